//! Ends of cylinders.

use nalgebra::Vector3;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Corners of the polygon that stands for the end of a cylinder.
pub(super) const CAP_CORNERS: usize = 16;

/// Sines and cosines of the corners' angles.
static ANGLES: LazyLock<[(f64, f64); CAP_CORNERS]> =
    LazyLock::new(|| std::array::from_fn(|number| (TAU * number as f64 / CAP_CORNERS as f64).sin_cos()));

/// The end of a cylinder about z, as a polygon on its rim.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cap {
    pub radius: f64,
    pub half_length: f64,
    /// 1 for the end at which z is greater, else -1.
    pub outward: f64,
}

impl Cap {
    /// A corner (m); they are clockwise as seen from outside.
    pub fn corner(&self, number: usize) -> Vector3<f64> {
        let (sin, cos) = ANGLES[number];
        Vector3::new(self.radius * cos, -self.outward * self.radius * sin, self.outward * self.half_length)
    }

    /// Unit, outward.
    pub fn normal(&self) -> Vector3<f64> {
        Vector3::new(0.0, 0.0, self.outward)
    }
}
