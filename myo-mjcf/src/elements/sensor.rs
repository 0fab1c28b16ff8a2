//! Sensors: one table of attributes, and one of which sensor takes which.

use super::Interpolation;
use crate::place::Kind;
use crate::reading::{ToActuator, ToBody, ToCamera, ToGeom, ToJoint, ToMesh, ToSite, ToTendon};
use crate::table::table;
use crate::value::{Value, keywords, numbers};

keywords! {
    /// Elements with a place in space, and what stands for it.
    pub enum FrameObject {
        /// A body, at its centre of mass.
        Body = "body",
        /// A body, at its origin.
        XBody = "xbody",
        /// A geom.
        Geom = "geom",
        /// A site.
        Site = "site",
        /// A camera.
        Camera = "camera",
    }

    /// When a user's sensor is computed.
    pub enum Stage {
        /// Never.
        None = "none",
        /// After positions.
        Position = "pos",
        /// After velocities.
        Velocity = "vel",
        /// After accelerations.
        Acceleration = "acc",
    }

    /// What numbers of a user's sensor are.
    pub enum DataKind {
        /// Any numbers.
        Real = "real",
        /// Not negative.
        Positive = "positive",
        /// A unit vector.
        Axis = "axis",
        /// A unit quaternion.
        Quaternion = "quaternion",
    }
}

table! {
    /// A sensor. Which attributes it may have depends on its kind.
    pub struct Sensor {
        own {
            /// Its name.
            name: String;
            /// Samples that are kept.
            nsample: i32 = 0;
            /// What stands between them.
            interp: Interpolation = Interpolation::Hold;
            /// Delay (s).
            delay: f64 = 0.0;
            /// Period (s) and phase of measurement.
            interval: Interval;
            /// Greatest value; 0 is any.
            cutoff: f64 = 0.0;
            /// Standard deviation of noise, which MuJoCo does not add.
            noise: f64 = 0.0;
            /// Numbers of the user.
            user: Vec<f64>;
            /// The name of the site.
            site: String as ToSite;
            /// The name of the joint.
            joint: String as ToJoint;
            /// The name of the tendon.
            tendon: String as ToTendon;
            /// The name of the actuator.
            actuator: String as ToActuator;
            /// The name of the body.
            body: String as ToBody;
            /// The name of the camera.
            camera: String as ToCamera;
            /// The name of the geom.
            geom: String as ToGeom;
            /// The name of the mesh.
            mesh: String as ToMesh;
            /// What `objname` is.
            objtype: String;
            /// The name of what is measured.
            objname: String;
            /// What `refname` is.
            reftype: String;
            /// The name of that in whose axes it is measured.
            refname: String;
            /// The name of the first geom.
            geom1: String as ToGeom;
            /// The name of the second geom.
            geom2: String as ToGeom;
            /// The name of the first body.
            body1: String as ToBody;
            /// The name of the second body.
            body2: String as ToBody;
            /// The name of the body on top of the first subtree.
            subtree1: String as ToBody;
            /// The name of the body on top of the second subtree.
            subtree2: String as ToBody;
            /// How many contacts are told.
            num: i32 = 1;
            /// What is told, as words.
            data: String;
            /// Which contacts are told, as a word.
            reduce: String;
            /// Whether all of the object must be inside.
            enclosed: bool = false;
            /// How many numbers it gives.
            dim: i32 = 0;
            /// When it is computed.
            needstage: Stage = Stage::Acceleration;
            /// What its numbers are.
            datatype: DataKind = DataKind::Real;
        }
        plus {
            /// Its kind, which is its tag.
            kind: &'static str;
        }
    }
}

/// Period (s) of a sensor, and the phase of its first measurement if the file gives one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Period (s).
    pub period: f64,
    /// Phase (s).
    pub phase: Option<f64>,
}

impl Value for Interval {
    fn read(text: &str) -> Result<Self, crate::value::Fault> {
        match numbers(text)?[..] {
            [period] => Ok(Self { period, phase: None }),
            [period, phase] => Ok(Self { period, phase: Some(phase) }),
            ref found => {
                let expected = crate::value::Count { least: 1, most: 2 };
                Err(crate::value::Fault::Count { found: found.len(), expected })
            }
        }
    }

    fn write(&self) -> String {
        self.phase.map_or(self.period.to_string(), |phase| format!("{} {phase}", self.period))
    }
}

/// The kind of element that an `objtype` or `reftype` stands for.
pub(crate) fn object_kind(word: &str) -> Option<Kind> {
    Some(match word {
        "body" | "xbody" => Kind::Body,
        "joint" | "dof" => Kind::Joint,
        "geom" => Kind::Geom,
        "site" => Kind::Site,
        "camera" => Kind::Camera,
        "light" => Kind::Light,
        "mesh" => Kind::Mesh,
        "hfield" => Kind::HeightField,
        "texture" => Kind::Texture,
        "material" => Kind::Material,
        "pair" => Kind::Pair,
        "exclude" => Kind::Exclude,
        "equality" => Kind::Equality,
        "tendon" => Kind::Tendon,
        "actuator" => Kind::Actuator,
        "sensor" => Kind::Sensor,
        "numeric" => Kind::Numeric,
        "text" => Kind::Text,
        "tuple" => Kind::Tuple,
        "key" => Kind::Key,
        _ => return None,
    })
}

/// Which attributes a kind of sensor takes beside those of all.
pub(crate) struct SensorKind {
    pub tag: &'static str,
    pub required: &'static [&'static str],
    pub optional: &'static [&'static str],
}

const COMMON: &[&str] = &["name", "nsample", "interp", "delay", "interval", "cutoff", "noise", "user"];

impl SensorKind {
    pub fn takes(&self, attribute: &str) -> bool {
        let common: &[_] = match self.tag {
            "user" => &["name", "cutoff", "noise", "user"],
            // It has no noise.
            "tactile" => &["name", "nsample", "interp", "delay", "interval", "cutoff", "user"],
            _ => COMMON,
        };
        [common, self.required, self.optional].iter().any(|names| names.contains(&attribute))
    }
}

const NOTHING: &[&str] = &[];
const REFERENCE: &[&str] = &["reftype", "refname"];
const TWO_BODIES: &[&str] = &["geom1", "geom2", "body1", "body2"];
const CONTACT: &[&str] = &["geom1", "geom2", "body1", "body2", "subtree1", "subtree2", "site", "num", "data", "reduce"];

macro_rules! sensor_kinds {
    ($( $required:tt, $optional:expr => $($tag:ident)|+ ; )*) => {
        /// All kinds of sensors that are read.
        pub(crate) const SENSOR_KINDS: &[SensorKind] = &[ $( $( sensor_kinds!(@one $tag $required, $optional), )+ )* ];
    };
    (@one $tag:ident [$($required:ident)*], $optional:expr) => {
        SensorKind { tag: stringify!($tag), required: &[$( stringify!($required) ),*], optional: $optional }
    };
}

// What must be there, what may, and for which sensors.
sensor_kinds! {
    [site], NOTHING => touch | accelerometer | velocimeter | gyro | force | torque | magnetometer;
    [site camera], NOTHING => camprojection;
    [], &["site", "camera", "data"] => rangefinder;
    [joint], NOTHING => jointpos | jointvel | jointactuatorfrc | jointlimitpos | jointlimitvel | jointlimitfrc;
    [joint], NOTHING => ballquat | ballangvel;
    [tendon], NOTHING => tendonpos | tendonvel | tendonactuatorfrc | tendonlimitpos | tendonlimitvel | tendonlimitfrc;
    [actuator], NOTHING => actuatorpos | actuatorvel | actuatorfrc;
    [objtype objname], REFERENCE => framepos | framequat | framexaxis | frameyaxis | framezaxis;
    [objtype objname], REFERENCE => framelinvel | frameangvel;
    [objtype objname], NOTHING => framelinacc | frameangacc;
    [body], NOTHING => subtreecom | subtreelinvel | subtreeangmom;
    [site objtype objname], &["enclosed"] => insidesite;
    [], TWO_BODIES => distance | normal | fromto;
    [], CONTACT => contact;
    [], NOTHING => e_potential | e_kinetic | clock;
    [geom mesh], NOTHING => tactile;
    [dim], &["objtype", "objname", "needstage", "datatype"] => user;
}
