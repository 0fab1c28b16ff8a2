//! The tree that reading gives.

use crate::elements::*;
use crate::place::Place;

/// A model: what its files say after includes, classes, frames, copies and attached models.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Mjcf {
    /// The name of the model.
    pub model: Option<String>,
    /// How the main file is read.
    pub compiler: Compiler,
    /// How length ranges are computed.
    pub length_range: LengthRange,
    /// How the model is simulated.
    pub option: Options,
    /// What is switched on and off.
    pub flags: Flags,
    /// Sizes of memory.
    pub sizes: Sizes,
    /// Typical sizes.
    pub statistic: Statistic,
    /// How the model is seen, not interpreted: `global`, `quality`, `headlight`, `map`, `scale`, `rgba`.
    pub visual: Vec<Raw>,
    /// Meshes.
    pub meshes: Vec<Mesh>,
    /// Height fields.
    pub height_fields: Vec<HeightField>,
    /// Textures.
    pub textures: Vec<Texture>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Bodies with their joints, geoms, sites, cameras and lights. Parents stand before their children, the world first,
    /// in the order of MuJoCo's body indices.
    pub bodies: Vec<Body>,
    /// Contacts that are asked for.
    pub pairs: Vec<Pair>,
    /// Contacts that are ruled out.
    pub excludes: Vec<Exclude>,
    /// Equality constraints.
    pub equalities: Vec<Equality>,
    /// Tendons.
    pub tendons: Vec<Tendon>,
    /// Actuators.
    pub actuators: Vec<Actuator>,
    /// Sensors.
    pub sensors: Vec<Sensor>,
    /// Stored states.
    pub keys: Vec<Key>,
    /// Numbers of the user.
    pub numerics: Vec<Numeric>,
    /// Texts of the user.
    pub texts: Vec<Text>,
    /// Lists of the user.
    pub tuples: Vec<Tuple>,
    /// What is valid but not read.
    pub refused: Vec<Refused>,
}

/// Something that MuJoCo reads and this crate does not. A model without it may be another model.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Refused {
    /// Its tag.
    pub element: String,
    /// Where it stands.
    pub place: Place,
    /// Why it is not read, and what would be right.
    pub why: String,
}

impl std::fmt::Display for Refused {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: <{}>: {}", self.place, self.element, self.why)
    }
}

impl Mjcf {
    /// Joints in the order of MuJoCo's indices, with the index of their body.
    pub fn joints(&self) -> impl Iterator<Item = (usize, &Joint)> {
        self.bodies.iter().enumerate().flat_map(|(index, body)| body.joints.iter().map(move |joint| (index, joint)))
    }

    /// Geoms in the order of MuJoCo's indices, with the index of their body.
    pub fn geoms(&self) -> impl Iterator<Item = (usize, &Geom)> {
        self.bodies.iter().enumerate().flat_map(|(index, body)| body.geoms.iter().map(move |geom| (index, geom)))
    }

    /// Sites in the order of MuJoCo's indices, with the index of their body.
    pub fn sites(&self) -> impl Iterator<Item = (usize, &Site)> {
        self.bodies.iter().enumerate().flat_map(|(index, body)| body.sites.iter().map(move |site| (index, site)))
    }

    /// Cameras in the order of MuJoCo's indices, with the index of their body.
    pub fn cameras(&self) -> impl Iterator<Item = (usize, &Camera)> {
        self.bodies.iter().enumerate().flat_map(|(index, body)| body.cameras.iter().map(move |camera| (index, camera)))
    }

    /// Lights in the order of MuJoCo's indices, with the index of their body.
    pub fn lights(&self) -> impl Iterator<Item = (usize, &Light)> {
        self.bodies.iter().enumerate().flat_map(|(index, body)| body.lights.iter().map(move |light| (index, light)))
    }
}
