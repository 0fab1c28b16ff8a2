//! Tables in another precision: each struct says once what its numbers are.

use myo_muscle::Muscle;
use myo_scalar::Real;

/// Something whose numbers can be rounded to `D`.
pub(crate) trait Cast<D> {
    /// The same with numbers of type `D`.
    type Output;
    /// Rounds every number.
    fn cast(&self) -> Self::Output;
}

/// `Struct { numbers; what stays as it is }`: the fields of structs, all of them, or it does not compile.
macro_rules! cast {
    ($($name:ident { $($number:ident),+ $(; $($kept:ident),+)? })+) => {$(
        impl<C: Real + Cast<D, Output = D>, D: Real> Cast<D> for $name<C> {
            type Output = $name<D>;
            fn cast(&self) -> $name<D> {
                $name {
                    $($number: Cast::<D>::cast(&self.$number),)+
                    $($($kept: Clone::clone(&self.$kept),)+)?
                }
            }
        }
    )+};
}
pub(crate) use cast;

impl<D: Real> Cast<D> for f64 {
    type Output = D;
    fn cast(&self) -> D {
        D::from_f64(*self)
    }
}

impl<D: Real> Cast<D> for f32 {
    type Output = D;
    fn cast(&self) -> D {
        D::from_f64(self.to_f64())
    }
}

impl<T: Cast<D>, D, const N: usize> Cast<D> for [T; N] {
    type Output = [T::Output; N];
    fn cast(&self) -> Self::Output {
        self.each_ref().map(Cast::cast)
    }
}

impl<T: Cast<D>, D> Cast<D> for Vec<T> {
    type Output = Vec<T::Output>;
    fn cast(&self) -> Self::Output {
        self.iter().map(Cast::cast).collect()
    }
}

impl<T: Cast<D>, D> Cast<D> for Option<T> {
    type Output = Option<T::Output>;
    fn cast(&self) -> Self::Output {
        self.as_ref().map(Cast::cast)
    }
}

impl<T: Cast<D>, D> Cast<D> for Box<T> {
    type Output = Box<T::Output>;
    fn cast(&self) -> Self::Output {
        Box::new((**self).cast())
    }
}

impl<C: Real, D: Real> Cast<D> for Muscle<C> {
    type Output = Muscle<D>;
    fn cast(&self) -> Muscle<D> {
        Muscle::cast(self)
    }
}
