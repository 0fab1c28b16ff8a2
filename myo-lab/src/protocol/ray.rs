//! Protocol I1: pointing at a wall with a ray from the hand, by the angles that it must turn and may be off.

use myo_measure::Line;
use myo_measure::fitts::index_of_difficulty;
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::OverUsers;
use super::practice::ray_pairs;
use super::recording::Recording;

/// Least share of the selections of a pair that must be made.
const LEAST_SHARE: f64 = 0.5;
/// Fewest pairs that a law goes through.
const LEAST_PAIRS: usize = 5;
/// Exponents of the width that are tried: from none to many, hundredths apart.
const EXPONENTS: [f64; 2] = [0.2, 6.0];

/// Times of a ray over angles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayPointing {
    /// How many users.
    pub users: usize,
    /// Each pair of angles.
    pub rows: Vec<RayRow>,
    /// Fitts' law of angles, through the pairs that all users have learnt; none where these are fewer than five.
    pub law: Option<RayLaw>,
    /// Which pair somebody has not learnt, if there is one, and what would help.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unlearnt: Option<String>,
}

/// A pair of angles, as seen from the shoulder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayRow {
    /// From target to target (degrees).
    pub distance_deg: f64,
    /// Of a target (degrees).
    pub width_deg: f64,
    /// From the end of the stay in one target to the last entry into the next (s); none where nobody has learnt it.
    pub time_s: Option<OverUsers>,
    /// Share of the selections that were not made, mean over users.
    pub missed: f64,
}

/// Laws of movement time over angles, user by user.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayLaw {
    /// Pairs that it goes through.
    pub pairs: usize,
    /// Share of the variance that `a + b log2(alpha / omega + 1)` explains (Lane 2025, arXiv 2505.03027).
    pub r2: OverUsers,
    /// Its slope (s/bit).
    pub slope_s_per_bit: OverUsers,
    /// Its intercept (s).
    pub intercept_s: OverUsers,
    /// The exponent `k` with which `a + b log2(alpha / omega^k + 1)^2` explains most, angles in degrees (Kopper et al. 2010,
    /// doi 10.1016/j.ijhcs.2010.05.001).
    pub exponent: OverUsers,
    /// What that explains.
    pub r2_of_exponent: OverUsers,
}

/// What one user did of a pair.
struct Selections {
    pair: [f64; 2],
    times_s: Vec<f64>,
    asked: usize,
}

impl RayPointing {
    /// Of one user or more, each with its recordings of all pairs, in the order of [`ray_pairs`].
    ///
    /// # Errors
    /// Nobody has learnt anything.
    pub fn of(users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let of_user = |user: &Vec<Vec<Recording>>| {
            ray_pairs().into_iter().zip(user).map(|(pair, own)| Selections::of(pair, own)).collect()
        };
        let all: Vec<Vec<Selections>> = users.iter().map(of_user).collect();
        let rows = (0..ray_pairs().len())
            .map(|number| RayRow::of(&all.iter().map(|user| &user[number]).collect::<Vec<_>>()))
            .collect::<Result<Vec<_>, _>>()?;
        let unlearnt = match all.iter().flatten().find_map(|own| own.time_s().err()) {
            Some(error) if rows.iter().all(|row| row.time_s.is_none()) => return Err(error),
            first => first.map(|error| error.to_string()),
        };
        let learnt: Vec<usize> =
            (0..rows.len()).filter(|&pair| all.iter().all(|user| user[pair].time_s().is_ok())).collect();
        let law = if learnt.len() < LEAST_PAIRS { None } else { Some(RayLaw::of(&all, &learnt)?) };
        Ok(Self { users: users.len(), rows, law, unlearnt })
    }

    /// Times over the index of difficulty of the angles.
    pub fn plot(&self) -> Plot {
        let index = |row: &RayRow| index_of_difficulty(row.distance_deg, row.width_deg);
        let mut widths: Vec<f64> = self.rows.iter().map(|row| row.width_deg).collect();
        widths.sort_by(f64::total_cmp);
        widths.dedup();
        let series = widths.into_iter().map(|width| {
            let own = self.rows.iter().filter(|row| row.width_deg == width);
            let point = |row: &RayRow| {
                row.time_s.map(|time| PlotPoint { at: [index(row), time.median], interval: time.interval })
            };
            PlotSeries { name: format!("{width} deg wide"), points: own.filter_map(point).collect(), line: vec![] }
        });
        let line = self.law.as_ref().map(|law| {
            let ends = self.rows.iter().map(index).fold([f64::INFINITY, 0.0], |[a, b], x| [a.min(x), b.max(x)]);
            let [slope, from] = [law.slope_s_per_bit.median, law.intercept_s.median];
            let name = format!("{:.0} ms + {:.0} ms/bit, R2 {:.2}", 1e3 * from, 1e3 * slope, law.r2.median);
            PlotSeries { name, points: vec![], line: ends.map(|index| [index, from + slope * index]).to_vec() }
        });
        Plot {
            title: "Pointing with a ray".into(),
            axes: ["log2(angle / angular width + 1), bit".into(), "movement time, s".into()],
            series: series.chain(line).collect(),
        }
    }
}

impl RayRow {
    fn of(users: &[&Selections]) -> Result<Self, ProtocolError> {
        let [distance_deg, width_deg] = users.first().map_or([f64::NAN; 2], |own| own.pair);
        let times: Vec<f64> = users.iter().filter_map(|own| own.time_s().ok()).collect();
        let missed = users.iter().map(|own| 1.0 - own.times_s.len() as f64 / own.asked.max(1) as f64).sum::<f64>();
        Ok(Self {
            distance_deg,
            width_deg,
            time_s: if times.is_empty() { None } else { Some(OverUsers::of(&times, "selections with a ray")?) },
            missed: missed / users.len() as f64,
        })
    }
}

impl RayLaw {
    fn of(users: &[Vec<Selections>], pairs: &[usize]) -> Result<Self, ProtocolError> {
        let of_user = |user: &Vec<Selections>| {
            let own: Vec<&Selections> = pairs.iter().map(|&pair| &user[pair]).collect();
            let times = own.iter().map(|own| own.time_s()).collect::<Result<Vec<f64>, _>>()?;
            let through = |of: &dyn Fn([f64; 2]) -> f64| {
                let indices: Vec<f64> = own.iter().map(|own| of(own.pair)).collect();
                Line::through(&indices, &times).map_err(ProtocolError::measuring("selections with a ray"))
            };
            let plain = through(&|[distance, width]| index_of_difficulty(distance, width))?;
            let squared = |k: f64| through(&|[distance, width]| index_of_difficulty(distance, width.powf(k)).powi(2));
            let hundredths = EXPONENTS.map(|k| (100.0 * k) as usize);
            let mut best = (EXPONENTS[0], squared(EXPONENTS[0])?.r2);
            for k in (hundredths[0]..=hundredths[1]).map(|hundredth| hundredth as f64 / 100.0) {
                let r2 = squared(k)?.r2;
                if r2 > best.1 {
                    best = (k, r2);
                }
            }
            Ok((plain, best))
        };
        let laws = users.iter().map(of_user).collect::<Result<Vec<(Line, (f64, f64))>, ProtocolError>>()?;
        let over = |of: fn(&(Line, (f64, f64))) -> f64| {
            OverUsers::of(&laws.iter().map(of).collect::<Vec<_>>(), "selections with a ray")
        };
        Ok(Self {
            pairs: pairs.len(),
            r2: over(|(line, _)| line.r2)?,
            slope_s_per_bit: over(|(line, _)| line.slope)?,
            intercept_s: over(|(line, _)| line.intercept)?,
            exponent: over(|(_, (k, _))| *k)?,
            r2_of_exponent: over(|(_, (_, r2))| *r2)?,
        })
    }
}

impl Selections {
    fn of(pair: [f64; 2], recordings: &[Recording]) -> Self {
        // The first one begins with a hanging arm.
        let seconds = |recording: &Recording| {
            let rate_hz = recording.rate_hz;
            recording
                .done
                .iter()
                .skip(1)
                .map(move |done| (done.entry - done.begin) as f64 / rate_hz)
                .collect::<Vec<_>>()
        };
        let times_s = recordings.iter().flat_map(seconds).collect();
        Self { pair, times_s, asked: (super::practice::SELECTIONS - 1) * recordings.len() }
    }

    /// Mean time (s).
    ///
    /// # Errors
    /// Fewer than half of the selections were made.
    fn time_s(&self) -> Result<f64, ProtocolError> {
        let (found, asked) = (self.times_s.len(), self.asked);
        let least = ((LEAST_SHARE * asked as f64).ceil() as usize).max(1);
        if found < least {
            let [distance, width] = self.pair;
            let what = format!("selections with a ray, {distance} degrees apart and {width} degrees wide");
            return Err(ProtocolError::TooFew { what, found, asked, least });
        }
        Ok(self.times_s.iter().sum::<f64>() / found as f64)
    }
}
