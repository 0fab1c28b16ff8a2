//! A box beside a plane, a ball or a capsule: MuJoCo's geometry.
//!
//! A ball touches in one point, a plane in the four lowest corners, a capsule with the point of its axis that is nearest and, where it lies along
//! a face or an edge, with another one as far from it as the box goes.

mod rod;

pub(super) use rod::rod;

use super::contact::surface;
use super::support::Apart;
use crate::spatial::{Frame, Rotation, Vec3};
use myo_scalar::Scalar;

/// A box about its middle, seen in its own frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cuboid<S> {
    /// Half of its sides (m).
    pub half_size: [S; 3],
}

impl<S: Scalar> Cuboid<S> {
    /// How a ball touches it, from the ball to the box.
    #[inline(always)]
    fn ball(&self, middle: Vec3<S>, radius: S) -> Apart<S> {
        let Rotation { x, y, z } = Rotation::identity();
        let (distance, out) = surface([x, y, z].map(Vec3::array), self.half_size, middle);
        // From the middle of the ball to that between the surfaces.
        let back = (distance + radius) * S::lit(0.5);
        Apart { distance: distance - radius, normal: -out, at: middle - out.scale(back) }
    }

    /// Square of the distance of a point, none inside (m^2).
    #[inline(always)]
    pub(super) fn square_outside(&self, point: Vec3<S>) -> S {
        let excess = self.beyond(point);
        excess.dot(excess)
    }

    /// How far a point is outside along each axis (m).
    #[inline(always)]
    fn beyond(&self, point: Vec3<S>) -> Vec3<S> {
        let [x, y, z] = point.array();
        let [a, b, c] = self.half_size;
        let beyond = |x: S, half: S| x - x.max(-half).min(half);
        Vec3::new(beyond(x, a), beyond(y, b), beyond(z, c))
    }
}

/// The lowest corners of a box along the normal of a plane (m, from O): of each two that are opposite one.
#[inline(always)]
pub(super) fn lowest<S: Scalar>(frame: &Frame<S>, half_size: [S; 3], normal: Vec3<S>) -> [Vec3<S>; 4] {
    let Rotation { x, y, z } = frame.rotation;
    let [x, y, z] = [x.scale(half_size[0]), y.scale(half_size[1]), z.scale(half_size[2])];
    [x + y + z, x + y - z, x - y + z, x - y - z].map(|corner| {
        let is_up = S::zero().lt(corner.dot(normal));
        frame.position + Vec3::select(is_up, -corner, corner)
    })
}
