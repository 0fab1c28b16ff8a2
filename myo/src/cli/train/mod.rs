//! `myo train`: learns a task, leaves a run folder.

mod examiner;
mod progress;
mod schedule;
mod session;
mod settings;

use std::path::{Path, PathBuf};

use clap::Args;
use myo::train::{PpoConfig, RunError, RunFolder, RunWriter, Trainer};
use serde_json::json;

use super::backend::{Backend, Options, Place, Wish};
use super::envs::Envs;
use super::failure::{Failure, Result, complain};
use super::interrupt::Interrupt;
use super::output::{duration, grouped, print, print_json, rounded};
use super::parse::{self, Goal};
use super::report;
use super::run_config::{Description, newest_checkpoint};
use super::stage::Stage;

pub use examiner::evaluation_seed;
pub use session::{End, Outcome, Session};
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

    /// Go on with a run from its newest checkpoint, where it began, to the bit as if it had never stopped; with another
    /// --backend or --device, not to the bit
    #[arg(long, value_name = "RUN", conflicts_with_all = ["task", "out", "seed", "envs", "set"])]
    resume: Option<PathBuf>,

    /// Print the result as JSON on standard output; progress stays on standard error
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo train pointing                          until 95 % of fresh episodes succeed, at most 60 M control steps
  myo train my.yaml --out runs/slow --seed 7
  myo train pointing --until off --steps 20M --set gamma=0.98
  myo train --resume runs/pointing-1          after Ctrl-C, or a crash

The run folder holds config.json, metrics.csv, tensorboard/, checkpoints/ (every 30 s) and evaluation.json.
Whether `--until` is reached is looked at in 256 fresh episodes whenever training does well, and confirmed in 1,000
others; these are the ones in the final table. Ctrl-C stops with a checkpoint, a second one at once. A graphics card that
is lost stops with a checkpoint, too, and status 3; going on from it begins new episodes.

With --backend gpu the policy acts and learns on the card, too; looking at the goal is work of the processor.

JSON: `run`, `task`, `seed`, `backend` (`cpu` or `gpu`), `device` (its name, null on the cpu), `env_steps`, `updates`,
`wall_s` (evaluations included), `stopped_by` (`until`, `steps`, `interrupt` or `device_lost`), `until`, and `evaluation`,
with the keys that `myo eval --json` prints; null after an interrupt or a loss.";

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
    let config = settings(args.envs, &args.set)?;
    let stage = Stage::open(task)?;
    let seed = args.seed.unwrap_or(1);
    let (place, env) = stage.env(&args.physics.wish(Backend::Auto)?, config.num_envs, seed)?;
    let description = Description {
        task: stage.task.clone(),
        backend: place.backend().into(),
        device: place.device().map(String::from),
        version: env!("CARGO_PKG_VERSION").into(),
        until: args.until.map_or(UNTIL, |goal| goal.0),
        steps: args.steps.unwrap_or(STEPS),
    };
    let trainer = env.train(config, seed)?;
    let writer = create(args.out.as_deref(), &description, &trainer)?;
    complain(&format!(
        "training {} in {}: {} environments on {}",
        stage.task.name,
        writer.folder().path().display(),
        grouped(trainer.spec().num_envs as u64),
        place.sentence()
    ));
    let session = Session::new(&stage, trainer, description.until, description.steps);
    conclude(args, &stage, &place, session.recorded_in(writer), interrupt)
}

/// Makes the run folder: the one asked for, or the first that is free.
fn create(out: Option<&Path>, description: &Description, trainer: &Trainer) -> Result<RunWriter> {
    let run = serde_json::to_value(description)?;
    let make = |path: &Path| {
        RunWriter::create(path, run.clone(), trainer.config(), trainer.seed(), &trainer.spec().episode_names)
    };
    if let Some(path) = out {
        return Ok(make(path)?);
    }
    let name = description.task.name.replace(|c: char| !c.is_alphanumeric() && c != '_', "-");
    let mut number = 1;
    loop {
        match make(&Path::new("runs").join(format!("{name}-{number}"))) {
            Err(RunError::Exists { .. }) => number += 1,
            made => return Ok(made?),
        }
    }
}

fn resume(args: &Train, path: &Path, interrupt: &Interrupt) -> Result<()> {
    let run = RunFolder::open(path)?;
    let mut description = Description::of(&run)?;
    description.until = args.until.map_or(description.until, |goal| goal.0);
    description.steps = args.steps.unwrap_or(description.steps);
    let stage = Stage::of(description.task.clone())?;
    let (config, seed) = (run.config().ppo.clone(), run.config().seed);
    let (place, env) = env_again(args, &stage, &description, &config, seed)?;
    let trainer = match newest_checkpoint(&run)? {
        Some(checkpoint) => env.go_on(&checkpoint)?,
        // Stopped before its first checkpoint: the same seed begins the same run.
        None => env.train(config, seed)?,
    };
    if trainer.env_steps() >= description.steps {
        let (done, limit) = (grouped(trainer.env_steps()), grouped(description.steps));
        let path = path.display();
        return Err(Failure::sentence(format!(
            "{path} has {done} control steps, and its limit is {limit}; raise it with --steps"
        )));
    }
    let writer = RunWriter::resume(path, trainer.env_steps(), &trainer.spec().episode_names)?;
    complain(&format!(
        "going on with {} in {} after {} control steps, on {}",
        stage.task.name,
        path.display(),
        grouped(trainer.env_steps()),
        place.sentence()
    ));
    let session = Session::new(&stage, trainer, description.until, description.steps);
    conclude(args, &stage, &place, session.recorded_in(writer), interrupt)
}

/// The environments of a run that goes on: where it began, unless another place is asked for.
fn env_again(
    args: &Train,
    stage: &Stage,
    description: &Description,
    config: &PpoConfig,
    seed: u64,
) -> Result<(Place, Envs)> {
    if args.physics.is_given() {
        return stage.env(&args.physics.wish(Backend::Auto)?, config.num_envs, seed);
    }
    let wish = description.wish();
    if let (Wish::Gpu(_), Err(Failure::Sentence(reason))) = (&wish, wish.place(config.num_envs)) {
        let device = description.device.as_deref().unwrap_or("a graphics card");
        return Err(Failure::sentence(format!(
            "the run began on {device}, which cannot be had now: {reason}. To go on elsewhere, add --backend cpu or --device"
        )));
    }
    stage.env(&wish, config.num_envs, seed)
}

/// Trains to the end and tells how it went.
fn conclude(args: &Train, stage: &Stage, place: &Place, session: Session<'_>, interrupt: &Interrupt) -> Result<()> {
    let (seed, until) = (session.seed(), session.until());
    let outcome = session.run(interrupt)?;
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
    } else if outcome.end != End::DeviceLost {
        print(&summary(stage, &outcome, seed, until, &run))?;
    }
    match outcome.end {
        End::DeviceLost => Err(Failure::DeviceLost(loss(&outcome, &run))),
        End::Interrupted => Err(Failure::Interrupted),
        End::Until | End::Steps => Ok(()),
    }
}

/// What is left after the graphics card was lost.
fn loss(outcome: &Outcome, run: &str) -> String {
    let reason = outcome.lost.as_deref().unwrap_or("the driver does not say why");
    let steps = rounded(outcome.env_steps as f64);
    let checkpoint = outcome.checkpoint.as_deref().unwrap_or(Path::new("")).display();
    format!(
        "the GPU was lost: {reason}\nstopped after {steps} control steps, with the checkpoint {checkpoint}\n\n\
         next, with new episodes: {} train --resume {run}",
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
    let next = match (outcome.end, until) {
        (End::Steps, Some(_)) => format!("{program} train --resume {run} --steps {}", 2 * outcome.env_steps),
        _ => format!("{program} eval {run} --episodes 10000"),
    };
    let missed = match (outcome.end, until) {
        (End::Steps, Some(until)) => format!("the step limit came before {:.0} % success\n", 100.0 * until),
        _ => String::new(),
    };
    format!(
        "\n{}  trained         {steps} control steps in {time}, seed {seed}\n  run folder      {run}\n\n{missed}next: {next}\n",
        report::evaluation(&stage.task.name, evaluation)
    )
}
