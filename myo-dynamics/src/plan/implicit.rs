//! What an implicit step needs to know of muscles.

use super::Plan;
use super::coordinates::Coordinates;
use super::elimination::inertial;
use myo_model::Model;
use myo_model::description::{Integrator, JointKind};
use myo_model::model::Joint;
use std::collections::BTreeSet;

/// Parts of a unit vector that are less are rounding, as MuJoCo has it.
const ALIGNED: f64 = 1e-14;

/// A muscle whose force at the end of a step counts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImplicitMuscle {
    /// Coordinates that change its length.
    pub dofs: Vec<usize>,
    /// Pairs of these, the greater one first, that feel each other's inertia: MuJoCo knows no others.
    pub pairs: Vec<[usize; 2]>,
}

impl ImplicitMuscle {
    /// Of the coordinates along its path, in a plan whose mass matrix is known.
    pub(super) fn of(dofs: Vec<usize>, plan: &Plan<f64>) -> Self {
        let own = dofs.iter().map(|&dof| [dof, dof]);
        let felt = inertial(plan).map(|(a, b)| [a.max(b), a.min(b)]).filter(|pair| !plan.apart.contains(pair));
        let all: BTreeSet<[usize; 2]> =
            own.chain(felt.filter(|pair| pair.iter().all(|dof| dofs.contains(dof)))).collect();
        Self { dofs, pairs: all.into_iter().collect() }
    }
}

/// Pairs of coordinates of bodies whose mass matrix MuJoCo knows to be diagonal: for its `implicitfast` these have nothing in common.
pub(super) fn apart(model: &Model, coordinates: &Coordinates) -> Vec<[usize; 2]> {
    if model.options.integrator != Integrator::ImplicitFast {
        return vec![];
    }
    let simple = (1..model.bodies.len()).filter(|&body| is_simple(model, body));
    let pairs = simple.flat_map(|body| {
        let joints = model.joints.iter().zip(&coordinates.joints).filter(move |(joint, _)| joint.body == body);
        let dofs: Vec<usize> = joints.flat_map(|(_, own)| own.dofs()).collect();
        let pairs = dofs.iter().flat_map(|&a| dofs.iter().map(move |&b| [a, b]));
        pairs.filter(|[a, b]| a > b).collect::<Vec<_>>()
    });
    pairs.collect()
}

/// Whether a body stands on the world and carries nothing, and moves along and then about its principal axes, through its centre of mass. Of free bodies
/// MuJoCo knows all entries.
fn is_simple(model: &Model, number: usize) -> bool {
    let (body, bodies) = (&model.bodies[number], &model.bodies);
    let moves = |body: usize| model.joints.iter().any(|joint| joint.body == body);
    let on_world = body.parent == 0 || (bodies[body.parent].parent == 0 && !moves(body.parent));
    let carries = bodies.iter().skip(1).any(|other| other.parent == number);
    let joints: Vec<&Joint> = model.joints.iter().filter(|joint| joint.body == number).collect();
    let along_axis = |joint: &Joint| joint.axis.iter().filter(|part| part.abs() > ALIGNED).count() == 1;
    let fits = |(k, joint): (usize, &&Joint)| match joint.kind {
        JointKind::Free => false,
        _ if joint.pos.norm() > 0.0 => false,
        JointKind::Slide => along_axis(joint),
        JointKind::Hinge => along_axis(joint) && k + 1 == joints.len(),
        JointKind::Ball => k + 1 == joints.len(),
    };
    let is_centred = body.com.norm() == 0.0 && body.inertia_quat.angle() == 0.0;
    on_world && !carries && is_centred && joints.iter().enumerate().all(fits)
}
