//! Boxes fixed to the world.

use crate::oriented_box::OrientedBox;
use nalgebra::{Matrix3, Vector3};

/// A box that the fingertip can touch, in numbers of type `T`: constants, one per lane, or reads of a card's memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticBox<T = f64> {
    /// Centre (m, from the shoulder centre in world axes).
    pub centre: [T; 3],
    /// Own axes as columns; those of a button: up the face, across it, out of it.
    pub axes: [[T; 3]; 3],
    /// Half sizes along the axes (m).
    pub half_size: [T; 3],
    /// Radius of the ball around it (m).
    pub radius: T,
}

impl StaticBox {
    /// A box.
    pub fn new(centre: [f64; 3], axes: [[f64; 3]; 3], half_size: [f64; 3]) -> Self {
        Self { centre, axes, half_size, radius: Vector3::from(half_size).norm() }
    }

    /// The same as vectors.
    pub fn oriented(&self) -> OrientedBox {
        let axes = Matrix3::from_columns(&self.axes.map(Vector3::from));
        OrientedBox { centre: self.centre.into(), axes, half_size: self.half_size.into() }
    }
}

impl<T> StaticBox<T> {
    /// The same with other numbers: each is what `f` makes of this one, in the order of the fields.
    #[inline(always)]
    pub fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> StaticBox<U> {
        StaticBox {
            centre: self.centre.each_ref().map(&mut *f),
            axes: self.axes.each_ref().map(|axis| axis.each_ref().map(&mut *f)),
            half_size: self.half_size.each_ref().map(&mut *f),
            radius: f(&self.radius),
        }
    }
}

impl<T: Copy> StaticBox<T> {
    /// Axes, one after the other, and half sizes.
    #[inline(always)]
    pub fn sides(&self) -> [T; 12] {
        let ([h, w, d], [[a, b, c], [e, f, g], [i, j, k]]) = (self.half_size, self.axes);
        [a, b, c, e, f, g, i, j, k, h, w, d]
    }
}
