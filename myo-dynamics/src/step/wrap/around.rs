//! Around a circle: two tangents and the arc between them.
//!
//! The tangent points are kept as unit vectors from the centre, which stay accurate however near to the circle an end is;
//! the arc is the angle between them.

use super::flat::{Bend, Ends, Flat, TINY};
use myo_scalar::{Mask, Scalar, atan2};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_8, TAU};

/// How much (relative, in units of the precision) the square of a distance may be below that of the radius and still count
/// as on the circle: what rounding leaves of a point that was put there.
const SURFACE: f64 = 256.0;

/// The path around a circle. Without a side it takes the shorter way, and only where the straight line would cut the circle.
/// With one it goes round as the line from its first end by the side to its last end does, as in MuJoCo since 4.0.
#[inline(always)]
pub(super) fn around<S: Scalar>(side: Option<Flat<S>>, from: Flat<S>, to: Flat<S>, radius: S) -> Bend<S> {
    let ends = Ends::new(from, to, radius);
    let short = S::select(from.cross(to).lt(S::zero()), S::lit(-1.0), S::lit(1.0));
    let is_long = match side {
        None => S::Mask::splat(false),
        // That line never crosses the ray opposite the side. If this ray is on the shorter way, the line takes the longer one.
        Some(side) => S::zero().lt(short * side.cross(from)) & S::zero().lt(short * to.cross(side)),
    };
    let turn = S::select(is_long, -short, short);
    let [before, after] = ends.tangents;
    let (first, second) = feet(&ends, radius, turn);
    let arc = arc(is_long, (before + after).lt(radius), turn * first.cross(second), first.dot(second));
    Bend {
        bends: (ends.is_cut | is_long) & is_outside(&ends, radius),
        lengths: [before, radius * arc, after],
        directions: [first.left().scale(turn), second.left().scale(turn)],
        turn,
    }
}

/// Where no end is inside.
#[inline(always)]
fn is_outside<S: Scalar>(ends: &Ends<S>, radius: S) -> S::Mask {
    let bound = radius * radius * S::lit(1.0 - SURFACE * S::EPSILON);
    bound.le(ends.squares[0]) & bound.le(ends.squares[1])
}

/// Unit vectors from the centre to the tangent points.
#[inline(always)]
fn feet<S: Scalar>(ends: &Ends<S>, radius: S, turn: S) -> (Flat<S>, Flat<S>) {
    let [before, after] = ends.tangents;
    let first = ends.from.left().mul_add(turn * before, ends.from.scale(radius));
    let second = ends.to.left().mul_add(-(turn * after), ends.to.scale(radius));
    let inverse = |square: S| square.max(S::lit(TINY)).recip();
    (first.scale(inverse(ends.squares[0])), second.scale(inverse(ends.squares[1])))
}

/// The arc (rad) of this sine and cosine. A full turn is added where the arc must be that long, with a seam where no path can be:
/// a shorter way is at most half a turn and at least a rounding below none, which it keeps, so that lengths are continuous
/// where it comes off the circle. A longer one ends near a full turn if both ends are close, and else before the last
/// eighth of it.
#[inline(always)]
fn arc<S: Scalar>(is_long: S::Mask, are_close: S::Mask, sin: S, cos: S) -> S {
    let arc = atan2(sin, cos);
    let seam = S::select(are_close, S::lit(FRAC_PI_2), S::lit(-FRAC_PI_8));
    let seam = S::select(is_long, seam, S::lit(-FRAC_PI_2));
    arc + S::lit(TAU).only(arc.lt(seam))
}
