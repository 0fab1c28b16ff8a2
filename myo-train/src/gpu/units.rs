//! The matrix units of a card: products of matrices of 16 x 16 numbers of 16 bits, summed up in 32 bits, which the threads of
//! a subgroup make together.

/// Threads of a subgroup.
pub const SUBGROUP: u32 = 32;
/// Rows and columns of a matrix.
pub const UNIT: u32 = 16;
/// Bytes of shared memory that a subgroup takes for sums on their way from the matrix units to its threads: 16 rows of 20
/// numbers, so that the rows lie in different banks.
pub const STAGE_BYTES: u32 = UNIT * 20 * 4;

/// What all kernels for matrix units have in common.
pub fn units(subgroups: u32) -> String {
    let common = include_str!("units.wgsl");
    format!("{common}\nconst SUBGROUPS = {subgroups}u;\n")
}

/// What every thread of a subgroup knows about itself: where it finds its sums, as [`Matrices::staged`] calls it.
pub const THREAD: &str = "    let line = lane / 4u;
    let quad = lane % 4u;
    let staged = subgroup * 16u * STAGE_STRIDE;
";

/// The matrices that a subgroup makes of a product: `y_0_0`, `y_0_1` and so on, from `w_0` and following, and `x_0` and
/// following.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Matrices {
    /// Matrices below each other.
    pub rows: u32,
    /// Matrices side by side.
    pub columns: u32,
}

impl Matrices {
    /// A text for each, by row and column.
    pub fn each(self, mut text: impl FnMut(u32, u32) -> String) -> String {
        (0..self.rows)
            .flat_map(|row| (0..self.columns).map(move |column| (row, column)))
            .map(|(r, c)| text(r, c))
            .collect()
    }

    /// Declares them, zero.
    pub fn zero(self) -> String {
        self.each(|row, column| format!("    var y_{row}_{column} = coop_mat16x16<f32, C>();\n"))
    }

    /// Adds one product to each.
    pub fn multiply(self) -> String {
        self.each(|row, column| {
            let y = format!("y_{row}_{column}");
            format!("        {y} = coopMultiplyAdd(w_{row}, x_{column}, {y});\n")
        })
    }

    /// Brings one after the other through shared memory to the threads. Each thread gets two groups of four columns, `sum_0`
    /// in row `line` and `sum_1` eight rows below, of column group `quad` within the matrix; `keep(row, column, half)` is what
    /// becomes of them.
    pub fn staged(self, keep: impl Fn(u32, u32, u32) -> String) -> String {
        self.each(|row, column| {
            let [first, second] = [0, 1].map(|half| keep(row, column, half));
            format!(
                "    {{
        coopStoreT(y_{row}_{column}, &stage[staged], STAGE_STRIDE);
        subgroupBarrier();
        let sum_0 = stage[staged + line * STAGE_STRIDE + quad];
        let sum_1 = stage[staged + (line + 8u) * STAGE_STRIDE + quad];
        subgroupBarrier();
        {first}
        {second}
    }}\n"
            )
        })
    }
}
