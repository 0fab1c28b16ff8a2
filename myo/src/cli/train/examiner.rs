//! Evaluation during training.

use myo::train::{Evaluation, Policy, evaluate};

use crate::cli::backend::Place;
use crate::cli::envs::Envs;
use crate::cli::failure::Result;
use crate::cli::interrupt::Interrupt;
use crate::cli::stage::Stage;

/// Environments that evaluate side by side.
const ENVS: usize = 256;

/// Evaluates policies, each time on other fresh episodes. On the processor always: so few environments are no work for a
/// graphics card.
pub struct Examiner<'a> {
    stage: &'a Stage,
    training_seed: u64,
    taken: u64,
    env: Option<Envs>,
}

impl<'a> Examiner<'a> {
    /// For a training with this seed.
    pub fn new(stage: &'a Stage, training_seed: u64) -> Self {
        Self { stage, training_seed, taken: 0, env: None }
    }

    /// The deterministic policy on fresh episodes; none when interrupted.
    pub fn evaluate(
        &mut self,
        policy: &mut Policy,
        episodes: usize,
        interrupt: &Interrupt,
    ) -> Result<Option<Evaluation>> {
        self.taken += 1;
        let seed = evaluation_seed(self.training_seed, self.taken);
        let mut env = match self.env.take() {
            Some(env) => env,
            None => self.stage.env_at(&Place::Cpu, ENVS, seed)?,
        };
        let evaluation = evaluate(policy, env.as_mut(), episodes, seed, |_| !interrupt.wanted())?;
        self.env = Some(env);
        Ok(Some(evaluation).filter(|_| !interrupt.wanted()))
    }

    /// Control steps that an evaluation takes at most; nearly so many if any episode runs to its limit.
    pub fn cost(&self, episodes: usize) -> u64 {
        let rounds = episodes.div_ceil(ENVS) as u64;
        rounds * ENVS as u64 * u64::from(self.stage.task.time_limit_steps())
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
