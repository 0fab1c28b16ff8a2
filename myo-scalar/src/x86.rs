//! Lanes in one x86 register: the two widths differ only in the names of their instructions.
//!
//! Values of these types may be made only where the processor has the features that their module names;
//! [`crate::dispatch`] sees to it.

/// An expression of processor intrinsics.
macro_rules! intrinsic {
    ($e:expr) => {{
        // SAFETY: these types are used only inside `dispatch`, which checked the processor's features.
        unsafe { $e }
    }};
}

/// One binary operator of a register type.
macro_rules! binary {
    ($type:ident, $trait:ident, $method:ident, $e:expr) => {
        impl std::ops::$trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, rhs: Self) -> Self {
                Self(intrinsic!($e(self.0, rhs.0)))
            }
        }
    };
}

/// Defines numbers, truth values and integers of one register width, and everything that [`crate::Scalar`] asks of them.
/// What instructions of the same name do not cover is given as small expressions of named operands.
macro_rules! x86_lanes {
    (
        lanes: $n:literal, features: $features:literal,
        number: $number:ident($vec:ty), mask: $mask:ident($mask_raw:ty), word: $word:ident($int:ty),
        add: $add:ident, sub: $sub:ident, mul: $mul:ident, fma: $fma:ident, sqrt: $sqrt:ident, min: $min:ident, max: $max:ident,
        splat: $splat:ident, load: $load:ident, store: $store:ident,
        add_int: $add_int:ident, xor_int: $xor_int:ident, and_int: $and_int:ident, or_int: $or_int:ident,
        shift_left: $shift_left:ident, shift_right: $shift_right:ident, splat_int: $splat_int:ident,
        load_int: $load_int:ident, store_int: $store_int:ident,
        mul_even: $mul_even:ident, mul_low: $mul_low:ident, high_half: $high_half:ident,
        bits_of: $bits_of:ident, from_bits: $from_bits:ident, to_int: $to_int:ident, from_int: $from_int:ident,
        rsqrt: $rsqrt:ident, recip: $recip:ident,
        neg: |$neg:ident| $neg_e:expr, abs: |$abs:ident| $abs_e:expr,
        round: |$round:ident| $round_e:expr, floor: |$floor:ident| $floor_e:expr,
        lt: |$lt_a:ident, $lt_b:ident| $lt_e:expr,
        select: |$sel_m:ident, $sel_a:ident, $sel_b:ident| $sel_e:expr,
        select_int: |$seli_m:ident, $seli_a:ident, $seli_b:ident| $seli_e:expr,
        odd_from: |$even:ident, $odd:ident| $odd_e:expr,
        mask_splat: |$ms:ident| $ms_e:expr, mask_any: |$many:ident| $many_e:expr, mask_not: |$mnot:ident| $mnot_e:expr,
        mask_and: $mand:expr, mask_or: $mor:expr $(,)?
    ) => {
        use crate::elementary::{self, Bits};
        use crate::scalar::{Mask, Scalar, Stage, Word};

        const N: usize = $n;

        /// Numbers.
        #[derive(Clone, Copy, Debug)]
        pub struct $number($vec);

        /// Truth values.
        #[derive(Clone, Copy, Debug)]
        pub struct $mask($mask_raw);

        /// Integers.
        #[derive(Clone, Copy, Debug)]
        pub struct $word($int);

        binary!($number, Add, add, $add);
        binary!($number, Sub, sub, $sub);
        binary!($number, Mul, mul, $mul);
        binary!($mask, BitAnd, bitand, $mand);
        binary!($mask, BitOr, bitor, $mor);
        binary!($word, Add, add, $add_int);
        binary!($word, BitXor, bitxor, $xor_int);
        binary!($word, BitAnd, bitand, $and_int);
        binary!($word, BitOr, bitor, $or_int);

        impl std::ops::Neg for $number {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let $neg = self.0;
                Self(intrinsic!($neg_e))
            }
        }
        impl std::ops::AddAssign for $number {
            #[inline(always)]
            fn add_assign(&mut self, rhs: Self) {
                *self = *self + rhs;
            }
        }
        impl std::ops::SubAssign for $number {
            #[inline(always)]
            fn sub_assign(&mut self, rhs: Self) {
                *self = *self - rhs;
            }
        }
        impl std::ops::Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                let $mnot = self.0;
                Self($mnot_e)
            }
        }
        impl std::ops::Shl<u32> for $word {
            type Output = Self;
            #[inline(always)]
            fn shl(self, by: u32) -> Self {
                Self(intrinsic!($shift_left(self.0, _mm_cvtsi32_si128(by as i32))))
            }
        }
        impl std::ops::Shr<u32> for $word {
            type Output = Self;
            #[inline(always)]
            fn shr(self, by: u32) -> Self {
                Self(intrinsic!($shift_right(self.0, _mm_cvtsi32_si128(by as i32))))
            }
        }

        impl Mask for $mask {
            #[inline(always)]
            fn splat(value: bool) -> Self {
                let $ms = value;
                Self($ms_e)
            }
            #[inline(always)]
            fn any(self) -> bool {
                let $many = self.0;
                $many_e
            }
        }

        impl Word for $word {
            #[inline(always)]
            fn splat(x: u32) -> Self {
                Self(intrinsic!($splat_int(x as i32)))
            }
            #[inline(always)]
            fn mul_wide(self, by: u32) -> (Self, Self) {
                // The processor multiplies every other lane; the odd ones are shifted down, and their result up again.
                let by = Self::splat(by).0;
                let $even = intrinsic!($high_half::<32>($mul_even(self.0, by)));
                let $odd = intrinsic!($mul_even($high_half::<32>(self.0), by));
                (Self(intrinsic!($odd_e)), Self(intrinsic!($mul_low(self.0, by))))
            }
            #[inline(always)]
            fn load(from: &[u32]) -> Self {
                assert!(from.len() >= N);
                Self(intrinsic!($load_int(from.as_ptr().cast())))
            }
            #[inline(always)]
            fn store(self, to: &mut [u32]) {
                assert!(to.len() >= N);
                intrinsic!($store_int(to.as_mut_ptr().cast(), self.0));
            }
        }

        impl Bits for $number {
            #[inline(always)]
            fn to_bits(self) -> $word {
                $word(intrinsic!($bits_of(self.0)))
            }
            #[inline(always)]
            fn from_bits(bits: $word) -> Self {
                Self(intrinsic!($from_bits(bits.0)))
            }
            #[inline(always)]
            fn round(self) -> Self {
                let $round = self.0;
                Self(intrinsic!($round_e))
            }
            #[inline(always)]
            fn to_word(self) -> $word {
                $word(intrinsic!($to_int(self.0)))
            }
        }

        impl Scalar for $number {
            type Const = f32;
            type Mask = $mask;
            type Word = $word;
            const LANES: usize = N;
            const EPSILON: f64 = f32::EPSILON as f64;

            #[inline(always)]
            fn splat(c: f32) -> Self {
                Self(intrinsic!($splat(c)))
            }
            #[inline(always)]
            fn load(from: &[f32]) -> Self {
                assert!(from.len() >= N);
                Self(intrinsic!($load(from.as_ptr())))
            }
            #[inline(always)]
            fn store(self, to: &mut [f32]) {
                assert!(to.len() >= N);
                intrinsic!($store(to.as_mut_ptr(), self.0));
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                Self(intrinsic!($fma(self.0, a.0, b.0)))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(intrinsic!($sqrt(self.0)))
            }
            #[inline(always)]
            fn rsqrt(self) -> Self {
                elementary::refine_rsqrt(self, Self(intrinsic!($rsqrt(self.0))))
            }
            #[inline(always)]
            fn recip(self) -> Self {
                elementary::refine_recip(self, Self(intrinsic!($recip(self.0))))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                let $abs = self.0;
                Self(intrinsic!($abs_e))
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self(intrinsic!($min(self.0, other.0)))
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(intrinsic!($max(self.0, other.0)))
            }
            #[inline(always)]
            fn floor(self) -> Self {
                let $floor = self.0;
                Self(intrinsic!($floor_e))
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
            fn lt(self, other: Self) -> $mask {
                let ($lt_a, $lt_b) = (self.0, other.0);
                $mask(intrinsic!($lt_e))
            }
            #[inline(always)]
            fn select(mask: $mask, a: Self, b: Self) -> Self {
                let ($sel_m, $sel_a, $sel_b) = (mask.0, a.0, b.0);
                Self(intrinsic!($sel_e))
            }
            #[inline(always)]
            fn from_word(word: $word) -> Self {
                Self(intrinsic!($from_int(word.0)))
            }
            #[inline(always)]
            fn outline<T: Stage<Self>>(stage: T) -> T::Output {
                intrinsic!(outlined(stage))
            }
            #[inline(always)]
            fn select_word(mask: $mask, a: $word, b: $word) -> $word {
                let ($seli_m, $seli_a, $seli_b) = (mask.0, a.0, b.0);
                $word(intrinsic!($seli_e))
            }
        }

        #[target_feature(enable = $features)]
        #[inline(never)]
        fn outlined<T: Stage<$number>>(stage: T) -> T::Output {
            stage.run()
        }
    };
}
pub(crate) use {binary, intrinsic, x86_lanes};
