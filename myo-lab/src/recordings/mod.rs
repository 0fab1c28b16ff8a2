//! Recordings of hands that aimed at targets, of people or of simulated users, from a table of samples.
//!
//! The table is text with a head line, values separated by commas, a row for each sample, rows of a trial together and in order:
//!
//! | column | what it is |
//! |---|---|
//! | `participant` | who, by any name; may be left out where there is one |
//! | `trial` or `episode` | which recording of theirs |
//! | `layout` | which layout, where there are several |
//! | `time_s` or `time_ms` | when; the clock may begin anywhere |
//! | `x_m`, `y_m`, `z_m`, or `fingertip_x_m` and so on, or `pointer_x_m` and so on | where the hand, or what it points with, is; `z_m` may be left out; also in `_cm` and `_mm` |
//! | `target_x_m` and so on, or `object_x_m` and so on | centre of the target that is to be come to |
//! | `target_width_m` or `object_width_m` | its width: of a sphere the diameter |
//! | `MUSCLE_activation` | may be left out: how active a muscle of the simulated body is, 0 to 1; of people the envelope of its electromyogram as a share of that of the greatest voluntary contraction |
//! | `event` | may be left out: `entered` in the row of the last entry into the target, `done` in the last row of a selection |
//!
//! What [`trajectories`](crate::trajectories()) writes is such a table; its columns of joints are passed over, and so are columns whose name begins
//! with `note_` or that have none. Where no row has `done` a selection ends where another target is to be come to, or with its trial, and its target was entered
//! when the hand came into it for the last time. Who did not end in the target missed it: the movement counts, with where it ended, unless the time was up (`time_out`, or `given_up` of one selection among others).

mod aimed;
mod columns;
mod simulated;

use std::io::Read;

use myo_measure::{MeasureError, Point};
use thiserror::Error;

pub use aimed::{AimedFigures, AimedRow, FittsOfAimed};
pub(crate) use aimed::{LEAST_OF_CONDITION, Measured, SAME_WIDTH, measured};
use columns::{Columns, Sample};

use crate::TrajectoryError;

/// Samples that are further apart in time than this (s) leave a gap.
const GAP_S: f64 = 0.1;
/// Nobody's hand is farther (m) from where places are measured from.
const FARTHEST_M: f64 = 10.0;
/// Fewest samples of a trial.
const LEAST_SAMPLES: usize = 20;

/// Why recordings cannot be measured.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The text is no such table.
    #[error("line {line}: {message}")]
    Csv {
        /// The line, from one.
        line: u64,
        /// What is wrong.
        message: String,
    },
    /// A column is missing, or is not known.
    #[error("{0}")]
    Columns(String),
    /// A value cannot be one.
    #[error("line {line}: `{column}` is {value}; {right}")]
    Value {
        /// The line, from one.
        line: u64,
        /// The column.
        column: String,
        /// What stands there.
        value: String,
        /// What would be right.
        right: &'static str,
    },
    /// A trial is not as a recording is.
    #[error("{trial}: {problem}")]
    Trial {
        /// Which.
        trial: String,
        /// What is wrong, and what would be right.
        problem: String,
    },
    /// Too little was recorded.
    #[error("{0}")]
    TooFew(String),
    /// A simulated user cannot be recorded.
    #[error(transparent)]
    Simulate(#[from] TrajectoryError),
    /// A movement has no figures.
    #[error("{what}: {error}")]
    Measure {
        /// Which movement.
        what: String,
        /// Why.
        error: MeasureError,
    },
}

/// Recordings of one or several people.
#[derive(Clone, Debug, PartialEq)]
pub struct Recordings {
    /// Each of them.
    pub participants: Vec<Participant>,
}

/// All that one person did.
#[derive(Clone, Debug, PartialEq)]
pub struct Participant {
    /// Who.
    pub name: String,
    /// Muscles whose activations were recorded.
    pub muscles: Vec<String>,
    /// Their recordings.
    pub trials: Vec<Trial>,
}

/// One recording without a gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// What it is called, with the layout if there is one.
    pub name: String,
    /// Times (s) of the samples, from zero.
    pub times: Vec<f64>,
    /// Where the hand was (m).
    pub points: Vec<Point>,
    /// Activations, (samples, muscles); nothing where none were recorded.
    pub activations: Vec<f64>,
    /// What was to be come to, selection by selection.
    pub selections: Vec<Selection>,
}

/// A target that was to be come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// Its centre (m).
    pub target: Point,
    /// Its width (m).
    pub width: f64,
    /// First and last sample.
    pub samples: [usize; 2],
    /// The sample of the last entry; of a miss, the one from which the hand stayed within the target's width about where it ended.
    pub entry: usize,
    /// How it ended.
    pub outcome: Outcome,
}

/// How a selection ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// In the target.
    Hit,
    /// Beside it.
    Miss,
    /// Not at all: the time was up (`time_out`).
    GivenUp,
}

impl Recordings {
    /// Reads a table.
    ///
    /// # Errors
    /// It is no such table, a value cannot be one, a recording has a gap, or its clock goes back.
    pub fn read(text: impl Read) -> Result<Self, RecordingError> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text);
        let columns = Columns::of(reader.headers().map_err(wrong_table)?)?;
        let mut found = Gathered::of(columns.muscles.clone());
        for record in reader.records() {
            let record = record.map_err(wrong_table)?;
            let line = record.position().map_or(0, csv::Position::line);
            found.add(columns.sample(&record, line)?)?;
        }
        found.whole()
    }

    /// All participants taken for one person.
    #[must_use]
    pub fn as_one(self) -> Self {
        let name = format!("all {} participants", self.participants.len());
        // What was not recorded of everybody tells nothing of all together.
        let first = self.participants.first().map(|person| person.muscles.clone()).unwrap_or_default();
        let muscles = if self.participants.iter().all(|person| person.muscles == first) { first } else { vec![] };
        let trials = self.participants.into_iter().flat_map(|person| person.trials).collect();
        Self { participants: vec![Participant { name, muscles, trials }] }
    }

    /// Puts people of other recordings behind these.
    pub fn append(&mut self, others: Self) {
        self.participants.extend(others.participants);
    }
}

fn wrong_table(error: csv::Error) -> RecordingError {
    let line = error.position().map_or(1, csv::Position::line);
    let message = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("this row has {len} values, and the head line names {expected_len}")
        }
        _ => error.to_string(),
    };
    RecordingError::Csv { line, message }
}

/// Samples that were read so far.
struct Gathered {
    muscles: Vec<String>,
    participants: Vec<Participant>,
    /// Those of the trial that is being read.
    current: Vec<Sample>,
}

impl Gathered {
    const fn of(muscles: Vec<String>) -> Self {
        Self { muscles, participants: vec![], current: vec![] }
    }

    fn add(&mut self, sample: Sample) -> Result<(), RecordingError> {
        if self.current.last().is_some_and(|last| last.whose() != sample.whose()) {
            self.close()?;
        }
        self.current.push(sample);
        Ok(())
    }

    /// Ends a trial.
    fn close(&mut self) -> Result<(), RecordingError> {
        let samples = std::mem::take(&mut self.current);
        let Some(first) = samples.first() else { return Ok(()) };
        let (who, name) = (first.participant.clone(), first.trial_name());
        let problem = |problem: String| RecordingError::Trial { trial: format!("{who}, {name}"), problem };
        let known = self.participants.iter().position(|participant| participant.name == who);
        let index = known.unwrap_or_else(|| {
            self.participants.push(Participant { name: who.clone(), muscles: self.muscles.clone(), trials: vec![] });
            self.participants.len() - 1
        });
        let trials = &mut self.participants[index].trials;
        if trials.iter().any(|trial| trial.name == name) {
            return Err(problem("its rows are not together; sort the table by participant, trial and time".into()));
        }
        trials.push(trial(&samples, name.clone()).map_err(problem)?);
        Ok(())
    }

    fn whole(mut self) -> Result<Recordings, RecordingError> {
        self.close()?;
        if self.participants.is_empty() {
            return Err(RecordingError::TooFew("there is no sample in the table".into()));
        }
        Ok(Recordings { participants: self.participants })
    }
}

/// A trial of its samples, or what is wrong with it.
fn trial(samples: &[Sample], name: String) -> Result<Trial, String> {
    if samples.len() < LEAST_SAMPLES {
        return Err(format!("it has {} samples; at least {LEAST_SAMPLES} are needed", samples.len()));
    }
    for pair in samples.windows(2) {
        let (time, step) = (pair[0].time_s, pair[1].time_s - pair[0].time_s);
        if step <= 0.0 {
            let line = pair[1].line;
            return Err(format!("its clock stands or goes back in line {line}, after {time} s; times must rise"));
        }
        if step > GAP_S {
            return Err(format!(
                "there is a gap of {step:.3} s after {time} s (line {}); cut the recording there into two trials, or is the clock in milliseconds (`time_ms`)?",
                pair[0].line
            ));
        }
    }
    let start = samples[0].time_s;
    Ok(Trial {
        name,
        times: samples.iter().map(|sample| sample.time_s - start).collect(),
        points: samples.iter().map(|sample| sample.point).collect(),
        activations: samples.iter().flat_map(|sample| sample.activations.iter().copied()).collect(),
        selections: selections(samples),
    })
}

/// Stretches of samples with one target, up to its `done`.
fn selections(samples: &[Sample]) -> Vec<Selection> {
    let mut all = vec![];
    let mut begin = 0;
    // A target may move: where ends are told, nothing else is one.
    let are_told = samples.iter().any(|sample| sample.ends);
    for index in 0..samples.len() {
        let is_last = index + 1 == samples.len();
        let changes = || {
            let [now, next] = [index, index + 1].map(|k| samples[k].target);
            if are_told { now.is_some() != next.is_some() } else { now != next }
        };
        if !(is_last || samples[index].ends || changes()) {
            continue;
        }
        if let Some((target, width)) = samples[index].target {
            let own = begin..=index;
            let told = own.clone().rev().find(|&k| samples[k].enters);
            let hit = told.or_else(|| Some(begin + last_entry(&samples[own.clone()], target, width)?));
            let miss = || begin + last_entry(&samples[own], samples[index].point, width).unwrap_or_default();
            all.push(Selection {
                target,
                width,
                samples: [begin, index],
                outcome: match hit {
                    _ if samples[index].gives_up => Outcome::GivenUp,
                    Some(_) => Outcome::Hit,
                    None => Outcome::Miss,
                },
                entry: hit.unwrap_or_else(miss),
            });
        }
        begin = index + 1;
    }
    all
}

/// The sample in which the hand came into a target to stay there; none where it is not there in the end.
fn last_entry(samples: &[Sample], target: Point, width: f64) -> Option<usize> {
    let is_inside = |sample: &Sample| apart(sample.point, target) <= 0.5 * width;
    is_inside(samples.last()?).then(|| samples.iter().rposition(|sample| !is_inside(sample)).map_or(0, |k| k + 1))
}

/// How far two places are from each other (m).
fn apart(a: Point, b: Point) -> f64 {
    [0, 1, 2].map(|k| (a[k] - b[k]).powi(2)).iter().sum::<f64>().sqrt()
}
