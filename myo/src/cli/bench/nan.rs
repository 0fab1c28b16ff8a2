//! `myo bench nan`: is there any number that is not finite?

use std::time::Instant;

use clap::Args;
use myo::env::{StepStorage, VectorEnv};
use rayon::prelude::*;
use serde_json::json;

use super::machine::Machine;
use super::random::Random;
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::output::{duration, grouped, print, print_json, rounded};
use crate::cli::parse;
use crate::cli::stage::Stage;

/// An environment keeps its action with this probability in each step: muscles also see long pulls.
const HOLD: f32 = 0.7;
/// Share of new actions that are full or no excitation, muscle by muscle.
const EXTREME: f32 = 0.5;
/// Every so many steps a tenth of the environments is reset in the middle of an episode.
const RESET_EVERY: u64 = 37;

/// Arguments of `myo bench nan`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Nan {
    /// Name of a task, or a task file
    #[arg(long, default_value = "ar")]
    task: String,

    /// Control steps of all environments
    #[arg(long, value_name = "N", default_value = "100M", value_parser = parse::count)]
    steps: u64,

    /// Environments side by side
    #[arg(long, value_name = "N", default_value = "4096", value_parser = parse::positive)]
    envs: usize,

    /// Seed of environments and actions
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo bench nan
  myo bench nan --task pointing --steps 1M --seed 7

Actions are uniform or at their bounds and held for some steps; episodes end at their limit or are reset at random.
Exit status 1 if an observation or a reward was NaN or infinite.

JSON: `control_steps`, `resets`, `non_finite` (rows of an observation or reward that were not finite), `first` (null, or
an object with `env`, `step`, `what`), `task`, `seed`, `envs`, `wall_s`, `machine`, `date`, `version`.";

/// Where the first number that is not finite was.
struct First {
    env: usize,
    step: u64,
    what: String,
}

/// Runs `myo bench nan`.
pub fn run(args: &Nan) -> Result<()> {
    let stage = Stage::open(&args.task)?;
    let mut env = stage.env(args.envs, args.seed)?;
    let spec = env.spec().clone();
    let (width, actors) = (spec.observation_size(), spec.action_size());
    let mut out = StepStorage::new(&spec);
    let mut actions = vec![0.0; args.envs * actors];
    let mut random: Vec<Random> = (0..args.envs).map(|i| Random((args.seed << 32) + i as u64)).collect();
    let (mut bad, mut resets, mut first) = (0, 0, None);
    let steps = args.steps.div_ceil(args.envs as u64);
    let (start, mut told) = (Instant::now(), Instant::now());
    env.reset(Some(args.seed), None, &mut out.observation)?;
    for step in 0..steps {
        actions.par_chunks_mut(actors).zip(&mut random).for_each(|(action, random)| draw(action, random));
        env.step(&actions, out.buffers())?;
        resets += out.terminated.iter().zip(&out.truncated).filter(|(done, late)| **done || **late).count();
        for (i, (observation, reward)) in out.observation.chunks_exact(width).zip(&out.reward).enumerate() {
            if reward.is_finite() && observation.iter().all(|x| x.is_finite()) {
                continue;
            }
            bad += 1;
            let entry = observation.iter().position(|x| !x.is_finite());
            let what = entry.map_or("reward".into(), |entry| spec.observation_names[entry].clone());
            first.get_or_insert(First { env: i, step, what });
        }
        if step % RESET_EVERY == RESET_EVERY - 1 {
            let mask: Vec<bool> = random.iter_mut().map(|random| random.unit() < 0.1).collect();
            resets += mask.iter().filter(|reset| **reset).count();
            env.reset(None, Some(&mask), &mut out.observation)?;
        }
        if told.elapsed().as_secs() >= 10 {
            told = Instant::now();
            complain(&format!(
                "{} of {} control steps",
                rounded((step * args.envs as u64) as f64),
                rounded(args.steps as f64)
            ));
        }
    }
    show(args, &stage, (steps * args.envs as u64, resets, bad), first.as_ref(), start.elapsed().as_secs_f64())
}

fn draw(action: &mut [f32], random: &mut Random) {
    if random.unit() < HOLD {
        return;
    }
    let extreme = random.unit() < EXTREME;
    random.fill_signed(action);
    if extreme {
        action.iter_mut().for_each(|x| *x = x.signum());
    }
}

fn show(
    args: &Nan,
    stage: &Stage,
    (control_steps, resets, bad): (u64, usize, u64),
    first: Option<&First>,
    wall_s: f64,
) -> Result<()> {
    let task = &stage.task.name;
    let Machine { machine, date, version } = Machine::here();
    if args.json {
        print_json(&json!({
            "control_steps": control_steps,
            "resets": resets,
            "non_finite": bad,
            "first": first.map(|first| json!({"env": first.env, "step": first.step, "what": first.what})),
            "task": task, "seed": args.seed, "envs": args.envs, "wall_s": wall_s,
            "machine": machine, "date": date, "version": version,
        }))?;
    } else {
        print(&format!(
            "{task}: {} control steps of random actions, {} resets, {} not finite ({}, seed {}, {machine}, {date}, myo {version})\n",
            grouped(control_steps),
            grouped(resets as u64),
            grouped(bad),
            duration(wall_s),
            args.seed,
        ))?;
    }
    match first {
        None => Ok(()),
        Some(First { env, step, what }) => Err(Failure::sentence(format!(
            "{what} of environment {env} was not finite in step {step}; the same again: myo bench nan --task {} --envs {} \
             --seed {}",
            args.task, args.envs, args.seed
        ))),
    }
}
