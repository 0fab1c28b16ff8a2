//! Learning from a roll-out: minibatches, gradients, Adam.

use std::ops::Range;

use rayon::prelude::*;

use crate::config::LogStd;
use crate::gaussian::{self, Spread, Surrogate, SurrogateSums};
use crate::kernels;
use crate::networks::{CHUNK_ROWS, ChunkWork, Lender, Networks};
use crate::random::shuffle;
use crate::rollout::Rollout;
use crate::{PpoConfig, TrainError};

/// At most this many partial gradients per minibatch. Each sums its share of the samples in order, then they are summed in
/// order: the result does not depend on which thread did what. More parts occupy more threads and cost more additions.
const GRADIENT_PARTS: usize = 32;

/// Samples below which a share is not worth a part of its own.
const PART_ROWS: usize = 2 * CHUNK_ROWS;

/// Parameters that one task sums up or moves at a time.
const PARAMETER_BLOCK: usize = 4096;

/// Adam's memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimizer {
    /// Decaying mean of the gradient.
    pub mean: Vec<f32>,
    /// Decaying mean of its square.
    pub square: Vec<f32>,
    /// Steps done.
    pub steps: u64,
}

/// Means over one update.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LearnStats {
    /// Clipped objective, negated.
    pub policy_loss: f64,
    /// Mean squared error of the value network.
    pub value_loss: f64,
    /// Divergence from the collecting policy, mean over the last pass.
    pub kl: f64,
    /// Share of samples whose gradient was cut off.
    pub clip_fraction: f64,
    /// Length of the gradient before it is shortened.
    pub gradient_norm: f64,
}

/// Memory of learning.
pub struct Learner {
    gradients: Vec<f32>,
    order: Vec<u32>,
    words: Vec<u32>,
    part_sums: Vec<Sums>,
    block_squares: Vec<f64>,
    /// Bounds of the logarithms of the standard deviations.
    log_std: LogStd,
    /// Half width of the band of probability ratios.
    clip: f32,
}

#[derive(Clone, Copy, Default)]
struct Sums {
    policy: SurrogateSums,
    value: f64,
}

/// What one gradient needs.
struct Minibatch<'a> {
    networks: &'a Networks,
    parameters: &'a [f32],
    spread: &'a Spread,
    rollout: &'a Rollout,
    samples: &'a [u32],
    advantage_mean: f32,
    advantage_scale: f32,
    /// Half width of the band of probability ratios.
    clip: f32,
    config: &'a PpoConfig,
}

impl Learner {
    /// Partial gradients that there is memory for.
    pub fn gradient_parts(config: &PpoConfig, control_dt: f64) -> usize {
        part_count(config.batch_size(control_dt).div_ceil(config.minibatches))
    }

    /// Memory for batches of `config`, with control steps of `control_dt` seconds.
    pub fn new(networks: &Networks, config: &PpoConfig, control_dt: f64) -> Self {
        let (parts, batch) = (Self::gradient_parts(config, control_dt), config.batch_size(control_dt));
        Self {
            gradients: vec![0.0; parts * networks.len()],
            order: vec![0; batch],
            words: vec![0; batch],
            part_sums: vec![Sums::default(); parts],
            log_std: config.log_std(control_dt),
            clip: config.ratio_clip(control_dt),
            block_squares: vec![0.0; networks.len().div_ceil(PARAMETER_BLOCK)],
        }
    }

    /// Passes over the roll-out; moves `parameters` and `optimizer`. None if `go_on`, asked before every minibatch, ended it
    /// early.
    #[allow(clippy::too_many_arguments)]
    pub fn learn(
        &mut self,
        networks: &Networks,
        rollout: &Rollout,
        config: &PpoConfig,
        (seed, update): (u64, u64),
        learning_rate: f64,
        lender: &Lender<ChunkWork>,
        parameters: &mut [f32],
        optimizer: &mut Optimizer,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<LearnStats>, TrainError> {
        let (mut stats, batch) = (LearnStats::default(), self.order.len());
        let share = 1.0 / (config.epochs * config.minibatches) as f64;
        for epoch in 0..config.epochs {
            shuffle(seed, update * config.epochs as u64 + epoch as u64, &mut self.order, &mut self.words);
            for index in 0..config.minibatches {
                if !go_on() {
                    return Ok(None);
                }
                let samples = index * batch / config.minibatches..(index + 1) * batch / config.minibatches;
                let (n, parts) = (samples.len() as f64, part_count(samples.len()));
                let sums = self.gradient(networks, parameters, rollout, samples, config, lender);
                let norm = self.reduce(networks.len(), parts);
                for (what, x) in [("policy loss", sums.policy.loss), ("value loss", sums.value), ("gradient", norm)] {
                    if !x.is_finite() {
                        return Err(TrainError::Diverged { what, update });
                    }
                }
                self.descend(networks, config, learning_rate, norm, parameters, optimizer);
                stats.policy_loss += sums.policy.loss / n * share;
                stats.value_loss += sums.value / n * share;
                stats.clip_fraction += sums.policy.clipped / n * share;
                stats.gradient_norm += norm * share;
                if epoch + 1 == config.epochs {
                    stats.kl += sums.policy.kl / n / config.minibatches as f64;
                }
            }
        }
        if parameters.iter().any(|w| !w.is_finite()) {
            return Err(TrainError::Diverged { what: "a weight", update });
        }
        Ok(Some(stats))
    }

    /// Partial gradients of the loss on the samples at these places of the order.
    fn gradient(
        &mut self,
        networks: &Networks,
        parameters: &[f32],
        rollout: &Rollout,
        samples: Range<usize>,
        config: &PpoConfig,
        lender: &Lender<ChunkWork>,
    ) -> Sums {
        let samples = &self.order[samples];
        let spread = networks.spread(parameters);
        let (advantage_mean, advantage_scale) = mean_and_scale(&rollout.advantage, samples);
        let batch = Minibatch {
            networks,
            parameters,
            spread: &spread,
            rollout,
            samples,
            advantage_mean,
            advantage_scale,
            clip: self.clip,
            config,
        };
        let parts = part_count(samples.len());
        let gradients = self.gradients.par_chunks_mut(networks.len());
        gradients.zip(self.part_sums.par_iter_mut()).take(parts).enumerate().for_each(|(part, (gradient, sums))| {
            let n = samples.len();
            let share = &samples[part * n / parts..(part + 1) * n / parts];
            lender.with(|| networks.work(), |work| *sums = batch.part(share, work, gradient));
        });
        // d(-entropy) / d log_std = -1, once for the whole minibatch
        let log_std_gradient = &mut self.gradients[networks.log_std_range()];
        log_std_gradient.iter_mut().for_each(|g| *g -= config.entropy_coefficient as f32);
        let mut total = Sums::default();
        for sums in &self.part_sums[..parts] {
            total.policy.loss += sums.policy.loss;
            total.policy.kl += sums.policy.kl;
            total.policy.clipped += sums.policy.clipped;
            total.value += sums.value;
        }
        total
    }

    /// Sums the partial gradients into the first; returns the length of the sum.
    fn reduce(&mut self, len: usize, parts: usize) -> f64 {
        let (total, others) = self.gradients.split_at_mut(len);
        let others = &others[..(parts - 1) * len];
        total.par_chunks_mut(PARAMETER_BLOCK).zip(self.block_squares.par_iter_mut()).enumerate().for_each(
            |(block, (total, squares))| {
                for part in others.chunks_exact(len) {
                    kernels::add_assign(total, &part[block * PARAMETER_BLOCK..][..total.len()]);
                }
                *squares = kernels::sum_squares(total);
            },
        );
        self.block_squares.iter().sum::<f64>().sqrt()
    }

    /// One Adam step with the gradient shortened to `gradient_norm_max`.
    fn descend(
        &self,
        networks: &Networks,
        config: &PpoConfig,
        learning_rate: f64,
        norm: f64,
        parameters: &mut [f32],
        optimizer: &mut Optimizer,
    ) {
        optimizer.steps += 1;
        let t = optimizer.steps as f64;
        let scale = (config.gradient_norm_max / norm).min(1.0) as f32;
        let step = (learning_rate / (1.0 - config.adam_beta1.powf(t))) as f32;
        let inverse_bias = (1.0 / (1.0 - config.adam_beta2.powf(t)).sqrt()) as f32;
        let (epsilon, beta1, beta2) = (config.adam_epsilon as f32, config.adam_beta1 as f32, config.adam_beta2 as f32);
        (parameters.par_chunks_mut(PARAMETER_BLOCK))
            .zip(optimizer.mean.par_chunks_mut(PARAMETER_BLOCK))
            .zip(optimizer.square.par_chunks_mut(PARAMETER_BLOCK))
            .zip(self.gradients[..networks.len()].par_chunks(PARAMETER_BLOCK))
            .for_each(|(((w, m), v), g)| {
                kernels::adam(w, m, v, g, scale, step, inverse_bias, epsilon, beta1, beta2);
            });
        for log_std in &mut parameters[networks.log_std_range()] {
            *log_std = log_std.clamp(self.log_std.min as f32, self.log_std.max as f32);
        }
    }
}

impl Minibatch<'_> {
    /// Gradient and sums of a share of the samples, chunk by chunk.
    fn part(&self, share: &[u32], work: &mut ChunkWork, gradient: &mut [f32]) -> Sums {
        let (networks, rollout) = (self.networks, self.rollout);
        let (n_obs, n_act) = (networks.policy.inputs(), networks.policy.outputs());
        let weight = 1.0 / self.samples.len() as f32;
        let settings = Surrogate { clip: self.clip, weight, bound: self.config.bound() };
        let (policy_gradient, rest) = gradient.split_at_mut(networks.policy.len());
        let (log_std_gradient, value_gradient) = rest.split_at_mut(n_act);
        log_std_gradient.fill(0.0);
        let mut sums = Sums::default();
        for (index, samples) in share.chunks(CHUNK_ROWS).enumerate() {
            let rows = samples.len();
            let x = &mut work.observation[..rows * n_obs];
            kernels::gather_rows(&rollout.observation, n_obs, samples, x);
            let action = &mut work.action[..rows * n_act];
            kernels::gather_rows(&rollout.action, n_act, samples, action);
            let [log_prob, advantage, target] = &mut work.scalars;
            for (row, &i) in samples.iter().enumerate() {
                log_prob[row] = rollout.log_prob[i as usize];
                advantage[row] = (rollout.advantage[i as usize] - self.advantage_mean) * self.advantage_scale;
                target[row] = rollout.target[i as usize];
            }

            let parameters = &self.parameters[networks.policy_range()];
            let mean = networks.policy.forward_for_gradient(parameters, x, &mut work.policy);
            let part = gaussian::clipped_surrogate(
                mean,
                action,
                &self.spread.inverse_std,
                self.spread.log_peak,
                &log_prob[..rows],
                &advantage[..rows],
                settings,
                log_std_gradient,
            );
            networks.policy.backward(parameters, x, &mut work.policy, policy_gradient, index > 0);

            let parameters = &self.parameters[networks.value_range()];
            let value = networks.value.forward_for_gradient(parameters, x, &mut work.value);
            let factor = self.config.value_coefficient as f32 * weight;
            sums.value += gaussian::squared_error(value, &target[..rows], factor);
            networks.value.backward(parameters, x, &mut work.value, value_gradient, index > 0);

            sums.policy.loss += part.loss;
            sums.policy.kl += part.kl;
            sums.policy.clipped += part.clipped;
        }
        sums
    }
}

/// Partial gradients for a minibatch of `samples`.
fn part_count(samples: usize) -> usize {
    (samples / PART_ROWS).clamp(1, GRADIENT_PARTS)
}

/// Mean of `x` at `samples`, and one over its standard deviation.
fn mean_and_scale(x: &[f32], samples: &[u32]) -> (f32, f32) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for &i in samples {
        let x = f64::from(x[i as usize]);
        sum += x;
        squares += x * x;
    }
    let n = samples.len() as f64;
    let mean = sum / n;
    // Equal advantages have no scale: they are left at zero.
    let std = (squares / n - mean * mean).max(0.0).sqrt();
    (mean as f32, (1.0 / (std + 1e-8)) as f32)
}
