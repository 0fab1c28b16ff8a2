//! An ellipsoid beside a cylinder.

use super::Cylinder;
use crate::spatial::{Rotation, Vec3};
use crate::step::ellipsoid::{TINY, past_ellipse};
use crate::step::support::{Apart, Oval, Smooth, climb};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor};

/// Steps by which a direction between two bodies is found about.
const STEPS_TOWARD: usize = 32;
/// How much a first direction from the rim leans to either side at least.
const LEAN: f64 = 0.05;

/// An ellipsoid, its middle and axes in those of the cylinder. Of one that is farther than the margin no more is sure than that.
#[inline(always)]
pub(in crate::step) fn oval<S: Scalar>(cylinder: &Cylinder<S>, oval: &Oval<S>, middle: Vec3<S>) -> Apart<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let side = beside_axis(oval, middle);
    let mut best = along(cylinder, oval, middle, side);
    for up in [one, -one] {
        best = best.farther(along(cylinder, oval, middle, Vec3::new(o, o, up)));
    }
    // What is over an end is no less deep past its rim.
    let touching = middle - oval.support(best.normal).point;
    let is_inside = touching.x.mul_add(touching.x, touching.y * touching.y).lt(cylinder.radius.sq());
    let is_open = !(is_inside & S::lit(0.5).lt(best.normal.z.abs())) & best.distance.lt(cylinder.margin);
    S::when(is_open, &mut best, |best| S::outline(PastRims { cylinder, oval, middle, side, is_open, best }));
    best
}

/// The ways out of an ellipsoid past both rims.
struct PastRims<'a, S: Scalar> {
    cylinder: &'a Cylinder<S>,
    oval: &'a Oval<S>,
    middle: Vec3<S>,
    /// The way out across the axis.
    side: Vec3<S>,
    /// Where it is looked at.
    is_open: S::Mask,
    best: &'a mut Apart<S>,
}

impl<S: Scalar> Stage<S> for PastRims<'_, S> {
    const NAME: &'static str = "ellipsoid past rims";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { cylinder, oval, middle, side, is_open, best } = self;
        let between = toward(cylinder, oval, middle);
        let up = S::select(middle.z.lt(S::zero()), S::lit(-1.0), S::lit(1.0));
        past_rim(cylinder, oval, middle, PastRim { up, side, between, is_open }, best);
        // Along directions to the other end it is no farther than its middle is from the axis, less the rim and its least radius.
        let [a, b, c] = oval.radii;
        let from_axis = middle.x.mul_add(middle.x, middle.y * middle.y).max(S::lit(TINY)).sqrt();
        let most = (from_axis - cylinder.radius).max(S::zero()) - a.min(b).min(c);
        let is_open = is_open & best.distance.lt(most.min(cylinder.margin));
        S::when(is_open, best, |best| {
            S::outline(OtherRim { cylinder, oval, middle, past: PastRim { up: -up, side, between, is_open }, best });
        });
    }
}

/// The way past the rim at the end where an ellipsoid is not: rarely the least.
struct OtherRim<'a, S: Scalar> {
    cylinder: &'a Cylinder<S>,
    oval: &'a Oval<S>,
    middle: Vec3<S>,
    past: PastRim<S>,
    best: &'a mut Apart<S>,
}

impl<S: Scalar> Stage<S> for OtherRim<'_, S> {
    const NAME: &'static str = "ellipsoid past the other rim";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        past_rim(self.cylinder, self.oval, self.middle, self.past, self.best);
    }
}

/// A rim, and where a way past it may begin.
#[derive(Clone, Copy)]
struct PastRim<S: Scalar> {
    /// Its end: one or less one.
    up: S,
    /// The way out across the axis.
    side: Vec3<S>,
    /// About the direction between the bodies.
    between: Vec3<S>,
    /// Where it is looked at.
    is_open: S::Mask,
}

/// Takes the way out past a rim if it is less than the best.
#[inline(always)]
fn past_rim<S: Scalar>(
    cylinder: &Cylinder<S>,
    oval: &Oval<S>,
    middle: Vec3<S>,
    PastRim { up, side, between, is_open }: PastRim<S>,
    best: &mut Apart<S>,
) {
    let end = Vec3::new(S::zero(), S::zero(), up);
    let rim = cylinder.rim(up);
    let corner = middle - rim.support(side).point;
    let out = side.scale(corner.dot(side).max(S::lit(LEAN))) + end.scale(corner.dot(end).max(S::lit(LEAN)));
    // Straight up the way out has an edge, at which a search that comes from the wrong side would end. Towards what is lowest over
    // the end it rises from there, and a search never goes down.
    let lowest = middle - oval.support(end).point;
    let toward = Vec3::new(lowest.x, lowest.y, S::zero());
    let leaning = end + toward.scale(toward.dot(toward).max(S::lit(TINY)).rsqrt() * S::lit(LEAN));
    let mut start = between;
    for other in [out.unit(), leaning.unit()] {
        let [before, now] = [start, other].map(|way| along(cylinder, oval, middle, way).distance);
        start = Vec3::select(before.lt(now), other, start);
    }
    let from_rim = along(cylinder, oval, middle, climb(&rim, oval, middle, start));
    *best = best.farther(from_rim).or(is_open, *best);
}

/// About the direction from a cylinder to an ellipsoid that is apart from it: that of the shortest vector from a point of the one to a point of
/// the other, as far as a few steps find it (Frank and Wolfe 1956, doi 10.1002/nav.3800030109).
#[inline(always)]
fn toward<S: Scalar>(cylinder: &Cylinder<S>, oval: &Oval<S>, middle: Vec3<S>) -> Vec3<S> {
    let mut shortest = Shortest(middle);
    S::repeat_while(STEPS_TOWARD, &mut shortest, |shortest| {
        S::outline(Shorten { cylinder, oval, middle, shortest });
        S::Mask::splat(true)
    });
    let Shortest(vector) = shortest;
    vector.unit()
}

/// A vector from a point of one body to a point of another.
struct Shortest<S>(Vec3<S>);

impl<S: Scalar> Carried<S> for Shortest<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Vec3 { x, y, z } = &mut self.0;
        visitor.numbers([x, y, z]);
    }
}

/// Moves it towards the points of both that are nearest to each other along it.
struct Shorten<'a, S: Scalar> {
    cylinder: &'a Cylinder<S>,
    oval: &'a Oval<S>,
    middle: Vec3<S>,
    shortest: &'a mut Shortest<S>,
}

impl<S: Scalar> Stage<S> for Shorten<'_, S> {
    const NAME: &'static str = "vector between bodies";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { cylinder, oval, middle, shortest: Shortest(vector) } = self;
        let way = vector.unit();
        let extreme = middle - oval.support(way).point - cylinder.support(way).point;
        let change = extreme - *vector;
        let share = -vector.dot(change) * change.dot(change).max(S::lit(TINY)).recip();
        *vector = change.mul_add(share.clamp(0.0, 1.0), *vector);
    }
}

/// The direction across the axis in which an ellipsoid is farthest from it: seen along the axis it is an ellipse.
#[inline(always)]
fn beside_axis<S: Scalar>(oval: &Oval<S>, middle: Vec3<S>) -> Vec3<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let Rotation { x, y, z } = oval.axes;
    let [a, b, c] = [x.scale(oval.radii[0]), y.scale(oval.radii[1]), z.scale(oval.radii[2])];
    let form = [
        a.x.mul_add(a.x, b.x.mul_add(b.x, c.x * c.x)),
        a.x.mul_add(a.y, b.x.mul_add(b.y, c.x * c.y)),
        a.y.mul_add(a.y, b.y.mul_add(b.y, c.y * c.y)),
    ];
    // Seen from the ellipsoid the axis is somewhere, and the way is back.
    -past_ellipse(form, [Vec3::new(one, o, o), Vec3::new(o, one, o)], -middle)
}

/// How an ellipsoid and the cylinder are apart along a direction.
#[inline(always)]
fn along<S: Scalar>(cylinder: &Cylinder<S>, oval: &Oval<S>, middle: Vec3<S>, normal: Vec3<S>) -> Apart<S> {
    let (inner, outer) = (cylinder.support(normal), oval.support(normal));
    let distance = normal.dot(middle) - inner.reach - outer.reach;
    // The end of a cylinder is flat: what touches it is the point of the ellipsoid.
    Apart { distance, normal, at: middle - outer.point - normal.scale(distance * S::lit(0.5)) }
}
