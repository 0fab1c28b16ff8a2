//! Protocol F1: how long a user takes to select targets of many distances and widths.

use myo_measure::bands::{Figure, Figures};
use myo_measure::fitts::{Users, index_of_difficulty};
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::{OverUsers, USUAL_DISTANCE, UserReaches, set_all};
use super::practice::conditions;

/// The width (m) of the target at the usual distance whose time is told.
const USUAL_WIDTH: f64 = 0.05;

/// Protocol F1: Fitts' law, of users who selected targets across a circle (ISO 9241-411).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittsLaw {
    /// How many users.
    pub users: usize,
    /// Each pair of distance and width.
    pub conditions: Vec<FittsCondition>,
    /// The law.
    pub fitts: FittsFit,
}

/// The law through means of conditions, user by user.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittsFit {
    /// Share of the variance of the means that it explains.
    pub r2: f64,
    /// 95 % confidence interval of the mean over users, as all that follow.
    pub r2_interval: Option<[f64; 2]>,
    /// Slope (s/bit).
    pub slope_s_per_bit: f64,
    /// Its interval.
    pub slope_s_per_bit_interval: Option<[f64; 2]>,
    /// Intercept (s).
    pub intercept_s: f64,
    /// Its interval.
    pub intercept_s_interval: Option<[f64; 2]>,
    /// Effective throughput (bit/s) of ISO 9241-411, dwell not counted.
    pub throughput_bit_s: f64,
    /// Its interval.
    pub throughput_bit_s_interval: Option<[f64; 2]>,
    /// Different indices of difficulty that it stands on.
    pub distinct_indices: usize,
}

/// A pair of distance and width.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittsCondition {
    /// From target to target (m).
    pub distance_m: f64,
    /// Diameter of the target (m).
    pub width_m: f64,
    /// Index of difficulty (bit), Shannon's.
    pub id_bit: f64,
    /// Mean movement time (s) without dwell, median over users.
    pub movement_time_s: f64,
    /// Its interval over users.
    pub movement_time_s_interval: Option<[f64; 2]>,
    /// Share of selections that were not made in time.
    pub missed: f64,
}

impl FittsLaw {
    /// Of one user or more.
    ///
    /// # Errors
    /// A user who selects fewer than half of the targets of a condition, or no fit.
    pub fn of(users: &[UserReaches]) -> Result<Self, ProtocolError> {
        let all = conditions();
        let asked = users
            .iter()
            .map(|user| (0..all.len()).map(|condition| user.of_condition(condition)).collect::<Result<Vec<_>, _>>())
            .collect::<Result<Vec<_>, _>>()?;
        let found = Users::of(&asked).map_err(ProtocolError::measuring("Fitts' law"))?;
        let condition = |index: usize| {
            let [distance_m, width_m] = all[index];
            let times: Vec<f64> = found.users.iter().map(|user| user.conditions[index].movement_time_s).collect();
            let time = OverUsers::of(&times, "movement times")?;
            let missed = users.iter().map(|user| user.missed(index)).sum::<f64>() / users.len() as f64;
            Ok(FittsCondition {
                distance_m,
                width_m,
                id_bit: index_of_difficulty(distance_m, width_m),
                movement_time_s: time.median,
                movement_time_s_interval: time.interval,
                missed,
            })
        };
        let [r2, slope, intercept, throughput] =
            [found.r2, found.slope, found.intercept, found.throughput].map(OverUsers::from);
        Ok(Self {
            users: users.len(),
            conditions: (0..all.len()).map(condition).collect::<Result<_, ProtocolError>>()?,
            fitts: FittsFit {
                r2: r2.median,
                r2_interval: r2.interval,
                slope_s_per_bit: slope.median,
                slope_s_per_bit_interval: slope.interval,
                intercept_s: intercept.median,
                intercept_s_interval: intercept.interval,
                throughput_bit_s: throughput.median,
                throughput_bit_s_interval: throughput.interval,
                distinct_indices: found.users[0].distinct_indices(1.5, 5.0),
            },
        })
    }

    /// Movement times over indices of difficulty, and the line through them.
    pub fn plot(&self) -> Plot {
        let points = self.conditions.iter().map(|condition| PlotPoint {
            at: [condition.id_bit, condition.movement_time_s],
            interval: condition.movement_time_s_interval,
        });
        let fit = &self.fitts;
        let line = [1.0, 5.0].map(|index| [index, fit.intercept_s + fit.slope_s_per_bit * index]);
        let name =
            format!("{:.0} ms + {:.0} ms/bit, R2 {:.2}", 1e3 * fit.intercept_s, 1e3 * fit.slope_s_per_bit, fit.r2);
        Plot {
            title: "Fitts' law".into(),
            axes: ["index of difficulty, bit".into(), "movement time, s".into()],
            series: vec![
                PlotSeries { name: "means of conditions".into(), points: points.collect(), line: vec![] },
                PlotSeries { name, points: vec![], line: line.to_vec() },
            ],
        }
    }

    /// What of it people's bands are about.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let usual = |c: &&FittsCondition| [c.distance_m, c.width_m] == [USUAL_DISTANCE, USUAL_WIDTH];
        let time =
            self.conditions.iter().find(usual).map(|condition| (Figure::MovementTime30, condition.movement_time_s));
        let fit = &self.fitts;
        let all = [
            (Figure::DistinctIndices, fit.distinct_indices as f64),
            (Figure::FitR2, fit.r2),
            (Figure::FitSlope, fit.slope_s_per_bit),
            (Figure::Throughput, fit.throughput_bit_s),
        ];
        set_all(figures, all.into_iter().chain(time))
    }
}
