//! Protocols F1, K1 and K2: how fast, how smoothly and how precisely a user points.

use myo_measure::bands::{Figure, Figures};
use myo_measure::fitts::{Condition, Users, index_of_difficulty};
use myo_measure::{EndpointCloud, Movement, Spread, statistics};
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::practice::{SELECTIONS, conditions};
use super::reach::Reach;

/// Least share of selections of a condition that must be made.
const LEAST_SHARE: f64 = 0.5;
/// Indices of difficulty (bit) of movements that count as easy, below, and as hard, between.
const EASY: f64 = 2.5;
const HARD: [f64; 2] = [3.0, 5.0];
/// The distance (m) at which speeds are told.
const USUAL_DISTANCE: f64 = 0.3;
/// The width (m) at which the time for it is told.
const USUAL_WIDTH: f64 = 0.05;
/// The width (m) of targets so small that stops scatter freely.
const SMALL: f64 = 0.015;

/// A figure of several users.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OverUsers {
    /// The middle one.
    pub median: f64,
    /// 95 % confidence interval of the mean; null with one user.
    pub interval: Option<[f64; 2]>,
}

impl From<Spread> for OverUsers {
    fn from(spread: Spread) -> Self {
        Self { median: spread.median, interval: spread.interval }
    }
}

impl OverUsers {
    fn of(values: &[f64], what: &str) -> Result<Self, ProtocolError> {
        Ok(Spread::of(values).map_err(ProtocolError::measuring(what))?.into())
    }
}

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

/// Reaches of one user, for so many episodes of each condition.
pub struct UserReaches {
    /// All of them.
    pub reaches: Vec<Reach>,
    /// Episodes of each condition.
    pub repeats: usize,
}

impl UserReaches {
    /// Those from target to target.
    fn between(&self) -> impl Iterator<Item = &Reach> {
        self.reaches.iter().filter(|reach| reach.selection > 0)
    }

    fn of_condition(&self, condition: usize) -> Result<Condition, ProtocolError> {
        let [distance, width] = conditions()[condition];
        let trials: Vec<_> =
            self.between().filter(|reach| reach.condition == condition).map(|reach| reach.trial).collect();
        // A fingertip that was there already did not move.
        let trials: Vec<_> = trials.into_iter().filter(|trial| trial.movement_time_s > 0.0).collect();
        let asked = self.repeats * (SELECTIONS - 1);
        let least = (LEAST_SHARE * asked as f64).ceil() as usize;
        if trials.len() < least {
            let what = format!("targets of {:.0} mm at {:.0} mm", 1e3 * width, 1e3 * distance);
            return Err(ProtocolError::TooFew { what, found: trials.len(), asked, least });
        }
        Ok(Condition { distance, width, trials })
    }

    fn missed(&self, condition: usize) -> f64 {
        let made = self.between().filter(|reach| reach.condition == condition).count();
        1.0 - made as f64 / (self.repeats * (SELECTIONS - 1)) as f64
    }

    /// Distance, width and movement of each reach from target to target.
    fn movements(&self) -> impl Iterator<Item = ([f64; 2], &Movement)> {
        self.between().filter_map(|reach| Some((conditions()[reach.condition], reach.movement.as_ref()?)))
    }
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

/// Sets figures.
pub(super) fn set_all(
    figures: &mut Figures,
    values: impl IntoIterator<Item = (Figure, f64)>,
) -> Result<(), ProtocolError> {
    for (figure, value) in values {
        figures.set(figure, value).map_err(ProtocolError::measuring(format!("{figure:?}")))?;
    }
    Ok(())
}

/// A figure of movements, and over users.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KinematicRow {
    /// What it is, a stable key.
    pub key: &'static str,
    /// What it is, for people.
    pub what: &'static str,
    /// Its unit; empty for shares and counts.
    pub unit: &'static str,
    /// The median over users.
    pub median: f64,
    /// 95 % confidence interval of the mean over users.
    pub interval: Option<[f64; 2]>,
    #[serde(skip)]
    figure: Figure,
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

/// Means of profiles, place by place.
fn mean_profile<'a>(profiles: impl Iterator<Item = &'a Vec<f64>>) -> Vec<f64> {
    let (mut sum, mut count) = (vec![], 0.0);
    for profile in profiles.filter(|profile| !profile.is_empty()) {
        sum.resize(profile.len(), 0.0);
        sum.iter_mut().zip(profile).for_each(|(sum, speed)| *sum += speed);
        count += 1.0;
    }
    sum.iter().map(|sum| sum / count).collect()
}

fn profile_of(users: &[UserReaches], condition: usize) -> Vec<f64> {
    let reaches = users.iter().flat_map(UserReaches::between).filter(|reach| reach.condition == condition);
    mean_profile(reaches.map(|reach| &reach.profile))
}

type OfUser = fn(&UserReaches) -> Result<f64, ProtocolError>;

/// What is told of movements.
const KINEMATICS: [(Figure, &str, &str, &str, OfUser); 12] = [
    (Figure::PeakSpeed30, "peak_speed_30_m_s", "peak speed over 30 cm", "m/s", |user| {
        median(user.movements().filter(|(pair, _)| pair[0] == USUAL_DISTANCE), |movement| movement.peak_speed)
    }),
    (Figure::PeakOverMean, "peak_over_mean", "peak over mean speed", "", |user| {
        median(user.movements(), |movement| movement.peak_over_mean)
    }),
    (Figure::TimeOfPeak, "time_of_peak", "time of the peak, share of the duration", "", |user| {
        median(user.movements(), |movement| movement.time_of_peak)
    }),
    (Figure::TimeOfPeakPerBit, "time_of_peak_per_bit", "change of that per bit, by width", "", time_of_peak_per_bit),
    (Figure::SpeedMaximaEasy, "speed_maxima_easy", "speed maxima below 2.5 bits", "", |user| {
        median(user.movements().filter(|(pair, _)| index(*pair) < EASY), |movement| movement.speed_maxima as f64)
    }),
    (Figure::SpeedMaximaHard, "speed_maxima_hard", "speed maxima from 3 to 5 bits", "", |user| {
        let hard = user.movements().filter(|(pair, _)| (HARD[0]..=HARD[1]).contains(&index(*pair)));
        median(hard, |movement| movement.speed_maxima as f64)
    }),
    (Figure::SpeedMaximaPerBit, "speed_maxima_per_bit", "change of their mean per bit", "", |user| {
        slope(user.movements().map(|(pair, movement)| (index(pair), movement.speed_maxima as f64)))
    }),
    (Figure::Sparc, "sparc", "smoothness, SPARC", "", |user| median(user.movements(), |movement| movement.sparc)),
    (Figure::Ldlj, "ldlj", "smoothness, LDLJ", "", |user| median(user.movements(), |movement| movement.ldlj)),
    (Figure::PathOverChord, "path_over_chord", "path over chord", "", |user| {
        median(user.movements(), |movement| movement.path_over_chord.unwrap_or(f64::NAN))
    }),
    (Figure::PathOverChordFromHanging, "path_over_chord_from_hanging", "the same from the hanging arm", "", |user| {
        let first = user.reaches.iter().filter(|reach| reach.selection == 0);
        let first = first.filter_map(|reach| Some(([0.0; 2], reach.movement.as_ref()?)));
        median(first, |movement| movement.path_over_chord.unwrap_or(f64::NAN))
    }),
    // Not a band of its own; tells how far MT of Fitts' law and the movement itself agree.
    (Figure::MovementTime30, "duration_30_s", "duration of movements over 30 cm to 5 cm", "s", |user| {
        let usual = user.movements().filter(|(pair, _)| *pair == [USUAL_DISTANCE, USUAL_WIDTH]);
        median(usual, |movement| movement.duration_s)
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

fn slope(points: impl Iterator<Item = (f64, f64)>) -> Result<f64, ProtocolError> {
    let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
    statistics::slope(&x, &y).map_err(ProtocolError::measuring("a change per bit"))
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
        let row = |(figure, key, what, unit, of_user): (Figure, &'static str, &'static str, &'static str, OfUser)| {
            let values = users.iter().map(of_user).collect::<Result<Vec<_>, _>>()?;
            let OverUsers { median, interval } = OverUsers::of(&values, what)?;
            Ok(KinematicRow { key, what, unit, median, interval, figure })
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
        let judged = self.rows.iter().filter(|row| row.figure != Figure::MovementTime30);
        set_all(figures, judged.map(|row| (row.figure, row.median)))
    }
}

/// Protocol K2: where movements end that were aimed at targets of 15 mm, before they are corrected.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scatter {
    /// How many users.
    pub users: usize,
    /// By distance.
    pub rows: Vec<ScatterRow>,
    /// Standard deviation along the movement over that across; median over users, as all that follow.
    pub elongation: f64,
    /// Change of the standard deviation along the movement per metre of distance.
    pub growth_along: f64,
    /// Standard deviation across the movement as seen from its start (degrees).
    pub direction_deg: f64,
}

/// Movements over one distance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScatterRow {
    /// Distance (m).
    pub distance_m: f64,
    /// Standard deviation along the movement (m): median over directions and users.
    pub sd_along_m: f64,
    /// The same across it.
    pub sd_across_m: f64,
    /// How far beyond the target they end, along the movement (m).
    pub overshoot_m: f64,
}

impl Scatter {
    /// Of one user or more.
    ///
    /// # Errors
    /// Too few movements in a direction.
    pub fn of(users: &[UserReaches]) -> Result<Self, ProtocolError> {
        let all = conditions();
        let small: Vec<usize> = (0..all.len()).filter(|&condition| all[condition][1] == SMALL).collect();
        let clouds = users
            .iter()
            .map(|user| small.iter().map(|&condition| clouds(user, condition)).collect::<Result<Vec<_>, _>>())
            .collect::<Result<Vec<_>, _>>()?;
        let of_all = |of: fn(&EndpointCloud) -> f64, place: Option<usize>| {
            let user = |user: &Vec<Vec<EndpointCloud>>| {
                let chosen = user.iter().enumerate().filter(|(at, _)| place.is_none_or(|place| place == *at));
                middle(&chosen.flat_map(|(_, clouds)| clouds).map(of).collect::<Vec<_>>())
            };
            middle(&clouds.iter().map(user).collect::<Result<Vec<_>, _>>()?)
        };
        let row = |(place, &condition): (usize, &usize)| {
            Ok(ScatterRow {
                distance_m: all[condition][0],
                sd_along_m: of_all(|cloud| cloud.sd_along, Some(place))?,
                sd_across_m: of_all(|cloud| cloud.sd_across, Some(place))?,
                overshoot_m: of_all(|cloud| cloud.overshoot, Some(place))?,
            })
        };
        let rows = small.iter().enumerate().map(row).collect::<Result<Vec<_>, ProtocolError>>()?;
        Ok(Self {
            users: users.len(),
            elongation: of_all(|cloud| cloud.sd_along / cloud.sd_across, None)?,
            growth_along: slope(rows.iter().map(|row| (row.distance_m, row.sd_along_m)))?,
            direction_deg: of_all(|cloud| cloud.direction_sd_deg, None)?,
            rows,
        })
    }

    /// Scatter over distance.
    pub fn plot(&self) -> Plot {
        let series = |name: &str, of: fn(&ScatterRow) -> f64| {
            let at = |row: &ScatterRow| [100.0 * row.distance_m, 1e3 * of(row)];
            let points = self.rows.iter().map(|row| PlotPoint { at: at(row), interval: None });
            PlotSeries { name: name.into(), points: points.collect(), line: self.rows.iter().map(at).collect() }
        };
        Plot {
            title: "End points before any correction".into(),
            axes: ["distance, cm".into(), "standard deviation, mm".into()],
            series: vec![
                series("along the movement", |row| row.sd_along_m),
                series("across it", |row| row.sd_across_m),
            ],
        }
    }

    /// What of it people's bands are about.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let all = [
            (Figure::EndpointElongation, self.elongation),
            (Figure::EndpointGrowth, self.growth_along),
            (Figure::EndpointDirectionDeg, self.direction_deg),
        ];
        set_all(figures, all)
    }
}

fn middle(values: &[f64]) -> Result<f64, ProtocolError> {
    statistics::median(values).map_err(ProtocolError::measuring("end points"))
}

/// The cloud of each direction of a condition.
fn clouds(user: &UserReaches, condition: usize) -> Result<Vec<EndpointCloud>, ProtocolError> {
    let cloud = |selection: usize| {
        let same = user.between().filter(|reach| (reach.condition, reach.selection) == (condition, selection));
        let (mut stops, mut trials) = (vec![], vec![]);
        for reach in same {
            stops.extend(reach.first_stop);
            trials.push(reach.trial);
        }
        let distance = conditions()[condition][0];
        let targets = super::practice::circle_targets(distance);
        EndpointCloud::of(&stops, targets[selection - 1], targets[selection])
            .map_err(ProtocolError::measuring(format!("end points over {:.0} mm", 1e3 * distance)))
    };
    (1..SELECTIONS).map(cloud).collect()
}
