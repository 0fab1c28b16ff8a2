//! A few environments seen without the others, where those lie in several places.

use crate::common::{arm, gpu, rollout, short, without_gpu};
use myo_env::gpu::GpuOptions;
use myo_env::{Env, EnvConfig, GpuEnv, Snapshot, Tables, VectorEnv};

/// Asserts that every run of environments is seen as the saved state has it.
fn assert_sees_what_is_saved(env: &dyn VectorEnv, tables: &Tables<f64>, context: &str) {
    let saved = env.save_state().unwrap();
    let n = env.spec().num_envs;
    for start in 0..=n {
        for end in start..=n {
            let seen = env.peek(start..end).unwrap();
            let read = (start..end).map(|env| Snapshot::read(tables, &saved, env).unwrap());
            let (seen, read) = (format!("{seen:?}"), format!("{:?}", read.collect::<Vec<_>>()));
            assert_eq!(seen, read, "{context}, {start}..{end}");
        }
    }
}

#[test]
fn runs_over_the_ends_of_shards_are_seen() {
    if without_gpu() {
        return;
    }
    let task = short("pointing-uitb");
    let (model, config) = (arm(&task), EnvConfig { num_envs: 7, exploring: 3, ..EnvConfig::default() });
    let options = GpuOptions { envs_per_shard: 3, ..GpuOptions::default() };
    let mut env = GpuEnv::with_options(&gpu(), &model, &task, &config, &options).unwrap();
    assert_eq!(env.shards().len(), 3);
    rollout(&mut env, 4);
    assert_sees_what_is_saved(&env, &Tables::new(&model, &task).unwrap(), "shards of three");
}

#[test]
fn each_group_sees_its_own() {
    if without_gpu() {
        return;
    }
    let task = short("pointing-single");
    let (model, config) = (arm(&task), EnvConfig { num_envs: 4, ..EnvConfig::default() });
    let all = GpuEnv::new(&gpu().in_groups(2).unwrap(), &model, &task, &config).unwrap();
    let (tables, mut observation) = (Tables::new(&model, &task).unwrap(), vec![0.0; 4 * all.spec().observation_size()]);
    let mut groups = [0, 1].map(|group| all.of(group).unwrap());
    for (seed, group) in groups.iter_mut().enumerate() {
        group.reset(Some(seed as u64), None, &mut observation).unwrap();
    }
    for (number, group) in groups.iter().enumerate() {
        assert_sees_what_is_saved(group, &tables, &format!("group {number}"));
    }
    let first = |env: &GpuEnv| env.peek(0..1).unwrap().remove(0).body.qpos;
    assert_ne!(first(&groups[0]), first(&groups[1]));
}

#[test]
fn one_environment_is_seen_as_the_first_of_many() {
    let task = short("ticket");
    let mut one = Env::new(&arm(&task), &task, 3).unwrap();
    let before = one.peek();
    assert!(before.episode == 1 && before.task.step == 0.0 && !before.ended);
    while !one.step(&[0.2; 26]).unwrap().truncated {}
    let after = one.peek();
    assert!(after.episode == 1 && after.task.step == one.spec().max_episode_steps as f64 && after.ended);
    one.reset(None);
    assert!(one.peek().episode == 2 && !one.peek().ended);
}
