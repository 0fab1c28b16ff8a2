//! The two-thirds power law: how much slower a hand is where its path is more curved.
//!
//! `speed = gain * curvature^exponent` along curved paths that are drawn fluently, with an exponent near -1/3, which for angular velocities is two thirds
//! (Lacquaniti, Terzuolo and Viviani 1983; ellipses: Viviani and Schneider 1991, doi 10.1037/0096-1523.17.1.198).

use crate::{Line, Point, Result, check, point, signal, statistics};

/// Samples of less curvature than all but this share are left out: nearly straight pieces say how noisy the recording is.
const STRAIGHTEST: f64 = 0.05;
/// Below this share of the greatest speed a hand stands, and a path has no curvature.
const STANDS: f64 = 0.01;
/// Fewest samples.
const LEAST: usize = 10;

/// Speed over curvature, on logarithmic axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// The natural logarithm of the speed (m/s) over that of the curvature (1/m). Its slope is the exponent.
    pub fit: Line,
    /// Samples that it goes through.
    pub samples: usize,
}

impl PowerLaw {
    /// Of `positions` (n) in m at a fixed rate in Hz, smooth enough to be derived twice.
    ///
    /// # Errors
    /// Too few samples in motion, numbers that are not finite, a path whose curvature is everywhere the same.
    pub fn of(positions: &[Point], rate_hz: f64) -> Result<Self> {
        check::points("positions in m", positions)?;
        check::rate(rate_hz)?;
        check::at_least("samples", positions.len(), LEAST)?;
        let derived = |points: &[Point]| signal::per_axis(points, |axis| signal::derivative(axis, rate_hz));
        let velocity = derived(positions)?;
        let acceleration = derived(&velocity)?;
        let fastest = velocity.iter().map(|&v| point::length(v)).fold(0.0, f64::max);
        let curved = velocity.iter().zip(&acceleration).filter_map(|(&v, &a)| {
            let speed = point::length(v);
            let curvature = point::length(cross(v, a)) / speed.powi(3);
            (speed > STANDS * fastest && curvature > 0.0).then_some([curvature, speed])
        });
        let curved: Vec<[f64; 2]> = curved.collect();
        check::at_least("samples on a curved path", curved.len(), LEAST)?;
        let all: Vec<f64> = curved.iter().map(|[curvature, _]| *curvature).collect();
        let least = statistics::quantile(&all, STRAIGHTEST)?;
        let kept = curved.iter().filter(|[curvature, _]| *curvature >= least);
        let (x, y): (Vec<f64>, Vec<f64>) = kept.map(|[curvature, speed]| (curvature.ln(), speed.ln())).unzip();
        Ok(Self { fit: Line::through(&x, &y)?, samples: x.len() })
    }
}

fn cross([a, b, c]: Point, [x, y, z]: Point) -> Point {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const RATE_HZ: f64 = 500.0;

    /// An ellipse of 20 by 10 cm, where its parameter is so large at each sample.
    fn ellipse(parameter: impl Fn(f64) -> f64) -> Vec<Point> {
        let at = |sample: usize| {
            let (sin, cos) = parameter(sample as f64 / RATE_HZ).sin_cos();
            [0.4, 0.1 * cos, 0.05 * sin]
        };
        (0..1500).map(at).collect()
    }

    #[test]
    fn harmonic_motion_along_an_ellipse_obeys_the_law_exactly() {
        let law = PowerLaw::of(&ellipse(|time| TAU * time), RATE_HZ).unwrap();
        assert!((law.fit.slope + 1.0 / 3.0).abs() < 2e-3 && law.fit.r2 > 0.999, "{law:?}");
        // The gain is the cube root of both semi-axes' product, by the angular rate.
        let gain = (0.1_f64 * 0.05).cbrt() * TAU;
        assert!((law.fit.intercept.exp() / gain - 1.0).abs() < 0.01, "{law:?}");
        assert!((1400..1440).contains(&law.samples), "{law:?}");
    }

    #[test]
    fn a_hand_of_constant_speed_knows_no_curvature() {
        // The parameter that goes along the ellipse as fast everywhere, by small steps.
        let mut angles = vec![0.0_f64];
        for _ in 0..1500 {
            let mut angle = *angles.last().unwrap();
            for _ in 0..100 {
                let (sin, cos) = angle.sin_cos();
                angle += 0.3 / RATE_HZ / 100.0 / f64::hypot(0.1 * sin, 0.05 * cos);
            }
            angles.push(angle);
        }
        let path = ellipse(|time| angles[(time * RATE_HZ).round() as usize]);
        let law = PowerLaw::of(&path, RATE_HZ).unwrap();
        assert!(law.fit.slope.abs() < 1e-3, "{law:?}");
    }

    #[test]
    fn what_has_no_law_is_refused() {
        let error = PowerLaw::of(&ellipse(|time| TAU * time)[..9], RATE_HZ).unwrap_err().to_string();
        assert!(error.contains("samples"), "{error}");
        let line: Vec<Point> = (0..100).map(|k| [0.0, 0.01 * f64::from(k), 0.0]).collect();
        let error = PowerLaw::of(&line, RATE_HZ).unwrap_err().to_string();
        assert!(error.contains("samples on a curved path"), "{error}");
        assert!(PowerLaw::of(&[[f64::NAN; 3]; 100], RATE_HZ).is_err());
        assert!(PowerLaw::of(&line, 0.0).is_err());
    }
}
