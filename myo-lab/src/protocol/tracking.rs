//! Protocol S2: how well a wandering target is tracked, by how fast it wanders.

use myo_measure::tracking::Tracking;
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::OverUsers;
use super::practice::{TRACKED_RADIUS, TRACKED_UP_TO_HZ};
use super::recording::Recording;

/// The step of the script that tracks.
const TRACKS: usize = 1;
/// Seconds at its beginning that are left out, as by those who asked User-in-the-Box.
const LEFT_OUT_S: f64 = 1.0;

/// Targets whose waves go up to four frequencies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pursuit {
    /// How many users.
    pub users: usize,
    /// Each greatest frequency.
    pub rows: Vec<PursuitRow>,
}

/// Targets of one greatest frequency: means over episodes, median over users, with the 95 % confidence interval of the mean over users.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PursuitRow {
    /// Greatest frequency of the target's waves (Hz).
    pub up_to_hz: f64,
    /// Mean speed of the target (m/s).
    pub target_speed_m_s: f64,
    /// From the pointer to the target's centre, root mean square (m).
    pub rms_error_m: f64,
    /// Its interval.
    pub rms_error_m_interval: Option<[f64; 2]>,
    /// The same, mean (m).
    pub mean_error_m: f64,
    /// Share of the time inside the target.
    pub inside: f64,
    /// Its interval.
    pub inside_interval: Option<[f64; 2]>,
    /// How late the pointer is (s).
    pub lag_s: f64,
    /// Its interval.
    pub lag_s_interval: Option<[f64; 2]>,
    /// How far it goes for how far the target goes.
    pub gain: f64,
    /// Its interval.
    pub gain_interval: Option<[f64; 2]>,
}

impl Pursuit {
    /// Of one user or more, each with its recordings of all frequencies, in their order.
    ///
    /// # Errors
    /// A user came to none of the targets of a frequency.
    pub fn of(users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let row = |(number, &up_to_hz): (usize, &f64)| {
            let tracked = users.iter().map(|user| tracked(up_to_hz, &user[number])).collect::<Result<Vec<_>, _>>()?;
            PursuitRow::of(up_to_hz, &tracked)
        };
        let rows = TRACKED_UP_TO_HZ.iter().enumerate().map(row).collect::<Result<_, _>>()?;
        Ok(Self { users: users.len(), rows })
    }

    /// Errors over greatest frequency.
    pub fn plot(&self) -> Plot {
        let point = |row: &PursuitRow| PlotPoint {
            at: [row.up_to_hz, 100.0 * row.rms_error_m],
            interval: row.rms_error_m_interval.map(|ends| ends.map(|error| 100.0 * error)),
        };
        let points: Vec<PlotPoint> = self.rows.iter().map(point).collect();
        let line = points.iter().map(|point| point.at).collect();
        Plot {
            title: "Tracking".into(),
            axes: [
                "greatest frequency of the target, Hz".into(),
                "distance from its centre, root mean square, cm".into(),
            ],
            series: vec![PlotSeries { name: String::new(), points, line }],
        }
    }
}

impl PursuitRow {
    fn of(up_to_hz: f64, users: &[Vec<Tracking>]) -> Result<Self, ProtocolError> {
        let over = |of: fn(&Tracking) -> f64| {
            let mean = |episodes: &Vec<Tracking>| episodes.iter().map(of).sum::<f64>() / episodes.len() as f64;
            OverUsers::of(&users.iter().map(mean).collect::<Vec<_>>(), "tracking")
        };
        let [rms, inside, lag, gain] =
            [over(|t| t.rms_error)?, over(|t| t.inside)?, over(|t| t.lag_s)?, over(|t| t.gain)?];
        Ok(Self {
            up_to_hz,
            target_speed_m_s: over(|t| t.target_speed)?.median,
            rms_error_m: rms.median,
            rms_error_m_interval: rms.interval,
            mean_error_m: over(|t| t.mean_error)?.median,
            inside: inside.median,
            inside_interval: inside.interval,
            lag_s: lag.median,
            lag_s_interval: lag.interval,
            gain: gain.median,
            gain_interval: gain.interval,
        })
    }
}

/// How a user tracked in the episodes in which it came to the target.
fn tracked(up_to_hz: f64, recordings: &[Recording]) -> Result<Vec<Tracking>, ProtocolError> {
    let mut found = vec![];
    for recording in recordings {
        if let Some([pointer, target]) = tracked_part(recording) {
            let measured = Tracking::of(&pointer, &target, recording.rate_hz, TRACKED_RADIUS);
            found.push(measured.map_err(ProtocolError::measuring("tracking"))?);
        }
    }
    if found.is_empty() {
        let what = format!("episodes in which a target of up to {up_to_hz} Hz was come to");
        return Err(ProtocolError::TooFew { what, found: 0, asked: recordings.len(), least: 1 });
    }
    Ok(found)
}

/// Where fingertip and target were while it was tracked, without the beginning; none where the user never came to it in time.
fn tracked_part(recording: &Recording) -> Option<[Vec<[f64; 3]>; 2]> {
    let targets = recording.targets.as_ref()?;
    let begin = targets.step.iter().position(|&step| step == TRACKS)? * targets.samples;
    let begin = begin + (LEFT_OUT_S * recording.rate_hz) as usize;
    let target: Vec<[f64; 3]> = targets.path().collect();
    let end = target.len().min(recording.fingertip.len());
    // As much as is needed to tell of it at all.
    let enough = (end as f64 - begin as f64) >= 2.0 * recording.rate_hz;
    enough.then(|| [recording.fingertip[begin..end].to_vec(), target[begin..end].to_vec()])
}
