//! `myo bench curve`: how good a simulated user is after so many control steps.

use std::panic::resume_unwind;

use clap::Args;
use myo::Start;
use myo::train::session::{Goal, Until};
use myo::train::{Evaluation, PpoConfig, Session};
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

/// Arguments of `myo bench curve`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct CurveArgs {
    /// Name of a task, or a task file
    task: String,

    /// Control steps after which the user is evaluated, in order
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "6.25M,12.5M,25M,50M,100M", value_parser = parse::count)]
    at: Vec<u64>,

    /// Seeds to train with: 1 to N
    #[arg(long, value_name = "N", default_value = "1", value_parser = parse::positive)]
    seeds: usize,

    /// Train with all seeds at once, on a graphics card
    #[arg(long)]
    at_once: bool,

    /// Episodes of each evaluation
    #[arg(long, value_name = "N", default_value = "4096", value_parser = parse::positive)]
    episodes: usize,

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
  myo bench curve pointing --at 5M,10M
  myo bench curve ar --seeds 3 --json
  myo bench curve ar --seeds 8 --at-once      on a graphics card

Time is that of training alone, without opening the device and without these evaluations; with --at-once, of all together. No run folders are left.

JSON: `rows` of objects with `backend`, `device` (null on the cpu), `task`, `seed`, `env_steps`, `train_s`, `learning_rate`,
`evaluation` (as `myo eval --json`), `machine`, `date`, `version`.";

#[derive(Clone, Debug, Serialize)]
struct Row {
    backend: &'static str,
    device: Option<String>,
    task: String,
    seed: u64,
    env_steps: u64,
    train_s: f64,
    learning_rate: f64,
    evaluation: Evaluation,
    #[serde(flatten)]
    machine: Machine,
}

/// Runs `myo bench curve`.
pub fn run(args: &CurveArgs) -> Result<()> {
    if !args.at.is_sorted() {
        return Err(Failure::sentence("the control steps of `--at` must not go down"));
    }
    let scenario = Scenario::open(&args.task)?;
    let config = args.learner.settings(&scenario.usual_settings())?;
    let interrupt = Interrupt::listen()?;
    let rows = if args.at_once {
        measure_all(args, &scenario, &config, &interrupt)?
    } else {
        let mut rows = Vec::new();
        for seed in 1..=args.seeds as u64 {
            complain(&format!("{} with seed {seed} of {}", scenario.task.name, args.seeds));
            rows.extend(measure(args, &scenario, &config, seed, &interrupt)?);
        }
        rows
    };
    if args.json {
        return print_json(&json!({"rows": rows}));
    }
    let mut cells = vec![row(["seed", "control steps", "time", "success", "episode", "return"])];
    cells.extend(rows.iter().map(|r| {
        let number = |x: Option<f64>, unit: &str| x.map_or("-".into(), |x| format!("{x:.3}{unit}"));
        row([
            &r.seed.to_string(),
            &rounded(r.env_steps as f64),
            &duration(r.train_s),
            &r.evaluation.success.map_or("-".into(), percent),
            &number(r.evaluation.episode_length_s, " s"),
            &number(r.evaluation.episode_return, ""),
        ])
    }));
    let Machine { machine, date, version } = Machine::here();
    print(&format!("{}, {machine}, {date}, myo {version}\n{}", scenario.task.name, table(&cells)))
}

/// Trains one user and evaluates it on its way.
fn measure(
    args: &CurveArgs,
    scenario: &Scenario,
    config: &PpoConfig,
    seed: u64,
    interrupt: &Interrupt,
) -> Result<Vec<Row>> {
    let env = scenario.training_env(&args.physics.choice(BackendName::Cpu)?, config, seed)?;
    follow(args, Ready::new(scenario, env, Start::New { config, seed, from: None }, goal(args))?, interrupt)
}

/// The same of all seeds at once.
fn measure_all(args: &CurveArgs, scenario: &Scenario, config: &PpoConfig, interrupt: &Interrupt) -> Result<Vec<Row>> {
    let all = ready_at_once(scenario, &args.physics, config, args.seeds, goal(args))?;
    std::thread::scope(|scope| {
        let follow = |ready| scope.spawn(|| follow(args, ready, interrupt));
        let threads: Vec<_> = all.into_iter().map(follow).collect();
        let rows = threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
        Ok(rows.collect::<Result<Vec<_>>>()?.concat())
    })
}

fn goal(args: &CurveArgs) -> Goal {
    Goal { until: Until::Off, steps: args.at.last().copied().unwrap_or(0) }
}

/// A training to its end, with evaluations on its way.
fn follow(args: &CurveArgs, ready: Ready<'_>, interrupt: &Interrupt) -> Result<Vec<Row>> {
    let Ready { scenario, device, mut session, .. } = ready;
    let mut rows = Vec::new();
    for (&mark, number) in args.at.iter().zip(1..) {
        train_to(&mut session, mark, interrupt)?;
        let evaluation = session.measure(args.episodes, number, &|| !interrupt.wanted())?;
        let trainer = session.trainer();
        rows.push(Row {
            backend: device.backend(),
            device: device.card().map(String::from),
            task: scenario.task.name.clone(),
            seed: trainer.seed(),
            env_steps: trainer.env_steps(),
            train_s: trainer.wall_s(),
            learning_rate: trainer.learning_rate(),
            evaluation: evaluation.ok_or(Failure::Interrupted)?,
            machine: Machine::here(),
        });
    }
    Ok(rows)
}

fn train_to(session: &mut Session, env_steps: u64, interrupt: &Interrupt) -> Result<()> {
    while session.trainer().env_steps() < env_steps {
        session.advance(&|| !interrupt.wanted())?;
        if interrupt.wanted() {
            return Err(Failure::Interrupted);
        }
    }
    Ok(())
}
