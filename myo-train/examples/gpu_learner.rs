//! Speed of learning on the graphics card: `gpu_learner [tiles]`.
//!
//! Whole updates with two hidden layers of 128, and single gradient steps of a policy 4 x 128 and a value network 5 x 256, on
//! records of made-up numbers; then what their kernels take. With `tiles`, instead: single gradient steps with every tile.

use std::collections::BTreeMap;
use std::time::Instant;

use myo_gpu::{Batch, Buffer, Gpu, Want};
use myo_train::PpoConfig;
use myo_train::gpu::{DeviceLearner, RolloutBuffers, Settings, Sizes, Tile, Tiles};

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

/// A record and parameters to learn from.
struct Data {
    sizes: Sizes,
    record: RolloutBuffers,
    parameters: Buffer<f32>,
}

fn data(gpu: &Gpu, config: &PpoConfig) -> Result<Data, Failure> {
    let (envs, steps) = (config.num_envs, config.steps_per_update);
    let padded = envs.next_multiple_of(4);
    let sizes =
        Sizes { steps, envs, padded, observations: 55, actions: 26, summary: 5, time_limit: 100, control_dt: 0.05 };
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
    Ok(Data { sizes, record, parameters })
}

fn measure(gpu: &Gpu, config: &PpoConfig) -> Result<(), Failure> {
    let (envs, steps) = (config.num_envs, config.steps_per_update);
    let Data { sizes, record, parameters } = data(gpu, config)?;
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

/// Tiles worth trying.
const TILES: &[Tile] = &[
    Tile::new(16, 64, 16, (4, 4)),
    Tile::new(32, 64, 16, (4, 4)),
    Tile::new(64, 64, 16, (4, 4)),
    Tile::new(64, 64, 16, (8, 4)),
    Tile::new(64, 64, 16, (8, 8)),
    Tile::new(64, 128, 8, (8, 4)),
    Tile::new(64, 128, 8, (8, 8)),
    Tile::new(128, 64, 8, (8, 8)),
    Tile::new(128, 128, 8, (8, 8)),
];

/// What a gradient step's products take with every tile.
fn tiles(gpu: &Gpu, config: &PpoConfig) -> Result<(), Failure> {
    let Data { sizes, record, parameters } = data(gpu, config)?;
    println!("{} samples, value network {:?}", sizes.samples() / config.minibatches, config.value_hidden);
    for &tile in TILES {
        let tiles = Tiles { layers: Some(tile), weights: Some(tile) };
        let mut learner = DeviceLearner::with_tiles(gpu, &sizes, config, &parameters, &record, tiles)?;
        learner.prepare(&sizes, Settings { seed: 1, update: 0, learning_rate: 1e-4, gradient_steps: 0 })?;
        let mut best = BTreeMap::<String, f64>::new();
        for _ in 0..5 {
            let mut batch = gpu.batch().timed()?;
            learner.record_step(&mut batch);
            let mut kernels = BTreeMap::<String, f64>::new();
            for timing in batch.submit_and_time()? {
                *kernels.entry(timing.kernel).or_default() += timing.seconds * 1e6;
            }
            for (kernel, us) in kernels {
                let best = best.entry(kernel).or_insert(f64::INFINITY);
                *best = best.min(us);
            }
        }
        let products = ["forward", "backward", "weight"];
        let all = best.iter().filter(|(kernel, _)| products.iter().any(|product| kernel.starts_with(product)));
        let all: Vec<_> = all.map(|(kernel, us)| format!("{kernel} {us:.0} us")).collect();
        println!("  {:?} {}: {}", tile.per_thread, tile.depth, all.join(", "));
    }
    Ok(())
}

fn main() -> Result<(), Failure> {
    let gpu = Gpu::open(&Want::Any)?;
    println!("{}", gpu.adapter().name);
    let measure = if std::env::args().any(|argument| argument == "tiles") { tiles } else { measure };
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
