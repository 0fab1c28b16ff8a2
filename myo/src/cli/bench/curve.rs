//! `myo bench curve`: how good a simulated user is after so many control steps.

use clap::Args;
use myo::Start;
use myo::train::session::{Examiner, Goal, Until};
use myo::train::{Evaluation, PpoConfig, Session};
use serde::Serialize;
use serde_json::json;

use super::machine::Machine;
use crate::cli::backend::{BackendName, Options};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::interrupt::Interrupt;
use crate::cli::output::{duration, percent, print, print_json, rounded, row, table};
use crate::cli::parse;
use crate::cli::stage::Stage;
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

Time is that of training alone, without opening the device and without these evaluations. No run folders are left.

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
    let config = args.learner.settings(&PpoConfig::default())?;
    if !args.at.is_sorted() {
        return Err(Failure::sentence("the control steps of `--at` must not go down"));
    }
    let stage = Stage::open(&args.task)?;
    let interrupt = Interrupt::listen()?;
    let mut rows = Vec::new();
    for seed in 1..=args.seeds as u64 {
        complain(&format!("{} with seed {seed} of {}", stage.task.name, args.seeds));
        measure(args, &stage, &config, seed, &interrupt, &mut rows)?;
    }
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
    print(&format!("{}, {machine}, {date}, myo {version}\n{}", stage.task.name, table(&cells)))
}

/// Trains one user and evaluates it on its way.
fn measure(
    args: &CurveArgs,
    stage: &Stage,
    config: &PpoConfig,
    seed: u64,
    interrupt: &Interrupt,
    rows: &mut Vec<Row>,
) -> Result<()> {
    let choice = args.physics.choice(BackendName::Cpu)?;
    let env = stage.env(&choice, config.num_envs, seed)?;
    let looks = env.for_looks(&stage.model, &stage.task, seed)?;
    let goal = Goal { until: Until::Off, steps: args.at.last().copied().unwrap_or(0) };
    let Ready { device, mut session, .. } = Ready::new(stage, env, Start::New { config, seed, from: None }, goal)?;
    let mut examiner = looks.examine(session.trainer())?;
    for (&mark, number) in args.at.iter().zip(1..) {
        train_to(&mut session, mark, interrupt)?;
        rows.push(Row {
            backend: device.backend(),
            device: device.card().map(String::from),
            task: stage.task.name.clone(),
            seed,
            env_steps: session.trainer().env_steps(),
            train_s: session.trainer().wall_s(),
            learning_rate: session.trainer().learning_rate(),
            evaluation: evaluate(&mut examiner, &session, args.episodes, number, interrupt)?,
            machine: Machine::here(),
        });
    }
    Ok(())
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

fn evaluate(
    examiner: &mut Examiner,
    session: &Session,
    episodes: usize,
    number: u64,
    interrupt: &Interrupt,
) -> Result<Evaluation> {
    let evaluation = examiner.evaluate(&mut session.trainer().policy(), episodes, number, || !interrupt.wanted())?;
    if interrupt.wanted() { Err(Failure::Interrupted) } else { Ok(evaluation) }
}
