//! One aimed movement: where it begins and ends, and its figures.

use crate::{MeasureError, Point, Result, check, point, signal, smoothness};

/// Share of its peak speed that a movement begins and ends at.
pub const THRESHOLD: f64 = 0.05;
/// Least rise of a speed maximum over the valleys beside it, as a share of the peak speed, to count as one.
pub const PROMINENCE: f64 = 0.05;
/// A chord this much shorter than its path goes nowhere: the movement came back to where it began.
const NO_CHORD: f64 = 1e-6;

/// Where a movement begins or ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Where the speed crosses [`THRESHOLD`] of the peak of this movement, next to the bell with the peak: the onset is the first
    /// sample above it, the end the first one below.
    Threshold,
    /// At this sample, because of something that the positions do not tell: the last entry into a target, for example.
    Sample(usize),
}

/// Figures of one movement of one point. Times are right to one sample, at 100 Hz to 10 ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement {
    /// First sample that belongs to it.
    pub onset: usize,
    /// Last sample that belongs to it.
    pub end: usize,
    /// From onset to end, in s.
    pub duration_s: f64,
    /// Peak speed in m/s.
    pub peak_speed: f64,
    /// Path over duration, in m/s.
    pub mean_speed: f64,
    /// Peak over mean speed; 1.875 for minimum jerk (Flash and Hogan 1985, doi 10.1523/JNEUROSCI.05-07-01688.1985).
    pub peak_over_mean: f64,
    /// When the peak is, as a share of the duration.
    pub time_of_peak: f64,
    /// Speed maxima that rise by more than [`PROMINENCE`] of the peak over the valleys beside them.
    pub speed_maxima: usize,
    /// Length of the path in m.
    pub path: f64,
    /// Straight distance from onset to end in m.
    pub chord: f64,
    /// Path over chord, at least 1; none where the movement came back to where it began.
    pub path_over_chord: Option<f64>,
    /// Spectral arc length from onset to end, see [`smoothness::sparc`].
    pub sparc: f64,
    /// Logarithm of the dimensionless jerk from onset to end, see [`smoothness::ldlj`].
    pub ldlj: f64,
}

impl Movement {
    /// The movement in `positions`, (n), in m at a fixed rate in Hz. Recordings of people are to be smoothed before
    /// ([`signal::low_pass_points`], 10 Hz). The peak is the highest speed between samples that are given as edges, or of the
    /// recording: one recording holds one movement.
    ///
    /// # Errors
    /// Positions that are not finite, a rate of at most 20 Hz, fewer than seven samples from onset to end, no movement, a
    /// recording that begins or ends amid the movement, given edges outside of the recording.
    pub fn of(positions: &[Point], rate_hz: f64, onset: Edge, end: Edge) -> Result<Self> {
        let speed = signal::speed(positions, rate_hz)?;
        let (onset, peak, end) = edges(&speed, onset, end)?;
        let inside = &speed[onset..=end];
        let steps = positions[onset..=end].windows(2);
        let path: f64 = steps.map(|pair| point::length(point::minus(pair[1], pair[0]))).sum();
        let chord = point::length(point::minus(positions[end], positions[onset]));
        let duration_s = (end - onset) as f64 / rate_hz;
        let (peak_speed, mean_speed) = (speed[peak], path / duration_s);
        Ok(Self {
            onset,
            end,
            duration_s,
            peak_speed,
            mean_speed,
            peak_over_mean: peak_speed / mean_speed,
            time_of_peak: (peak - onset) as f64 / (end - onset) as f64,
            speed_maxima: prominent_maxima(inside, PROMINENCE * peak_speed),
            path,
            chord,
            path_over_chord: (chord > NO_CHORD * path).then(|| path / chord),
            sparc: smoothness::sparc(inside, rate_hz)?,
            ldlj: smoothness::ldlj(inside, rate_hz)?,
        })
    }
}

/// Samples of onset, peak and end.
fn edges(speed: &[f64], onset: Edge, end: Edge) -> Result<(usize, usize, usize)> {
    let first = given("onset", onset, 0, speed)?;
    let last = given("end", end, speed.len() - 1, speed)?;
    check::setting("end", last as f64, "after the onset", last > first)?;
    let peak = first + highest(&speed[first..=last]);
    check::setting("peak speed in m/s", speed[peak], "greater than 0", speed[peak] > 0.0)?;
    let onset = if onset == Edge::Threshold { onset_before(speed, peak)? } else { first };
    let end = if end == Edge::Threshold { end_behind(speed, peak)? } else { last };
    Ok((onset, peak, end))
}

/// The sample that an edge gives, or another where it gives none.
fn given(what: &'static str, edge: Edge, otherwise: usize, speed: &[f64]) -> Result<usize> {
    let Edge::Sample(sample) = edge else { return Ok(otherwise) };
    check::setting(what, sample as f64, "a sample of the recording", sample < speed.len())?;
    Ok(sample)
}

/// First sample of the bell with the peak that is above the threshold.
fn onset_before(speed: &[f64], peak: usize) -> Result<usize> {
    let rest = speed[..peak].iter().rposition(|&v| v <= THRESHOLD * speed[peak]);
    let right = "let the recording begin earlier, or give the sample of the onset";
    rest.map(|rest| rest + 1).ok_or_else(|| no_edge("onset of the movement", speed, peak, 0, right))
}

/// First sample behind the peak that is below the threshold.
fn end_behind(speed: &[f64], peak: usize) -> Result<usize> {
    let rest = speed[peak..].iter().position(|&v| v < THRESHOLD * speed[peak]);
    let right = "let the recording last longer, or give the sample of the end";
    rest.map(|rest| peak + rest).ok_or_else(|| no_edge("end of the movement", speed, peak, speed.len() - 1, right))
}

fn no_edge(what: &'static str, speed: &[f64], peak: usize, index: usize, right: &'static str) -> MeasureError {
    MeasureError::NoEdge { what, index, share: speed[index] / speed[peak], threshold: THRESHOLD, right }
}

/// Index of the first of the highest values.
fn highest(x: &[f64]) -> usize {
    (0..x.len()).fold(0, |best, i| if x[i] > x[best] { i } else { best })
}

/// How many maxima rise by more than `least` over both the lowest values between them and higher ground or the ends. The ends
/// themselves are no maxima; level ground counts once.
fn prominent_maxima(x: &[f64], least: f64) -> usize {
    maxima(x).filter(|&(from, to)| prominence(x, from, to) > least).count()
}

/// First and last sample of each stretch of equal values that is higher than what is before and behind it.
fn maxima(x: &[f64]) -> impl Iterator<Item = (usize, usize)> {
    (1..x.len()).filter(|&from| x[from - 1] < x[from]).filter_map(|from| {
        let to = from + x[from..].iter().take_while(|&&y| y == x[from]).count() - 1;
        x.get(to + 1).is_some_and(|&after| after < x[from]).then_some((from, to))
    })
}

fn prominence(x: &[f64], from: usize, to: usize) -> f64 {
    let top = x[from];
    let lowest =
        |valley: &mut dyn Iterator<Item = &f64>| valley.take_while(|&&y| y <= top).copied().fold(top, f64::min);
    let (before, behind) = (lowest(&mut x[..from].iter().rev()), lowest(&mut x[to + 1..].iter()));
    top - before.max(behind)
}
