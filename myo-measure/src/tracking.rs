//! How a moving target is tracked: how far off, how late, and with what share of its excursions.
//!
//! The lag is the one with which the pointer is nearest to where the target was; the gain is that of a straight line through pointer over target, all axes
//! together, at that lag.

use crate::{Point, Result, check, point};

/// Longest lag in s that is looked at.
pub const LONGEST_LAG_S: f64 = 0.5;
/// Least tracking in s: the longest lag twice, so that most of it is looked at whatever the lag.
const SHORTEST_S: f64 = 2.0 * LONGEST_LAG_S;

/// How well a target was tracked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracking {
    /// From the pointer to the centre of the target, root mean square, in m.
    pub rms_error: f64,
    /// The same, mean, in m.
    pub mean_error: f64,
    /// Share of the time closer to the centre than the radius of the target.
    pub inside: f64,
    /// How late the pointer is, in s; 0 where it is ahead of the target.
    pub lag_s: f64,
    /// How far it goes for how far the target goes; 1 is as far.
    pub gain: f64,
    /// Mean speed of the target in m/s.
    pub target_speed: f64,
}

impl Tracking {
    /// Of `pointer` and `target`, (n) each, in m at a fixed rate in Hz, of at least a second; the target has a `radius` in m.
    ///
    /// # Errors
    /// Less than a second, unequal lengths, numbers that are not finite, a radius that is not positive, a target that stands still.
    pub fn of(pointer: &[Point], target: &[Point], rate_hz: f64, radius: f64) -> Result<Self> {
        check::points("positions of the pointer in m", pointer)?;
        check::points("positions of the target in m", target)?;
        check::same_length("positions of the target", target.len(), pointer.len())?;
        check::rate(rate_hz)?;
        check::setting("radius in m", radius, "greater than 0", radius > 0.0)?;
        check::at_least("samples of one second", pointer.len(), ((SHORTEST_S * rate_hz).ceil() as usize).max(2))?;
        let path: f64 = target.windows(2).map(|pair| distance(pair[1], pair[0])).sum();
        check::setting("way of the target in m", path, "greater than 0", path > 0.0)?;
        let errors: Vec<f64> =
            pointer.iter().zip(target).map(|(&pointer, &target)| distance(pointer, target)).collect();
        let n = errors.len() as f64;
        let lag = lag(pointer, target, (LONGEST_LAG_S * rate_hz) as usize);
        Ok(Self {
            rms_error: (errors.iter().map(|error| error * error).sum::<f64>() / n).sqrt(),
            mean_error: errors.iter().sum::<f64>() / n,
            inside: errors.iter().filter(|&&error| error < radius).count() as f64 / n,
            lag_s: lag as f64 / rate_hz,
            gain: gain(&pointer[lag..], &target[..target.len() - lag]),
            target_speed: path * rate_hz / (n - 1.0),
        })
    }
}

/// Samples, up to `longest`, by which the pointer is late: where it is nearest to the target on average.
fn lag(pointer: &[Point], target: &[Point], longest: usize) -> usize {
    let off = |lag: usize| {
        let pairs = pointer[lag..].iter().zip(target);
        pairs.map(|(&pointer, &target)| distance(pointer, target)).sum::<f64>() / (pointer.len() - lag) as f64
    };
    (0..=longest).map(|lag| (lag, off(lag))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(lag, _)| lag)
}

/// Least squares over all axes, each about its mean.
fn gain(pointer: &[Point], target: &[Point]) -> f64 {
    let means = [pointer, target].map(point::centre);
    let (mut product, mut square) = (0.0, 0.0);
    for (&pointer, &target) in pointer.iter().zip(target) {
        let [pointer, target] = [point::minus(pointer, means[0]), point::minus(target, means[1])];
        product += point::dot(pointer, target);
        square += point::dot(target, target);
    }
    product / square
}

fn distance(a: Point, b: Point) -> f64 {
    point::length(point::minus(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 200.0;

    /// A target that wanders for ten seconds, `late` seconds ago, `gain` times as far, and 2 cm ahead.
    fn wandering(late: f64, gain: f64) -> Vec<Point> {
        let at = |sample: usize| {
            let t = sample as f64 / RATE_HZ - late;
            let wave = |hz: f64, phase: f64| (std::f64::consts::TAU * hz * t + phase).sin();
            [0.5, gain * (0.1 * wave(0.3, 1.0) + 0.05 * wave(0.47, 0.0)), gain * 0.1 * wave(0.21, 2.0)]
        };
        (0..2000).map(at).collect()
    }

    #[test]
    fn a_pointer_that_is_late_and_goes_less_far_is_told_so() {
        let target = wandering(0.0, 1.0);
        let found = Tracking::of(&target, &target, RATE_HZ, 0.01).unwrap();
        assert_eq!((found.rms_error, found.mean_error, found.inside, found.lag_s), (0.0, 0.0, 1.0, 0.0));
        assert!((found.gain - 1.0).abs() < 1e-12);
        let found = Tracking::of(&wandering(0.15, 0.8), &target, RATE_HZ, 0.01).unwrap();
        assert!((found.lag_s - 0.15).abs() < 0.011 && (found.gain - 0.8).abs() < 0.01, "{found:?}");
        assert!(found.inside < 0.2 && found.rms_error > found.mean_error, "{found:?}");
        // Ahead of it: no lag is nearer than none.
        assert_eq!(Tracking::of(&wandering(-0.1, 1.0), &target, RATE_HZ, 0.01).unwrap().lag_s, 0.0);
        // A constant way off changes neither lag nor gain.
        let beside: Vec<Point> = wandering(0.1, 1.0).iter().map(|&[x, y, z]| [x + 0.03, y, z]).collect();
        let found = Tracking::of(&beside, &target, RATE_HZ, 0.02).unwrap();
        assert!(
            (found.gain - 1.0).abs() < 1e-3 && (found.lag_s - 0.1).abs() < 0.011 && found.inside == 0.0,
            "{found:?}"
        );
        // 0.1 m at 0.3 Hz alone goes 4 * 0.1 * 0.3 m/s.
        let line: Vec<Point> =
            (0..2001).map(|k| [0.0, 0.1 * (std::f64::consts::TAU * 0.3 * k as f64 / RATE_HZ).cos(), 0.0]).collect();
        assert!((Tracking::of(&line, &line, RATE_HZ, 0.01).unwrap().target_speed - 0.12).abs() < 1e-4);
    }

    #[test]
    fn what_cannot_be_measured_is_refused() {
        let target = wandering(0.0, 1.0);
        let still = vec![[0.5, 0.0, 0.0]; 2000];
        for (pointer, target, radius, says) in [
            (&target[..150], &target[..150], 0.01, "samples of one second"),
            (&target[..], &target[..1000], 0.01, "positions of the target"),
            (&target[..], &still[..], 0.01, "way of the target"),
            (&target[..], &target[..], 0.0, "radius in m"),
        ] {
            let error = Tracking::of(pointer, target, RATE_HZ, radius).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}
