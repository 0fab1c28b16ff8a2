//! Processors without AVX-512.

use crate::{Memory, NativeError, View};
use myo_scalar::symbolic::Program;

/// A compiled program; there is none on this processor.
#[derive(Debug)]
pub enum Routine {}

impl Routine {
    /// Refuses.
    ///
    /// # Errors
    /// There is no AVX-512.
    pub fn compile(_: &Program) -> Result<Self, NativeError> {
        Err(NativeError::Unsupported)
    }

    /// Refuses.
    ///
    /// # Errors
    /// There is no AVX-512.
    pub fn compile_in_pieces(_: &Program, _: usize) -> Result<Self, NativeError> {
        Err(NativeError::Unsupported)
    }

    /// Runs it.
    pub fn run_blocks<const N: usize>(&self, _: &mut [[View<'_>; N]], _: &mut Memory) {
        match *self {}
    }

    /// Runs it.
    pub fn run(&self, _: &mut [View<'_>], _: &mut Memory) {
        match *self {}
    }

    /// Bytes of machine code.
    pub fn size(&self) -> usize {
        match *self {}
    }
}
