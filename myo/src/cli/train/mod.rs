//! `myo train`: learns a task, leaves a run folder.

mod drive;
mod progress;
mod settings;
mod several;

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use myo::train::session::{End, Outcome};
use myo::train::{Checkpoint, Inherited, PpoConfig, RunClaim, RunError, RunFolder, RunWriter, Session, Trainer};
use myo::{Beginning, Envs, Wish};
use serde_json::json;

use super::backend::{Backend, Options, place, sentence};
use super::failure::{Failure, Result, complain};
use super::interrupt::Interrupt;
use super::output::{duration, grouped, print, print_json, rounded};
use super::parse::{self, Goal};
use super::report;
use super::run_config::{Description, Inheritance, existing_checkpoint, newest_checkpoint};
use super::stage::Stage;
use several::Several;

pub use drive::Ready;
pub use settings::{STEPS, UNTIL, settings};

/// Arguments of `myo train`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Train {
    /// Name of a task (see `myo task list`), or a task file
    #[arg(required_unless_present = "resume")]
    task: Option<String>,

    /// Run folder to make; one that exists is refused [default: runs/<task>-<n>, the first free number]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Seed of everything random [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Control steps of all environments after which to stop in any case; 60M is short for 60000000 [default: 60M]
    #[arg(long, value_name = "N", value_parser = parse::count)]
    steps: Option<u64>,

    /// Stop when the deterministic policy succeeds in this share of fresh episodes, or `off` [default: 0.95]
    #[arg(long, value_name = "SHARE", value_parser = parse::goal)]
    until: Option<Goal>,

    #[command(flatten)]
    physics: Options,

    /// Environments side by side [default: that of the learner's settings]
    #[arg(long, value_name = "N", value_parser = parse::positive)]
    envs: Option<usize>,

    /// Change a setting of the learner; may be given several times. `config.json` of any run lists them all
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,

    /// Train with several seeds one after the other, from --seed on, and tell mean and spread; the folder then holds a run
    /// folder for each, and seeds.json
    #[arg(long, value_name = "N", value_parser = parse::positive)]
    seeds: Option<usize>,

    /// Begin with the networks of another run instead of with nothing; its task may have had other targets, and its body
    /// other muscles: observations and actions are matched by name
    #[arg(long, value_name = "RUN")]
    from: Option<PathBuf>,

    /// Go on with a run from its newest checkpoint, where it began, to the bit as if it had never stopped; with another
    /// --backend or --device, not to the bit
    #[arg(long, value_name = "RUN", conflicts_with_all = ["task", "out", "seed", "seeds", "from", "envs", "set"])]
    resume: Option<PathBuf>,

    /// Seconds between two checkpoints, which is what a crash may cost; 0 writes one after every update
    #[arg(long, value_name = "S", default_value = "30", value_parser = seconds)]
    checkpoint_every_s: f64,

    /// Print the result as JSON on standard output; progress stays on standard error
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo train pointing                          until 95 % of fresh episodes succeed, at most 60 M control steps
  myo train my.yaml --out runs/slow --seed 7
  myo train pointing --until off --steps 20M --set discount_per_s=0.5
  myo train my.yaml --from runs/pointing-1    starts with what that user can do already
  myo train ar --seeds 5                      mean and spread over five seeds
  myo train --resume runs/pointing-1          after Ctrl-C, or a crash

The run folder holds config.json, metrics.csv, tensorboard/, checkpoints/ and evaluation.json.
Whether `--until` is reached is looked at in 256 fresh episodes (1,024 on a graphics card) whenever training does well,
and confirmed in 1,000 others; these are the ones in the final table, with the 95 % confidence interval of their success.
Ctrl-C stops with a checkpoint, a second one at once. A graphics card that is lost stops with status 3; the run goes on from its
newest checkpoint. However a run was stopped, --resume ends it with the same weights and metrics as if it had not been, bit
for bit, and makes up for an evaluation that is missing. When learning runs away (a NaN, or a policy that moves by more than `kl_max`), it
goes back to its last good state with shorter steps and says so; when nothing improves for six million control steps, the
likely cause is named.

With --backend gpu the policy acts, learns and is looked at on the card.

JSON: `run`, `task`, `seed`, `backend` (`cpu` or `gpu`), `device` (its name, null on the cpu), `env_steps`, `updates`,
`wall_s` (evaluations included), `stopped_by` (`until`, `steps`, `interrupt` or `device_lost`), `until`, and `evaluation`,
with the keys that `myo eval --json` prints; null after an interrupt or a loss. With --seeds: `task`, `folder`, `runs`, a list
of such objects, `reached`, the number of seeds that reached the goal, and `mean` and `sd`, each with `wall_s`, `env_steps`,
`success`, `episode_length_s` and `effort`.";

/// A time, in seconds.
fn seconds(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(s) if (0.0..=1e6).contains(&s) => Ok(s),
        _ => Err("a number of seconds from 0 to 1000000 is needed".into()),
    }
}

/// Runs `myo train`.
pub fn run(args: &Train) -> Result<()> {
    let interrupt = Interrupt::listen()?;
    match (&args.resume, &args.task) {
        (Some(run), _) => resume(args, run, &interrupt),
        (None, Some(task)) => start(args, task, &interrupt),
        // Excluded by the declaration of the arguments.
        (None, None) => Err(Failure::sentence("name a task, or a run to resume")),
    }
}

fn start(args: &Train, task: &str, interrupt: &Interrupt) -> Result<()> {
    let heritage = args.from.as_deref().map(Heritage::open).transpose()?;
    let base = heritage
        .as_ref()
        .map_or_else(PpoConfig::default, |heritage| heritage.checkpoint.config().with_default_learning());
    let config = settings(&base, args.envs, &args.set)?;
    let stage = Stage::open(task)?;
    warn_of_goal(&stage, args.until.map_or(UNTIL, |goal| goal.0));
    let seed = args.seed.unwrap_or(1);
    let training = Training { args, stage: &stage, config, heritage, interrupt };
    match args.seeds {
        Some(seeds) => training.several(seed, seeds as u64),
        None => {
            let ready = training.ready(seed, |make| numbered(&stage.task.name, args.out.as_deref(), make))?;
            conclude(args, &stage, ready, interrupt)
        }
    }
}

/// Tells at once when the goal is beyond what the task allows.
fn warn_of_goal(stage: &Stage, until: Option<f64>) {
    let most = stage.most_success;
    if let Some(until) = until.filter(|until| *until > most) {
        complain(&format!(
            "warning: at most {:.1} % of the episodes can succeed, since targets lie out of reach, and the goal is {:.1} %: bring them \
             nearer, or set --until lower",
            100.0 * most,
            100.0 * until
        ));
    }
}

/// What a warm start begins from.
struct Heritage {
    run: PathBuf,
    checkpoint: Checkpoint,
}

impl Heritage {
    fn open(run: &Path) -> Result<Self> {
        let checkpoint = existing_checkpoint(&RunFolder::open(run)?)?;
        Ok(Self { run: run.to_owned(), checkpoint })
    }

    /// What a run was to begin from that was stopped before it had a checkpoint.
    fn again(from: &Inheritance) -> Result<Self> {
        let heritage = Self::open(&from.run)?;
        if heritage.description() == *from {
            return Ok(heritage);
        }
        Err(Failure::sentence(format!(
            "the run was to begin from {} after {} control steps, and was stopped before it did; that run is at {} now. \
             Start it again with --from",
            from.run.display(),
            grouped(from.env_steps),
            grouped(heritage.checkpoint.env_steps())
        )))
    }

    fn description(&self) -> Inheritance {
        Inheritance { run: self.run.clone(), env_steps: self.checkpoint.env_steps() }
    }
}

/// New trainings that differ in nothing but their seed.
struct Training<'a> {
    args: &'a Train,
    stage: &'a Stage,
    config: PpoConfig,
    heritage: Option<Heritage>,
    interrupt: &'a Interrupt,
}

impl<'a> Training<'a> {
    /// Prepares a training; `make_folder` chooses where it is recorded.
    fn ready(
        &self,
        seed: u64,
        make_folder: impl FnOnce(&dyn Fn(&Path) -> MadeFolder) -> Result<RunWriter>,
    ) -> Result<Ready<'a>> {
        let (args, stage) = (self.args, self.stage);
        let env = stage.env(&args.physics.wish(Backend::Auto)?, self.config.num_envs, seed)?;
        let place = env.place();
        let description = Description {
            task: stage.task.clone(),
            model: stage.own_model.clone(),
            backend: place.backend().into(),
            device: place.device().map(String::from),
            version: env!("CARGO_PKG_VERSION").into(),
            until: args.until.map_or(UNTIL, |goal| goal.0),
            steps: args.steps.unwrap_or(STEPS),
            from: self.heritage.as_ref().map(Heritage::description),
        };
        let from = self.heritage.as_ref().map(|heritage| &heritage.checkpoint);
        let beginning = Beginning::New { config: &self.config, seed, from };
        let ready = Ready::new(stage, env, beginning, description.goal())?;
        let (run, trainer) = (serde_json::to_value(&description)?, ready.session.trainer());
        let names = &trainer.spec().episode_names;
        let writer =
            make_folder(&|path| RunWriter::create(path, run.clone(), trainer.config(), trainer.seed(), names))?;
        complain(&format!(
            "training {} in {}: {} environments on {}",
            stage.task.name,
            writer.folder().path().display(),
            grouped(trainer.spec().num_envs as u64),
            sentence(&place)
        ));
        if let (Some(inherited), Some(heritage)) = (trainer.inherited(), &self.heritage) {
            complain(&heir(heritage, inherited, trainer));
        }
        recorded(args, ready, writer)
    }

    /// One training after the other.
    fn several(&self, first: u64, seeds: u64) -> Result<()> {
        let name = &self.stage.task.name;
        let folder = self.args.out.clone().unwrap_or_else(|| free_folder(name));
        let mut several = Several::new(name, &folder)?;
        for seed in first..first + seeds {
            let path = several.run_folder(seed);
            let outcome = self.ready(seed, |make| Ok(make(&path)?))?.run(self.interrupt)?;
            let (end, lost) = (outcome.end.clone(), loss(&outcome, &path.display().to_string()));
            several.add(seed, outcome)?;
            match end {
                End::DeviceLost { .. } => return Err(Failure::DeviceLost(lost)),
                End::Interrupted => return Err(Failure::Interrupted),
                End::Until | End::Steps => {}
            }
        }
        several.tell(self.args.json)
    }
}

/// What a warm start took over, for people.
fn heir(heritage: &Heritage, inherited: Inherited, trainer: &Trainer) -> String {
    let spec = trainer.spec();
    format!(
        "starting from {} after {} control steps: {} of {} observations and {} of {} actions are known",
        heritage.run.display(),
        grouped(inherited.env_steps),
        inherited.observations,
        spec.observation_size(),
        inherited.actions,
        spec.action_size()
    )
}

type MadeFolder = std::result::Result<RunWriter, RunError>;

/// Makes the run folder: the one asked for, or the first that is free.
fn numbered(task: &str, out: Option<&Path>, make: &dyn Fn(&Path) -> MadeFolder) -> Result<RunWriter> {
    if let Some(path) = out {
        return Ok(make(path)?);
    }
    loop {
        // Another process may take the name in between.
        match make(&free_folder(task)) {
            Err(RunError::Exists { .. }) => {}
            made => return Ok(made?),
        }
    }
}

/// The first of `runs/<task>-1`, `runs/<task>-2`, ... that is not taken.
fn free_folder(task: &str) -> PathBuf {
    let name = task.replace(|c: char| !c.is_alphanumeric() && c != '_', "-");
    let path = |number: u64| Path::new("runs").join(format!("{name}-{number}"));
    (1..).map(path).find(|path| !path.exists()).unwrap_or_else(|| path(1))
}

fn resume(args: &Train, path: &Path, interrupt: &Interrupt) -> Result<()> {
    let claim = RunClaim::take(path)?;
    let run = claim.folder();
    let mut description = Description::of(run)?;
    description.until = args.until.map_or(description.until, |goal| goal.0);
    description.steps = args.steps.unwrap_or(description.steps);
    let stage = Stage::of(&description)?;
    let (config, seed, goal) = (run.config().ppo.clone(), run.config().seed, description.goal());
    let env = env_again(args, &stage, &description, &config, seed)?;
    let checkpoint = newest_checkpoint(run)?;
    // Stopped before its first checkpoint: the same beginning gives the same run.
    let from = description.from.as_ref().filter(|_| checkpoint.is_none()).map(Heritage::again).transpose()?;
    let new = Beginning::New { config: &config, seed, from: from.as_ref().map(|heritage| &heritage.checkpoint) };
    let ready = Ready::new(&stage, env, checkpoint.as_ref().map_or(new, Beginning::Again), goal)?;
    if run.has_evaluation()? {
        refuse_if_over(path, &ready.session)?;
    }
    let trainer = ready.session.trainer();
    let writer = claim.resume(trainer.env_steps(), &trainer.spec().episode_names)?;
    complain(&format!(
        "going on with {} in {} after {} control steps, on {}",
        stage.task.name,
        path.display(),
        grouped(trainer.env_steps()),
        sentence(&ready.place)
    ));
    conclude(args, &stage, recorded(args, ready, writer)?, interrupt)
}

/// Says what would make a training go on whose end is recorded.
fn refuse_if_over(path: &Path, session: &Session) -> Result<()> {
    let (path, done, limit) = (path.display(), session.trainer().env_steps(), session.goal().steps);
    let success = session.confirmed().and_then(|evaluation| evaluation.success).unwrap_or_default();
    match session.over() {
        Some(End::Until) => Err(Failure::sentence(format!(
            "{path} has reached its goal with {:.1} % success; raise it with --until, or take --until off",
            100.0 * success
        ))),
        Some(_) => Err(Failure::sentence(format!(
            "{path} has {} control steps, and its limit is {}; raise it with --steps",
            grouped(done),
            grouped(limit)
        ))),
        None => Ok(()),
    }
}

/// The training with its record.
fn recorded<'a>(args: &Train, ready: Ready<'a>, writer: RunWriter) -> Result<Ready<'a>> {
    ready.recorded_in(writer, Duration::from_secs_f64(args.checkpoint_every_s))
}

/// The environments of a run that goes on: where it began, unless another place is asked for.
fn env_again(args: &Train, stage: &Stage, description: &Description, config: &PpoConfig, seed: u64) -> Result<Envs> {
    if args.physics.is_given() {
        return stage.env(&args.physics.wish(Backend::Auto)?, config.num_envs, seed);
    }
    let wish = description.wish();
    if let (Wish::Gpu(_), Err(Failure::Sentence(reason))) = (&wish, place(&wish, config.num_envs)) {
        let device = description.device.as_deref().unwrap_or("a graphics card");
        return Err(Failure::sentence(format!(
            "the run began on {device}, which cannot be had now: {reason}. To go on elsewhere, add --backend cpu or --device"
        )));
    }
    stage.env(&wish, config.num_envs, seed)
}

/// Trains to the end and tells how it went.
fn conclude(args: &Train, stage: &Stage, ready: Ready<'_>, interrupt: &Interrupt) -> Result<()> {
    let (seed, until, place) = (ready.session.trainer().seed(), ready.session.goal().until, ready.place.clone());
    let outcome = ready.run(interrupt)?;
    let run = outcome.run.as_deref().unwrap_or(Path::new("")).display().to_string();
    if args.json {
        print_json(&json!({
            "run": run,
            "task": stage.task.name,
            "seed": seed,
            "backend": place.backend(),
            "device": place.device(),
            "env_steps": outcome.env_steps,
            "updates": outcome.updates,
            "wall_s": outcome.wall_s,
            "stopped_by": outcome.end.name(),
            "until": until,
            "evaluation": outcome.evaluation,
        }))?;
    } else if !matches!(outcome.end, End::DeviceLost { .. }) {
        print(&summary(stage, &outcome, seed, until, &run))?;
    }
    match outcome.end {
        End::DeviceLost { .. } => Err(Failure::DeviceLost(loss(&outcome, &run))),
        End::Interrupted => Err(Failure::Interrupted),
        End::Until | End::Steps => Ok(()),
    }
}

/// What is left after the graphics card was lost.
fn loss(outcome: &Outcome, run: &str) -> String {
    let End::DeviceLost { reason } = &outcome.end else { return String::new() };
    let steps = rounded(outcome.env_steps as f64);
    let from = match &outcome.checkpoint {
        Some(checkpoint) => format!("its newest checkpoint is {}", checkpoint.display()),
        None => "it had no checkpoint yet and begins again".into(),
    };
    format!(
        "the GPU was lost: {reason}\nstopped after {steps} control steps; {from}\n\nnext: {} train --resume {run}",
        program()
    )
}

fn program() -> String {
    std::env::args().next().unwrap_or_else(|| "myo".into())
}

fn summary(stage: &Stage, outcome: &Outcome, seed: u64, until: Option<f64>, run: &str) -> String {
    let program = program();
    let (steps, time) = (rounded(outcome.env_steps as f64), duration(outcome.wall_s));
    let Some(evaluation) = &outcome.evaluation else {
        let next = format!("{program} train --resume {run}");
        return format!("\nstopped after {steps} control steps and {time}, with a checkpoint\n\nnext: {next}\n");
    };
    let next = match (&outcome.end, until) {
        (End::Steps, Some(_)) => format!("{program} train --resume {run} --steps {}", 2 * outcome.env_steps),
        _ => format!("{program} eval {run} --episodes 10000"),
    };
    let missed = match (&outcome.end, until) {
        (End::Steps, Some(until)) => format!("the step limit came before {:.0} % success\n", 100.0 * until),
        _ => String::new(),
    };
    format!(
        "\n{}  trained         {steps} control steps in {time}, seed {seed}\n  run folder      {run}\n\n{missed}next: {next}\n",
        report::evaluation(&stage.task.name, evaluation)
    )
}
