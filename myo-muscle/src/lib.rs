//! Hill-type muscle: activation dynamics, force-length-velocity curves, motor noise.
mod parameters;

pub use parameters::{CurveParameters, MuscleParameters};
