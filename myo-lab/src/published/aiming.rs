//! How users aim at targets of some widths: times, and the shape of their movements.

use myo_measure::fitts::{Condition, Pointing, index_of_difficulty};
use myo_measure::{MeasureError, statistics};
use myo_tasks::{Item, Range, Task};
use serde::{Deserialize, Serialize};

use super::PublishedError;
use crate::protocol::{Plot, PlotPoint, PlotSeries, mean_profile};
use crate::recordings::{FittsOfAimed, LEAST_OF_CONDITION, Measured, Participant, Recordings, SAME_WIDTH, measured};

/// How many widths a user is asked at, evenly from the smallest to the largest of its task.
const WIDTHS: usize = 6;
/// Groups of equally many movements that distances are divided into.
const DISTANCES: usize = 3;
/// How some people, or simulated users, aim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Aiming {
    /// Who they are.
    pub name: String,
    /// How many.
    pub users: usize,
    /// Their movements at targets.
    pub movements: usize,
    /// Targets that were not reached.
    pub missed: usize,
    /// Fitts' law through means of conditions, and effective throughput.
    pub fitts: FittsOfAimed,
    /// R2 of the same law through single movements, the median over users.
    pub r2_of_movements: f64,
    /// Means of conditions, over users.
    pub conditions: Vec<AimingCondition>,
    /// Movements by width, narrow to wide.
    pub widths: Vec<AimingWidth>,
}

/// A width and a group of distances.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AimingCondition {
    /// Width of the target (m).
    pub width_m: f64,
    /// Mean distance (m).
    pub distance_m: f64,
    /// Index of difficulty (bit, Shannon).
    pub id_bit: f64,
    /// Movement time (s): mean over users of their means.
    pub movement_time_s: f64,
}

/// Movements at targets of a width.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AimingWidth {
    /// Width of the targets (m).
    pub width_m: f64,
    /// How many movements.
    pub movements: usize,
    /// Median duration (s).
    pub duration_s: f64,
    /// Median peak speed (m/s).
    pub peak_speed_m_s: f64,
    /// Median time of the peak, as a share of the duration.
    pub time_of_peak: f64,
    /// Share of the way to the centre of the target that lies behind, straight on, at even shares of the duration: the mean.
    pub position: Vec<f64>,
    /// Velocity straight on (m/s) at even shares of the duration: the mean.
    pub velocity_m_s: Vec<f64>,
}

/// The task of a user at six widths from its smallest to its largest targets, layouts of one structure.
///
/// # Errors
/// Something else than resting spheres of one range of sizes is asked for.
pub fn at_widths(task: &Task) -> Result<Vec<Task>, PublishedError> {
    let other = || PublishedError::NotSpheres { task: task.name.clone() };
    let mut ranges = task.scene.0.values().map(|item| match item {
        Item::Sphere(sphere) if sphere.moves.is_none() => Some(sphere.radius),
        _ => None,
    });
    let range = ranges.next().flatten().ok_or_else(other)?;
    if range.min >= range.max || ranges.any(|radius| radius != Some(range)) {
        return Err(other());
    }
    let layout = |place: usize| {
        let radius = range.at(place as f64 / (WIDTHS - 1) as f64);
        let mut task = task.clone();
        for item in task.scene.0.values_mut() {
            if let Item::Sphere(sphere) = item {
                // As far from each other as among targets of all widths.
                sphere.min_distance_from_previous.get_or_insert(2.0 * range.max);
                sphere.radius = Range::fixed(radius);
            }
        }
        task.name = format!("{:.0} mm", 2e3 * radius);
        task
    };
    Ok((0..WIDTHS).map(layout).collect())
}

impl Aiming {
    /// Of people and simulated users alike, each of whom counts as much.
    ///
    /// # Errors
    /// Too few movements, or none that a law goes through.
    pub fn of(name: &str, recordings: &Recordings) -> Result<Self, PublishedError> {
        let people = recordings.participants.iter().map(measured).collect::<Result<Vec<_>, _>>()?;
        let missed = people.iter().map(|(_, missed)| missed).sum();
        let people: Vec<Vec<Measured>> = people.into_iter().map(|(movements, _)| movements).collect();
        for (movements, person) in people.iter().zip(&recordings.participants) {
            refuse_few(movements, person)?;
        }
        let groups = Groups::of(&people)?;
        let of_person = |movements: &Vec<Measured>| {
            Pointing::of(&groups.conditions(movements).into_iter().flatten().collect::<Vec<_>>())
        };
        let pointing = people.iter().map(of_person).collect::<Result<Vec<_>, _>>()?;
        let of_trials =
            pointing.iter().map(|person| Ok(person.fit_of_trials()?.r2)).collect::<Result<Vec<_>, MeasureError>>()?;
        Ok(Self {
            name: name.to_owned(),
            users: people.len(),
            movements: people.iter().map(Vec::len).sum(),
            missed,
            fitts: FittsOfAimed::of(&pointing)?,
            r2_of_movements: statistics::median(&of_trials)?,
            conditions: groups.means(&people),
            widths: groups.widths.iter().map(|&width| at_width(&people, width)).collect::<Result<_, _>>()?,
        })
    }

    /// Share of the way over the duration, by width.
    pub fn positions(&self) -> Plot {
        self.profiles(format!("{}: position", self.name), "share of the way to the centre", |width| &width.position)
    }

    /// Velocity straight on over the duration, by width.
    pub fn velocities(&self) -> Plot {
        self.profiles(format!("{}: velocity", self.name), "velocity along the way, m/s", |width| &width.velocity_m_s)
    }

    fn profiles(&self, title: String, up: &str, of: fn(&AimingWidth) -> &Vec<f64>) -> Plot {
        let series = |width: &AimingWidth| {
            let last = of(width).len().max(2) - 1;
            let at = |(place, &x): (usize, &f64)| [place as f64 / last as f64, x];
            PlotSeries {
                name: format!("targets of {:.0} mm", 1e3 * width.width_m),
                points: vec![],
                line: of(width).iter().enumerate().map(at).collect(),
            }
        };
        let axes = ["share of the duration".into(), up.into()];
        Plot { title, axes, series: self.widths.iter().map(series).collect() }
    }

    /// Means of conditions, and the line through them.
    pub(super) fn series(&self) -> Vec<PlotSeries> {
        let point = |one: &AimingCondition| PlotPoint { at: [one.id_bit, one.movement_time_s], interval: None };
        let [ids, times] = [|one: &AimingCondition| one.id_bit, |one: &AimingCondition| one.movement_time_s]
            .map(|of| self.conditions.iter().map(of).collect::<Vec<f64>>());
        let means =
            PlotSeries { name: self.name.clone(), points: self.conditions.iter().map(point).collect(), line: vec![] };
        let ends = [ids.iter().copied().reduce(f64::min), ids.iter().copied().reduce(f64::max)];
        // Of too few means there is none.
        let line = statistics::Line::through(&ids, &times).map(|law| PlotSeries {
            name: format!("{:.3} s + {:.3} s/bit, R² {:.2}", law.intercept, law.slope, law.r2),
            points: vec![],
            line: ends.into_iter().flatten().map(|id| [id, law.at(id)]).collect(),
        });
        std::iter::once(means).chain(line.ok()).collect()
    }
}

fn refuse_few(movements: &[Measured], person: &Participant) -> Result<(), PublishedError> {
    let least = LEAST_OF_CONDITION * DISTANCES;
    if movements.len() < least {
        return Err(PublishedError::TooFew { who: person.name.clone(), found: movements.len(), least });
    }
    Ok(())
}

/// What movements are sorted by.
struct Groups {
    /// Widths (m), narrow to wide.
    widths: Vec<f64>,
    /// Distances (m) between two groups.
    bounds: Vec<f64>,
}

impl Groups {
    fn of(people: &[Vec<Measured>]) -> Result<Self, PublishedError> {
        let all = || people.iter().flatten();
        let mut widths: Vec<f64> = all().map(|one| one.width).collect();
        widths.sort_by(f64::total_cmp);
        widths.dedup_by(|a, b| (*a - *b).abs() < SAME_WIDTH);
        let distances: Vec<f64> = all().map(|one| one.distance).collect();
        let bound = |group: usize| statistics::quantile(&distances, group as f64 / DISTANCES as f64);
        Ok(Self { widths, bounds: (1..DISTANCES).map(bound).collect::<Result<_, _>>()? })
    }

    /// The movements of each condition, place by place; none where there are too few.
    fn conditions(&self, movements: &[Measured]) -> Vec<Option<Condition>> {
        let group = |distance: f64| self.bounds.iter().filter(|bound| distance > **bound).count();
        let places = self.widths.len() * DISTANCES;
        let of_place = |place: usize| {
            let (width, wanted) = (self.widths[place / DISTANCES], place % DISTANCES);
            let mine = |one: &&Measured| (one.width - width).abs() < SAME_WIDTH && group(one.distance) == wanted;
            let all: Vec<&Measured> = movements.iter().filter(mine).collect();
            let distance = all.iter().map(|one| one.distance).sum::<f64>() / all.len() as f64;
            let trials = all.iter().map(|one| one.aimed.trial).collect();
            (all.len() >= LEAST_OF_CONDITION).then_some(Condition { distance, width, trials })
        };
        (0..places).map(of_place).collect()
    }

    /// Means of conditions over people.
    fn means(&self, people: &[Vec<Measured>]) -> Vec<AimingCondition> {
        let of_people: Vec<_> = people.iter().map(|movements| self.conditions(movements)).collect();
        let of_place = |place: usize| {
            let all: Vec<&Condition> = of_people.iter().filter_map(|person| person[place].as_ref()).collect();
            let mean = |of: &dyn Fn(&Condition) -> f64| all.iter().map(|one| of(one)).sum::<f64>() / all.len() as f64;
            let time = |one: &Condition| {
                one.trials.iter().map(|trial| trial.movement_time_s).sum::<f64>() / one.trials.len() as f64
            };
            let (width_m, distance_m) = (all.first()?.width, mean(&|one| one.distance));
            let id_bit = index_of_difficulty(distance_m, width_m);
            Some(AimingCondition { width_m, distance_m, id_bit, movement_time_s: mean(&time) })
        };
        (0..self.widths.len() * DISTANCES).filter_map(of_place).collect()
    }
}

fn at_width(people: &[Vec<Measured>], width: f64) -> Result<AimingWidth, PublishedError> {
    let all: Vec<&Measured> = people.iter().flatten().filter(|one| (one.width - width).abs() < SAME_WIDTH).collect();
    let movements: Vec<_> = all.iter().filter_map(|one| one.aimed.movement).collect();
    let straight_on = || all.iter().filter_map(|one| one.straight_on.as_ref());
    let median = |values: Vec<f64>| statistics::median(&values);
    Ok(AimingWidth {
        width_m: width,
        movements: movements.len(),
        duration_s: median(movements.iter().map(|one| one.duration_s).collect())?,
        peak_speed_m_s: median(movements.iter().map(|one| one.peak_speed).collect())?,
        time_of_peak: median(movements.iter().map(|one| one.time_of_peak).collect())?,
        position: mean_profile(straight_on().map(|one| &one.share)),
        velocity_m_s: mean_profile(straight_on().map(|one| &one.velocity)),
    })
}
