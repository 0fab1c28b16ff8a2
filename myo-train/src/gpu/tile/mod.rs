//! Sizes of the tiles that a workgroup makes of a product, and the functions of a kernel that depend on them.
//!
//! These functions are written out, entry by entry, because not every driver keeps arrays that loops index in registers.

mod multiply;
mod over_inputs;
mod over_samples;

pub use over_inputs::Weights;

/// What one workgroup makes of a matrix product, and in which pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tile {
    /// Rows (outputs of the layer), a multiple of `per_thread.0`.
    pub outputs: u32,
    /// Columns (samples), a multiple of `per_thread.1`.
    pub columns: u32,
    /// Inputs multiplied between two barriers.
    pub depth: u32,
    /// Rows and columns of one thread, multiples of 4.
    pub per_thread: (u32, u32),
}

/// Shared memory that every device has, in bytes.
const PORTABLE_SHARED: u32 = 16 << 10;
/// Threads of a workgroup that every device can run.
const PORTABLE_THREADS: u32 = 256;

impl Tile {
    /// A tile of some rows and columns.
    ///
    /// # Panics
    /// The pieces do not fill the tile, or some card could not run it: more than 256 threads or 16 KiB.
    pub const fn new(outputs: u32, columns: u32, depth: u32, per_thread: (u32, u32)) -> Self {
        let tile = Self { outputs, columns, depth, per_thread };
        assert!(per_thread.0.is_multiple_of(4) && per_thread.1.is_multiple_of(4), "threads hold groups of four");
        assert!(outputs.is_multiple_of(per_thread.0) && columns.is_multiple_of(per_thread.1), "threads fill the tile");
        assert!(tile.threads() <= PORTABLE_THREADS, "at most 256 threads");
        // Twice what is multiplied between two barriers, 4 bytes each.
        assert!(2 * 4 * depth * (outputs + columns) <= PORTABLE_SHARED, "at most 16 KiB");
        tile
    }

    /// Threads of the workgroup.
    pub const fn threads(self) -> u32 {
        self.threads_x() * self.threads_y()
    }

    /// Workgroups for a layer.
    pub const fn workgroups(self, outputs: u32, columns: u32) -> u32 {
        outputs.div_ceil(self.outputs) * columns.div_ceil(self.columns)
    }

    const fn threads_x(self) -> u32 {
        self.columns / self.per_thread.1
    }

    const fn threads_y(self) -> u32 {
        self.outputs / self.per_thread.0
    }

    /// Numbers of W in shared memory.
    const fn w_numbers(self) -> u32 {
        self.depth * self.outputs
    }

    /// Groups of four numbers of X in shared memory.
    const fn x_groups(self) -> u32 {
        self.depth * self.columns / 4
    }

    /// What a kernel needs besides its own files: the constants, what the workgroup shares, and `make_tile`.
    fn with(self, make_tile: &str) -> String {
        let Self { outputs, columns, depth, .. } = self;
        let (groups, threads_x, threads_y) = (columns / 4, self.threads_x(), self.threads_y());
        let common = include_str!("tile.wgsl");
        format!(
            "
const DEPTH = {depth}u;
const TILE_OUTPUTS = {outputs}u;
const TILE_GROUPS = {groups}u;
const THREADS_X = {threads_x}u;
const THREADS_Y = {threads_y}u;

{common}
{make_tile}"
        )
    }
}
