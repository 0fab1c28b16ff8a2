//! `myo train`: learns a task, leaves a run folder.

mod ahead;
mod both;
mod drive;
mod practise;
mod progress;
mod resume;
mod settings;
mod several;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::thread::Scope;
use std::time::Duration;

use clap::Args;
use myo::tasks::User;
use myo::train::session::{End, Goal, Outcome, Until};
use myo::train::{Checkpoint, Inherited, PpoConfig, RunError, RunWriter, Trainer};
use myo::{Backend, Device, RunDescription, Start, WarmStart, layout_names};
use serde_json::json;

use super::backend::{BackendName, Options, sentence};
use super::failure::{Failure, Result, complain};
use super::interrupt::Interrupt;
use super::output::{argument, command, duration, grouped, name, print, print_json, rounded};
use super::parse;
use super::report;
use super::run_folder::existing_checkpoint;
use super::scenario::{Scenario, run_name_of};
use several::{Plan, Report};

pub use both::{Side, train_both};
pub use drive::Ready;
pub use practise::{Practising, practise, practise_until};
pub use settings::LearnerOptions;
pub use several::{Several, open_run};

/// Arguments of `myo train`.
#[derive(Args, Default)]
#[command(after_help = HELP)]
pub struct Train {
    /// Name of a task (see `myo task list`), or a task file; several with --together
    #[arg(required_unless_present = "resume")]
    task: Vec<String>,

    /// Train one user on all of several layouts, tasks of one structure: side by side, so many environments for each
    #[arg(long)]
    together: bool,

    /// Run folder to make; one that exists is refused [default: runs/<n>, named after the task or its file, such as
    /// runs/pointing-1, with the first free number]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    how: TrainingOptions,

    /// Train with several seeds, starting at --seed, and report mean and spread: at once on a graphics card, else one after
    /// the other, with the same results. The folder then holds a run folder for each, and seeds.json
    #[arg(long, value_name = "N", value_parser = parse::positive)]
    seeds: Option<usize>,

    /// Start from the networks of another run instead of from scratch; its task may have had other targets, and its body
    /// other muscles: observations and actions are matched by name
    #[arg(long, value_name = "RUN")]
    from: Option<PathBuf>,

    /// Continue a run, or the runs of --seeds, from the newest checkpoint on the same backend, bit for bit as if it had never
    /// stopped; on another --backend or --device, up to rounding
    #[arg(long, value_name = "RUN", conflicts_with_all = ["task", "together", "out", "seed", "seeds", "from", "envs", "set", "user"])]
    resume: Option<PathBuf>,

    /// Print the result as JSON on standard output; progress stays on standard error
    #[arg(long)]
    json: bool,

    /// The caller tells how several trainings went
    #[arg(skip)]
    silent: bool,
}

/// How users are trained, whoever asks for it.
#[derive(Clone, Debug, Default, Args)]
pub struct TrainingOptions {
    /// Who does it, in place of the task's `user`: `human`, `fastest`, or a person such as `small_woman` (`myo task users`); what the task says of its user stays [default: as the task says]
    #[arg(long, value_name = "USER", value_parser = parse::user)]
    user: Option<User>,

    /// Seed of everything random [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Control steps of all environments after which to stop in any case; 60M is short for 60000000 [default: 200M at 20 Hz, 10 million simulated seconds]
    #[arg(long, value_name = "N", value_parser = parse::count)]
    steps: Option<u64>,

    /// What to train to: `plateau`, where nothing improves any more that is worth it; a share of fresh episodes in which the
    /// deterministic policy succeeds, such as 0.95; or `off` [default: plateau]
    #[arg(long, value_name = "GOAL")]
    until: Option<Until>,

    #[command(flatten)]
    physics: Options,

    #[command(flatten)]
    learner: LearnerOptions,

    /// Seconds between two checkpoints, which is what a crash may cost; 0 writes one after every update
    #[arg(long, value_name = "S", default_value = "30", value_parser = seconds)]
    checkpoint_every_s: f64,
}

const HELP: &str = "\
Examples:
  myo train pointing                          until the user has finished learning, at most 200 M control steps
  myo train pointing --user fastest           as fast as muscles allow, whatever the effort: for comparisons of learners
  myo train pointing --until 0.95             until 95 % of fresh episodes succeed, which is where it has just begun to be good
  myo train my.yaml --out runs/slow --seed 7
  myo train pointing --until off --steps 20M --set discount_per_s=0.7
  myo train my.yaml --from runs/pointing-1    starts from what that user has learned
  myo train ar --seeds 5                      mean and spread over five seeds
  myo train a.yaml b.yaml c.yaml --together   one user for three layouts
  myo train --resume runs/pointing-1          after Ctrl-C, or a crash; also the folder of --seeds

The run folder holds config.json, metrics.csv, tensorboard/, checkpoints/ and evaluation.json.
The plateau is where four times as many steps would change the time of an episode by less than 3 %, success by less than 1 % and \
the return by less than 2 % of what it has gained, as far as the last two doublings tell, counted from when all costs counted: \
what a movement costs is put on a beginner little by little, and who could not afford it yet still changes. Whether a share is \
reached is tried in 256 fresh episodes (1,024 on a graphics card) whenever training does well, and confirmed in 1,000 others. The \
final table is about 1,000 fresh episodes that had no say in when to stop, with 95 % confidence intervals, and says by how much \
the user was still improving. Ctrl-C stops with a checkpoint, a second Ctrl-C at once; the loss of a graphics card stops with \
status 3. However a run was stopped, --resume ends it with the same weights and metrics as if it had not been stopped, bit for \
bit, and adds an evaluation that is missing. When learning runs away (a NaN, or a policy that moves by more than `kl_max`), it \
returns to its last good state with shorter steps and says so; when nothing improves for six million control steps, the likely \
cause is named.

With --together one user learns all layouts at once. They may differ in numbers alone: where objects are, how large, which of them \
a step asks for, times, forces, weights; else the one that differs is named. A goal is reached when it is in every layout: each \
must succeed in as many of so many episodes of its own, and the plateau is that of the layout that still improves most. The table, \
and `evaluation`, have each layout and the mean.

With --backend gpu the policy acts, learns and is evaluated on the card.

JSON: `run`, `task`, `layouts` (names, one or more), `seed`, `backend` (`cpu` or `gpu`), `device` (its name, null on the cpu), \
`env_steps`, `updates`, `wall_s` (evaluations included), `stopped_by` (`until`, `plateau`, `steps`, `interrupt` or `device_lost`), \
`until`, `trend` (`env_steps`, `since`, the steps from which on it counts, and what the `last_doubling` of training brought and \
`four_times` as much would: `episode_time` and `return` as shares, `success`; or null), and `evaluation`, with the keys that `myo \
eval --json` prints; null after an interrupt or a loss. With --seeds: `task`, `folder`, `runs`, a list of such objects, `reached`, \
the number of seeds that reached the goal, and `mean` and `sd`, each with `wall_s`, `env_steps`, `success`, `episode_length_s` and \
`effort`.";

impl TrainingOptions {
    /// Who does the tasks where they do not say.
    pub fn user(&self) -> Option<User> {
        self.user
    }

    fn checkpoint_every(&self) -> Duration {
        Duration::from_secs_f64(self.checkpoint_every_s)
    }
}

impl Train {
    fn report(&self) -> Report {
        match (self.silent, self.json) {
            (true, _) => Report::Nothing,
            (false, true) => Report::Json,
            (false, false) => Report::Table,
        }
    }
}

/// A time, in seconds.
fn seconds(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(s) if (0.0..=1e6).contains(&s) => Ok(s),
        _ => Err("expected a number of seconds from 0 to 1000000".into()),
    }
}

/// Trains users of a task with this many seeds in a new folder, and leaves it to the caller to tell how that went.
pub fn train_users(
    how: &TrainingOptions,
    task: &str,
    seeds: usize,
    folder: &Path,
    interrupt: &Interrupt,
) -> Result<()> {
    let (task, out, how) = (vec![task.into()], Some(folder.into()), how.clone());
    let (seeds, together) = (Some(seeds), false);
    let args = Train { task, together, out, how, seeds, from: None, resume: None, json: false, silent: true };
    start_or_resume(&args, interrupt)
}

/// Runs `myo train`, with threads `beside` that may last longer than it takes to tell what is wrong.
pub fn run<'scope>(args: &Train, beside: &'scope Scope<'scope, '_>) -> Result<()> {
    ahead::open_card(args, beside);
    start_or_resume(args, &Interrupt::listen()?)
}

fn start_or_resume(args: &Train, interrupt: &Interrupt) -> Result<()> {
    match (&args.resume, &args.task[..], args.together) {
        (Some(run), ..) => resume::run(args, run, interrupt),
        // Excluded by the declaration of the arguments.
        (None, [], _) => Err(Failure::sentence("name a task, or a run to resume")),
        (None, [_], false) | (None, [_, _, ..], true) => start(args, &args.task, interrupt),
        (None, [task], true) => {
            Err(Failure::sentence(format!("--together needs several tasks; there is only {}", name(task))))
        }
        (None, tasks, false) => Err(Failure::sentence(format!(
            "{} tasks are named: with --together one user learns all of them; `myo compare` trains users of each of two",
            tasks.len()
        ))),
    }
}

fn start(args: &Train, tasks: &[String], interrupt: &Interrupt) -> Result<()> {
    let heritage = args.from.as_deref().map(Heritage::open).transpose()?;
    let seed = args.how.seed.unwrap_or(1);
    let seeds = args.seeds.map(|count| several::seeds(seed, count as u64)).transpose()?;
    let (scenario, run_name) = (Scenario::open_together(tasks, args.how.user)?, run_name_of(tasks));
    let user = scenario.task.user;
    let base = heritage
        .as_ref()
        .map_or_else(|| scenario.usual_settings(), |heritage| heritage.checkpoint.config().with_learning_of(user));
    let config = args.how.learner.settings(&base)?;
    let steps = args.how.steps.unwrap_or_else(|| myo::default_steps(scenario.task.control_dt_s));
    let goal = Goal { until: args.how.until.unwrap_or_default(), steps };
    warn_of_goal(&scenario, goal.until.share());
    let backend = args.how.physics.choice(BackendName::Auto)?;
    let checkpoint_every = args.how.checkpoint_every();
    let training = Training { scenario: &scenario, config, heritage, backend, goal, checkpoint_every };
    match seeds {
        Some(seeds) => {
            let folder = args.out.clone().unwrap_or_else(|| free_folder(&run_name));
            training.several(args, seeds, &folder, interrupt)
        }
        None => {
            let ready = training.ready(seed, |make, _| numbered(&run_name, args.out.as_deref(), make))?;
            conclude(args, &scenario, ready, interrupt)
        }
    }
}

/// Tells at once when the goal is beyond what the task allows.
fn warn_of_goal(scenario: &Scenario, until: Option<f64>) {
    let most = scenario.most_success;
    if let Some(until) = until.filter(|until| *until > most) {
        complain(&format!(
            "warning: at most {:.1} % of the episodes can succeed, since targets lie out of reach, and the goal is {:.1} %: move \
             them as advised above, or set --until lower",
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
        let checkpoint = existing_checkpoint(&open_run(run)?)?;
        Ok(Self { run: run.to_owned(), checkpoint })
    }

    fn description(&self) -> WarmStart {
        WarmStart { run: self.run.clone(), env_steps: self.checkpoint.env_steps() }
    }
}

/// New trainings that differ in nothing but their seed.
struct Training<'a> {
    scenario: &'a Scenario,
    config: PpoConfig,
    heritage: Option<Heritage>,
    backend: Backend,
    goal: Goal,
    checkpoint_every: Duration,
}

impl<'a> Training<'a> {
    /// Prepares a training; `make_folder` chooses where it is recorded.
    fn ready(
        &self,
        seed: u64,
        make_folder: impl FnOnce(&dyn Fn(&Path) -> MadeFolder, RunDescription) -> Result<RunWriter>,
    ) -> Result<Ready<'a>> {
        let scenario = self.scenario;
        let env = scenario.training_env(&self.backend, &self.config, seed)?;
        self.recorded(Ready::new(scenario, env, self.start(seed), self.goal)?, make_folder)
    }

    /// Records a training; `make_folder` chooses where.
    fn recorded(
        &self,
        ready: Ready<'a>,
        make_folder: impl FnOnce(&dyn Fn(&Path) -> MadeFolder, RunDescription) -> Result<RunWriter>,
    ) -> Result<Ready<'a>> {
        let (description, trainer) = (self.description(&ready.device), ready.session.trainer());
        let run = serde_json::to_value(&description)?;
        let make = |path: &Path| RunWriter::create(path, run.clone(), trainer.config(), trainer.seed(), trainer.spec());
        let writer = make_folder(&make, description)?;
        complain(&format!(
            "training {} in {}, user {}: {} environments on {}",
            self.scenario.title(),
            writer.folder().path().display(),
            self.scenario.task.who(),
            grouped(trainer.spec().num_envs as u64),
            sentence(&ready.device)
        ));
        if let (Some(inherited), Some(heritage)) = (trainer.inherited(), &self.heritage) {
            complain(&heir(heritage, inherited, trainer));
        }
        ready.recorded_in(writer, self.checkpoint_every)
    }

    /// How the training with a seed starts, if it is new.
    fn start(&self, seed: u64) -> Start<'_> {
        Start::New { config: &self.config, seed, from: self.heritage.as_ref().map(|heritage| &heritage.checkpoint) }
    }

    fn description(&self, device: &Device) -> RunDescription {
        let (task, own_model) = (self.scenario.task.clone(), self.scenario.own_model.clone());
        let from = self.heritage.as_ref().map(Heritage::description);
        let other_layouts = self.scenario.layouts[1..].to_vec();
        RunDescription { other_layouts, ..RunDescription::new(task, own_model, device, self.goal, from) }
    }

    /// The trainings in a new folder: at once where that is possible, else one after the other.
    fn several(&self, args: &Train, seeds: SeedRange, folder: &Path, interrupt: &Interrupt) -> Result<()> {
        let starts: Vec<_> = seeds.clone().map(|seed| self.start(seed)).collect();
        if let Some(all) = Ready::several(self.scenario, &self.backend, &self.config, &starts, self.goal)? {
            let Some(device) = all.first().map(|ready| ready.device.clone()) else { return Ok(()) };
            let plan = Plan::new(seeds, self.description(&device), self.config.clone());
            let from = self.heritage.as_ref().map(|heritage| &heritage.checkpoint);
            let several = Several::create(folder, plan, from)?;
            let recorded = |ready: Ready<'a>| {
                let path = several.run_folder(ready.session.trainer().seed());
                self.recorded(ready, |make, _| Ok(make(&path)?))
            };
            let all = all.into_iter().map(recorded).collect::<Result<_>>()?;
            return several.run_at_once(args.report(), all, interrupt);
        }
        let mut several = None;
        let first = self.ready(*seeds.start(), |make, run| {
            let plan = Plan::new(seeds, run, self.config.clone());
            let from = self.heritage.as_ref().map(|heritage| &heritage.checkpoint);
            let made = several.insert(Several::create(folder, plan, from)?);
            Ok(make(&made.run_folder(made.plan().first_seed))?)
        })?;
        let Some(several) = several else { return Ok(()) };
        let mut first = Some(first);
        several.run(args.report(), |seed, path| match first.take() {
            Some(first) => first.run(interrupt),
            None => self.ready(seed, |make, _| Ok(make(path)?))?.run(interrupt),
        })
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
type SeedRange = RangeInclusive<u64>;

/// Makes the run folder: the one asked for, or the first that is free.
fn numbered(name: &str, out: Option<&Path>, make: &dyn Fn(&Path) -> MadeFolder) -> Result<RunWriter> {
    if let Some(path) = out {
        return Ok(make(path)?);
    }
    loop {
        // Another process may take the name in between.
        match make(&free_folder(name)) {
            Err(RunError::Exists { .. }) => {}
            made => return Ok(made?),
        }
    }
}

/// The first of `runs/<name>-1`, `runs/<name>-2`, ... that is not taken.
pub fn free_folder(name: &str) -> PathBuf {
    let path = |number: u64| Path::new("runs").join(format!("{name}-{number}"));
    (1..).map(path).find(|path| !path.exists()).unwrap_or_else(|| path(1))
}

/// Trains to the end and tells how it went.
fn conclude(args: &Train, scenario: &Scenario, ready: Ready<'_>, interrupt: &Interrupt) -> Result<()> {
    let (seed, until, device) = (ready.session.trainer().seed(), ready.session.goal().until, ready.device.clone());
    let outcome = ready.run(interrupt)?;
    let run = outcome.run.as_deref().unwrap_or(Path::new(""));
    if args.json {
        let evaluation = outcome.evaluation.as_ref().map(|told| report::json(&scenario.layouts, told)).transpose()?;
        print_json(&json!({
            "run": run.display().to_string(),
            "task": scenario.task.name,
            "layouts": layout_names(&scenario.layouts),
            "seed": seed,
            "backend": device.backend(),
            "device": device.card(),
            "env_steps": outcome.env_steps,
            "updates": outcome.updates,
            "wall_s": outcome.wall_s,
            "stopped_by": outcome.end.name(),
            "until": until,
            "trend": outcome.trend,
            "evaluation": evaluation,
        }))?;
    } else if !matches!(outcome.end, End::DeviceLost { .. }) {
        print(&summary(scenario, &outcome, seed, until, run))?;
    }
    match outcome.end {
        End::DeviceLost { .. } => Err(Failure::DeviceLost(loss(&outcome, run))),
        End::Interrupted => Err(Failure::Interrupted),
        End::Until | End::Plateau | End::Steps => Ok(()),
    }
}

/// What is left after the graphics card was lost; `run` is the folder to go on with.
fn loss(outcome: &Outcome, run: &Path) -> String {
    let End::DeviceLost { reason } = &outcome.end else { return String::new() };
    let steps = rounded(outcome.env_steps as f64);
    let from = match &outcome.checkpoint {
        Some(checkpoint) => format!("its newest checkpoint is {}", checkpoint.display()),
        None => "it had no checkpoint yet and begins again".into(),
    };
    let next = command(&["train", "--resume", &argument(run)]);
    format!("the GPU was lost: {reason}\nstopped after {steps} control steps; {from}\n\nnext: {next}")
}

fn summary(scenario: &Scenario, outcome: &Outcome, seed: u64, until: Until, run: &Path) -> String {
    let (steps, time) = (rounded(outcome.env_steps as f64), duration(outcome.wall_s));
    let folder = argument(run);
    let Some(evaluation) = &outcome.evaluation else {
        let next = command(&["train", "--resume", &folder]);
        return format!("\nstopped after {steps} control steps and {time}, with a checkpoint\n\nnext: {next}\n");
    };
    let improves = outcome.trend.is_none_or(|trend| !trend.is_plateau());
    let next = match (&outcome.end, until) {
        (End::Steps, Until::Plateau | Until::Success(_)) => {
            command(&["train", "--resume", &folder, "--steps", &(2 * outcome.env_steps).to_string()])
        }
        (End::Until, _) if improves => command(&["train", "--resume", &folder, "--until", "plateau"]),
        _ => command(&["eval", &folder, "--episodes", "10000"]),
    };
    let missed = match (&outcome.end, until) {
        (End::Steps, Until::Success(share)) => format!("the step limit came before {:.0} % success\n", 100.0 * share),
        (End::Steps, Until::Plateau) => "the step limit came before the plateau\n".into(),
        _ => String::new(),
    };
    format!(
        "\n{}{}  trained         {steps} control steps in {time}, seed {seed}\n  run folder      {}\n\n{missed}next: {next}\n",
        report::evaluation(&scenario.layouts, evaluation),
        report::practice(outcome.trend),
        run.display()
    )
}
