//! From joints to generalised coordinates: which numbers tell where a joint is, and which passive forces act along them.

use super::{CouplingMode, CurvedJoint};
use myo_model::Model;
use myo_model::description::JointKind;
use myo_model::model::{Body, Coupling, Joint};
use std::ops::Range;

/// A joint that is a coordinate itself.
const IDENTITY: [f64; 5] = [0.0, 1.0, 0.0, 0.0, 0.0];

/// A generalised coordinate and the passive forces that are linear in it:
/// `tau = -(stiffness * q + spring_torque) - damping * qvel`.
#[derive(Clone, Debug)]
pub struct Dof<C> {
    /// Name of the joint; of one with several coordinates with `_tx`, `_ty`, `_tz` (along the axes of the world) or `_rx`, `_ry`, `_rz`
    /// (about those of the body).
    pub name: String,
    /// What it is.
    pub kind: DofKind,
    /// Which entry of `qpos` is its position; of a turn the first of four.
    pub at: usize,
    /// Limits of the joint, if limited (rad).
    pub range: Option<[C; 2]>,
    /// Sum of springs (N m/rad).
    pub stiffness: C,
    /// Torque of the springs at zero (N m).
    pub spring_torque: C,
    /// Sum of dampers (N m s/rad).
    pub damping: C,
    /// Sum of armatures (kg m^2).
    pub armature: C,
}

/// What a coordinate is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DofKind {
    /// A hinge or slide.
    Joint,
    /// A place of a free body along an axis of the world.
    Place,
    /// A turn of a ball joint or free body about an axis of the body.
    Turn,
}

/// An orientation (w, x, y, z) and its rate (rad/s) in the turned axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ball {
    /// The first of four entries of `qpos`.
    pub at: usize,
    /// The first of three coordinates.
    pub dof: usize,
}

/// Where a joint of the model finds its position.
#[derive(Clone, Debug, PartialEq)]
pub enum JointCoordinates<C> {
    /// In one number, which a coordinate is or drives.
    One(Drive<C>),
    /// In several, of a ball or free joint.
    Many {
        /// Entries of `qpos`.
        qpos: Range<usize>,
        /// Coordinates.
        qvel: Range<usize>,
    },
}

/// A joint position as a function of a generalised coordinate: `p(q)`, or constant without one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive<C> {
    /// The coordinate.
    pub dof: Option<usize>,
    /// Which entry of `qpos` is its position.
    pub at: usize,
    /// Coefficients, constant first.
    pub poly: [C; 5],
    /// What the polynomial amounts to.
    pub form: Form,
}

/// The simplest form of a polynomial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `q`.
    Identity,
    /// `c0 + c1 q`.
    Linear,
    /// Anything else.
    Curved,
}

/// Generalised coordinates of a model.
pub(super) struct Coordinates {
    /// Where each joint of the model finds its position.
    pub joints: Vec<JointCoordinates<f64>>,
    /// One for each rate.
    pub dofs: Vec<Dof<f64>>,
    /// Orientations.
    pub balls: Vec<Ball>,
    /// Positions in the model's pose of reference.
    pub qpos0: Vec<f64>,
}

impl Coordinates {
    pub(super) fn of(model: &Model, coupling: CouplingMode) -> Self {
        let followed = |joint: usize| match coupling {
            CouplingMode::Reduced => model.couplings.iter().find(|c| c.dependent == joint),
            CouplingMode::Soft => None,
        };
        let mut all = Self { joints: vec![], dofs: vec![], balls: vec![], qpos0: vec![] };
        let leaders: Vec<Option<JointCoordinates<f64>>> = model
            .joints
            .iter()
            .enumerate()
            .map(|(index, joint)| followed(index).is_none().then(|| all.add(joint, &model.bodies[joint.body])))
            .collect();
        let following = |coupling: &Coupling| {
            let leader = coupling.independent.and_then(|leader| leaders[leader].as_ref()?.drive());
            JointCoordinates::One(Drive::of(leader.and_then(Drive::place), coupling.polycoef))
        };
        all.joints = (0..model.joints.len())
            .map(|joint| match (followed(joint), &leaders[joint]) {
                (None, Some(leader)) => leader.clone(),
                (coupling, _) => following(coupling.expect("a joint leads or follows")),
            })
            .collect();
        all.add_passive_forces(model);
        all
    }

    /// Appends the coordinates of a joint that follows no other.
    fn add(&mut self, joint: &Joint, body: &Body) -> JointCoordinates<f64> {
        let start = [self.qpos0.len(), self.dofs.len()];
        match joint.kind {
            JointKind::Hinge | JointKind::Slide => {
                self.push(joint.name.clone(), DofKind::Joint, joint.range, 0.0);
                return JointCoordinates::One(Drive::of(Some((start[1], start[0])), IDENTITY));
            }
            JointKind::Ball => self.add_ball(&joint.name, [1.0, 0.0, 0.0, 0.0]),
            JointKind::Free => {
                for (axis, &at) in ["tx", "ty", "tz"].into_iter().zip(body.pos.iter()) {
                    self.push(format!("{}_{axis}", joint.name), DofKind::Place, None, at);
                }
                self.add_ball(&joint.name, [body.quat.w, body.quat.i, body.quat.j, body.quat.k]);
            }
        }
        JointCoordinates::Many { qpos: start[0]..self.qpos0.len(), qvel: start[1]..self.dofs.len() }
    }

    fn push(&mut self, name: String, kind: DofKind, range: Option<[f64; 2]>, position: f64) {
        let at = self.qpos0.len();
        self.dofs.push(Dof { name, kind, at, range, ..Dof::unloaded() });
        self.qpos0.push(position);
    }

    fn add_ball(&mut self, name: &str, quaternion: [f64; 4]) {
        let at = self.qpos0.len();
        self.balls.push(Ball { at, dof: self.dofs.len() });
        for axis in ["rx", "ry", "rz"] {
            self.dofs.push(Dof { name: format!("{name}_{axis}"), kind: DofKind::Turn, at, ..Dof::unloaded() });
        }
        self.qpos0.extend(quaternion);
    }

    /// Adds the passive forces of all joints that are coordinates or follow them linearly.
    fn add_passive_forces(&mut self, model: &Model) {
        for (joint, coordinates) in model.joints.iter().zip(&self.joints) {
            match coordinates {
                JointCoordinates::Many { qvel, .. } => {
                    for dof in &mut self.dofs[qvel.clone()] {
                        (dof.damping, dof.armature) = (joint.damping, joint.armature);
                    }
                }
                JointCoordinates::One(Drive { form: Form::Curved, .. }) => {}
                JointCoordinates::One(drive) => {
                    let Some(dof) = drive.dof else { continue };
                    let ([constant, slope, ..], dof) = (drive.poly, &mut self.dofs[dof]);
                    dof.stiffness += joint.stiffness * slope * slope;
                    dof.spring_torque += joint.stiffness * slope * (constant - joint.spring_ref);
                    dof.damping += joint.damping * slope * slope;
                    dof.armature += joint.armature * slope * slope;
                }
            }
        }
    }

    /// The joints that a curved coupling moves.
    pub(super) fn curved_joints(&self, model: &Model) -> Vec<CurvedJoint<f64>> {
        let curved = |drive: &&Drive<f64>| drive.form == Form::Curved && drive.dof.is_some();
        let joints = model.joints.iter().zip(&self.joints);
        let joints = joints.filter_map(|(joint, place)| Some((joint, place.drive().filter(curved)?)));
        joints
            .map(|(joint, &drive)| CurvedJoint {
                drive,
                stiffness: joint.stiffness,
                spring_ref: joint.spring_ref,
                damping: joint.damping,
                armature: joint.armature,
            })
            .collect()
    }
}

impl Drive<f64> {
    /// A polynomial in a coordinate: the number of its rate, and that of its position.
    pub(super) fn of(place: Option<(usize, usize)>, poly: [f64; 5]) -> Self {
        let form = match poly {
            IDENTITY => Form::Identity,
            [_, _, 0.0, 0.0, 0.0] => Form::Linear,
            _ => Form::Curved,
        };
        Self { dof: place.map(|(dof, _)| dof), at: place.map_or(0, |(_, at)| at), poly, form }
    }

    /// Its coordinate again.
    pub(super) fn place(&self) -> Option<(usize, usize)> {
        self.dof.map(|dof| (dof, self.at))
    }
}

impl Dof<f64> {
    /// Without a name, limits or forces.
    fn unloaded() -> Self {
        Self {
            name: String::new(),
            kind: DofKind::Joint,
            at: 0,
            range: None,
            stiffness: 0.0,
            spring_torque: 0.0,
            damping: 0.0,
            armature: 0.0,
        }
    }
}

impl<C> JointCoordinates<C> {
    /// How a hinge or slide moves.
    pub fn drive(&self) -> Option<&Drive<C>> {
        match self {
            Self::One(drive) => Some(drive),
            Self::Many { .. } => None,
        }
    }

    /// Coordinates that are this joint's own.
    pub(super) fn dofs(&self) -> Range<usize> {
        match self {
            Self::One(Drive { dof: Some(dof), form: Form::Identity, .. }) => *dof..dof + 1,
            Self::One(_) => 0..0,
            Self::Many { qvel, .. } => qvel.clone(),
        }
    }

    /// Whether anything moves it.
    pub(super) fn moves(&self) -> bool {
        self.drive().is_none_or(|drive| drive.dof.is_some())
    }
}
