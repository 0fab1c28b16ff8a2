//! `f64` and `f32`: one environment, the standard library's mathematics.

use crate::scalar::{Mask, Real, Scalar, Stage, Word};

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
}

/// `u32` in a wrapper, because the standard integer panics where this one wraps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct U32(u32);

macro_rules! word_op {
    ($trait:ident, $method:ident, $rhs:ty, |$a:ident, $b:ident| $e:expr) => {
        impl std::ops::$trait<$rhs> for U32 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, rhs: $rhs) -> Self {
                let ($a, $b) = (self, rhs);
                Self($e)
            }
        }
    };
}
word_op!(Add, add, U32, |a, b| a.0.wrapping_add(b.0));
word_op!(BitXor, bitxor, U32, |a, b| a.0 ^ b.0);
word_op!(BitAnd, bitand, U32, |a, b| a.0 & b.0);
word_op!(BitOr, bitor, U32, |a, b| a.0 | b.0);
word_op!(Shl, shl, u32, |a, b| a.0 << b);
word_op!(Shr, shr, u32, |a, b| a.0 >> b);

impl Word for U32 {
    #[inline(always)]
    fn splat(x: u32) -> Self {
        Self(x)
    }
    #[inline(always)]
    fn mul_wide(self, by: u32) -> (Self, Self) {
        let product = u64::from(self.0) * u64::from(by);
        (Self((product >> 32) as u32), Self(product as u32))
    }
    #[inline(always)]
    fn load(from: &[u32]) -> Self {
        Self(from[0])
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        to[0] = self.0;
    }
}

macro_rules! plain_scalar {
    ($t:ty) => {
        impl Real for $t {
            #[inline(always)]
            fn from_f64(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }

        impl Scalar for $t {
            type Const = $t;
            type Mask = bool;
            type Word = U32;
            const LANES: usize = 1;
            const EPSILON: f64 = <$t>::EPSILON as f64;

            #[inline(always)]
            fn splat(c: $t) -> Self {
                c
            }
            #[inline(always)]
            fn load(from: &[$t]) -> Self {
                from[0]
            }
            #[inline(always)]
            fn store(self, to: &mut [$t]) {
                to[0] = self;
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                // Not `mul_add`: without the FMA feature that is a call into the mathematics library.
                self * a + b
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn rsqrt(self) -> Self {
                1.0 / <$t>::sqrt(self)
            }
            #[inline(always)]
            fn recip(self) -> Self {
                1.0 / self
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                <$t>::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                <$t>::max(self, other)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                <$t>::floor(self)
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                <$t>::sin_cos(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                <$t>::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                <$t>::ln(self)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn select(mask: bool, a: Self, b: Self) -> Self {
                if mask { a } else { b }
            }
            #[inline(always)]
            fn from_word(word: U32) -> Self {
                word.0 as $t
            }
            #[inline(never)]
            fn outline<T: Stage<Self>>(stage: T) -> T::Output {
                stage.run()
            }
            #[inline(always)]
            fn select_word(mask: bool, a: U32, b: U32) -> U32 {
                if mask { a } else { b }
            }
        }
    };
}
plain_scalar!(f64);
plain_scalar!(f32);
