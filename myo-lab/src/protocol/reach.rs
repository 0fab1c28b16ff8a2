//! Single reaches of a recording, each with the figures of its movement.

use std::ops::RangeInclusive;

use myo_measure::fitts::Trial;
use myo_measure::{Edge, MeasureError, Movement, centre, signal};

use super::ProtocolError;
use super::practice::{circle_targets, conditions};
use super::recording::{Done, Recording};

/// What is faster (Hz) is no movement of an arm: where recordings are cut off before speeds are taken.
pub(crate) const CUT_OFF_HZ: f64 = 10.0;
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
    let track = Track { raw: &recording.fingertip, smooth, rate_hz: recording.rate_hz };
    let Aimed { trial, movement, profile, first_stop, samples } = track
        .aimed(done, circle_targets(distance)[selection], earliest)
        .map_err(ProtocolError::measuring("a movement"))?;
    Ok(Reach { condition, selection, trial, movement, profile, first_stop, samples })
}

/// Where a hand was, as it was recorded and smoothed.
#[derive(Clone, Copy)]
pub(crate) struct Track<'a> {
    /// As it was recorded (m).
    pub raw: &'a [[f64; 3]],
    /// Without what is no movement of an arm.
    pub smooth: &'a [[f64; 3]],
    /// Samples per second.
    pub rate_hz: f64,
}

/// A movement at one target; fields as those of [`Reach`].
pub(crate) struct Aimed {
    pub trial: Trial,
    pub movement: Option<Movement>,
    pub profile: Vec<f64>,
    pub first_stop: Option<[f64; 3]>,
    pub samples: [usize; 2],
}

impl Track<'_> {
    /// What was done at a target (m); the movement does not begin before the sample `earliest`.
    pub(crate) fn aimed(&self, done: Done, target: [f64; 3], earliest: usize) -> Result<Aimed, MeasureError> {
        let Self { raw, smooth, rate_hz } = *self;
        let end = done.end.min(raw.len() - 1);
        let moved = done.entry > done.begin + LEAST_SAMPLES;
        let found = moved.then(|| movement(&smooth[earliest..=end], rate_hz, done, earliest)).transpose()?;
        // Where nothing moved the time is that from the signal to the entry, which is short or none.
        let onset = found.as_ref().map_or(done.begin, |found| found.samples[0]);
        let trial = Trial {
            movement_time_s: (done.entry - onset) as f64 / rate_hz,
            start: raw[onset],
            target,
            end: centre(&raw[done.entry..=end]),
        };
        Ok(Aimed {
            trial,
            first_stop: found.as_ref().map(|found| smooth[found.first_stop]),
            movement: found.as_ref().map(|found| found.movement),
            samples: [onset, end],
            profile: found.map_or_else(Vec::new, |found| found.profile),
        })
    }
}

/// A movement straight on to its target, at even shares of its duration.
pub(crate) struct StraightOn {
    /// How much of the way from its start to the centre lies behind, as a share.
    pub share: Vec<f64>,
    /// How fast it goes on (m/s).
    pub velocity: Vec<f64>,
}

impl Track<'_> {
    /// A movement as seen from its start towards its target (m); none where there is no movement.
    pub(crate) fn straight_on(&self, aimed: &Aimed, target: [f64; 3]) -> Result<Option<StraightOn>, MeasureError> {
        let Some(movement) = aimed.movement else { return Ok(None) };
        let onset = aimed.samples[0];
        let end = (onset + (movement.duration_s * self.rate_hz).round() as usize).min(self.smooth.len() - 1);
        let start = self.smooth[onset];
        let way = [0, 1, 2].map(|k| target[k] - start[k]);
        let distance = way.map(|x| x * x).iter().sum::<f64>().sqrt();
        let along = |point: &[f64; 3]| [0, 1, 2].map(|k| (point[k] - start[k]) * way[k]).iter().sum::<f64>() / distance;
        let behind: Vec<f64> = self.smooth[onset..=end].iter().map(along).collect();
        let velocity = signal::derivative(&behind, self.rate_hz)?;
        let share = behind.iter().map(|behind| behind / distance).collect::<Vec<_>>();
        Ok(Some(StraightOn { share: profile(&share), velocity: profile(&velocity) }))
    }
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

/// What was at each sample, at even shares of the time, straight between samples.
fn profile(speed: &[f64]) -> Vec<f64> {
    let last = (speed.len() - 1) as f64;
    let at = |place: usize| {
        let sample = last * place as f64 / (PROFILE - 1) as f64;
        let (below, above) = (speed[sample.floor() as usize], speed[sample.ceil() as usize]);
        below + (above - below) * sample.fract()
    };
    (0..PROFILE).map(at).collect()
}

/// Means of profiles, place by place.
pub(crate) fn mean_profile<'a>(profiles: impl Iterator<Item = &'a Vec<f64>>) -> Vec<f64> {
    let (mut sum, mut count) = (vec![], 0.0);
    for profile in profiles.filter(|profile| !profile.is_empty()) {
        sum.resize(profile.len(), 0.0);
        sum.iter_mut().zip(profile).for_each(|(sum, speed)| *sum += speed);
        count += 1.0;
    }
    sum.iter().map(|sum| sum / count).collect()
}
