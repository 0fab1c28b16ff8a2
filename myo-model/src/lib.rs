//! Musculoskeletal model: description, checks, the built-in arm, MJCF export.
//!
//! A [`ModelDescription`] is what a person writes: a tree of named elements, read from YAML. [`Model::new`] checks it and
//! resolves the names; a [`Model`] never changes afterwards.
//!
//! ```
//! use myo_model::{Model, builtin};
//!
//! let arm = Model::new(&builtin("mobl-arms")?)?;
//! assert_eq!((arm.joints.len(), arm.couplings.len(), arm.muscles.len()), (17, 12, 26));
//! # Ok::<(), myo_model::ModelError>(())
//! ```
//!
//! This crate knows no state and no equation of motion, no task, and no file beyond the text handed to it.
mod builtin;
mod check;
mod compile;
pub mod description;
mod error;
pub mod mjcf;
pub mod model;
mod text;

pub use builtin::{builtin, builtin_names};
pub use compile::FORMAT_VERSION;
pub use description::ModelDescription;
pub use error::{Element, ElementKind, ModelError, Nearest};
pub use model::Model;
