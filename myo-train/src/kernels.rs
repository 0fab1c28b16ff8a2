//! The element-by-element work of learning: everything between two matrix products.

use crate::simd::{clip, kernels, madd, sigmoid};

kernels! {
    /// Hidden layer without gradient: `z <- silu(z + bias)`, `silu(x) = x sigmoid(x)`; `z` is `(rows, bias.len())`.
    pub fn bias_silu<const FMA: bool>(z: &mut [f32], bias: &[f32]) {
        for row in z.chunks_exact_mut(bias.len()) {
            for (z, b) in row.iter_mut().zip(bias) {
                let x = *z + b;
                *z = x * sigmoid::<FMA>(x);
            }
        }
    }

    /// As [`bias_silu`], and writes `silu'(x) = s + silu(x) (1 - s)` with `s = sigmoid(x)`, which the backward pass
    /// multiplies with; keeping it costs less than a second exponential.
    pub fn bias_silu_derivative<const FMA: bool>(z: &mut [f32], bias: &[f32], derivative: &mut [f32]) {
        let n = bias.len();
        for (row, derivative) in z.chunks_exact_mut(n).zip(derivative.chunks_exact_mut(n)) {
            for ((z, b), d) in row.iter_mut().zip(bias).zip(derivative) {
                let x = *z + b;
                let s = sigmoid::<FMA>(x);
                let h = x * s;
                *z = h;
                *d = madd::<FMA>(h, 1.0 - s, s);
            }
        }
    }

    /// Output layer: adds the bias to every row.
    pub fn add_bias<const FMA: bool>(z: &mut [f32], bias: &[f32]) {
        for row in z.chunks_exact_mut(bias.len()) {
            for (z, b) in row.iter_mut().zip(bias) {
                *z += b;
            }
        }
    }

    /// Adds the sum of the rows of `delta`, `(rows, bias_gradient.len())`.
    pub fn add_row_sum<const FMA: bool>(delta: &[f32], bias_gradient: &mut [f32]) {
        for row in delta.chunks_exact(bias_gradient.len()) {
            for (g, d) in bias_gradient.iter_mut().zip(row) {
                *g += d;
            }
        }
    }

    /// Gradient through the activation, `delta <- delta * derivative`, and its row sum, added to `bias_gradient`.
    pub fn activation_backward<const FMA: bool>(delta: &mut [f32], derivative: &[f32], bias_gradient: &mut [f32]) {
        let n = bias_gradient.len();
        for (delta, derivative) in delta.chunks_exact_mut(n).zip(derivative.chunks_exact(n)) {
            for ((delta, d), g) in delta.iter_mut().zip(derivative).zip(bias_gradient.iter_mut()) {
                *delta *= d;
                *g += *delta;
            }
        }
    }

    /// `out = clip((x - mean) * inverse_std, -limit, limit)` for every row of `x`.
    pub fn normalize_rows<const FMA: bool>(x: &[f32], mean: &[f32], inverse_std: &[f32], limit: f32, out: &mut [f32]) {
        let n = mean.len();
        for (x, out) in x.chunks_exact(n).zip(out.chunks_exact_mut(n)) {
            for (((x, m), s), out) in x.iter().zip(mean).zip(inverse_std).zip(out) {
                *out = clip((x - m) * s, -limit, limit);
            }
        }
    }

    /// Sums of `d = x - shift` and of `d^2` over the rows of `x`, added to `sum` and `sum_squares`.
    pub fn add_moments<const FMA: bool>(x: &[f32], shift: &[f64], sum: &mut [f64], sum_squares: &mut [f64]) {
        for row in x.chunks_exact(shift.len()) {
            for (((x, c), s), q) in row.iter().zip(shift).zip(sum.iter_mut()).zip(sum_squares.iter_mut()) {
                let d = f64::from(*x) - c;
                *s += d;
                *q += d * d;
            }
        }
    }

    /// `total += part`.
    pub fn add_assign<const FMA: bool>(total: &mut [f32], part: &[f32]) {
        for (t, p) in total.iter_mut().zip(part) {
            *t += p;
        }
    }

    /// One Adam step (Kingma and Ba 2015, arXiv 1412.6980) on a piece of the parameters, with `g = scale * gradient`:
    ///
    /// `m <- beta1 m + (1 - beta1) g`, `v <- beta2 v + (1 - beta2) g^2`,
    /// `w <- w - step m / (sqrt(v) inverse_bias + epsilon)`.
    ///
    /// `step` is the learning rate over `1 - beta1^t`; `inverse_bias` is `1 / sqrt(1 - beta2^t)`.
    pub fn adam<const FMA: bool>(
        w: &mut [f32], m: &mut [f32], v: &mut [f32], gradient: &[f32],
        scale: f32, step: f32, inverse_bias: f32, epsilon: f32, beta1: f32, beta2: f32,
    ) {
        for (((w, m), v), g) in w.iter_mut().zip(m).zip(v).zip(gradient) {
            let g = g * scale;
            *m = madd::<FMA>(beta1, *m - g, g);
            *v = madd::<FMA>(beta2, *v - g * g, g * g);
            *w -= step * *m / madd::<FMA>(v.sqrt(), inverse_bias, epsilon);
        }
    }
}

/// Sum of squares in double precision, 16 partial sums so that it vectorises.
pub fn sum_squares(x: &[f32]) -> f64 {
    let mut partial = [0.0_f64; 16];
    for chunk in x.chunks(16) {
        for (p, x) in partial.iter_mut().zip(chunk) {
            *p += f64::from(*x) * f64::from(*x);
        }
    }
    partial.iter().sum()
}

/// Copies the rows `index` of `source`, `(.., width)`, one after the other into `out`.
pub fn gather_rows(source: &[f32], width: usize, index: &[u32], out: &mut [f32]) {
    for (out, &row) in out.chunks_exact_mut(width).zip(index) {
        let start = row as usize * width;
        out.copy_from_slice(&source[start..start + width]);
    }
}
