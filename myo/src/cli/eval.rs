//! `myo eval`: how well a trained policy does.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use myo::env::EnvSpec;
use myo::train::gpu::DeviceEvaluator;
use myo::train::session::{Trend, evaluation_seed};
use myo::train::{Checkpoint, Evaluation, Policy, RunFolder, evaluate};
use myo::{Envs, RunDescription};
use serde::Serialize;

use super::backend::{BackendName, Options, sentence};
use super::failure::{Failure, Result, complain};
use super::interrupt::Interrupt;
use super::output::{name, print, print_json, rounded};
use super::run_folder::existing_checkpoint;
use super::stage::Stage;
use super::train::open_run;
use super::{parse, report};

/// Most environments that run side by side.
const ENVS: usize = 1024;

/// Arguments of `myo eval`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Eval {
    /// Run folder
    run: PathBuf,

    /// Another task to try the policy on, by name or file: observations and actions are matched by name
    #[arg(long, value_name = "TASK")]
    task: Option<String>,

    /// Checkpoint to evaluate: a file, or the control steps in the name of one in the run folder [default: the newest]
    #[arg(long, value_name = "FILE|STEPS")]
    checkpoint: Option<String>,

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
  myo eval runs/pointing-1 --task ar                        does what was learned carry over?
  myo eval runs/pointing-1 --checkpoint 1638400

Evaluates the deterministic policy of the newest checkpoint, or of the one before it if that file is damaged. With --task,
observations that the policy was not trained with do not influence it; a body with muscles that it does not know is refused.

Movement time is from the start of a target (the end of the one before, or the reset) to the last entry into it or the touch of
a button: without dwell, to one physics step. With dwell it is the time to the end of the target.

JSON: `success` (share of episodes with every target done), `episodes`, `targets`, a list with `success`, `movement_time_s`
and `time_s` (with dwell) each, `final_distance_m`, `effort`, `episode_length_s`, `return`; each of these but `episodes` also
with `_interval` behind its name, a list of the two ends of its 95 % confidence interval (Wilson's for shares, Student's for
means), and times of targets with `_sd` (standard deviation); and `run`, `task`, `trained_task`, `env_steps` (control steps that the policy was
trained for), `trend` (what the last doubling of them brought and more would, as `myo train --json` tells), `seed`, `backend` (`cpu` or `gpu`) and
`device` (its name). Values that do not exist are null. Backends agree up to rounding, not bit for bit.";

/// What `--json` prints.
#[derive(Serialize)]
struct Results<'a> {
    #[serde(flatten)]
    evaluation: &'a Evaluation,
    run: String,
    task: &'a str,
    trained_task: &'a str,
    env_steps: u64,
    trend: Option<Trend>,
    seed: u64,
    backend: &'a str,
    device: Option<&'a str>,
}

/// Runs `myo eval`.
pub fn run(args: &Eval) -> Result<()> {
    let folder = open_run(&args.run)?;
    let trained = RunDescription::of(&folder)?;
    let stage = args.task.as_deref().map_or_else(|| Stage::of(&trained), Stage::open)?;
    let checkpoint = match &args.checkpoint {
        Some(which) => checkpoint(&folder, which)?,
        None => existing_checkpoint(&folder)?,
    };
    let interrupt = Interrupt::listen()?;
    let seed = args.seed.unwrap_or_else(|| evaluation_seed(checkpoint.seed(), 0));
    let episodes = usize::try_from(args.episodes)?;
    let mut env = stage.env(&args.physics.choice(BackendName::Auto)?, episodes.min(ENVS), seed)?;
    let mut policy = match args.task {
        Some(_) => policy_for(&checkpoint.policy(), env.as_env().spec())?,
        None => checkpoint.policy(),
    };
    let (device, bar) = (env.device(), bar(args.episodes));
    let progress = |counted: usize| {
        bar.set_position(counted as u64);
        !interrupt.wanted()
    };
    let evaluation = match env {
        Envs::Cpu(mut env) => evaluate(&mut policy, env.as_mut(), episodes, seed, progress)?,
        Envs::Gpu(env) => DeviceEvaluator::new(*env, &policy)?.evaluate(&policy, episodes, seed, progress)?,
    };
    bar.finish_and_clear();
    // Episodes that ended before an interrupt are too often short ones.
    if interrupt.wanted() {
        return Err(Failure::Interrupted);
    }
    let (task, trained_task) = (&stage.task.name, &trained.task.name);
    if args.json {
        let (run, env_steps, trend) = (args.run.display().to_string(), checkpoint.env_steps(), checkpoint.trend());
        let (backend, device) = (device.backend(), device.card());
        let evaluation = &evaluation;
        return print_json(&Results { evaluation, run, task, trained_task, env_steps, trend, seed, backend, device });
    }
    let steps = rounded(checkpoint.env_steps() as f64);
    let elsewhere = if args.task.is_some() { format!(" on {}", name(trained_task)) } else { String::new() };
    print(&format!(
        "{}{}  trained         {steps} control steps{elsewhere}\n  evaluated       on {}\n",
        report::evaluation(&stage.task, &evaluation),
        report::practice(checkpoint.trend()),
        sentence(&device)
    ))
}

/// The checkpoint in a file, or of so many control steps in the run folder.
fn checkpoint(run: &RunFolder, which: &str) -> Result<Checkpoint> {
    let file = Path::new(which);
    let path = match which.parse().or_else(|_| parse::count(which)) {
        Ok(steps) if !file.exists() => checkpoint_of(run, steps)?,
        _ => file.to_owned(),
    };
    Checkpoint::read(&path)
        .map_err(|error| Failure::sentence(format!("cannot use the checkpoint {}: {error}", path.display())))
}

fn checkpoint_of(run: &RunFolder, steps: u64) -> Result<PathBuf> {
    let steps_of = |path: &Path| path.file_stem()?.to_str()?.strip_prefix("step_")?.parse::<u64>().ok();
    let files = run.checkpoints()?;
    if let Some(file) = files.iter().find(|path| steps_of(path) == Some(steps)) {
        return Ok(file.clone());
    }
    let there: Vec<String> =
        files.iter().rev().filter_map(|path| steps_of(path).map(|steps| steps.to_string())).collect();
    let there =
        if there.is_empty() { "it has none yet".into() } else { format!("it has those of {}", there.join(", ")) };
    Err(Failure::sentence(format!("{} has no checkpoint of {steps} control steps; {there}", run.path().display())))
}

/// The policy for another environment; tells the user where its observations differ.
fn policy_for(policy: &Policy, spec: &EnvSpec) -> Result<Policy> {
    let (trained, own) = (policy.observation_names(), &spec.observation_names[..]);
    let missing = |from: &[String], to: &[String]| -> Vec<String> {
        from.iter().filter(|observation| !to.contains(observation)).map(|observation| name(observation)).collect()
    };
    let differences =
        [(missing(own, trained), "does not know and does not use"), (missing(trained, own), "knows and does not get")];
    for (names, what) in differences {
        if !names.is_empty() {
            complain(&format!("{} observations that the policy {what}: {}", names.len(), names.join(", ")));
        }
    }
    Ok(policy.for_environment(spec)?)
}

fn bar(episodes: u64) -> ProgressBar {
    let target =
        if std::io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{bar:20} {pos} of {len} episodes, {eta} left");
    ProgressBar::with_draw_target(Some(episodes), target)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
