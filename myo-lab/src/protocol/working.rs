//! Protocol E2: what ten minutes of selecting in the air cost an arm, at the height of the shoulder and of the waist.
//!
//! Episodes that were recorded are put one behind the other until ten minutes have passed. Fatigue is reckoned from the activations, as if muscles tired by them: a user whose
//! muscles do tire is none the more tired for it. Endurance is reckoned from the share of its strength that holds the upper arm up.

use myo_dynamics::{CouplingMode, Exerter, Isometric, Plan, State};
use myo_measure::bands::{Figure, Figures};
use myo_measure::{ergonomics, statistics};
use myo_model::Model;
use myo_muscle::{Fatigue, FatigueRates, MuscleGroup};
use serde::Serialize;

use super::ProtocolError;
use super::pointing::set_all;
use super::practice::{HEIGHTS, SELECTIONS};
use super::recording::Recording;

/// How long is worked (s).
const WORK_S: f64 = 600.0;
/// The joint that raises the upper arm.
const RAISES: &str = "shoulder_elv";
/// The plane in which it is raised, and where in it muscles are told apart that raise it (degrees).
const PLANE: (&str, f64) = ("elv_angle", 90.0);
const RAISED_DEG: f64 = 45.0;
/// Least moment arm (m) of a muscle that raises it.
const LEAST_ARM: f64 = 0.005;
/// From one look at the posture to the next (s).
const LOOK_S: f64 = 0.1;
/// From one look at what muscles do to the next (s).
const EXERTION_S: f64 = 0.02;

/// Work at both heights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorkInTheAir {
    /// How many users.
    pub users: usize,
    /// At the height of the shoulder, and of the waist. Medians over users.
    pub rows: Vec<WorkRow>,
}

/// Ten minutes of work.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorkRow {
    /// `shoulder` or `waist`.
    pub height: &'static str,
    /// Share that is fatigued of the shoulder's muscles that raise the arm, their mean by strength (3CC-r).
    pub fatigued: f64,
    /// Share of its strength that holds the upper arm up, mean over time.
    pub of_strength: f64,
    /// Share of the endurance at this load that the work takes, as consumed endurance has it; none at 15 % of the strength or less.
    pub consumed_endurance: f64,
    /// The same as NICER has it, for which no load is too small.
    pub consumed_nicer: f64,
    /// Share of the time that the upper arm is within 20 degrees of hanging down, within 45, within 90, and above (RULA).
    pub upper_arm: [f64; 4],
    /// What muscles consume (W), more than at rest.
    pub metabolic_w: f64,
    /// Torque of the muscles on all joints together (N m), root mean square.
    pub torque_nm: f64,
    /// How fast that changes (N m/s), root mean square.
    pub torque_change_nm_s: f64,
    /// Mean squared activation of the muscles.
    pub activation: f64,
    /// Selections per minute.
    pub selections_per_min: f64,
}

/// A body that works.
struct Worker {
    plan: Plan<f64>,
    raises: usize,
    /// Muscles of the shoulder that raise the arm: which, and how strong.
    elevators: Vec<(usize, f64)>,
    rates: Vec<FatigueRates>,
    exerter: Exerter,
}

/// What all muscles together do, mean over time.
struct Efforts {
    metabolic_w: f64,
    torque_nm: f64,
    torque_change_nm_s: f64,
    activation: f64,
}

impl Worker {
    fn of(model: &Model) -> Result<Self, ProtocolError> {
        let plan = Plan::exact(model, CouplingMode::Reduced)?;
        let coordinate = |joint: &'static str| {
            let found = plan.dofs.iter().position(|dof| dof.name == joint);
            found.ok_or_else(|| ProtocolError::NoJoint { joint, model: model.name.clone() })
        };
        let (raises, plane) = (coordinate(RAISES)?, coordinate(PLANE.0)?);
        let mut qpos = vec![0.0; plan.ndof()];
        (qpos[raises], qpos[plane]) = (RAISED_DEG.to_radians(), PLANE.1.to_radians());
        let pulls = Isometric::at(&plan, &qpos).muscles;
        let group = |muscle: usize| model.muscles[muscle].parameters.group;
        let raising = pulls.iter().enumerate().filter(|(muscle, pull)| {
            group(*muscle) == Some(MuscleGroup::Shoulder) && pull.moment_arms[raises] >= LEAST_ARM
        });
        let elevators: Vec<_> = raising.map(|(muscle, pull)| (muscle, pull.torque[raises].max(0.0))).collect();
        if elevators.iter().map(|(_, strength)| strength).sum::<f64>() <= 0.0 {
            return Err(ProtocolError::NoMuscle {
                what: "muscles of the shoulder that raise the arm",
                model: model.name.clone(),
            });
        }
        let rates = (0..model.muscles.len()).map(|muscle| FatigueRates::of(group(muscle))).collect();
        let exerter = Exerter::new(model, plan.clone());
        Ok(Self { plan, raises, elevators, rates, exerter })
    }

    /// Ten minutes of these recordings, one behind the other.
    fn work(&self, height: &'static str, recordings: &[Recording]) -> Result<WorkRow, ProtocolError> {
        let stretches: Vec<_> = recordings
            .iter()
            .filter_map(|recording| {
                // Who does not come to the next target works on until the time is up.
                let all = recording.done.len() == SELECTIONS;
                let end = if all { recording.done.last()?.end } else { recording.fingertip.len() };
                Some((recording, recording.done.first()?.end..end))
            })
            .filter(|(_, samples)| !samples.is_empty())
            .collect();
        let made: usize = recordings.iter().map(|recording| recording.done.len().saturating_sub(1)).sum();
        let asked = (SELECTIONS - 1) * recordings.len();
        let Some(rate_hz) = stretches.first().map(|(recording, _)| recording.rate_hz).filter(|_| 2 * made >= asked)
        else {
            let what = format!("selections at the height of the {height}");
            return Err(ProtocolError::TooFew { what, found: made, asked, least: asked.div_ceil(2) });
        };
        let samples: usize = stretches.iter().map(|(_, samples)| samples.len()).sum();
        let (of_strength, angles) = self.postures(&stretches, (LOOK_S * rate_hz) as usize);
        if !of_strength.is_finite() {
            return Err(ProtocolError::Powerless { joint: RAISES, height });
        }
        let measuring = || ProtocolError::measuring(format!("work at the height of the {height}"));
        let consumed = |endurance: Result<f64, myo_measure::MeasureError>| {
            endurance.and_then(|endurance_s| ergonomics::consumed(WORK_S, endurance_s)).map_err(measuring())
        };
        let Efforts { metabolic_w, torque_nm, torque_change_nm_s, activation } = self.efforts(&stretches, rate_hz);
        Ok(WorkRow {
            height,
            metabolic_w,
            torque_nm,
            torque_change_nm_s,
            activation,
            fatigued: self.fatigued(&stretches, rate_hz),
            of_strength,
            consumed_endurance: consumed(ergonomics::rohmert_endurance_s(of_strength.min(1.0)))?,
            consumed_nicer: consumed(ergonomics::nicer_endurance_s(of_strength.min(1.0)))?,
            upper_arm: ergonomics::UpperArm::shares(&angles).map_err(measuring())?,
            selections_per_min: 60.0 * made as f64 * rate_hz / samples as f64,
        })
    }

    /// Mean share of its strength that holds the upper arm up, and how far (degrees) it is raised, now and then.
    fn postures(&self, stretches: &[(&Recording, std::ops::Range<usize>)], every: usize) -> (f64, Vec<f64>) {
        let joints = self.plan.ndof();
        let looks = stretches.iter().flat_map(|(recording, samples)| {
            let at =
                |sample: usize| recording.qpos[sample * joints..][..joints].iter().map(|&q| f64::from(q)).collect();
            samples.clone().step_by(every.max(1)).map(at).collect::<Vec<Vec<f64>>>()
        });
        let (shares, angles): (Vec<f64>, Vec<f64>) = looks
            .map(|qpos| (Isometric::at(&self.plan, &qpos).holding_share(self.raises), qpos[self.raises].to_degrees()))
            .unzip();
        (shares.iter().sum::<f64>() / shares.len() as f64, angles)
    }

    /// What the muscles do and consume, every [`EXERTION_S`].
    fn efforts(&self, stretches: &[(&Recording, std::ops::Range<usize>)], rate_hz: f64) -> Efforts {
        let (joints, muscles) = (self.plan.ndof(), self.plan.nmuscle());
        let every = ((EXERTION_S * rate_hz) as usize).max(1);
        let (mut exerter, mut state) = (self.exerter.clone(), State::new(&self.plan));
        let squares = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
        let (mut metabolic, mut torque, mut change, mut activation) = (vec![], vec![], vec![], vec![]);
        for (recording, samples) in stretches {
            let mut before: Option<Vec<f64>> = None;
            for sample in samples.clone().step_by(every) {
                let State { qpos, qvel, act } = &mut state;
                for (own, seen, count) in [
                    (qpos, &recording.qpos, joints),
                    (qvel, &recording.qvel, joints),
                    (act, &recording.activations, muscles),
                ] {
                    own.iter_mut().zip(&seen[sample * count..]).for_each(|(own, &seen)| *own = f64::from(seen));
                }
                let now = exerter.at(&state);
                metabolic.push(now.metabolic);
                torque.push(squares(&now.torque));
                activation.push(squares(&state.act) / muscles as f64);
                if let Some(before) = before.replace(now.torque.clone()) {
                    let rates: Vec<f64> =
                        now.torque.iter().zip(before).map(|(now, was)| (now - was) / EXERTION_S).collect();
                    change.push(squares(&rates));
                }
            }
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        Efforts {
            metabolic_w: mean(&metabolic),
            torque_nm: mean(&torque).sqrt(),
            torque_change_nm_s: mean(&change).sqrt(),
            activation: mean(&activation),
        }
    }

    /// Mean share that is fatigued of the muscles that raise the arm, after ten minutes.
    fn fatigued(&self, stretches: &[(&Recording, std::ops::Range<usize>)], rate_hz: f64) -> f64 {
        let muscles = self.rates.len();
        let strength: f64 = self.elevators.iter().map(|(_, strength)| strength).sum();
        let of_muscle = |muscle: usize| {
            let tiring = Fatigue::<f64>::new(self.rates[muscle], 1.0, rate_hz.recip());
            let once = stretches.iter().flat_map(|(recording, samples)| {
                samples.clone().map(|sample| f64::from(recording.activations[sample * muscles + muscle]))
            });
            once.cycle().take((WORK_S * rate_hz) as usize).fold(0.0, |fatigued, act| tiring.next(fatigued, act, act))
        };
        self.elevators.iter().map(|&(muscle, share)| of_muscle(muscle) * share / strength).sum()
    }
}

impl WorkInTheAir {
    /// Refuses a body that cannot be asked.
    ///
    /// # Errors
    /// A body without a shoulder, or whose file does not say which muscles are the shoulder's.
    pub fn check(model: &Model) -> Result<(), ProtocolError> {
        Worker::of(model).map(drop)
    }

    /// Of one user or more, each with its recordings at each height.
    ///
    /// # Errors
    /// A body without a shoulder, too few selections.
    pub fn of(model: &Model, users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let worker = Worker::of(model)?;
        let at = |place: usize, height: &'static str| {
            let of_user =
                |layouts: &Vec<Vec<Recording>>| worker.work(height, layouts.get(place).map_or(&[], |own| own));
            median(height, &users.iter().map(of_user).collect::<Result<Vec<_>, _>>()?)
        };
        let rows = HEIGHTS.iter().enumerate().map(|(place, (height, _))| at(place, height));
        Ok(Self { users: users.len(), rows: rows.collect::<Result<_, _>>()? })
    }

    /// What of it people's bands are about: the measure by which the waist does worst.
    ///
    /// # Errors
    /// Work at the height of the shoulder that takes nothing.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let [shoulder, waist] = &self.rows[..] else { return Ok(()) };
        let measures: [fn(&WorkRow) -> f64; 3] = [|row| row.fatigued, |row| row.of_strength, |row| row.consumed_nicer];
        let over = measures.map(|of| of(waist) / of(shoulder));
        // Nothing over nothing is no figure, and may not hide behind the others.
        let worst = over.into_iter().reduce(|a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) });
        set_all(figures, worst.map(|worst| (Figure::WaistOverShoulder, worst)))
    }
}

/// Medians over users.
fn median(height: &'static str, rows: &[WorkRow]) -> Result<WorkRow, ProtocolError> {
    let over = |of: &dyn Fn(&WorkRow) -> f64| {
        statistics::median(&rows.iter().map(of).collect::<Vec<_>>()).map_err(ProtocolError::measuring("work"))
    };
    let mut upper_arm = [0.0; 4];
    for (class, share) in upper_arm.iter_mut().enumerate() {
        *share = over(&|row| row.upper_arm[class])?;
    }
    Ok(WorkRow {
        height,
        fatigued: over(&|row| row.fatigued)?,
        of_strength: over(&|row| row.of_strength)?,
        consumed_endurance: over(&|row| row.consumed_endurance)?,
        consumed_nicer: over(&|row| row.consumed_nicer)?,
        upper_arm,
        metabolic_w: over(&|row| row.metabolic_w)?,
        torque_nm: over(&|row| row.torque_nm)?,
        torque_change_nm_s: over(&|row| row.torque_change_nm_s)?,
        activation: over(&|row| row.activation)?,
        selections_per_min: over(&|row| row.selections_per_min)?,
    })
}

#[cfg(test)]
mod tests {
    use myo_model::builtin;

    use super::super::recording::Done;
    use super::*;

    fn body() -> Model {
        Model::new(&builtin("myo-arm").unwrap()).unwrap()
    }

    /// An arm that is held raised by so much (degrees), all muscles active as told.
    fn held(model: &Model, degrees: f64, activation: f32) -> Recording {
        let worker = Worker::of(model).unwrap();
        let plane = worker.plan.dofs.iter().position(|dof| dof.name == PLANE.0).unwrap();
        let mut qpos = vec![0.0_f32; worker.plan.ndof()];
        (qpos[worker.raises], qpos[plane]) = (degrees.to_radians() as f32, PLANE.1.to_radians() as f32);
        let samples = 14 * 100;
        Recording {
            rate_hz: 100.0,
            fingertip: vec![[0.0; 3]; samples],
            force: vec![0.0; samples],
            qvel: vec![0.0; qpos.len() * samples],
            qpos: qpos.repeat(samples),
            activations: vec![activation; samples * model.muscles.len()],
            done: (0..14).map(|n| Done { begin: 100 * n, entry: 100 * n + 50, end: 100 * n + 100 }).collect(),
            exits: 0.0,
            wrong_presses: 0.0,
            targets: None,
        }
    }

    #[test]
    fn an_arm_that_is_held_up_is_told_as_it_is() {
        let model = body();
        let user = vec![vec![held(&model, 85.0, 0.2)], vec![held(&model, 30.0, 0.05)]];
        let found = WorkInTheAir::of(&model, &[user]).unwrap();
        let [shoulder, waist] = &found.rows[..] else { panic!("{found:?}") };
        assert_eq!((shoulder.height, shoulder.upper_arm), ("shoulder", [0.0, 0.0, 1.0, 0.0]));
        assert_eq!((waist.height, waist.upper_arm), ("waist", [0.0, 1.0, 0.0, 0.0]));
        // About as protocol M1 has the share that holds a straight arm at 90 degrees.
        assert!((0.12..0.2).contains(&shoulder.of_strength), "{shoulder:?}");
        assert!((shoulder.selections_per_min - 60.0).abs() < 1e-9);
        // Muscles at work for ten minutes: the equation of fatigue in closed form.
        let FatigueRates { fatigue_per_s: f, recovery_per_s: r, .. } = MuscleGroup::Shoulder.rates();
        let exact = f * 0.05 / r * (1.0 - (-r * WORK_S).exp());
        assert!((waist.fatigued - exact).abs() < 0.01 * exact, "{waist:?}, not {exact}");
        // Four times as much work would tire more than there is.
        assert!((0.7..0.95).contains(&shoulder.fatigued), "{shoulder:?}");
        // Arms that do not move: nothing changes, and heat alone is consumed. A muscle a fifth active takes 24 W/kg at the most of heat.
        assert_eq!([shoulder, waist].map(|row| row.torque_change_nm_s), [0.0; 2]);
        assert!((shoulder.activation - 0.04).abs() < 1e-6 && (waist.activation - 0.0025).abs() < 1e-7, "{found:?}");
        let most = 24.0 * Exerter::new(&model, Plan::exact(&model, CouplingMode::Reduced).unwrap()).muscle_mass_kg();
        assert!((0.5 * most..most).contains(&shoulder.metabolic_w), "{shoulder:?}, not {most}");
        assert!(waist.metabolic_w < 0.3 * shoulder.metabolic_w && waist.torque_nm < shoulder.torque_nm, "{found:?}");
        let mut figures = Figures::new();
        found.figures(&mut figures).unwrap();
        assert!(figures.get(Figure::WaistOverShoulder).unwrap() < 1.0);
    }

    #[test]
    fn who_does_not_select_has_no_figures() {
        let model = body();
        let mut idle = held(&model, 90.0, 0.2);
        idle.done.truncate(3);
        let rest = WorkRow { fatigued: 0.0, ..row_of_nothing() };
        let nothing = WorkInTheAir { users: 1, rows: vec![rest.clone(), rest] };
        let error = nothing.figures(&mut Figures::new()).unwrap_err().to_string();
        assert!(error.starts_with("WaistOverShoulder: "), "{error}");
        let error = WorkInTheAir::of(&model, &[vec![vec![idle.clone()], vec![idle]]]).unwrap_err().to_string();
        assert!(
            error.starts_with("selections at the height of the shoulder: the user did 2 of 13, and at least 7"),
            "{error}"
        );
    }

    fn row_of_nothing() -> WorkRow {
        WorkRow {
            height: "shoulder",
            fatigued: 0.1,
            of_strength: 0.1,
            consumed_endurance: 0.0,
            consumed_nicer: 0.1,
            upper_arm: [1.0, 0.0, 0.0, 0.0],
            metabolic_w: 10.0,
            torque_nm: 10.0,
            torque_change_nm_s: 10.0,
            activation: 0.01,
            selections_per_min: 100.0,
        }
    }

    /// Seconds in which a target is not come to are work, too.
    #[test]
    fn who_does_not_come_to_a_target_works_all_the_same() {
        let model = body();
        let all = held(&model, 85.0, 0.2);
        let mut stuck = all.clone();
        stuck.done.truncate(8);
        let pace = |recording: Recording| {
            let user = vec![vec![recording.clone()], vec![recording]];
            WorkInTheAir::of(&model, &[user]).unwrap().rows[0].selections_per_min
        };
        assert!((pace(all) - 60.0).abs() < 1e-9);
        assert!((pace(stuck) - 60.0 * 7.0 / 13.0).abs() < 1e-9);
    }

    #[test]
    fn a_body_whose_muscles_are_not_known_is_refused() {
        let mut description = builtin("myo-arm").unwrap();
        description.muscles.iter_mut().for_each(|muscle| muscle.parameters.group = None);
        let model = Model::new(&description).unwrap();
        let error = WorkInTheAir::of(&model, &[]).unwrap_err().to_string();
        assert_eq!(
            error,
            "the protocol needs muscles of the shoulder that raise the arm, which the body `myo-arm` does not name"
        );
    }
}
