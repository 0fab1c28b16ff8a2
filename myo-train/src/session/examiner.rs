//! Looks at how well the policy does, in environments of their own.

use myo_env::{EnvSpec, VectorEnv};

use crate::gpu::DeviceEvaluator;
use crate::{Evaluation, Policy, TrainError, evaluate};

/// Episodes of a quick look on the processor.
const QUICK_EPISODES: usize = 256;

/// Evaluates policies on fresh episodes, each time on others.
pub struct Examiner {
    env: ExaminerEnv,
    training_seed: u64,
}

/// Where policies are evaluated.
enum ExaminerEnv {
    /// On the processor.
    Host(Box<dyn VectorEnv>),
    /// On the card.
    Card(Box<DeviceEvaluator>),
}

impl Examiner {
    /// Evaluates in these environments, on the processor; for a training with this seed.
    pub fn on_host(env: Box<dyn VectorEnv>, training_seed: u64) -> Self {
        Self { env: ExaminerEnv::Host(env), training_seed }
    }

    /// Evaluates on the card, where as many episodes as environments take no longer than one.
    pub fn on_card(evaluator: DeviceEvaluator, training_seed: u64) -> Self {
        Self { env: ExaminerEnv::Card(Box::new(evaluator)), training_seed }
    }

    /// The mean actions of `policy` on fresh episodes, those of the `number`-th evaluation; `go_on` is asked now and then,
    /// and ends the evaluation early.
    ///
    /// # Errors
    /// The environments do not fit the policy, or the card is lost.
    pub fn evaluate(
        &mut self,
        policy: &mut Policy,
        episodes: usize,
        number: u64,
        go_on: impl Fn() -> bool,
    ) -> Result<Evaluation, TrainError> {
        let seed = evaluation_seed(self.training_seed, number);
        match &mut self.env {
            ExaminerEnv::Host(env) => evaluate(policy, env.as_mut(), episodes, seed, |_| go_on()),
            ExaminerEnv::Card(evaluator) => evaluator.evaluate(policy, episodes, seed, |_| go_on()),
        }
    }

    fn spec(&self) -> &EnvSpec {
        match &self.env {
            ExaminerEnv::Host(env) => env.spec(),
            ExaminerEnv::Card(evaluator) => evaluator.env().spec(),
        }
    }

    /// Episodes, of each layout, of a look that may turn out to be in vain.
    pub fn quick_episodes(&self) -> usize {
        match &self.env {
            ExaminerEnv::Host(_) => QUICK_EPISODES,
            ExaminerEnv::Card(_) => {
                let num_envs = self.spec().num_envs;
                (num_envs / self.spec().layouts()).max(QUICK_EPISODES.min(num_envs))
            }
        }
    }

    /// Control steps that an evaluation of so many episodes of each layout takes at most; nearly so many if any episode runs to
    /// its limit.
    pub fn cost(&self, episodes: usize) -> u64 {
        let &EnvSpec { num_envs, max_episode_steps, .. } = self.spec();
        let layouts = self.spec().layouts();
        ((episodes * layouts).div_ceil(num_envs) * num_envs * max_episode_steps) as u64
    }
}

/// A seed for the `number`-th evaluation that is not the one of the training; number 0 is that of `myo eval`.
pub fn evaluation_seed(training_seed: u64, number: u64) -> u64 {
    // SplitMix64 (Steele et al. 2014, doi 10.1145/2714064.2660195): neighbours become far apart.
    let mut z = training_seed.wrapping_add((number + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
