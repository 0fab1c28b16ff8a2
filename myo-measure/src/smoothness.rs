//! How smooth a speed profile is: spectral arc length and jerk.

use std::f64::consts::TAU;

use crate::{Result, check, signal};

/// Highest frequency in Hz that the spectral arc length looks at.
const HIGHEST_HZ: f64 = 10.0;
/// Share of the spectrum at rest that ends the arc, the last time it is reached.
const AMPLITUDE_THRESHOLD: f64 = 0.05;
/// By how many powers of two the spectrum is finer than the samples, rounded up to a power of two, ask for.
const PADDING: u32 = 4;
/// Fewest samples of a profile: with fewer there is no second derivative inside to speak of.
const LEAST: usize = 7;

/// Spectral arc length (SPARC) of a speed profile: `-integral sqrt((1 / w)^2 + (dV/df)^2) df` over the spectrum `V` of
/// the speed, relative to its value at rest, from 0 to `w`, where it is last at least 0.05 up to 10 Hz (Balasubramanian et al.
/// 2015, doi 10.1186/s12984-015-0090-9, with padding level 4: zeros up to the power of two above the number of samples, times 2^4).
/// Closer to zero is smoother; one minimum-jerk bell has -1.40 to -1.41.
///
/// It has no unit and hears neither of the size of the speed nor, as long as `w` is below 10 Hz, of the time it takes.
///
/// # Errors
/// Fewer than seven samples, speeds that are not finite or negative, no movement, a rate of at most 20 Hz.
pub fn sparc(speed: &[f64], rate_hz: f64) -> Result<f64> {
    check_profile(speed, rate_hz)?;
    check::setting("rate in Hz", rate_hz, "greater than 20", rate_hz > 2.0 * HIGHEST_HZ)?;
    let fine = speed.len().next_power_of_two() << PADDING;
    let highest = (HIGHEST_HZ / rate_hz * fine as f64).floor() as usize;
    let at_rest: f64 = speed.iter().sum();
    let spectrum: Vec<f64> = (0..=highest).map(|k| amplitude(speed, k, fine) / at_rest).collect();
    let last = spectrum.iter().rposition(|&amplitude| amplitude >= AMPLITUDE_THRESHOLD).unwrap_or(0);
    // A spectrum that falls within one of its steps belongs to a recording of thousands of bells.
    check::at_least("steps of the spectrum above 0.05", last, 1)?;
    let step = 1.0 / last as f64;
    Ok(-spectrum[..=last].windows(2).map(|pair| step.hypot(pair[1] - pair[0])).sum::<f64>())
}

/// `|sum x[n] exp(-2 pi i k n / fine)|`
fn amplitude(x: &[f64], k: usize, fine: usize) -> f64 {
    let (re, im) = signal::fourier(x, TAU * k as f64 / fine as f64);
    re.hypot(im)
}

/// Logarithm of the dimensionless jerk (LDLJ) of a speed profile: `-ln(T^3 / v_peak^2 * integral (d^2 v / dt^2)^2 dt)` over all
/// samples handed in (Balasubramanian et al. 2012, doi 10.1109/TBME.2011.2179545, and 2015, doi 10.1186/s12984-015-0090-9). Closer
/// to zero is smoother; one minimum-jerk bell from rest to rest has `-ln 204.8`.
///
/// Hangs on the window and on the filter: cut at 5 % of its peak the same bell has -4.4.
///
/// # Errors
/// Fewer than seven samples, speeds that are not finite or negative, no movement, a steady rise or fall without jerk.
pub fn ldlj(speed: &[f64], rate_hz: f64) -> Result<f64> {
    check_profile(speed, rate_hz)?;
    let n = speed.len();
    let peak = speed.iter().copied().fold(0.0, f64::max);
    let jerk: Vec<f64> = speed.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]) / peak).collect();
    let last = jerk.len() - 1;
    // The ends have no neighbours; the line through the nearest two goes on to them.
    let (before, after) = (2.0 * jerk[0] - jerk[1], 2.0 * jerk[last] - jerk[last - 1]);
    // Trapezia, in units of samples: T^3 * (1 / dt^2)^2 * dt is (n - 1)^3.
    let integral = jerk.iter().map(|jerk| jerk * jerk).sum::<f64>() + 0.5 * (before * before + after * after);
    let dimensionless = ((n - 1) as f64).powi(3) * integral;
    check::setting("dimensionless jerk", dimensionless, "greater than 0", dimensionless > 0.0)?;
    Ok(-dimensionless.ln())
}

fn check_profile(speed: &[f64], rate_hz: f64) -> Result<()> {
    check::at_least("samples of speed", speed.len(), LEAST)?;
    check::within("speed in m/s", speed, "0 or more", |v| v >= 0.0)?;
    check::rate(rate_hz)?;
    let fastest = speed.iter().copied().fold(0.0, f64::max);
    check::setting("peak speed in m/s", fastest, "greater than 0", fastest > 0.0)
}
