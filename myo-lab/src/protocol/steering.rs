//! Protocol S1: how long ways take that must not be left.

use myo_measure::steering::{Steering, Tunnel};
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::OverUsers;
use super::practice::{WAY_PIECES, WAY_SPHERE, Way, ways};
use super::recording::Recording;
use crate::advice::distance;

/// Steps before the first piece of a way: to stay at its beginning, and to be there when it begins.
const BEFORE: usize = 2;
/// Fewest passes of a way without leaving it that a time is taken from.
const LEAST_PASSES: usize = 2;

/// Protocol S1: the steering law (Accot and Zhai 1997, doi 10.1145/258549.258760), of users who went along straight and round ways.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteeringLaw {
    /// How many users.
    pub users: usize,
    /// Each way.
    pub rows: Vec<SteeringRow>,
    /// The law of each shape.
    pub steering: Vec<SteeringFit>,
}

/// A way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteeringRow {
    /// Its shape.
    pub shape: &'static str,
    /// How wide it is (m).
    pub width_m: f64,
    /// Length over width.
    pub index: f64,
    /// Mean time (s) of passes that did not leave it, from its first sphere to its last; median over users.
    pub time_s: f64,
    /// 95 % confidence interval of the mean over users, as all that follow.
    pub time_s_interval: Option<[f64; 2]>,
    /// Share of passes that left it, mean over users.
    pub left: f64,
}

/// The law of one shape, through mean times of its ways, user by user.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteeringFit {
    /// Of which ways.
    pub shape: &'static str,
    /// Share of the variance of the means that it explains.
    pub r2: f64,
    /// Its interval.
    pub r2_interval: Option<[f64; 2]>,
    /// Slope (s per unit of length over width).
    pub slope_s: f64,
    /// Its interval.
    pub slope_s_interval: Option<[f64; 2]>,
    /// Intercept (s).
    pub intercept_s: f64,
    /// Its interval.
    pub intercept_s_interval: Option<[f64; 2]>,
}

impl SteeringLaw {
    /// Of one user or more, each with its recordings of all ways, in their order.
    ///
    /// # Errors
    /// A way that a user did not pass often enough without leaving it, or no fit.
    pub fn of(users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let ways = ways();
        let passed = |user: &Vec<Vec<Recording>>| {
            ways.iter().zip(user).map(|(way, recordings)| tunnel(way, recordings)).collect::<Result<Vec<_>, _>>()
        };
        let tunnels = users.iter().map(passed).collect::<Result<Vec<_>, _>>()?;
        let rows = (0..ways.len())
            .map(|number| {
                let of_users: Vec<&Tunnel> = tunnels.iter().map(|user| &user[number]).collect();
                SteeringRow::of(&ways[number], &of_users)
            })
            .collect::<Result<_, _>>()?;
        let mut shapes: Vec<&'static str> = ways.iter().map(|way| way.shape).collect();
        shapes.dedup();
        let law = |shape| {
            let of_shape = |user: &Vec<Tunnel>| {
                let own = ways.iter().zip(user).filter(|(way, _)| way.shape == shape);
                let own: Vec<Tunnel> = own.map(|(_, tunnel)| tunnel.clone()).collect();
                Steering::of(&own).map_err(ProtocolError::measuring("the steering law"))
            };
            SteeringFit::of(shape, &tunnels.iter().map(of_shape).collect::<Result<Vec<_>, _>>()?)
        };
        Ok(Self { users: users.len(), rows, steering: shapes.into_iter().map(law).collect::<Result<_, _>>()? })
    }

    /// Times over length by width, and the lines through them.
    pub fn plot(&self) -> Plot {
        let series = self.steering.iter().flat_map(|fit| {
            let rows = || self.rows.iter().filter(|row| row.shape == fit.shape);
            let point = |row: &SteeringRow| PlotPoint { at: [row.index, row.time_s], interval: row.time_s_interval };
            let ends = rows().map(|row| row.index).fold([f64::INFINITY, 0.0], |[a, b], x| [a.min(x), b.max(x)]);
            let line = ends.map(|index| [index, fit.intercept_s + fit.slope_s * index]);
            let name = format!("{:.0} ms + {:.0} ms per unit", 1e3 * fit.intercept_s, 1e3 * fit.slope_s);
            [
                PlotSeries { name: fit.shape.into(), points: rows().map(point).collect(), line: vec![] },
                PlotSeries { name: format!("{name}, R2 {:.2}", fit.r2), points: vec![], line: line.to_vec() },
            ]
        });
        Plot {
            title: "The steering law".into(),
            axes: ["length over width of the way".into(), "time, s".into()],
            series: series.collect(),
        }
    }
}

impl SteeringRow {
    fn of(way: &Way, users: &[&Tunnel]) -> Result<Self, ProtocolError> {
        let mean = |tunnel: &&Tunnel| tunnel.times_s.iter().sum::<f64>() / tunnel.times_s.len() as f64;
        let time = OverUsers::of(&users.iter().map(mean).collect::<Vec<_>>(), "times of passes")?;
        let left = |tunnel: &&Tunnel| tunnel.left as f64 / (tunnel.left + tunnel.times_s.len()) as f64;
        Ok(Self {
            shape: way.shape,
            width_m: way.width,
            index: way.length() / way.width,
            time_s: time.median,
            time_s_interval: time.interval,
            left: users.iter().map(left).sum::<f64>() / users.len() as f64,
        })
    }
}

impl SteeringFit {
    fn of(shape: &'static str, users: &[Steering]) -> Result<Self, ProtocolError> {
        let over =
            |of: fn(&Steering) -> f64| OverUsers::of(&users.iter().map(of).collect::<Vec<_>>(), "the steering law");
        let [r2, slope, intercept] =
            [over(|law| law.fit.r2)?, over(|law| law.fit.slope)?, over(|law| law.fit.intercept)?];
        Ok(Self {
            shape,
            r2: r2.median,
            r2_interval: r2.interval,
            slope_s: slope.median,
            slope_s_interval: slope.interval,
            intercept_s: intercept.median,
            intercept_s_interval: intercept.interval,
        })
    }
}

/// What a user's episodes on a way were: one pass each, or none.
fn tunnel(way: &Way, recordings: &[Recording]) -> Result<Tunnel, ProtocolError> {
    let whole = || recordings.iter().filter_map(|recording| Some((recording, time(way, recording)?)));
    let times_s: Vec<f64> = whole().filter(|(recording, _)| recording.exits == 0.0).map(|(_, time)| time).collect();
    if times_s.len() < LEAST_PASSES {
        let what = format!("passes of the {} way of {:.0} mm that did not leave it", way.shape, 1e3 * way.width);
        let (found, asked) = (times_s.len(), recordings.len());
        return Err(ProtocolError::TooFew { what, found, asked, least: LEAST_PASSES });
    }
    let left = whole().count() - times_s.len();
    Ok(Tunnel { length: way.length(), width: way.width, times_s, left })
}

/// How long (s) an episode took from leaving the first sphere of its way to coming to the last one; none where it did not.
fn time(way: &Way, recording: &Recording) -> Option<f64> {
    let (start, end) = (recording.done.get(BEFORE - 1)?.end, recording.done.get(BEFORE + WAY_PIECES - 1)?.entry);
    let is_at_start = |&sample: &usize| distance(recording.fingertip[sample], way.corners[0]) <= WAY_SPHERE;
    let leaves = (start..end.min(recording.fingertip.len())).rev().find(is_at_start).unwrap_or(start);
    Some((end - leaves) as f64 / recording.rate_hz)
}
