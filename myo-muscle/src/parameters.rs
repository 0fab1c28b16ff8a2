//! Named muscle parameters, as a person writes them in a model file.

use crate::fatigue::MuscleGroup;
#[cfg(feature = "serde")]
use garde::Validate;
#[cfg(feature = "serde")]
use schemars::JsonSchema;
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// One muscle-tendon actuator with a rigid tendon: everything but its path.
///
/// The parametrisation is MuJoCo's `muscle` actuator (documentation chapter "Muscles"), with names instead of
/// positions in an array. Lengths in metres, times in seconds, forces in newtons.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize, JsonSchema, Validate))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[cfg_attr(feature = "serde", garde(allow_unvalidated))]
pub struct MuscleParameters {
    /// Shortest and longest tendon length (m) that the normalised operating `range` of the curves is stretched over.
    pub length_range: [f64; 2],
    /// Active force: force-length and force-velocity curve.
    #[cfg_attr(feature = "serde", garde(dive))]
    pub gain: CurveParameters,
    /// Passive force; its parameters may differ from those of the active force.
    #[cfg_attr(feature = "serde", garde(dive))]
    pub bias: CurveParameters,
    /// Time constant of activation (s) at an activation of 1/3.
    #[cfg_attr(feature = "serde", garde(range(min = 1e-4, max = 10.0)))]
    pub tau_act: f64,
    /// Time constant of deactivation (s) at an activation of 1/3.
    #[cfg_attr(feature = "serde", garde(range(min = 1e-4, max = 10.0)))]
    pub tau_deact: f64,
    /// Width (in units of excitation) over which the time constant blends from one to the other; 0 switches.
    #[cfg_attr(feature = "serde", serde(default))]
    #[cfg_attr(feature = "serde", garde(range(min = 0.0, max = 1.0)))]
    pub tau_smooth: f64,
    /// Lower and upper bound of the control (neural excitation), usually 0 and 1.
    #[cfg_attr(feature = "serde", serde(default = "unit_range"))]
    pub ctrl_range: [f64; 2],
    /// Which joint it moves, as far as fatigue differs; without, it tires as muscles of all joints do together.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub group: Option<MuscleGroup>,
}

/// Parameters of one pair of force curves (dimensionless unless said).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize, JsonSchema, Validate))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[cfg_attr(feature = "serde", garde(allow_unvalidated))]
pub struct CurveParameters {
    /// Normalised fibre length at the two ends of `length_range`, in units of the optimal length.
    pub range: [f64; 2],
    /// Peak isometric force (N); if absent it is `scale / acc0`, where `acc0` is the norm of the joint
    /// acceleration that one newton of this muscle causes in the reference pose.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub force: Option<f64>,
    /// Numerator of the automatic force.
    #[cfg_attr(feature = "serde", garde(range(min = 0.0)))]
    pub scale: f64,
    /// Normalised length below which the active force is zero.
    pub lmin: f64,
    /// Normalised length above which the active force is zero.
    pub lmax: f64,
    /// Greatest shortening speed, optimal lengths per second.
    #[cfg_attr(feature = "serde", garde(range(min = 1e-6)))]
    pub vmax: f64,
    /// Scale of the passive force, in units of the peak isometric force: half of it is reached midway between optimal
    /// length and `lmax`, one and a half times it at `lmax`.
    #[cfg_attr(feature = "serde", garde(range(min = 0.0)))]
    pub fpmax: f64,
    /// Active force at saturating lengthening speed, in units of the peak isometric force.
    #[cfg_attr(feature = "serde", garde(range(min = 1.0)))]
    pub fvmax: f64,
}

#[cfg(feature = "serde")]
fn unit_range() -> [f64; 2] {
    [0.0, 1.0]
}
