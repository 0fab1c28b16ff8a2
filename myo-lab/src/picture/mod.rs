//! Pictures of a simulated user: the arm with its muscles, targets and the fingertip's path, as shapes on a page.
//!
//! The view is from behind and to the left: nearer things are lower left, the plane of the targets upper right. A
//! [`Painter`] makes a [`Drawing`] of what [`VectorEnv::peek`](myo_env::VectorEnv::peek) saw, which writes itself as SVG; whoever wants pixels draws its shapes.
//! Where everything is it asks a [`Skeleton`](myo_env::Skeleton).

mod drawing;
mod painter;

pub use drawing::{Colour, Drawing, Shape};
pub use painter::Painter;
