//! Eight lanes in one AVX2 register, with fused multiply-add.
//!
//! Values of these types may be made only where the processor has the features AVX2 and FMA; [`crate::dispatch`] sees to it.

use crate::elementary::{self, Bits};
use crate::scalar::{Mask, Scalar, Stage, Word};
use std::arch::x86_64::*;

const N: usize = 8;

/// 8 `f32`.
#[derive(Clone, Copy, Debug)]
pub struct F32x8(__m256);

/// 8 truth values.
#[derive(Clone, Copy, Debug)]
pub struct Mask8(__m256);

/// 8 `u32`.
#[derive(Clone, Copy, Debug)]
pub struct U32x8(__m256i);

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
binary!(F32x8, Add, add, |a, b| _mm256_add_ps(a, b));
binary!(F32x8, Sub, sub, |a, b| _mm256_sub_ps(a, b));
binary!(F32x8, Mul, mul, |a, b| _mm256_mul_ps(a, b));
binary!(Mask8, BitAnd, bitand, |a, b| _mm256_and_ps(a, b));
binary!(Mask8, BitOr, bitor, |a, b| _mm256_or_ps(a, b));
binary!(U32x8, Add, add, |a, b| _mm256_add_epi32(a, b));
binary!(U32x8, BitXor, bitxor, |a, b| _mm256_xor_si256(a, b));
binary!(U32x8, BitAnd, bitand, |a, b| _mm256_and_si256(a, b));
binary!(U32x8, BitOr, bitor, |a, b| _mm256_or_si256(a, b));

impl std::ops::Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsic!(_mm256_xor_ps(self.0, _mm256_set1_ps(-0.0))))
    }
}
impl std::ops::AddAssign for F32x8 {
    #[inline(always)]
    fn add_assign(&mut self, rhs: Self) {
        *self = *self + rhs;
    }
}
impl std::ops::SubAssign for F32x8 {
    #[inline(always)]
    fn sub_assign(&mut self, rhs: Self) {
        *self = *self - rhs;
    }
}
impl std::ops::Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(intrinsic!(_mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))))
    }
}
impl std::ops::Shl<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        Self(intrinsic!(_mm256_sll_epi32(self.0, _mm_cvtsi32_si128(by as i32))))
    }
}
impl std::ops::Shr<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        Self(intrinsic!(_mm256_srl_epi32(self.0, _mm_cvtsi32_si128(by as i32))))
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(intrinsic!(_mm256_castsi256_ps(_mm256_set1_epi32(-i32::from(value)))))
    }
    #[inline(always)]
    fn any(self) -> bool {
        intrinsic!(_mm256_movemask_ps(self.0)) != 0
    }
}

impl Word for U32x8 {
    #[inline(always)]
    fn splat(x: u32) -> Self {
        Self(intrinsic!(_mm256_set1_epi32(x as i32)))
    }
    #[inline(always)]
    fn mul_wide(self, by: u32) -> (Self, Self) {
        // The processor multiplies every other lane; the odd ones are shifted down, and their result up again.
        let by = Self::splat(by).0;
        let even = intrinsic!(_mm256_mul_epu32(self.0, by));
        let odd = intrinsic!(_mm256_mul_epu32(_mm256_srli_epi64::<32>(self.0), by));
        let hi = intrinsic!(_mm256_blend_epi32::<0xaa>(_mm256_srli_epi64::<32>(even), odd));
        (Self(hi), Self(intrinsic!(_mm256_mullo_epi32(self.0, by))))
    }
    #[inline(always)]
    fn load(from: &[u32]) -> Self {
        assert!(from.len() >= N);
        Self(intrinsic!(_mm256_loadu_si256(from.as_ptr().cast())))
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        assert!(to.len() >= N);
        intrinsic!(_mm256_storeu_si256(to.as_mut_ptr().cast(), self.0));
    }
}

impl Bits for F32x8 {
    #[inline(always)]
    fn to_bits(self) -> U32x8 {
        U32x8(intrinsic!(_mm256_castps_si256(self.0)))
    }
    #[inline(always)]
    fn from_bits(bits: U32x8) -> Self {
        Self(intrinsic!(_mm256_castsi256_ps(bits.0)))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(intrinsic!(_mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn to_word(self) -> U32x8 {
        U32x8(intrinsic!(_mm256_cvtps_epi32(self.0)))
    }
}

impl Scalar for F32x8 {
    type Const = f32;
    type Mask = Mask8;
    type Word = U32x8;
    const LANES: usize = N;

    #[inline(always)]
    fn splat(c: f32) -> Self {
        Self(intrinsic!(_mm256_set1_ps(c)))
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        assert!(from.len() >= N);
        Self(intrinsic!(_mm256_loadu_ps(from.as_ptr())))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        assert!(to.len() >= N);
        intrinsic!(_mm256_storeu_ps(to.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(intrinsic!(_mm256_fmadd_ps(self.0, a.0, b.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(intrinsic!(_mm256_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn rsqrt(self) -> Self {
        elementary::refine_rsqrt(self, Self(intrinsic!(_mm256_rsqrt_ps(self.0))))
    }
    #[inline(always)]
    fn recip(self) -> Self {
        elementary::refine_recip(self, Self(intrinsic!(_mm256_rcp_ps(self.0))))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsic!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsic!(_mm256_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsic!(_mm256_max_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(intrinsic!(_mm256_floor_ps(self.0)))
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
    fn lt(self, other: Self) -> Mask8 {
        Mask8(intrinsic!(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: Mask8, a: Self, b: Self) -> Self {
        Self(intrinsic!(_mm256_blendv_ps(b.0, a.0, mask.0)))
    }
    #[inline(always)]
    fn from_word(word: U32x8) -> Self {
        Self(intrinsic!(_mm256_cvtepi32_ps(word.0)))
    }
    #[inline(always)]
    fn outline<T: Stage<Self>>(stage: T) -> T::Output {
        intrinsic!(outlined(stage))
    }
    #[inline(always)]
    fn select_word(mask: Mask8, a: U32x8, b: U32x8) -> U32x8 {
        U32x8(intrinsic!(_mm256_castps_si256(_mm256_blendv_ps(
            _mm256_castsi256_ps(b.0),
            _mm256_castsi256_ps(a.0),
            mask.0
        ))))
    }
}

#[target_feature(enable = "avx2,fma")]
#[inline(never)]
fn outlined<T: Stage<F32x8>>(stage: T) -> T::Output {
    stage.run()
}
