//! Eight lanes in an array: every processor. On aarch64 the compiler turns the loops into NEON with fused
//! multiply-add, both part of that architecture's baseline.

use crate::elementary::{self, Bits};
use crate::scalar::{Mask, Scalar, Stage, Word};

const N: usize = 8;

/// Eight `f32`.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct F32x8([f32; N]);

/// Eight truth values.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Mask8([bool; N]);

/// Eight `u32`.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct U32x8([u32; N]);

/// Applies an expression lane by lane; a loop and not `array::from_fn`, which would not be inlined.
macro_rules! lanes {
    ($out:ident, $zero:expr, |$i:ident| $e:expr) => {{
        let mut out = [$zero; N];
        for $i in 0..N {
            out[$i] = $e;
        }
        $out(out)
    }};
}

macro_rules! binary {
    ($type:ident, $zero:expr, $trait:ident, $method:ident, |$a:ident, $b:ident| $e:expr) => {
        impl std::ops::$trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, rhs: Self) -> Self {
                lanes!($type, $zero, |i| {
                    let ($a, $b) = (self.0[i], rhs.0[i]);
                    $e
                })
            }
        }
    };
}
binary!(F32x8, 0.0, Add, add, |a, b| a + b);
binary!(F32x8, 0.0, Sub, sub, |a, b| a - b);
binary!(F32x8, 0.0, Mul, mul, |a, b| a * b);
binary!(Mask8, false, BitAnd, bitand, |a, b| a & b);
binary!(Mask8, false, BitOr, bitor, |a, b| a | b);
binary!(U32x8, 0, Add, add, |a, b| a.wrapping_add(b));
binary!(U32x8, 0, BitXor, bitxor, |a, b| a ^ b);
binary!(U32x8, 0, BitAnd, bitand, |a, b| a & b);
binary!(U32x8, 0, BitOr, bitor, |a, b| a | b);

impl std::ops::Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        lanes!(Self, 0.0, |i| -self.0[i])
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
        lanes!(Self, false, |i| !self.0[i])
    }
}
impl std::ops::Shl<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        lanes!(Self, 0, |i| self.0[i] << by)
    }
}
impl std::ops::Shr<u32> for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        lanes!(Self, 0, |i| self.0[i] >> by)
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.iter().any(|&b| b)
    }
}

impl Word for U32x8 {
    #[inline(always)]
    fn splat(x: u32) -> Self {
        Self([x; N])
    }
    #[inline(always)]
    fn mul_wide(self, by: u32) -> (Self, Self) {
        (
            lanes!(Self, 0, |i| ((u64::from(self.0[i]) * u64::from(by)) >> 32) as u32),
            lanes!(Self, 0, |i| self.0[i].wrapping_mul(by)),
        )
    }
    #[inline(always)]
    fn load(from: &[u32]) -> Self {
        lanes!(Self, 0, |i| from[i])
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        to[..N].copy_from_slice(&self.0);
    }
}

impl Bits for F32x8 {
    #[inline(always)]
    fn to_bits(self) -> U32x8 {
        lanes!(U32x8, 0, |i| self.0[i].to_bits())
    }
    #[inline(always)]
    fn from_bits(bits: U32x8) -> Self {
        lanes!(Self, 0.0, |i| f32::from_bits(bits.0[i]))
    }
    #[inline(always)]
    fn round(self) -> Self {
        // Adding and subtracting 1.5 * 2^23 rounds to even; `f32::round_ties_even` is a library call on SSE2.
        const MAGIC: f32 = 12_582_912.0;
        lanes!(Self, 0.0, |i| (self.0[i] + MAGIC) - MAGIC)
    }
    #[inline(always)]
    fn to_word(self) -> U32x8 {
        lanes!(U32x8, 0, |i| self.0[i] as i32 as u32)
    }
}

impl Scalar for F32x8 {
    type Const = f32;
    type Mask = Mask8;
    type Word = U32x8;
    const LANES: usize = N;
    const EPSILON: f64 = f32::EPSILON as f64;

    #[inline(always)]
    fn splat(c: f32) -> Self {
        Self([c; N])
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        lanes!(Self, 0.0, |i| from[i])
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[..N].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        // Fused only where the baseline has it: elsewhere `f32::mul_add` is a library call per lane.
        if cfg!(any(target_arch = "aarch64", target_feature = "fma")) {
            lanes!(Self, 0.0, |i| self.0[i].mul_add(a.0[i], b.0[i]))
        } else {
            self * a + b
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        lanes!(Self, 0.0, |i| self.0[i].sqrt())
    }
    #[inline(always)]
    fn rsqrt(self) -> Self {
        lanes!(Self, 0.0, |i| 1.0 / self.0[i].sqrt())
    }
    #[inline(always)]
    fn recip(self) -> Self {
        lanes!(Self, 0.0, |i| 1.0 / self.0[i])
    }
    #[inline(always)]
    fn abs(self) -> Self {
        lanes!(Self, 0.0, |i| self.0[i].abs())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        lanes!(Self, 0.0, |i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        lanes!(Self, 0.0, |i| if other.0[i] < self.0[i] { self.0[i] } else { other.0[i] })
    }
    #[inline(always)]
    fn floor(self) -> Self {
        let rounded = self.round();
        rounded - Self::indicator(self.lt(rounded))
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
        lanes!(Mask8, false, |i| self.0[i] < other.0[i])
    }
    #[inline(always)]
    fn select(mask: Mask8, a: Self, b: Self) -> Self {
        lanes!(Self, 0.0, |i| if mask.0[i] { a.0[i] } else { b.0[i] })
    }
    #[inline(always)]
    fn from_word(word: U32x8) -> Self {
        lanes!(Self, 0.0, |i| word.0[i] as i32 as f32)
    }
    #[inline(never)]
    fn outline<T: Stage<Self>>(stage: T) -> T::Output {
        stage.run()
    }
    #[inline(always)]
    fn select_word(mask: Mask8, a: U32x8, b: U32x8) -> U32x8 {
        lanes!(U32x8, 0, |i| if mask.0[i] { a.0[i] } else { b.0[i] })
    }
}
