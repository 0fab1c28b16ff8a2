//! Protocols: what is asked of a simulated user as it was asked of people, and how the answer compares.

mod strength;

pub use strength::{HoldingShare, MomentArm, SignChange, Strength, StrengthRow};
