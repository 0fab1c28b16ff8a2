//! Looks at how well the policy does, in environments of their own.

use myo_env::{EnvSpec, VectorEnv};

use crate::gpu::DeviceEvaluator;
use crate::{Evaluation, Policy, TrainError, evaluate};

/// Episodes of a quick look on the processor.
const QUICK_EPISODES: usize = 256;

/// Evaluates policies, each time on other fresh episodes.
pub struct Examiner {
    place: Place,
    training_seed: u64,
    taken: u64,
}

/// Where policies are evaluated.
enum Place {
    /// On the processor.
    Host(Box<dyn VectorEnv>),
    /// On the card.
    Card(Box<DeviceEvaluator>),
}

impl Examiner {
    /// Evaluates in these environments, on the processor; for a training with this seed.
    pub fn on_host(env: Box<dyn VectorEnv>, training_seed: u64) -> Self {
        Self { place: Place::Host(env), training_seed, taken: 0 }
    }

    /// Evaluates on the card, where as many episodes as environments take no longer than one.
    pub fn on_card(evaluator: DeviceEvaluator, training_seed: u64) -> Self {
        Self { place: Place::Card(Box::new(evaluator)), training_seed, taken: 0 }
    }

    /// The mean actions of `policy` on fresh episodes; `go_on` is asked now and then, and ends the evaluation early.
    ///
    /// # Errors
    /// The environments do not fit the policy, or the card is lost.
    pub fn evaluate(
        &mut self,
        policy: &mut Policy,
        episodes: usize,
        go_on: impl Fn() -> bool,
    ) -> Result<Evaluation, TrainError> {
        self.taken += 1;
        let seed = evaluation_seed(self.training_seed, self.taken);
        match &mut self.place {
            Place::Host(env) => evaluate(policy, env.as_mut(), episodes, seed, |_| go_on()),
            Place::Card(evaluator) => evaluator.evaluate(policy, episodes, seed, |_| go_on()),
        }
    }

    fn spec(&self) -> &EnvSpec {
        match &self.place {
            Place::Host(env) => env.spec(),
            Place::Card(evaluator) => evaluator.env().spec(),
        }
    }

    /// Episodes of a look that may turn out to be in vain.
    pub fn quick_episodes(&self) -> usize {
        match &self.place {
            Place::Host(_) => QUICK_EPISODES,
            Place::Card(_) => self.spec().num_envs,
        }
    }

    /// Control steps that an evaluation takes at most; nearly so many if any episode runs to its limit.
    pub fn cost(&self, episodes: usize) -> u64 {
        let EnvSpec { num_envs, max_episode_steps, .. } = *self.spec();
        (episodes.div_ceil(num_envs) * num_envs * max_episode_steps) as u64
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
