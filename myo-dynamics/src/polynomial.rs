//! Polynomials in one coordinate, fitted to smooth functions that are known exactly but cost more to evaluate.

use crate::cast::{Cast, cast};
use myo_scalar::{Real, Scalar};

/// The interval a polynomial is fitted on, mapped to [-1, 1], and how far past its ends the polynomial is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain<C> {
    scale: C,
    offset: C,
    reach: C,
}

impl Domain<f64> {
    /// The interval from `lo` to `hi`, followed by `beyond` past either end.
    pub fn new(lo: f64, hi: f64, beyond: f64) -> Self {
        let scale = 2.0 / (hi - lo);
        Self { scale, offset: -(lo + hi) / 2.0 * scale, reach: 1.0 + beyond * scale }
    }
    /// Points past the ends, as far as the polynomial is followed.
    pub fn beyond(&self) -> impl Iterator<Item = f64> {
        let step = (self.reach - 1.0) / BEYOND as f64;
        (1..=BEYOND).map(move |k| 1.0 + step * k as f64).flat_map(|t| [-t, t])
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

cast!(Domain { scale, offset, reach });

impl<C: Real> Domain<C> {
    /// Maps a coordinate to the polynomial's argument, held where the polynomial is followed no farther; true where it is
    /// not held.
    #[inline(always)]
    pub fn map<S: Scalar<Const = C>>(&self, q: S) -> (S, S::Mask) {
        let reach = S::splat(self.reach);
        let t = q.mul_add(S::splat(self.scale), S::splat(self.offset));
        (t.max(-reach).min(reach), t.abs().lt(reach))
    }
}

/// A polynomial in `t`, highest power first; empty is zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial<C>(Vec<C>);

impl<C: Cast<D>, D> Cast<D> for Polynomial<C> {
    type Output = Polynomial<C::Output>;
    fn cast(&self) -> Self::Output {
        Polynomial(self.0.cast())
    }
}

impl<C: Real> Polynomial<C> {
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
/// Points past each end at which the fit is checked.
const BEYOND: usize = 8;
/// How much worse than its tolerance a fit may be there.
const BEYOND_FACTOR: f64 = 1e3;

/// Chebyshev points of the second sampling, on [-1, 1].
pub fn nodes() -> impl Iterator<Item = f64> {
    (0..SAMPLES).map(|k| ((k as f64 + 0.5) * std::f64::consts::PI / SAMPLES as f64).cos())
}

/// Number of [`nodes`].
pub const NODES: usize = SAMPLES;

/// Fits values given at [`nodes`] and then at [`Domain::beyond`] by a truncated Chebyshev series of the least degree whose
/// error stays below `tolerance`; none if no degree up to sixteen does, or if the polynomial leaves the function past the
/// ends by a thousand times as much.
pub fn fit(domain: &Domain<f64>, values: &[f64], tolerance: f64) -> Option<Polynomial<f64>> {
    let (values, beyond) = values.split_at(SAMPLES);
    let fitted = fit_between(values, tolerance)?;
    let close = |(t, value): (f64, &f64)| (fitted.value(t) - value).abs() <= BEYOND_FACTOR * tolerance;
    domain.beyond().zip(beyond).all(close).then_some(fitted)
}

fn fit_between(values: &[f64], tolerance: f64) -> Option<Polynomial<f64>> {
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

    const DOMAIN: (f64, f64, f64) = (-0.5, 3.0, 0.4);

    fn domain() -> Domain<f64> {
        Domain::new(DOMAIN.0, DOMAIN.1, DOMAIN.2)
    }
    fn fit_of(f: impl Fn(f64) -> f64, tolerance: f64) -> Option<Polynomial<f64>> {
        let domain = domain();
        let values: Vec<f64> = nodes().chain(domain.beyond()).map(|t| f(domain.at(t))).collect();
        fit(&domain, &values, tolerance)
    }

    #[test]
    fn fit_reproduces_a_smooth_function_and_its_slope() {
        let domain = domain();
        let fitted = fit_of(|q| 0.3 * q.sin(), 1e-9).expect("a sine over half a turn is smooth");
        for k in 0..100 {
            let q = -0.5 + 3.5 * k as f64 / 99.0;
            let t = domain.map(q).0;
            let (value, slope) = (fitted.value(t), fitted.derivative().value(t));
            assert!((value - 0.3 * q.sin()).abs() < 2e-9, "{q}");
            assert!((slope * domain.scale() - 0.3 * q.cos()).abs() < 1e-7, "{q}");
        }
    }

    #[test]
    fn a_fit_is_followed_past_its_ends_and_then_held() {
        let domain = domain();
        let fitted = fit_of(|q| 0.3 * q.sin(), 1e-9).unwrap();
        for q in [-0.8999, -0.7, 3.1, 3.3999] {
            let (t, is_free) = domain.map::<f64>(q);
            assert!(is_free && (fitted.value(t) - 0.3 * q.sin()).abs() < 1e-6, "{q}");
        }
        for (q, end) in [(-1e6, -0.9), (-0.9001, -0.9), (3.4001, 3.4), (1e6, 3.4)] {
            let (t, is_free) = domain.map::<f64>(q);
            assert!(!is_free && (domain.at(t) - end).abs() < 1e-12, "{q}");
        }
    }

    #[test]
    fn constants_take_one_coefficient_and_zero_takes_none() {
        assert_eq!(fit_of(|_| 2.0, 1e-9).map(|p| p.0.len()), Some(1));
        assert_eq!(fit_of(|_| 0.0, 1e-9).map(|p| p.0.len()), Some(0));
    }

    #[test]
    fn a_kink_is_refused_wherever_it_is() {
        assert_eq!(fit_of(|q| (q - 1.0).abs(), 1e-9), None);
        assert_eq!(fit_of(|q| (q - 3.1).max(0.0), 1e-9), None);
    }
}
