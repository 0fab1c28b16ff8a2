//! Figures of aimed movements that were recorded, of people and of simulated users in the same way.

use myo_measure::fitts::{Condition, Pointing, Trial as FittsTrial, index_of_difficulty};
use myo_measure::{MeasureError, Movement, Point, signal, statistics};
use serde::{Deserialize, Serialize};

use super::{Outcome, Participant, RecordingError, Recordings, Selection, Trial, apart};
use crate::protocol::{Aimed, CUT_OFF_HZ, Done, OverUsers, StraightOn, Track};

/// All recordings are measured at this rate (Hz), that of the simulation.
const RATE_HZ: f64 = 500.0;
/// Distances and widths (m) that differ by less are one condition.
const SAME_DISTANCE: f64 = 0.01;
pub(crate) const SAME_WIDTH: f64 = 0.001;
/// Fewest movements of a condition that count for Fitts' law, and fewest of a person.
pub(crate) const LEAST_OF_CONDITION: usize = 4;
const LEAST_CONDITIONS: usize = 3;
const LEAST_MOVEMENTS: usize = 5;

/// What aimed movements of some people are like.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AimedFigures {
    /// How many people.
    pub participants: usize,
    /// Movements at targets, those that missed included.
    pub movements: usize,
    /// Targets that the hand was not in in the end. Such movements count, for times as for throughput: ISO 9241-411 makes errors wider targets.
    pub missed: usize,
    /// Figures; those that cannot be had are left out.
    pub rows: Vec<AimedRow>,
    /// Index of difficulty (bit) and mean movement time (s) of each person's pairs of distance and width that Fitts' law goes through.
    pub times_by_index: Vec<[f64; 2]>,
    /// Fitts' law.
    pub fitts: Option<FittsOfAimed>,
    /// Why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_fitts: Option<String>,
}

/// A figure of movements: the median of each person, over people.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AimedRow {
    /// Its name in JSON.
    pub figure: &'static str,
    /// What it is, for people.
    pub what: &'static str,
    /// Its unit; empty for shares and counts.
    pub unit: &'static str,
    /// The median over people.
    pub median: f64,
    /// 95 % confidence interval of the mean over people.
    pub interval: Option<[f64; 2]>,
}

/// Fitts' law through the means of conditions, person by person.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittsOfAimed {
    /// Pairs of distance and width, on average over people.
    pub conditions: f64,
    /// Share of the variance of the means that it explains.
    pub r2: OverUsers,
    /// Slope (s/bit).
    pub slope_s_per_bit: OverUsers,
    /// Intercept (s).
    pub intercept_s: OverUsers,
    /// Effective throughput (bit/s), ISO 9241-411.
    pub throughput_bit_s: OverUsers,
}

/// A movement that was measured.
pub(crate) struct Measured {
    /// From the centre of the target before, or from where the hand was (m).
    pub distance: f64,
    /// Of the target (m).
    pub width: f64,
    pub aimed: Aimed,
    /// Of each muscle that was recorded, on average from the onset of the movement to the end of the selection.
    pub activations: Vec<f64>,
    /// As seen from its start towards the target.
    pub straight_on: Option<StraightOn>,
}

type OfMovement = fn(&Movement, &Measured) -> Option<f64>;

/// What is told of movements.
const FIGURES: [(&str, &str, &str, OfMovement); 11] = [
    ("movement_time_s", "movement time", "s", |_, one| Some(one.aimed.trial.movement_time_s)),
    ("distance_m", "distance", "m", |_, one| Some(one.distance)),
    ("index_bit", "index of difficulty", "bit", |_, one| Some(index_of_difficulty(one.distance, one.width))),
    ("peak_speed_m_s", "peak speed", "m/s", |movement, _| Some(movement.peak_speed)),
    ("peak_over_mean", "peak over mean speed", "", |movement, _| Some(movement.peak_over_mean)),
    ("time_of_peak", "time of the peak, share of the duration", "", |movement, _| Some(movement.time_of_peak)),
    ("speed_maxima", "speed maxima", "", |movement, _| Some(movement.speed_maxima as f64)),
    ("sparc", "smoothness, SPARC", "", |movement, _| Some(movement.sparc)),
    ("ldlj", "smoothness, LDLJ", "", |movement, _| Some(movement.ldlj)),
    ("path_over_chord", "path over chord", "", |movement, _| movement.path_over_chord),
    ("off_centre_m", "end of the movement from the centre of the target", "m", |_, one| {
        let FittsTrial { end, target, .. } = one.aimed.trial;
        Some(apart(end, target))
    }),
];

impl AimedFigures {
    /// Of all people, each of whom counts as much.
    ///
    /// # Errors
    /// Somebody made too few movements, or a movement cannot be measured.
    pub fn of(recordings: &Recordings) -> Result<Self, RecordingError> {
        let people = recordings.participants.iter().map(measured).collect::<Result<Vec<_>, _>>()?;
        let missed = people.iter().map(|(_, missed)| missed).sum();
        let people: Vec<Vec<Measured>> = people.into_iter().map(|(movements, _)| movements).collect();
        let rows = FIGURES.iter().filter_map(|figure| row(figure, &people)).collect();
        let (fitts, no_fitts) = match fitts(&people) {
            Ok(fitts) => (Some(fitts), None),
            Err(reason) => (None, Some(reason.to_string())),
        };
        let movements = people.iter().map(Vec::len).sum();
        let times_by_index = people.iter().flat_map(|own| conditions(own)).map(|one| index_and_time(&one)).collect();
        Ok(Self { participants: people.len(), movements, missed, rows, times_by_index, fitts, no_fitts })
    }
}

fn index_and_time(condition: &Condition) -> [f64; 2] {
    let times = condition.trials.iter().map(|trial| trial.movement_time_s).sum::<f64>();
    [index_of_difficulty(condition.distance, condition.width), times / condition.trials.len() as f64]
}

/// A figure over people; none where no movement has it.
fn row(
    &(figure, what, unit, of): &(&'static str, &'static str, &'static str, OfMovement),
    people: &[Vec<Measured>],
) -> Option<AimedRow> {
    let of_person = |movements: &Vec<Measured>| {
        let values: Vec<f64> = movements
            .iter()
            .filter_map(|one| of(one.aimed.movement.as_ref()?, one))
            .filter(|x| x.is_finite())
            .collect();
        statistics::median(&values).ok()
    };
    let medians: Vec<f64> = people.iter().filter_map(of_person).collect();
    let OverUsers { median, interval } = OverUsers::of(&medians, what).ok()?;
    Some(AimedRow { figure, what, unit, median, interval })
}

/// Movements of a person, and how many of the targets were missed.
pub(crate) fn measured(person: &Participant) -> Result<(Vec<Measured>, usize), RecordingError> {
    let (mut all, mut missed) = (vec![], 0);
    for trial in &person.trials {
        let error = |what: String| {
            let what = format!("{}, {}{what}", person.name, trial.name);
            move |error| RecordingError::Measure { what, error }
        };
        let raw = even(trial).map_err(error(String::new()))?;
        let smooth = signal::low_pass_points(&raw, RATE_HZ, CUT_OFF_HZ).map_err(error(String::new()))?;
        let track = Track { raw: &raw, smooth: &smooth, rate_hz: RATE_HZ };
        let mut before: Option<&Selection> = None;
        for (number, selection) in (1..).zip(&trial.selections) {
            // Where the hand went without a target in between is another way.
            before = before.filter(|before| selection.samples[0] == before.samples[1] + 1);
            let done = done(selection, trial, raw.len());
            let earliest = before.map_or(done.begin, |before| self::done(before, trial, raw.len()).entry);
            let start = before.map_or(raw[done.begin], |before| before.target);
            let aimed = track.aimed(done, selection.target, earliest).map_err(error(format!(", movement {number}")))?;
            before = Some(selection);
            missed += usize::from(selection.outcome != Outcome::Hit);
            // Who was there already did not move, and who gave up ended nowhere.
            if selection.outcome != Outcome::GivenUp && aimed.movement.is_some() {
                let straight_on =
                    track.straight_on(&aimed, selection.target).map_err(error(format!(", movement {number}")))?;
                let distance = apart(start, selection.target);
                let activations = active(trial, person.muscles.len(), aimed.samples);
                all.push(Measured { distance, width: selection.width, aimed, activations, straight_on });
            }
        }
    }
    if all.len() < LEAST_MOVEMENTS {
        return Err(RecordingError::TooFew(format!(
            "{} made {} movements at targets, and missed {missed}; at least {LEAST_MOVEMENTS} movements of each person are needed",
            person.name,
            all.len()
        )));
    }
    Ok((all, missed))
}

/// Mean activations of a trial from one sample of the even rate to another.
fn active(trial: &Trial, muscles: usize, [first, last]: [usize; 2]) -> Vec<f64> {
    let at = |sample: usize| trial.times.partition_point(|time| time * RATE_HZ + 0.5 < sample as f64);
    // Of samples far apart there may be none in a short movement: then the next one counts.
    let begin = at(first).min(trial.times.len() - 1);
    let end = at(last + 1).max(begin + 1);
    let mean = |muscle: usize| {
        (begin..end).map(|sample| trial.activations[sample * muscles + muscle]).sum::<f64>() / (end - begin) as f64
    };
    (0..muscles).map(mean).collect()
}

/// A selection in samples of the even rate.
fn done(selection: &Selection, trial: &Trial, length: usize) -> Done {
    let sample = |index: usize| ((trial.times[index] * RATE_HZ).round() as usize).min(length - 1);
    let [begin, end] = selection.samples.map(sample);
    Done { begin, entry: sample(selection.entry), end }
}

/// The hand at even times.
fn even(trial: &Trial) -> Result<Vec<Point>, MeasureError> {
    let axis = |k: usize| {
        let x: Vec<f64> = trial.points.iter().map(|point| point[k]).collect();
        signal::resample(&trial.times, &x, RATE_HZ)
    };
    let [x, y, z] = [axis(0)?, axis(1)?, axis(2)?];
    Ok((0..x.len()).map(|k| [x[k], y[k], z[k]]).collect())
}

fn fitts(people: &[Vec<Measured>]) -> Result<FittsOfAimed, MeasureError> {
    let of_person = |movements: &Vec<Measured>| {
        let all = conditions(movements);
        let what = "conditions (distance and width) with four movements";
        if all.is_empty() {
            return Err(MeasureError::TooFew { what, found: 0, least: LEAST_CONDITIONS });
        }
        Pointing::of(&all)
    };
    FittsOfAimed::of(&people.iter().map(of_person).collect::<Result<Vec<_>, _>>()?)
}

impl FittsOfAimed {
    /// Of some people.
    pub(crate) fn of(people: &[Pointing]) -> Result<Self, MeasureError> {
        let fits = people.iter().map(Pointing::fit).collect::<Result<Vec<_>, _>>()?;
        let throughputs = people.iter().map(Pointing::throughput).collect::<Result<Vec<_>, _>>()?;
        let over = |values: &[f64]| myo_measure::Spread::of(values).map(OverUsers::from);
        let over_fits = |of: fn(&statistics::Line) -> f64| over(&fits.iter().map(of).collect::<Vec<_>>());
        let conditions: usize = people.iter().map(|person| person.conditions.len()).sum();
        Ok(Self {
            conditions: conditions as f64 / people.len() as f64,
            r2: over_fits(|line| line.r2)?,
            slope_s_per_bit: over_fits(|line| line.slope)?,
            intercept_s: over_fits(|line| line.intercept)?,
            throughput_bit_s: over(&throughputs)?,
        })
    }
}

/// Movements by distance and width, those conditions of which there are enough.
fn conditions(movements: &[Measured]) -> Vec<Condition> {
    let mut all: Vec<Condition> = vec![];
    for one in movements {
        let is_same = |condition: &&mut Condition| {
            (condition.distance - one.distance).abs() < SAME_DISTANCE
                && (condition.width - one.width).abs() < SAME_WIDTH
        };
        match all.iter_mut().find(is_same) {
            Some(condition) => condition.trials.push(one.aimed.trial),
            None => all.push(Condition { distance: one.distance, width: one.width, trials: vec![one.aimed.trial] }),
        }
    }
    all.retain(|condition| condition.trials.len() >= LEAST_OF_CONDITION);
    all
}
