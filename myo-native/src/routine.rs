//! Machine code that can be called.

use crate::assemble::{Assembled, assemble};
use crate::emit::{FRAME_BIAS, MOST_BUFFERS, POOL_BIAS};
use crate::lower::lower;
use crate::pieces::Pieces;
use crate::schedule::schedule;
use crate::{BLOCKS, LANES, Memory, NativeError, View};
use memmap2::{Mmap, MmapMut};
use myo_scalar::symbolic::{Entries, Op, Program, Statement};

/// Takes where rows of pointers begin and end: frame, constants and buffers of each block.
type Call = unsafe extern "sysv64" fn(*const *mut u8, *const *mut u8);

/// Most pointers of a call.
const MOST_POINTERS: usize = BLOCKS * (2 + MOST_BUFFERS);
/// Bytes from one frame to the next beyond what it takes: those of two blocks begin in different sets of a cache.
const FRAME_GAP: usize = 64;

/// Instructions of a piece, whose code is then a third of a first-level cache.
const PIECE: usize = 1500;

/// Operations beyond which compiling takes seconds.
const MOST_OPERATIONS: usize = 150_000;

/// A compiled program.
#[derive(Debug)]
pub struct Routine {
    code: Mmap,
    size: usize,
    constants: Vec<u32>,
    /// Bytes that it computes in.
    frame: usize,
    buffers: Vec<Demand>,
}

/// What a program does with a buffer.
#[derive(Clone, Copy, Debug)]
struct Demand {
    entries: Entries,
    is_written: bool,
}

impl Routine {
    /// Compiles a program.
    ///
    /// # Errors
    /// The processor has no AVX-512, there is no memory, or the program does what a routine cannot do, see [`NativeError`].
    pub fn compile(program: &Program) -> Result<Self, NativeError> {
        Self::compile_in_pieces(program, PIECE)
    }

    /// Compiles it into pieces of at most so many instructions, each of which runs for all blocks before the next one does. Results do not
    /// depend on it.
    ///
    /// # Errors
    /// Those of [`Routine::compile`].
    pub fn compile_in_pieces(program: &Program, most: usize) -> Result<Self, NativeError> {
        if !is_x86_feature_detected!("avx512f") {
            return Err(NativeError::Unsupported);
        }
        let operations = program.operations();
        if operations > MOST_OPERATIONS {
            return Err(NativeError::TooLarge { operations, most: MOST_OPERATIONS });
        }
        let nbuffer = count_buffers(program);
        if nbuffer > MOST_BUFFERS {
            return Err(NativeError::TooManyBuffers { count: nbuffer, most: MOST_BUFFERS });
        }
        let mut lowered = lower(program)?;
        schedule(&mut lowered);
        let pieces = Pieces::of(&lowered, most);
        let Assembled { bytes, constants, frame } = assemble(&lowered, &program.table, nbuffer, &pieces);
        let mut code = MmapMut::map_anon(bytes.len())?;
        code[..bytes.len()].copy_from_slice(&bytes);
        let buffers = (0..nbuffer as u32).map(|binding| Demand::of(program, binding)).collect();
        Ok(Self { code: code.make_exec()?, size: bytes.len(), constants, frame, buffers })
    }

    /// Runs it for [`LANES`] environments.
    ///
    /// # Panics
    /// A buffer is missing, is too short, or is read-only though the program writes it.
    pub fn run(&self, buffers: &mut [View<'_>], memory: &mut Memory) {
        let mut pointers = [std::ptr::null_mut(); MOST_POINTERS];
        let count = self.point(buffers, memory.of(self.frame), &mut pointers);
        self.call(&pointers[..count]);
    }

    /// Runs it for [`LANES`] environments with each of several sets of buffers. [`BLOCKS`] sets at once take less time than one after the
    /// other.
    ///
    /// # Panics
    /// As [`Routine::run`].
    pub fn run_blocks<const N: usize>(&self, blocks: &mut [[View<'_>; N]], memory: &mut Memory) {
        let frame = self.frame + FRAME_GAP;
        let frames = memory.of(frame * BLOCKS);
        for blocks in blocks.chunks_mut(BLOCKS) {
            let mut pointers = [std::ptr::null_mut(); MOST_POINTERS];
            let mut count = 0;
            for (number, buffers) in blocks.iter_mut().enumerate() {
                count += self.point(buffers, frames.wrapping_add(number * frame), &mut pointers[count..]);
            }
            self.call(&pointers[..count]);
        }
    }

    /// Writes down where all is that a block needs; how many pointers that are.
    fn point(&self, buffers: &mut [View<'_>], frame: *mut u8, pointers: &mut [*mut u8]) -> usize {
        assert!(buffers.len() >= self.buffers.len(), "{} buffers of {}", buffers.len(), self.buffers.len());
        pointers[0] = frame.wrapping_offset(FRAME_BIAS as isize);
        pointers[1] = self.constants.as_ptr().cast_mut().cast::<u8>().wrapping_offset(POOL_BIAS as isize);
        for (k, (view, demand)) in buffers.iter_mut().zip(&self.buffers).enumerate() {
            let needed = demand.entries.needed(LANES as u32);
            assert!(view.len() as u64 >= needed, "buffer {k} has {} entries of {needed}", view.len());
            assert!(view.is_writable() || !demand.is_written, "buffer {k} is written");
            pointers[k + 2] = match view {
                View::Numbers(x) => x.as_ptr().cast_mut().cast(),
                View::NumbersMut(x) => x.as_mut_ptr().cast(),
                View::Words(x) => x.as_ptr().cast_mut().cast(),
                View::WordsMut(x) => x.as_mut_ptr().cast(),
            };
        }
        2 + self.buffers.len()
    }

    /// Runs the code, with the pointers of one block or more.
    fn call(&self, pointers: &[*mut u8]) {
        let rows = pointers.as_ptr_range();
        // SAFETY: the code was made here for this signature, on a processor that has its instructions. Each block's pointers were written by
        // `point` for buffers that are borrowed until then. It reads and writes the rows that the program names, which the buffers have, as was
        // checked there, and the frames, which are as long as it wants and apart; what it looks up by computed numbers is bounded to rows that
        // the program names and to its table. It writes buffers that are mutable only.
        unsafe {
            let call: Call = std::mem::transmute(self.code.as_ptr());
            call(rows.start, rows.end);
        }
    }

    /// Bytes of machine code.
    pub fn size(&self) -> usize {
        self.size
    }
}

impl Demand {
    fn of(program: &Program, binding: u32) -> Self {
        let writes =
            |statement: &Statement| matches!(statement, Statement::Store(store) if store.buffer.binding == binding);
        Self { entries: program.entries(binding), is_written: program.statements.iter().any(writes) }
    }
}

/// Buffers up to the last one that a program names.
fn count_buffers(program: &Program) -> usize {
    let read = program.live_nodes().filter_map(|id| match program.nodes[id as usize].op {
        Op::Input(buffer, _) | Op::Gather(buffer, _) => Some(buffer.binding),
        _ => None,
    });
    let written = program.statements.iter().filter_map(|statement| match statement {
        Statement::Store(store) => Some(store.buffer.binding),
        _ => None,
    });
    read.chain(written).max().map_or(0, |binding| binding as usize + 1)
}
