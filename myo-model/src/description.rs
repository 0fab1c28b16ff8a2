//! The model as a person writes it: a plain typed tree, element names instead of indices.

use crate::size::Anthropometry;
#[cfg(feature = "files")]
use garde::Validate;
use myo_muscle::MuscleParameters;
#[cfg(feature = "files")]
use schemars::{JsonSchema, Schema, SchemaGenerator};
#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};
#[cfg(feature = "files")]
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::str::FromStr;

mod connection;
#[cfg(feature = "files")]
mod flat;
mod path;
mod sensor;

pub use connection::{Connection, Weld};
pub use path::{Over, PathElement, Pulley};
pub use sensor::{Frame, FrameQuantity, JointQuantity, Measure, MuscleQuantity, Sensor, SubtreeQuantity};

/// A whole model file.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema, Validate))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
#[cfg_attr(feature = "files", garde(allow_unvalidated))]
pub struct ModelDescription {
    /// Version of this file format; the current one is 1.
    pub version: u32,
    /// Short name, for example `mobl-arms`.
    pub name: String,
    /// Where the figures come from (paper with DOI).
    pub source: String,
    /// Solver options.
    #[cfg_attr(feature = "files", garde(dive))]
    pub options: Options,
    /// Names of the elements that tasks refer to.
    pub landmarks: Landmarks,
    /// Whose body it is; without it, it cannot be made as large as somebody else.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub anthropometry: Option<Anthropometry>,
    /// In what it was changed for a person, in words; empty for a model as it stands in its file.
    #[cfg_attr(feature = "files", serde(skip))]
    pub changes: String,
    /// Rigid bodies, parents before children.
    #[cfg_attr(feature = "files", garde(dive))]
    pub bodies: Vec<Body>,
    /// Joints, in the order in which they act along each body.
    #[cfg_attr(feature = "files", garde(dive))]
    pub joints: Vec<Joint>,
    /// Joints that follow another joint (or stand still).
    #[cfg_attr(feature = "files", serde(default))]
    pub couplings: Vec<Coupling>,
    /// Bodies that are held together.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub connections: Vec<Connection>,
    /// Points fixed to bodies: via points of muscles and landmarks.
    #[cfg_attr(feature = "files", serde(default))]
    pub sites: Vec<Site>,
    /// Collision shapes fixed to bodies. Those that no contact names touch the boxes of a task.
    #[cfg_attr(feature = "files", serde(default))]
    #[cfg_attr(feature = "files", garde(dive))]
    pub geoms: Vec<Geom>,
    /// Parts of the body that do not pass through each other; all others do.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub contacts: Vec<Contact>,
    /// What muscle paths may run over.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub wraps: Vec<Wrap>,
    /// Muscle-tendon actuators.
    #[cfg_attr(feature = "files", serde(default))]
    #[cfg_attr(feature = "files", garde(dive))]
    pub muscles: Vec<Muscle>,
    /// Convex meshes that geoms have for a shape.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub hulls: Vec<Hull>,
    /// What is measured.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub sensors: Vec<Sensor>,
    /// What is seen of bodies, where more is known than their bones.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub looks: Vec<Look>,
}

/// Solver options.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema, Validate))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
#[cfg_attr(feature = "files", garde(allow_unvalidated))]
pub struct Options {
    /// Physics time step (s).
    #[cfg_attr(feature = "files", garde(range(min = 1e-5, max = 0.02)))]
    pub timestep: f64,
    /// Gravitational acceleration in world axes (m/s^2).
    pub gravity: [f64; 3],
    /// How time steps are made.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Integrator::is_default"))]
    pub integrator: Integrator,
    /// Whether joint damping is integrated implicitly (MuJoCo's `eulerdamp`); `implicitfast` and `implicit` always do.
    pub implicit_joint_damping: bool,
    /// The shape of the cone in which forces of parts of the body that touch are. Boxes of a task are pressed with pyramids.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Cone::is_default"))]
    pub cone: Cone,
    /// How many times as hard friction is as the normal force of a contact (MuJoCo's `impratio`).
    #[cfg_attr(feature = "files", serde(default = "one", skip_serializing_if = "is_one"))]
    pub impratio: f64,
    /// How side sites tell which way a muscle path takes around a wrap.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "SideRule::is_default"))]
    pub side_rule: SideRule,
}

/// How time steps are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "lowercase"))]
pub enum Integrator {
    /// New velocities with forces as they are, then positions with these.
    #[default]
    Euler,
    /// The same, with forces of muscles and dampers as they become with the new velocities: MuJoCo's `implicitfast`.
    ImplicitFast,
    /// The same with Coriolis and centrifugal forces, too, as they become with the new velocities: MuJoCo's `implicit`.
    Implicit,
}

#[cfg(feature = "files")]
impl Integrator {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// The cone of forces that a contact can have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "lowercase"))]
pub enum Cone {
    /// A pyramid with two opposite edges for each direction.
    #[default]
    Pyramidal,
    /// A cone over an ellipse, as Coulomb's friction has it.
    Elliptic,
}

#[cfg(feature = "files")]
impl Cone {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// How the side site of a muscle path tells which way the path takes around a sphere or cylinder. MuJoCo changed that in 4.0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
pub enum SideRule {
    /// As in MuJoCo since 4.0: the way that the line from its one end by the side site to its other end takes.
    #[default]
    #[cfg_attr(feature = "files", serde(rename = "mujoco4"))]
    Mujoco4,
    /// As in MuJoCo before 4.0: past the side site, as soon as the straight line is nearest to the middle on its other side. There
    /// lengths jump.
    #[cfg_attr(feature = "files", serde(rename = "mujoco3"))]
    Mujoco3,
}

impl FromStr for SideRule {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "mujoco4" => Ok(Self::Mujoco4),
            "mujoco3" => Ok(Self::Mujoco3),
            _ => Err(format!("no rule of sides is `{text}`; there are `mujoco4` and `mujoco3`")),
        }
    }
}

impl SideRule {
    #[cfg(feature = "files")]
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Names of the elements that tasks refer to.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Landmarks {
    /// Site that points and presses.
    pub fingertip: String,
    /// Body whose origin in the zero pose is the origin of target coordinates (the shoulder centre).
    pub shoulder: String,
    /// Body whose origin is the elbow; rays from the forearm ask for it.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub elbow: Option<String>,
    /// Body whose origin is the wrist; rays ask for it.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub wrist: Option<String>,
    /// Sites of other fingers, by the names that tasks have for them, such as `thumb`; at most four.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "BTreeMap::is_empty"))]
    pub fingers: BTreeMap<String, String>,
}

impl Landmarks {
    /// A site that points, and a body that is the origin of target coordinates; nothing else.
    pub fn new(fingertip: &str, shoulder: &str) -> Self {
        let (fingertip, shoulder) = (fingertip.to_owned(), shoulder.to_owned());
        Self { fingertip, shoulder, elbow: None, wrist: None, fingers: BTreeMap::new() }
    }
}

/// A rigid body; its frame is placed in its parent's frame.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema, Validate))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
#[cfg_attr(feature = "files", garde(allow_unvalidated))]
pub struct Body {
    /// Unique name; `world` is reserved for the fixed root.
    pub name: String,
    /// Parent body, or `world`.
    pub parent: String,
    /// Position of the body frame in the parent's frame (m).
    pub pos: [f64; 3],
    /// Orientation of the body frame in the parent's frame (w, x, y, z).
    #[cfg_attr(feature = "files", serde(default = "identity_quat"))]
    pub quat: [f64; 4],
    /// Mass (kg).
    #[cfg_attr(feature = "files", garde(range(min = 0.0)))]
    pub mass: f64,
    /// Centre of mass in the body frame (m).
    #[cfg_attr(feature = "files", serde(default))]
    pub com: [f64; 3],
    /// Principal moments of inertia about the centre of mass (kg m^2).
    pub inertia: [f64; 3],
    /// Orientation of the principal axes in the body frame (w, x, y, z).
    #[cfg_attr(feature = "files", serde(default = "identity_quat"))]
    pub inertia_quat: [f64; 4],
}

/// What a joint lets its body do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "lowercase"))]
pub enum JointKind {
    /// Rotation about `axis` through `pos` (rad).
    Hinge,
    /// Translation along `axis` (m).
    Slide,
    /// Any rotation about `pos`, as a quaternion.
    Ball,
    /// Any motion of a body on the world: its place there, and its orientation.
    Free,
}

impl JointKind {
    /// How many numbers tell the position of such a joint, and how many its rate.
    pub fn sizes(self) -> [usize; 2] {
        match self {
            Self::Hinge | Self::Slide => [1, 1],
            Self::Ball => [4, 3],
            Self::Free => [7, 6],
        }
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hinge => "hinge",
            Self::Slide => "slide",
            Self::Ball => "ball",
            Self::Free => "free",
        }
    }

    /// Whether one number tells its position.
    pub fn is_scalar(self) -> bool {
        self.sizes() == [1, 1]
    }
}

/// A joint between a body and its parent.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema, Validate))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
#[cfg_attr(feature = "files", garde(allow_unvalidated))]
pub struct Joint {
    /// Unique name.
    pub name: String,
    /// The body that moves.
    pub body: String,
    /// Kind of motion.
    pub kind: JointKind,
    /// Unit axis in the body frame, of hinges and slides.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "is_zero"))]
    pub axis: [f64; 3],
    /// Anchor in the body frame (m).
    #[cfg_attr(feature = "files", serde(default))]
    pub pos: [f64; 3],
    /// Lower and upper limit (rad or m), if limited.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub range: Option<[f64; 2]>,
    /// Spring stiffness (N m/rad or N/m).
    #[cfg_attr(feature = "files", serde(default))]
    #[cfg_attr(feature = "files", garde(range(min = 0.0)))]
    pub stiffness: f64,
    /// Joint position at which the spring is at rest.
    #[cfg_attr(feature = "files", serde(default))]
    pub spring_ref: f64,
    /// Damping (N m s/rad or N s/m).
    #[cfg_attr(feature = "files", serde(default))]
    #[cfg_attr(feature = "files", garde(range(min = 0.0)))]
    pub damping: f64,
    /// Inertia added to the joint (kg m^2 or kg).
    #[cfg_attr(feature = "files", serde(default))]
    #[cfg_attr(feature = "files", garde(range(min = 0.0)))]
    pub armature: f64,
    /// How soft the limit is.
    #[cfg_attr(feature = "files", serde(default))]
    pub softness: Softness,
}

/// MuJoCo's constraint softness: reference acceleration and impedance (documentation chapter "Solver parameters").
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Softness {
    /// Time constant (s) and damping ratio.
    pub solref: [f64; 2],
    /// Impedance at zero and at full width, width (m or rad), midpoint, power.
    pub solimp: [f64; 5],
}

impl Default for Softness {
    fn default() -> Self {
        Self { solref: [0.02, 1.0], solimp: [0.9, 0.95, 0.001, 0.5, 2.0] }
    }
}

/// `q_dependent = c0 + c1 q + c2 q^2 + c3 q^3 + c4 q^4` with `q` the independent joint (or constant `c0` without one).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Coupling {
    /// The joint that follows.
    pub dependent: String,
    /// The joint that leads.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub independent: Option<String>,
    /// Coefficients of the polynomial, constant first.
    pub polycoef: [f64; 5],
    /// How soft the coupling is when it is kept as a constraint.
    #[cfg_attr(feature = "files", serde(default))]
    pub softness: Softness,
}

/// A point fixed to a body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Site {
    /// Unique name.
    pub name: String,
    /// The body it is fixed to.
    pub body: String,
    /// Position in the body frame (m).
    pub pos: [f64; 3],
    /// Orientation in the body frame (w, x, y, z), which sensors see.
    #[cfg_attr(feature = "files", serde(default = "identity_quat", skip_serializing_if = "is_identity"))]
    pub quat: [f64; 4],
    /// Where it feels touch.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub shape: Option<Shape>,
}

/// Shape of a collision geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "lowercase", deny_unknown_fields))]
pub enum Shape {
    /// Sphere of a radius (m).
    Sphere {
        /// Radius (m).
        radius: f64,
    },
    /// Cylinder about the local z axis with half a ball on each end.
    Capsule {
        /// Radius (m).
        radius: f64,
        /// Half of the length (m) without the balls.
        half_length: f64,
    },
    /// Ellipsoid of three semi-axes (m).
    Ellipsoid {
        /// Semi-axes along the local axes (m).
        radii: [f64; 3],
    },
    /// Cylinder about the local z axis, with flat ends.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Half of its length (m).
        half_length: f64,
    },
    /// All that is below the local xy plane, without end.
    Plane,
    /// Box of three half sizes (m).
    Box {
        /// Half sizes along the local axes (m).
        half_size: [f64; 3],
    },
    /// Convex mesh.
    Mesh {
        /// Its place among the `hulls`, counted from 0.
        hull: usize,
        /// How much larger it is than that.
        #[cfg_attr(feature = "files", serde(default = "as_large"))]
        scale: f64,
    },
}

/// A collision shape fixed to a body.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema, Validate))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
#[cfg_attr(feature = "files", garde(allow_unvalidated))]
pub struct Geom {
    /// Unique name.
    pub name: String,
    /// The body it is fixed to, or `world`.
    pub body: String,
    /// Shape and size.
    pub shape: Shape,
    /// Position in the body frame (m).
    #[cfg_attr(feature = "files", serde(default))]
    pub pos: [f64; 3],
    /// Orientation in the body frame (w, x, y, z).
    #[cfg_attr(feature = "files", serde(default = "identity_quat"))]
    pub quat: [f64; 4],
    /// Distance (m) at which contact forces begin; the margins of a pair add up.
    #[cfg_attr(feature = "files", serde(default))]
    #[cfg_attr(feature = "files", garde(range(min = 0.0)))]
    pub margin: f64,
    /// Sliding, torsional and rolling friction; the greater of a pair holds.
    pub friction: [f64; 3],
    /// How soft contacts are; a pair takes the mean of both.
    #[cfg_attr(feature = "files", serde(default))]
    pub softness: Softness,
}

/// What is seen of a body: triangles that are fixed to it. It has no part in the simulation.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Look {
    /// The body it is fixed to.
    pub body: String,
    /// Position of its frame in the body frame (m).
    #[cfg_attr(feature = "files", serde(default))]
    pub pos: [f64; 3],
    /// Orientation of its frame in the body frame (w, x, y, z).
    #[cfg_attr(feature = "files", serde(default = "identity_quat"))]
    pub quat: [f64; 4],
    /// Unit of its points (m).
    pub step: f64,
    /// Its points in units of `step`: whole numbers of 16 bits, the lower byte first, three for each; in base 64.
    pub points: String,
    /// Its triangles: indices of three points each, of 16 bits without sign, the lower byte first, counter-clockwise as seen from outside; in base 64.
    pub faces: String,
}

/// A convex mesh. Numbers of its lists stand one after the other, the lowest byte first, in base 64.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Hull {
    /// Its corners: three numbers of 64 bits each (m).
    pub points: String,
    /// Triangles of its surface, each edge between two of them: numbers of three corners each, of 16 bits without sign, counter-clockwise as seen from
    /// outside.
    pub triangles: String,
    /// Polygons of triangles that lie nearly in one plane, as numbers of 16 bits without sign: how many corners there are, and these, counter-clockwise as
    /// seen from outside. Where several would do for a contact, the first counts.
    pub polygons: String,
}

/// Two geoms that do not pass through each other. Margin, friction and softness of the geoms themselves do not count.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Contact {
    /// Names of the two geoms.
    pub geoms: [String; 2],
    /// Distance (m) at which the contact force begins.
    #[cfg_attr(feature = "files", serde(default))]
    pub margin: f64,
    /// Sliding friction; 0 is none, as of contacts with MuJoCo's `condim` 1.
    pub friction: f64,
    /// Sliding friction along the second of two directions, where it is another. Which directions these are is MuJoCo's choice.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub friction_across: Option<f64>,
    /// Friction against twisting about the normal (m); 0 is none.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "is_none"))]
    pub torsional: f64,
    /// Friction against rolling about both directions (m), where there is some against twisting; zeros are none.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "are_none"))]
    pub rolling: [f64; 2],
    /// How soft the contact is.
    #[cfg_attr(feature = "files", serde(default))]
    pub softness: Softness,
}

/// Shape of what muscle paths run over.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "lowercase", deny_unknown_fields))]
pub enum WrapShape {
    /// Sphere of a radius (m).
    Sphere {
        /// Radius (m).
        radius: f64,
    },
    /// Cylinder about the local z axis. To muscles it has no ends.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Half of the length (m) that pictures show.
        #[cfg_attr(feature = "files", serde(default = "shown_half_length"))]
        half_length: f64,
    },
}

impl WrapShape {
    /// Radius (m).
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Sphere { radius } | Self::Cylinder { radius, .. } => radius,
        }
    }
}

/// A sphere or cylinder fixed to a body, which muscle paths may run over. It collides with nothing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Wrap {
    /// Unique name; no geom may have it either.
    pub name: String,
    /// The body it is fixed to, or `world`.
    pub body: String,
    /// Shape and size.
    pub shape: WrapShape,
    /// Position of its centre in the body frame (m).
    #[cfg_attr(feature = "files", serde(default))]
    pub pos: [f64; 3],
    /// Orientation in the body frame (w, x, y, z).
    #[cfg_attr(feature = "files", serde(default = "identity_quat"))]
    pub quat: [f64; 4],
}

/// Lengths that a tendon does not leave, whatever its muscle does: it is a string that comes tight, or a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct TendonLimit {
    /// Shortest and longest length (m).
    pub range: [f64; 2],
    /// Distance (m) from either at which the force begins.
    #[cfg_attr(feature = "files", serde(default))]
    pub margin: f64,
    /// How soft the limit is.
    #[cfg_attr(feature = "files", serde(default))]
    pub softness: Softness,
}

/// A muscle-tendon actuator. In a file, its parameters stand beside name and path.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "files", serde(from = "flat::Muscle", into = "flat::Muscle"))]
pub struct Muscle {
    /// Unique name.
    pub name: String,
    /// Sites that the path runs through, origin first, what it runs over between two of them, and pulleys where it divides.
    pub path: Vec<PathElement>,
    /// Lengths that the tendon does not leave, if it is limited.
    pub limit: Option<TendonLimit>,
    /// Activation and force curves.
    pub parameters: MuscleParameters,
}

#[cfg(feature = "files")]
impl Validate for Muscle {
    type Context = ();

    fn validate_into(&self, context: &(), parent: &mut dyn FnMut() -> garde::Path, report: &mut garde::Report) {
        self.parameters.validate_into(context, parent, report);
    }
}

#[cfg(feature = "files")]
impl JsonSchema for Muscle {
    fn schema_name() -> Cow<'static, str> {
        flat::Muscle::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        flat::Muscle::json_schema(generator)
    }
}

#[cfg(feature = "files")]
fn is_zero(vector: &[f64; 3]) -> bool {
    *vector == [0.0; 3]
}

#[cfg(feature = "files")]
fn is_none(number: &f64) -> bool {
    *number == 0.0
}

#[cfg(feature = "files")]
fn are_none(numbers: &[f64; 2]) -> bool {
    numbers.iter().all(is_none)
}

#[cfg(feature = "files")]
fn is_one(number: &f64) -> bool {
    *number == 1.0
}

#[cfg(feature = "files")]
fn one() -> f64 {
    1.0
}

#[cfg(feature = "files")]
fn shown_half_length() -> f64 {
    0.05
}

#[cfg(feature = "files")]
fn as_large() -> f64 {
    1.0
}

#[cfg(feature = "files")]
fn identity_quat() -> [f64; 4] {
    [1.0, 0.0, 0.0, 0.0]
}

#[cfg(feature = "files")]
fn is_identity(quat: &[f64; 4]) -> bool {
    *quat == identity_quat()
}
