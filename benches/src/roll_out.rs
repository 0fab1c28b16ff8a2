//! A record of made-up numbers on a graphics card, to learn from.

use myo_gpu::{Buffer, Gpu};
use myo_train::PpoConfig;
use myo_train::gpu::{RolloutBuffers, Sizes};

use crate::{Failure, Idle, Numbers};

/// A roll-out as the environment would have left it, and parameters of the networks.
pub struct RollOut {
    /// Its sizes.
    pub sizes: Sizes,
    /// Its numbers.
    pub record: RolloutBuffers,
    /// Those of the policy, its deviations, those of the value network.
    pub parameters: Buffer<f32>,
}

impl RollOut {
    /// Observations and actions of pointing with the built-in arm, as many as the settings ask for.
    pub fn new(gpu: &Gpu, config: &PpoConfig) -> Result<Self, Failure> {
        let (envs, steps) = (config.num_envs, config.steps_per_update(0.05));
        let (observations, actions, padded) = (Idle::OBSERVATIONS, Idle::ACTIONS, envs.next_multiple_of(4));
        let sizes = Sizes {
            steps,
            noise_steps: 1,
            envs,
            counted: envs,
            noise_free: config.noise_free_envs(),
            layouts: 0,
            padded,
            observations,
            actions,
            summary: 5,
            between_cuts: 100,
            control_dt: 0.05,
        };
        let record = RolloutBuffers::new(gpu, &sizes)?;
        let filled = [&record.observation, &record.action, &record.value, &record.reward];
        for (seed, buffer) in filled.into_iter().enumerate() {
            gpu.write(buffer, 0, &Numbers::signed(seed as u32, buffer.len()))?;
        }
        gpu.write(&record.log_prob, 0, &vec![-24.0; record.log_prob.len()])?;
        let layers = |hidden: &[usize], outputs: usize| {
            let widths: Vec<_> = [observations].iter().chain(hidden).chain(&[outputs]).copied().collect();
            widths.windows(2).map(|w| w[0] * w[1] + w[1]).sum::<usize>()
        };
        let len = layers(&config.policy_hidden, actions) + actions + layers(&config.value_hidden, 1);
        let parameters = gpu.buffer("parameters", len)?;
        gpu.write(&parameters, 0, &Numbers::signed(9, len).iter().map(|x| 0.1 * x).collect::<Vec<_>>())?;
        Ok(Self { sizes, record, parameters })
    }
}
