//! Speed of acting on the graphics card: `cargo run --release -p myo-benches --example gpu_rollout -- [ENVS,ENVS,...] [TASK] [tiles]`.
//!
//! For every number of environments: one pass of the policy, the values of a whole roll-out, a whole roll-out, and what its
//! kernels take. With `tiles`, instead: the networks alone, with every tile.

use myo_benches::{Arguments, Failure, breakdown, seconds};
use myo_env::{EnvConfig, GpuEnv, VectorEnv};
use myo_gpu::{AdapterChoice, Batch, Gpu};
use myo_model::{Model, builtin};
use myo_train::gpu::{DeviceRollout, Tile};
use myo_train::{Normalizer, PpoConfig, Trainer};

fn measure_rollout(gpu: &Gpu, task: &myo_tasks::Task, num_envs: usize) -> Result<(), Failure> {
    let model = Model::new(&builtin(&task.model)?)?;
    let config = PpoConfig { num_envs, ..PpoConfig::default() };
    let make = || GpuEnv::new(gpu, &model, task, &EnvConfig { num_envs, ..EnvConfig::default() });
    let card = DeviceRollout::new(make()?, &config)?;
    card.set_scaling(&Normalizer::new(card.sizes().observations, 5.0, 0.05))?;
    card.set_clock(1, 0)?;
    let (steps, spec) = (config.steps_per_update, card.env().spec());
    println!("{num_envs} environments, {} observations, {} actions", spec.observation_size(), spec.action_size());
    let policy = seconds(gpu, |batch| card.record_policy(batch))?;
    let values = seconds(gpu, |batch| card.record_values(batch))?;
    let rollout = seconds(gpu, |batch| card.record(batch))?;
    println!(
        "  policy {:.1} us, values of {} steps {:.1} us, roll-out {:.3} ms: {:.1} us per step, {:.2} M steps/s",
        policy * 1e6,
        steps + 1,
        values * 1e6,
        rollout * 1e3,
        rollout / steps as f64 * 1e6,
        (num_envs * steps) as f64 / rollout / 1e6
    );
    breakdown(gpu, |batch| card.record(batch))?;

    let mut trainer = Trainer::on_card(make()?, config, 1)?;
    trainer.update()?;
    let metrics = trainer.update()?;
    println!("  an update: collected and read in {:.4} s, learned in {:.4} s", metrics.collect_s, metrics.learn_s);
    Ok(())
}

/// Tiles worth trying.
const TILES: &[Tile] = &[
    Tile::new(4, 128, 8, (4, 4)),
    Tile::new(16, 64, 16, (4, 4)),
    Tile::new(32, 64, 16, (4, 4)),
    Tile::new(64, 64, 16, (4, 4)),
    Tile::new(64, 64, 8, (8, 8)),
    Tile::new(64, 128, 8, (8, 4)),
    Tile::new(64, 128, 8, (8, 8)),
    Tile::new(128, 64, 8, (8, 8)),
    Tile::new(128, 128, 8, (8, 8)),
];

/// The networks alone, layer by layer, with every tile.
fn tiles(gpu: &Gpu, task: &myo_tasks::Task, num_envs: usize) -> Result<(), Failure> {
    let model = Model::new(&builtin(&task.model)?)?;
    let config = PpoConfig { num_envs, ..PpoConfig::default() };
    for &tile in TILES {
        let env = GpuEnv::new(gpu, &model, task, &EnvConfig { num_envs, ..EnvConfig::default() })?;
        let card = DeviceRollout::with_tile(env, &config, Some(tile))?;
        let layers = |add: &dyn Fn(&mut Batch)| -> Result<Vec<String>, Failure> {
            let mut best = vec![];
            for _ in 0..5 {
                let mut batch = gpu.batch().timed()?;
                add(&mut batch);
                let times: Vec<f64> = batch.submit_and_time()?.iter().map(|timing| timing.seconds * 1e6).collect();
                best = if best.is_empty() {
                    times
                } else {
                    best.iter().zip(&times).map(|(a, b)| f64::min(*a, *b)).collect()
                };
            }
            Ok(best.iter().take(3).map(|us| format!("{us:.1}")).collect())
        };
        let policy = seconds(gpu, |batch| card.record_policy(batch))?;
        println!(
            "{num_envs:6} {:3} x {:3} x {:2}, {:?}: policy {:6.1} us, layers {}; value layers {}",
            tile.outputs,
            tile.columns,
            tile.depth,
            tile.per_thread,
            policy * 1e6,
            layers(&|batch| card.record_policy(batch))?.join(" "),
            layers(&|batch| card.record_values(batch))?.join(" "),
        );
    }
    Ok(())
}

fn main() -> Result<(), Failure> {
    let mut arguments = Arguments::read();
    let measure = if arguments.takes("tiles") { tiles } else { measure_rollout };
    let sizes = arguments.numbers()?;
    let sizes = if sizes.is_empty() { vec![1024, 16_384, 65_536] } else { sizes };
    let name = arguments.word().unwrap_or("pointing".into());
    arguments.end()?;
    let task = myo_tasks::preset(&name).ok_or_else(|| format!("there is no task `{name}`"))?;
    let gpu = Gpu::open(&AdapterChoice::Any)?;
    println!("{} on {}", task.name, gpu.adapter().name);
    for size in sizes {
        measure(&gpu, &task, size)?;
    }
    Ok(())
}
