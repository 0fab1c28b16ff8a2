//! Speed of learning on the graphics card: `cargo run --release -p myo-benches --example gpu_learner -- [tiles] [--groups N]`.
//!
//! Whole updates with two hidden layers of 128, and single gradient steps of a policy 4 x 128 and a value network 5 x 256, on
//! records of made-up numbers; then what their kernels take. With `tiles`, instead: single gradient steps with every tile.
//! With `--groups`, all of this for several learners at once.

use std::collections::BTreeMap;
use std::time::Instant;

use clap::{Parser, ValueEnum};
use myo_benches::{Failure, RollOut, breakdown, seconds};
use myo_gpu::{AdapterChoice, Gpu};
use myo_train::PpoConfig;
use myo_train::gpu::{DeviceLearner, MatrixTile, Settings, Sizes, Tile, Tiles};

/// Measures learning on the graphics card.
#[derive(Parser)]
struct Arguments {
    /// What is measured instead of updates and what their kernels take
    instead: Option<Instead>,
    /// How many learners learn at once, each from a record of its own
    #[arg(long, value_name = "N", default_value_t = 1)]
    groups: usize,
    /// Environments whose roll-outs whole updates learn from
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "4096,16384")]
    envs: Vec<usize>,
    /// Samples of the single gradient steps
    #[arg(long, value_name = "N,N,...", value_delimiter = ',', default_value = "1280,8192,65536")]
    samples: Vec<usize>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Instead {
    /// Single gradient steps with every tile
    Tiles,
}

fn measure_both(gpu: &Gpu, config: &PpoConfig) -> Result<(), Failure> {
    let data = RollOut::new(gpu, config)?;
    let (envs, steps) = (data.sizes.envs, data.sizes.steps);
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
    let learner = DeviceLearner::new(gpu, sizes, config, parameters, record)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    prepare(gpu, &learner, sizes)?;
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

/// Uploads what an update needs, an order of the samples for every group.
fn prepare(gpu: &Gpu, learner: &DeviceLearner, sizes: &Sizes) -> Result<(), Failure> {
    for group in 0..gpu.groups() {
        let settings = Settings { seed: 1 + group as u64, update: 0, learning_rate: 1e-4, gradient_steps: 0 };
        learner.of(group).prepare(sizes, settings)?;
    }
    Ok(())
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
    let learner = DeviceLearner::with_tiles(gpu, sizes, config, parameters, record, tiles)?;
    prepare(gpu, &learner, sizes)?;
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
    let Arguments { instead, groups, envs, samples } = Arguments::parse();
    let measure = match instead {
        Some(Instead::Tiles) => tiles,
        None => measure_both,
    };
    let gpu = Gpu::open(&AdapterChoice::Any)?.in_groups(groups)?;
    println!("{}, groups: {groups}", gpu.adapter().name);
    for num_envs in envs {
        measure(&gpu, &PpoConfig { num_envs, ..PpoConfig::default() })?;
    }
    for num_envs in samples {
        let config = PpoConfig {
            num_envs,
            rollout_s: 0.05,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_of_the_documents_are_understood() {
        let read = |line: &str| {
            let Arguments { instead, groups, envs, samples } = Arguments::try_parse_from(line.split(' ')).unwrap();
            (matches!(instead, Some(Instead::Tiles)), groups, envs, samples)
        };
        let (envs, samples) = (vec![4096, 16_384], vec![1280, 8192, 65_536]);
        assert_eq!(read("gpu_learner"), (false, 1, envs.clone(), samples.clone()));
        assert_eq!(read("gpu_learner tiles"), (true, 1, envs, samples));
        assert_eq!(read("gpu_learner --groups 2 --envs 64 --samples 8,9"), (false, 2, vec![64], vec![8, 9]));
        assert!(Arguments::try_parse_from(["gpu_learner", "tile"]).is_err());
    }
}
