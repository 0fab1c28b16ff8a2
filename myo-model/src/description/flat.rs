//! The muscle as it stands in a file, all fields on one level.
//!
//! `#[serde(flatten)]` would do the same but reads through a buffer that forgets line and column.

use super::{PathElement, TendonLimit};
use myo_muscle::{CurveParameters, MuscleGroup, MuscleParameters};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A muscle-tendon actuator with a rigid tendon.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Muscle {
    /// Unique name.
    name: String,
    /// Sites that the path runs through, origin first, what it runs over between two of them, and pulleys where it divides.
    path: Vec<PathElement>,
    /// Lengths that the tendon does not leave, if it is limited.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    limit: Option<TendonLimit>,
    /// Shortest and longest tendon length (m) that the normalised operating `range` of the curves is stretched over.
    length_range: [f64; 2],
    /// Active force: force-length and force-velocity curve.
    gain: CurveParameters,
    /// Passive force; its parameters may differ from those of the active force.
    bias: CurveParameters,
    /// Time constant of activation (s) at an activation of 1/3.
    tau_act: f64,
    /// Time constant of deactivation (s) at an activation of 1/3.
    tau_deact: f64,
    /// Width (in units of excitation) over which the time constant blends from one to the other; 0 switches.
    #[serde(default)]
    tau_smooth: f64,
    /// Lower and upper bound of the control (neural excitation), usually 0 and 1.
    #[serde(default = "unit_range")]
    ctrl_range: [f64; 2],
    /// Which joint it moves, as far as fatigue differs; without, it tires as muscles of all joints do together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    group: Option<MuscleGroup>,
}

impl From<Muscle> for super::Muscle {
    fn from(flat: Muscle) -> Self {
        let Muscle { name, path, limit, length_range, gain, bias, tau_act, tau_deact, tau_smooth, ctrl_range, group } =
            flat;
        let parameters =
            MuscleParameters { length_range, gain, bias, tau_act, tau_deact, tau_smooth, ctrl_range, group };
        Self { name, path, limit, parameters }
    }
}

impl From<super::Muscle> for Muscle {
    fn from(muscle: super::Muscle) -> Self {
        let super::Muscle { name, path, limit, parameters } = muscle;
        let MuscleParameters { length_range, gain, bias, tau_act, tau_deact, tau_smooth, ctrl_range, group } =
            parameters;
        Self { name, path, limit, length_range, gain, bias, tau_act, tau_deact, tau_smooth, ctrl_range, group }
    }
}

fn unit_range() -> [f64; 2] {
    [0.0, 1.0]
}
