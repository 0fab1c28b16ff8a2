//! The seam between the physics and the numbers it runs on.

use crate::carried::Carried;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Mul, Neg, Not, Shl, Shr, Sub, SubAssign};

/// Most lanes of any number.
pub const MOST_LANES: usize = 16;

/// A plain number that tables of model constants are made of: `f64` or `f32`.
pub trait Real: Copy + Default + Debug + PartialEq + Send + Sync + 'static {
    /// Rounds a table value to this type.
    fn from_f64(x: f64) -> Self;
    /// Widens, exactly.
    fn to_f64(self) -> f64;
}

/// The outcome of a comparison, one truth value per lane.
pub trait Mask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// True or false everywhere.
    fn splat(value: bool) -> Self;
    /// Whether some lane is true. Generic code may use it only to skip work that no lane would select;
    /// a symbolic mask answers true.
    fn any(self) -> bool;
}

/// One unsigned 32-bit integer per lane; arithmetic wraps.
pub trait Word:
    Copy
    + Debug
    + Add<Output = Self>
    + BitXor<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// The same integer everywhere.
    fn splat(x: u32) -> Self;
    /// High and low half of the 64-bit product with a constant.
    fn mul_wide(self, by: u32) -> (Self, Self);
    /// Reads [`Scalar::LANES`] integers.
    fn load(from: &[u32]) -> Self;
    /// Writes [`Scalar::LANES`] integers.
    fn store(self, to: &mut [u32]);
}

/// Generic work on one kind of number that is compiled as a function of its own. `run` and all that it calls, other
/// stages aside, must be `#[inline(always)]`.
pub trait Stage<S> {
    /// Name, for tables of operation counts.
    const NAME: &'static str;
    /// What the stage returns.
    type Output;
    /// Runs the stage.
    fn run(self) -> Self::Output;
}

/// The same map of every row of a table: `put(k, map(take(k)))`. All of it must be `#[inline(always)]`, which closures cannot be:
/// those of this size would be functions of their own, without a level's instructions.
pub trait RowMap<S, const I: usize, const O: usize> {
    /// What the map takes of a row.
    fn take(&self, row: usize) -> [S; I];
    /// The map.
    fn map(&self, taken: [S; I]) -> [S; O];
    /// What becomes of a row's outcome.
    fn put(&mut self, row: usize, found: [S; O]);
}

/// A row of tables, within [`Scalar::for_each_row`].
#[derive(Clone, Copy, Debug)]
pub enum Row<W> {
    /// Its number is known.
    Known(usize),
    /// Its number is counted as the loop runs.
    Counted(W),
}

/// A number per lane, with the few operations that the physics needs.
pub trait Scalar:
    Copy
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// What tables of constants hold.
    type Const: Real;
    /// Outcome of a comparison.
    type Mask: Mask;
    /// Integers beside these numbers.
    type Word: Word;
    /// How many environments one value carries.
    const LANES: usize;
    /// Distance from one to the next number; of a symbolic number, where it will run: in single precision.
    const EPSILON: f64;

    /// Whether [`gather`](Self::gather) reads memory, however many rows there are; else it goes through all of them.
    const READS_ROWS: bool = false;

    /// The same constant everywhere.
    fn splat(c: Self::Const) -> Self;
    /// A literal.
    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self::splat(Self::Const::from_f64(x))
    }
    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::lit(0.0)
    }
    /// Reads [`Scalar::LANES`] numbers.
    fn load(from: &[Self::Const]) -> Self;
    /// Writes [`Scalar::LANES`] numbers.
    fn store(self, to: &mut [Self::Const]);

    /// `self * a + b`, in one rounding where the hardware has it.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// `1 / sqrt(self)` for positive numbers, to about one unit in the last place.
    fn rsqrt(self) -> Self;
    /// `1 / self`, to about one unit in the last place.
    fn recip(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller of two numbers.
    fn min(self, other: Self) -> Self;
    /// The greater of two numbers.
    fn max(self, other: Self) -> Self;
    /// Greatest whole number not above.
    fn floor(self) -> Self;
    /// Sine and cosine (rad); for lanes accurate to 1e-7 for angles up to a thousand turns.
    fn sin_cos(self) -> (Self, Self);
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm of positive numbers.
    fn ln(self) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `a` where the mask is true, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Converts integers below 2^24, exactly.
    fn from_word(word: Self::Word) -> Self;
    /// Chooses between integers.
    fn select_word(mask: Self::Mask, a: Self::Word, b: Self::Word) -> Self::Word;

    /// Runs a stage in a function of its own, compiled with these lanes' instructions. It bounds the size of functions,
    /// and so the time that the compiler takes; pass references, not numbers.
    fn outline<T: Stage<Self>>(stage: T) -> T::Output;

    /// Does work in double precision, one environment after the other: what is rare and branches a lot. Where the mask is false there is no work, and
    /// zero comes out. Call it within a stage, and work in a function that is not inlined.
    ///
    /// # Panics
    /// A symbolic number cannot do it.
    #[inline(always)]
    fn lane_by_lane<const I: usize, const O: usize>(
        mask: Self::Mask,
        inputs: [Self; I],
        mut work: impl FnMut(&[f64; I]) -> [f64; O],
    ) -> [Self; O] {
        let nothing = [Self::Const::default(); MOST_LANES];
        let (mut here, mut taken, mut found) = (nothing, [nothing; I], [nothing; O]);
        Self::indicator(mask).store(&mut here);
        for (lanes, input) in taken.iter_mut().zip(inputs) {
            input.store(lanes);
        }
        for lane in 0..Self::LANES {
            if here[lane].to_f64() == 0.0 {
                continue;
            }
            let mut numbers = [0.0; I];
            for (number, lanes) in numbers.iter_mut().zip(&taken) {
                *number = lanes[lane].to_f64();
            }
            for (lanes, number) in found.iter_mut().zip(work(&numbers)) {
                lanes[lane] = Self::Const::from_f64(number);
            }
        }
        let mut outputs = [Self::zero(); O];
        for (output, lanes) in outputs.iter_mut().zip(&found) {
            *output = Self::load(lanes);
        }
        outputs
    }

    /// Runs `body` `count` times. `vars` are what it changes and what is read afterwards.
    ///
    /// A symbolic number records the body once; ordinary Rust loops are unrolled.
    #[inline(always)]
    fn repeat<V: Carried<Self>>(count: usize, vars: &mut V, mut body: impl FnMut(&mut V)) {
        for _ in 0..count {
            body(vars);
        }
    }
    /// Runs `body` until it asks nowhere for another run, at most `limit` times. A lane that asks for none may see further
    /// ones, which must leave it as it is.
    #[inline(always)]
    fn repeat_while<V: Carried<Self>>(limit: usize, vars: &mut V, mut body: impl FnMut(&mut V) -> Self::Mask) {
        for _ in 0..limit {
            if !body(vars).any() {
                break;
            }
        }
    }
    /// Runs `body` if the mask is true somewhere. Lanes where it is not may see the run, which must leave them as they are.
    #[inline(always)]
    fn when<V: Carried<Self>>(mask: Self::Mask, vars: &mut V, body: impl FnOnce(&mut V)) {
        if mask.any() {
            body(vars);
        }
    }
    /// Replaces every `N` values in a row by what `body` makes of them and of the chunk's number.
    ///
    /// # Panics
    /// If the values are no whole number of chunks.
    #[inline(always)]
    fn map_chunks<const N: usize>(values: &mut [Self], mut body: impl FnMut(Self::Word, [Self; N]) -> [Self; N]) {
        let (chunks, rest) = values.as_chunks_mut();
        assert!(rest.is_empty(), "the values are whole chunks");
        for (index, chunk) in chunks.iter_mut().enumerate() {
            *chunk = body(Self::Word::splat(index as u32), *chunk);
        }
    }

    /// Goes through the rows of a table: `output[k] = body(constants(k), inputs[..][k], output[k])`. A symbolic number may
    /// record the body once, for all rows.
    ///
    /// # Panics
    /// If an input is shorter than the output.
    #[inline(always)]
    fn for_rows<const K: usize, const I: usize>(
        constants: impl Fn(usize) -> [Self::Const; K],
        inputs: [&[Self]; I],
        output: &mut [Self],
        mut body: impl FnMut([Self; K], [Self; I], Self) -> Self,
    ) {
        let inputs = inputs.map(|input| &input[..output.len()]);
        for (k, value) in output.iter_mut().enumerate() {
            *value = body(constants(k).map(Self::splat), inputs.map(|input| input[k]), *value);
        }
    }

    /// Maps `count` rows, see [`RowMap`]. A symbolic number may record the map once, for all rows: then it takes of all rows first and
    /// puts all of them last. What is taken as a constant in every row becomes a table, and of the rest only what the map reads is
    /// kept.
    #[inline(always)]
    fn map_rows<const I: usize, const O: usize>(count: usize, rows: &mut impl RowMap<Self, I, O>) {
        for k in 0..count {
            let found = rows.map(rows.take(k));
            rows.put(k, found);
        }
    }

    /// Whether [`Scalar::map_rows`] records a loop, in which every row waits for itself alone: then what else would be looked for of all rows
    /// together is looked for in the map, since all that rows hand on has to be kept.
    #[inline(always)]
    fn rows_are_a_loop() -> bool {
        false
    }

    /// Runs `body` for each of `count` rows of tables, whose entries [`Scalar::of_row`] reads. `vars` are what it changes and what
    /// is read afterwards. A symbolic number may record the body once.
    #[inline(always)]
    fn for_each_row<V: Carried<Self>>(count: usize, vars: &mut V, mut body: impl FnMut(&mut V, Row<Self::Word>)) {
        for row in 0..count {
            body(vars, Row::Known(row));
        }
    }

    /// The number of a row.
    #[inline(always)]
    fn row_number(row: Row<Self::Word>) -> Self {
        match row {
            Row::Known(row) => Self::lit(row as f64),
            Row::Counted(row) => Self::from_word(row),
        }
    }

    /// The entries of a row in columns of `count` entries each.
    ///
    /// # Panics
    /// The columns have no such row.
    #[inline(always)]
    fn of_row<const N: usize>(row: Row<Self::Word>, count: usize, entry: impl Fn(usize) -> [Self; N]) -> [Self; N] {
        match row {
            Row::Known(row) => entry(row),
            Row::Counted(row) => Self::gather(count, entry, Self::from_word(row)),
        }
    }

    /// Row `index`, a whole number, of `count` rows of a table; the first one below them and the last one beyond. A symbolic
    /// number reads a column from memory where its entries are a buffer's, evenly spaced.
    ///
    /// # Panics
    /// Without any row.
    #[inline(always)]
    fn gather<const N: usize>(count: usize, entry: impl Fn(usize) -> [Self; N], index: Self) -> [Self; N] {
        assert!(count > 0, "there is a row");
        let mut found = [Self::zero(); N];
        // One call, else the closure would not be inlined.
        for k in (0..count).rev() {
            let here = if k + 1 < count { index.lt(Self::lit(k as f64 + 0.5)) } else { Self::Mask::splat(true) };
            for (x, entry) in found.iter_mut().zip(entry(k)) {
                *x = Self::select(here, entry, *x);
            }
        }
        found
    }

    /// `self <= other`, for numbers.
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        !other.lt(self)
    }
    /// Between two constants.
    #[inline(always)]
    fn clamp(self, lo: f64, hi: f64) -> Self {
        self.max(Self::lit(lo)).min(Self::lit(hi))
    }
    /// Square.
    #[inline(always)]
    fn sq(self) -> Self {
        self * self
    }
    /// `self` where the mask is true, else zero.
    #[inline(always)]
    fn only(self, mask: Self::Mask) -> Self {
        Self::select(mask, self, Self::zero())
    }
    /// One where the mask is true, else zero.
    #[inline(always)]
    fn indicator(mask: Self::Mask) -> Self {
        Self::lit(1.0).only(mask)
    }
}
