//! Loops over `f32` compiled several times, for the widest instructions the processor has.
//!
//! [`kernels!`] turns a plain function into one copy per [`Level`](myo_scalar::Level) and picks a copy when it is called. The bodies
//! are ordinary branch-free loops that the compiler vectorises; everything they call must be `#[inline(always)]`, or
//! the call leaves the wide instruction set.

/// Whether the portable copy may fuse a product and a sum: without the instruction it would be a library call.
pub const PORTABLE_FMA: bool = cfg!(target_arch = "aarch64");

/// Compiles each function once per [`Level`](myo_scalar::Level); `FMA` says whether products and sums are fused.
macro_rules! kernels {
    ($($(#[$meta:meta])* pub fn $name:ident<const FMA: bool>($($arg:ident: $ty:ty),* $(,)?) $(-> $ret:ty)? $body:block)*) => { $(
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        pub fn $name($($arg: $ty),*) $(-> $ret)? {
            #[inline(always)]
            fn body<const FMA: bool>($($arg: $ty),*) $(-> $ret)? $body

            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma")]
                fn avx512($($arg: $ty),*) $(-> $ret)? { body::<true>($($arg),*) }
                #[target_feature(enable = "avx2,fma")]
                fn avx2($($arg: $ty),*) $(-> $ret)? { body::<true>($($arg),*) }
                match myo_scalar::Level::current().instructions() {
                    // SAFETY: a `Level` exists only where every feature that the function enables was detected.
                    myo_scalar::Instructions::Avx512 => return unsafe { avx512($($arg),*) },
                    // SAFETY: as above.
                    myo_scalar::Instructions::Avx2 => return unsafe { avx2($($arg),*) },
                    myo_scalar::Instructions::Portable => {}
                }
            }
            body::<{ $crate::simd::PORTABLE_FMA }>($($arg),*)
        }
    )* };
}
pub(crate) use kernels;

/// `a * b + c`, fused where `FMA` is set.
#[inline(always)]
pub fn madd<const FMA: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

/// `x` between `low` and `high`; NaN becomes `low`. Two instructions, where `f32::clamp` needs more.
#[inline(always)]
pub fn clip(x: f32, low: f32, high: f32) -> f32 {
    let x = if x > low { x } else { low };
    if x < high { x } else { high }
}

/// `exp(x)`, relative error below 3e-7 for -87 <= x <= 88 and held there outside.
///
/// `exp(x) = 2^n exp(r)`, `n` the nearest integer to `x / ln 2`, `|r| <= ln 2 / 2`, Taylor series of degree 7.
#[inline(always)]
pub fn exp<const FMA: bool>(x: f32) -> f32 {
    // Adding 1.5 * 2^23 rounds to the nearest integer and leaves it in the low bits of the sum.
    const ROUND: f32 = 12_582_912.0;
    // ln 2 in two parts, the first short enough that `n * LN2_HIGH` is exact.
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let x = clip(x, -87.0, 88.0);
    let shifted = madd::<FMA>(x, std::f32::consts::LOG2_E, ROUND);
    let n = shifted - ROUND;
    let r = madd::<FMA>(n, -LN2_LOW, madd::<FMA>(n, -LN2_HIGH, x));
    let mut p = 1.0 / 5040.0;
    p = madd::<FMA>(p, r, 1.0 / 720.0);
    p = madd::<FMA>(p, r, 1.0 / 120.0);
    p = madd::<FMA>(p, r, 1.0 / 24.0);
    p = madd::<FMA>(p, r, 1.0 / 6.0);
    p = madd::<FMA>(p, r, 0.5);
    p = madd::<FMA>(p, r, 1.0);
    p = madd::<FMA>(p, r, 1.0);
    // The integer n, read from the bits of `shifted`, goes into the exponent field.
    let power = f32::from_bits((shifted.to_bits() << 23).wrapping_add(127 << 23));
    p * power
}

/// `1 / (1 + exp(-x))`.
#[inline(always)]
pub fn sigmoid<const FMA: bool>(x: f32) -> f32 {
    1.0 / (1.0 + exp::<FMA>(-x))
}

/// Natural logarithm of a normal positive number, relative error below 3e-7 away from 1, absolute below 1e-7 near it.
///
/// `x = 2^e m`, `m` in [sqrt 1/2, sqrt 2); `ln m = 2 atanh(s)`, `s = (m - 1) / (m + 1)`, five terms of the series.
#[inline(always)]
pub fn ln<const FMA: bool>(x: f32) -> f32 {
    // Bits of sqrt(1/2): the difference of exponent fields to it is `e`, whatever the mantissa.
    const SQRT_HALF: u32 = 0x3f35_04f3;
    let e = (x.to_bits().wrapping_sub(SQRT_HALF) as i32) >> 23;
    let m = f32::from_bits(x.to_bits().wrapping_sub((e as u32) << 23));
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let mut p = 2.0 / 9.0;
    p = madd::<FMA>(p, s2, 2.0 / 7.0);
    p = madd::<FMA>(p, s2, 2.0 / 5.0);
    p = madd::<FMA>(p, s2, 2.0 / 3.0);
    p = madd::<FMA>(p, s2, 2.0);
    madd::<FMA>(e as f32, std::f32::consts::LN_2, s * p)
}

/// `(sin 2 pi t, cos 2 pi t)` for `t` in [0, 1], absolute error below 2e-7: the nearest quarter turn is taken off and
/// the rest, at most an eighth, goes through Taylor series.
#[inline(always)]
pub fn sin_cos_turns<const FMA: bool>(t: f32) -> (f32, f32) {
    let quarter = madd::<FMA>(t, 4.0, 0.5) as i32;
    let a = madd::<FMA>(quarter as f32, -0.25, t) * std::f32::consts::TAU;
    let a2 = a * a;
    let mut s = 1.0 / 362_880.0;
    s = madd::<FMA>(s, a2, -1.0 / 5040.0);
    s = madd::<FMA>(s, a2, 1.0 / 120.0);
    s = madd::<FMA>(s, a2, -1.0 / 6.0);
    s = madd::<FMA>(s, a2, 1.0) * a;
    let mut c = 1.0 / 40_320.0;
    c = madd::<FMA>(c, a2, -1.0 / 720.0);
    c = madd::<FMA>(c, a2, 1.0 / 24.0);
    c = madd::<FMA>(c, a2, -0.5);
    c = madd::<FMA>(c, a2, 1.0);
    let (sin, cos) = if quarter & 1 == 0 { (s, c) } else { (c, s) };
    let sin_sign = ((quarter as u32) & 2) << 30;
    let cos_sign = ((quarter as u32).wrapping_add(1) & 2) << 30;
    (f32::from_bits(sin.to_bits() ^ sin_sign), f32::from_bits(cos.to_bits() ^ cos_sign))
}

#[cfg(test)]
mod tests {
    use super::*;

    kernels! {
        /// `exp` of every entry.
        pub fn exp_all<const FMA: bool>(x: &mut [f32]) {
            for x in x {
                *x = exp::<FMA>(*x);
            }
        }
    }

    #[test]
    fn exp_agrees_with_the_library_on_every_level() {
        let xs: Vec<f32> = (-8700..8800).map(|i| i as f32 * 0.01).collect();
        let mut ys = xs.clone();
        exp_all(&mut ys);
        // Levels differ in whether products and sums are fused, and in nothing else.
        let [plain, fused]: [Vec<f32>; 2] = [exp::<false>, exp::<true>].map(|exp| xs.iter().map(|&x| exp(x)).collect());
        assert!(ys == plain || ys == fused);
        for (i, &x) in xs.iter().enumerate() {
            let exact = f64::from(x).exp();
            for got in [plain[i], fused[i]] {
                assert!((f64::from(got) / exact - 1.0).abs() < 3e-7, "exp({x}) = {got}, not {exact}");
            }
        }
        for exp in [exp::<false>, exp::<true>] {
            assert!(exp(f32::INFINITY).is_finite() && exp(f32::NEG_INFINITY) > 0.0);
        }
    }

    #[test]
    fn ln_and_sin_cos_agree_with_the_library() {
        check_ln_and_sin_cos(ln::<false>, sin_cos_turns::<false>);
        check_ln_and_sin_cos(ln::<true>, sin_cos_turns::<true>);
    }

    fn check_ln_and_sin_cos(ln: impl Fn(f32) -> f32, sin_cos_turns: impl Fn(f32) -> (f32, f32)) {
        for i in 1..=20_000 {
            let x = i as f32 / 20_000.0;
            let exact = f64::from(x).ln();
            assert!((f64::from(ln(x)) - exact).abs() < 3e-7 * exact.abs() + 1e-7, "ln({x})");
            let (s, c) = sin_cos_turns(x);
            let angle = f64::from(x) * std::f64::consts::TAU;
            assert!((f64::from(s) - angle.sin()).abs() < 3e-7, "sin({x} turns) = {s}");
            assert!((f64::from(c) - angle.cos()).abs() < 3e-7, "cos({x} turns) = {c}");
        }
    }
}
