//! An environment that costs next to nothing, so that the learner is measured alone.

use myo_env::{EnvConfig, EnvError, EnvSpec, StepBuffers, VectorEnv};
use myo_train::PpoConfig;

/// Observations that never change, and a reward of two of the actions.
pub struct Idle(EnvSpec);

impl Idle {
    /// Observations of pointing with the built-in arm.
    pub const OBSERVATIONS: usize = 55;
    /// Its actions, one per muscle.
    pub const ACTIONS: usize = 26;

    /// With as many environments as these settings train in; they explore in name.
    pub fn new(config: &PpoConfig) -> Self {
        let EnvConfig { num_envs, exploring, .. } = config.envs(0);
        let names = |n: usize| (0..n).map(|i| i.to_string()).collect();
        Self(EnvSpec {
            num_envs,
            observation_names: names(Self::OBSERVATIONS),
            action_names: names(Self::ACTIONS),
            episode_names: Vec::new(),
            control_dt: 0.05,
            max_episode_steps: 240,
            layout_limits: vec![],
            autoreset: Default::default(),
            exploring,
        })
    }
}

impl VectorEnv for Idle {
    fn spec(&self) -> &EnvSpec {
        &self.0
    }
    fn reset(&mut self, _: Option<u64>, _: Option<&[bool]>, observation: &mut [f32]) -> Result<(), EnvError> {
        observation.iter_mut().enumerate().for_each(|(i, x)| *x = (i % 23) as f32 * 0.1);
        Ok(())
    }
    fn step(&mut self, actions: &[f32], out: StepBuffers<'_>) -> Result<(), EnvError> {
        out.reward.iter_mut().zip(actions.chunks(Self::ACTIONS)).for_each(|(r, a)| *r = a[0] - a[1] * a[1]);
        Ok(())
    }
    fn save_state(&self) -> Result<Vec<u8>, EnvError> {
        Ok(Vec::new())
    }
    fn load_state(&mut self, _: &[u8]) -> Result<(), EnvError> {
        Ok(())
    }
}
