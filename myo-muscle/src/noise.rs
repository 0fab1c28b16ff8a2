//! Motor noise on muscle excitations.

use myo_scalar::Scalar;

/// Standard deviation of signal-dependent noise relative to the excitation
/// (van Beers, Haggard and Wolpert 2004, doi 10.1152/jn.00652.2003).
pub const SIGNAL_DEPENDENT_NOISE: f64 = 0.103;

/// Standard deviation of constant noise (same source).
pub const CONSTANT_NOISE: f64 = 0.185;

/// Time (s) in which motor noise forgets two thirds of what it was. Its power at low frequencies is that of noise which is drawn
/// every 50 ms and held, as that of the published simulations at 20 Hz is.
pub const NOISE_TIME_S: f64 = 0.025;

/// Motor noise of a muscle after `dt` seconds more: `rho z + sqrt(1 - rho^2) draw`, `rho = exp(-dt / NOISE_TIME_S)`, a first-order
/// autoregressive process of unit variance. `z` is what it was and `draw` a standard normal number, which it begins with.
///
/// So noise is the same at any rate of decisions: one that was drawn anew with each of many short steps would be gone before a
/// muscle feels it.
#[derive(Clone, Copy, Debug)]
pub struct MotorNoise {
    rho: f64,
    fresh: f64,
}

impl MotorNoise {
    /// For steps of `dt` seconds.
    pub fn new(dt: f64) -> Self {
        let rho = (-dt / NOISE_TIME_S).exp();
        Self { rho, fresh: (1.0 - rho * rho).sqrt() }
    }

    /// The noise after one more step.
    #[inline(always)]
    pub fn next<S: Scalar>(&self, z: S, draw: S) -> S {
        z.mul_add(S::lit(self.rho), draw * S::lit(self.fresh))
    }
}

/// `clip(u + sqrt((signal_dependent u)^2 + constant^2) z, 0, 1)`: two independent sources of noise, of which one part grows with the
/// excitation, add up to one of this deviation. `z` is standard normal.
#[inline(always)]
pub fn noisy_excitation<S: Scalar>(u: S, signal_dependent: S, constant: S, z: S) -> S {
    let grows = u * signal_dependent;
    let deviation = grows.mul_add(grows, constant * constant).sqrt();
    deviation.mul_add(z, u).clamp(0.0, 1.0)
}
