//! A cylinder over a plane.

use crate::spatial::{Frame, Vec3};
use crate::step::ellipsoid::TINY;
use myo_scalar::Scalar;

/// The lowest points of a cylinder along the normal of a plane (m, from O), as MuJoCo takes them: on the rim of the lower end, on that of the other end above it, and
/// two more that stand around the lower end as corners of a triangle.
#[inline(always)]
pub(in crate::step) fn lowest<S: Scalar>(
    frame: &Frame<S>,
    [radius, half_length]: [S; 2],
    normal: Vec3<S>,
) -> [Vec3<S>; 4] {
    let (x, z) = (frame.rotation.x, frame.rotation.z);
    let rise = z.dot(normal);
    let axis = Vec3::select(S::zero().lt(rise), -z, z);
    // What of the way down is across the axis: so also where rounding is all that there is.
    let down = axis.cross(axis.cross(normal));
    let square = down.dot(down);
    let leans = S::lit(TINY).lt(square);
    let out = Vec3::select(leans, down.scale(square.max(S::lit(TINY)).rsqrt()), x);
    let (end, rim) = (axis.scale(half_length), out.scale(radius));
    let aside = out.cross(axis).scale(radius * S::lit(0.75f64.sqrt()));
    let middle = frame.position + end - rim.scale(S::lit(0.5));
    [frame.position + end + rim, frame.position - end + rim, middle + aside, middle - aside]
}
