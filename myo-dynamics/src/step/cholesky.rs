//! Cholesky factorisation `A = L L^T` of small symmetric positive definite matrices, row-major, lower triangle, in the order and
//! with the zeros of an [`Elimination`].

use crate::plan::Elimination;
use myo_scalar::Scalar;

/// Solves `A x = b` in place of `b`; `matrix` and `pivot` are scratch afterwards.
#[inline(always)]
pub fn factor_and_solve<S: Scalar>(elimination: &Elimination, matrix: &mut [S], pivot: &mut [S], x: &mut [S]) {
    factor(elimination, matrix, pivot);
    solve(elimination, matrix, pivot, x);
}

/// Replaces the lower triangle by `L`, the reciprocals of its diagonal in `pivot`.
#[inline(always)]
pub fn factor<S: Scalar>(elimination: &Elimination, a: &mut [S], pivot: &mut [S]) {
    for column in &elimination.columns {
        let mut square = a[column.diagonal];
        for felt in &column.before {
            square = (-a[felt.entry]).mul_add(a[felt.entry], square);
        }
        pivot[column.dof] = square.rsqrt();
        for later in &column.after {
            let mut sum = a[later.entry];
            for &[x, y] in &later.products {
                sum = (-a[x]).mul_add(a[y], sum);
            }
            a[later.entry] = sum * pivot[column.dof];
        }
    }
}

/// Solves `L L^T x = b` in place.
#[inline(always)]
pub fn solve<S: Scalar>(elimination: &Elimination, l: &[S], pivot: &[S], x: &mut [S]) {
    for column in &elimination.columns {
        let mut sum = x[column.dof];
        for felt in &column.before {
            sum = (-l[felt.entry]).mul_add(x[felt.dof], sum);
        }
        x[column.dof] = sum * pivot[column.dof];
    }
    for column in elimination.columns.iter().rev() {
        let mut sum = x[column.dof];
        for later in &column.after {
            sum = (-l[later.entry]).mul_add(x[later.dof], sum);
        }
        x[column.dof] = sum * pivot[column.dof];
    }
}

/// The product `A x` of a matrix that has not been factored.
#[inline(always)]
pub fn product<S: Scalar>(elimination: &Elimination, a: &[S], x: &[S], product: &mut [S]) {
    for column in &elimination.columns {
        let mut sum = S::zero();
        for felt in &column.before {
            sum = a[felt.entry].mul_add(x[felt.dof], sum);
        }
        sum = a[column.diagonal].mul_add(x[column.dof], sum);
        for later in &column.after {
            sum = a[later.entry].mul_add(x[later.dof], sum);
        }
        product[column.dof] = sum;
    }
}

/// Copies the entries that are not always zero.
#[inline(always)]
pub fn copy<S: Scalar>(elimination: &Elimination, from: &[S], to: &mut [S]) {
    for column in &elimination.columns {
        to[column.diagonal] = from[column.diagonal];
        for felt in &column.before {
            to[felt.entry] = from[felt.entry];
        }
    }
}
