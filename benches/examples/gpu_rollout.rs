//! Speed of acting on the graphics card: `cargo run --release -p myo-benches --example gpu_rollout -- [ENVS,ENVS,...] [TASK] [tiles]
//! [--groups N]`.
//!
//! For every number of environments: one pass of the policy, the values of a whole roll-out, a whole roll-out, and what its
//! kernels take. With `tiles`, instead: the networks alone, with every tile. With `--groups`, all of this for so many
//! environments of several policies at once.

use std::thread;

use clap::{ArgAction, Parser, ValueEnum};
use myo_benches::{Failure, breakdown, seconds};
use myo_env::{GpuEnv, VectorEnv};
use myo_gpu::{AdapterChoice, Batch, Gpu};
use myo_model::builtin;
use myo_train::gpu::{DeviceRollout, Tile};
use myo_train::{Member, Normalizer, PpoConfig, TrainError, Trainer, UpdateMetrics};

/// Measures acting on the graphics card.
#[derive(Parser)]
struct Arguments {
    /// Numbers of environments, of every group
    #[arg(value_name = "ENVS,ENVS,...", action = ArgAction::Set, num_args = 1, value_delimiter = ',')]
    #[arg(default_value = "1024,16384,65536")]
    envs: Vec<usize>,
    /// A preset
    #[arg(default_value = "pointing-uitb")]
    task: String,
    /// What is measured instead of roll-outs and what their kernels take
    instead: Option<Instead>,
    /// How many policies act at once, each in environments of its own
    #[arg(long, value_name = "N", default_value_t = 1)]
    groups: usize,
}

#[derive(Clone, Copy, ValueEnum)]
enum Instead {
    /// The networks alone, with every tile
    Tiles,
}

fn measure_rollout(gpu: &Gpu, task: &myo_tasks::Task, num_envs: usize) -> Result<(), Failure> {
    let model = task.embody(&builtin(&task.model)?)?;
    let config = PpoConfig { num_envs, ..PpoConfig::default() };
    let make = || GpuEnv::new(gpu, &model, task, &config.envs(0));
    let card = DeviceRollout::new(make()?, &config)?;
    card.set_scaling(&Normalizer::new(card.sizes().observations, 5.0, 0.05))?;
    let (groups, spec) = (gpu.groups(), card.env().spec());
    let steps = config.steps_per_update(spec.control_dt);
    for group in 0..groups {
        card.of(group)?.set_clock(1 + group as u64, 0)?;
    }
    println!(
        "{groups} x {num_envs} environments, {} observations, {} actions",
        spec.observation_size(),
        spec.action_size()
    );
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
        (groups * num_envs * steps) as f64 / rollout / 1e6
    );
    breakdown(gpu, |batch| card.record(batch))?;

    let members: Vec<_> = (1..).take(groups).map(|seed| Member::New { config: &config, seed }).collect();
    let updates = second_updates(Trainer::several_on_card(make()?, &members)?)?;
    // They run in the same batches: all tell the same times.
    if let Some(metrics) = updates.first() {
        println!("  an update: collected and read in {:.4} s, learned in {:.4} s", metrics.collect_s, metrics.learn_s);
    }
    Ok(())
}

/// What the second updates of trainings tell that learn at once.
fn second_updates(trainers: Vec<Trainer>) -> Result<Vec<UpdateMetrics>, TrainError> {
    thread::scope(|scope| {
        let start = |mut trainer: Trainer| scope.spawn(move || trainer.update().and_then(|_| trainer.update()));
        let threads: Vec<_> = trainers.into_iter().map(start).collect();
        threads.into_iter().map(|thread| thread.join().expect("an update does not panic")).collect()
    })
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
    let model = task.embody(&builtin(&task.model)?)?;
    let config = PpoConfig { num_envs, ..PpoConfig::default() };
    for &tile in TILES {
        let env = GpuEnv::new(gpu, &model, task, &config.envs(0))?;
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
            "{} x {num_envs:6} {:3} x {:3} x {:2}, {:?}: policy {:6.1} us, layers {}; value layers {}",
            gpu.groups(),
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
    let Arguments { envs, task, instead, groups } = Arguments::parse();
    let measure = match instead {
        Some(Instead::Tiles) => tiles,
        None => measure_rollout,
    };
    let task = myo_tasks::preset(&task).ok_or_else(|| format!("there is no task `{task}`"))?;
    let gpu = Gpu::open(&AdapterChoice::Any)?.in_groups(groups)?;
    println!("{} on {}, groups: {groups}", task.name, gpu.adapter().name);
    for num_envs in envs {
        measure(&gpu, &task, num_envs)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_of_the_documents_are_understood() {
        let read = |line: &str| {
            let Arguments { envs, task, instead, groups } = Arguments::try_parse_from(line.split(' ')).unwrap();
            (envs, task, matches!(instead, Some(Instead::Tiles)), groups)
        };
        assert_eq!(read("gpu_rollout"), (vec![1024, 16_384, 65_536], "pointing-uitb".into(), false, 1));
        assert_eq!(read("gpu_rollout 2048"), (vec![2048], "pointing-uitb".into(), false, 1));
        assert_eq!(read("gpu_rollout 64,128 ar tiles --groups 2"), (vec![64, 128], "ar".into(), true, 2));
        assert!(Arguments::try_parse_from(["gpu_rollout", "64,1e3"]).is_err());
    }
}
