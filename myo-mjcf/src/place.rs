//! Where something stands: file, line and column, and the element it belongs to.

use std::fmt;
use std::sync::Arc;

/// A place in a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The file, as the path that [`Files`](crate::Files) knows it by.
    pub file: Arc<str>,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// An element of a file, as errors tell it: `arm.xml:12:5: <geom name="ulna">`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spot {
    /// Where it stands, or its attribute that the error is about.
    pub place: Place,
    /// Its tag.
    pub tag: String,
    /// Its name, if it has one.
    pub name: Option<String>,
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.name {
            Some(name) => write!(f, "{}: <{} name=\"{name}\">", self.place, self.tag),
            None => write!(f, "{}: <{}>", self.place, self.tag),
        }
    }
}

/// Kinds of elements that have names; names of one kind differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum Kind {
    Body,
    Frame,
    Joint,
    Geom,
    Site,
    Camera,
    Light,
    Mesh,
    HeightField,
    Texture,
    Material,
    Model,
    Pair,
    Exclude,
    Equality,
    Tendon,
    Actuator,
    Sensor,
    Numeric,
    Text,
    Tuple,
    Key,
    Class,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Body => "body",
            Self::Frame => "frame",
            Self::Joint => "joint",
            Self::Geom => "geom",
            Self::Site => "site",
            Self::Camera => "camera",
            Self::Light => "light",
            Self::Mesh => "mesh",
            Self::HeightField => "height field",
            Self::Texture => "texture",
            Self::Material => "material",
            Self::Model => "model",
            Self::Pair => "pair",
            Self::Exclude => "exclude",
            Self::Equality => "equality constraint",
            Self::Tendon => "tendon",
            Self::Actuator => "actuator",
            Self::Sensor => "sensor",
            Self::Numeric => "numeric",
            Self::Text => "text",
            Self::Tuple => "tuple",
            Self::Key => "key",
            Self::Class => "default class",
        })
    }
}
