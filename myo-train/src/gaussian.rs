//! A normal distribution over actions with a mean per state and one standard deviation per action.

use crate::simd::{clip, exp, kernels, madd};

/// `ln(2 pi) / 2`.
const HALF_LN_TAU: f32 = 0.918_938_5;

/// Partial sums a row is added up in, so that the sum vectorises; the order is fixed.
const WIDTH: usize = 16;

/// Sum over a row of `f(index)`, with `f` inlined.
#[inline(always)]
fn row_sum(n: usize, mut f: impl FnMut(usize) -> f32) -> f32 {
    let mut partial = [0.0_f32; WIDTH];
    let full = n / WIDTH * WIDTH;
    let mut start = 0;
    while start < full {
        for (lane, p) in partial.iter_mut().enumerate() {
            *p += f(start + lane);
        }
        start += WIDTH;
    }
    for (lane, p) in partial.iter_mut().enumerate().take(n - full) {
        *p += f(full + lane);
    }
    let mut sum = 0.0;
    for p in partial {
        sum += p;
    }
    sum
}

/// The parts of the distribution that do not depend on the state.
#[derive(Clone, Debug)]
pub struct Spread {
    /// Standard deviations.
    pub std: Vec<f32>,
    /// Their inverses.
    pub inverse_std: Vec<f32>,
    /// Logarithm of the density at the mean.
    pub log_peak: f32,
    /// Entropy in nats.
    pub entropy: f32,
}

impl Spread {
    /// For the logarithms of the standard deviations.
    pub fn new(log_std: &[f32]) -> Self {
        let n = log_std.len() as f32;
        let sum: f32 = log_std.iter().sum();
        let std = || log_std.iter().map(|&s| exp::<false>(s));
        Self {
            std: std().collect(),
            inverse_std: std().map(f32::recip).collect(),
            log_peak: -sum - n * HALF_LN_TAU,
            entropy: sum + n * (HALF_LN_TAU + 0.5),
        }
    }
}

/// Settings of [`clipped_surrogate`].
#[derive(Clone, Copy, Debug)]
pub struct Surrogate {
    /// Half width of the band of ratios.
    pub clip: f32,
    /// Weight of one sample: one over the size of the minibatch.
    pub weight: f32,
    /// What holds means where actions have an effect.
    pub bound: Bound,
}

/// Draws the means of actions back from where the environment clips them: half of `factor` times the squared distance is added to the loss.
///
/// Beyond the bounds by more than its noise reaches, an action has no effect and its gradient none either: what is saturated would stay so.
/// As the bounds loss of rl_games (Makoviichuk and Makoviychuk 2021).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Least mean with an effect.
    pub least: f32,
    /// Greatest.
    pub most: f32,
    /// Twice the weight of the squared distance.
    pub factor: f32,
}

/// Sums over samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurrogateSums {
    /// `-min(ratio A, clip(ratio) A)`.
    pub loss: f64,
    /// `ratio - 1 - ln ratio`, whose mean is the divergence from the new to the collecting policy.
    pub kl: f64,
    /// Samples whose gradient was cut off.
    pub clipped: f64,
}

kernels! {
    /// Samples actions: `action <- mean + std noise`, `log_prob <- ln density(action)`,
    /// `env_action <- clip(offset + scale (action + std held), -1, 1)`; `noise` and `held` have rows of `noise_width`.
    pub fn sample<const FMA: bool>(
        mean: &[f32], noise: &[f32], held: &[f32], noise_width: usize, std: &[f32], log_peak: f32, mapping: (f32, f32),
        action: &mut [f32], env_action: &mut [f32], log_prob: &mut [f32],
    ) {
        let n = std.len();
        let noise = noise.chunks_exact(noise_width).zip(held.chunks_exact(noise_width));
        let rows = mean.chunks_exact(n).zip(noise).zip(action.chunks_exact_mut(n));
        for (((mean, (noise, held)), action), (env_action, log_prob)) in rows.zip(env_action.chunks_exact_mut(n).zip(log_prob)) {
            for i in 0..n {
                action[i] = madd::<FMA>(std[i], noise[i], mean[i]);
                let done = madd::<FMA>(std[i], held[i], action[i]);
                env_action[i] = clip(madd::<FMA>(mapping.1, done, mapping.0), -1.0, 1.0);
            }
            *log_prob = log_peak - 0.5 * row_sum(n, |i| noise[i] * noise[i]);
        }
    }

    /// `env_action <- clip(offset + scale mean, -1, 1)`.
    pub fn map_actions<const FMA: bool>(mean: &[f32], mapping: (f32, f32), env_action: &mut [f32]) {
        for (out, mean) in env_action.iter_mut().zip(mean) {
            *out = clip(madd::<FMA>(mapping.1, *mean, mapping.0), -1.0, 1.0);
        }
    }

    /// The clipped objective of PPO (Schulman et al. 2017, arXiv 1707.06347, equation 7), to be minimised:
    ///
    /// `loss = -min(ratio A, clip(ratio, 1 - clip, 1 + clip) A)`, `ratio = exp(ln density(action) - old_log_prob)`.
    ///
    /// Overwrites each row of `mean` with the gradient `d loss / d mean` and what the bound adds to it, which is not in the sums, adds `d loss / d log_std` to
    /// `log_std_gradient` (both times the weight of a sample) and returns the sums of the rows.
    pub fn clipped_surrogate<const FMA: bool>(
        mean: &mut [f32], action: &[f32], inverse_std: &[f32], log_peak: f32, old_log_prob: &[f32], advantage: &[f32],
        settings: Surrogate, log_std_gradient: &mut [f32],
    ) -> SurrogateSums {
        let (n, bound) = (inverse_std.len(), settings.bound);
        let mut sums = SurrogateSums::default();
        let rows = mean.chunks_exact_mut(n).zip(action.chunks_exact(n));
        for ((mean, action), (&old, &a)) in rows.zip(old_log_prob.iter().zip(advantage)) {
            // The row holds z = (action - mean) / std for a while.
            for i in 0..n {
                mean[i] = (action[i] - mean[i]) * inverse_std[i];
            }
            let log_ratio = log_peak - 0.5 * row_sum(n, |i| mean[i] * mean[i]) - old;
            let ratio = exp::<FMA>(log_ratio);
            let clipped_ratio = clip(ratio, 1.0 - settings.clip, 1.0 + settings.clip);
            let (free, held) = (ratio * a, clipped_ratio * a);
            let cut = held < free;
            sums.loss -= f64::from(if cut { held } else { free });
            sums.kl += f64::from(ratio) - 1.0 - f64::from(log_ratio);
            sums.clipped += if cut { 1.0 } else { 0.0 };
            // d loss / d ln density, then d ln density / d mean = z / std and / d log_std = z^2 - 1
            let slope = if cut { 0.0 } else { -free * settings.weight };
            for i in 0..n {
                let z = mean[i];
                let own = action[i] - z / inverse_std[i];
                let beyond = own - clip(own, bound.least, bound.most);
                mean[i] = madd::<FMA>(slope * z, inverse_std[i], settings.weight * bound.factor * beyond);
                log_std_gradient[i] += slope * madd::<FMA>(z, z, -1.0);
            }
        }
        sums
    }

    /// Squared error: overwrites `value` with `2 factor (value - target)`, returns the sum of squared errors.
    pub fn squared_error<const FMA: bool>(value: &mut [f32], target: &[f32], factor: f32) -> f64 {
        let mut sum = 0.0;
        for (value, target) in value.iter_mut().zip(target) {
            let error = *value - target;
            sum += f64::from(error) * f64::from(error);
            *value = 2.0 * factor * error;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stream, fill_normal};

    const BOUND: Bound = Bound { least: -0.5, most: 0.75, factor: 0.6 };

    fn loss_f64(mean: &[f64], action: &[f32], log_std: &[f64], old: f32, a: f32) -> f64 {
        let density: f64 = (0..mean.len())
            .map(|i| {
                let z = (f64::from(action[i]) - mean[i]) / log_std[i].exp();
                -0.5 * z * z - log_std[i] - f64::from(HALF_LN_TAU)
            })
            .sum();
        let ratio = (density - f64::from(old)).exp();
        let beyond = |x: f64| x - x.clamp(f64::from(BOUND.least), f64::from(BOUND.most));
        let bound: f64 = mean.iter().map(|&x| f64::from(BOUND.factor) / 2.0 * beyond(x).powi(2)).sum();
        -(ratio * f64::from(a)).min(ratio.clamp(0.8, 1.2) * f64::from(a)) + bound
    }

    #[test]
    fn surrogate_gradient_agrees_with_finite_differences() {
        let (n, rows) = (19, 40);
        let mut x = vec![0.0; n * rows * 2 + rows * 2];
        fill_normal(9, Stream::Actions, 0, 0, &mut x);
        let (mean, rest) = x.split_at(n * rows);
        let (action, rest) = rest.split_at(n * rows);
        let (advantage, shift) = rest.split_at(rows);
        let log_std: Vec<f32> = (0..n).map(|i| -0.5 + 0.05 * i as f32).collect();
        let spread = Spread::new(&log_std);
        let settings = Surrogate { clip: 0.2, weight: 1.0, bound: BOUND };
        let wide = |x: &[f32]| x.iter().map(|&x| f64::from(x)).collect::<Vec<_>>();
        let mut clipped = 0.0;
        for row in 0..rows {
            let (mean, action) = (&mean[row * n..][..n], &action[row * n..][..n]);
            let z = |i: usize| (action[i] - mean[i]) * spread.inverse_std[i];
            // An old probability near the new one, so that ratios fall on both sides of the band.
            let old = spread.log_peak - 0.5 * (0..n).map(|i| z(i) * z(i)).sum::<f32>() + 0.3 * shift[row];
            let (mut gradient, mut log_std_gradient) = (mean.to_vec(), vec![0.0; n]);
            let sums = clipped_surrogate(
                &mut gradient,
                action,
                &spread.inverse_std,
                spread.log_peak,
                &[old],
                &advantage[row..=row],
                settings,
                &mut log_std_gradient,
            );
            clipped += sums.clipped;
            let exact = loss_f64(&wide(mean), action, &wide(&log_std), old, advantage[row]);
            let bound = loss_f64(&wide(mean), action, &wide(&log_std), old, 0.0);
            assert!((sums.loss + bound - exact).abs() < 1e-4 * (1.0 + exact.abs()));
            for i in 0..n {
                let nudged = |x: &[f32], by: f64| {
                    let mut x = wide(x);
                    x[i] += by;
                    x
                };
                let h = 1e-6;
                let by_mean = |by| loss_f64(&nudged(mean, by), action, &wide(&log_std), old, advantage[row]);
                let by_std = |by| loss_f64(&wide(mean), action, &nudged(&log_std, by), old, advantage[row]);
                let slope = (by_mean(h) - by_mean(-h)) / (2.0 * h);
                assert!(
                    (slope - f64::from(gradient[i])).abs() < 1e-3 * (1.0 + slope.abs()),
                    "mean {i}: {slope} {}",
                    gradient[i]
                );
                let slope = (by_std(h) - by_std(-h)) / (2.0 * h);
                let got = f64::from(log_std_gradient[i]);
                assert!((slope - got).abs() < 1e-3 * (1.0 + slope.abs()), "log_std {i}: {slope} {got}");
            }
        }
        assert!(clipped > 3.0 && clipped < 30.0, "{clipped} rows were clipped");
    }

    /// Loss, divergence, clipped share and gradients with respect to mean and log std of one action at its mean, whose
    /// probability changed by `ratio`; the standard deviation is 2.
    fn at_mean(ratio: f32, advantage: f32) -> (f64, f64, f64, f32, f32) {
        let spread = Spread::new(&[2.0_f32.ln()]);
        let (mut mean, mut log_std) = ([0.25], [0.0]);
        let sums = clipped_surrogate(
            &mut mean,
            &[0.25],
            &spread.inverse_std,
            spread.log_peak,
            &[spread.log_peak - ratio.ln()],
            &[advantage],
            Surrogate { clip: 0.2, weight: 1.0, bound: BOUND },
            &mut log_std,
        );
        (sums.loss, sums.kl, sums.clipped, mean[0], log_std[0])
    }

    #[test]
    fn loss_of_single_samples_is_as_known() {
        let check = |ratio: f32, advantage, loss: f64, clipped, log_std: f32| {
            let (got_loss, kl, got_clipped, mean, got_log_std) = at_mean(ratio, advantage);
            let expected_kl = f64::from(ratio) - 1.0 - f64::from(ratio).ln();
            assert!((got_loss - loss).abs() < 1e-6 && (kl - expected_kl).abs() < 1e-6, "{ratio}: {got_loss} {kl}");
            assert_eq!((got_clipped, mean), (clipped, 0.0), "{ratio}");
            assert!((got_log_std - log_std).abs() < 1e-6, "{ratio}: {got_log_std}");
        };
        // -min(r A, clip(r, 0.8, 1.2) A); at the mean, d ln density / d log std = -1.
        check(1.0, 3.0, -3.0, 0.0, 3.0);
        check(1.5, 2.0, -2.4, 1.0, 0.0);
        check(1.5, -2.0, 3.0, 0.0, -3.0);
        check(0.5, 2.0, -1.0, 0.0, 1.0);
        check(0.5, -2.0, 1.6, 1.0, 0.0);
    }

    #[test]
    fn entropy_is_that_of_a_standard_normal_for_unit_spread() {
        let spread = Spread::new(&[0.0, 0.0]);
        assert!((spread.entropy - 2.0 * 1.418_938_5).abs() < 1e-6);
        assert!((spread.log_peak + 2.0 * 0.918_938_5).abs() < 1e-6);
    }
}
