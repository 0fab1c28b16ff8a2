//! A capsule that lies on an end of a cylinder.

use super::{Cylinder, FAR};
use crate::spatial::Vec3;
use crate::step::ellipsoid::TINY;
use crate::step::support::{Apart, Segment};
use myo_scalar::Scalar;

/// Cosine of the angle between a way out and the axis above which it is past an end.
const SIDEWAYS: f64 = 1e-6;
/// Sine of the angle by which a capsule leans at most that lies on an end with both its own.
const LEAN_OF_LYING: f64 = 0.0888;
/// Corners of the polygon that MuJoCo takes for an end.
const CORNERS: usize = 16;

/// The ends of the line with which a capsule lies on an end of the cylinder, as MuJoCo 4.0 has them (found by trying): of one that leans
/// by up to [`LEAN_OF_LYING`], as far as they are over a polygon of sixteen corners within the rim. The line is that of the surface, half a margin
/// farther out, against the capsule's way out, less what of this is along its axis. Points that are not there, or do not touch, are far apart.
#[inline(always)]
pub(super) fn lying<S: Scalar>(cylinder: &Cylinder<S>, rod: &Segment<S>, radius: S, out: Vec3<S>) -> [Apart<S>; 2] {
    let (o, one, half) = (S::zero(), S::lit(1.0), rod.half);
    let (axis, normal) = (half.unit(), Vec3::new(o, o, S::select(out.z.lt(o), -one, one)));
    let surface = radius + cylinder.margin * S::lit(0.5);
    let line = rod.middle - (out - axis.scale(out.dot(axis))).scale(surface);
    let (mut first, mut last) = (-one, one);
    let apothem = cylinder.radius * S::lit((std::f64::consts::PI / CORNERS as f64).cos());
    for side in 0..CORNERS / 2 {
        let (sin, cos) = ((side as f64 + 0.5) * std::f64::consts::TAU / CORNERS as f64).sin_cos();
        let (cos, sin) = (S::lit(cos), S::lit(sin));
        let at = line.x.mul_add(cos, line.y * sin);
        let along = half.x.mul_add(cos, half.y * sin);
        let is_parallel = along.abs().lt(S::lit(TINY));
        let inverse = S::select(is_parallel, S::lit(TINY), along).recip();
        let (a, b) = ((-apothem - at) * inverse, (apothem - at) * inverse);
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    // A ball does not lie.
    let is_rod = S::lit(TINY).lt(half.dot(half));
    let is_past_end = S::lit(SIDEWAYS).lt(out.z.abs());
    let lies = is_rod & is_past_end & axis.z.abs().lt(S::lit(LEAN_OF_LYING)) & first.lt(last);
    let first = over_end(cylinder, half.mul_add(first, line), normal, lies);
    [first, over_end(cylinder, half.mul_add(last, line), normal, lies)]
}

/// A point of a line over an end of the cylinder, half a margin farther out than the surface it belongs to.
#[inline(always)]
fn over_end<S: Scalar>(cylinder: &Cylinder<S>, point: Vec3<S>, normal: Vec3<S>, lies: S::Mask) -> Apart<S> {
    let over = point.z.mul_add(normal.z, -cylinder.half_length);
    let half_margin = cylinder.margin * S::lit(0.5);
    let distance = over + half_margin;
    let touches = lies & distance.lt(cylinder.margin);
    let at = point - normal.scale((over - half_margin) * S::lit(0.5));
    Apart { distance: S::select(touches, distance, S::lit(FAR)), normal, at }
}
