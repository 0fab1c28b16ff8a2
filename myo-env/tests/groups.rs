//! Environments of several groups on a card: those of each are what they are without the others.

use crate::common::{arm, gpu, rollout, short, without_gpu};
use myo_env::{EnvConfig, GpuEnv, StepStorage, VectorEnv};
use myo_gpu::Gpu;

const ENVS: usize = 10;

fn config() -> EnvConfig {
    EnvConfig { num_envs: ENVS, exploring: ENVS / 2, ..EnvConfig::default() }
}

fn env(gpu: &Gpu) -> GpuEnv {
    let task = short("pointing-single");
    GpuEnv::new(gpu, &arm(&task), &task, &config()).unwrap()
}

/// What some environments return from `seed` on, over the end of their first episodes, as bits; and their state after it.
fn history(env: &mut GpuEnv, seed: u64) -> (Vec<u32>, Vec<u8>) {
    let mut observation = vec![0.0; ENVS * env.spec().observation_size()];
    env.reset(Some(seed), None, &mut observation).unwrap();
    let steps = rollout(env, 12);
    assert!(steps.iter().any(|step| step.truncated.contains(&true)), "no episode ended");
    let numbers = |step: &StepStorage| {
        let flags =
            [&step.terminated, &step.truncated].map(|flags| flags.iter().map(|&flag| f32::from(flag)).collect());
        let all = [&step.observation, &step.reward, &step.final_observation, &step.episode, &flags[0], &flags[1]];
        all.into_iter().flatten().copied().collect::<Vec<_>>()
    };
    let all = observation.into_iter().chain(steps.iter().flat_map(numbers)).map(f32::to_bits);
    (all.collect(), env.save_state().unwrap())
}

#[test]
fn environments_of_a_group_are_those_of_a_device_without_groups_bit_for_bit() {
    if without_gpu() {
        return;
    }
    let gpu = gpu();
    let seeds = [5, 1 << 40, 6];
    let all = env(&gpu.in_groups(seeds.len()).unwrap());
    let mut groups: Vec<GpuEnv> = (0..seeds.len()).map(|group| all.of(group).unwrap()).collect();
    let mut alone = env(&gpu);
    for (group, &seed) in groups.iter_mut().zip(&seeds) {
        let (got, expected) = (history(group, seed), history(&mut alone, seed));
        assert!(got == expected, "seed {seed}");
    }
    // Those that came later left the first alone, and its state is one of environments without groups.
    let mut before = alone.sibling(&config()).unwrap();
    history(&mut before, seeds[0]);
    assert!(groups[0].save_state().unwrap() == before.save_state().unwrap(), "changed by others");
    groups[2].load_state(&before.save_state().unwrap()).unwrap();
    assert!(groups[2].save_state().unwrap() == before.save_state().unwrap(), "loaded");
    assert!(groups[1].save_state().unwrap() != before.save_state().unwrap());
    let error = all.of(3).err().unwrap().to_string();
    assert!(error.contains("4 groups were asked for"), "{error}");
}

#[test]
fn all_groups_step_at_once_as_each_does_alone() {
    if without_gpu() {
        return;
    }
    let gpu = gpu();
    let all = env(&gpu.in_groups(2).unwrap());
    let seeds = [8, 9];
    let mut envs: Vec<GpuEnv> = (0..2).map(|group| all.of(group).unwrap()).collect();
    let mut observation = vec![0.0; ENVS * all.spec().observation_size()];
    for (env, &seed) in envs.iter_mut().zip(&seeds) {
        env.reset(Some(seed), None, &mut observation).unwrap();
        let actions = vec![0.1 * seed as f32; env.shards()[0].actions.len()];
        gpu.write(&env.shards()[0].actions, 0, &actions).unwrap();
    }
    let mut batch = all.gpu().batch();
    (0..5).for_each(|_| all.shards()[0].step(&mut batch));
    batch.submit().unwrap();
    for (env, &seed) in envs.iter().zip(&seeds) {
        let mut alone = self::env(&gpu);
        alone.reset(Some(seed), None, &mut observation).unwrap();
        let shard = &alone.shards()[0];
        gpu.write(&shard.actions, 0, &vec![0.1 * seed as f32; shard.actions.len()]).unwrap();
        let mut batch = gpu.batch();
        (0..5).for_each(|_| shard.step(&mut batch));
        batch.submit().unwrap();
        assert!(env.save_state().unwrap() == alone.save_state().unwrap(), "seed {seed}");
    }
}
