//! The checked model: indices instead of names, parents before children, everything in f64.

use crate::description::{JointKind, Measure, Options, Shape, Softness, TendonLimit, WrapShape};
use myo_muscle::MuscleParameters;
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use std::sync::Arc;

/// Index of the fixed root in [`Model::bodies`].
pub const WORLD: usize = 0;

/// A model that can be simulated. Made from a description by [`Model::new`]; never changes afterwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Short name.
    pub name: String,
    /// In what it was changed for a person, in words; empty for a model as it stands in its file.
    pub changes: String,
    /// Stature (m) of the person, where the description tells it.
    pub stature_m: Option<f64>,
    /// Solver options.
    pub options: Options,
    /// Bodies, the world first, parents before children.
    pub bodies: Vec<Body>,
    /// Joints, sorted by body, in the order in which they act.
    pub joints: Vec<Joint>,
    /// Couplings, at most one per dependent joint.
    pub couplings: Vec<Coupling>,
    /// Bodies that are held together.
    pub connections: Vec<Connection>,
    /// Points fixed to bodies.
    pub sites: Vec<Site>,
    /// Collision shapes.
    pub geoms: Vec<Geom>,
    /// Pairs of collision shapes that do not pass through each other.
    pub contacts: Vec<Contact>,
    /// What muscle paths may run over.
    pub wraps: Vec<Wrap>,
    /// Muscles.
    pub muscles: Vec<Muscle>,
    /// Convex meshes that geoms have for a shape.
    pub hulls: Vec<Hull>,
    /// What is measured, in the order of the description.
    pub sensors: Vec<Sensor>,
    /// What is seen of bodies, in their order.
    pub looks: Vec<Look>,
    /// Index of the site that points and presses.
    pub fingertip_site: usize,
    /// Names of other fingers and indices of their sites, in alphabetical order.
    pub fingers: Vec<(String, usize)>,
    /// Index of the body whose origin in the zero pose is the origin of target coordinates.
    pub shoulder_body: usize,
    /// Index of the body whose origin is the elbow, where the description names one.
    pub elbow_body: Option<usize>,
    /// Index of the body whose origin is the wrist, where the description names one.
    pub wrist_body: Option<usize>,
}

impl Model {
    /// Where each body is in the world, with all joints at zero.
    pub fn frames_in_zero_pose(&self) -> Vec<Isometry3<f64>> {
        let mut frames: Vec<Isometry3<f64>> = Vec::with_capacity(self.bodies.len());
        // Parents come before their children, and the world before all.
        for Body { pos, quat, parent, .. } in &self.bodies {
            let on_parent = Isometry3::from_parts(Translation3::from(*pos), *quat);
            frames.push(frames.get(*parent).map_or(on_parent, |parent| parent * on_parent));
        }
        frames
    }

    /// Where the centre of the shoulder is, from the origin of the world, with all joints at zero (m).
    pub fn shoulder_in_zero_pose(&self) -> Vector3<f64> {
        self.frames_in_zero_pose()[self.shoulder_body].translation.vector
    }

    /// Collision shapes that touch the boxes of a task: those that no contact names.
    pub fn pressing_geoms(&self) -> impl Iterator<Item = &Geom> {
        let is_named = |geom: usize| self.contacts.iter().any(|contact| contact.geoms.contains(&geom));
        self.geoms.iter().enumerate().filter(move |(index, _)| !is_named(*index)).map(|(_, geom)| geom)
    }

    /// Whether the arm is a left one: its shoulder is to the left of the middle.
    pub fn has_left_arm(&self) -> bool {
        self.shoulder_in_zero_pose().y > 0.0
    }
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name.
    pub name: String,
    /// Index of the parent; the world is its own parent.
    pub parent: usize,
    /// Position in the parent's frame (m).
    pub pos: Vector3<f64>,
    /// Orientation in the parent's frame.
    pub quat: UnitQuaternion<f64>,
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass in the body frame (m).
    pub com: Vector3<f64>,
    /// Inertia about the centre of mass, in body axes (kg m^2).
    pub inertia: Matrix3<f64>,
    /// Principal moments (kg m^2) as written in the description.
    pub principal_inertia: Vector3<f64>,
    /// Orientation of the principal axes in the body frame.
    pub inertia_quat: UnitQuaternion<f64>,
}

/// A joint with one degree of freedom.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// Index of the body that moves.
    pub body: usize,
    /// Kind of motion.
    pub kind: JointKind,
    /// Unit axis in the body frame.
    pub axis: Vector3<f64>,
    /// Anchor in the body frame (m).
    pub pos: Vector3<f64>,
    /// Limits (rad or m), if limited.
    pub range: Option<[f64; 2]>,
    /// Spring stiffness.
    pub stiffness: f64,
    /// Rest position of the spring.
    pub spring_ref: f64,
    /// Damping.
    pub damping: f64,
    /// Added inertia.
    pub armature: f64,
    /// Softness of the limit.
    pub softness: Softness,
}

/// A joint that follows another one by a polynomial of degree four.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupling {
    /// Index of the joint that follows.
    pub dependent: usize,
    /// Index of the joint that leads; none for a joint held at `polycoef[0]`.
    pub independent: Option<usize>,
    /// Coefficients, constant first.
    pub polycoef: [f64; 5],
    /// Softness when kept as a constraint.
    pub softness: Softness,
}

/// Two bodies that are held together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// Indices of the bodies.
    pub bodies: [usize; 2],
    /// A point of each, in its frame (m), that coincide.
    pub anchors: [Vector3<f64>; 2],
    /// How they are kept from turning against each other, if they are.
    pub weld: Option<Weld>,
    /// Softness.
    pub softness: Softness,
}

/// How two bodies are kept from turning against each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weld {
    /// Orientation of the second body in the frame of the first.
    pub turn: UnitQuaternion<f64>,
    /// Length (m) by which half an angle counts as a distance.
    pub torque_scale: f64,
}

/// A point fixed to a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Site {
    /// Name.
    pub name: String,
    /// Index of the body.
    pub body: usize,
    /// Position in the body frame (m).
    pub pos: Vector3<f64>,
    /// Orientation in the body frame.
    pub quat: UnitQuaternion<f64>,
    /// Where it feels touch.
    pub shape: Option<Shape>,
}

/// A sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Name.
    pub name: String,
    /// What it measures, of elements by their indices.
    pub measures: Measure<usize>,
    /// Greatest size of each of its numbers; 0 is any.
    pub cutoff: f64,
}

/// What is seen of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Index of the body.
    pub body: usize,
    /// Position of its frame in the body frame (m).
    pub pos: Vector3<f64>,
    /// Orientation of its frame in the body frame.
    pub quat: UnitQuaternion<f64>,
    /// Unit of its points (m).
    pub step: f64,
    /// Its points, as [`description::Look`](crate::description::Look) has them.
    pub points: Arc<str>,
    /// Its triangles, the same.
    pub faces: Arc<str>,
}

/// A collision shape fixed to a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Geom {
    /// Name.
    pub name: String,
    /// Index of the body.
    pub body: usize,
    /// Shape and size.
    pub shape: Shape,
    /// Position in the body frame (m).
    pub pos: Vector3<f64>,
    /// Orientation in the body frame.
    pub quat: UnitQuaternion<f64>,
    /// Contact margin (m).
    pub margin: f64,
    /// Sliding, torsional, rolling friction.
    pub friction: [f64; 3],
    /// Softness of contacts.
    pub softness: Softness,
}

/// A convex mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    /// Its corners (m).
    pub points: Vec<Vector3<f64>>,
    /// Indices of three corners each, counter-clockwise as seen from outside.
    pub triangles: Vec<[usize; 3]>,
    /// Indices of the corners of polygons that triangles were merged into, counter-clockwise as seen from outside.
    pub polygons: Vec<Vec<usize>>,
}

/// Two collision shapes that do not pass through each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Indices of the geoms.
    pub geoms: [usize; 2],
    /// Distance (m) at which the contact force begins.
    pub margin: f64,
    /// What resists sliding along two directions, twisting (m) and rolling about both directions (m); zero where nothing does.
    pub friction: [f64; 5],
    /// Softness.
    pub softness: Softness,
}

impl Contact {
    /// How many dimensions its force has, as MuJoCo counts them: 1, 3, 4 or 6.
    pub fn condim(&self) -> usize {
        match self.friction {
            [0.0, ..] => 1,
            [_, _, 0.0, ..] => 3,
            [_, _, _, 0.0, _] => 4,
            _ => 6,
        }
    }
}

/// A sphere or cylinder (about its z axis, without ends) that muscle paths may run over.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrap {
    /// Name.
    pub name: String,
    /// Index of the body.
    pub body: usize,
    /// Shape and size.
    pub shape: WrapShape,
    /// Position of its centre in the body frame (m).
    pub pos: Vector3<f64>,
    /// Orientation in the body frame.
    pub quat: UnitQuaternion<f64>,
}

/// A stretch of a muscle path that may bend round something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Over {
    /// The stretch is the one from this element of the path to the next.
    pub after: usize,
    /// Index of what it bends round.
    pub wrap: usize,
    /// Index of the site on the side where it runs, if it is told.
    pub side: Option<usize>,
}

/// Where a tendon divides: a branch of its path that begins anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulley {
    /// The element of the path that the branch begins with; it goes as far as the next one, or to the end.
    pub before: usize,
    /// What its length is divided by.
    pub divisor: f64,
}

/// A muscle-tendon actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Muscle {
    /// Name.
    pub name: String,
    /// Indices of the sites on its path.
    pub path: Vec<usize>,
    /// Stretches of the path that may bend round something, at most one for each, in the order of the path.
    pub over: Vec<Over>,
    /// Where the tendon divides, in the order of the path.
    pub pulleys: Vec<Pulley>,
    /// Lengths that the tendon does not leave, if it is limited.
    pub limit: Option<TendonLimit>,
    /// Activation and force curves.
    pub parameters: MuscleParameters,
}

impl Muscle {
    /// Stretches of the path: each from the element of this number to the next, and the pulley before its branch, if there is one. Nothing leads from the end of a branch to
    /// the beginning of the next.
    pub fn stretches(&self) -> impl Iterator<Item = (usize, Option<&Pulley>)> {
        let pulley = |element: usize| self.pulleys.iter().rfind(|pulley| pulley.before <= element);
        let is_one = |&element: &usize| self.pulleys.iter().all(|pulley| pulley.before != element + 1);
        (0..self.path.len().saturating_sub(1)).filter(is_one).map(move |element| (element, pulley(element)))
    }
}
