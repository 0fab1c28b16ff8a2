//! Reading a whole roll-out from the card into the processor's memory, for tests that compare.

use myo_env::VectorEnv;
use rayon::prelude::*;

use super::buffers::ALL_FINITE;
use super::rollout::DeviceRollout;
use super::sizes::Sizes;
use crate::metrics::EpisodeSums;
use crate::rollout::{Actor, Rollout};
use crate::{Normalizer, TrainError};

/// Memory of the host, as the buffers of the same names on the card.
#[derive(Default)]
struct HostCopy {
    observation: Vec<f32>,
    action: Vec<f32>,
    log_prob: Vec<f32>,
    value: Vec<f32>,
    reward: Vec<f32>,
    ended: Vec<u32>,
    sums: Vec<f32>,
    wrong: [u32; 1],
    /// Current raw observations.
    current: Vec<f32>,
}

impl DeviceRollout {
    /// Runs a roll-out on the card and reads it: what [`Rollout::collect`] does on the processor, and the values. One
    /// submission and one wait.
    pub(crate) fn collect(
        &mut self,
        actor: &Actor<'_>,
        first_step: u64,
        rollout: &mut Rollout,
        observation: &mut [f32],
    ) -> Result<(), TrainError> {
        self.set_parameters(actor.parameters)?;
        self.set_scaling(actor.normalizer)?;
        self.set_clock(actor.seed, first_step)?;
        let mut host = HostCopy::default();
        self.read(&mut host)?;
        unpack(self.sizes(), actor.normalizer, &host, rollout, observation);
        let update = first_step / self.sizes().steps as u64;
        check(&self.env().spec().observation_names, &host, rollout, update)
    }

    /// Runs a roll-out and reads everything that learning needs.
    fn read(&self, host: &mut HostCopy) -> Result<(), TrainError> {
        let (buffers, shard) = (self.buffers(), &self.env().shards()[0]);
        host.observation.resize(buffers.observation.len(), 0.0);
        host.action.resize(buffers.action.len(), 0.0);
        host.log_prob.resize(buffers.log_prob.len(), 0.0);
        host.value.resize(buffers.value.len(), 0.0);
        host.reward.resize(buffers.reward.len(), 0.0);
        host.ended.resize(buffers.ended.len(), 0);
        host.sums.resize(buffers.sums.len(), 0.0);
        host.current.resize(shard.observation.len(), 0.0);
        let mut batch = self.gpu().batch();
        self.record(&mut batch);
        batch.submit_and_read(&mut [
            buffers.observation.part(0, &mut host.observation)?,
            buffers.action.part(0, &mut host.action)?,
            buffers.log_prob.part(0, &mut host.log_prob)?,
            buffers.value.part(0, &mut host.value)?,
            buffers.reward.part(0, &mut host.reward)?,
            buffers.ended.part(0, &mut host.ended)?,
            buffers.sums.part(0, &mut host.sums)?,
            buffers.wrong.part(0, &mut host.wrong)?,
            shard.observation.part(0, &mut host.current)?,
        ])?;
        Ok(())
    }
}

/// Feature-major columns to rows of samples, leaving out idle columns: `(rows, stride)` to `(steps, envs, rows)`.
fn transpose(columns: &[f32], stride: usize, sizes: &Sizes, rows: usize, out: &mut [f32]) {
    out.par_chunks_mut(rows * sizes.envs).enumerate().for_each(|(t, out)| {
        for (row, columns) in columns.chunks_exact(stride).enumerate() {
            let column = &columns[t * sizes.padded..][..sizes.envs];
            out[row..].iter_mut().step_by(rows).zip(column).for_each(|(out, x)| *out = *x);
        }
    });
}

fn unpack(sizes: &Sizes, normalizer: &Normalizer, host: &HostCopy, rollout: &mut Rollout, observation: &mut [f32]) {
    transpose(&host.observation, sizes.columns(), sizes, sizes.observations, &mut rollout.observation);
    transpose(&host.action, sizes.samples(), sizes, sizes.actions, &mut rollout.action);
    transpose(&host.log_prob, sizes.samples(), sizes, 1, &mut rollout.log_prob);
    transpose(&host.reward, sizes.samples(), sizes, 1, &mut rollout.reward);
    transpose(&host.value, sizes.columns(), sizes, 1, &mut rollout.value);
    let current = Sizes { padded: sizes.envs, ..*sizes };
    transpose(&host.current, sizes.envs, &current, sizes.observations, observation);
    unpack_ends(sizes, host, rollout);
    let [moments, episodes, noise_free, _, layouts] = sizes.split_sums(&host.sums);
    rollout.moments = normalizer.moments_from_f32(sizes.steps * sizes.envs, moments);
    [rollout.episodes, rollout.noise_free] = [episodes, noise_free].map(EpisodeSums::from_rows);
    rollout.layouts = layouts.chunks_exact(sizes.episode_rows()).map(EpisodeSums::from_rows).collect();
}

/// Where episodes ended, and what the future was worth after every step.
fn unpack_ends(sizes: &Sizes, host: &HostCopy, rollout: &mut Rollout) {
    for t in 0..sizes.steps {
        for env in 0..sizes.envs {
            let (i, column) = (t * sizes.envs + env, t * sizes.padded + env);
            rollout.ended[i] = host.ended[column] != 0;
            rollout.next_value[i] = match host.ended[column] {
                0 => host.value[column + sizes.padded],
                1 => 0.0,
                _ => host.value[sizes.last_column(t) + env],
            };
        }
    }
}

fn check(names: &[String], host: &HostCopy, rollout: &Rollout, update: u64) -> Result<(), TrainError> {
    let non_finite = |what| Err(TrainError::NonFiniteEnv { what, update });
    match host.wrong[0] {
        ALL_FINITE if rollout.reward.iter().all(|r| r.is_finite()) => Ok(()),
        ALL_FINITE => non_finite("reward".into()),
        index => non_finite(format!("observation \"{}\"", names[index as usize])),
    }
}
