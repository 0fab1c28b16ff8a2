//! Speed of learning on the graphics card: `cargo run --release -p myo-benches --example gpu_learner -- [tiles]`.
//!
//! Whole updates with two hidden layers of 128, and single gradient steps of a policy 4 x 128 and a value network 5 x 256, on
//! records of made-up numbers; then what their kernels take. With `tiles`, instead: single gradient steps with every tile.

use std::collections::BTreeMap;
use std::time::Instant;

use myo_benches::{Arguments, Failure, RollOut, breakdown, seconds};
use myo_gpu::{AdapterChoice, Gpu};
use myo_train::PpoConfig;
use myo_train::gpu::{DeviceLearner, MatrixTile, Settings, Tile, Tiles};

fn measure_both(gpu: &Gpu, config: &PpoConfig) -> Result<(), Failure> {
    let data = RollOut::new(gpu, config)?;
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

fn measure_learner(gpu: &Gpu, config: &PpoConfig, data: &RollOut, what: &str) -> Result<(), Failure> {
    let RollOut { sizes, record, parameters } = data;
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
    let data = RollOut::new(gpu, config)?;
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
fn products(gpu: &Gpu, config: &PpoConfig, data: &RollOut, tiles: Tiles) -> Result<String, Failure> {
    let RollOut { sizes, record, parameters } = data;
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
    let mut arguments = Arguments::read();
    let measure = if arguments.takes("tiles") { tiles } else { measure_both };
    arguments.end()?;
    let gpu = Gpu::open(&AdapterChoice::Any)?;
    println!("{}", gpu.adapter().name);
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
