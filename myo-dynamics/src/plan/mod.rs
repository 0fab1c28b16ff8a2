//! The plan: a model compiled into flat tables that one step walks from front to back.
//!
//! [`Plan::exact`] is the obvious compilation, every joint a link, every path segment two points. [`Plan::specialised`]
//! trades tables for cheaper ones that compute the same (see `specialise.rs`); tests compare the two.

mod build;
mod cast;
mod connections;
mod coordinates;
mod elimination;
mod error;
mod implicit;
mod mass;
mod movers;
mod pairs;
mod reference_pose;
mod sensors;
mod sets;
mod specialise;
mod unsymmetric;
mod wraps;

pub use connections::Connection;
pub use coordinates::{Ball, Dof, DofKind, Drive, Form, JointCoordinates};
pub use elimination::{Column, Elimination, Felt, Later};
pub use error::PlanError;
pub use implicit::ImplicitMuscle;
pub use movers::{Mover, Movers};
pub use pairs::{ContactPair, Part, PartForm};
pub use sensors::Sensors;
pub(crate) use sensors::{Feeling, Measured, Seen, Sensor, Turn};
pub use unsymmetric::{FeltBothWays, LaterBothWays, Unsymmetric, UnsymmetricColumn};

use crate::impedance::Impedance;
use crate::mesh::Hull;
use crate::polynomial::{Domain, Polynomial};
use crate::step::kinematics::joint_state;
use myo_model::description::SideRule;
use myo_muscle::Muscle;
use myo_scalar::{Real, Scalar};
use std::sync::Arc;

/// What becomes of joint couplings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum CouplingMode {
    /// Compiled away: the generalised coordinates are the independent joints.
    #[default]
    Reduced,
    /// Kept as MuJoCo's soft equality rows: the generalised coordinates are all joints.
    Soft,
}

/// A compiled model. Constants in precision `C`; lengths m, angles rad, masses kg. All positions are relative to the
/// origin O, the shoulder centre in the zero pose, in world axes unless a link's frame is named.
#[derive(Clone, Debug)]
pub struct Plan<C> {
    /// Physics time step (s).
    pub timestep: C,
    /// How many times as hard friction is as the normal force of a contact.
    pub impratio: C,
    /// Whether joint damping is integrated implicitly.
    pub implicit_damping: bool,
    /// Gravity in world axes (m/s^2).
    pub gravity: [C; 3],
    /// Position of O in the model's world (m): what to add to a position of this plan to get the model's.
    pub origin: [C; 3],
    /// Generalised coordinates, as many as there are rates.
    pub dofs: Vec<Dof<C>>,
    /// Where the place of the one free body begins in `qpos`, if everything is reckoned from there instead of from O: far from O, single precision
    /// would lose how light parts turn in the inertia of the whole. Exact plans reckon from O.
    pub carried: Option<usize>,
    /// Orientations, each of four positions and three rates.
    pub balls: Vec<Ball>,
    /// Positions in the pose of reference: joints at zero, free bodies where the model puts them.
    pub qpos0: Vec<C>,
    /// Moving frames, parents first; entry 0 is the world.
    pub links: Vec<Link<C>>,
    /// Screws beyond the one of each link: number `links.len() + k`.
    pub screws: Vec<Screw>,
    /// Mass carried by links.
    pub bodies: Vec<Body<C>>,
    /// Sets of links that move together under some screw, smaller sets first.
    pub sets: Vec<LinkSet>,
    /// Terms of the mass matrix.
    pub mass_terms: Vec<MassTerm>,
    /// Which entries of the mass matrix are not always zero, and in which order coordinates are eliminated.
    pub elimination: Elimination,
    /// The same of a matrix whose halves differ, where steps take Coriolis forces implicitly (MuJoCo's `implicit`); else none.
    pub unsymmetric: Option<Unsymmetric>,
    /// Which wrench does work on which screw.
    pub projections: Vec<Projection>,
    /// Joints whose coupling is not linear: their passive forces do not fold into [`Dof`].
    pub curved_joints: Vec<CurvedJoint<C>>,
    /// Coordinates that profiles are functions of.
    pub profiled: Vec<ProfiledCoordinate<C>>,
    /// Kinetic and potential energy of links that move with one coordinate.
    pub energy_profiles: Vec<EnergyProfile<C>>,
    /// Muscles and their paths.
    pub tendons: Tendons<C>,
    /// Muscle curves.
    pub muscles: Vec<Muscle<C>>,
    /// Of each muscle what an implicit step asks; none where steps are explicit.
    pub implicit_muscles: Vec<ImplicitMuscle>,
    /// Pairs of coordinates, the greater one first, which no muscle ties together in such steps.
    pub apart: Vec<[usize; 2]>,
    /// Whether the time constants of any muscle's activation blend.
    pub smooth_activation: bool,
    /// Joint limits.
    pub limits: Vec<Limit<C>>,
    /// Limits of tendons.
    pub tendon_limits: Vec<TendonLimit<C>>,
    /// Couplings kept as constraints.
    pub equalities: Vec<Equality<C>>,
    /// Bodies that are held together.
    pub connections: Vec<Connection<C>>,
    /// The point that points and presses.
    pub fingertip: Point<C>,
    /// Elbow and wrist, where they were asked for, see [`Plan::with_arm`].
    pub arm: Option<[Point<C>; 2]>,
    /// Other fingers, where they were asked for, see [`Plan::with_fingers`].
    pub fingers: Vec<Point<C>>,
    /// The spheres that press: that at the fingertip first, then those of other fingers, as far as the model has any.
    pub contact_spheres: Vec<ContactSphere<C>>,
    /// Parts of the body that do not pass through each other.
    pub pairs: Vec<ContactPair<C>>,
    /// Convex meshes of these.
    pub hulls: Vec<Arc<Hull>>,
    /// Where each joint of the model finds its position.
    pub joints: Vec<JointCoordinates<C>>,
    /// For drawing: where the model's elements are. Only exact plans have them; specialised ones drop links.
    pub elements: Elements<C>,
}

/// Places of the model's elements, in the model's order.
#[derive(Clone, Debug, Default)]
pub struct Elements<C> {
    /// Frame of each body, the world's first.
    pub bodies: Vec<FixedFrame<C>>,
    /// Each site.
    pub sites: Vec<Point<C>>,
    /// Each of what muscles run over.
    pub wraps: Vec<FixedFrame<C>>,
}

/// A moving frame.
#[derive(Clone, Debug)]
pub struct Link<C> {
    /// The link it is attached to.
    pub parent: usize,
    /// How it moves.
    pub motion: LinkMotion<C>,
    /// Its joint position.
    pub drive: Drive<C>,
    /// Per coordinate: the screw that this link moves along when the coordinate changes.
    pub screw_of_dof: Vec<Option<usize>>,
}

/// How a link moves against its parent.
#[derive(Clone, Debug)]
pub enum LinkMotion<C> {
    /// It does not: the world.
    Fixed,
    /// It turns about its own z axis.
    Hinge(Placement<C>),
    /// It slides along its own z axis.
    Slide(Placement<C>),
    /// It turns as a quaternion says, as far as this is known before its last axis: three links in a row are a ball joint, and all three
    /// are turned as the last one.
    Ball(BallAxis<C>),
    /// Its pose in the world is a function of one coordinate.
    Profile(Box<PoseProfile<C>>),
}

/// One of the three links of a ball joint.
#[derive(Clone, Debug)]
pub struct BallAxis<C> {
    /// Frame of the unturned joint, in that of the link before all three.
    pub placement: Placement<C>,
    /// Where its quaternion begins in `qpos`.
    pub at: usize,
    /// The axis, from 0.
    pub axis: usize,
}

/// Frame of a link at joint position zero, in its parent's frame.
#[derive(Clone, Debug)]
pub struct Placement<C> {
    /// Origin.
    pub offset: [C; 3],
    /// Axes as columns; none if parallel to the parent's.
    pub axes: Option<[[C; 3]; 3]>,
}

/// A coordinate that drives whole links through polynomials (profiles). They are fitted a little past the coordinate's
/// limits and followed far past them; farther out everything that they describe stands still: poses and lengths keep their
/// values and have no rate, inertia stays, and neither gravity nor muscle forces act through them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfiledCoordinate<C> {
    /// The coordinate.
    pub dof: usize,
    /// Which entry of `qpos` is its position.
    pub at: usize,
    /// Its interval.
    pub domain: Domain<C>,
}

/// Pose, screw and rate of the screw as polynomials in one coordinate.
#[derive(Clone, Debug)]
pub struct PoseProfile<C> {
    /// The coordinate, as an index of [`Plan::profiled`].
    pub coordinate: usize,
    /// The first two axes as columns, the third being their vector product; none if they never turn.
    pub axes: Option<[[Polynomial<C>; 3]; 2]>,
    /// Origin.
    pub position: [Polynomial<C>; 3],
    /// Motion per unit of speed: angular, linear at O.
    pub screw: [[Polynomial<C>; 3]; 2],
    /// Its derivative with respect to the coordinate.
    pub screw_rate: [[Polynomial<C>; 3]; 2],
}

/// The motion of further links when a coordinate drives several joints in a row: `parent + slope * screw of link`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Screw {
    /// The screw of the coordinate before this joint.
    pub parent: Option<usize>,
    /// The joint that adds to it.
    pub link: usize,
}

/// Mass carried by a link, in the link's frame.
#[derive(Clone, Debug)]
pub struct Body<C> {
    /// The link.
    pub link: usize,
    /// Mass (kg).
    pub mass: C,
    /// Centre of mass (m).
    pub com: [C; 3],
    /// Inertia about it (kg m^2): the same about every axis,
    pub isotropic: C,
    /// plus `a a^T` of these vectors (kg^(1/2) m), along two of the principal axes.
    pub arms: [[C; 3]; 2],
}

/// Links that share a screw: their inertias and wrenches are summed once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkSet {
    /// Smaller sets that it contains.
    pub sets: Vec<usize>,
    /// Links in none of those.
    pub links: Vec<usize>,
}

/// One column of products: `M[a, column] += screw_a . (I_set screw)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MassTerm {
    /// Whose inertia.
    pub set: usize,
    /// Screw that is accelerated.
    pub screw: usize,
    /// Its coordinate.
    pub column: usize,
    /// Screws and coordinates that feel it.
    pub rows: Vec<(usize, usize)>,
}

/// `tau[dof] += screw . (wrench of set)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Projection {
    /// The coordinate.
    pub dof: usize,
    /// Its screw.
    pub screw: usize,
    /// The links that move along it.
    pub set: usize,
}

/// Passive forces of a joint with a curved coupling.
#[derive(Clone, Debug)]
pub struct CurvedJoint<C> {
    /// Its position.
    pub drive: Drive<C>,
    /// Spring (N m/rad).
    pub stiffness: C,
    /// Its rest position.
    pub spring_ref: C,
    /// Damper.
    pub damping: C,
    /// Added inertia.
    pub armature: C,
}

/// Links that move with one coordinate only, seen through their energy.
#[derive(Clone, Debug)]
pub struct EnergyProfile<C> {
    /// The coordinate, as an index of [`Plan::profiled`].
    pub coordinate: usize,
    /// Inertia felt by the coordinate.
    pub inertia: Polynomial<C>,
    /// Torque per squared speed: half the derivative of the inertia.
    pub centrifugal: Polynomial<C>,
    /// Torque that balances gravity.
    pub weight: Polynomial<C>,
}

/// A point fixed to a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<C> {
    /// The link.
    pub link: usize,
    /// Position in its frame.
    pub position: [C; 3],
}

/// A frame fixed to a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedFrame<C> {
    /// Its origin.
    pub origin: Point<C>,
    /// Its axes as columns, in the link's frame.
    pub axes: [[C; 3]; 3],
}

/// Paths of all muscles, sorted by how a segment's length is computed. What is said to be of a muscle may be of a [branch](Branch): their numbers follow those
/// of muscles.
#[derive(Clone, Debug)]
pub struct Tendons<C> {
    /// Length that never changes, per muscle and then per branch (m).
    pub constant: Vec<C>,
    /// Branches behind pulleys.
    pub branches: Vec<Branch<C>>,
    /// Points that segments run through.
    pub points: Vec<Point<C>>,
    /// Straight segments, grouped by the links they join.
    pub pairs: Vec<SegmentPair>,
    /// Segments across one hinge.
    pub hinge: Vec<HingeSegment<C>>,
    /// Segments across two hinges in a row.
    pub double_hinge: Vec<DoubleHingeSegment<C>>,
    /// Segments whose length depends on one coordinate through several joints.
    pub profiles: Vec<ProfileSegment<C>>,
    /// Stretches that may bend round something, grouped by the code that finds their ways.
    pub wraps: Vec<Bundle<C>>,
}

/// Part of a muscle's path that counts another time: what is behind a pulley.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<C> {
    /// The muscle.
    pub muscle: usize,
    /// How much of its length counts, and how much of the muscle's force pulls along it.
    pub share: C,
}

/// A tendon whose length is limited.
#[derive(Clone, Debug, PartialEq)]
pub struct TendonLimit<C> {
    /// Its muscle.
    pub muscle: usize,
    /// Coordinates that may change its length.
    pub dofs: Vec<usize>,
    /// Shortest and longest length (m).
    pub range: [C; 2],
    /// Distance (m) from either at which the force begins.
    pub margin: C,
    /// Softness.
    pub impedance: Impedance<C>,
    /// Inverse inertia that the tendon feels in the reference pose (1/kg).
    pub diagonal: C,
}

/// What a path may bend round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoundShape {
    /// A sphere.
    Sphere,
    /// A cylinder about its z axis, without ends.
    Cylinder,
}

/// A sphere or cylinder that paths may bend round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundThing<C> {
    /// Its centre and axes. Those of a sphere are its link's.
    pub frame: FixedFrame<C>,
    /// Its kind.
    pub shape: RoundShape,
    /// How a side tells the way around it.
    pub rule: SideRule,
    /// Its radius (m).
    pub radius: C,
}

/// How paths get past something round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Around it.
    Around,
    /// Through it.
    Through,
    /// As a moving point on the side tells.
    Either,
}

/// Stretches of paths that differ in numbers only. Round things that are passed around are all on one link.
#[derive(Clone, Debug)]
pub struct Bundle<C> {
    /// What they may bend round.
    pub shape: RoundShape,
    /// How sides tell ways around it.
    pub rule: SideRule,
    /// How.
    pub way: Way,
    /// Whether their first ends are on the links of the round things. Nothing then moves but the last ends.
    pub is_moored: bool,
    /// The stretches.
    pub stretches: Vec<Stretch<C>>,
}

/// A stretch of a path that may bend.
#[derive(Clone, Debug)]
pub struct Stretch<C> {
    /// The muscle.
    pub muscle: usize,
    /// What it may bend round.
    pub round: RoundThing<C>,
    /// Its ends. That on the link of the round thing comes first, if one is.
    pub ends: [Point<C>; 2],
    /// The first one from the centre of the round thing and in its axes (m), if it is fixed to the same link.
    pub local: Option<[C; 3]>,
    /// On which side it runs.
    pub side: Side<C>,
}

/// The side of a sphere or cylinder on which a path runs.
#[derive(Clone, Debug)]
pub enum Side<C> {
    /// The one with the shorter way.
    Any,
    /// That of a point, from the centre of the round thing and in its axes (m).
    Fixed([C; 3]),
    /// Through it, touching it from within.
    Inside,
    /// That of a point of another link; within the radius it asks for a way through.
    Moving(Point<C>),
}

/// Segments between two links.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SegmentPair {
    /// Link of the first points.
    pub a: usize,
    /// Link of the second points.
    pub b: usize,
    /// The segments.
    pub segments: Vec<Segment>,
}

/// A straight segment between two points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// The muscle.
    pub muscle: usize,
    /// First point.
    pub a: usize,
    /// Second point.
    pub b: usize,
}

/// A segment across one hinge: its squared length is `c0 + c1 cos + c2 sin`, exactly.
#[derive(Clone, Debug)]
pub struct HingeSegment<C> {
    /// The muscle.
    pub muscle: usize,
    /// The link behind the hinge.
    pub link: usize,
    /// Coefficients.
    pub square: [C; 3],
    /// Half of `c1` and `c2`, for the derivative.
    pub half: [C; 2],
}

/// A segment across two hinges in a row: its squared length is bilinear in (1, cos, sin) of both, exactly.
#[derive(Clone, Debug)]
pub struct DoubleHingeSegment<C> {
    /// The muscle.
    pub muscle: usize,
    /// The links behind the two hinges.
    pub links: [usize; 2],
    /// Coefficients; rows for the first hinge.
    pub square: [[C; 3]; 3],
}

/// A segment whose squared length is a polynomial in one coordinate.
#[derive(Clone, Debug)]
pub struct ProfileSegment<C> {
    /// The muscle.
    pub muscle: usize,
    /// The coordinate, as an index of [`Plan::profiled`].
    pub coordinate: usize,
    /// Squared length (m^2).
    pub square: Polynomial<C>,
    /// Half its derivative with respect to the coordinate.
    pub half_slope: Polynomial<C>,
}

/// A joint limit.
#[derive(Clone, Debug)]
pub struct Limit<C> {
    /// The joint.
    pub drive: Drive<C>,
    /// Bounds (rad or m).
    pub range: [C; 2],
    /// Softness.
    pub impedance: Impedance<C>,
    /// Inverse inertia of the joint in the reference pose, of the model with all joints.
    pub diagonal: C,
}

/// A coupling as a soft constraint: `q_dependent - p(q_independent) = 0`.
#[derive(Clone, Debug)]
pub struct Equality<C> {
    /// The coordinate that follows.
    pub dependent: usize,
    /// Which entry of `qpos` is its position.
    pub at: usize,
    /// What it follows.
    pub drive: Drive<C>,
    /// Softness.
    pub impedance: Impedance<C>,
    /// Inverse inertia of both joints in the reference pose.
    pub diagonal: C,
}

/// A sphere that presses boxes.
#[derive(Clone, Debug)]
pub struct ContactSphere<C> {
    /// Whose it is: 0, the fingertip's, or one more than the number of a [finger](Plan::fingers); of plans that were not asked for fingers, of one
    /// of the model's.
    pub finger: usize,
    /// Its centre.
    pub centre: Point<C>,
    /// Centre of mass of the model's body that it is fixed to: where `diagonal` is measured.
    pub body_com: Point<C>,
    /// Its radius (m).
    pub radius: C,
    /// Its contact margin (m).
    pub margin: f64,
    /// Its sliding friction.
    pub friction: f64,
    /// Its softness.
    pub softness: myo_model::description::Softness,
    /// Inverse mass in the reference pose, of the model with all joints (1/kg).
    pub diagonal: f64,
    /// Coordinates that move it.
    pub movers: Movers,
}

impl<C> Plan<C> {
    /// Number of generalised coordinates.
    pub fn ndof(&self) -> usize {
        self.dofs.len()
    }
    /// Number of positions: as many as coordinates, and one more for each orientation.
    pub fn nq(&self) -> usize {
        self.qpos0.len()
    }
    /// Number of rows that always hold: of couplings, then of connections.
    pub fn equality_rows(&self) -> usize {
        self.equalities.len() + self.connections.iter().map(Connection::rows).sum::<usize>()
    }
    /// Number of muscles.
    pub fn nmuscle(&self) -> usize {
        self.muscles.len()
    }
}

impl<C> Plan<C> {
    /// Whether all its coordinates are hinges and slides, as those of bodies that do tasks are.
    ///
    /// # Errors
    /// [`PlanError::NotHeld`] names the first that is not.
    pub fn check_held(&self) -> Result<(), PlanError> {
        let joint = |dof: &Dof<C>| dof.name.rsplit_once('_').map_or(&*dof.name, |(joint, _)| joint).to_owned();
        match self.dofs.iter().find(|dof| dof.kind != DofKind::Joint) {
            Some(dof) => Err(PlanError::NotHeld { joint: joint(dof) }),
            None => Ok(()),
        }
    }
}

impl Plan<f64> {
    /// A pose with these positions of hinges and slides; ball joints and free bodies are as in the pose of reference.
    pub fn pose(&self, position: impl Fn(usize, &Dof<f64>) -> f64) -> Vec<f64> {
        let mut pose = self.qpos0.clone();
        for (k, dof) in self.dofs.iter().enumerate().filter(|(_, dof)| dof.kind == DofKind::Joint) {
            pose[dof.at] = position(k, dof);
        }
        pose
    }
}

impl<C: Real> Plan<C> {
    /// Positions of all joints of the model, coupled ones included, in the model's order: MuJoCo's `qpos`.
    pub fn joint_positions<S: Scalar<Const = C>>(&self, qpos: &[S]) -> Vec<S> {
        let of = |joint: &JointCoordinates<C>| match joint {
            JointCoordinates::One(drive) => vec![joint_state(drive, qpos, &self.still()).position],
            JointCoordinates::Many { qpos: own, .. } => qpos[own.clone()].to_vec(),
        };
        self.joints.iter().flat_map(of).collect()
    }

    /// Rates of all joints of the model: MuJoCo's `qvel`.
    pub fn joint_rates<S: Scalar<Const = C>>(&self, qpos: &[S], qvel: &[S]) -> Vec<S> {
        let of = |joint: &JointCoordinates<C>| match joint {
            JointCoordinates::One(drive) => vec![joint_state(drive, qpos, qvel).rate],
            JointCoordinates::Many { qvel: own, .. } => qvel[own.clone()].to_vec(),
        };
        self.joints.iter().flat_map(of).collect()
    }

    /// No rates.
    fn still<S: Scalar<Const = C>>(&self) -> Vec<S> {
        vec![S::zero(); self.ndof()]
    }
}
