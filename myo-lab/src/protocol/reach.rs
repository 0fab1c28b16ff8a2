//! Single reaches of a recording, each with the figures of its movement.

use myo_measure::fitts::Trial;
use myo_measure::{Edge, MeasureError, Movement, signal};

use super::ProtocolError;
use super::practice::{circle_targets, conditions};
use super::recording::{Done, Recording};

/// What is faster (Hz) is no movement of an arm: where recordings are cut off before speeds are taken.
const CUT_OFF_HZ: f64 = 10.0;
/// How long (s) before its signal a movement is looked for: users who know what comes next begin before the dwell is over.
const BEFORE_S: f64 = 0.1;
/// Places of a movement where its speed is told.
const PROFILE: usize = 51;
/// Fewest samples that are a movement.
const LEAST_SAMPLES: usize = 12;

/// A reach from target to target, or from the hanging arm to the first one.
#[derive(Clone, Debug)]
pub struct Reach {
    /// Which of the [`conditions`].
    pub condition: usize,
    /// Which selection of the episode, from 0; the first begins with the hanging arm.
    pub selection: usize,
    /// As Fitts' law sees it.
    pub trial: Trial,
    /// Its figures; none where the fingertip was there already.
    pub movement: Option<Movement>,
    /// Speed (m/s) at even shares of its duration, from its onset to its end; empty where there is none.
    pub profile: Vec<f64>,
    /// Where the first bell of its speed ended (m): the end of the movement before anything was corrected.
    pub first_stop: Option<[f64; 3]>,
    /// First and last sample of the recording that it has.
    pub samples: [usize; 2],
}

/// All reaches of users' recordings by layout.
pub fn reaches(by_layout: &[Vec<Recording>]) -> Result<Vec<Reach>, ProtocolError> {
    let mut reaches = vec![];
    for (condition, recordings) in by_layout.iter().enumerate() {
        for recording in recordings {
            let smooth = signal::low_pass_points(&recording.fingertip, recording.rate_hz, CUT_OFF_HZ);
            let smooth = smooth.map_err(ProtocolError::measuring("smoothing a recording"))?;
            let done = recording.done.iter().enumerate();
            let of = |(selection, done): (usize, &Done)| reach(recording, &smooth, (condition, selection), *done);
            reaches.extend(done.map(of).collect::<Result<Vec<_>, _>>()?);
        }
    }
    Ok(reaches)
}

fn reach(
    recording: &Recording,
    smooth: &[[f64; 3]],
    (condition, selection): (usize, usize),
    done: Done,
) -> Result<Reach, ProtocolError> {
    let [distance, _] = conditions()[condition];
    let raw = &recording.fingertip;
    // Where it was when the dwell was over.
    let end = done.end.min(raw.len() - 1);
    let trial = Trial {
        movement_time_s: (done.entry - done.begin) as f64 / recording.rate_hz,
        start: raw[done.begin],
        target: circle_targets(distance)[selection],
        end: raw[end],
    };
    let first = done.begin.saturating_sub((BEFORE_S * recording.rate_hz) as usize);
    let moved = done.entry > done.begin + LEAST_SAMPLES;
    let found =
        moved.then(|| movement(&smooth[first..=end], recording.rate_hz, done.begin - first, done.entry - first));
    let found = found.transpose().map_err(ProtocolError::measuring("a movement"))?;
    Ok(Reach {
        condition,
        selection,
        trial,
        first_stop: found.as_ref().map(|(_, stop, _)| smooth[first + stop]),
        movement: found.as_ref().map(|(movement, ..)| *movement),
        profile: found.map_or_else(Vec::new, |(.., profile)| profile),
        samples: [first, end],
    })
}

/// From 5 % of the peak speed to 5 % of it, or to the last entry into the target where that is later; where the first bell ends; and the speed
/// at even shares of the duration.
fn movement(
    positions: &[[f64; 3]],
    rate_hz: f64,
    signal_at: usize,
    entry: usize,
) -> Result<(Movement, usize, Vec<f64>), MeasureError> {
    let speed = signal::speed(positions, rate_hz)?;
    // Who never came to rest began with the signal, and ended where it was slowest within the target.
    let slowest = (entry..positions.len()).fold(entry, |best, at| if speed[at] < speed[best] { at } else { best });
    let try_edges = |onset: Edge| {
        Movement::of(positions, rate_hz, onset, Edge::Threshold)
            .or_else(|_| Movement::of(positions, rate_hz, onset, Edge::Sample(slowest)))
    };
    let bell = try_edges(Edge::Threshold).or_else(|_| try_edges(Edge::Sample(signal_at)))?;
    let whole = match entry <= bell.end {
        true => bell,
        false => Movement::of(positions, rate_hz, Edge::Sample(bell.onset), Edge::Sample(entry))?,
    };
    Ok((whole, bell.end, profile(&speed[whole.onset..=whole.end])))
}

/// A speed at even shares of its time, straight between samples.
fn profile(speed: &[f64]) -> Vec<f64> {
    let last = (speed.len() - 1) as f64;
    let at = |place: usize| {
        let sample = last * place as f64 / (PROFILE - 1) as f64;
        let (below, above) = (speed[sample.floor() as usize], speed[sample.ceil() as usize]);
        below + (above - below) * sample.fract()
    };
    (0..PROFILE).map(at).collect()
}
