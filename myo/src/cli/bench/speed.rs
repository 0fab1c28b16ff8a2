//! How long a step of many environments takes.

use std::time::Instant;

use myo::env::{StepStorage, VectorEnv};
use myo::gpu::{Batch, Gpu};

use super::best_and_median;
use super::random::Random;
use crate::cli::failure::Result;

/// Measurements.
const REPEATS: usize = 7;
/// Time (s) of one measurement at least.
const LEAST_S: f64 = 0.3;
/// Control steps before the first measurement.
const WARM_UP: usize = 10;
/// Most control steps handed to a graphics card at once.
const MOST_AT_ONCE: f64 = 4096.0;

/// Seconds per step: least and median of the measurements.
pub type BestAndMedian = (f64, f64);

/// Steps with actions from the host and observations back to it; drawing the actions is not timed.
pub fn through_host(env: &mut dyn VectorEnv) -> Result<BestAndMedian> {
    let mut out = StepStorage::new(env.spec());
    let mut actions = vec![0.0; env.spec().num_envs * env.spec().action_size()];
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
    Ok(best_and_median(per_step))
}

/// Steps that stay on a graphics card: many in a row, then one wait. `add` adds a step to a batch.
pub fn on_device(gpu: &Gpu, add: impl Fn(&mut Batch)) -> Result<BestAndMedian> {
    let run = |steps: u32| -> Result<f64> {
        let start = Instant::now();
        let mut batch = gpu.batch();
        (0..steps).for_each(|_| add(&mut batch));
        batch.submit()?;
        gpu.wait()?;
        Ok(start.elapsed().as_secs_f64() / f64::from(steps))
    };
    let enough = |per_step: f64| (LEAST_S / per_step).ceil().clamp(1.0, MOST_AT_ONCE) as u32;
    run(1)?;
    // Few steps are mostly waiting, so they count as too slow; what they ask for is closer to the truth.
    let steps = enough(run(enough(run(2)?).min(100))?);
    let per_step = (0..REPEATS).map(|_| run(steps)).collect::<Result<_>>()?;
    Ok(best_and_median(per_step))
}
