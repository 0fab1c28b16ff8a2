//! `myo bench env`: random actions, everything included.

use std::time::Instant;

use clap::Args;
use myo::env::{StepStorage, VectorEnv};
use myo::scalar::Level;
use serde::Serialize;
use serde_json::json;

use super::best_and_median;
use super::machine::Machine;
use super::random::Random;
use crate::cli::failure::{Result, complain};
use crate::cli::output::{print, print_json, rounded, row, table};
use crate::cli::parse;
use crate::cli::stage::Stage;

/// Measurements.
const REPEATS: usize = 7;
/// Time (s) of one measurement at least.
const LEAST_S: f64 = 0.3;
/// Control steps before the first measurement.
const WARM_UP: usize = 10;

/// Arguments of `myo bench env`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Env {
    /// Name of a task, or a task file
    #[arg(long, default_value = "pointing")]
    task: String,

    /// Environments side by side, separated by commas
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "64,1024,16384", value_parser = parse::positive)]
    envs: Vec<usize>,

    /// Print the rows as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo bench env
  myo bench env --task ar --envs 1024,4096 --threads 1

Actions are random; drawing them is not timed. Rates are those of the best of 7 measurements; `median` is the middle one.

JSON: `rows` of objects with `backend`, `level`, `task`, `envs`, `threads`, `physics_steps_per_s`, `control_steps_per_s`,
`control_steps_per_s_median`, `machine`, `date`, `version`.";

#[derive(Clone, Debug, Serialize)]
struct Row {
    backend: &'static str,
    level: &'static str,
    task: String,
    envs: usize,
    threads: usize,
    physics_steps_per_s: f64,
    control_steps_per_s: f64,
    control_steps_per_s_median: f64,
    #[serde(flatten)]
    machine: Machine,
}

/// Runs `myo bench env`.
pub fn run(args: &Env) -> Result<()> {
    let stage = Stage::open(&args.task)?;
    let rows = args.envs.iter().map(|&envs| measure(&stage, envs)).collect::<Result<Vec<_>>>()?;
    if args.json {
        return print_json(&json!({ "rows": rows }));
    }
    let mut cells = vec![row(["backend", "level", "envs", "threads", "control steps/s", "median", "physics steps/s"])];
    cells.extend(rows.iter().map(|r| {
        row([
            r.backend,
            r.level,
            &r.envs.to_string(),
            &r.threads.to_string(),
            &rounded(r.control_steps_per_s),
            &rounded(r.control_steps_per_s_median),
            &rounded(r.physics_steps_per_s),
        ])
    }));
    let Machine { machine, date, version } = Machine::here();
    print(&format!("{}, {machine}, {date}, myo {version}\n{}", stage.task.name, table(&cells)))
}

fn measure(stage: &Stage, envs: usize) -> Result<Row> {
    complain(&format!("measuring {envs} environments"));
    let mut env = stage.env(envs, 1)?;
    let mut out = StepStorage::new(env.spec());
    let mut actions = vec![0.0; envs * env.spec().action_size()];
    let mut random = Random(1);
    let mut step = || -> Result<f64> {
        random.fill_signed(&mut actions);
        let start = Instant::now();
        env.step(&actions, out.buffers())?;
        Ok(start.elapsed().as_secs_f64())
    };
    for _ in 0..WARM_UP {
        step()?;
    }
    let mut per_step = Vec::new();
    for _ in 0..REPEATS {
        let (mut seconds, mut steps) = (0.0, 0);
        while seconds < LEAST_S {
            seconds += step()?;
            steps += 1;
        }
        per_step.push(seconds / f64::from(steps));
    }
    let (best, median) = best_and_median(per_step);
    let substeps = stage.task.substeps(stage.model.options.timestep);
    Ok(Row {
        backend: "cpu",
        level: Level::detect().name(),
        task: stage.task.name.clone(),
        envs,
        threads: rayon::current_num_threads(),
        physics_steps_per_s: f64::from(substeps) * envs as f64 / best,
        control_steps_per_s: envs as f64 / best,
        control_steps_per_s_median: envs as f64 / median,
        machine: Machine::here(),
    })
}
