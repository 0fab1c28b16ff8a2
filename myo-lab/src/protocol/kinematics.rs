//! Protocol K1: speeds, shapes and smoothness of movements.

use myo_measure::bands::{Figure, Figures};
use myo_measure::fitts::index_of_difficulty;
use myo_measure::{Movement, statistics};
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotSeries};
use super::pointing::{OverUsers, USUAL_DISTANCE, UserReaches, set_all, slope};
use super::practice::conditions;
use super::reach::mean_profile;

/// Indices of difficulty (bit) of movements that count as easy, below, and as hard, between.
const EASY: f64 = 2.5;
const HARD: [f64; 2] = [3.0, 5.0];

/// A figure of movements, and over users.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KinematicRow {
    /// What it is.
    pub figure: Figure,
    /// What it is, for people.
    pub what: &'static str,
    /// Its unit; empty for shares and counts.
    pub unit: &'static str,
    /// The median over users.
    pub median: f64,
    /// 95 % confidence interval of the mean over users.
    pub interval: Option<[f64; 2]>,
}

/// Protocol K1: speeds, shapes and smoothness of movements.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Kinematics {
    /// How many users.
    pub users: usize,
    /// Movements of all of them from target to target.
    pub movements: usize,
    /// What they are like.
    pub rows: Vec<KinematicRow>,
    /// Mean speed over 30 cm, by the width of the target.
    pub profiles: Vec<SpeedProfile>,
}

/// Mean speed of movements of all users over 30 cm to a target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpeedProfile {
    /// Diameter of the target (m).
    pub width_m: f64,
    /// Speed (m/s) at even shares of the duration, from its beginning to its end.
    pub speed_m_s: Vec<f64>,
}

fn profile_of(users: &[UserReaches], condition: usize) -> Vec<f64> {
    let reaches = users.iter().flat_map(UserReaches::between).filter(|reach| reach.condition == condition);
    mean_profile(reaches.map(|reach| &reach.profile))
}

type OfUser = fn(&UserReaches) -> Result<f64, ProtocolError>;

/// What is told of movements.
const KINEMATICS: [(Figure, &str, &str, OfUser); 11] = [
    (Figure::PeakSpeed30, "peak speed over 30 cm", "m/s", |user| {
        median(user.movements().filter(|(pair, _)| pair[0] == USUAL_DISTANCE), |movement| movement.peak_speed)
    }),
    (Figure::PeakOverMean, "peak over mean speed", "", |user| {
        median(user.movements(), |movement| movement.peak_over_mean)
    }),
    (Figure::TimeOfPeak, "time of the peak, share of the duration", "", |user| {
        median(user.movements(), |movement| movement.time_of_peak)
    }),
    (Figure::TimeOfPeakPerBit, "change of that per bit, by width", "", time_of_peak_per_bit),
    (Figure::SpeedMaximaEasy, "speed maxima below 2.5 bits", "", |user| {
        median(user.movements().filter(|(pair, _)| index(*pair) < EASY), |movement| movement.speed_maxima as f64)
    }),
    (Figure::SpeedMaximaHard, "speed maxima from 3 to 5 bits", "", |user| {
        let hard = user.movements().filter(|(pair, _)| (HARD[0]..=HARD[1]).contains(&index(*pair)));
        median(hard, |movement| movement.speed_maxima as f64)
    }),
    (Figure::SpeedMaximaPerBit, "change of their mean per bit", "", |user| {
        slope(user.movements().map(|(pair, movement)| (index(pair), movement.speed_maxima as f64)))
    }),
    (Figure::Sparc, "smoothness, SPARC", "", |user| median(user.movements(), |movement| movement.sparc)),
    (Figure::Ldlj, "smoothness, LDLJ", "", |user| median(user.movements(), |movement| movement.ldlj)),
    (Figure::PathOverChord, "path over chord", "", |user| {
        median(user.movements(), |movement| movement.path_over_chord.unwrap_or(f64::NAN))
    }),
    (Figure::PathOverChordFromHanging, "the same from the hanging arm", "", |user| {
        let first = user.reaches.iter().filter(|reach| reach.selection == 0);
        let first = first.filter_map(|reach| Some(([0.0; 2], reach.movement.as_ref()?)));
        median(first, |movement| movement.path_over_chord.unwrap_or(f64::NAN))
    }),
];

fn index([distance, width]: [f64; 2]) -> f64 {
    index_of_difficulty(distance, width)
}

fn median<'a>(
    movements: impl Iterator<Item = ([f64; 2], &'a Movement)>,
    of: fn(&Movement) -> f64,
) -> Result<f64, ProtocolError> {
    let values: Vec<f64> = movements.map(|(_, movement)| of(movement)).filter(|value| value.is_finite()).collect();
    statistics::median(&values).map_err(ProtocolError::measuring("movements"))
}

/// The mean over distances: difficulty by smaller widths alone.
fn time_of_peak_per_bit(user: &UserReaches) -> Result<f64, ProtocolError> {
    let mut distances: Vec<f64> = conditions().iter().map(|pair| pair[0]).collect();
    distances.dedup();
    let of_distance = |distance: &f64| {
        let movements = user.movements().filter(|(pair, _)| pair[0] == *distance);
        slope(movements.map(|(pair, movement)| (index(pair), movement.time_of_peak)))
    };
    let slopes = distances.iter().map(of_distance).collect::<Result<Vec<_>, _>>()?;
    Ok(slopes.iter().sum::<f64>() / slopes.len() as f64)
}

impl Kinematics {
    /// Of one user or more.
    ///
    /// # Errors
    /// Users who do not move.
    pub fn of(users: &[UserReaches]) -> Result<Self, ProtocolError> {
        let row = |(figure, what, unit, of_user): (Figure, &'static str, &'static str, OfUser)| {
            let values = users.iter().map(of_user).collect::<Result<Vec<_>, _>>()?;
            let OverUsers { median, interval } = OverUsers::of(&values, what)?;
            Ok(KinematicRow { figure, what, unit, median, interval })
        };
        Ok(Self {
            users: users.len(),
            movements: users.iter().map(|user| user.movements().count()).sum(),
            rows: KINEMATICS.into_iter().map(row).collect::<Result<_, ProtocolError>>()?,
            profiles: conditions()
                .iter()
                .enumerate()
                .filter(|(_, pair)| pair[0] == USUAL_DISTANCE)
                .map(|(condition, pair)| SpeedProfile { width_m: pair[1], speed_m_s: profile_of(users, condition) })
                .collect(),
        })
    }

    /// Mean speeds over 30 cm.
    pub fn plot(&self) -> Plot {
        let series = |profile: &SpeedProfile| {
            let last = profile.speed_m_s.len().max(2) - 1;
            let at = |(place, &speed): (usize, &f64)| [place as f64 / last as f64, speed];
            PlotSeries {
                name: format!("target of {:.0} mm", 1e3 * profile.width_m),
                points: vec![],
                line: profile.speed_m_s.iter().enumerate().map(at).collect(),
            }
        };
        Plot {
            title: "Mean speed over 30 cm".into(),
            axes: ["share of the duration".into(), "speed, m/s".into()],
            series: self.profiles.iter().map(series).collect(),
        }
    }

    /// What of it people's bands are about.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        set_all(figures, self.rows.iter().map(|row| (row.figure, row.median)))
    }
}
