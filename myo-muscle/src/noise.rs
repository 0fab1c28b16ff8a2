//! Motor noise on muscle excitations.

use myo_scalar::Scalar;

/// Standard deviation of signal-dependent noise relative to the excitation
/// (van Beers, Haggard and Wolpert 2004, doi 10.1152/jn.00652.2003).
pub const SIGNAL_DEPENDENT_NOISE: f64 = 0.103;

/// Standard deviation of constant noise (same source).
pub const CONSTANT_NOISE: f64 = 0.185;

/// `clip(u + signal_dependent * u * z1 + constant * z2, 0, 1)` with two independent standard normal numbers per muscle.
#[inline(always)]
pub fn noisy_excitation<S: Scalar>(u: S, signal_dependent: S, constant: S, z1: S, z2: S) -> S {
    let noise = (u * signal_dependent).mul_add(z1, constant * z2);
    (u + noise).clamp(0.0, 1.0)
}
