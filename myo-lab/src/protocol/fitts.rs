//! Protocol F1: how long a user takes to select targets of many distances and widths.

use myo_measure::MeasureError;
use myo_measure::bands::{Figure, Figures};
use myo_measure::fitts::{Condition, ConditionFigures, Users, index_of_difficulty};
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
    /// The law; none where a user has not learnt a condition.
    pub fitts: Option<FittsFit>,
    /// Which condition that is, if there is one, and what would help.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unlearnt: Option<String>,
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
    /// Mean movement time (s) without dwell, median over the users who have learnt it; none where nobody has.
    pub movement_time_s: Option<f64>,
    /// Its interval over users.
    pub movement_time_s_interval: Option<[f64; 2]>,
    /// Share of selections that were not made in time.
    pub missed: f64,
}

impl FittsCondition {
    /// Of the users who have learnt it.
    fn of([distance_m, width_m]: [f64; 2], learnt: &[Condition], missed: f64) -> Result<Self, ProtocolError> {
        let time = |condition: &Condition| Ok(ConditionFigures::of(condition)?.movement_time_s);
        let times: Result<Vec<f64>, MeasureError> = learnt.iter().map(time).collect();
        let times = times.map_err(ProtocolError::measuring("movement times"))?;
        let time = if times.is_empty() { None } else { Some(OverUsers::of(&times, "movement times")?) };
        Ok(Self {
            distance_m,
            width_m,
            id_bit: index_of_difficulty(distance_m, width_m),
            movement_time_s: time.map(|time| time.median),
            movement_time_s_interval: time.and_then(|time| time.interval),
            missed,
        })
    }
}

impl FittsFit {
    /// The line that is drawn.
    fn line(&self) -> PlotSeries {
        let Self { intercept_s, slope_s_per_bit, r2, .. } = self;
        let name = format!("{:.0} ms + {:.0} ms/bit, R2 {r2:.2}", 1e3 * intercept_s, 1e3 * slope_s_per_bit);
        let line = [1.0, 5.0].map(|index| [index, intercept_s + slope_s_per_bit * index]);
        PlotSeries { name, points: vec![], line: line.to_vec() }
    }

    /// Of users who have learnt every condition.
    fn of(users: &[UserReaches]) -> Result<Self, ProtocolError> {
        let of_user =
            |user: &UserReaches| (0..conditions().len()).map(|condition| user.of_condition(condition)).collect();
        let asked = users.iter().map(of_user).collect::<Result<Vec<Vec<Condition>>, _>>()?;
        let found = Users::of(&asked).map_err(ProtocolError::measuring("Fitts' law"))?;
        let [r2, slope, intercept, throughput] =
            [found.r2, found.slope, found.intercept, found.throughput].map(OverUsers::from);
        Ok(Self {
            r2: r2.median,
            r2_interval: r2.interval,
            slope_s_per_bit: slope.median,
            slope_s_per_bit_interval: slope.interval,
            intercept_s: intercept.median,
            intercept_s_interval: intercept.interval,
            throughput_bit_s: throughput.median,
            throughput_bit_s_interval: throughput.interval,
            distinct_indices: found.users[0].distinct_indices(1.5, 5.0),
        })
    }
}

impl FittsLaw {
    /// Of one user or more. There is no law where a user has not learnt a condition: [`unlearnt`](Self::unlearnt) says which.
    ///
    /// # Errors
    /// Nobody has learnt anything, or there is no fit.
    pub fn of(users: &[UserReaches]) -> Result<Self, ProtocolError> {
        let all = conditions();
        let learnt = |index: usize| users.iter().map(move |user| user.of_condition(index));
        let conditions = (0..all.len())
            .map(|index| {
                let missed = users.iter().map(|user| user.missed(index)).sum::<f64>() / users.len() as f64;
                FittsCondition::of(all[index], &learnt(index).filter_map(Result::ok).collect::<Vec<_>>(), missed)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let unlearnt = (0..all.len()).flat_map(learnt).find_map(Result::err);
        let found_any = conditions.iter().any(|condition| condition.movement_time_s.is_some());
        let (fitts, unlearnt) = match unlearnt {
            None => (Some(FittsFit::of(users)?), None),
            Some(error) if found_any => (None, Some(error.to_string())),
            Some(error) => return Err(error),
        };
        Ok(Self { users: users.len(), conditions, fitts, unlearnt })
    }

    /// Movement times over indices of difficulty, and the line through them.
    pub fn plot(&self) -> Plot {
        let point = |condition: &FittsCondition| {
            let at = [condition.id_bit, condition.movement_time_s?];
            Some(PlotPoint { at, interval: condition.movement_time_s_interval })
        };
        let points = self.conditions.iter().filter_map(point).collect();
        let means = PlotSeries { name: "means of conditions".into(), points, line: vec![] };
        Plot {
            title: if self.fitts.is_some() { "Fitts' law" } else { "No law yet: times of what was learnt" }.into(),
            axes: ["index of difficulty, bit".into(), "movement time, s".into()],
            series: std::iter::once(means).chain(self.fitts.as_ref().map(FittsFit::line)).collect(),
        }
    }

    /// What of it people's bands are about.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let usual = |c: &&FittsCondition| [c.distance_m, c.width_m] == [USUAL_DISTANCE, USUAL_WIDTH];
        let time = self.conditions.iter().find(usual).and_then(|condition| condition.movement_time_s);
        let fit = self.fitts.iter().flat_map(|fit| {
            [
                (Figure::DistinctIndices, fit.distinct_indices as f64),
                (Figure::FitR2, fit.r2),
                (Figure::FitSlope, fit.slope_s_per_bit),
                (Figure::Throughput, fit.throughput_bit_s),
            ]
        });
        set_all(figures, fit.chain(time.map(|time| (Figure::MovementTime30, time))))
    }
}
