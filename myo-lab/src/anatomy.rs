//! What a body is before anybody learns to use it: where its fingertip gets to, how long the fibres of its muscles become, and
//! which joints they move.

use myo_dynamics::plan::DofKind;
use myo_dynamics::step::{fingertip, force::moment_arms, kinematics::kinematics, tendon};
use myo_dynamics::{Isometric, Plan, Workspace};
use myo_model::Model;
use myo_scalar::{Counter, Scalar, Word, philox, seed_words, unit};
use serde::Serialize;

use crate::protocol::{Plot, PlotSeries};

/// Poses that are looked at, drawn from within the limits of joints.
const POSES: u32 = 1000;
/// What a joint without limits is drawn from (rad).
const UNLIMITED: [f64; 2] = [-std::f64::consts::PI, std::f64::consts::PI];
/// Angles at which moment arms are drawn.
const ANGLES: usize = 41;
/// Muscles in one plot: as many as have a colour.
const DRAWN: usize = 6;
/// Moment arms that are none (m).
const NO_ARM: f64 = 1e-4;
/// Share of poses above which fibres are too often too long or too short to pull.
const OFTEN: f64 = 0.1;
/// Names in one warning.
const NAMED: usize = 6;

/// What a body is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Anatomy {
    /// How many random poses were looked at.
    pub poses: u32,
    /// From where to where the fingertip comes along x, y and z, in these poses (m, from the shoulder).
    pub fingertip_m: [[f64; 2]; 3],
    /// How near to the shoulder, and how far from it (m).
    pub distance_m: [f64; 2],
    /// Muscles, in the order of the model.
    pub muscles: Vec<MuscleAnatomy>,
}

/// What a muscle is in these poses.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MuscleAnatomy {
    /// Name.
    pub name: String,
    /// Length (m) at which its fibres pull most.
    pub optimal_length_m: f64,
    /// Length of its tendon (m): of its path without fibres.
    pub tendon_length_m: f64,
    /// Greatest active force (N).
    pub force_n: f64,
    /// From where to where the length of its fibres goes, in optimal lengths.
    pub fibre: [f64; 2],
    /// Lengths between which fibres pull, in optimal lengths.
    pub pulls: [f64; 2],
    /// Share of the poses in which its fibres are too short or too long to pull.
    pub cannot_pull: f64,
    /// The coordinate with its greatest moment arm, and that (m or 1), with its sign: positive where it pulls the coordinate up. None
    /// where it moves nothing.
    pub moves: Option<(String, f64)>,
}

impl Anatomy {
    /// Of a model and its [exact](Plan::exact) plan with reduced coordinates.
    pub fn of(model: &Model, plan: &Plan<f64>) -> Self {
        let mut ws = Workspace::<f64>::new(plan);
        let mut anatomy = Self {
            poses: POSES,
            fingertip_m: [[f64::INFINITY, f64::NEG_INFINITY]; 3],
            distance_m: [f64::INFINITY, f64::NEG_INFINITY],
            muscles: model.muscles.iter().zip(&plan.muscles).map(unlooked_at).collect(),
        };
        let still = vec![0.0; plan.ndof()];
        for number in 0..POSES {
            kinematics(plan, &pose(plan, number), &still, &mut ws);
            tendon::lengths(plan, &mut ws);
            let point = fingertip(plan, &ws);
            point.iter().zip(&mut anatomy.fingertip_m).for_each(|(&x, range)| widen(range, x));
            widen(&mut anatomy.distance_m, point.iter().map(|x| x * x).sum::<f64>().sqrt());
            let lengths = ws.tendon_length.clone();
            for (index, muscle) in anatomy.muscles.iter_mut().enumerate() {
                let curves = &plan.muscles[index].curves;
                let [scale, offset] = curves.fibre_length(&model.muscles[index].parameters.gain);
                let fibre = scale * lengths[index] + offset;
                widen(&mut muscle.fibre, fibre);
                if !(muscle.pulls[0]..=muscle.pulls[1]).contains(&fibre) {
                    muscle.cannot_pull += 1.0 / f64::from(POSES);
                }
                for (dof, slope) in plan.dofs.iter().zip(moment_arms(plan, index, &mut ws)) {
                    let greatest = muscle.moves.as_ref().map_or(NO_ARM, |(_, arm)| arm.abs());
                    if slope.abs() > greatest {
                        muscle.moves = Some((dof.name.clone(), -slope));
                    }
                }
            }
        }
        anatomy
    }

    /// What is not as in bodies, in sentences.
    pub fn warnings(&self) -> Vec<String> {
        let named = |of: &dyn Fn(&MuscleAnatomy) -> bool| {
            let names: Vec<&str> =
                self.muscles.iter().filter(|&muscle| of(muscle)).map(|muscle| &*muscle.name).collect();
            let rest = names.len().saturating_sub(NAMED);
            let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
            (!names.is_empty()).then(|| format!("{}{more}", names[..names.len().min(NAMED)].join(", ")))
        };
        let lax = named(&|muscle| muscle.cannot_pull > OFTEN).map(|names| {
            format!(
                "in more than {:.0} % of poses fibres are too short or too long to pull: {names}; look at `length_range` and `range`, or at the \
                 path",
                100.0 * OFTEN
            )
        });
        let idle = named(&|muscle| muscle.moves.is_none())
            .map(|names| format!("no joint is moved by {names}; look at the bodies of their sites"));
        let short = named(&|muscle| muscle.tendon_length_m < 0.0).map(|names| {
            format!("fibres are longer than the whole path, so that there is no tendon: {names}; look at `length_range` and `range`")
        });
        [lax, idle, short].into_iter().flatten().collect()
    }
}

/// Moment arms over each coordinate, of the muscles that have the greatest, all other coordinates in the middle of their ranges: the name
/// of the coordinate with its plot. Coordinates that no muscle moves have none.
pub fn moment_arm_plots(model: &Model, plan: &Plan<f64>) -> Vec<(String, Plot)> {
    let middle = plan.pose(|_, dof| dof.range.map_or(0.0, |[lo, hi]| 0.5 * (lo + hi)));
    // Muscles move a free body by nothing but its joints.
    let coordinates = plan.dofs.iter().enumerate().filter(|(_, dof)| dof.kind == DofKind::Joint);
    coordinates.filter_map(|(k, dof)| Some((dof.name.clone(), moment_arm_plot(model, plan, k, &middle)?))).collect()
}

fn moment_arm_plot(model: &Model, plan: &Plan<f64>, k: usize, middle: &[f64]) -> Option<Plot> {
    let dof = &plan.dofs[k];
    let [lo, hi] = dof.range.unwrap_or(UNLIMITED);
    let angles: Vec<f64> = (0..ANGLES).map(|n| lo + (hi - lo) * n as f64 / (ANGLES - 1) as f64).collect();
    let at = |&angle: &f64| {
        let mut pose = middle.to_vec();
        pose[dof.at] = angle;
        Isometric::at(plan, &pose)
    };
    let all: Vec<Isometric> = angles.iter().map(at).collect();
    let arm = |muscle: usize, n: usize| all[n].muscles[muscle].moment_arms[k];
    let greatest = |muscle: usize| (0..ANGLES).map(|n| arm(muscle, n).abs()).fold(0.0, f64::max);
    let mut muscles: Vec<(usize, f64)> = (0..plan.nmuscle()).map(|muscle| (muscle, greatest(muscle))).collect();
    muscles.retain(|(_, greatest)| *greatest > NO_ARM);
    muscles.sort_by(|a, b| b.1.total_cmp(&a.1));
    muscles.truncate(DRAWN);
    let series = muscles.iter().map(|&(muscle, _)| PlotSeries {
        name: model.muscles[muscle].name.clone(),
        points: vec![],
        line: angles.iter().enumerate().map(|(n, angle)| [angle.to_degrees(), 100.0 * arm(muscle, n)]).collect(),
    });
    (!muscles.is_empty()).then(|| Plot {
        title: format!("Greatest moment arms over {}", dof.name),
        axes: [format!("{} (degrees)", dof.name), "moment arm (cm), positive where it pulls up".into()],
        series: series.collect(),
    })
}

fn unlooked_at((muscle, own): (&myo_model::model::Muscle, &myo_muscle::Muscle<f64>)) -> MuscleAnatomy {
    let gain = &muscle.parameters.gain;
    let [scale, offset] = own.curves.fibre_length(gain);
    MuscleAnatomy {
        name: muscle.name.clone(),
        optimal_length_m: scale.recip(),
        tendon_length_m: -offset / scale,
        force_n: own.curves.peak_isometric_force(),
        fibre: [f64::INFINITY, f64::NEG_INFINITY],
        pulls: [gain.lmin, gain.lmax],
        cannot_pull: 0.0,
        moves: None,
    }
}

fn widen(range: &mut [f64; 2], x: f64) {
    *range = [range[0].min(x), range[1].max(x)];
}

/// A random pose within the limits of all joints.
fn pose(plan: &Plan<f64>, number: u32) -> Vec<f64> {
    let word = <f64 as Scalar>::Word::splat;
    let draw = |dof: usize| {
        let [env, stream, zero] = [word(number), word(dof as u32), word(0)];
        unit::<f64>(philox::<f64>(Counter { seed: seed_words(1), env, episode: zero, step: zero, stream })[0])
    };
    plan.pose(|k, dof| {
        let [lo, hi] = dof.range.unwrap_or(UNLIMITED);
        lo + (hi - lo) * draw(k)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use myo_dynamics::CouplingMode;
    use myo_model::builtin;

    fn anatomy(change: impl FnOnce(&mut myo_model::ModelDescription)) -> Anatomy {
        let mut description = builtin("myo-arm").unwrap();
        change(&mut description);
        let model = Model::new(&description).unwrap();
        Anatomy::of(&model, &Plan::exact(&model, CouplingMode::Reduced).unwrap())
    }

    fn muscle<'a>(anatomy: &'a Anatomy, name: &str) -> &'a MuscleAnatomy {
        anatomy.muscles.iter().find(|muscle| muscle.name == name).unwrap()
    }

    #[test]
    fn an_arm_is_as_long_as_a_mans_and_its_muscles_move_their_joints() {
        let arm = anatomy(|_| ());
        let [near, far] = arm.distance_m;
        assert!(near < 0.35 && (0.65..0.85).contains(&far), "{near} {far}");
        let brachialis = muscle(&arm, "BRA");
        let (joint, moment_arm) = brachialis.moves.clone().unwrap();
        assert!(joint == "elbow_flexion" && (0.015..0.04).contains(&moment_arm), "{joint} {moment_arm}");
        // What the arm was made of has no more than 5.8 cm.
        assert!(
            (0.05..0.12).contains(&brachialis.optimal_length_m) && brachialis.tendon_length_m > 0.0,
            "{brachialis:?}"
        );
        assert!(arm.muscles.iter().all(|muscle| muscle.moves.is_some()), "{:?}", arm.warnings());
    }

    #[test]
    fn what_no_body_has_is_told() {
        let lame = anatomy(|arm| {
            let bra = arm.muscles.iter_mut().find(|muscle| muscle.name == "BRA").unwrap();
            // A path of twice the length that it has.
            bra.parameters.length_range = bra.parameters.length_range.map(|x| 2.0 * x);
            let other = arm.muscles.iter_mut().find(|muscle| muscle.name == "DELT1").unwrap();
            let last = other.path.last().unwrap().clone();
            other.path = vec![last.clone(), last];
        });
        let warnings = lame.warnings();
        assert!(
            warnings.iter().any(|one| one.contains("too short or too long to pull") && one.contains("BRA")),
            "{warnings:?}"
        );
        assert!(warnings.iter().any(|one| one.starts_with("no joint is moved by DELT1;")), "{warnings:?}");
    }

    #[test]
    fn moment_arms_are_drawn() {
        let model = Model::new(&builtin("mobl-arms").unwrap()).unwrap();
        let plan = Plan::exact(&model, CouplingMode::Reduced).unwrap();
        let plots = moment_arm_plots(&model, &plan);
        let (_, elbow) = plots.iter().find(|(name, _)| name == "elbow_flexion").unwrap();
        assert!(elbow.series.len() == DRAWN && elbow.series.iter().all(|series| series.line.len() == ANGLES));
        assert!(elbow.svg().unwrap().contains("elbow_flexion"));
    }
}
