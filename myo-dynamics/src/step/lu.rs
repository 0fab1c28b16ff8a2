//! Factorisation `A = L U` of small matrices whose halves differ, row-major, in the order and with the zeros of an [`Unsymmetric`] elimination.
//!
//! Without pivots: what is factored is a mass matrix and as much as changes in one time step.

use crate::plan::Unsymmetric;
use myo_scalar::Scalar;

/// Copies the lower triangle into the upper one.
#[inline(always)]
pub fn mirror<S: Scalar>(elimination: &Unsymmetric, matrix: &mut [S]) {
    for column in &elimination.columns {
        for later in &column.after {
            let [a, b] = later.entries;
            matrix[a.min(b)] = matrix[a.max(b)];
        }
    }
}

/// Solves `A x = b` in place of `b`; `matrix` and `pivot` are scratch afterwards.
#[inline(always)]
pub fn factor_and_solve<S: Scalar>(elimination: &Unsymmetric, matrix: &mut [S], pivot: &mut [S], x: &mut [S]) {
    factor(elimination, matrix, pivot);
    solve(elimination, matrix, pivot, x);
}

/// Replaces the matrix by `U` and, in the rows of coordinates that are eliminated later, `L`, whose diagonal is one; the reciprocals of the diagonal of `U`
/// in `pivot`.
#[inline(always)]
fn factor<S: Scalar>(elimination: &Unsymmetric, a: &mut [S], pivot: &mut [S]) {
    for column in &elimination.columns {
        let mut diagonal = a[column.diagonal];
        for felt in &column.before {
            let [l, u] = felt.entries;
            diagonal = (-a[l]).mul_add(a[u], diagonal);
        }
        let inverse = diagonal.recip();
        pivot[column.dof] = inverse;
        for later in &column.after {
            let [below, right] = later.entries;
            let [mut l, mut u] = [a[below], a[right]];
            for &[[later_l, later_u], [own_l, own_u]] in &later.products {
                l = (-a[later_l]).mul_add(a[own_u], l);
                u = (-a[own_l]).mul_add(a[later_u], u);
            }
            (a[below], a[right]) = (l * inverse, u);
        }
    }
}

/// Solves `L U x = b` in place.
#[inline(always)]
fn solve<S: Scalar>(elimination: &Unsymmetric, a: &[S], pivot: &[S], x: &mut [S]) {
    for column in &elimination.columns {
        let mut sum = x[column.dof];
        for felt in &column.before {
            sum = (-a[felt.entries[0]]).mul_add(x[felt.dof], sum);
        }
        x[column.dof] = sum;
    }
    for column in elimination.columns.iter().rev() {
        let mut sum = x[column.dof];
        for later in &column.after {
            sum = (-a[later.entries[1]]).mul_add(x[later.dof], sum);
        }
        x[column.dof] = sum * pivot[column.dof];
    }
}
