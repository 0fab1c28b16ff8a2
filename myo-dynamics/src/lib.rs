//! Rigid-body dynamics of muscle-driven models.
mod batch;
mod impedance;
mod obstacles;
pub mod plan;
mod polynomial;
mod reach;
pub mod spatial;
pub mod step;
mod workspace;

pub use batch::Batch;
pub use obstacles::{Obstacles, StaticBox, Surface};
pub use plan::{Coupling, Plan, PlanError};
pub use reach::ReachableSpace;
pub use workspace::{State, Workspace};
