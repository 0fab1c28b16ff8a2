//! Protocol M1: whether a body is as strong as people, and whether its muscles pull where people's do.
//!
//! The body is at rest in each posture, one muscle at a time fully active. A strength is the sum over all muscles that pull a joint one way,
//! without passive forces. Postures name the joints that are not at zero; *forward* is `elv_angle` 90, *sideways* `elv_angle` 0.

use myo_dynamics::{CouplingMode, Isometric, Plan, PlanError};
use myo_measure::bands::{BANDS, Figure, Figures};
use myo_model::Model;
use serde::Serialize;
use thiserror::Error;

use super::ProtocolError;
use super::pointing::set_all;

/// What a strength is measured against.
struct People {
    what: &'static str,
    joint: &'static str,
    /// 1 where muscles that pull the joint up count, -1 where those that pull it down do.
    way: f64,
    posture: &'static [(&'static str, f64)],
    /// The joint that goes through angles, and at each what people can do (N m).
    over: &'static str,
    range: &'static [(f64, [f64; 2])],
    source: &'static str,
}

const MEN: &str =
    "men, Holzbaur et al. 2007, doi 10.1016/j.jbiomech.2006.11.013, with the shape of isometric handbooks";
const HANDBOOK: &str = "men, isometric handbooks";
const FORWARD: (&str, f64) = ("elv_angle", 90.0);
const SIDEWAYS: (&str, f64) = ("elv_angle", 0.0);
const BENT: (&str, f64) = ("elbow_flexion", 90.0);

/// Isometric strength of people.
const STRENGTH: &[People] = &[
    People {
        what: "elbow flexion",
        joint: "elbow_flexion",
        way: 1.0,
        posture: &[],
        over: "elbow_flexion",
        range: &[
            (60.0, [55.0, 79.5]),
            (75.0, [70.0, 79.5]),
            (90.0, [79.5, 79.5]),
            (105.0, [70.0, 79.5]),
            (120.0, [55.7, 79.5]),
        ],
        source: MEN,
    },
    People {
        what: "elbow extension",
        joint: "elbow_flexion",
        way: -1.0,
        posture: &[],
        over: "elbow_flexion",
        range: &[(45.0, [40.0, 55.0]), (60.0, [40.0, 55.0]), (75.0, [40.0, 55.0]), (90.0, [40.0, 55.0])],
        source: HANDBOOK,
    },
    People {
        what: "shoulder flexion, arm straight",
        joint: "shoulder_elv",
        way: 1.0,
        posture: &[FORWARD],
        over: "shoulder_elv",
        range: &[(0.0, [89.9, 89.9]), (45.0, [68.6, 68.6]), (90.0, [84.0, 84.0])],
        source: "26 men, dynamic shoulder flexion (0 and 45 degrees); regression of the model NICER (90 degrees), arXiv 2406.08875",
    },
    People {
        what: "shoulder abduction, arm straight",
        joint: "shoulder_elv",
        way: 1.0,
        posture: &[SIDEWAYS],
        over: "shoulder_elv",
        range: &[(30.0, [55.0, 75.0]), (90.0, [45.0, 60.0])],
        source: HANDBOOK,
    },
    People {
        what: "shoulder adduction, arm straight",
        joint: "shoulder_elv",
        way: -1.0,
        posture: &[SIDEWAYS],
        over: "shoulder_elv",
        range: &[(30.0, [67.9, 93.7]), (60.0, [67.9, 93.7]), (90.0, [67.9, 93.7])],
        source: MEN,
    },
    People {
        what: "inward rotation, elbow at 90",
        joint: "shoulder_rot",
        way: 1.0,
        posture: &[BENT],
        over: "shoulder_rot",
        range: &[(0.0, [40.0, 60.0])],
        source: HANDBOOK,
    },
    People {
        what: "outward rotation, elbow at 90",
        joint: "shoulder_rot",
        way: -1.0,
        posture: &[BENT],
        over: "shoulder_rot",
        range: &[(0.0, [25.0, 40.0])],
        source: HANDBOOK,
    },
    People {
        what: "pronation, elbow at 90",
        joint: "pro_sup",
        way: 1.0,
        posture: &[BENT],
        over: "pro_sup",
        range: &[(0.0, [7.0, 10.0])],
        source: HANDBOOK,
    },
    People {
        what: "supination, elbow at 90",
        joint: "pro_sup",
        way: -1.0,
        posture: &[BENT],
        over: "pro_sup",
        range: &[(0.0, [7.0, 10.0])],
        source: HANDBOOK,
    },
];

/// Below this share of the least that people can do, a strength fails.
const WEAK: f64 = 0.5;

/// Elevations (degrees) at which the straight arm is held.
const HELD_AT: [f64; 5] = [60.0, 75.0, 90.0, 105.0, 120.0];

/// Muscles whose moment arms at the elbow are known, and polynomials of the angle (rad) that give them in cm: regressions after
/// Pigeon, Yahia and Feldman 1996, doi 10.1016/0021-9290(96)00057-7.
const ARMS: [(&str, &[&str], [f64; 6]); 4] = [
    ("biceps", &["BIClong", "BICshort"], [1.963, -1.44, 3.031, 0.887, -1.418, 0.285]),
    ("brachioradialis", &["BRD"], [2.015, -0.458, 3.058, -1.081, 0.159, -0.0187]),
    ("brachialis", &["BRA"], [1.554, 0.0813, -1.689, 3.523, -1.811, 0.276]),
    ("triceps", &["TRIlong", "TRIlat", "TRImed"], [-2.365, -1.015, 1.92, -1.035, 0.257, -0.0262]),
];

/// Angles (degrees) of the elbow at which moment arms are told.
const ARMS_AT: [f64; 6] = [0.0, 30.0, 60.0, 90.0, 105.0, 120.0];

/// A muscle whose moment arm may not change its sign.
struct Kept {
    muscle: &'static str,
    joint: &'static str,
    /// The rest of the posture.
    posture: &'static [(&'static str, f64)],
    /// The greatest angle from zero (degrees).
    up_to: u32,
}

impl Kept {
    const fn at_elbow(muscle: &'static str) -> Self {
        Self { muscle, joint: "elbow_flexion", posture: &[], up_to: 130 }
    }

    const fn at_shoulder(muscle: &'static str, posture: &'static [(&'static str, f64)]) -> Self {
        Self { muscle, joint: "shoulder_elv", posture, up_to: 120 }
    }
}

const KEEP_SIGN: [Kept; 6] = [
    Kept::at_elbow("BRA"),
    Kept::at_elbow("BIClong"),
    Kept::at_elbow("BRD"),
    Kept::at_elbow("TRIlat"),
    Kept::at_shoulder("DELT1", &[FORWARD]),
    Kept::at_shoulder("DELT2", &[SIDEWAYS]),
];

/// Moment arms (m) nearer to zero than this have no sign.
const NO_ARM: f64 = 1e-3;

/// One strength.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StrengthRow {
    /// What is done.
    pub what: &'static str,
    /// Angle of the joint that goes through angles (degrees).
    pub at_deg: f64,
    /// Of this body (N m).
    pub torque_n_m: f64,
    /// Of people, from and to (N m).
    pub people_n_m: [f64; 2],
    /// Whether it is at least half of what people can do.
    pub passes: bool,
    /// Where people's figures come from.
    pub source: &'static str,
}

/// The straight arm, held against gravity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HoldingShare {
    /// `forward` or `sideways`.
    pub way: &'static str,
    /// Elevation (degrees).
    pub at_deg: f64,
    /// Torque of gravity (N m).
    pub gravity_n_m: f64,
    /// Strength against it (N m).
    pub strength_n_m: f64,
    /// One over the other.
    pub share: f64,
    /// Whether people hold it as easily.
    pub passes: bool,
}

/// Moment arm at the elbow.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MomentArm {
    /// The muscle, of whose heads it is the mean.
    pub muscle: &'static str,
    /// Angle of the elbow (degrees).
    pub at_deg: f64,
    /// Of this body (cm), positive where it flexes.
    pub body_cm: f64,
    /// Of people (cm).
    pub people_cm: f64,
}

/// A muscle that turns from one that pulls a joint up into one that pulls it down.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignChange {
    /// The muscle.
    pub muscle: &'static str,
    /// The joint.
    pub joint: &'static str,
    /// Where (degrees).
    pub at_deg: f64,
}

/// What protocol M1 found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Strength {
    /// Name of the body.
    pub model: String,
    /// Strengths.
    pub strength: Vec<StrengthRow>,
    /// The straight arm, held.
    pub holding: Vec<HoldingShare>,
    /// Moment arms at the elbow.
    pub moment_arms: Vec<MomentArm>,
    /// Muscles among brachialis, biceps, brachioradialis, triceps and deltoid that change sides.
    pub sign_changes: Vec<SignChange>,
}

/// Why protocol M1 cannot be done.
#[derive(Debug, Error)]
pub enum StrengthError {
    /// The body lacks what the protocol names.
    #[error("protocol M1 needs the {kind} {missing}; the body `{model}` has {present}")]
    Missing {
        /// `joint` or `muscle`.
        kind: &'static str,
        /// Which.
        missing: String,
        /// Name of the body.
        model: String,
        /// What it has.
        present: String,
    },
    /// The body cannot be simulated.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// A body that is asked.
struct Body {
    plan: Plan<f64>,
    muscles: Vec<String>,
}

impl Strength {
    /// Asks a body.
    ///
    /// # Errors
    /// The body cannot be simulated, or lacks joints or muscles that the protocol names.
    pub fn of(model: &Model) -> Result<Self, StrengthError> {
        let body = Body::new(model)?;
        Ok(Self {
            model: model.name.clone(),
            strength: STRENGTH.iter().flat_map(|people| body.strength(people)).collect(),
            holding: [("forward", FORWARD), ("sideways", SIDEWAYS)].iter().flat_map(|way| body.holding(*way)).collect(),
            moment_arms: ARMS.iter().flat_map(|arm| body.moment_arms(arm)).collect(),
            sign_changes: KEEP_SIGN.iter().filter_map(|kept| body.sign_change(kept)).collect(),
        })
    }

    /// What of it people's bands are about: the share that holds the arm forward at 90 degrees.
    ///
    /// # Errors
    /// A body without any strength there.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let level = |row: &&HoldingShare| row.way == "forward" && row.at_deg == 90.0;
        let share = self.holding.iter().find(level).map(|row| (Figure::HoldingShare, row.share));
        let changes = (Figure::MomentArmSignChanges, self.sign_changes.len() as f64);
        set_all(figures, share.into_iter().chain([changes]))
    }

    /// Whether everything passes.
    pub fn passes(&self) -> bool {
        self.strength.iter().all(|row| row.passes)
            && self.holding.iter().all(|row| row.passes)
            && self.sign_changes.is_empty()
    }
}

impl Body {
    fn new(model: &Model) -> Result<Self, StrengthError> {
        let plan = Plan::exact(model, CouplingMode::Reduced)?;
        let muscles: Vec<String> = model.muscles.iter().map(|muscle| muscle.name.clone()).collect();
        let joints: Vec<String> = plan.dofs.iter().map(|dof| dof.name.clone()).collect();
        let named = STRENGTH.iter().flat_map(|people| [people.joint, people.over]);
        let needed =
            ARMS.iter().flat_map(|(_, heads, _)| *heads).copied().chain(KEEP_SIGN.iter().map(|kept| kept.muscle));
        check("joint", named.chain([FORWARD.0]), &joints, model)?;
        check("muscle", needed, &muscles, model)?;
        Ok(Self { plan, muscles })
    }

    fn coordinate(&self, joint: &str) -> usize {
        self.plan.dofs.iter().position(|dof| dof.name == joint).expect("joints were looked for")
    }

    fn muscle(&self, name: &str) -> usize {
        self.muscles.iter().position(|muscle| muscle == name).expect("muscles were looked for")
    }

    /// At these angles (degrees), all other joints at zero.
    fn at(&self, posture: &[(&str, f64)]) -> Isometric {
        let mut qpos = vec![0.0; self.plan.ndof()];
        posture.iter().for_each(|&(joint, degrees)| qpos[self.coordinate(joint)] = degrees.to_radians());
        Isometric::at(&self.plan, &qpos)
    }

    fn strength(&self, people: &'static People) -> Vec<StrengthRow> {
        let row = |&(at_deg, people_n_m): &(f64, [f64; 2])| {
            let posture = [people.posture, &[(people.over, at_deg)]].concat();
            let [up, down] = self.at(&posture).strength(self.coordinate(people.joint));
            let torque_n_m = if people.way > 0.0 { up } else { -down };
            let passes = torque_n_m >= WEAK * people_n_m[0];
            StrengthRow { what: people.what, at_deg, torque_n_m, people_n_m, passes, source: people.source }
        };
        people.range.iter().map(row).collect()
    }

    fn holding(&self, (way, plane): (&'static str, (&str, f64))) -> Vec<HoldingShare> {
        let k = self.coordinate("shoulder_elv");
        let row = |at_deg: f64| {
            let found = self.at(&[plane, ("shoulder_elv", at_deg)]);
            let (gravity_n_m, strength_n_m) = (-found.gravity[k], found.strength(k)[0]);
            let share = found.holding_share(k);
            let passes = is_within_band(Figure::HoldingShare, share);
            HoldingShare { way, at_deg, gravity_n_m, strength_n_m, share, passes }
        };
        HELD_AT.into_iter().map(row).collect()
    }

    fn moment_arms(&self, (muscle, heads, regression): &(&'static str, &[&str], [f64; 6])) -> Vec<MomentArm> {
        let k = self.coordinate("elbow_flexion");
        let row = |at_deg: f64| {
            let found = self.at(&[("elbow_flexion", at_deg)]);
            let arm = |head: &&str| found.muscles[self.muscle(head)].moment_arms[k] * 100.0;
            let body_cm = heads.iter().map(arm).sum::<f64>() / heads.len() as f64;
            let angle = at_deg.to_radians();
            let people_cm = regression.iter().rev().fold(0.0, |sum, coefficient| sum * angle + coefficient);
            MomentArm { muscle, at_deg, body_cm, people_cm }
        };
        ARMS_AT.into_iter().map(row).collect()
    }

    /// Where a muscle first pulls the other way than at the beginning, degree by degree.
    fn sign_change(&self, kept: &Kept) -> Option<SignChange> {
        let Kept { muscle, joint, posture, up_to } = *kept;
        let (k, index) = (self.coordinate(joint), self.muscle(muscle));
        let arm = |at_deg: f64| {
            let posture = [posture, &[(joint, at_deg)]].concat();
            self.at(&posture).muscles[index].moment_arms[k]
        };
        let mut sign = 0.0;
        for at_deg in (0..=up_to).map(f64::from) {
            let arm = arm(at_deg);
            if arm.abs() < NO_ARM {
                continue;
            }
            if sign * arm < 0.0 {
                return Some(SignChange { muscle, joint, at_deg });
            }
            sign = arm.signum();
        }
        None
    }
}

/// Whether a figure is as people's.
fn is_within_band(figure: Figure, value: f64) -> bool {
    let bounds = BANDS.iter().flat_map(|band| band.bounds);
    bounds.filter(|bound| bound.figure == figure).all(|bound| bound.holds(value))
}

/// Refuses a body that lacks one of the names.
fn check<'a>(
    kind: &'static str,
    mut needed: impl Iterator<Item = &'a str>,
    present: &[String],
    model: &Model,
) -> Result<(), StrengthError> {
    match needed.find(|name| !present.iter().any(|own| own == name)) {
        None => Ok(()),
        Some(missing) => Err(StrengthError::Missing {
            kind,
            missing: missing.to_owned(),
            model: model.name.clone(),
            present: present.join(", "),
        }),
    }
}

#[cfg(test)]
mod tests {
    use myo_model::builtin;

    use super::*;

    fn found(name: &str) -> Strength {
        Strength::of(&Model::new(&builtin(name).unwrap()).unwrap()).unwrap()
    }

    #[test]
    fn straight_tendons_fail_where_people_point() {
        let found = found("mobl-arms");
        let weak: Vec<_> = found.strength.iter().filter(|row| !row.passes).map(|row| (row.what, row.at_deg)).collect();
        assert_eq!(weak, [("elbow flexion", 120.0), ("shoulder flexion, arm straight", 90.0)]);
        let changes: Vec<_> = found.sign_changes.iter().map(|change| change.muscle).collect();
        assert!(changes.starts_with(&["BRA"]) && changes.contains(&"DELT1"), "{changes:?}");
        assert_eq!(found.holding.iter().filter(|row| !row.passes).count(), 4);
        assert!(!found.passes());
    }

    #[test]
    fn the_human_arm_is_strong_enough_and_holds_itself_as_people_do() {
        let found = found("myo-arm");
        assert!(found.strength.iter().all(|row| row.passes), "{:#?}", found.strength);
        assert!(found.holding.iter().all(|row| row.passes), "{:#?}", found.holding);
        let changes: Vec<_> = found.sign_changes.iter().map(|change| change.muscle).collect();
        assert!(changes.iter().all(|muscle| *muscle == "DELT1"), "{changes:?}");
        // Those that were not adjusted are within a centimetre of people's.
        for arm in found.moment_arms.iter().filter(|arm| ["brachialis", "triceps"].contains(&arm.muscle)) {
            assert!((arm.body_cm - arm.people_cm).abs() < 1.0, "{arm:?}");
        }
    }

    #[test]
    fn a_body_without_the_joints_is_told_which() {
        let mut description = builtin("myo-arm").unwrap();
        description.name = "other".into();
        description
            .joints
            .iter_mut()
            .filter(|joint| joint.name == "pro_sup")
            .for_each(|joint| joint.name = "twist".into());
        let error = Strength::of(&Model::new(&description).unwrap()).unwrap_err().to_string();
        assert!(error.starts_with("protocol M1 needs the joint pro_sup; the body `other` has elv_angle, "), "{error}");
    }
}
