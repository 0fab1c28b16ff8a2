//! Speed of learning on the graphics card: `gpu_learner [tiles]`.
//!
//! Whole updates with two hidden layers of 128, and single gradient steps of a policy 4 x 128 and a value network 5 x 256, on
//! records of made-up numbers; then what their kernels take. With `tiles`, instead: single gradient steps with every tile.

mod measure;

use std::collections::BTreeMap;
use std::time::Instant;

use measure::{Failure, breakdown, seconds};
use myo_gpu::{Buffer, Gpu, Want};
use myo_train::PpoConfig;
use myo_train::gpu::{DeviceLearner, MatrixTile, RolloutBuffers, Settings, Sizes, Tile, Tiles};

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

fn measure_both(gpu: &Gpu, config: &PpoConfig) -> Result<(), Failure> {
    let data = data(gpu, config)?;
    let (envs, steps) = (config.num_envs, config.steps_per_update);
    println!(
        "{envs} x {steps} samples, {} x {} minibatches, policy {:?}, value {:?}",
        config.epochs, config.minibatches, config.policy_hidden, config.value_hidden
    );
    measure_learner(gpu, &PpoConfig { matrix_units: false, ..config.clone() }, &data, "32 bits")?;
    if gpu.adapter().cooperative_matrix {
        measure_learner(gpu, config, &data, "matrix units")?;
    }
    Ok(())
}

fn measure_learner(gpu: &Gpu, config: &PpoConfig, data: &Data, what: &str) -> Result<(), Failure> {
    let Data { sizes, record, parameters } = data;
    let start = Instant::now();
    let mut learner = DeviceLearner::new(gpu, sizes, config, parameters, record)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    learner.prepare(sizes, Settings { seed: 1, update: 0, learning_rate: 1e-4, gradient_steps: 0 })?;
    let uploaded = start.elapsed().as_secs_f64();
    let estimates = seconds(gpu, |batch| learner.record_estimates(batch))?;
    let step = seconds(gpu, |batch| learner.record_step(batch))?;
    let update = seconds(gpu, |batch| learner.record(batch))?;
    println!(
        "  {what}: prepared in {prepared:.3} s, order {:.3} ms, advantages {:.3} ms, gradient step {:.3} ms, update {:.3} ms",
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

/// Tiles of gradients of weights for matrix units, and columns of a workgroup of the passes.
const MATRIX_TILES: &[(u32, MatrixTile)] = &[
    (32, MatrixTile::new((32, 32), (32, 32))),
    (64, MatrixTile::new((64, 64), (32, 32))),
    (32, MatrixTile::new((64, 32), (64, 32))),
    (64, MatrixTile::new((64, 64), (64, 32))),
    (32, MatrixTile::new((64, 64), (64, 64))),
    (64, MatrixTile::new((128, 64), (64, 64))),
    (32, MatrixTile::new((128, 64), (64, 32))),
    (64, MatrixTile::new((128, 128), (64, 32))),
    (64, MatrixTile::new((128, 128), (64, 64))),
];

/// What a gradient step's products take with every tile.
fn tiles(gpu: &Gpu, config: &PpoConfig) -> Result<(), Failure> {
    let data = data(gpu, config)?;
    println!("{} samples, value network {:?}", data.sizes.samples() / config.minibatches, config.value_hidden);
    for &tile in TILES {
        let tiles = Tiles { layers: Some(tile), weights: Some(tile), ..Tiles::default() };
        let config = PpoConfig { matrix_units: false, ..config.clone() };
        println!("  {:?} {}: {}", tile.per_thread, tile.depth, products(gpu, &config, &data, tiles)?);
    }
    let units: &[_] = if gpu.adapter().cooperative_matrix { MATRIX_TILES } else { &[] };
    for &(columns, tile) in units {
        let tiles = Tiles { columns: Some(columns), matrix_weights: Some(tile), ..Tiles::default() };
        println!("  {tile:?}: {}", products(gpu, config, &data, tiles)?);
    }
    Ok(())
}

/// What they take with these tiles.
fn products(gpu: &Gpu, config: &PpoConfig, data: &Data, tiles: Tiles) -> Result<String, Failure> {
    let Data { sizes, record, parameters } = data;
    let mut learner = DeviceLearner::with_tiles(gpu, sizes, config, parameters, record, tiles)?;
    learner.prepare(sizes, Settings { seed: 1, update: 0, learning_rate: 1e-4, gradient_steps: 0 })?;
    // A card that has waited for a compiler is slow for a while.
    seconds(gpu, |batch| learner.record_step(batch))?;
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
    let products = ["forward", "backward", "passes", "weight"];
    let all = best.iter().filter(|(kernel, _)| products.iter().any(|product| kernel.starts_with(product)));
    let all: Vec<_> = all.map(|(kernel, us)| format!("{kernel} {us:.0} us")).collect();
    Ok(all.join(", "))
}

fn main() -> Result<(), Failure> {
    let gpu = Gpu::open(&Want::Any)?;
    println!("{}", gpu.adapter().name);
    let measure = if std::env::args().any(|argument| argument == "tiles") { tiles } else { measure_both };
    for num_envs in [2048, 16_384] {
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
