//! Speed of learning on the graphics card: `gpu_learner`.
//!
//! Whole updates with two hidden layers of 128, and single gradient steps of a policy 4 x 128 and a value network 5 x 256, on
//! records of made-up numbers; then what their kernels take.

use std::collections::BTreeMap;
use std::time::Instant;

use myo_gpu::{Batch, Gpu, Want};
use myo_train::PpoConfig;
use myo_train::gpu::{DeviceLearner, RolloutBuffers, Settings, Sizes};

type Failure = Box<dyn std::error::Error>;

/// Seconds per repetition: the best of several batches, each long enough to hide its submission.
fn seconds(gpu: &Gpu, add: impl Fn(&mut Batch)) -> Result<f64, Failure> {
    let run = |count: u32| -> Result<f64, Failure> {
        let start = Instant::now();
        let mut batch = gpu.batch();
        (0..count).for_each(|_| add(&mut batch));
        batch.submit()?;
        gpu.wait()?;
        Ok(start.elapsed().as_secs_f64())
    };
    run(1)?;
    let count = (0.1 / run(1)?).ceil().clamp(1.0, 100.0) as u32;
    let mut best = f64::INFINITY;
    for _ in 0..4 {
        best = best.min(run(count)? / f64::from(count));
    }
    Ok(best)
}

/// Prints how much of the device's time each kernel takes.
fn breakdown(gpu: &Gpu, add: impl Fn(&mut Batch)) -> Result<(), Failure> {
    let Ok(mut batch) = gpu.batch().timed() else {
        println!("    (this device has no clock)");
        return Ok(());
    };
    add(&mut batch);
    let mut kernels = BTreeMap::<String, (u32, f64)>::new();
    for timing in batch.submit_and_time()? {
        let (count, seconds) = kernels.entry(timing.kernel).or_default();
        *count += 1;
        *seconds += timing.seconds;
    }
    for (kernel, (count, seconds)) in kernels {
        let each = seconds / f64::from(count) * 1e6;
        println!("    {kernel:24} {count:4} x {each:9.1} us = {:8.3} ms", seconds * 1e3);
    }
    Ok(())
}

/// Numbers between -1 and 1 without a pattern that matters.
fn numbers(n: usize, seed: u32) -> Vec<f32> {
    let mut word = seed;
    let mut next = || {
        word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (word >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    (0..n).map(|_| next()).collect()
}

fn measure(gpu: &Gpu, config: &PpoConfig) -> Result<(), Failure> {
    let (envs, steps) = (config.num_envs, config.steps_per_update);
    let padded = envs.next_multiple_of(4);
    let sizes = Sizes { steps, envs, padded, observations: 55, actions: 26, summary: 5, time_limit: 100 };
    let record = RolloutBuffers::new(gpu, &sizes)?;
    for (seed, buffer) in [&record.observation, &record.action, &record.value, &record.reward].into_iter().enumerate() {
        gpu.write(buffer, 0, &numbers(buffer.len(), seed as u32))?;
    }
    gpu.write(&record.log_prob, 0, &vec![-24.0; record.log_prob.len()])?;
    let layers = |hidden: &[usize], outputs: usize| {
        let widths: Vec<_> = [55].iter().chain(hidden).chain(&[outputs]).copied().collect();
        widths.windows(2).map(|w| w[0] * w[1] + w[1]).sum::<usize>()
    };
    let (policy, value) = (layers(&config.policy_hidden, 26), layers(&config.value_hidden, 1));
    let parameters = gpu.buffer("parameters", policy + 26 + value)?;
    gpu.write(&parameters, 0, &numbers(parameters.len(), 9).iter().map(|x| 0.1 * x).collect::<Vec<_>>())?;
    let start = Instant::now();
    let mut learner = DeviceLearner::new(gpu, &sizes, config, &parameters, &record)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    learner.prepare(&sizes, Settings { seed: 1, update: 0, learning_rate: 1e-4, gradient_steps: 0 })?;
    let uploaded = start.elapsed().as_secs_f64();
    let estimates = seconds(gpu, |batch| learner.record_estimates(batch))?;
    let step = seconds(gpu, |batch| learner.record_step(batch))?;
    let update = seconds(gpu, |batch| learner.record(batch))?;
    println!(
        "{envs} x {steps} samples, {} x {} minibatches, policy {:?}, value {:?}: prepared in {prepared:.3} s",
        config.epochs, config.minibatches, config.policy_hidden, config.value_hidden
    );
    println!(
        "  order {:.3} ms, advantages {:.3} ms, gradient step {:.3} ms, update {:.3} ms",
        uploaded * 1e3,
        estimates * 1e3,
        step * 1e3,
        update * 1e3
    );
    breakdown(gpu, |batch| learner.record(batch))
}

fn main() -> Result<(), Failure> {
    let gpu = Gpu::open(&Want::Any)?;
    println!("{}", gpu.adapter().name);
    for num_envs in [1024, 16_384] {
        measure(&gpu, &PpoConfig { num_envs, ..PpoConfig::default() })?;
    }
    for num_envs in [1280, 8192, 65_536] {
        let config = PpoConfig {
            num_envs,
            steps_per_update: 1,
            epochs: 1,
            minibatches: 1,
            policy_hidden: vec![128; 4],
            value_hidden: vec![256; 5],
            ..PpoConfig::default()
        };
        measure(&gpu, &config)?;
    }
    Ok(())
}
