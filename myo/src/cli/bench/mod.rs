//! `myo bench`: how fast it is here.

mod curve;
mod env;
mod env_gpu;
mod fit;
mod kernel;
mod machine;
mod mujoco;
mod nan;
mod physics;
mod published;
mod random;
mod speed;
mod train;

use clap::{Subcommand, ValueEnum};
use myo::Start;
use myo::scalar::Level;
use myo::train::PpoConfig;
use myo::train::session::Goal;

use super::backend::{BackendName, Options};
use super::failure::{Failure, Result, complain};
use super::scenario::Scenario;
use super::train::Ready;

/// What to measure.
#[derive(Subcommand)]
pub enum Command {
    /// Physics alone, on one core unless `--threads` says more
    Physics(physics::PhysicsArgs),
    /// The whole environment: physics, task, reward, observation, reset
    Env(env::EnvArgs),
    /// Time from the start of training until it is good enough, for several seeds
    Train(train::TrainArgs),
    /// The experiments of the published system, done again: two tables, three figures
    Published(published::PublishedArgs),
    /// Whether `myo fit` finds simulated users who are known
    Fit(fit::FitArgs),
    /// How good a simulated user is after so many control steps
    Curve(curve::CurveArgs),
    /// Operations of the kernel that a graphics card runs, and its text
    Kernel(kernel::KernelArgs),
    /// Look for numbers that are not finite in many steps of random actions
    Nan(nan::NanArgs),
}

/// Runs a `myo bench` command.
pub fn run(command: &Command, threads: Option<usize>) -> Result<()> {
    match command {
        Command::Physics(args) => physics::run(args, threads.unwrap_or(1)),
        Command::Env(args) => env::run(args),
        Command::Train(args) => train::run(args),
        Command::Published(args) => published::run(args),
        Command::Fit(args) => fit::run(args),
        Command::Curve(args) => curve::run(args),
        Command::Kernel(args) => kernel::run(args),
        Command::Nan(args) => nan::run(args),
    }
}

/// What steps bodies, by name.
#[derive(Clone, Copy, ValueEnum)]
enum CodeName {
    /// Plain code, NEON on ARM
    Portable,
    /// 8 lanes
    Avx2,
    /// 16 lanes
    Avx512,
    /// Machine code made for the model, with AVX-512
    Compiled,
}

/// What steps bodies.
#[derive(Clone, Copy)]
enum Code {
    /// Lanes that go through the tables of a body.
    Lanes(Level),
    /// Machine code made for it.
    Compiled,
}

impl CodeName {
    /// The code, if this processor has the level.
    fn code(self) -> Result<Code> {
        let name = match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Compiled => return Ok(Code::Compiled),
        };
        Ok(Code::Lanes(Level::named(name)?))
    }
}

impl Code {
    /// Short name, as on the command line.
    fn name(self) -> &'static str {
        match self {
            Self::Lanes(level) => level.name(),
            Self::Compiled => "compiled",
        }
    }
}

/// The least and the middle of some times.
fn best_and_median(mut times: Vec<f64>) -> (f64, f64) {
    times.sort_by(f64::total_cmp);
    (times.first().copied().unwrap_or(f64::NAN), times.get(times.len() / 2).copied().unwrap_or(f64::NAN))
}

/// Trainings with seeds 1 to `seeds` that run at once.
fn ready_at_once<'a>(
    scenario: &'a Scenario,
    physics: &Options,
    config: &PpoConfig,
    seeds: usize,
    goal: Goal,
) -> Result<Vec<Ready<'a>>> {
    complain(&format!("{} with {seeds} seeds at once", scenario.task.name));
    let starts: Vec<_> = (1..=seeds as u64).map(|seed| Start::New { config, seed, from: None }).collect();
    let all = Ready::several(scenario, &physics.choice(BackendName::Gpu)?, config, &starts, goal)?;
    all.ok_or_else(|| Failure::sentence("only a graphics card with room for all of them trains several seeds at once"))
}
