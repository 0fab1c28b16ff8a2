//! Protocol I2: reaching far with a hand that grows (Go-Go): how long it takes, and how fast the hand is and what it points with.

use myo_measure::{Point, signal};
use myo_tasks::Task;
use myo_tasks::logic::{CompiledTask, Landmarks, Pointer};
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::OverUsers;
use super::practice::{FAR, FAR_REACHES};
use super::reach::CUT_OFF_HZ;
use super::recording::Recording;

/// Least share of the reaches to a distance that must be made.
const LEAST_SHARE: f64 = 0.5;

/// Reaches to targets in and beyond the arm's reach.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FarReaches {
    /// How many users.
    pub users: usize,
    /// Each distance.
    pub rows: Vec<FarRow>,
    /// Which distance somebody has not learnt, if there is one, and what would help.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unlearnt: Option<String>,
}

/// A distance: means over reaches, over the users who have learnt it; none where nobody has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FarRow {
    /// Of the target from the shoulder (m).
    pub distance_m: f64,
    /// From the end of the stay near the body to the last entry into the target (s).
    pub time_s: Option<OverUsers>,
    /// Peak speed of the hand (m/s).
    pub hand_speed_m_s: Option<OverUsers>,
    /// Peak speed of what it points with (m/s).
    pub pointer_speed_m_s: Option<OverUsers>,
    /// Share of the reaches that were not made, mean over users.
    pub missed: f64,
}

/// What one user did at a distance: time (s), peak speeds of hand and pointer (m/s) of each reach.
struct Reaches {
    distance_m: f64,
    all: Vec<[f64; 3]>,
    asked: usize,
}

impl FarReaches {
    /// Of one user or more, each with its recordings of all distances, in the order of [`FAR`], of the task of one of these.
    ///
    /// # Errors
    /// Nobody has learnt anything, or a recording cannot be measured.
    pub fn of(task: &Task, users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let pointer = CompiledTask::<f64>::new(task).map_err(myo_env::BuildError::from)?.pointer;
        let of_user = |user: &Vec<Vec<Recording>>| {
            FAR.iter().zip(user).map(|(&distance, own)| Reaches::of(&pointer, distance, own)).collect()
        };
        let all: Vec<Vec<Reaches>> = users.iter().map(of_user).collect::<Result<_, _>>()?;
        let rows = (0..FAR.len())
            .map(|number| FarRow::of(&all.iter().map(|user| &user[number]).collect::<Vec<_>>()))
            .collect::<Result<Vec<_>, _>>()?;
        let unlearnt = match all.iter().flatten().find_map(|own| own.means().err()) {
            Some(error) if rows.iter().all(|row| row.time_s.is_none()) => return Err(error),
            first => first.map(|error| error.to_string()),
        };
        Ok(Self { users: users.len(), rows, unlearnt })
    }

    /// Times over distance.
    pub fn plot(&self) -> Plot {
        let point = |row: &FarRow| {
            row.time_s.map(|time| PlotPoint { at: [row.distance_m, time.median], interval: time.interval })
        };
        let points = self.rows.iter().filter_map(point).collect();
        Plot {
            title: "Reaching far (Go-Go)".into(),
            axes: ["distance of the target from the shoulder, m".into(), "movement time, s".into()],
            series: vec![PlotSeries { name: String::new(), points, line: vec![] }],
        }
    }
}

impl FarRow {
    fn of(users: &[&Reaches]) -> Result<Self, ProtocolError> {
        let means: Vec<[f64; 3]> = users.iter().filter_map(|own| own.means().ok()).collect();
        let over = |number: usize| {
            let values: Vec<f64> = means.iter().map(|own| own[number]).collect();
            if values.is_empty() { Ok(None) } else { OverUsers::of(&values, "reaches").map(Some) }
        };
        let missed = users.iter().map(|own| 1.0 - own.all.len() as f64 / own.asked.max(1) as f64).sum::<f64>();
        Ok(Self {
            distance_m: users.first().map_or(f64::NAN, |own| own.distance_m),
            time_s: over(0)?,
            hand_speed_m_s: over(1)?,
            pointer_speed_m_s: over(2)?,
            missed: missed / users.len() as f64,
        })
    }
}

impl Reaches {
    fn of(pointer: &Pointer<f64>, distance_m: f64, recordings: &[Recording]) -> Result<Self, ProtocolError> {
        let mut all = vec![];
        for Recording { rate_hz, fingertip, done, .. } in recordings {
            let measuring = || ProtocolError::measuring("a far reach");
            let hand = signal::low_pass_points(fingertip, *rate_hz, CUT_OFF_HZ).map_err(measuring())?;
            let pointed: Vec<Point> = hand.iter().map(|&point| place(pointer, point)).collect();
            let speeds = [&hand, &pointed].map(|points| signal::speed(points, *rate_hz).map_err(measuring()));
            let [hand, pointed] = speeds;
            let (hand, pointed) = (hand?, pointed?);
            // Every second step is to come back to the body.
            for one in done.iter().skip(1).step_by(2) {
                let peak = |speeds: &[f64]| {
                    speeds[one.begin..one.entry.max(one.begin + 1)].iter().copied().fold(0.0, f64::max)
                };
                all.push([(one.entry - one.begin) as f64 / rate_hz, peak(&hand), peak(&pointed)]);
            }
        }
        Ok(Self { distance_m, all, asked: FAR_REACHES * recordings.len() })
    }

    /// Means over reaches.
    ///
    /// # Errors
    /// Fewer than half of them were made.
    fn means(&self) -> Result<[f64; 3], ProtocolError> {
        let (found, asked) = (self.all.len(), self.asked);
        let least = ((LEAST_SHARE * asked as f64).ceil() as usize).max(1);
        if found < least {
            let what = format!("reaches to {} m", self.distance_m);
            return Err(ProtocolError::TooFew { what, found, asked, least });
        }
        Ok([0, 1, 2].map(|number| self.all.iter().map(|one| one[number]).sum::<f64>() / found as f64))
    }
}

/// Where the pointer is with the fingertip there; a hand that grows goes by nothing else.
fn place(pointer: &Pointer<f64>, fingertip: Point) -> Point {
    pointer.place(&Landmarks { fingertip, ..Landmarks::unknown() }, fingertip)
}
