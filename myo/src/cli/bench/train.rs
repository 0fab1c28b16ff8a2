//! `myo bench train`: how long until a new simulated user is good enough.

use std::time::Instant;

use clap::Args;
use myo::tasks::User;
use myo::train::PpoConfig;
use myo::train::session::{End, Goal, Outcome, Until};
use myo::{Backend, Device, Start};
use serde::Serialize;
use serde_json::json;

use super::machine::Machine;
use super::ready_at_once;
use crate::cli::backend::{BackendName, Options};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::interrupt::Interrupt;
use crate::cli::output::{duration, percent, print, print_json, rounded, row, table};
use crate::cli::parse;
use crate::cli::scenario::Scenario;
use crate::cli::train::{LearnerOptions, Ready};

/// Arguments of `myo bench train`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct TrainArgs {
    /// Name of a task, or a task file
    task: String,

    /// Who does it, in place of the task's `user`: `human`, `fastest`, or a person such as `small_woman` (`myo task users`); what the task says of its user stays [default: as the task says]
    #[arg(long, value_name = "USER", value_parser = parse::user)]
    user: Option<User>,

    /// Seeds to train with: 1 to N
    #[arg(long, value_name = "N", default_value = "5", value_parser = parse::positive)]
    seeds: usize,

    /// Train with all seeds at once, on a graphics card
    #[arg(long)]
    at_once: bool,

    /// What to train to: a share of fresh episodes in which the deterministic policy succeeds, or `plateau`
    #[arg(long, value_name = "GOAL", default_value = "0.95")]
    until: Until,

    /// Control steps after which a seed has failed [default: 200M at 20 Hz, 10 million simulated seconds]
    #[arg(long, value_name = "N", value_parser = parse::count)]
    steps: Option<u64>,

    #[command(flatten)]
    learner: LearnerOptions,

    #[command(flatten)]
    physics: Options,

    /// Print the rows as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo bench train pointing-single
  myo bench train ar --seeds 3 --threads 2 --json
  myo bench train ar --seeds 8 --at-once      on a graphics card

Time runs from opening the device, compiling included, to the end of the training and of an evaluation of 1,000 fresh episodes;
looking at the goal is included. Later seeds find the device open and the kernels compiled. With --at-once, the time of each
seed runs from the beginning of all to its own end. No run folders are left.

JSON: `rows` of objects with `backend`, `device` (null on the cpu), `task`, `seed`, `envs`, `threads`, `wall_s`, `env_steps`, `control_steps_per_s`,
`success`, `episode_length_s`, `stopped_by` (`until`, `plateau` or `steps`), `machine`, `date`, `version`; and `reached`, the number of seeds that
reached the goal.";

#[derive(Clone, Debug, Serialize)]
struct Row {
    backend: &'static str,
    device: Option<String>,
    task: String,
    seed: u64,
    envs: usize,
    threads: usize,
    wall_s: f64,
    env_steps: u64,
    control_steps_per_s: f64,
    success: Option<f64>,
    episode_length_s: Option<f64>,
    stopped_by: &'static str,
    #[serde(flatten)]
    machine: Machine,
}

/// Runs `myo bench train`.
pub fn run(args: &TrainArgs) -> Result<()> {
    args.learner.settings(&PpoConfig::default())?;
    let scenario = Scenario::open_for(&args.task, args.user)?;
    let interrupt = Interrupt::listen()?;
    let mut rows = if args.at_once { measure_all(args, &scenario, &interrupt)? } else { Vec::new() };
    for seed in (1..=args.seeds as u64).filter(|_| !args.at_once) {
        complain(&format!("{} with seed {seed} of {}", scenario.task.name, args.seeds));
        rows.push(measure(args, &scenario, seed, &interrupt)?);
    }
    let reached = rows.iter().filter(|row| row.stopped_by != End::Steps.name()).count();
    if args.json {
        return print_json(&json!({"rows": rows, "reached": reached}));
    }
    let mut cells = vec![row(["seed", "time", "control steps", "control steps/s", "success", "episode", "stopped by"])];
    cells.extend(rows.iter().map(|r| {
        row([
            &r.seed.to_string(),
            &duration(r.wall_s),
            &rounded(r.env_steps as f64),
            &rounded(r.control_steps_per_s),
            &r.success.map_or("-".into(), percent),
            &r.episode_length_s.map_or("-".into(), |s| format!("{s:.2} s")),
            r.stopped_by,
        ])
    }));
    let Machine { machine, date, version } = Machine::here();
    let threads = rayon::current_num_threads();
    print(&format!(
        "{}, {machine}, {threads} used, {date}, myo {version}\n{}  {reached} of {} seeds reached the goal\n",
        scenario.task.name,
        table(&cells),
        rows.len()
    ))
}

/// All seeds at once: the time of each runs from the beginning of all to its own end.
fn measure_all(args: &TrainArgs, scenario: &Scenario, interrupt: &Interrupt) -> Result<Vec<Row>> {
    let config = args.learner.settings(&scenario.usual_settings())?;
    let start = Instant::now();
    let all = ready_at_once(scenario, &args.physics, &config, args.seeds, goal(args, scenario))?;
    let Some(device) = all.first().map(|ready| ready.device.clone()) else { return Ok(Vec::new()) };
    let seeds: Vec<u64> = all.iter().map(|ready| ready.session.trainer().seed()).collect();
    let mut rows = Vec::new();
    Ready::run_all(all, interrupt, |index, outcome| {
        let wall_s = start.elapsed().as_secs_f64();
        rows.push(outcome.and_then(|outcome| ended(args, scenario, &device, seeds[index], wall_s, outcome)));
    });
    let mut rows = rows.into_iter().collect::<Result<Vec<_>>>()?;
    rows.sort_by_key(|row| row.seed);
    Ok(rows)
}

fn goal(args: &TrainArgs, scenario: &Scenario) -> Goal {
    let steps = args.steps.unwrap_or_else(|| myo::default_steps(scenario.task.control_dt_s));
    Goal { until: args.until, steps }
}

fn measure(args: &TrainArgs, scenario: &Scenario, seed: u64, interrupt: &Interrupt) -> Result<Row> {
    let config = args.learner.settings(&scenario.usual_settings())?;
    let (backend, goal) = (args.physics.choice(BackendName::Cpu)?, goal(args, scenario));
    let Trained { device, outcome, wall_s } = train_once(scenario, &config, &backend, (seed, goal), interrupt)?;
    ended(args, scenario, &device, seed, wall_s, outcome)
}

/// A training that is over.
pub(super) struct Trained {
    /// What computed it.
    pub device: Device,
    /// How it ended: at its goal, or when its steps were used up.
    pub outcome: Outcome,
    /// Seconds from getting ready to the end of the last evaluation.
    pub wall_s: f64,
}

/// Trains a new user, and leaves nothing behind.
pub(super) fn train_once(
    scenario: &Scenario,
    config: &PpoConfig,
    backend: &Backend,
    (seed, goal): (u64, Goal),
    interrupt: &Interrupt,
) -> Result<Trained> {
    let start = Instant::now();
    let env = scenario.training_env(backend, config, seed)?;
    let ready = Ready::new(scenario, env, Start::New { config, seed, from: None }, goal)?;
    let (device, ready_s) = (ready.device.clone(), start.elapsed().as_secs_f64());
    let outcome = refuse_cut(ready.run(interrupt)?)?;
    Ok(Trained { device, wall_s: ready_s + outcome.wall_s, outcome })
}

/// A training that was cut short has no time.
fn refuse_cut(outcome: Outcome) -> Result<Outcome> {
    match outcome.end {
        End::Interrupted => Err(Failure::Interrupted),
        End::DeviceLost { reason } => Err(Failure::DeviceLost(reason)),
        End::Until | End::Plateau | End::Steps => Ok(outcome),
    }
}

/// What is told of a training that ended after so many seconds.
fn ended(
    args: &TrainArgs,
    scenario: &Scenario,
    device: &Device,
    seed: u64,
    wall_s: f64,
    outcome: Outcome,
) -> Result<Row> {
    let outcome = refuse_cut(outcome)?;
    Ok(Row {
        backend: device.backend(),
        device: device.card().map(String::from),
        task: scenario.task.name.clone(),
        seed,
        envs: args.learner.settings(&scenario.usual_settings())?.num_envs,
        threads: rayon::current_num_threads(),
        wall_s,
        env_steps: outcome.env_steps,
        control_steps_per_s: outcome.env_steps as f64 / wall_s,
        success: outcome.evaluation.as_ref().and_then(|evaluation| evaluation.success),
        episode_length_s: outcome.evaluation.and_then(|evaluation| evaluation.episode_length_s),
        stopped_by: outcome.end.name(),
        machine: Machine::here(),
    })
}
