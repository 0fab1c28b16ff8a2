//! Bodies that are held together.

use super::Softness;
#[cfg(feature = "files")]
use schemars::JsonSchema;
#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

/// Two bodies that are held together, softly: at a point, about which they may turn, or as one. What a tree of bodies cannot say: a
/// bar between two levers, a hand on a handle. MuJoCo's `connect` and `weld`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Connection {
    /// Names of the two bodies; one may be `world`.
    pub bodies: [String; 2],
    /// A point of each, in its own frame (m): these two coincide.
    pub anchors: [[f64; 3]; 2],
    /// How they are kept from turning against each other, if they are.
    #[cfg_attr(feature = "files", serde(default, skip_serializing_if = "Option::is_none"))]
    pub weld: Option<Weld>,
    /// How soft the connection is.
    #[cfg_attr(feature = "files", serde(default))]
    pub softness: Softness,
}

/// How two bodies are kept from turning against each other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Weld {
    /// Orientation of the second body in the frame of the first (w, x, y, z).
    pub quat: [f64; 4],
    /// Length (m) by which half an angle counts as a distance.
    #[cfg_attr(feature = "files", serde(default = "torque_scale"))]
    pub torque_scale: f64,
}

#[cfg(feature = "files")]
fn torque_scale() -> f64 {
    1.0
}
