//! Polynomials in one coordinate, fitted to smooth functions that are known exactly but cost more to evaluate.

use myo_scalar::{Real, Scalar};

/// The interval a fit holds on, mapped to [-1, 1]; beyond it the argument is held at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain<C> {
    scale: C,
    offset: C,
}

impl Domain<f64> {
    /// The interval from `lo` to `hi`.
    pub fn new(lo: f64, hi: f64) -> Self {
        let scale = 2.0 / (hi - lo);
        Self { scale, offset: -(lo + hi) / 2.0 * scale }
    }
    /// The point of the interval that maps to `t`.
    pub fn at(&self, t: f64) -> f64 {
        (t - self.offset) / self.scale
    }
    /// `dt / dq`.
    pub fn scale(&self) -> f64 {
        self.scale
    }
}

impl<C: Real> Domain<C> {
    /// The same interval in another precision.
    pub fn cast<D: Real>(&self) -> Domain<D> {
        Domain { scale: D::from_f64(self.scale.to_f64()), offset: D::from_f64(self.offset.to_f64()) }
    }
    /// Maps a coordinate to [-1, 1].
    #[inline(always)]
    pub fn map<S: Scalar<Const = C>>(&self, q: S) -> S {
        q.mul_add(S::splat(self.scale), S::splat(self.offset)).clamp(-1.0, 1.0)
    }
}

/// A polynomial in `t`, highest power first; empty is zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial<C>(Vec<C>);

impl<C: Real> Polynomial<C> {
    /// The same polynomial in another precision.
    pub fn cast<D: Real>(&self) -> Polynomial<D> {
        Polynomial(self.0.iter().map(|c| D::from_f64(c.to_f64())).collect())
    }
    /// Value at `t`.
    #[inline(always)]
    pub fn value<S: Scalar<Const = C>>(&self, t: S) -> S {
        let Some((&first, rest)) = self.0.split_first() else { return S::zero() };
        let mut y = S::splat(first);
        for &c in rest {
            y = y.mul_add(t, S::splat(c));
        }
        y
    }
}

impl Polynomial<f64> {
    /// The derivative with respect to `t`.
    pub fn derivative(&self) -> Self {
        let powers = (1..self.0.len()).rev();
        Self(self.0.iter().zip(powers).map(|(c, power)| c * power as f64).collect())
    }
    /// The polynomial times a number.
    pub fn scaled(&self, by: f64) -> Self {
        Self(self.0.iter().map(|c| c * by).collect())
    }
}

/// Highest degree that a fit may have: beyond it single precision gains nothing.
const MAX_DEGREE: usize = 16;
/// Points at which the fit is sampled; many more than its degree, so that aliasing is negligible.
const SAMPLES: usize = 48;

/// Chebyshev points of the second sampling, on [-1, 1].
pub fn nodes() -> impl Iterator<Item = f64> {
    (0..SAMPLES).map(|k| ((k as f64 + 0.5) * std::f64::consts::PI / SAMPLES as f64).cos())
}

/// Fits values given at [`nodes`] by a truncated Chebyshev series of the least degree whose error stays below
/// `tolerance`; none if no degree up to sixteen does.
pub fn fit(values: &[f64], tolerance: f64) -> Option<Polynomial<f64>> {
    let coefficients = chebyshev_coefficients(values);
    let mut tail: f64 = coefficients[MAX_DEGREE + 1..].iter().map(|c| c.abs()).sum();
    if tail > tolerance {
        return None;
    }
    let mut degree = MAX_DEGREE as isize;
    while degree >= 0 && tail + coefficients[degree as usize].abs() <= tolerance {
        tail += coefficients[degree as usize].abs();
        degree -= 1;
    }
    Some(to_monomials(&coefficients[..(degree + 1) as usize]))
}

fn chebyshev_coefficients(values: &[f64]) -> Vec<f64> {
    let n = SAMPLES as f64;
    (0..SAMPLES)
        .map(|j| {
            let sum: f64 = values
                .iter()
                .enumerate()
                .map(|(k, v)| v * (j as f64 * (k as f64 + 0.5) * std::f64::consts::PI / n).cos())
                .sum();
            sum * if j == 0 { 1.0 } else { 2.0 } / n
        })
        .collect()
}

fn to_monomials(chebyshev: &[f64]) -> Polynomial<f64> {
    let n = chebyshev.len();
    let mut out = vec![0.0; n];
    // T_0 = 1, T_1 = t, T_{j+1} = 2 t T_j - T_{j-1}; coefficients with the constant first.
    let (mut before, mut current) = (vec![0.0; n], vec![0.0; n]);
    for (j, &c) in chebyshev.iter().enumerate() {
        let mut next = vec![0.0; n];
        match j {
            0 => next[0] = 1.0,
            1 => next[1] = 1.0,
            _ => {
                for k in 0..n {
                    next[k] = -before[k] + if k > 0 { 2.0 * current[k - 1] } else { 0.0 };
                }
            }
        }
        for k in 0..n {
            out[k] += c * next[k];
        }
        (before, current) = (current, next);
    }
    out.reverse();
    Polynomial(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fit_reproduces_a_smooth_function_and_its_slope() {
        let domain = Domain::new(-0.5, 3.0);
        let values: Vec<f64> = nodes().map(|t| domain.at(t).sin() * 0.3).collect();
        let fitted = fit(&values, 1e-9).expect("a sine over half a turn is smooth");
        for k in 0..100 {
            let q = -0.5 + 3.5 * k as f64 / 99.0;
            let (value, slope) = (fitted.value(domain.map(q)), fitted.derivative().value(domain.map(q)));
            assert!((value - 0.3 * q.sin()).abs() < 2e-9, "{q}");
            assert!((slope * domain.scale() - 0.3 * q.cos()).abs() < 1e-7, "{q}");
            assert_eq!(value, fitted.value(domain.map(q)));
        }
    }

    #[test]
    fn constants_take_one_coefficient_and_zero_takes_none() {
        assert_eq!(fit(&[2.0; SAMPLES], 1e-9).map(|p| p.0.len()), Some(1));
        assert_eq!(fit(&[0.0; SAMPLES], 1e-9).map(|p| p.0.len()), Some(0));
    }

    #[test]
    fn a_kink_is_refused() {
        let values: Vec<f64> = nodes().map(f64::abs).collect();
        assert_eq!(fit(&values, 1e-9), None);
    }
}
