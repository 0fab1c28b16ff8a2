//! How the samples of a roll-out lie in the buffers.

use myo_env::EnvSpec;

use super::dense::GROUP;
use super::kernels::OBSERVE_WORKGROUP;
use crate::PpoConfig;
use crate::rollout::told_layouts;

/// Sizes of a roll-out. Its samples are columns: environment `e` in step `t` is column `t * padded + e`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Control steps.
    pub steps: usize,
    /// Draws that the exploration noise of an action is the sum of.
    pub noise_steps: usize,
    /// Environments.
    pub envs: usize,
    /// The first so many of them, whose episodes are whole and count.
    pub counted: usize,
    /// The first so many of these, which act without noise and count by themselves.
    pub noise_free: usize,
    /// Layouts whose episodes are told apart: none where there is but one.
    pub layouts: usize,
    /// Columns of one step: `envs` rounded up to a multiple of four.
    pub padded: usize,
    /// Entries of an observation.
    pub observations: usize,
    /// Entries of an action.
    pub actions: usize,
    /// Entries of the summary of an episode.
    pub summary: usize,
    /// Control steps from one cut by the time limit to the next of the same environment, at least.
    pub between_cuts: usize,
    /// Seconds of simulated time per control step.
    pub control_dt: f64,
}

impl Sizes {
    /// For an environment and settings.
    pub fn new(spec: &EnvSpec, config: &PpoConfig) -> Self {
        Self {
            steps: config.steps_per_update(spec.control_dt),
            noise_steps: config.exploration_steps(spec.control_dt),
            envs: spec.num_envs,
            counted: spec.whole_episodes(),
            noise_free: config.noise_free_envs(),
            layouts: told_layouts(spec),
            padded: spec.num_envs.next_multiple_of(GROUP),
            observations: spec.observation_size(),
            actions: spec.action_size(),
            summary: spec.episode_size(),
            between_cuts: spec.steps_between_cuts(),
            control_dt: spec.control_dt,
        }
    }

    /// Columns of all actions, rewards and so on.
    pub fn samples(&self) -> usize {
        self.steps * self.padded
    }

    /// Columns of all observations: those before every step, those after the last, and last ones of episodes that the
    /// time limit cut off.
    pub fn columns(&self) -> usize {
        (self.steps + 1 + self.steps.div_ceil(self.between_cuts)) * self.padded
    }

    /// First column for the last observations of episodes cut off in step `t`. The time limit cuts an environment off
    /// once in `between_cuts` steps, so steps that share these columns never meet in one environment.
    pub fn last_column(&self, t: usize) -> usize {
        (self.steps + 1 + t / self.between_cuts) * self.padded
    }

    /// Workgroups per observation entry that keep observations.
    pub fn observe_chunks(&self) -> usize {
        self.envs.div_ceil(OBSERVE_WORKGROUP)
    }

    /// Partial moments of one observation entry: those before every step, and of the observations after the last, which
    /// do not count.
    pub fn partial_moments(&self) -> usize {
        (self.steps + 1) * self.observe_chunks()
    }

    /// How many [sums](super::RolloutBuffers::sums) there are.
    pub(super) fn sums(&self) -> usize {
        2 * self.observations + (2 + self.layouts) * self.episode_rows() + self.steps
    }

    /// Their parts: of moments, of episodes with noise and without, of rewards, of episodes with noise of each layout.
    pub(super) fn split_sums<'a>(&self, sums: &'a [f32]) -> [&'a [f32]; 5] {
        let (moments, rest) = sums.split_at(2 * self.observations);
        let (episodes, rest) = rest.split_at(self.episode_rows());
        let (noise_free, rest) = rest.split_at(self.episode_rows());
        let (rewards, layouts) = rest.split_at(self.steps);
        [moments, episodes, noise_free, rewards, layouts]
    }

    /// Rows of the sums over episodes: their number, then sums and counts of the entries of their summaries.
    pub fn episode_rows(&self) -> usize {
        1 + 2 * self.summary
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_observations_of_one_environment_never_share_a_column() {
        let sizes = Sizes {
            steps: 17,
            noise_steps: 1,
            envs: 5,
            counted: 5,
            noise_free: 0,
            layouts: 0,
            padded: 8,
            observations: 3,
            actions: 2,
            summary: 4,
            between_cuts: 5,
            control_dt: 0.05,
        };
        for first in 0..sizes.between_cuts {
            let columns: Vec<_> =
                (first..sizes.steps).step_by(sizes.between_cuts).map(|t| sizes.last_column(t)).collect();
            assert!(columns.is_sorted_by(|a, b| a + sizes.padded <= *b), "{columns:?}");
            assert!(columns.iter().all(|c| c + sizes.padded <= sizes.columns()));
        }
    }
}
