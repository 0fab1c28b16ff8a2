//! Dense Cholesky factorisation `A = L L^T` of small symmetric positive definite matrices, row-major, lower triangle.

use myo_scalar::Scalar;

/// Solves `A x = b` in place of `b`; `matrix` and `pivot` are scratch afterwards.
#[inline(always)]
pub fn factor_and_solve<S: Scalar>(n: usize, matrix: &mut [S], pivot: &mut [S], x: &mut [S]) {
    // Sizes that are known when compiling stay in registers.
    match n {
        2 => sized::<S, 2>(matrix, x),
        3 => sized::<S, 3>(matrix, x),
        4 => sized::<S, 4>(matrix, x),
        5 => sized::<S, 5>(matrix, x),
        6 => sized::<S, 6>(matrix, x),
        _ => {
            factor(n, matrix, pivot);
            solve(n, matrix, pivot, x);
        }
    }
}

/// [`factor`] and [`solve`] for one size.
#[inline(always)]
#[expect(clippy::needless_range_loop, reason = "the indices are those of the equations")]
fn sized<S: Scalar, const N: usize>(matrix: &[S], x: &mut [S]) {
    let (matrix, x) = (&matrix[..N * N], &mut x[..N]);
    let mut l = [[S::zero(); N]; N];
    let (mut pivot, mut y) = ([S::zero(); N], [S::zero(); N]);
    for j in 0..N {
        let (mut square, mut right) = (matrix[j * N + j], x[j]);
        for k in 0..j {
            square = (-l[j][k]).mul_add(l[j][k], square);
            right = (-l[j][k]).mul_add(y[k], right);
        }
        pivot[j] = square.rsqrt();
        y[j] = right * pivot[j];
        for i in j + 1..N {
            let mut sum = matrix[i * N + j];
            for k in 0..j {
                sum = (-l[i][k]).mul_add(l[j][k], sum);
            }
            l[i][j] = sum * pivot[j];
        }
    }
    for i in (0..N).rev() {
        let mut sum = y[i];
        for k in i + 1..N {
            sum = (-l[k][i]).mul_add(y[k], sum);
        }
        y[i] = sum * pivot[i];
    }
    x.copy_from_slice(&y);
}

/// Replaces the lower triangle by `L`, the reciprocals of its diagonal in `pivot`.
#[inline(always)]
pub fn factor<S: Scalar>(n: usize, a: &mut [S], pivot: &mut [S]) {
    for j in 0..n {
        let mut square = a[j * n + j];
        for k in 0..j {
            square -= a[j * n + k] * a[j * n + k];
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
