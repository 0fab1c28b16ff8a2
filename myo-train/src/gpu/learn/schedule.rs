//! What the host works out before and after an update.

use super::memory::STEP_METRICS;
use super::update::Settings;
use crate::learn::LearnStats;
use crate::{PpoConfig, TrainError};

/// Per gradient step: the learning rate over `1 - beta1^t`, and `1 / sqrt(1 - beta2^t)`; in double precision, for powers.
pub fn rates(config: &PpoConfig, settings: Settings, steps: usize) -> Vec<[f32; 2]> {
    let rate = |step: usize| {
        let t = (settings.gradient_steps + 1 + step as u64) as f64;
        let step = settings.learning_rate / (1.0 - config.adam_beta1.powf(t));
        [step as f32, (1.0 / (1.0 - config.adam_beta2.powf(t)).sqrt()) as f32]
    };
    (0..steps).map(rate).collect()
}

/// Means over an update from the sums of every gradient step.
pub fn stats(metrics: &[f32], samples: &[f64], minibatches: usize, update: u64) -> Result<LearnStats, TrainError> {
    let (mut stats, steps) = (LearnStats::default(), samples.len());
    let share = 1.0 / steps as f64;
    for (step, (metrics, &n)) in metrics.chunks_exact(STEP_METRICS).zip(samples).enumerate() {
        let n = n.max(1.0);
        let mut numbers = [0.0; STEP_METRICS];
        numbers.iter_mut().zip(metrics).for_each(|(wide, &x)| *wide = f64::from(x));
        let [loss, kl, clipped, value, norm, wrong] = numbers;
        for (what, x) in [("policy loss", loss), ("value loss", value), ("gradient", norm)] {
            if !x.is_finite() {
                return Err(TrainError::Diverged { what, update });
            }
        }
        if wrong != 0.0 {
            return Err(TrainError::Diverged { what: "a weight", update });
        }
        stats.policy_loss += loss / n * share;
        stats.value_loss += value / n * share;
        stats.clip_fraction += clipped / n * share;
        stats.gradient_norm += norm * share;
        if step + minibatches >= steps {
            stats.kl += kl / n / minibatches as f64;
        }
    }
    Ok(stats)
}
