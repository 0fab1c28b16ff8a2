//! Dense Cholesky factorisation `A = L L^T` of small symmetric positive definite matrices, row-major, lower triangle.

use myo_scalar::Scalar;

/// Solves `A x = b` in place of `b`; `matrix` and `pivot` are scratch afterwards.
#[inline(always)]
pub fn factor_and_solve<S: Scalar>(n: usize, matrix: &mut [S], pivot: &mut [S], x: &mut [S]) {
    factor(n, matrix, pivot);
    solve(n, matrix, pivot, x);
}

/// Replaces the lower triangle by `L`, the reciprocals of its diagonal in `pivot`.
#[inline(always)]
pub fn factor<S: Scalar>(n: usize, a: &mut [S], pivot: &mut [S]) {
    for j in 0..n {
        let mut square = a[j * n + j];
        for k in 0..j {
            square = (-a[j * n + k]).mul_add(a[j * n + k], square);
        }
        pivot[j] = square.rsqrt();
        for i in j + 1..n {
            let mut sum = a[i * n + j];
            for k in 0..j {
                sum = (-a[i * n + k]).mul_add(a[j * n + k], sum);
            }
            a[i * n + j] = sum * pivot[j];
        }
    }
}

/// Solves `L L^T x = b` in place.
#[inline(always)]
pub fn solve<S: Scalar>(n: usize, l: &[S], pivot: &[S], x: &mut [S]) {
    for i in 0..n {
        let mut sum = x[i];
        for k in 0..i {
            sum = (-l[i * n + k]).mul_add(x[k], sum);
        }
        x[i] = sum * pivot[i];
    }
    for i in (0..n).rev() {
        let mut sum = x[i];
        for k in i + 1..n {
            sum = (-l[k * n + i]).mul_add(x[k], sum);
        }
        x[i] = sum * pivot[i];
    }
}
