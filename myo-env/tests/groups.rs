//! Environments of several groups on a card: those of each are what they are without the others.

use myo_env::{EnvConfig, GpuEnv, StepBuffers, VectorEnv};
use myo_gpu::{AdapterChoice, Gpu};
use myo_model::{Model, builtin};

const ENVS: usize = 10;

fn gpu() -> Option<Gpu> {
    match Gpu::open_with_cache(&AdapterChoice::Any, None) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var("MYO_NO_GPU").as_deref() == Ok("1") => {
            println!("skipped: MYO_NO_GPU=1, and {error}");
            None
        }
        Err(error) => panic!("{error}. To skip these tests, set MYO_NO_GPU=1."),
    }
}

fn env(gpu: &Gpu) -> GpuEnv {
    let mut task = myo_tasks::preset("pointing-single").unwrap();
    task.time_limit_s = 0.2;
    let model = Model::new(&builtin(&task.model).unwrap()).unwrap();
    GpuEnv::new(gpu, &model, &task, &EnvConfig { num_envs: ENVS, ..EnvConfig::default() }).unwrap()
}

/// Bits of what some environments return from `seed` on, over the end of their first episode, and of their state after it.
fn history(env: &mut GpuEnv, seed: u64) -> Vec<u8> {
    let spec = env.spec().clone();
    let mut observation = vec![0.0; ENVS * spec.observation_size()];
    env.reset(Some(seed), None, &mut observation).unwrap();
    let mut all: Vec<u8> = bytes(&observation);
    for step in 0..6 {
        let wave = |k: usize| ((k + 7 * step) as f32 * 0.37 + seed as f32).sin();
        let actions: Vec<f32> = (0..ENVS * spec.action_size()).map(wave).collect();
        let mut out = Out::new(ENVS, observation.len(), ENVS * spec.episode_size());
        env.step(&actions, out.buffers()).unwrap();
        all.extend([bytes(&out.observation), bytes(&out.reward), bytes(&out.last), bytes(&out.episode)].concat());
        all.extend(out.ended.iter().flatten().map(|&ended| u8::from(ended)));
    }
    all.extend(env.save_state().unwrap());
    all
}

fn bytes(x: &[f32]) -> Vec<u8> {
    x.iter().flat_map(|x| x.to_le_bytes()).collect()
}

struct Out {
    observation: Vec<f32>,
    reward: Vec<f32>,
    ended: [Vec<bool>; 2],
    last: Vec<f32>,
    episode: Vec<f32>,
}

impl Out {
    fn new(envs: usize, observations: usize, episodes: usize) -> Self {
        let [observation, last] = [(); 2].map(|()| vec![0.0; observations]);
        let ended = [(); 2].map(|()| vec![false; envs]);
        Self { observation, reward: vec![0.0; envs], ended, last, episode: vec![0.0; episodes] }
    }

    fn buffers(&mut self) -> StepBuffers<'_> {
        let [terminated, truncated] = &mut self.ended;
        StepBuffers {
            observation: &mut self.observation,
            reward: &mut self.reward,
            terminated,
            truncated,
            final_observation: &mut self.last,
            episode: &mut self.episode,
        }
    }
}

#[test]
fn environments_of_a_group_are_those_of_a_device_without_groups_bit_for_bit() {
    let Some(gpu) = gpu() else { return };
    let seeds = [5, 1 << 40, 6];
    let all = env(&gpu.in_groups(seeds.len()).unwrap());
    let mut groups: Vec<GpuEnv> = (0..seeds.len()).map(|group| all.of(group).unwrap()).collect();
    let mut alone = env(&gpu);
    for (group, &seed) in groups.iter_mut().zip(&seeds) {
        assert!(history(group, seed) == history(&mut alone, seed), "seed {seed}");
    }
    // Those that came later left the first alone, and its state is one of environments without groups.
    let mut before = alone.sibling(ENVS, 0).unwrap();
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
    let Some(gpu) = gpu() else { return };
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
