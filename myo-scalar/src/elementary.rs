//! Elementary functions of `f32` lanes and symbolic numbers, from the operations that every processor has.
//!
//! The polynomials are the single-precision ones of the Cephes library (Moshier 1989), which are minimax on the
//! reduced ranges; errors stay near one unit in the last place.

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

#[inline(always)]
pub(crate) fn sin_cos<S: Bits>(x: S) -> (S, S) {
    // x = quadrant * pi/2 + r, with pi/2 in three parts (Cody and Waite) so that r keeps its precision.
    let quadrant = (x * S::lit(std::f64::consts::FRAC_2_PI)).round();
    let r = quadrant.mul_add(S::lit(-1.570_312_5), x);
    let r = quadrant.mul_add(S::lit(-4.837_512_969_970_703e-4), r);
    let r = quadrant.mul_add(S::lit(-7.549_789_948_768_648e-8), r);
    let r2 = r * r;
    let sin = (poly(r2, [-1.951_529_589_1e-4, 8.332_160_873_6e-3, -1.666_665_461_1e-1]) * r2).mul_add(r, r);
    let cos = poly(r2, [2.443_315_711_8e-5, -1.388_731_625_49e-3, 4.166_664_568_3e-2]);
    let cos = (cos * r2).mul_add(r2, r2.mul_add(S::lit(-0.5), S::lit(1.0)));
    // The two low bits of the quadrant swap and flip: bit 0 swaps, bit 1 negates the sine, their sum the cosine.
    let q = quadrant.to_word();
    let one = S::Word::splat(1);
    let swap = S::lit(0.5).lt(S::from_word(q & one));
    let sin_sign = (q & S::Word::splat(2)) << 30;
    let cos_sign = ((q + one) & S::Word::splat(2)) << 30;
    let (s, c) = (S::select(swap, cos, sin), S::select(swap, sin, cos));
    (S::from_bits(s.to_bits() ^ sin_sign), S::from_bits(c.to_bits() ^ cos_sign))
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
