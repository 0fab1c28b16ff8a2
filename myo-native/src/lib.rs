//! Recorded programs as machine code: what a graphics card runs as a kernel, a processor with AVX-512 runs as a routine.
//!
//! Generic code over lanes walks through tables: which joint, which muscle, which pair is next is read from memory, and so is every
//! constant, and intermediate results go back to it. A recorded program ([`myo_scalar::symbolic`]) has none of that: it is straight
//! code for one body or one task, its constants in place, what is equal computed once. [`Routine::compile`] turns it into instructions,
//! 16 environments to a register, in some milliseconds; [`Routine::run`] runs it.
//!
//! Nothing is decided here but which number is in which register when. Numbers agree with the same program on a card, and with lanes
//! to the rounding of single precision.
//!
//! ```
//! use myo_native::{LANES, Memory, Routine, View};
//! use myo_scalar::Scalar;
//! use myo_scalar::symbolic::{Buffer, Sharing, trace};
//!
//! let xs = Buffer { binding: 0, sharing: Sharing::PerEnv };
//! let program = trace(|| xs.set_number(1, xs.number(0).mul_add(Scalar::lit(2.0), Scalar::lit(1.0))));
//! if let Ok(routine) = Routine::compile(&program) {
//!     let mut rows = [3.0; 2 * LANES];
//!     routine.run(&mut [View::NumbersMut(&mut rows)], &mut Memory::default());
//!     assert_eq!(rows[LANES..], [7.0; LANES]);
//! }
//! ```
//!
//! This crate does not know bodies, tasks or environments, and no other processors than those with AVX-512.

#[cfg(target_arch = "x86_64")]
mod assemble;
#[cfg(target_arch = "x86_64")]
mod code;
#[cfg(not(target_arch = "x86_64"))]
mod elsewhere;
#[cfg(target_arch = "x86_64")]
mod emit;
#[cfg(target_arch = "x86_64")]
mod heirs;
#[cfg(target_arch = "x86_64")]
mod lower;
#[cfg(target_arch = "x86_64")]
mod pieces;
#[cfg(target_arch = "x86_64")]
mod registers;
#[cfg(target_arch = "x86_64")]
mod routine;
#[cfg(target_arch = "x86_64")]
mod schedule;
#[cfg(target_arch = "x86_64")]
mod uses;

#[cfg(not(target_arch = "x86_64"))]
pub use elsewhere::Routine;
#[cfg(target_arch = "x86_64")]
pub use routine::Routine;

/// Environments that a routine runs at once: row `row` of a buffer with rows for each begins at `row * LANES`.
pub const LANES: usize = 16;

/// Sets of buffers that [`Routine::run_blocks`] runs at once: code is read once for so many, and their frames still fit into a cache.
pub const BLOCKS: usize = 2;

/// Why a program was not compiled.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NativeError {
    /// There are no such instructions.
    #[error("this processor has no AVX-512")]
    Unsupported,
    /// Compiling would take seconds.
    #[error("the program takes {operations} operations; at most {most} are compiled")]
    TooLarge {
        /// How many it takes.
        operations: usize,
        /// How many it may take.
        most: usize,
    },
    /// The program has more buffers than there are registers for.
    #[error("the program has {count} buffers; at most {most} can be handed over")]
    TooManyBuffers {
        /// How many.
        count: usize,
        /// How many there may be.
        most: usize,
    },
    /// It would be unclear which of several environments wrote last.
    #[error("the program writes buffer {binding}, which environments share")]
    WritesShared {
        /// Which buffer.
        binding: u32,
    },
    /// What it looks up would have to be what was there before.
    #[error("the program looks rows up in buffer {binding} after it may have written them")]
    GathersWhatItWrites {
        /// Which buffer.
        binding: u32,
    },
    /// The system gives no memory that can be executed.
    #[error("no memory for machine code: {0}")]
    NoMemory(#[from] std::io::Error),
}

/// A buffer of a program. One that the program writes must be mutable.
#[derive(Debug)]
pub enum View<'a> {
    /// Numbers that are read.
    Numbers(&'a [f32]),
    /// Numbers that are read and written.
    NumbersMut(&'a mut [f32]),
    /// Integers that are read.
    Words(&'a [u32]),
    /// Integers that are read and written.
    WordsMut(&'a mut [u32]),
}

impl View<'_> {
    /// How many entries it has.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(x) => x.len(),
            Self::NumbersMut(x) => x.len(),
            Self::Words(x) => x.len(),
            Self::WordsMut(x) => x.len(),
        }
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether it may be written.
    pub fn is_writable(&self) -> bool {
        matches!(self, Self::NumbersMut(_) | Self::WordsMut(_))
    }
}

/// Memory that routines compute in. It holds nothing from one run to the next, and any routine may use it.
#[derive(Debug, Default)]
pub struct Memory {
    lines: Vec<Line>,
}

/// A register's worth.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Line(#[allow(dead_code, reason = "only machine code reads it")] [u8; 64]);

#[cfg(target_arch = "x86_64")]
impl Memory {
    fn of(&mut self, bytes: usize) -> *mut u8 {
        let lines = bytes.div_ceil(size_of::<Line>());
        if self.lines.len() < lines {
            self.lines.resize(lines, Line([0; 64]));
        }
        self.lines.as_mut_ptr().cast()
    }
}
