//! Protocol K2: where movements end before they are corrected.

use myo_measure::bands::{Figure, Figures};
use myo_measure::{EndpointCloud, MeasureError, statistics};
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::{UserReaches, set_all, slope};
use super::practice::{SELECTIONS, circle_targets, conditions};

/// The width (m) of targets so small that stops scatter freely.
const SMALL: f64 = 0.015;

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

/// The clouds of the directions of a condition in which enough movements stopped, at least half of them.
fn clouds(user: &UserReaches, condition: usize) -> Result<Vec<EndpointCloud>, ProtocolError> {
    let distance = conditions()[condition][0];
    let targets = circle_targets(distance);
    let cloud = |selection: usize| {
        let same = user.between().filter(|reach| (reach.condition, reach.selection) == (condition, selection));
        let stops: Vec<_> = same.filter_map(|reach| reach.first_stop).collect();
        EndpointCloud::of(&stops, targets[selection - 1], targets[selection])
    };
    let (mut found, mut too_few) = (vec![], None);
    for direction in (1..SELECTIONS).map(cloud) {
        match direction {
            Ok(cloud) => found.push(cloud),
            Err(error @ MeasureError::TooFew { .. }) => too_few = too_few.or(Some(error)),
            Err(error) => return Err(telling(distance)(error)),
        }
    }
    match too_few {
        Some(error) if 2 * found.len() < SELECTIONS - 1 => Err(telling(distance)(error)),
        _ => Ok(found),
    }
}

fn telling(distance: f64) -> impl Fn(MeasureError) -> ProtocolError {
    move |error| ProtocolError::measuring(format!("end points over {:.0} mm", 1e3 * distance))(error)
}
