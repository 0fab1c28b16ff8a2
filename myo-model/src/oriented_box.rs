//! Boxes that are turned, and the gap between two of them.

use nalgebra::{Matrix3, Vector3};

/// A box in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Its centre (m).
    pub centre: Vector3<f64>,
    /// Its axes as columns.
    pub axes: Matrix3<f64>,
    /// Half sizes along the axes (m).
    pub half_size: Vector3<f64>,
}

impl OrientedBox {
    /// Gap (m) to another box; negative when they overlap.
    ///
    /// Separating axis test (Gottschalk, Lin and Manocha 1996, <https://doi.org/10.1145/237170.237244>): the widest gap over
    /// the 15 candidate axes. Where two corners face each other the true gap is a little larger.
    pub fn gap(&self, other: &Self) -> f64 {
        let d = other.centre - self.centre;
        let extent = |each: &Self, axis: &Vector3<f64>| (each.axes.transpose() * axis).abs().dot(&each.half_size);
        let faces = self.axes.column_iter().chain(other.axes.column_iter()).map(|c| c.into_owned());
        let edges = self.axes.column_iter().flat_map(|u| other.axes.column_iter().map(move |v| u.cross(&v)));
        faces
            .chain(edges)
            // Parallel edges give no axis of their own.
            .filter_map(|axis| axis.try_normalize(1e-9))
            .map(|axis| d.dot(&axis).abs() - extent(self, &axis) - extent(other, &axis))
            .fold(f64::NEG_INFINITY, f64::max)
    }
}
