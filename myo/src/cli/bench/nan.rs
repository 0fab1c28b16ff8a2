//! `myo bench nan`: is there any number that is not finite?

use std::time::Instant;

use clap::Args;
use myo::Device;
use myo::env::{EnvSpec, StepStorage};
use rayon::prelude::*;
use serde_json::json;

use super::machine::Machine;
use super::random::Random;
use crate::cli::backend::{BackendName, Options, sentence};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::output::{duration, grouped, print, print_json, rounded};
use crate::cli::parse;
use crate::cli::scenario::Scenario;

/// An environment keeps its action with this probability in each step: muscles also see long pulls.
const HOLD: f32 = 0.7;
/// Share of new actions that are full or no excitation, muscle by muscle.
const EXTREME: f32 = 0.5;
/// Every so many steps a tenth of the environments is reset in the middle of an episode.
const RESET_EVERY: u64 = 37;

/// Arguments of `myo bench nan`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct NanArgs {
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

    #[command(flatten)]
    physics: Options,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo bench nan
  myo bench nan --task pointing-uitb --steps 1M --seed 7

Actions are uniform or at their bounds and held for some steps; episodes end at their limit or are reset at random.
Exit status 1 if an observation or a reward was NaN or infinite.

JSON: `control_steps`, `resets`, `non_finite` (rows of an observation or reward that were not finite), `first` (null, or
an object with `env`, `step`, `what`), `backend`, `device`, `task`, `seed`, `envs`, `wall_s`, `machine`, `date`, `version`.";

/// What was found so far.
#[derive(Default)]
struct Findings {
    /// Control steps of all environments.
    control_steps: u64,
    /// Episodes that ended or were broken off.
    resets: usize,
    /// Rows that were not finite.
    bad: u64,
    /// The first of them.
    first: Option<First>,
}

/// Where the first number that is not finite was.
struct First {
    env: usize,
    step: u64,
    what: String,
}

/// Runs `myo bench nan`.
pub fn run(args: &NanArgs) -> Result<()> {
    let scenario = Scenario::open(&args.task)?;
    let mut env = scenario.env(&args.physics.choice(BackendName::Cpu)?, args.envs, args.seed)?;
    let device = env.device();
    let env = env.as_env();
    let spec = env.spec().clone();
    let mut out = StepStorage::new(&spec);
    let mut actions = vec![0.0; args.envs * spec.action_size()];
    let mut random: Vec<Random> = (0..args.envs).map(|i| Random((args.seed << 32) + i as u64)).collect();
    let mut found = Findings::default();
    let (start, mut told) = (Instant::now(), Instant::now());
    env.reset(Some(args.seed), None, &mut out.observation)?;
    for step in 0..args.steps.div_ceil(args.envs as u64) {
        let rows = actions.par_chunks_mut(spec.action_size()).zip(&mut random);
        rows.for_each(|(action, random)| draw(action, random));
        env.step(&actions, out.buffers())?;
        found.look(step, &spec, &out);
        if step % RESET_EVERY == RESET_EVERY - 1 {
            let mask: Vec<bool> = random.iter_mut().map(|random| random.unit() < 0.1).collect();
            found.resets += mask.iter().filter(|reset| **reset).count();
            env.reset(None, Some(&mask), &mut out.observation)?;
        }
        if told.elapsed().as_secs() >= 10 {
            told = Instant::now();
            let [done, all] = [found.control_steps, args.steps].map(|steps| rounded(steps as f64));
            complain(&format!("{done} of {all} control steps"));
        }
    }
    show(args, &scenario, &device, &found, start.elapsed().as_secs_f64())
}

impl Findings {
    /// Takes in one step of all environments.
    fn look(&mut self, step: u64, spec: &EnvSpec, out: &StepStorage) {
        self.control_steps += spec.num_envs as u64;
        self.resets += out.terminated.iter().zip(&out.truncated).filter(|(done, late)| **done || **late).count();
        let rows = out.observation.chunks_exact(spec.observation_size()).zip(&out.reward);
        for (env, (observation, reward)) in rows.enumerate() {
            let entry = observation.iter().position(|x| !x.is_finite());
            if entry.is_none() && reward.is_finite() {
                continue;
            }
            self.bad += 1;
            let what = || entry.map_or("the reward".into(), |entry| spec.observation_names[entry].clone());
            self.first.get_or_insert_with(|| First { env, step, what: what() });
        }
    }
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

fn show(args: &NanArgs, scenario: &Scenario, device: &Device, found: &Findings, wall_s: f64) -> Result<()> {
    let task = &scenario.task.name;
    let Machine { machine, date, version } = Machine::here();
    if args.json {
        print_json(&json!({
            "control_steps": found.control_steps,
            "resets": found.resets,
            "non_finite": found.bad,
            "first": found.first.as_ref().map(|f| json!({"env": f.env, "step": f.step, "what": f.what})),
            "backend": device.backend(), "device": device.card(),
            "task": task, "seed": args.seed, "envs": args.envs, "wall_s": wall_s,
            "machine": machine, "date": date, "version": version,
        }))?;
    } else {
        let [steps, resets, bad] = [found.control_steps, found.resets as u64, found.bad].map(grouped);
        print(&format!(
            "{task}: {steps} control steps of random actions, {resets} resets, {bad} not finite\n  \
             {} in {} environments on {}, seed {}, {machine}, {date}, myo {version}\n",
            duration(wall_s),
            args.envs,
            sentence(device),
            args.seed,
        ))?;
    }
    let Some(First { env, step, what }) = &found.first else { return Ok(()) };
    let again = format!("myo bench nan --task {} --envs {} --seed {}", args.task, args.envs, args.seed);
    Err(Failure::sentence(format!("{what} of environment {env} was not finite in step {step}; to repeat it: {again}")))
}
