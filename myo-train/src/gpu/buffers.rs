//! The buffers of a roll-out.

use myo_gpu::{Buffer, Gpu, GpuError};

use super::sizes::Sizes;

/// What a roll-out writes, feature-major; see [`Sizes`] for the columns.
#[derive(Clone, Debug)]
pub struct RolloutBuffers {
    /// Normalised observations, `(observations, columns)`.
    pub observation: Buffer<f32>,
    /// Outputs of the policy before they are mapped and clipped, `(actions, samples)`. Holds noise before the step.
    pub action: Buffer<f32>,
    /// Noise of earlier steps that is left in the actions of the environment, in standard deviations, `(actions, samples)`.
    pub held: Buffer<f32>,
    /// Logarithms of their probability densities, `(samples)`.
    pub log_prob: Buffer<f32>,
    /// Values of the observations, `(columns)`.
    pub value: Buffer<f32>,
    /// Scaled rewards, `(samples)`.
    pub reward: Buffer<f32>,
    /// 1 where the task ended the episode, 2 where the time limit did, else 0, `(samples)`.
    pub ended: Buffer<u32>,
    /// Sums over the episodes of every environment, `(1 + 2 summary, envs)`.
    pub episodes: Buffer<f32>,
    /// Sums over parts of the observations, `(2 observations, partial moments)`.
    pub moments: Buffer<f32>,
    /// Sums: moments `(2 observations)`, episodes `(1 + 2 summary)`, those without noise alike, scaled rewards of every step
    /// `(steps)`, and where there are several layouts, episodes of each `(layouts, 1 + 2 summary)`.
    pub sums: Buffer<f32>,
    /// The least observation entry that was NaN or infinite, or [`ALL_FINITE`].
    pub wrong: Buffer<u32>,
}

/// What [`RolloutBuffers::wrong`] holds when all is well.
pub const ALL_FINITE: u32 = u32::MAX;

impl RolloutBuffers {
    /// Memory for a roll-out, zero.
    ///
    /// # Errors
    /// There is no memory left, a buffer is larger than the card allows, or the card is lost.
    pub fn new(gpu: &Gpu, sizes: &Sizes) -> Result<Self, GpuError> {
        let (samples, columns) = (sizes.samples(), sizes.columns());
        Ok(Self {
            observation: gpu.buffer("observation record", sizes.observations * columns)?,
            action: gpu.buffer("action record", sizes.actions * samples)?,
            held: gpu.buffer("held noise", sizes.actions * samples)?,
            log_prob: gpu.buffer("log_prob record", samples)?,
            value: gpu.buffer("value record", columns)?,
            reward: gpu.buffer("reward record", samples)?,
            ended: gpu.buffer("ended record", samples)?,
            episodes: gpu.buffer("episode sums", sizes.episode_rows() * sizes.envs)?,
            moments: gpu.buffer("moments", 2 * sizes.observations * sizes.partial_moments())?,
            sums: gpu.buffer("sums", sizes.sums())?,
            wrong: gpu.buffer("wrong", 1)?,
        })
    }

    /// Those of one group.
    pub(super) fn of(&self, group: usize) -> Self {
        Self {
            observation: self.observation.of(group),
            action: self.action.of(group),
            held: self.held.of(group),
            log_prob: self.log_prob.of(group),
            value: self.value.of(group),
            reward: self.reward.of(group),
            ended: self.ended.of(group),
            episodes: self.episodes.of(group),
            moments: self.moments.of(group),
            sums: self.sums.of(group),
            wrong: self.wrong.of(group),
        }
    }
}
