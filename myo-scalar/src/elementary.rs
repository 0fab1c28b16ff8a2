//! Elementary functions of `f32` lanes and symbolic numbers, from the operations that every processor has.
//!
//! The polynomials of exponential and logarithm are the single-precision ones of the Cephes library (Moshier 1989), which
//! are minimax on the reduced ranges; errors stay near one unit in the last place.

use crate::scalar::{Scalar, Word};

/// What the elementary functions need beyond [`Scalar`]: the bits of a number.
pub(crate) trait Bits: Scalar {
    fn to_bits(self) -> Self::Word;
    fn from_bits(bits: Self::Word) -> Self;
    /// Nearest whole number.
    fn round(self) -> Self;
    /// Converts whole numbers in (-2^31, 2^31) to two's complement.
    fn to_word(self) -> Self::Word;
}

#[inline(always)]
fn poly<S: Scalar, const N: usize>(x: S, c: [f64; N]) -> S {
    let mut y = S::lit(c[0]);
    for &c in &c[1..] {
        y = y.mul_add(x, S::lit(c));
    }
    y
}

/// `(sin r - r) / r^3` and `(cos r - 1) / r^2` in `r^2`, for r in [-pi/2, pi/2]: minimax in the absolute error of the sine
/// (5e-9) and the cosine (3e-10), by Remez' algorithm.
const SIN: [f64; 4] = [2.600_039_269_722_5e-6, -1.980_660_828_013_2e-4, 8.333_017_197_562_2e-3, -0.166_666_570_927_88];
const COS: [f64; 5] = [
    -2.607_696_227_838_9e-7,
    2.476_187_855_083_7e-5,
    -1.388_840_336_772_8e-3,
    4.166_664_071_818_5e-2,
    -0.499_999_995_493_49,
];

#[inline(always)]
pub(crate) fn sin_cos<S: Bits>(x: S) -> (S, S) {
    // x = half_turns * pi + r, with pi in three parts (Cody and Waite) so that r keeps its precision.
    let half_turns = (x * S::lit(std::f64::consts::FRAC_1_PI)).round();
    let r = half_turns.mul_add(S::lit(-3.140_625), x);
    let r = half_turns.mul_add(S::lit(-9.675_025_939_941_406e-4), r);
    let r = half_turns.mul_add(S::lit(-1.509_957_989_753_729_6e-7), r);
    let r2 = r * r;
    let sin = (poly(r2, SIN) * r2).mul_add(r, r);
    let cos = poly(r2, COS).mul_add(r2, S::lit(1.0));
    // Odd half turns flip both signs.
    let sign = half_turns.to_word() << 31;
    (S::from_bits(sin.to_bits() ^ sign), S::from_bits(cos.to_bits() ^ sign))
}

#[inline(always)]
pub(crate) fn exp<S: Bits>(x: S) -> S {
    // Beyond these bounds the result would leave the normal numbers.
    let x = x.clamp(-87.0, 88.0);
    let n = (x * S::lit(std::f64::consts::LOG2_E)).round();
    let r = n.mul_add(S::lit(-0.693_359_375), x);
    let r = n.mul_add(S::lit(2.121_944_400_546_905_8e-4), r);
    let p = poly(
        r,
        [
            1.987_569_15e-4,
            1.398_199_950_7e-3,
            8.333_451_907_3e-3,
            4.166_579_589_4e-2,
            1.666_666_545_9e-1,
            5.000_000_120_1e-1,
        ],
    );
    let y = (p * r).mul_add(r, r) + S::lit(1.0);
    y * S::from_bits((n.to_word() + S::Word::splat(127)) << 23)
}

#[inline(always)]
pub(crate) fn ln<S: Bits>(x: S) -> S {
    // x = m * 2^e with m in [sqrt(1/2), sqrt(2)).
    let bits = x.to_bits();
    let e = S::from_word(bits >> 23) - S::lit(126.0);
    let m = S::from_bits((bits & S::Word::splat(0x007f_ffff)) | S::Word::splat(0x3f00_0000));
    let small = m.lt(S::lit(std::f64::consts::FRAC_1_SQRT_2));
    let e = e - S::indicator(small);
    let f = m + m.only(small) - S::lit(1.0);
    let z = f * f;
    let p = poly(
        f,
        [
            7.037_683_629_2e-2,
            -1.151_461_031e-1,
            1.167_699_874e-1,
            -1.242_014_084_6e-1,
            1.424_932_278_7e-1,
            -1.666_805_766_5e-1,
            2.000_071_476_5e-1,
            -2.499_999_399_3e-1,
            3.333_333_117_4e-1,
        ],
    );
    let y = p * f * z;
    let y = e.mul_add(S::lit(-2.121_944_4e-4), y);
    let y = z.mul_add(S::lit(-0.5), y);
    e.mul_add(S::lit(0.693_359_375), f + y)
}

/// `1 / sqrt(x)` from a rough estimate by one step of Newton's method.
#[inline(always)]
pub(crate) fn refine_rsqrt<S: Scalar>(x: S, y: S) -> S {
    // y (3 - x y^2) / 2
    let half_xy = x * S::lit(0.5) * y;
    y.mul_add((-half_xy).mul_add(y, S::lit(0.5)), y)
}

/// `1 / x` from a rough estimate by one step of Newton's method.
#[inline(always)]
pub(crate) fn refine_recip<S: Scalar>(x: S, y: S) -> S {
    y.mul_add((-x).mul_add(y, S::lit(1.0)), y)
}
