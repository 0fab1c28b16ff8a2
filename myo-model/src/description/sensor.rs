//! What is measured of a body.

use crate::error::ElementKind;
#[cfg(feature = "files")]
use schemars::JsonSchema;
#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

/// A sensor: numbers that tell what a body does, for whoever asks. It has no part in the simulation.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Sensor {
    /// Unique name.
    pub name: String,
    /// What it measures.
    pub measures: Measure<String>,
    /// Greatest size of each of its numbers; 0 is any. Orientations and axes have none.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "is_any"))]
    pub cutoff: f64,
}

#[cfg(feature = "files")]
fn is_any(cutoff: &f64) -> bool {
    *cutoff == 0.0
}

/// What a sensor measures, of elements by name (in a description) or by index (in a model).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "snake_case", deny_unknown_fields))]
#[cfg_attr(feature = "files", schemars(rename = "Measure"))]
pub enum Measure<N> {
    /// Sum of the normal forces (N) of contacts of the body of a site, in the shape of the site or where a line from the contact out of the body
    /// meets it.
    Touch(N),
    /// How a site turns (rad/s), in its own axes.
    Gyro(N),
    /// How a site moves (m/s), in its own axes.
    Velocimeter(N),
    /// A number of a hinge or slide, or position and velocity of a ball joint: a quaternion, and three rates.
    Joint {
        /// The joint.
        of: N,
        /// What of it.
        quantity: JointQuantity,
    },
    /// A number of a muscle and its tendon.
    Muscle {
        /// The muscle.
        of: N,
        /// What of it.
        quantity: MuscleQuantity,
    },
    /// Place and motion of a frame.
    Frame {
        /// The frame.
        of: Frame<N>,
        /// What of it.
        quantity: FrameQuantity,
        /// The frame in which it is seen; the world without one.
        #[cfg_attr(feature = "files", serde(skip_serializing_if = "Option::is_none"))]
        seen_from: Option<Frame<N>>,
    },
    /// Of a body and all that hangs on it.
    Subtree {
        /// The body.
        of: N,
        /// What of it.
        quantity: SubtreeQuantity,
    },
}

/// What there is to measure of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "snake_case"))]
pub enum JointQuantity {
    /// Its position (rad or m; a quaternion).
    Position,
    /// Its rate (rad/s or m/s).
    Velocity,
    /// What all muscles together do to it (N m or N).
    MuscleForce,
    /// How far it is within its limit (rad or m), negative beyond; 0 while it is not beyond.
    LimitDistance,
    /// How fast it gets back to its limit (rad/s or m/s); 0 while it is not beyond.
    LimitVelocity,
    /// What its limit does to it (N m or N).
    LimitForce,
}

/// What there is to measure of a muscle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "snake_case"))]
pub enum MuscleQuantity {
    /// Length of its path (m).
    Length,
    /// How fast that grows (m/s).
    Velocity,
    /// Its force (N), negative where it pulls.
    Force,
    /// How far its tendon is within its limit, less the margin (m); 0 while it is not beyond.
    LimitDistance,
    /// How fast it gets back to its limit (m/s); 0 while it is not beyond.
    LimitVelocity,
    /// The force of its limit (N).
    LimitForce,
}

/// A frame that is fixed to a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "snake_case", deny_unknown_fields))]
#[cfg_attr(feature = "files", schemars(rename = "Frame"))]
pub enum Frame<N> {
    /// That of a body.
    Body(N),
    /// Centre of mass and principal axes of a body.
    Centre(N),
    /// That of a collision shape.
    Geom(N),
    /// That of what muscles run over.
    Wrap(N),
    /// That of a site.
    Site(N),
}

/// What there is to measure of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "snake_case"))]
pub enum FrameQuantity {
    /// Where it is (m).
    Position,
    /// How it is turned (w, x, y, z).
    Orientation,
    /// Its x axis.
    XAxis,
    /// Its y axis.
    YAxis,
    /// Its z axis.
    ZAxis,
    /// How it moves (m/s).
    Velocity,
    /// How it turns (rad/s).
    AngularVelocity,
}

/// What there is to measure of a body and all that hangs on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "snake_case"))]
pub enum SubtreeQuantity {
    /// Its centre of mass (m).
    Centre,
    /// How that moves (m/s).
    Velocity,
}

impl FrameQuantity {
    /// Whether it tells how a frame is turned, as numbers of no unit.
    pub fn is_turn(self) -> bool {
        matches!(self, Self::Orientation | Self::XAxis | Self::YAxis | Self::ZAxis)
    }
}

impl JointQuantity {
    /// Whether only joints with limits have it.
    pub fn is_of_limit(self) -> bool {
        matches!(self, Self::LimitDistance | Self::LimitVelocity | Self::LimitForce)
    }
}

impl MuscleQuantity {
    /// Whether only tendons with limits have it.
    pub fn is_of_limit(self) -> bool {
        matches!(self, Self::LimitDistance | Self::LimitVelocity | Self::LimitForce)
    }
}

impl<N> Measure<N> {
    /// The same of elements that are told otherwise.
    pub(crate) fn try_map<M, E>(
        &self,
        mut element: impl FnMut(ElementKind, &N) -> Result<M, E>,
    ) -> Result<Measure<M>, E> {
        Ok(match self {
            Self::Touch(site) => Measure::Touch(element(ElementKind::Site, site)?),
            Self::Gyro(site) => Measure::Gyro(element(ElementKind::Site, site)?),
            Self::Velocimeter(site) => Measure::Velocimeter(element(ElementKind::Site, site)?),
            Self::Joint { of, quantity } => {
                Measure::Joint { of: element(ElementKind::Joint, of)?, quantity: *quantity }
            }
            Self::Muscle { of, quantity } => {
                Measure::Muscle { of: element(ElementKind::Muscle, of)?, quantity: *quantity }
            }
            Self::Frame { of, quantity, seen_from } => Measure::Frame {
                of: of.try_map(&mut element)?,
                quantity: *quantity,
                seen_from: seen_from.as_ref().map(|frame| frame.try_map(&mut element)).transpose()?,
            },
            Self::Subtree { of, quantity } => {
                Measure::Subtree { of: element(ElementKind::Body, of)?, quantity: *quantity }
            }
        })
    }
}

impl<N> Frame<N> {
    fn try_map<M, E>(&self, element: &mut impl FnMut(ElementKind, &N) -> Result<M, E>) -> Result<Frame<M>, E> {
        Ok(match self {
            Self::Body(body) => Frame::Body(element(ElementKind::Body, body)?),
            Self::Centre(body) => Frame::Centre(element(ElementKind::Body, body)?),
            Self::Geom(geom) => Frame::Geom(element(ElementKind::Geom, geom)?),
            Self::Wrap(wrap) => Frame::Wrap(element(ElementKind::Wrap, wrap)?),
            Self::Site(site) => Frame::Site(element(ElementKind::Site, site)?),
        })
    }
}
