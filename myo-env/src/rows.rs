//! Between rows of the caller's memory, one per environment, and lanes.

use myo_scalar::{Real, Scalar};

/// Most lanes that any level has.
pub const MAX_LANES: usize = 16;

/// Truth values per environment to a mask; environments past the end are false.
#[inline(always)]
pub fn mask_from<S: Scalar>(flags: impl Iterator<Item = bool>) -> S::Mask {
    let mut numbers = [S::Const::default(); MAX_LANES];
    for (x, flag) in numbers.iter_mut().zip(flags) {
        *x = S::Const::from_f64(f64::from(u8::from(flag)));
    }
    S::lit(0.5).lt(S::load(&numbers))
}

/// A mask to truth values.
#[inline(always)]
pub fn flags_of<S: Scalar>(mask: S::Mask) -> [bool; MAX_LANES] {
    let mut numbers = [S::Const::default(); MAX_LANES];
    S::indicator(mask).store(&mut numbers);
    let mut flags = [false; MAX_LANES];
    for (flag, x) in flags.iter_mut().zip(numbers) {
        *flag = x.to_f64() > 0.5;
    }
    flags
}

/// Writes one row of `values` per environment where `which` says so; `rows` holds the environments of this block.
#[inline(always)]
pub fn write_rows<S: Scalar>(values: &[S], which: &[bool], rows: &mut [f32]) {
    let width = values.len();
    for (k, value) in values.iter().enumerate() {
        let mut numbers = [S::Const::default(); MAX_LANES];
        value.store(&mut numbers);
        for ((row, x), wanted) in rows.chunks_exact_mut(width).zip(numbers).zip(which) {
            if *wanted {
                row[k] = x.to_f64() as f32;
            }
        }
    }
}

/// Reads one row per environment into lanes.
#[inline(always)]
pub fn read_rows<S: Scalar>(rows: &[f32], values: &mut [S]) {
    let width = values.len();
    for (k, value) in values.iter_mut().enumerate() {
        let mut numbers = [S::Const::default(); MAX_LANES];
        for (x, row) in numbers.iter_mut().zip(rows.chunks_exact(width)) {
            *x = S::Const::from_f64(f64::from(row[k]));
        }
        *value = S::load(&numbers);
    }
}

/// Writes one row per environment as columns, entry `row` of lane `lane` at `row * lanes + lane`; those of lanes without an environment stay as they are.
pub fn fill_columns(rows: &[f32], columns: &mut [f32], lanes: usize) {
    let width = columns.len() / lanes;
    for (lane, row) in rows.chunks_exact(width.max(1)).take(lanes).enumerate() {
        for (column, &x) in columns.chunks_exact_mut(lanes).zip(row) {
            column[lane] = x;
        }
    }
}

/// Copies environments of columns, entry `row` of environment `env` at `row * envs + env`, into rows, where `which` says so. Of the last block there may be fewer
/// rows than environments.
pub fn fill_rows(columns: &[f32], envs: usize, which: impl Fn(usize) -> bool, rows: &mut [f32]) {
    let width = columns.len() / envs;
    for (env, row) in rows.chunks_exact_mut(width.max(1)).enumerate().filter(|(env, _)| which(*env)) {
        for (k, x) in row.iter_mut().enumerate() {
            *x = columns[k * envs + env];
        }
    }
}

/// The rows of block `block` in an array of `width` entries per environment.
macro_rules! rows {
    ($array:expr, $block:expr, $lanes:expr, $width:expr) => {{
        let start = $block * $lanes * $width;
        let end = (start + $lanes * $width).min($array.len());
        &mut $array[start..end]
    }};
}
pub(crate) use rows;
