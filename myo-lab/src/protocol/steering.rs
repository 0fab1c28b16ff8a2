//! Protocol S1: how long ways take that must not be left.

use myo_measure::steering::{Steering, Tunnel};
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::OverUsers;
use super::practice::{BEFORE_WAY, WAY_PIECES, WAY_SPHERE, Way, ways};
use super::recording::Recording;
use crate::advice::distance;

/// Fewest passes of a way without leaving it that a time is taken from.
const LEAST_PASSES: usize = 2;

/// Protocol S1: the steering law (Accot and Zhai 1997, doi 10.1145/258549.258760), of users who went along straight and round ways.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteeringLaw {
    /// How many users.
    pub users: usize,
    /// Each way.
    pub rows: Vec<SteeringRow>,
    /// The law of each shape whose ways all users have learnt.
    pub steering: Vec<SteeringFit>,
    /// Which way that is not, if there is one, and what would help.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unlearnt: Option<String>,
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
    /// Mean time (s) of passes that did not leave it, from its first sphere to its last; median over the users who have learnt it, none where nobody has.
    pub time_s: Option<f64>,
    /// 95 % confidence interval of the mean over users, as all that follow.
    pub time_s_interval: Option<[f64; 2]>,
    /// Share of passes that left it, mean over the users who came to its end; none where nobody did.
    pub left: Option<f64>,
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
    /// Of one user or more, each with its recordings of all ways, in their order. There is no law of a shape where a user has not learnt one of its
    /// ways: [`unlearnt`](Self::unlearnt) says which.
    ///
    /// # Errors
    /// Nobody has learnt anything, or there is no fit.
    pub fn of(users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let ways = ways();
        let of_user =
            |user: &Vec<Vec<Recording>>| ways.iter().zip(user).map(|(way, own)| Passes::of(way, own)).collect();
        let passes: Vec<Vec<Passes>> = users.iter().map(of_user).collect();
        let rows = (0..ways.len())
            .map(|number| SteeringRow::of(&ways[number], &passes.iter().map(|user| &user[number]).collect::<Vec<_>>()))
            .collect::<Result<Vec<_>, _>>()?;
        let unlearnt = match passes.iter().flatten().find_map(|passes| passes.tunnel().err()) {
            Some(error) if rows.iter().all(|row| row.time_s.is_none()) => return Err(error),
            first => first.map(|error| error.to_string()),
        };
        let mut shapes: Vec<&'static str> = ways.iter().map(|way| way.shape).collect();
        shapes.dedup();
        let law = |shape| {
            let tunnels = |user: &Vec<Passes>| {
                let own = user.iter().filter(|passes| passes.way.shape == shape);
                own.map(|passes| passes.tunnel().ok()).collect::<Option<Vec<Tunnel>>>()
            };
            let learnt = passes.iter().map(tunnels).collect::<Option<Vec<_>>>()?;
            Some(SteeringFit::of(shape, &learnt))
        };
        let steering = shapes.into_iter().filter_map(law).collect::<Result<_, _>>()?;
        Ok(Self { users: users.len(), rows, steering, unlearnt })
    }

    /// Times over length by width, and the lines through them.
    pub fn plot(&self) -> Plot {
        let mut shapes: Vec<&'static str> = self.rows.iter().map(|row| row.shape).collect();
        shapes.dedup();
        let series = shapes.into_iter().flat_map(|shape| {
            let rows: Vec<_> = self.rows.iter().filter(|row| row.shape == shape).collect();
            let line = self.steering.iter().find(|fit| fit.shape == shape).map(|fit| fit.line(&rows));
            let point =
                |row: &&SteeringRow| Some(PlotPoint { at: [row.index, row.time_s?], interval: row.time_s_interval });
            let points = rows.iter().filter_map(point).collect();
            [Some(PlotSeries { name: shape.into(), points, line: vec![] }), line]
        });
        Plot {
            title: "The steering law".into(),
            axes: ["length over width of the way".into(), "time, s".into()],
            series: series.flatten().collect(),
        }
    }
}

impl SteeringRow {
    fn of(way: &Way, users: &[&Passes]) -> Result<Self, ProtocolError> {
        let learnt: Vec<f64> =
            users.iter().filter_map(|user| user.tunnel().ok()).map(|own| mean(&own.times_s)).collect();
        let time = if learnt.is_empty() { None } else { Some(OverUsers::of(&learnt, "times of passes")?) };
        let left: Vec<f64> = users.iter().filter_map(|user| user.share_left()).collect();
        Ok(Self {
            shape: way.shape,
            width_m: way.width,
            index: way.length() / way.width,
            time_s: time.map(|time| time.median),
            time_s_interval: time.and_then(|time| time.interval),
            left: (!left.is_empty()).then(|| mean(&left)),
        })
    }
}

impl SteeringFit {
    /// The line that is drawn, over these ways.
    fn line(&self, rows: &[&SteeringRow]) -> PlotSeries {
        let ends = rows.iter().map(|row| row.index).fold([f64::INFINITY, 0.0], |[a, b], x| [a.min(x), b.max(x)]);
        let line = ends.map(|index| [index, self.intercept_s + self.slope_s * index]);
        let name = format!("{:.0} ms + {:.0} ms per unit", 1e3 * self.intercept_s, 1e3 * self.slope_s);
        PlotSeries { name: format!("{name}, R2 {:.2}", self.r2), points: vec![], line: line.to_vec() }
    }

    fn of(shape: &'static str, users: &[Vec<Tunnel>]) -> Result<Self, ProtocolError> {
        let law = |tunnels: &Vec<Tunnel>| Steering::of(tunnels).map_err(ProtocolError::measuring("the steering law"));
        let users = users.iter().map(law).collect::<Result<Vec<_>, _>>()?;
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

/// What a user's episodes on a way were.
struct Passes<'a> {
    way: &'a Way,
    /// Of episodes that did not leave it (s).
    times_s: Vec<f64>,
    /// How many left it and came to its end.
    left: usize,
    /// Episodes in all.
    asked: usize,
}

impl<'a> Passes<'a> {
    fn of(way: &'a Way, recordings: &[Recording]) -> Self {
        let whole = || recordings.iter().filter_map(|recording| Some((recording, time(way, recording)?)));
        let times_s: Vec<f64> = whole().filter(|(recording, _)| recording.exits == 0.0).map(|(_, time)| time).collect();
        Self { left: whole().count() - times_s.len(), times_s, way, asked: recordings.len() }
    }

    /// The same for the law.
    fn tunnel(&self) -> Result<Tunnel, ProtocolError> {
        let Self { way, times_s, left, asked } = self;
        if times_s.len() < LEAST_PASSES {
            let what = format!("passes of the {} way of {:.0} mm that did not leave it", way.shape, 1e3 * way.width);
            return Err(ProtocolError::TooFew { what, found: times_s.len(), asked: *asked, least: LEAST_PASSES });
        }
        Ok(Tunnel { length: way.length(), width: way.width, times_s: times_s.clone(), left: *left })
    }

    /// Share of those that came to its end which left it.
    fn share_left(&self) -> Option<f64> {
        let ended = self.left + self.times_s.len();
        (ended > 0).then(|| self.left as f64 / ended as f64)
    }
}

/// How long (s) an episode took from leaving the first sphere of its way to coming to the last one; none where it did not.
fn time(way: &Way, recording: &Recording) -> Option<f64> {
    let (start, end) =
        (recording.done.get(BEFORE_WAY - 1)?.end, recording.done.get(BEFORE_WAY + WAY_PIECES - 1)?.entry);
    let is_at_start = |&sample: &usize| distance(recording.fingertip[sample], way.corners[0]) <= WAY_SPHERE;
    let leaves = (start..end.min(recording.fingertip.len())).rev().find(is_at_start).unwrap_or(start);
    Some((end - leaves) as f64 / recording.rate_hz)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
