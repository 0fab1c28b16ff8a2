//! Environments small enough to know the answer.
#![allow(dead_code)]

use myo_env::{Autoreset, EnvError, EnvSpec, StepBuffers, VectorEnv};

/// Length of an episode of [`Points`] in control steps.
pub const TIME_LIMIT: usize = 60;

/// Numbers in a summary of one of its episodes.
pub const SUMMARY: usize = 12;

/// Numbers with fractions in the state of a world.
const FLOATS: usize = 11;

/// What it costs to move a point at full speed for a step.
const MOVEMENT_COST: f32 = 0.001;

/// A point moves at the commanded velocity, which costs something, and shall reach two targets, one after the other.
pub struct Points {
    spec: EnvSpec,
    worlds: Vec<World>,
    cost_share: f32,
}

#[derive(Clone, Default)]
struct World {
    position: [f32; 2],
    targets: [[f32; 2]; 2],
    done: usize,
    times: [f32; 2],
    steps: usize,
    total: f32,
    /// What targets brought, and what movement cost.
    earned: f32,
    spent: f32,
    random: u64,
}

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|&n| n.into()).collect()
}

impl Points {
    pub fn new(num_envs: usize) -> Self {
        let spec = EnvSpec {
            num_envs,
            observation_names: names(&["x", "y", "to_target_x", "to_target_y", "done", "constant"]),
            action_names: names(&["v_x", "v_y"]),
            episode_names: names(&[
                "return",
                "length",
                "success",
                "targets_done",
                "final_distance",
                "effort",
                "target_1_success",
                "target_1_time",
                "target_2_success",
                "target_2_time",
                "reward_subtask",
                "reward_neural_effort",
            ]),
            control_dt: 0.05,
            max_episode_steps: TIME_LIMIT,
            layout_limits: vec![],
            autoreset: Autoreset::SameStep,
            exploring: 0,
        };
        Self { spec, worlds: vec![World::default(); num_envs], cost_share: 1.0 }
    }

    /// The same as so many layouts, which do not differ.
    pub fn in_layouts(mut self, layouts: usize) -> Self {
        self.spec.layout_limits = vec![TIME_LIMIT; layouts];
        self
    }
}

impl World {
    /// Uniform in [-1, 1]; a plain linear congruence is enough for a toy.
    fn uniform(&mut self) -> f32 {
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.random >> 40) as f32 / 8_388_608.0 - 1.0
    }

    fn restart(&mut self) {
        let random = self.random;
        *self = Self { random, times: [f32::NAN; 2], ..Self::default() };
        self.position = [self.uniform(), self.uniform()];
        self.targets = [[self.uniform(), self.uniform()], [self.uniform(), self.uniform()]];
    }

    fn to_target(&self) -> [f32; 2] {
        let target = self.targets[self.done.min(1)];
        [target[0] - self.position[0], target[1] - self.position[1]]
    }

    fn distance(&self) -> f32 {
        let [x, y] = self.to_target();
        x.hypot(y)
    }

    fn observe(&self, out: &mut [f32]) {
        let [x, y] = self.to_target();
        out.copy_from_slice(&[self.position[0], self.position[1], x, y, self.done as f32, 0.3]);
    }

    fn numbers(&mut self) -> Vec<&mut f32> {
        let Self { position, targets, times, total, earned, spent, .. } = self;
        position.iter_mut().chain(targets.as_flattened_mut()).chain(times).chain([total, earned, spent]).collect()
    }
}

impl VectorEnv for Points {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn reset(&mut self, seed: Option<u64>, mask: Option<&[bool]>, observation: &mut [f32]) -> Result<(), EnvError> {
        for (i, (world, out)) in self.worlds.iter_mut().zip(observation.chunks_mut(6)).enumerate() {
            if mask.is_none_or(|mask| mask[i]) {
                if let Some(seed) = seed {
                    world.random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (i as u64) << 20;
                    for _ in 0..4 {
                        world.uniform();
                    }
                }
                world.restart();
            }
            world.observe(out);
        }
        Ok(())
    }

    fn step(&mut self, actions: &[f32], out: StepBuffers<'_>) -> Result<(), EnvError> {
        for (i, world) in self.worlds.iter_mut().enumerate() {
            let action = &actions[2 * i..2 * i + 2];
            assert!(action.iter().all(|a| a.abs() <= 1.0), "actions lie in [-1, 1]");
            world.position[0] += 0.15 * action[0];
            world.position[1] += 0.15 * action[1];
            world.steps += 1;
            let cost = self.cost_share * MOVEMENT_COST * (action[0].powi(2) + action[1].powi(2));
            world.spent += cost;
            out.reward[i] = -world.distance() - cost;
            if world.distance() < 0.15 {
                world.times[world.done] = world.steps as f32 * 0.05;
                world.done += 1;
                world.earned += 2.0;
                out.reward[i] += 2.0;
            }
            world.total += out.reward[i];
            out.terminated[i] = world.done == 2;
            out.truncated[i] = world.done < 2 && world.steps == TIME_LIMIT;
            if out.terminated[i] || out.truncated[i] {
                world.observe(&mut out.final_observation[6 * i..][..6]);
                let reached = |target: usize| f32::from(world.done > target);
                out.episode[SUMMARY * i..][..SUMMARY].copy_from_slice(&[
                    world.total,
                    world.steps as f32,
                    reached(1),
                    world.done as f32,
                    world.distance(),
                    0.5,
                    reached(0),
                    world.times[0],
                    reached(1),
                    world.times[1],
                    world.earned,
                    -world.spent,
                ]);
                world.restart();
            }
            world.observe(&mut out.observation[6 * i..][..6]);
        }
        Ok(())
    }

    fn set_cost_share(&mut self, share: f64) -> Result<(), EnvError> {
        self.cost_share = share as f32;
        Ok(())
    }

    fn save_state(&self) -> Result<Vec<u8>, EnvError> {
        let mut bytes = Vec::new();
        for world in &self.worlds {
            world.clone().numbers().iter().for_each(|x| bytes.extend(x.to_le_bytes()));
            [world.done as u64, world.steps as u64, world.random].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        }
        Ok(bytes)
    }

    fn load_state(&mut self, state: &[u8]) -> Result<(), EnvError> {
        let size = 4 * FLOATS + 8 * 3;
        if state.len() != size * self.worlds.len() {
            return Err(EnvError::BadState { reason: "wrong size".into() });
        }
        for (world, bytes) in self.worlds.iter_mut().zip(state.chunks(size)) {
            let (floats, words) = bytes.split_at(4 * FLOATS);
            for (x, bytes) in world.numbers().into_iter().zip(floats.as_chunks().0) {
                *x = f32::from_le_bytes(*bytes);
            }
            let words: Vec<u64> = words.as_chunks().0.iter().map(|&b| u64::from_le_bytes(b)).collect();
            (world.done, world.steps, world.random) = (words[0] as usize, words[1] as usize, words[2]);
        }
        Ok(())
    }
}

/// Reward 1 in every step; ends by the time limit alone, or by the task alone.
pub struct Constant {
    spec: EnvSpec,
    /// How long the episodes of each environment are, and how far they are after a reset.
    lengths: Vec<usize>,
    begun: Vec<usize>,
    steps: Vec<usize>,
    terminates: bool,
    /// Reward that is returned.
    pub reward: f32,
}

impl Constant {
    /// Episodes are equally long, and staggered, so that some end in every roll-out.
    pub fn new(num_envs: usize, length: usize, terminates: bool) -> Self {
        let begun = (0..num_envs).map(|i| i % length).collect();
        Self::with_lengths(vec![length; num_envs], begun, terminates)
    }

    /// Episodes of environment `i` take `i + 1` steps and return as much.
    pub fn staircase(num_envs: usize) -> Self {
        Self::with_lengths((1..=num_envs).collect(), vec![0; num_envs], true)
    }

    /// The last so many explore.
    pub fn exploring(mut self, exploring: usize) -> Self {
        self.spec.exploring = exploring;
        self
    }

    /// So many layouts.
    pub fn in_layouts(mut self, layouts: usize) -> Self {
        self.spec.layout_limits = vec![self.spec.max_episode_steps; layouts];
        self
    }

    pub fn with_lengths(lengths: Vec<usize>, begun: Vec<usize>, terminates: bool) -> Self {
        let spec = EnvSpec {
            num_envs: lengths.len(),
            observation_names: names(&["one", "last"]),
            action_names: names(&["nothing"]),
            episode_names: names(&["return"]),
            control_dt: 0.05,
            max_episode_steps: lengths.iter().copied().max().unwrap_or(0),
            layout_limits: vec![],
            autoreset: Autoreset::SameStep,
            exploring: 0,
        };
        Self { spec, steps: vec![0; lengths.len()], lengths, begun, terminates, reward: 1.0 }
    }
}

impl VectorEnv for Constant {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn reset(&mut self, _: Option<u64>, mask: Option<&[bool]>, observation: &mut [f32]) -> Result<(), EnvError> {
        for (i, (steps, begun)) in self.steps.iter_mut().zip(&self.begun).enumerate() {
            if mask.is_none_or(|mask| mask[i]) {
                *steps = *begun;
            }
        }
        observation.chunks_mut(2).for_each(|o| o.copy_from_slice(&[1.0, 0.0]));
        Ok(())
    }

    fn step(&mut self, _: &[f32], out: StepBuffers<'_>) -> Result<(), EnvError> {
        for (i, steps) in self.steps.iter_mut().enumerate() {
            *steps += 1;
            let end = *steps == self.lengths[i];
            out.reward[i] = self.reward;
            out.observation[2 * i..][..2].copy_from_slice(&[1.0, 0.0]);
            (out.terminated[i], out.truncated[i]) = (end && self.terminates, end && !self.terminates);
            if end {
                out.final_observation[2 * i..][..2].copy_from_slice(&[1.0, 0.0]);
                out.episode[i] = *steps as f32 * self.reward;
                *steps = 0;
            }
        }
        Ok(())
    }

    fn save_state(&self) -> Result<Vec<u8>, EnvError> {
        Ok(self.steps.iter().map(|&s| s as u8).collect())
    }

    fn load_state(&mut self, state: &[u8]) -> Result<(), EnvError> {
        self.steps.iter_mut().zip(state).for_each(|(s, &b)| *s = b.into());
        Ok(())
    }
}
