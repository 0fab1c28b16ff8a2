//! The number types that the physics is written over.
//!
//! Everything that happens to one environment is written once, generic over [`Scalar`], without data-dependent
//! branches, and run by
//! - `f64`: the reference, slow and obvious;
//! - lanes of `f32` (16 on AVX-512, 8 elsewhere): one environment per lane, picked at run time by [`dispatch`];
//! - [`symbolic::Sym`], which only writes down what is computed, so that a graphics card can run it.
//!
//! A mask is a value like any other, and the only question generic code may ask a mask is [`Mask::any`], to *skip* work
//! whose results would not be selected. Loops and branches that a graphics card should keep are [`Scalar::repeat`],
//! [`Scalar::repeat_while`], [`Scalar::when`] and [`Scalar::map_chunks`]; what they hand on is [`Carried`].
//!
//! [`philox`] draws counter-based random numbers whose integers are the same for every implementation.
//!
//! ```
//! use myo_scalar::{dispatch, LaneTask, Level, Scalar};
//!
//! struct Norm<'a>(&'a [f32], &'a mut [f32]);
//! impl LaneTask for Norm<'_> {
//!     type Output = ();
//!     #[inline(always)]
//!     fn run<S: Scalar<Const = f32>>(self) {
//!         for (x, y) in self.0.chunks_exact(S::LANES).zip(self.1.chunks_exact_mut(S::LANES)) {
//!             let v = S::load(x);
//!             (v * v + S::lit(1.0)).sqrt().store(y);
//!         }
//!     }
//! }
//! let (x, mut y) = ([3.0; 16], [0.0; 16]);
//! dispatch(Level::detect()?, Norm(&x, &mut y));
//! assert!((y[0] - 10.0f32.sqrt()).abs() < 1e-6);
//! # Ok::<(), myo_scalar::LevelError>(())
//! ```
//!
//! This crate does not know muscles, bodies, tasks, threads or files.

mod angle;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod carried;
mod elementary;
mod level;
mod philox;
mod plain;
mod portable;
mod scalar;
pub mod symbolic;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use angle::atan2;
pub use carried::{Carried, Visitor};
pub use level::{Instructions, LaneTask, Level, LevelError, dispatch};
pub use philox::{Counter, normal_pair, open_unit, philox, philox_block, seed_words, unit};
pub use portable::F32x8;
pub use scalar::{Mask, Real, Row, RowMap, Scalar, Stage, Word};
