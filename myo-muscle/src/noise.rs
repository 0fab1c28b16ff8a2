//! Motor noise on muscle excitations.

use myo_scalar::Scalar;

/// Standard deviation of signal-dependent noise relative to the excitation
/// (van Beers, Haggard and Wolpert 2004, doi 10.1152/jn.00652.2003).
pub const SIGNAL_DEPENDENT_NOISE: f64 = 0.103;

/// Standard deviation of constant noise (same source).
pub const CONSTANT_NOISE: f64 = 0.185;

/// Motor noise of a muscle, which changes every `dt` seconds: `rho z + sqrt(1 - rho^2) draw`, a first-order autoregressive process.
/// `z` is what it was and `draw` a standard normal number, which it begins with.
///
/// `rho` is such that the power at low frequencies, `dt (1 + rho) / (1 - rho)`, is that of noise which is drawn every `held` seconds and held, at
/// any rate: noise that was drawn anew with each of many short steps would be gone before a muscle feels it. With steps longer than `held` it is
/// drawn for each and is smaller instead. (The published simulations draw it every 50 ms.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorNoise<T> {
    rho: T,
    fresh: T,
    size: T,
}

impl MotorNoise<f64> {
    /// For steps of `dt` seconds, as slow as noise that is held for `held` seconds.
    pub fn new(dt: f64, held: f64) -> Self {
        let rho = ((held - dt) / (held + dt)).max(0.0);
        Self { rho, fresh: (1.0 - rho * rho).sqrt(), size: (held / dt).min(1.0).sqrt() }
    }
}

impl<T> MotorNoise<T> {
    /// The same with other numbers: each is what `f` makes of this one.
    #[inline(always)]
    pub fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> MotorNoise<U> {
        MotorNoise { rho: f(&self.rho), fresh: f(&self.fresh), size: f(&self.size) }
    }
}

impl<S: Scalar> MotorNoise<S> {
    /// The noise after one more step.
    #[inline(always)]
    pub fn next(&self, z: S, draw: S) -> S {
        z.mul_add(self.rho, draw * self.fresh)
    }

    /// How far (in the standard deviations that a task names) noise of this number is from none.
    #[inline(always)]
    pub fn deviation(&self, z: S) -> S {
        z * self.size
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
