//! Musculoskeletal model: description, checks, the built-in arm, MJCF export.
pub mod description;
pub mod model;

pub use description::ModelDescription;
pub use model::Model;
