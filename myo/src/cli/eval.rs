//! `myo eval`: how well a trained policy does.

use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use myo::Envs;
use myo::train::gpu::DeviceEvaluator;
use myo::train::session::evaluation_seed;
use myo::train::{Evaluation, RunFolder, evaluate};
use serde::Serialize;

use super::backend::{Backend, Options, sentence};
use super::failure::{Failure, Result};
use super::interrupt::Interrupt;
use super::output::{print, print_json, rounded};
use super::run_config::{Description, existing_checkpoint};
use super::stage::Stage;
use super::{parse, report};

/// Most environments side by side.
const ENVS: usize = 1024;

/// Arguments of `myo eval`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Eval {
    /// Run folder
    run: PathBuf,

    /// Fresh episodes
    #[arg(long, value_name = "N", default_value = "1000", value_parser = parse::count)]
    episodes: u64,

    /// Seed of the episodes [default: one made from that of the training, never the same]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    #[command(flatten)]
    physics: Options,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo eval runs/pointing-1
  myo eval runs/pointing-1 --episodes 10000 --seed 3 --json

The deterministic policy of the newest checkpoint acts; if that file is damaged, the one before it.

JSON: `success` (share of episodes with every target done), `success_interval` (95 %), `episodes`, `targets`, a list with
`success`, `movement_time_s` and `movement_time_s_sd` each, `final_distance_m`, `effort`, `episode_length_s`, `return`;
and `run`, `task`, `env_steps` (control steps that the policy was trained for), `seed`, `backend` (`cpu` or `gpu`) and
`device` (its name). What does not exist is null. Backends agree to rounding, not to the bit.";

/// What `--json` prints.
#[derive(Serialize)]
struct Results<'a> {
    #[serde(flatten)]
    evaluation: &'a Evaluation,
    run: String,
    task: &'a str,
    env_steps: u64,
    seed: u64,
    backend: &'a str,
    device: Option<&'a str>,
}

/// Runs `myo eval`.
pub fn run(args: &Eval) -> Result<()> {
    let folder = RunFolder::open(&args.run)?;
    let stage = Stage::of(&Description::of(&folder)?)?;
    let checkpoint = existing_checkpoint(&folder)?;
    let interrupt = Interrupt::listen()?;
    let seed = args.seed.unwrap_or_else(|| evaluation_seed(checkpoint.seed(), 0));
    let episodes = usize::try_from(args.episodes)?;
    let env = stage.env(&args.physics.wish(Backend::Auto)?, episodes.min(ENVS), seed)?;
    let (place, mut policy, bar) = (env.place(), checkpoint.policy(), bar(args.episodes));
    let progress = |counted: usize| {
        bar.set_position(counted as u64);
        !interrupt.wanted()
    };
    let evaluation = match env {
        Envs::Cpu(mut env) => evaluate(&mut policy, env.as_mut(), episodes, seed, progress)?,
        Envs::Gpu(env) => DeviceEvaluator::new(*env, &policy)?.evaluate(&policy, episodes, seed, progress)?,
    };
    bar.finish_and_clear();
    // What was counted before an interrupt over-represents short episodes.
    if interrupt.wanted() {
        return Err(Failure::Interrupted);
    }
    let task = &stage.task.name;
    if args.json {
        let (run, env_steps) = (args.run.display().to_string(), checkpoint.env_steps());
        let (backend, device) = (place.backend(), place.device());
        return print_json(&Results { evaluation: &evaluation, run, task, env_steps, seed, backend, device });
    }
    let trained = rounded(checkpoint.env_steps() as f64);
    print(&format!(
        "{}  trained         {trained} control steps\n  evaluated       on {}\n",
        report::evaluation(task, &evaluation),
        sentence(&place)
    ))
}

fn bar(episodes: u64) -> ProgressBar {
    let target =
        if std::io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{bar:20} {pos} of {len} episodes, {eta} left");
    ProgressBar::with_draw_target(Some(episodes), target)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
