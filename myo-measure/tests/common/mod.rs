//! Movements whose figures are known.
#![allow(dead_code, reason = "each test file uses some")]

use myo_measure::Point;

/// Minimum jerk from 0 to 1 for `s` from 0 to 1 (Flash and Hogan 1985, doi 10.1523/JNEUROSCI.05-07-01688.1985), at rest outside.
pub fn minimum_jerk(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
}

/// Its speed.
pub fn minimum_jerk_speed(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    30.0 * s * s * (1.0 - s) * (1.0 - s)
}

/// Positions along the first axis, `place(t)` at `rate_hz` from 0 to `until_s`.
pub fn along_x(rate_hz: f64, until_s: f64, place: impl Fn(f64) -> f64) -> Vec<Point> {
    let n = (until_s * rate_hz).round() as usize;
    (0..=n).map(|i| [place(i as f64 / rate_hz), 0.0, 0.0]).collect()
}

/// One reach of `distance` in `duration_s`, a fifth of a second after the begin of the recording and as long before its end.
pub fn reach(rate_hz: f64, distance: f64, duration_s: f64) -> Vec<Point> {
    along_x(rate_hz, duration_s + 0.4, |t| distance * minimum_jerk((t - 0.2) / duration_s))
}

#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} for {expected} +- {tolerance}");
}
