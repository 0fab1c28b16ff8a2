//! A capsule beside a cylinder.

use super::lying::lying;
use super::{Beside, Cylinder, FAR, Rim};
use crate::spatial::Vec3;
use crate::step::contact::tangents;
use crate::step::ellipsoid::{TINY, past_ellipse};
use crate::step::support::{Apart, Segment, Smooth};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor};

/// Most steps of a search about the axis of a rod.
const MAX_TURNS: usize = 20;
/// The longest of them (rad).
const LONGEST_TURN: f64 = 0.5;
/// A step (rad) that is as good as none, in units of rounding.
const SETTLED: f64 = 16.0;

/// A capsule about a segment: the one point in which they meet, or the two in which it lies on an end. Points that are not there are far apart.
/// All in the axes of the cylinder.
#[inline(always)]
pub(in crate::step) fn rod<S: Scalar>(cylinder: &Cylinder<S>, rod: &Segment<S>, radius: S) -> [Apart<S>; 2] {
    let one = nearest(cylinder, rod, radius);
    let [first, second] = lying(cylinder, rod, radius, one.normal);
    let lies = first.distance.lt(cylinder.margin) | second.distance.lt(cylinder.margin);
    [first.or(lies, one), second]
}

/// Where a capsule is nearest, or which is its least way out. Of one that is farther than the margin no more is sure than that.
#[inline(always)]
pub(super) fn nearest<S: Scalar>(cylinder: &Cylinder<S>, rod: &Segment<S>, radius: S) -> Apart<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let mut best = beside(cylinder, rod);
    for up in [one, -one] {
        best = best.farther(out(cylinder, rod, Vec3::new(o, o, up)));
    }
    // An axis that is out of the cylinder is nearest where its point is, and one that is in it least deep along one of the others.
    let may_touch = best.distance.lt(radius + cylinder.margin);
    let outermost = outermost(cylinder, rod, may_touch);
    let is_in = outermost.distance.lt(o);
    best = outermost.farther(best);
    S::when(is_in, &mut best, |best| S::outline(PastRims { cylinder, rod: *rod, is_in, best }));
    let Apart { distance, normal, at } = best;
    Apart { distance: distance - radius, normal, at: at - normal.scale((distance + radius) * S::lit(0.5)) }
}

/// How far a rod is out along a direction, and with which point.
#[inline(always)]
fn out<S: Scalar>(cylinder: &Cylinder<S>, rod: &Segment<S>, normal: Vec3<S>) -> Apart<S> {
    let (distance, along) = rod.out(&cylinder.support(normal), normal);
    Apart { distance, normal, at: rod.at(along) }
}

/// The point of an axis that is nearest to a cylinder, if it is out of it and may touch. There the distance is a smooth convex function along the axis.
#[inline(always)]
fn outermost<S: Scalar>(cylinder: &Cylinder<S>, rod: &Segment<S>, may_touch: S::Mask) -> Apart<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    // Over an end the lower of both ends of the axis is nearest.
    let [a, b] = [rod.middle - rod.half, rod.middle + rod.half];
    let is_over = over_end(cylinder, a) & over_end(cylinder, b) & o.lt(a.z * b.z);
    let lower = S::select(a.z.abs().lt(b.z.abs()), -one, one);
    let mut part = Part { first: S::select(is_over, lower, -one), last: S::select(is_over, lower, one) };
    let searched = !is_over & may_touch;
    S::when(searched, &mut part, |part| S::outline(Search { cylinder, rod: *rod, searched, part }));
    // Where it never rises the last point is nearest, and where it always does the first.
    let at = rod.at((part.first + part.last) * S::lit(0.5));
    let Beside { distance, normal } = cylinder.beside(at);
    let is_in = distance.lt(S::zero());
    Apart { distance: S::select(is_in, S::lit(-FAR), distance), normal, at }
}

/// Whether a point is over an end of a cylinder, or under the other.
#[inline(always)]
fn over_end<S: Scalar>(cylinder: &Cylinder<S>, point: Vec3<S>) -> S::Mask {
    let square = point.x.mul_add(point.x, point.y * point.y);
    cylinder.half_length.lt(point.z.abs()) & square.lt(cylinder.radius.sq())
}

/// The search for the nearest point where one has to be made.
struct Search<'a, S: Scalar> {
    cylinder: &'a Cylinder<S>,
    rod: Segment<S>,
    searched: S::Mask,
    part: &'a mut Part<S>,
}

impl<S: Scalar> Stage<S> for Search<'_, S> {
    const NAME: &'static str = "nearest point of a rod";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { cylinder, rod, searched, part } = self;
        // As many halvings as a number has binary digits.
        let halvings = -S::EPSILON.log2() as usize;
        S::repeat_while(halvings, part, |part| {
            S::outline(Halve { cylinder, rod, part });
            searched
        });
    }
}

/// A half of a segment that holds its nearest point, from -1 to 1.
struct Part<S> {
    first: S,
    last: S,
}

impl<S: Scalar> Carried<S> for Part<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers([&mut self.first, &mut self.last]);
    }
}

/// Halves a segment. A stage, since a closure that is not inlined would be compiled without its level's instructions.
struct Halve<'a, S> {
    cylinder: &'a Cylinder<S>,
    rod: Segment<S>,
    part: &'a mut Part<S>,
}

impl<S: Scalar> Stage<S> for Halve<'_, S> {
    const NAME: &'static str = "half of a segment";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { cylinder, rod, part: Part { first, last } } = self;
        let along = (*first + *last) * S::lit(0.5);
        let rises = S::zero().lt(cylinder.beside(rod.at(along)).normal.dot(rod.half));
        *first = S::select(rises, *first, along);
        *last = S::select(rises, along, *last);
    }
}

/// The way out across the cylinder: seen along it, the rod is a line and the cylinder a circle.
#[inline(always)]
fn beside<S: Scalar>(cylinder: &Cylinder<S>, rod: &Segment<S>) -> Apart<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let seen = |v: Vec3<S>| Vec3::new(v.x, v.y, o);
    let (middle, half) = (seen(rod.middle), seen(rod.half));
    let along = (-(middle.dot(half)) * half.dot(half).max(S::lit(TINY)).recip()).clamp(-1.0, 1.0);
    let aside = half.mul_add(along, middle);
    // On the axis any way out is as good.
    let is_axis = aside.dot(aside).lt(S::lit(TINY));
    let normal = Vec3::select(is_axis, Vec3::new(one, o, o), aside.unit());
    Apart { at: rod.at(along), ..out(cylinder, rod, normal) }
}

/// The ways out of a rod past both rims.
struct PastRims<'a, S: Scalar> {
    cylinder: &'a Cylinder<S>,
    rod: Segment<S>,
    /// Where the axis of the rod pierces the cylinder.
    is_in: S::Mask,
    best: &'a mut Apart<S>,
}

impl<S: Scalar> Stage<S> for PastRims<'_, S> {
    const NAME: &'static str = "rod past rims";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { cylinder, rod, is_in, best } = self;
        for up in [S::lit(1.0), S::lit(-1.0)] {
            for normal in [past_rim(cylinder, &rod, up), least_past_end(cylinder, &rod, up)] {
                let other = best.farther(out(cylinder, &rod, normal));
                *best = other.or(is_in, *best);
            }
        }
    }
}

/// The direction across a rod in which it is least deep at the rim: seen along the rod, this is an ellipse.
#[inline(always)]
fn past_rim<S: Scalar>(cylinder: &Cylinder<S>, rod: &Segment<S>, up: S) -> Vec3<S> {
    let above = Vec3::new(S::zero(), S::zero(), S::lit(1.0));
    // A ball is looked at from above.
    let is_ball = rod.half.dot(rod.half).lt(S::lit(TINY));
    let [x, y] = tangents(Vec3::select(is_ball, above, rod.half.unit()));
    let scale = cylinder.radius.sq();
    let flat = |a: Vec3<S>, b: Vec3<S>| a.x.mul_add(b.x, a.y * b.y) * scale;
    let from_end = rod.middle - above.scale(cylinder.half_length * up);
    past_ellipse([flat(x, x), flat(x, y), flat(y, y)], [x, y], from_end)
}

/// The direction across a rod in which it is least deep at the rim, as near as may be to the way out past the end.
#[inline(always)]
fn least_past_end<S: Scalar>(cylinder: &Cylinder<S>, rod: &Segment<S>, up: S) -> Vec3<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let (above, axis) = (Vec3::new(o, o, up), rod.half.unit());
    let across = above - axis.scale(axis.dot(above));
    // Of an upright rod any way across is as good.
    let is_upright = across.dot(across).lt(S::lit(TINY));
    let start = Vec3::select(is_upright, Vec3::new(one, o, o), across.unit());
    let mut way = Way { normal: start, goes_on: S::Mask::splat(true) };
    S::repeat_while(MAX_TURNS, &mut way, |way| {
        S::outline(Turn { rim: cylinder.rim(up), middle: rod.middle, axis, way });
        way.goes_on
    });
    way.normal
}

/// A direction across a rod, and whether it is looked for on.
struct Way<S: Scalar> {
    normal: Vec3<S>,
    goes_on: S::Mask,
}

impl<S: Scalar> Carried<S> for Way<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Vec3 { x, y, z } = &mut self.normal;
        visitor.numbers([x, y, z]);
        visitor.mask(&mut self.goes_on);
    }
}

/// A step of Newton's method about the axis of a rod.
struct Turn<'a, S: Scalar> {
    rim: Rim<S>,
    middle: Vec3<S>,
    axis: Vec3<S>,
    way: &'a mut Way<S>,
}

impl<S: Scalar> Stage<S> for Turn<'_, S> {
    const NAME: &'static str = "way out past a rim";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { rim, middle, axis, way: Way { normal, goes_on } } = self;
        let side = axis.cross(*normal);
        let support = rim.support(*normal);
        let gap = middle - support.point;
        let [bend, ..] = rim.curvature(&support, *normal, [side, side]);
        let (rise, distance) = (side.dot(gap), normal.dot(gap));
        // Of a maximum, else the curvature without what the depth takes of it.
        let is_maximum = S::zero().lt(bend + distance);
        let bend = S::select(is_maximum, bend + distance, bend).max(S::lit(TINY));
        let step = (rise * bend.recip()).clamp(-LONGEST_TURN, LONGEST_TURN);
        *normal = Vec3::select(*goes_on, side.mul_add(step, *normal).unit(), *normal);
        *goes_on = *goes_on & S::lit(SETTLED * S::EPSILON).lt(step.abs());
    }
}
