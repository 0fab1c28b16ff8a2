//! Recorded signals: even times, smoothing without delay, derivatives.

use std::f64::consts::{PI, SQRT_2, TAU};

use crate::{MeasureError, Point, Result, check, statistics};

/// By how much a step in time may differ from the middle one, as a share of it, and still count as even.
const UNEVEN: f64 = 0.01;
/// Fewest samples that are reflected at either end, as SciPy's `filtfilt` does for filters of second order.
const LEAST_REFLECTED: usize = 9;
/// Most samples that one recorded interval is resampled to: beyond it a rate is a slip, not a wish.
const MOST_PER_INTERVAL: f64 = 1000.0;

/// Rate in Hz of samples at these times in s.
///
/// # Errors
/// Fewer than two times, times that are not finite or do not rise, steps that differ by more than 1 % from the middle one.
pub fn rate_of(times: &[f64]) -> Result<f64> {
    let steps = steps(times)?;
    let usual_s = statistics::median(&steps)?;
    let odd = steps.iter().position(|step| (step - usual_s).abs() > UNEVEN * usual_s);
    match odd {
        Some(index) => Err(MeasureError::UnevenTimes { index, step_s: steps[index], usual_s }),
        None => Ok(steps.len() as f64 / steps.iter().sum::<f64>()),
    }
}

/// How far rising times are apart.
fn steps(times: &[f64]) -> Result<Vec<f64>> {
    check::at_least("times", times.len(), 2)?;
    check::finite("times", times)?;
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    check::within("steps in time in s", &steps, "finite and greater than 0", |step| step > 0.0)?;
    Ok(steps)
}

/// The signal at a fixed rate in Hz from the first time to the last, by cubic pieces (Hermite) whose slopes are those of the
/// parabola through a sample and its neighbours: parabolas come out as they went in.
///
/// # Errors
/// Fewer than three samples, unequal lengths, numbers that are not finite, times that do not rise, a rate that makes more than
/// a thousand samples of one.
pub fn resample(times: &[f64], x: &[f64], rate_hz: f64) -> Result<Vec<f64>> {
    check::same_length("samples", x.len(), times.len())?;
    check::at_least("samples", x.len(), 3)?;
    check::finite("samples", x)?;
    check::rate(rate_hz)?;
    let steps = steps(times)?;
    // The last sample counts although quotients are rounded.
    let intervals = ((times[times.len() - 1] - times[0]) * rate_hz * (1.0 + f64::EPSILON * 4.0)).floor();
    let right = "low enough for at most 1000 samples per recorded one";
    check::setting("rate in Hz", rate_hz, right, intervals <= MOST_PER_INTERVAL * x.len() as f64)?;
    let slopes = slopes(&steps, x);
    let mut piece = 0;
    let value = |k: usize| {
        let t = times[0] + k as f64 / rate_hz;
        while piece + 2 < times.len() && t > times[piece + 1] {
            piece += 1;
        }
        let (h, s) = (steps[piece], ((t - times[piece]) / steps[piece]).min(1.0));
        let (from, to) = (1.0 + 2.0 * s, 3.0 - 2.0 * s);
        (1.0 - s).powi(2) * (from * x[piece] + s * h * slopes[piece])
            + s * s * (to * x[piece + 1] - (1.0 - s) * h * slopes[piece + 1])
    };
    Ok((0..=intervals as usize).map(value).collect())
}

/// Slope at each sample of the parabola through it and its neighbours; at the ends that of the nearest parabola.
fn slopes(steps: &[f64], x: &[f64]) -> Vec<f64> {
    let rises: Vec<f64> = x.windows(2).zip(steps).map(|(pair, h)| (pair[1] - pair[0]) / h).collect();
    let n = rises.len();
    let inner = |i: usize| (steps[i] * rises[i - 1] + steps[i - 1] * rises[i]) / (steps[i - 1] + steps[i]);
    let mut slopes = Vec::with_capacity(n + 1);
    slopes.push(2.0 * rises[0] - inner(1));
    slopes.extend((1..n).map(inner));
    slopes.push(2.0 * rises[n - 1] - inner(n - 1));
    slopes
}

/// Low-pass filter without delay: a Butterworth filter of second order forwards and backwards, which is of fourth order in
/// total effect. At the cut-off the gain is therefore 1/2; it is `1 / sqrt(2)` at 0.802 of the cut-off (Winter 2009,
/// doi 10.1002/9780470549148, divides the wanted cut-off by this factor; that is left to the caller).
///
/// Both ends are continued by their reflection through the end point, over a period of the cut-off where there are so many
/// samples, and the filter begins at rest at the first of them (Gustafsson 1996, doi 10.1109/78.492552, discusses ways to begin).
///
/// # Errors
/// Fewer than ten samples, numbers that are not finite, a cut-off that is not between 0 and half the rate.
pub fn low_pass(x: &[f64], rate_hz: f64, cutoff_hz: f64) -> Result<Vec<f64>> {
    filter(x, rate_hz, cutoff_hz, Biquad::low_pass)
}

/// High-pass filter without delay: as [`low_pass`], for what is faster.
///
/// # Errors
/// Those of [`low_pass`].
pub fn high_pass(x: &[f64], rate_hz: f64, cutoff_hz: f64) -> Result<Vec<f64>> {
    filter(x, rate_hz, cutoff_hz, Biquad::high_pass)
}

/// [`low_pass`] of each coordinate.
///
/// # Errors
/// Those of [`low_pass`].
pub fn low_pass_points(points: &[Point], rate_hz: f64, cutoff_hz: f64) -> Result<Vec<Point>> {
    per_axis(points, |x| low_pass(x, rate_hz, cutoff_hz))
}

/// What of the signal is from `lowest` to `highest` Hz, by its Fourier series: sharp, so that nothing within is weakened. The
/// signal should begin and end alike (what is slow removed, [`high_pass`]); else the jump from its end to its begin rings near both.
///
/// # Errors
/// Fewer than three samples, numbers that are not finite, frequencies that are not between 0 and half the rate or not in order.
pub fn band(x: &[f64], rate_hz: f64, lowest: f64, highest: f64) -> Result<Vec<f64>> {
    check::at_least("samples", x.len(), 3)?;
    check::finite("samples", x)?;
    check::rate(rate_hz)?;
    check::setting("lowest frequency in Hz", lowest, "greater than 0", lowest > 0.0)?;
    let right = "at least the lowest frequency and less than half the rate";
    check::setting("highest frequency in Hz", highest, right, highest >= lowest && 2.0 * highest < rate_hz)?;
    let n = x.len() as f64;
    let (first, last) = ((lowest * n / rate_hz).ceil() as usize, (highest * n / rate_hz).floor() as usize);
    let mut band = vec![0.0; x.len()];
    for k in first..=last {
        let angle = TAU * k as f64 / n;
        let (re, im) = fourier(x, angle);
        for (i, y) in band.iter_mut().enumerate() {
            let (sine, cosine) = (angle * i as f64).sin_cos();
            *y += 2.0 / n * (re * cosine + im * sine);
        }
    }
    Ok(band)
}

/// Real and imaginary part of `sum x[n] exp(i angle n)`.
pub(crate) fn fourier(x: &[f64], angle: f64) -> (f64, f64) {
    let (sine, cosine) = angle.sin_cos();
    // From the last sample to the first, each time turned by one angle (Horner).
    x.iter().rev().fold((0.0, 0.0), |(re, im), x| (re * cosine - im * sine + x, re * sine + im * cosine))
}

/// What becomes of points when each coordinate goes through `change`.
pub(crate) fn per_axis(points: &[Point], change: impl Fn(&[f64]) -> Result<Vec<f64>>) -> Result<Vec<Point>> {
    let axis = |axis: usize| change(&points.iter().map(|point| point[axis]).collect::<Vec<_>>());
    let (x, y, z) = (axis(0)?, axis(1)?, axis(2)?);
    Ok(x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect())
}

fn filter(x: &[f64], rate_hz: f64, cutoff_hz: f64, design: fn(f64) -> Biquad) -> Result<Vec<f64>> {
    check::at_least("samples to filter", x.len(), LEAST_REFLECTED + 1)?;
    check::finite("samples to filter", x)?;
    check::rate(rate_hz)?;
    let right = "greater than 0 and less than half the rate";
    check::setting("cut-off in Hz", cutoff_hz, right, cutoff_hz > 0.0 && 2.0 * cutoff_hz < rate_hz)?;
    let biquad = design((PI * cutoff_hz / rate_hz).tan());
    let reflected = ((rate_hz / cutoff_hz).ceil() as usize).clamp(LEAST_REFLECTED, x.len() - 1);
    let mut long = reflect(x, reflected);
    for _ in 0..2 {
        biquad.run(&mut long);
        long.reverse();
    }
    Ok(long[reflected..reflected + x.len()].to_vec())
}

/// The signal with `count` samples at both ends that are reflected through the end point, so that value and slope go on.
fn reflect(x: &[f64], count: usize) -> Vec<f64> {
    let (first, last) = (x[0], x[x.len() - 1]);
    let before = x[1..=count].iter().rev().map(|x| 2.0 * first - x);
    let after = x[x.len() - 1 - count..x.len() - 1].iter().rev().map(|x| 2.0 * last - x);
    before.chain(x.iter().copied()).chain(after).collect()
}

/// A filter of second order: `y[n] = b0 x[n] + b1 x[n-1] + b2 x[n-2] - a1 y[n-1] - a2 y[n-2]`.
struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
    /// Gain of constant signals.
    at_rest: f64,
}

impl Biquad {
    /// Butterworth by the bilinear transform, with `k = tan(pi cutoff / rate)` (Oppenheim and Schafer 2010, chapter 7).
    fn low_pass(k: f64) -> Self {
        let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
        let b = k * k * scale;
        Self { b: [b, 2.0 * b, b], a: Self::poles(k, scale), at_rest: 1.0 }
    }

    fn high_pass(k: f64) -> Self {
        let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
        Self { b: [scale, -2.0 * scale, scale], a: Self::poles(k, scale), at_rest: 0.0 }
    }

    fn poles(k: f64, scale: f64) -> [f64; 2] {
        [2.0 * (k * k - 1.0) * scale, (1.0 - SQRT_2 * k + k * k) * scale]
    }

    /// Filters in place, as if the first value had always been there (direct form II, transposed).
    fn run(&self, x: &mut [f64]) {
        let Self { b, a, at_rest } = self;
        let Some(&first) = x.first() else { return };
        let mut late = [(at_rest - b[0]) * first, (b[2] - a[1] * at_rest) * first];
        for x in x {
            let y = b[0] * *x + late[0];
            late = [b[1] * *x - a[0] * y + late[1], b[2] * *x - a[1] * y];
            *x = y;
        }
    }
}

/// Rate of change per second by central differences, at the ends by the parabola through the last three samples: exact for
/// parabolas.
///
/// # Errors
/// Fewer than three samples, numbers that are not finite, a rate that is not positive.
pub fn derivative(x: &[f64], rate_hz: f64) -> Result<Vec<f64>> {
    check::at_least("samples", x.len(), 3)?;
    check::finite("samples", x)?;
    check::rate(rate_hz)?;
    let n = x.len();
    let half = 0.5 * rate_hz;
    let inner = x.windows(3).map(|x| half * (x[2] - x[0]));
    let first = half * (4.0 * x[1] - 3.0 * x[0] - x[2]);
    let last = half * (3.0 * x[n - 1] - 4.0 * x[n - 2] + x[n - 3]);
    Ok(std::iter::once(first).chain(inner).chain([last]).collect())
}

/// Speed in m/s along positions in m, see [`derivative`].
///
/// # Errors
/// Those of [`derivative`].
pub fn speed(positions: &[Point], rate_hz: f64) -> Result<Vec<f64>> {
    check::points("positions", positions)?;
    let velocity = per_axis(positions, |x| derivative(x, rate_hz))?;
    Ok(velocity.into_iter().map(crate::point::length).collect())
}
