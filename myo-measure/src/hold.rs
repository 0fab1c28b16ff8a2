//! A hand that holds still: how fast it moves nevertheless, how it drifts and trembles.

use nalgebra::Vector3;

use crate::{Point, Result, check, endpoints, point, signal, statistics};

/// Slower motion in Hz is drift and no tremor.
const DRIFT_HZ: f64 = 2.0;
/// Lowest and highest frequency in Hz of tremor; that of an arm has its peak at 6 to 12 Hz (Lakie et al. 2015,
/// doi 10.1113/JP270464).
const TREMOR_HZ: [f64; 2] = [4.0, 15.0];
/// What is left out of the tremor at either end, in s: filters see only reflections beyond.
const MARGIN_S: f64 = 0.25;
/// Shortest hold in s: a few cycles of tremor between the margins.
const SHORTEST_S: f64 = 1.0;

/// How still a point is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// In s.
    pub duration_s: f64,
    /// Mean speed in m/s, of the positions as they are.
    pub mean_speed: f64,
    /// How far the straight line through the positions over time (least squares) leads during the hold, in m.
    pub drift: f64,
    /// Distance in m between the extremes of the tremor along the axis where it is largest. Tremor is the displacement without what
    /// is below 2 Hz ([`signal::high_pass`]), from 4 to 15 Hz ([`signal::band`]); a
    /// quarter second at either end is left out.
    pub tremor_peak_to_peak: f64,
    /// Root mean square of the tremor in all directions, in m.
    pub tremor_rms: f64,
}

impl Hold {
    /// Of `positions`, (n), in m at a fixed rate in Hz, of at least a second.
    ///
    /// # Errors
    /// Less than a second, positions that are not finite, a rate of at most 30 Hz.
    pub fn of(positions: &[Point], rate_hz: f64) -> Result<Self> {
        check::points("positions in m", positions)?;
        check::setting("rate in Hz", rate_hz, "finite and greater than 30", rate_hz > 2.0 * TREMOR_HZ[1])?;
        check::at_least(
            "samples of one second",
            positions.len(),
            ((SHORTEST_S * rate_hz).ceil() as usize).saturating_add(1),
        )?;
        let duration_s = (positions.len() - 1) as f64 / rate_hz;
        let steps = positions.windows(2).map(|pair| point::length(point::minus(pair[1], pair[0])));
        let path: f64 = steps.sum();
        let tremor = tremor(positions, rate_hz)?;
        Ok(Self {
            duration_s,
            mean_speed: path / duration_s,
            drift: duration_s * drift_speed(positions, rate_hz)?,
            tremor_peak_to_peak: largest_extent(&tremor),
            tremor_rms: (tremor.iter().map(|&x| point::dot(x, x)).sum::<f64>() / tremor.len() as f64).sqrt(),
        })
    }
}

fn drift_speed(positions: &[Point], rate_hz: f64) -> Result<f64> {
    let times: Vec<f64> = (0..positions.len()).map(|i| i as f64 / rate_hz).collect();
    let slope = |axis: usize| statistics::slope(&times, &positions.iter().map(|point| point[axis]).collect::<Vec<_>>());
    Ok(point::length([slope(0)?, slope(1)?, slope(2)?]))
}

fn tremor(positions: &[Point], rate_hz: f64) -> Result<Vec<Point>> {
    let band = signal::per_axis(positions, |x| {
        let faster = signal::high_pass(x, rate_hz, DRIFT_HZ)?;
        signal::band(&faster, rate_hz, TREMOR_HZ[0], TREMOR_HZ[1])
    })?;
    let margin = (MARGIN_S * rate_hz).floor() as usize;
    Ok(band[margin..band.len() - margin].to_vec())
}

/// Between the extremes along the longest axis.
fn largest_extent(points: &[Point]) -> f64 {
    let (_, long) = endpoints::axes(endpoints::covariance(points, point::centre(points)));
    let places = points.iter().map(|&point| long.dot(&Vector3::from(point)));
    let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    high - low
}
