//! Hill-type muscle: activation dynamics, force-length-velocity curves, motor noise, fatigue, metabolic power.
//!
//! [`MuscleParameters`] is what a person writes; [`Muscle`] is the same with every quotient worked out, in the precision
//! of the numbers that run on it. The functions are generic over [`myo_scalar::Scalar`] and have no branches that depend
//! on the state.
//!
//! ```
//! use myo_muscle::{CurveParameters, Muscle, MuscleParameters};
//! let curve = CurveParameters {
//!     range: [0.75, 1.05], force: Some(500.0), scale: 200.0,
//!     lmin: 0.5, lmax: 1.6, vmax: 1.5, fpmax: 1.3, fvmax: 1.2,
//! };
//! let parameters = MuscleParameters {
//!     length_range: [0.1, 0.2], gain: curve.clone(), bias: curve,
//!     tau_act: 0.01, tau_deact: 0.04, tau_smooth: 0.0, ctrl_range: [0.0, 1.0], group: None,
//! };
//! let muscle = Muscle::<f64>::new(&parameters, 1.0);
//! // At optimal length, standing still, fully active: the peak isometric force, pulling.
//! let optimal = 0.1 + (1.0 - 0.75) / (1.05 - 0.75) * 0.1;
//! assert!((muscle.force(optimal, 0.0, 1.0) + 500.0_f64).abs() < 1e-9);
//! ```
//!
//! This crate does not know tendon paths, bodies or time steps. It has no tendon elasticity and no pennation, and of what a muscle is made of no
//! more than its force and length tell: half of all fibres are taken to be slow.

mod curves;
mod fatigue;
mod metabolism;
mod noise;
mod parameters;

pub use curves::{ActivationDynamics, ForceCurves, Muscle};
pub use fatigue::{Endurance, Fatigue, FatigueRates, MuscleGroup, left_of};
pub use metabolism::{MetabolicPower, Metabolism};
pub use noise::{CONSTANT_NOISE, MotorNoise, SIGNAL_DEPENDENT_NOISE, noisy_excitation};
pub use parameters::{CurveParameters, MuscleParameters};
