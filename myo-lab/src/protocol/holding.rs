//! Protocols K3 and K5: how still an arm is held, and what muscles do for it and in movements.

use myo_dynamics::{CouplingMode, Isometric, Plan};
use myo_measure::bands::{Figure, Figures};
use myo_measure::{Drive, Hold, drive, statistics};
use myo_model::Model;
use serde::Serialize;

use super::ProtocolError;
use super::pointing::set_all;
use super::practice::HOLD_DEG;
use super::recording::Recording;

/// What is left out of a hold at its beginning (s): the arm comes to rest.
const SETTLING_S: f64 = 0.5;
/// Fewest holds that figures are taken from.
const LEAST_HOLDS: usize = 5;
/// Least moment arm (m) of a muscle at the elbow for it to count as a flexor or an extensor.
const LEAST_ARM: f64 = 0.005;
/// The joint that is co-contracted, and at what angle muscles are told apart.
const ELBOW: &str = "elbow_flexion";
const ELBOW_DEG: f64 = 90.0;

/// Protocol K3: how still the fingertip is held in a sphere of 10 cm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stillness {
    /// How many users.
    pub users: usize,
    /// By the angle between hanging and held arm.
    pub rows: Vec<StillnessRow>,
}

/// Holds with the arm raised so far.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StillnessRow {
    /// Angle between the hanging arm and the one that is held (degrees).
    pub at_deg: f64,
    /// Mean speed of the fingertip (m/s), median over holds and users.
    pub mean_speed_m_s: f64,
    /// Displacement from 4 to 15 Hz, peak to peak (m).
    pub tremor_m: f64,
    /// From where the hold began to where it ended, without tremor (m).
    pub drift_m: f64,
}

/// The settled part of each hold at the `step`-th angle, in samples.
fn held(recordings: &[Recording], step: usize) -> Vec<(&Recording, std::ops::Range<usize>)> {
    let hold = |recording: &'_ Recording| {
        let done = recording.done.get(step)?;
        let from = done.entry + (SETTLING_S * recording.rate_hz) as usize;
        (from < done.end).then_some(from..done.end)
    };
    recordings.iter().filter_map(|recording| Some((recording, hold(recording)?))).collect()
}

fn enough(found: usize, asked: usize, at_deg: f64) -> Result<(), ProtocolError> {
    let what = format!("holds at {at_deg} degrees");
    if found >= LEAST_HOLDS { Ok(()) } else { Err(ProtocolError::TooFew { what, found, asked, least: LEAST_HOLDS }) }
}

impl Stillness {
    /// Of one user or more, each with its recordings.
    ///
    /// # Errors
    /// Too few holds.
    pub fn of(users: &[Vec<Recording>]) -> Result<Self, ProtocolError> {
        let row = |(step, at_deg): (usize, f64)| {
            let of_user = |recordings: &Vec<Recording>| holds(recordings, step, at_deg);
            let users = users.iter().map(of_user).collect::<Result<Vec<_>, _>>()?;
            let over = |of: fn(&Hold) -> f64| {
                let each = users.iter().map(|holds| statistics::median(&holds.iter().map(of).collect::<Vec<_>>()));
                statistics::median(&each.collect::<Result<Vec<_>, _>>()?)
            };
            let over = |of| over(of).map_err(ProtocolError::measuring("holds"));
            Ok(StillnessRow {
                at_deg,
                mean_speed_m_s: over(|hold| hold.mean_speed)?,
                tremor_m: over(|hold| hold.tremor_peak_to_peak)?,
                drift_m: over(|hold| hold.drift)?,
            })
        };
        let rows = HOLD_DEG.into_iter().enumerate().map(row).collect::<Result<_, ProtocolError>>()?;
        Ok(Self { users: users.len(), rows })
    }

    /// What of it people's bands are about: the angle that does worse.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let worst = |of: fn(&StillnessRow) -> f64| self.rows.iter().map(of).fold(0.0, f64::max);
        let all = [(Figure::HoldSpeed, worst(|row| row.mean_speed_m_s)), (Figure::Tremor, worst(|row| row.tremor_m))];
        set_all(figures, all)
    }
}

fn holds(recordings: &[Recording], step: usize, at_deg: f64) -> Result<Vec<Hold>, ProtocolError> {
    let held = held(recordings, step);
    enough(held.len(), recordings.len(), at_deg)?;
    let hold = |(recording, samples): (&Recording, std::ops::Range<usize>)| {
        Hold::of(&recording.fingertip[samples], recording.rate_hz).map_err(ProtocolError::measuring("a hold"))
    };
    held.into_iter().map(hold).collect()
}

/// Protocol K5: activations of muscles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MuscleDrive {
    /// How many users.
    pub users: usize,
    /// While the arm is held at 45 degrees, and in movements from target to target.
    pub rows: Vec<DriveRow>,
}

/// What muscles do in one of these.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DriveRow {
    /// `holding` or `moving`.
    pub when: &'static str,
    /// Mean activation over muscles and time, median over users, as all that follow.
    pub mean: f64,
    /// Share of samples below 0.05.
    pub share_at_rest: f64,
    /// Share of samples above 0.95.
    pub share_saturated: f64,
    /// Mean change within 50 ms.
    pub change_per_50_ms: f64,
    /// Co-contraction of the elbow, from 0 to 1: what flexors and extensors do at once.
    pub elbow_co_contraction: f64,
}

/// Muscles that flex and that extend the elbow, by their moment arms at 90 degrees.
struct Elbow {
    flexors: Vec<usize>,
    extensors: Vec<usize>,
}

impl Elbow {
    fn of(model: &Model) -> Result<Self, ProtocolError> {
        let plan = Plan::exact(model, CouplingMode::Reduced)?;
        let elbow = plan.dofs.iter().position(|dof| dof.name == ELBOW);
        let elbow = elbow.ok_or_else(|| ProtocolError::NoJoint { joint: ELBOW, model: model.name.clone() })?;
        let mut qpos = vec![0.0; plan.ndof()];
        qpos[elbow] = ELBOW_DEG.to_radians();
        let found = Isometric::at(&plan, &qpos);
        let by = |sign: f64| {
            let arms = found.muscles.iter().map(|pull| sign * pull.moment_arms[elbow]).enumerate();
            arms.filter(|(_, arm)| *arm >= LEAST_ARM).map(|(muscle, _)| muscle).collect::<Vec<_>>()
        };
        Ok(Self { flexors: by(1.0), extensors: by(-1.0) })
    }
}

impl MuscleDrive {
    /// Of one user or more, each with its recordings of holding and of pointing.
    ///
    /// # Errors
    /// A body without an elbow, too few holds.
    pub fn of(model: &Model, users: &[(Vec<Recording>, Vec<Recording>)]) -> Result<Self, ProtocolError> {
        let elbow = Elbow::of(model)?;
        let muscles = model.muscles.len();
        let mut kinds: [Vec<DriveRow>; 2] = [vec![], vec![]];
        for (holding, pointing) in users {
            let held = held(holding, 0);
            enough(held.len(), holding.len(), HOLD_DEG[0])?;
            let moved = pointing.iter().filter_map(|recording| {
                let (first, last) = (recording.done.get(1)?, recording.done.last()?);
                Some((recording, first.begin..last.end))
            });
            kinds[0].push(row("holding", held, muscles, &elbow)?);
            kinds[1].push(row("moving", moved.collect(), muscles, &elbow)?);
        }
        Ok(Self { users: users.len(), rows: kinds.iter().map(|rows| over_users(rows)).collect::<Result<_, _>>()? })
    }

    /// What of it people's bands are about.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let [holding, moving] = &self.rows[..] else { return Ok(()) };
        let all = [
            (Figure::MeanActivation, holding.mean),
            (Figure::ShareSaturated, holding.share_saturated),
            (Figure::ElbowCoContraction, moving.elbow_co_contraction),
        ];
        set_all(figures, all)
    }
}

/// Over all these stretches of one user, put together.
fn row(
    when: &'static str,
    stretches: Vec<(&Recording, std::ops::Range<usize>)>,
    muscles: usize,
    elbow: &Elbow,
) -> Result<DriveRow, ProtocolError> {
    let of = |stretch: &(&Recording, std::ops::Range<usize>)| {
        let (recording, samples) = stretch;
        let activations = &recording.activations[samples.start * muscles..samples.end * muscles];
        activations.iter().map(|&x| f64::from(x)).collect::<Vec<_>>()
    };
    let activations: Vec<f64> = stretches.iter().flat_map(of).collect();
    let rate_hz = stretches.first().map_or(f64::NAN, |(recording, _)| recording.rate_hz);
    let measuring = || ProtocolError::measuring(format!("activations while {when}"));
    let found = Drive::of(&activations, muscles, rate_hz).map_err(measuring())?;
    let group = |group: &[usize]| drive::group_activation(&activations, muscles, group);
    let (flexors, extensors) =
        (group(&elbow.flexors).map_err(measuring())?, group(&elbow.extensors).map_err(measuring())?);
    Ok(DriveRow {
        when,
        mean: found.mean,
        share_at_rest: found.share_at_rest,
        share_saturated: found.share_saturated,
        change_per_50_ms: found.change_per_50_ms,
        elbow_co_contraction: drive::co_contraction(&flexors, &extensors).map_err(measuring())?,
    })
}

fn over_users(rows: &[DriveRow]) -> Result<DriveRow, ProtocolError> {
    let over = |of: fn(&DriveRow) -> f64| {
        statistics::median(&rows.iter().map(of).collect::<Vec<_>>()).map_err(ProtocolError::measuring("activations"))
    };
    Ok(DriveRow {
        when: rows.first().map_or("", |row| row.when),
        mean: over(|row| row.mean)?,
        share_at_rest: over(|row| row.share_at_rest)?,
        share_saturated: over(|row| row.share_saturated)?,
        change_per_50_ms: over(|row| row.change_per_50_ms)?,
        elbow_co_contraction: over(|row| row.elbow_co_contraction)?,
    })
}
