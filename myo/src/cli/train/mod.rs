//! `myo train`: learns a task, leaves a run folder.

mod examiner;
mod progress;
mod schedule;
mod session;
mod settings;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use myo::train::{RunError, RunFolder, RunWriter, Trainer};
use serde_json::json;

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

    /// What computes the physics
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    backend: Backend,

    /// Environments side by side [default: that of the learner's settings]
    #[arg(long, value_name = "N", value_parser = parse::positive)]
    envs: Option<usize>,

    /// Change a setting of the learner; may be given several times. `config.json` of any run lists them all
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,

    /// Go on with a run from its newest checkpoint, to the bit as if it had never stopped
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
others; these are the ones in the final table. Ctrl-C stops with a checkpoint, a second one at once.

JSON: `run`, `task`, `seed`, `env_steps`, `updates`, `wall_s` (evaluations included), `stopped_by` (`until`, `steps` or
`interrupt`), `until`, and `evaluation`, with the keys that `myo eval --json` prints; null after an interrupt.";

#[derive(Clone, Copy, ValueEnum)]
enum Backend {
    /// The fastest that this machine has
    Auto,
    /// Processor cores
    Cpu,
}

/// Runs `myo train`.
pub fn run(args: &Train) -> Result<()> {
    // Both are the processor as long as there is nothing else.
    let (Backend::Auto | Backend::Cpu) = args.backend;
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
    let description = Description {
        task: stage.task.clone(),
        backend: "cpu".into(),
        version: env!("CARGO_PKG_VERSION").into(),
        until: args.until.map_or(UNTIL, |goal| goal.0),
        steps: args.steps.unwrap_or(STEPS),
    };
    let trainer = Trainer::new(Box::new(stage.env(config.num_envs, seed)?), config, seed)?;
    let writer = create(args.out.as_deref(), &description, &trainer)?;
    complain(&format!(
        "training {} in {}: {} environments on {} threads",
        stage.task.name,
        writer.folder().path().display(),
        grouped(trainer.spec().num_envs as u64),
        rayon::current_num_threads()
    ));
    let session = Session::new(&stage, trainer, description.until, description.steps);
    conclude(args, &stage, session.recorded_in(writer), interrupt)
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
    let env = Box::new(stage.env(config.num_envs, seed)?);
    let trainer = match newest_checkpoint(&run)? {
        Some(checkpoint) => Trainer::restore(env, &checkpoint)?,
        // Stopped before its first checkpoint: the same seed begins the same run.
        None => Trainer::new(env, config, seed)?,
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
        "going on with {} in {} after {} control steps",
        stage.task.name,
        path.display(),
        grouped(trainer.env_steps())
    ));
    let session = Session::new(&stage, trainer, description.until, description.steps);
    conclude(args, &stage, session.recorded_in(writer), interrupt)
}

/// Trains to the end and tells how it went.
fn conclude(args: &Train, stage: &Stage, session: Session<'_>, interrupt: &Interrupt) -> Result<()> {
    let (seed, until) = (session.seed(), session.until());
    let outcome = session.run(interrupt)?;
    let run = outcome.run.as_deref().unwrap_or(Path::new("")).display().to_string();
    if args.json {
        print_json(&json!({
            "run": run,
            "task": stage.task.name,
            "seed": seed,
            "env_steps": outcome.env_steps,
            "updates": outcome.updates,
            "wall_s": outcome.wall_s,
            "stopped_by": outcome.end.name(),
            "until": until,
            "evaluation": outcome.evaluation,
        }))?;
    } else {
        print(&summary(stage, &outcome, seed, until, &run))?;
    }
    if outcome.end == End::Interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}

fn summary(stage: &Stage, outcome: &Outcome, seed: u64, until: Option<f64>, run: &str) -> String {
    let program = std::env::args().next().unwrap_or_else(|| "myo".into());
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
