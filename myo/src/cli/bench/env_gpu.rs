//! `myo bench env --backend gpu`: steps that stay on a graphics card.

use std::time::Instant;

use clap::ValueEnum;
use myo::env::gpu::{GpuOptions, PhysicsBench};
use myo::env::{EnvConfig, GpuEnv, Tables, VectorEnv};
use myo::gpu::{Cached, Gpu};
use myo::scalar::symbolic::Form;
use serde::Serialize;

use super::machine::Machine;
use super::random::Random;
use super::speed::{BestAndMedian, on_device, through_host};
use crate::cli::failure::{Result, complain};
use crate::cli::output::{rounded, row};
use crate::cli::scenario::Scenario;

/// What of a step is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum StepPart {
    /// The whole environment, with everything left where it is computed
    Env,
    /// The physics alone
    Physics,
    /// The whole environment, with actions from the host and observations back to it
    Host,
}

/// One measurement on a graphics card.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    backend: &'static str,
    device: String,
    driver: String,
    part: StepPart,
    form: &'static str,
    task: String,
    envs: usize,
    layouts: usize,
    ready_s: f64,
    kernel_cache: Option<&'static str>,
    physics_steps_per_s: f64,
    control_steps_per_s: f64,
    control_steps_per_s_median: f64,
    #[serde(flatten)]
    machine: Machine,
}

/// Headings of [`Row::cells`].
pub const HEADINGS: [&str; 8] =
    ["device", "part", "envs", "control steps/s", "median", "physics steps/s", "ready, s", "kernel cache"];

impl Row {
    /// For a table.
    pub fn cells(&self) -> Vec<String> {
        row([
            &self.device,
            self.part.to_possible_value().as_ref().map_or("", |value| value.get_name()),
            &self.envs.to_string(),
            &rounded(self.control_steps_per_s),
            &rounded(self.control_steps_per_s_median),
            &rounded(self.physics_steps_per_s),
            &format!("{:.2}", self.ready_s),
            self.kernel_cache.unwrap_or("-"),
        ])
    }
}

/// How a kernel came about.
#[derive(Clone, Copy, Debug)]
struct Ready {
    seconds: f64,
    cache: Option<&'static str>,
}

/// What all measurements have in common.
pub struct Measurement<'a> {
    /// Task and body.
    pub scenario: &'a Scenario,
    /// The open card.
    pub gpu: &'a Gpu,
    /// How long opening it took.
    pub open_s: f64,
    /// Form of the kernels; the environment's choice, if none.
    pub form: Option<Form>,
    /// Layouts in one batch.
    pub layouts: usize,
}

impl Measurement<'_> {
    /// Measures the parts of one number of environments.
    pub fn run(&self, envs: usize, parts: &[StepPart]) -> Result<Vec<Row>> {
        complain(&format!("compiling and measuring {envs} environments"));
        let (mut env, ready) = self.env(envs)?;
        let mut rows = Vec::new();
        for &part in parts {
            let (time, ready) = match part {
                StepPart::Env => (whole(self.gpu, &env)?, ready),
                StepPart::Host => (through_host(&mut env)?, ready),
                StepPart::Physics => self.physics(&env)?,
            };
            rows.push(self.row(&env, part, ready, time));
        }
        Ok(rows)
    }

    fn env(&self, num_envs: usize) -> Result<(GpuEnv, Ready)> {
        let start = Instant::now();
        let config = EnvConfig { num_envs, seed: 1, ..EnvConfig::default() };
        let options = GpuOptions { form: self.form, ..GpuOptions::default() };
        let tasks = vec![self.scenario.task.clone(); self.layouts];
        let env = GpuEnv::with_layouts(self.gpu, &self.scenario.model, &tasks, &config, &options)?;
        self.gpu.wait()?;
        let seconds = self.open_s + start.elapsed().as_secs_f64();
        let cache = cache(env.kernels().cached());
        Ok((env, Ready { seconds, cache }))
    }

    fn physics(&self, env: &GpuEnv) -> Result<(BestAndMedian, Ready)> {
        // It takes actions as excitations, which lie in [0, 1].
        upload(self.gpu, env, |x| 0.5 * (x + 1.0))?;
        let start = Instant::now();
        let tables = Tables::<f64>::new(&self.scenario.model, &self.scenario.task)?;
        let physics = PhysicsBench::new(env, &tables)?;
        let seconds = self.open_s + start.elapsed().as_secs_f64();
        let ready = Ready { seconds, cache: cache(physics.cached()) };
        Ok((on_device(self.gpu, |batch| physics.step(batch))?, ready))
    }

    fn row(&self, env: &GpuEnv, part: StepPart, ready: Ready, (best, median): BestAndMedian) -> Row {
        let (task, adapter) = (&self.scenario.task, self.gpu.adapter());
        let (envs, substeps) = (env.spec().num_envs, task.substeps(self.scenario.model.options.timestep));
        Row {
            backend: "gpu",
            device: adapter.name.clone(),
            driver: adapter.driver.clone(),
            part,
            form: match env.kernels().form() {
                Form::Straight => "straight",
                Form::Paths => "paths",
                Form::Loops => "loops",
            },
            task: task.name.clone(),
            envs,
            layouts: self.layouts,
            ready_s: ready.seconds,
            kernel_cache: ready.cache,
            physics_steps_per_s: f64::from(substeps) * envs as f64 / best,
            control_steps_per_s: envs as f64 / best,
            control_steps_per_s_median: envs as f64 / median,
            machine: Machine::here(),
        }
    }
}

fn whole(gpu: &Gpu, env: &GpuEnv) -> Result<BestAndMedian> {
    upload(gpu, env, |x| x)?;
    on_device(gpu, |batch| env.shards().iter().for_each(|shard| shard.step(batch)))
}

/// Random actions for all steps to come, from numbers in [-1, 1).
fn upload(gpu: &Gpu, env: &GpuEnv, action: impl Fn(f32) -> f32) -> Result<()> {
    let mut random = Random(1);
    for shard in env.shards() {
        let mut actions = vec![0.0; env.spec().action_size() * shard.num_envs];
        random.fill_signed(&mut actions);
        actions.iter_mut().for_each(|x| *x = action(*x));
        gpu.write(&shard.actions, 0, &actions)?;
    }
    Ok(())
}

/// Whether the compiled kernel was kept from an earlier process.
fn cache(cached: &Cached) -> Option<&'static str> {
    Some(match cached {
        Cached::Loaded => "warm",
        Cached::Stored => "cold",
        _ => "none",
    })
}
