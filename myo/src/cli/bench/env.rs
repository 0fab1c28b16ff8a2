//! `myo bench env`: random actions, everything included.

use std::time::Instant;

use clap::Args;
use myo::Device;
use myo::env::{BuildError, CpuEnv, EnvConfig};
use myo::gpu::Gpu;
use myo::scalar::Level;
use myo::scalar::symbolic::Form;
use serde::Serialize;
use serde_json::json;

use super::env_gpu::{self, Measurement, StepPart};
use super::machine::Machine;
use super::speed::through_host;
use crate::cli::backend::{BackendName, Options, device};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::output::{print, print_json, rounded, row, table};
use crate::cli::parse;
use crate::cli::scenario::Scenario;

/// Arguments of `myo bench env`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct EnvArgs {
    /// Name of a task, or a task file
    #[arg(long, default_value = "pointing-uitb")]
    task: String,

    /// Environments side by side, separated by commas
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "64,1024,16384", value_parser = parse::positive)]
    envs: Vec<usize>,

    /// Layouts in one batch, each environment with numbers of its own
    #[arg(long, value_name = "N", default_value = "1", value_parser = parse::positive)]
    layouts: usize,

    #[command(flatten)]
    physics: Options,

    /// Parts to measure, separated by commas; more than `env` only on a graphics card
    #[arg(long, value_enum, value_name = "PART,...", value_delimiter = ',', default_value = "env")]
    part: Vec<StepPart>,

    /// Loops over the tables of the body in the kernel, as too large bodies have them; only on a graphics card
    #[arg(long)]
    loops: bool,

    /// Print the rows as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo bench env
  myo bench env --task ar --envs 1024,4096 --threads 1
  myo bench env --backend gpu --envs 1024,16384,262144 --part env,physics
  myo bench env --envs 4096 --layouts 256

Actions are random; drawing them is not timed. Rates are those of the best of 7 measurements; `median` is the middle one.

On a graphics card the actions are drawn once, and many steps run in a row before one wait; with `--part host` every step
takes actions from the host and brings observations back, as `myo eval` and users of the library need it. The physics alone holds
random excitations and has no episodes. `ready_s` is the time
until the kernel could run: opening the card, recording, compiling. `kernel_cache` is `warm` if the compiled kernel was
found on disk, `cold` if it was compiled and kept, `none` if the driver keeps nothing (null: not known). For a cold start
let MYO_CACHE_DIR name an empty folder; drivers may have a cache of their own.

JSON: `rows` of objects with `backend`, `task`, `envs`, `layouts`, `physics_steps_per_s`, `control_steps_per_s`,
`control_steps_per_s_median`, `machine`, `date`, `version`; on the cpu also `level` (`compiled`: machine code made for the task) and `threads`, on the gpu `device`,
`driver`, `part`, `form` (`straight`, `paths` with loops over bent paths, or `loops`), `ready_s`, `kernel_cache`.";

#[derive(Clone, Debug, Serialize)]
struct Row {
    backend: &'static str,
    level: &'static str,
    task: String,
    envs: usize,
    layouts: usize,
    threads: usize,
    physics_steps_per_s: f64,
    control_steps_per_s: f64,
    control_steps_per_s_median: f64,
    #[serde(flatten)]
    machine: Machine,
}

/// Runs `myo bench env`.
pub fn run(args: &EnvArgs) -> Result<()> {
    let scenario = Scenario::open(&args.task)?;
    let most = args.envs.iter().copied().max().unwrap_or(1);
    let start = Instant::now();
    match device(&args.physics.choice(BackendName::Cpu)?, most)? {
        Device::Gpu(gpu) => on_gpu(args, &scenario, &gpu, start.elapsed().as_secs_f64()),
        Device::Cpu if args.part != [StepPart::Env] || args.loops => Err(Failure::sentence(
            "on the cpu there is only `--part env`, without `--loops`; `myo bench physics` measures the physics alone",
        )),
        Device::Cpu => on_cpu(args, &scenario),
    }
}

fn on_cpu(args: &EnvArgs, scenario: &Scenario) -> Result<()> {
    let codes = [Some(true), Some(false)];
    let each = args.envs.iter().flat_map(|&envs| codes.map(|native| (envs, native)));
    let measured = each.map(|(num_envs, native)| {
        measure(scenario, &EnvConfig { num_envs, native, seed: 1, ..EnvConfig::default() }, args.layouts)
    });
    let rows: Vec<Row> = measured.collect::<Result<Vec<_>>>()?.into_iter().flatten().collect();
    let cells = rows.iter().map(|r| {
        row([
            r.backend,
            r.level,
            &r.envs.to_string(),
            &r.threads.to_string(),
            &rounded(r.control_steps_per_s),
            &rounded(r.control_steps_per_s_median),
            &rounded(r.physics_steps_per_s),
        ])
    });
    let headings = row(["backend", "level", "envs", "threads", "control steps/s", "median", "physics steps/s"]);
    show(args, scenario, &rows, [headings].into_iter().chain(cells).collect())
}

fn on_gpu(args: &EnvArgs, scenario: &Scenario, gpu: &Gpu, open_s: f64) -> Result<()> {
    let measurement =
        Measurement { scenario, gpu, open_s, layouts: args.layouts, form: args.loops.then_some(Form::Loops) };
    let each = args.envs.iter().map(|&envs| measurement.run(envs, &args.part));
    let rows = each.collect::<Result<Vec<_>>>()?.concat();
    let cells = rows.iter().map(env_gpu::Row::cells);
    show(args, scenario, &rows, [row(env_gpu::HEADINGS)].into_iter().chain(cells).collect())
}

fn show(args: &EnvArgs, scenario: &Scenario, rows: &[impl Serialize], cells: Vec<Vec<String>>) -> Result<()> {
    if args.json {
        return print_json(&json!({ "rows": rows }));
    }
    let Machine { machine, date, version } = Machine::here();
    print(&format!("{}, {machine}, {date}, myo {version}\n{}", scenario.task.name, table(&cells)))
}

/// None where machine code is asked for and there can be none.
fn measure(scenario: &Scenario, config: &EnvConfig, layouts: usize) -> Result<Option<Row>> {
    let (envs, layouts_of) = (config.num_envs, vec![scenario.task.clone(); layouts]);
    let mut env = match CpuEnv::with_layouts(&scenario.model, &layouts_of, config) {
        Err(BuildError::NotCompiled(reason)) => {
            complain(&format!("without machine code: {reason}"));
            return Ok(None);
        }
        env => env?,
    };
    let level = if env.is_native() { "compiled" } else { Level::current().name() };
    complain(&format!("measuring {envs} environments with {level}"));
    let (best, median) = through_host(&mut env)?;
    let substeps = scenario.task.substeps(scenario.model.options.timestep);
    Ok(Some(Row {
        backend: "cpu",
        level,
        task: scenario.task.name.clone(),
        envs,
        layouts,
        threads: rayon::current_num_threads(),
        physics_steps_per_s: f64::from(substeps) * envs as f64 / best,
        control_steps_per_s: envs as f64 / best,
        control_steps_per_s_median: envs as f64 / median,
        machine: Machine::here(),
    }))
}
