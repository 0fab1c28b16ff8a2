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
//! Without the default feature `files` there are no files and no built-in arm (which is one), and none of the libraries
//! that reading takes; descriptions are then made in code.
//!
//! This crate knows no state and no equation of motion, no task, and no file beyond the text handed to it.
#[cfg(feature = "files")]
mod builtin;
mod check;
mod compile;
pub mod description;
mod error;
#[cfg(feature = "files")]
pub mod import;
mod mirror;
pub mod mjcf;
pub mod model;
mod oriented_box;
mod size;
mod static_box;
mod strength;
#[cfg(feature = "files")]
mod text;

#[cfg(feature = "files")]
pub use builtin::{builtin, builtin_names};
pub use compile::{FORMAT_VERSION, MOST_FINGERS};
pub use description::ModelDescription;
pub use error::{Element, ElementKind, ModelError};
pub use model::Model;
pub use myo_nearest::Nearest;
pub use oriented_box::OrientedBox;
pub use size::{Anthropometry, Sex, Size};
pub use static_box::StaticBox;
