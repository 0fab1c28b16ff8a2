//! Protocol C1: how much longer it takes to react where there are more to choose from.

use myo_measure::Line;
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::OverUsers;
use super::practice::{CHOICES, REACTIONS};
use super::recording::Recording;

/// Least share of the reactions that must be made.
const LEAST_SHARE: f64 = 0.5;

/// One of two, four or eight spheres about the hand lights up, all as far away, and the hand goes there: response times over the bits of the choice, `log2(n + 1)`
/// (Hick 1952, doi 10.1080/17470215208416600).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChoiceReaction {
    /// How many users.
    pub users: usize,
    /// Each number of spheres.
    pub rows: Vec<ChoiceRow>,
    /// Slope of the response time (s/bit), user by user.
    pub slope_s_per_bit: OverUsers,
    /// Its intercept (s).
    pub intercept_s: OverUsers,
}

/// A number of spheres to choose from: means over reactions, over users.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChoiceRow {
    /// How many.
    pub choices: usize,
    /// Bits of the choice.
    pub bits: f64,
    /// From where the sphere lights up to where the fingertip comes to it to stay (s).
    pub response_s: OverUsers,
    /// Share of the reactions that were not made in time.
    pub missed: f64,
}

impl ChoiceReaction {
    /// Of one user or more, each with its recordings of all numbers of choices, in their order.
    ///
    /// # Errors
    /// A user made fewer than half of the reactions to one of them.
    pub fn of(users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let of_user = |user: &Vec<Vec<Recording>>| {
            let reactions = CHOICES.iter().zip(user).map(|(&choices, recordings)| Reactions::of(choices, recordings));
            reactions.collect::<Result<Vec<_>, _>>()
        };
        let all = users.iter().map(of_user).collect::<Result<Vec<_>, _>>()?;
        let rows = CHOICES.iter().enumerate().map(|(number, &choices)| {
            let over = |of: fn(&Reactions) -> f64| over(all.iter().map(|user| of(&user[number])));
            let (response_s, missed) = (over(|own| own.response_s)?, over(|own| own.missed)?.median);
            Ok(ChoiceRow { choices, bits: bits(choices), response_s, missed })
        });
        let rows = rows.collect::<Result<Vec<_>, ProtocolError>>()?;
        let x = CHOICES.map(bits);
        let line = |user: &Vec<Reactions>| {
            let y: Vec<f64> = user.iter().map(|own| own.response_s).collect();
            Line::through(&x, &y).map_err(ProtocolError::measuring("reactions"))
        };
        let lines = all.iter().map(line).collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            users: users.len(),
            rows,
            slope_s_per_bit: over(lines.iter().map(|line| line.slope))?,
            intercept_s: over(lines.iter().map(|line| line.intercept))?,
        })
    }

    /// Response times over bits.
    pub fn plot(&self) -> Plot {
        let point =
            |row: &ChoiceRow| PlotPoint { at: [row.bits, row.response_s.median], interval: row.response_s.interval };
        let ends = [bits(CHOICES[0]), bits(CHOICES[CHOICES.len() - 1])];
        let line = ends.map(|bits| [bits, self.intercept_s.median + self.slope_s_per_bit.median * bits]);
        Plot {
            title: "Choice reaction".into(),
            axes: ["log2(choices + 1), bit".into(), "response time, s".into()],
            series: vec![PlotSeries {
                name: String::new(),
                points: self.rows.iter().map(point).collect(),
                line: line.to_vec(),
            }],
        }
    }
}

fn over(values: impl Iterator<Item = f64>) -> Result<OverUsers, ProtocolError> {
    OverUsers::of(&values.collect::<Vec<_>>(), "reactions")
}

fn bits(choices: usize) -> f64 {
    ((choices + 1) as f64).log2()
}

/// What one user did where there were so many to choose from.
struct Reactions {
    response_s: f64,
    missed: f64,
}

impl Reactions {
    fn of(choices: usize, recordings: &[Recording]) -> Result<Self, ProtocolError> {
        // Every second step is to come back to the middle.
        let seconds = |recording: &Recording| {
            let rate_hz = recording.rate_hz;
            let reactions = recording.done.iter().skip(1).step_by(2);
            reactions.map(|done| (done.entry - done.begin) as f64 / rate_hz).collect::<Vec<_>>()
        };
        let times: Vec<f64> = recordings.iter().flat_map(seconds).collect();
        let (found, asked) = (times.len(), REACTIONS * recordings.len());
        let least = ((LEAST_SHARE * asked as f64).ceil() as usize).max(1);
        if found < least {
            let what = format!("reactions to one of {choices}");
            return Err(ProtocolError::TooFew { what, found, asked, least });
        }
        let missed = 1.0 - found as f64 / asked as f64;
        Ok(Self { response_s: times.iter().sum::<f64>() / found as f64, missed })
    }
}
