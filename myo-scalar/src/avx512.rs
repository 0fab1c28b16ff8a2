//! Sixteen lanes in one AVX-512 register.
//!
//! Values of these types may be made only where the processor has the features AVX-512 F, DQ and VL; [`crate::dispatch`] sees to it.

use crate::elementary::{self, Bits};
use crate::scalar::{Mask, Scalar, Stage, Word};
use std::arch::x86_64::*;

const N: usize = 16;

/// 16 `f32`.
#[derive(Clone, Copy, Debug)]
pub struct F32x16(__m512);

/// 16 truth values.
#[derive(Clone, Copy, Debug)]
pub struct Mask16(__mmask16);

/// 16 `u32`.
#[derive(Clone, Copy, Debug)]
pub struct U32x16(__m512i);

/// An expression of processor intrinsics.
macro_rules! intrinsic {
    ($e:expr) => {
        // SAFETY: these types are used only inside `dispatch`, which checked the processor's features.
        unsafe { $e }
    };
}

macro_rules! binary {
    ($type:ident, $trait:ident, $method:ident, |$a:ident, $b:ident| $e:expr) => {
        impl std::ops::$trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, rhs: Self) -> Self {
                let ($a, $b) = (self.0, rhs.0);
                Self(intrinsic!($e))
            }
        }
    };
}
binary!(F32x16, Add, add, |a, b| _mm512_add_ps(a, b));
binary!(F32x16, Sub, sub, |a, b| _mm512_sub_ps(a, b));
binary!(F32x16, Mul, mul, |a, b| _mm512_mul_ps(a, b));
binary!(U32x16, Add, add, |a, b| _mm512_add_epi32(a, b));
binary!(U32x16, BitXor, bitxor, |a, b| _mm512_xor_si512(a, b));
binary!(U32x16, BitAnd, bitand, |a, b| _mm512_and_si512(a, b));
binary!(U32x16, BitOr, bitor, |a, b| _mm512_or_si512(a, b));

impl std::ops::Neg for F32x16 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsic!(_mm512_xor_ps(self.0, _mm512_set1_ps(-0.0))))
    }
}
impl std::ops::AddAssign for F32x16 {
    #[inline(always)]
    fn add_assign(&mut self, rhs: Self) {
        *self = *self + rhs;
    }
}
impl std::ops::SubAssign for F32x16 {
    #[inline(always)]
    fn sub_assign(&mut self, rhs: Self) {
        *self = *self - rhs;
    }
}
impl std::ops::BitAnd for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, rhs: Self) -> Self {
        Self(self.0 & rhs.0)
    }
}
impl std::ops::BitOr for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, rhs: Self) -> Self {
        Self(self.0 | rhs.0)
    }
}
impl std::ops::Not for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}
impl std::ops::Shl<u32> for U32x16 {
    type Output = Self;
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        Self(intrinsic!(_mm512_sll_epi32(self.0, _mm_cvtsi32_si128(by as i32))))
    }
}
impl std::ops::Shr<u32> for U32x16 {
    type Output = Self;
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        Self(intrinsic!(_mm512_srl_epi32(self.0, _mm_cvtsi32_si128(by as i32))))
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(if value { !0 } else { 0 })
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }
}

impl Word for U32x16 {
    #[inline(always)]
    fn splat(x: u32) -> Self {
        Self(intrinsic!(_mm512_set1_epi32(x as i32)))
    }
    #[inline(always)]
    fn mul_wide(self, by: u32) -> (Self, Self) {
        // The processor multiplies every other lane; the odd ones are shifted down, and their result up again.
        let by = Self::splat(by).0;
        let even = intrinsic!(_mm512_mul_epu32(self.0, by));
        let odd = intrinsic!(_mm512_mul_epu32(_mm512_srli_epi64::<32>(self.0), by));
        let hi = intrinsic!(_mm512_mask_blend_epi32(0xaaaa, _mm512_srli_epi64::<32>(even), odd));
        (Self(hi), Self(intrinsic!(_mm512_mullo_epi32(self.0, by))))
    }
    #[inline(always)]
    fn load(from: &[u32]) -> Self {
        assert!(from.len() >= N);
        Self(intrinsic!(_mm512_loadu_si512(from.as_ptr().cast())))
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        assert!(to.len() >= N);
        intrinsic!(_mm512_storeu_si512(to.as_mut_ptr().cast(), self.0));
    }
}

impl Bits for F32x16 {
    #[inline(always)]
    fn to_bits(self) -> U32x16 {
        U32x16(intrinsic!(_mm512_castps_si512(self.0)))
    }
    #[inline(always)]
    fn from_bits(bits: U32x16) -> Self {
        Self(intrinsic!(_mm512_castsi512_ps(bits.0)))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(intrinsic!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn to_word(self) -> U32x16 {
        U32x16(intrinsic!(_mm512_cvtps_epi32(self.0)))
    }
}

impl Scalar for F32x16 {
    type Const = f32;
    type Mask = Mask16;
    type Word = U32x16;
    const LANES: usize = N;

    #[inline(always)]
    fn splat(c: f32) -> Self {
        Self(intrinsic!(_mm512_set1_ps(c)))
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        assert!(from.len() >= N);
        Self(intrinsic!(_mm512_loadu_ps(from.as_ptr())))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        assert!(to.len() >= N);
        intrinsic!(_mm512_storeu_ps(to.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(intrinsic!(_mm512_fmadd_ps(self.0, a.0, b.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(intrinsic!(_mm512_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn rsqrt(self) -> Self {
        elementary::refine_rsqrt(self, Self(intrinsic!(_mm512_rsqrt14_ps(self.0))))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        elementary::refine_recip(self, Self(intrinsic!(_mm512_rcp14_ps(self.0))))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsic!(_mm512_abs_ps(self.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsic!(_mm512_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsic!(_mm512_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(intrinsic!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        elementary::sin_cos(self)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        elementary::ln(self)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask16 {
        Mask16(intrinsic!(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: Mask16, a: Self, b: Self) -> Self {
        Self(intrinsic!(_mm512_mask_blend_ps(mask.0, b.0, a.0)))
    }
    #[inline(always)]
    fn from_word(word: U32x16) -> Self {
        Self(intrinsic!(_mm512_cvtepi32_ps(word.0)))
    }
    #[inline(always)]
    fn outline<T: Stage<Self>>(stage: T) -> T::Output {
        intrinsic!(outlined(stage))
    }
    #[inline(always)]
    fn select_word(mask: Mask16, a: U32x16, b: U32x16) -> U32x16 {
        U32x16(intrinsic!(_mm512_mask_blend_epi32(mask.0, b.0, a.0)))
    }
}

#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
#[inline(never)]
fn outlined<T: Stage<F32x16>>(stage: T) -> T::Output {
    stage.run()
}
