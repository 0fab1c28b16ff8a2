//! Single reaches of a recording, each with the figures of its movement.

use std::ops::RangeInclusive;

use myo_measure::fitts::Trial;
use myo_measure::{Edge, MeasureError, Movement, centre, signal};

use super::ProtocolError;
use super::practice::{circle_targets, conditions};
use super::recording::{Done, Recording};

/// What is faster (Hz) is no movement of an arm: where recordings are cut off before speeds are taken.
const CUT_OFF_HZ: f64 = 10.0;
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
            let all = &recording.done;
            let of = |selection: usize| {
                // Who knows what comes next begins before the dwell is over.
                let earliest = selection.checked_sub(1).map_or(0, |before| all[before].entry);
                reach(recording, &smooth, (condition, selection), earliest)
            };
            reaches.extend((0..all.len()).map(of).collect::<Result<Vec<_>, _>>()?);
        }
    }
    Ok(reaches)
}

fn reach(
    recording: &Recording,
    smooth: &[[f64; 3]],
    (condition, selection): (usize, usize),
    earliest: usize,
) -> Result<Reach, ProtocolError> {
    let ([distance, _], done) = (conditions()[condition], recording.done[selection]);
    let raw = &recording.fingertip;
    let end = done.end.min(raw.len() - 1);
    let moved = done.entry > done.begin + LEAST_SAMPLES;
    let found = moved.then(|| movement(&smooth[earliest..=end], recording.rate_hz, done, earliest));
    let found = found.transpose().map_err(ProtocolError::measuring("a movement"))?;
    // Where nothing moved the time is that from the signal to the entry, which is short or none.
    let onset = found.as_ref().map_or(done.begin, |found| found.samples[0]);
    let trial = Trial {
        movement_time_s: (done.entry - onset) as f64 / recording.rate_hz,
        start: raw[onset],
        target: circle_targets(distance)[selection],
        end: centre(&raw[done.entry..=end]),
    };
    Ok(Reach {
        condition,
        selection,
        trial,
        first_stop: found.as_ref().map(|found| smooth[found.first_stop]),
        movement: found.as_ref().map(|found| found.movement),
        samples: [onset, end],
        profile: found.map_or_else(Vec::new, |found| found.profile),
    })
}

/// A movement, and where it is in a recording.
struct Found {
    movement: Movement,
    /// Its first and last sample.
    samples: [usize; 2],
    /// Where its first bell ends.
    first_stop: usize,
    profile: Vec<f64>,
}

/// From 5 % of the peak speed, or from where the hand turned that never came to rest, to 5 % of it, or to the last entry into the target where
/// that is later. `positions` begin with the sample `first`.
fn movement(positions: &[[f64; 3]], rate_hz: f64, done: Done, first: usize) -> Result<Found, MeasureError> {
    let speed = signal::speed(positions, rate_hz)?;
    let (signal_at, entry) = (done.begin - first, done.entry - first);
    let slowest =
        |within: RangeInclusive<usize>| within.min_by(|&a, &b| speed[a].total_cmp(&speed[b])).unwrap_or(entry);
    let fastest = (signal_at..=entry).max_by(|&a, &b| speed[a].total_cmp(&speed[b])).unwrap_or(entry);
    let turn = slowest(0..=fastest);
    let ends = Edge::Sample(slowest(entry..=positions.len() - 1) - turn);
    let (mine, speed) = (&positions[turn..], &speed[turn..]);
    let try_edges = |onset: Edge| {
        let at_rest = Movement::of(mine, rate_hz, onset, Edge::Threshold);
        at_rest.or_else(|_| Movement::of(mine, rate_hz, onset, ends))
    };
    let bell = try_edges(Edge::Threshold).or_else(|_| try_edges(Edge::Sample(0)))?;
    let entry = entry - turn;
    let whole = match entry <= bell.end {
        true => bell,
        false => Movement::of(mine, rate_hz, Edge::Sample(bell.onset), Edge::Sample(entry))?,
    };
    let at = |sample: usize| first + turn + sample;
    Ok(Found {
        movement: whole,
        samples: [whole.onset, whole.end].map(at),
        first_stop: at(bell.end),
        profile: profile(&speed[whole.onset..=whole.end]),
    })
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
