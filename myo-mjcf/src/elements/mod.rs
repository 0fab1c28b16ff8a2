//! The elements, one table each.

mod actuator;
mod asset;
mod body;
mod compiler;
mod contact;
mod equality;
mod geom;
mod joint;
mod keyframe;
mod option;
mod sensor;
mod tendon;

pub use actuator::*;
pub use asset::*;
pub use body::*;
pub use compiler::*;
pub use contact::*;
pub use equality::*;
pub use geom::*;
pub use joint::*;
pub use keyframe::*;
pub use option::*;
pub use sensor::*;
pub use tendon::*;
