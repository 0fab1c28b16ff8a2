//! A capsule or an ellipsoid beside a cylinder that has ends.
//!
//! Along each direction they are some distance apart, and the greatest of these is their signed distance. Directions in which it can be are
//! those of the near end, those across the axis, and those from the rim between both.

use crate::spatial::{Rotation, Vec3};
use crate::step::contact::tangents;
use crate::step::ellipsoid::{ACROSS, TINY, ellipse, nearest};
use crate::step::support::{Apart, Oval, Smooth, Support, apart, climb};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor};

/// Farther than anything that touches (m).
const FAR: f64 = 1e3;
/// Cosine of the angle between a way out and the axis above which it is past an end.
const SIDEWAYS: f64 = 1e-6;
/// Sine of the angle by which a capsule leans at most that lies on an end with both its own.
const LEAN_OF_LYING: f64 = 0.0888;
/// Steps by which a direction between two bodies is found about.
const STEPS_TOWARD: usize = 32;
/// Most steps of a search about the axis of a rod, and the longest of them (rad).
const MAX_TURNS: usize = 20;
/// See [`MAX_TURNS`].
const LONGEST_TURN: f64 = 0.5;
/// A step (rad) that is as good as none, in units of rounding.
const SETTLED: f64 = 16.0;
/// Corners of the polygon that MuJoCo takes for an end.
const CORNERS: usize = 16;
/// How much a first direction from the rim leans to either side at least.
const LEAN: f64 = 0.05;

/// A cylinder about the z axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cylinder<S> {
    /// Radius (m).
    pub radius: S,
    /// Half of its length (m).
    pub half_length: S,
    /// Distance (m) at which contact begins.
    pub margin: S,
}

/// Where a point is beside it.
pub(super) struct Beside<S> {
    pub distance: S,
    normal: Vec3<S>,
}

impl<S: Scalar> Cylinder<S> {
    /// Signed distance of a point, and the direction out of the cylinder there.
    #[inline(always)]
    pub(super) fn beside(&self, point: Vec3<S>) -> Beside<S> {
        let (o, one) = (S::zero(), S::lit(1.0));
        let square = point.x.mul_add(point.x, point.y * point.y);
        let inverse = square.max(S::lit(TINY)).rsqrt();
        // On the axis any way out is as good.
        let is_axis = square.lt(S::lit(TINY));
        let aside = Vec3::new(S::select(is_axis, one, point.x * inverse), (point.y * inverse).only(!is_axis), o);
        let up = Vec3::new(o, o, S::select(point.z.lt(o), -one, one));
        let (over, out) = (point.z.abs() - self.half_length, square * inverse - self.radius);
        let (over_end, over_side) = (over.max(o), out.max(o));
        let beyond = over_end.mul_add(over_end, over_side * over_side);
        let from_edge = beyond.max(S::lit(TINY)).rsqrt();
        let is_inside = !(o.lt(over) | o.lt(out));
        let inside = Vec3::select(out.lt(over), up, aside);
        let outside = up.scale(over_end * from_edge) + aside.scale(over_side * from_edge);
        Beside {
            distance: S::select(is_inside, over.max(out), beyond * from_edge),
            normal: Vec3::select(is_inside, inside, outside),
        }
    }
}

/// Halves a segment. A stage, since a closure that is not inlined would be compiled without its level's instructions.
struct Halve<'a, S> {
    cylinder: &'a Cylinder<S>,
    middle: Vec3<S>,
    half: Vec3<S>,
    part: &'a mut Part<S>,
}

impl<S: Scalar> Stage<S> for Halve<'_, S> {
    const NAME: &'static str = "half of a segment";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { cylinder, middle, half, part: Part { first, last } } = self;
        let along = (*first + *last) * S::lit(0.5);
        let rises = S::zero().lt(cylinder.beside(half.mul_add(along, middle)).normal.dot(half));
        *first = S::select(rises, *first, along);
        *last = S::select(rises, along, *last);
    }
}

impl<S: Scalar> Cylinder<S> {
    /// Whether a way out is that past an end, and what touches there is over it: past the rim it is no less deep.
    #[inline(always)]
    fn is_over_end(&self, way: &Apart<S>, touching: Vec3<S>) -> S::Mask {
        let aside = touching.x.mul_add(touching.x, touching.y * touching.y);
        S::lit(0.5).lt(way.normal.z.abs()) & aside.lt(self.radius.sq())
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

/// A capsule, its middle and half its axis in the axes of the cylinder: the one point in which they meet, or the two in which it lies on
/// an end. Points that are not there are far apart.
#[inline(always)]
pub(super) fn rod<S: Scalar>(cylinder: &Cylinder<S>, middle: Vec3<S>, half: Vec3<S>, radius: S) -> [Apart<S>; 2] {
    let one = nearest_of_rod(cylinder, middle, half, radius);
    let far = S::lit(FAR);
    let is_end = S::lit(SIDEWAYS).lt(one.normal.z.abs());
    let ends = lying(cylinder, middle, half, radius, one.normal);
    let [first, second] = ends;
    let first_touches = is_end & first.distance.lt(cylinder.margin);
    let second_touches = is_end & second.distance.lt(cylinder.margin);
    let first = first.or(first_touches, Apart { distance: far, ..first });
    let second = second.or(second_touches, Apart { distance: far, ..second });
    [first.or(first_touches | second_touches, one), second]
}

impl<S: Scalar> Apart<S> {
    /// This where the mask is true, else another.
    #[inline(always)]
    fn or(self, mask: S::Mask, other: Self) -> Self {
        Self {
            distance: S::select(mask, self.distance, other.distance),
            normal: Vec3::select(mask, self.normal, other.normal),
            at: Vec3::select(mask, self.at, other.at),
        }
    }
}

/// Where a capsule is nearest, or which is its least way out.
#[inline(always)]
fn nearest_of_rod<S: Scalar>(cylinder: &Cylinder<S>, middle: Vec3<S>, half: Vec3<S>, radius: S) -> Apart<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let rod = Rod { middle, half };
    // An axis that is out of the cylinder is nearest where its point is, and one that is in it least deep along one of the others.
    let mut best = outermost(cylinder, &rod);
    let is_out = o.le(best.distance);
    let beside = beside_rod(cylinder, &rod);
    best = beside.or(best.distance.lt(beside.distance), best);
    for up in [one, -one] {
        let over = rod.out(cylinder, Vec3::new(o, o, up));
        best = over.or(best.distance.lt(over.distance), best);
    }
    let is_in = !is_out;
    S::when(is_in, &mut best, |best| S::outline(RodPastRims { cylinder, rod, is_in, best }));
    let Apart { distance, normal, at } = best;
    Apart { distance: distance - radius, normal, at: at - normal.scale((distance + radius) * S::lit(0.5)) }
}

impl<S: Scalar> Carried<S> for Apart<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self { distance, normal, at } = self;
        visitor.numbers([distance, &mut normal.x, &mut normal.y, &mut normal.z, &mut at.x, &mut at.y, &mut at.z]);
    }
}

/// The ways out of a rod past both rims.
struct RodPastRims<'a, S: Scalar> {
    cylinder: &'a Cylinder<S>,
    rod: Rod<S>,
    /// Where the axis of the rod pierces the cylinder.
    is_in: S::Mask,
    best: &'a mut Apart<S>,
}

impl<S: Scalar> Stage<S> for RodPastRims<'_, S> {
    const NAME: &'static str = "rod past rims";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { cylinder, rod, is_in, best } = self;
        for up in [S::lit(1.0), S::lit(-1.0)] {
            for normal in [past_rim(cylinder, &rod, up), least_past_end(cylinder, &rod, up)] {
                let other = rod.out(cylinder, normal);
                *best = other.or(is_in & best.distance.lt(other.distance), *best);
            }
        }
    }
}

/// The way out across the cylinder: seen along it, the rod is a line and the cylinder a circle.
#[inline(always)]
fn beside_rod<S: Scalar>(cylinder: &Cylinder<S>, rod: &Rod<S>) -> Apart<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let Rod { middle, half } = *rod;
    let (seen, along) = (Vec3::new(middle.x, middle.y, o), Vec3::new(half.x, half.y, o));
    let nearest_axis = (-(seen.dot(along)) * along.dot(along).max(S::lit(TINY)).recip()).clamp(-1.0, 1.0);
    let aside = along.mul_add(nearest_axis, seen);
    let square = aside.dot(aside);
    // On the axis any way out is as good.
    let is_axis = square.lt(S::lit(TINY));
    let normal = Vec3::select(is_axis, Vec3::new(one, o, o), aside.scale(square.max(S::lit(TINY)).rsqrt()));
    Apart { at: half.mul_add(nearest_axis, middle), ..rod.out(cylinder, normal) }
}

/// The axis of a capsule.
#[derive(Clone, Copy)]
struct Rod<S> {
    middle: Vec3<S>,
    half: Vec3<S>,
}

impl<S: Scalar> Rod<S> {
    /// How far it is out along a direction, and with which point.
    #[inline(always)]
    fn out(&self, cylinder: &Cylinder<S>, normal: Vec3<S>) -> Apart<S> {
        let (o, one) = (S::zero(), S::lit(1.0));
        let end = S::select(normal.z.lt(o), -cylinder.half_length, cylinder.half_length);
        let Support { reach, point } = Rim { radius: cylinder.radius, end }.support(normal);
        let side = normal.dot(self.half);
        // Along its own axis an end is, and across it the point beside the rim.
        let square = self.half.dot(self.half).max(S::lit(TINY));
        let beside = ((point - self.middle).dot(self.half) * square.recip()).clamp(-1.0, 1.0);
        let is_across = side.sq().lt(square * S::lit(ACROSS * S::EPSILON * S::EPSILON));
        let along = S::select(is_across, beside, S::select(side.lt(o), one, -one));
        let distance = normal.dot(self.middle) - side.abs() - reach;
        Apart { distance, normal, at: self.half.mul_add(along, self.middle) }
    }
}

/// The point of an axis that is nearest to a cylinder, if it is out of it. There the distance is a smooth convex function along the axis.
#[inline(always)]
fn outermost<S: Scalar>(cylinder: &Cylinder<S>, rod: &Rod<S>) -> Apart<S> {
    let Rod { middle, half } = *rod;
    let mut part = Part { first: S::lit(-1.0), last: S::lit(1.0) };
    let always = S::Mask::splat(true);
    // As many halvings as a number has binary digits.
    let halvings = -S::EPSILON.log2() as usize;
    S::repeat_while(halvings, &mut part, |part| {
        S::outline(Halve { cylinder, middle, half, part });
        always
    });
    // Where it never rises the last point is nearest, and where it always does the first.
    let point = half.mul_add((part.first + part.last) * S::lit(0.5), middle);
    let Beside { distance, normal } = cylinder.beside(point);
    let is_in = distance.lt(S::zero());
    Apart { distance: S::select(is_in, S::lit(-FAR), distance), normal, at: point }
}

/// The direction across a rod in which it is least deep at the rim: seen along the rod, this is an ellipse.
#[inline(always)]
fn past_rim<S: Scalar>(cylinder: &Cylinder<S>, rod: &Rod<S>, up: S) -> Vec3<S> {
    let Rod { middle, half } = *rod;
    let square = half.dot(half);
    // A ball is looked at from above.
    let is_ball = square.lt(S::lit(TINY));
    let above = Vec3::new(S::zero(), S::zero(), S::lit(1.0));
    let axis = Vec3::select(is_ball, above, half.scale(square.max(S::lit(TINY)).rsqrt()));
    let [x, y] = tangents(axis);
    let scale = cylinder.radius.sq();
    let flat = |a: Vec3<S>, b: Vec3<S>| a.x.mul_add(b.x, a.y * b.y) * scale;
    let ([long, short], radii) = ellipse([flat(x, x), flat(x, y), flat(y, y)], [x, y]);
    let from_end = middle - above.scale(cylinder.half_length * up);
    let (_, [along_long, along_short]) = nearest(radii, [long.dot(from_end), short.dot(from_end)]);
    long.scale(along_long) + short.scale(along_short)
}

/// The direction across a rod in which it is least deep at the rim, as near as may be to the way out past the end.
#[inline(always)]
fn least_past_end<S: Scalar>(cylinder: &Cylinder<S>, rod: &Rod<S>, up: S) -> Vec3<S> {
    let Rod { middle, half } = *rod;
    let (o, one) = (S::zero(), S::lit(1.0));
    let above = Vec3::new(o, o, up);
    let axis = half.scale(half.dot(half).max(S::lit(TINY)).rsqrt());
    let across = above - axis.scale(axis.dot(above));
    let square = across.dot(across);
    // Of an upright rod any way across is as good.
    let is_upright = square.lt(S::lit(TINY));
    let start = Vec3::select(is_upright, Vec3::new(one, o, o), across.scale(square.max(S::lit(TINY)).rsqrt()));
    let rim = Rim { radius: cylinder.radius, end: cylinder.half_length * up };
    let mut way = Way { normal: start, goes_on: S::Mask::splat(true) };
    S::repeat_while(MAX_TURNS, &mut way, |way| {
        S::outline(Turn { rim, middle, axis, way });
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
        let next = side.mul_add(step, *normal);
        let next = next.scale(next.dot(next).max(S::lit(TINY)).rsqrt());
        *normal = Vec3::select(*goes_on, next, *normal);
        *goes_on = *goes_on & S::lit(SETTLED * S::EPSILON).lt(step.abs());
    }
}

/// The ends of the line with which a capsule lies on an end of the cylinder, as MuJoCo 4.0 has them (found by trying): of one that leans
/// by up to [`LEAN_OF_LYING`], as far as they are over a polygon of sixteen corners within the rim. The line is that of the surface, half a margin
/// farther out, against the capsule's way out, less what of this is along its axis. Points that are not there are far apart.
#[inline(always)]
fn lying<S: Scalar>(cylinder: &Cylinder<S>, middle: Vec3<S>, half: Vec3<S>, radius: S, out: Vec3<S>) -> [Apart<S>; 2] {
    let (o, one) = (S::zero(), S::lit(1.0));
    let up = S::select(out.z.lt(o), -one, one);
    let square = half.dot(half).max(S::lit(TINY));
    let axis = half.scale(square.rsqrt());
    let surface = radius + cylinder.margin * S::lit(0.5);
    let normal = Vec3::new(o, o, up);
    let line = middle - (out - axis.scale(out.dot(axis))).scale(surface);
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
    let is_there = is_rod & axis.z.abs().lt(S::lit(LEAN_OF_LYING)) & first.lt(last);
    let first = over_end(cylinder, half.mul_add(first, line), normal, is_there);
    [first, over_end(cylinder, half.mul_add(last, line), normal, is_there)]
}

/// A point of a line over an end of the cylinder, half a margin farther out than the surface it belongs to.
#[inline(always)]
fn over_end<S: Scalar>(cylinder: &Cylinder<S>, point: Vec3<S>, normal: Vec3<S>, is_there: S::Mask) -> Apart<S> {
    let over = point.z.mul_add(normal.z, -cylinder.half_length);
    let half_margin = cylinder.margin * S::lit(0.5);
    let distance = S::select(is_there, over + half_margin, S::lit(FAR));
    Apart { distance, normal, at: point - normal.scale((over - half_margin) * S::lit(0.5)) }
}

/// The rim of one end of a cylinder, from the middle of that.
#[derive(Clone, Copy, Debug)]
struct Rim<S> {
    radius: S,
    /// How far up the end is (m).
    end: S,
}

impl<S: Scalar> Rim<S> {
    /// Length of a direction across the axis, and its reciprocal.
    #[inline(always)]
    fn across(direction: Vec3<S>) -> (S, S) {
        let square = direction.x.mul_add(direction.x, direction.y * direction.y).max(S::lit(TINY));
        let inverse = square.rsqrt();
        (square * inverse, inverse)
    }
}

impl<S: Scalar> Smooth<S> for Rim<S> {
    #[inline(always)]
    fn support(&self, direction: Vec3<S>) -> Support<S> {
        let (length, inverse) = Self::across(direction);
        let scale = self.radius * inverse;
        Support {
            reach: self.radius.mul_add(length, self.end * direction.z),
            point: Vec3::new(direction.x * scale, direction.y * scale, self.end),
        }
    }

    #[inline(always)]
    fn curvature(&self, _: &Support<S>, direction: Vec3<S>, [a, b]: [Vec3<S>; 2]) -> [S; 3] {
        let (_, inverse) = Self::across(direction);
        // It bends around the axis only.
        let around = |v: Vec3<S>| (direction.x * v.y - direction.y * v.x) * inverse;
        let (x, y, scale) = (around(a), around(b), self.radius * inverse);
        [x * x * scale, x * y * scale, y * y * scale]
    }
}

/// An ellipsoid, its middle and axes in those of the cylinder.
#[inline(always)]
pub(super) fn oval<S: Scalar>(cylinder: &Cylinder<S>, oval: &Oval<S>, middle: Vec3<S>) -> Apart<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let side = beside_axis(oval, middle);
    let mut best = along(cylinder, oval, middle, side);
    for up in [one, -one] {
        let over = along(cylinder, oval, middle, Vec3::new(o, o, up));
        best = over.or(best.distance.lt(over.distance), best);
    }
    let is_open = !cylinder.is_over_end(&best, middle - oval.support(best.normal).point);
    S::when(is_open, &mut best, |best| S::outline(OvalPastRims { cylinder, oval, middle, side, is_open, best }));
    best
}

/// The ways out of an ellipsoid past both rims.
struct OvalPastRims<'a, S: Scalar> {
    cylinder: &'a Cylinder<S>,
    oval: &'a Oval<S>,
    middle: Vec3<S>,
    /// The way out across the axis.
    side: Vec3<S>,
    /// Where it is looked at.
    is_open: S::Mask,
    best: &'a mut Apart<S>,
}

impl<S: Scalar> Stage<S> for OvalPastRims<'_, S> {
    const NAME: &'static str = "ellipsoid past rims";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { cylinder, oval, middle, side, is_open, best } = self;
        let between = toward(cylinder, oval, middle);
        let apart = along(cylinder, oval, middle, between).distance;
        for up in [S::lit(1.0), S::lit(-1.0)] {
            let end = Vec3::new(S::zero(), S::zero(), up);
            let rim = Rim { radius: cylinder.radius, end: cylinder.half_length * up };
            let corner = middle - rim.support(side).point;
            let out = side.scale(corner.dot(side).max(S::lit(LEAN))) + end.scale(corner.dot(end).max(S::lit(LEAN)));
            let out = out.scale(out.dot(out).rsqrt());
            let start = Vec3::select(along(cylinder, oval, middle, out).distance.lt(apart), between, out);
            let from_rim = along(cylinder, oval, middle, climb(&rim, oval, middle, start));
            *best = from_rim.or(is_open & best.distance.lt(from_rim.distance), *best);
        }
    }
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
    vector.scale(vector.dot(vector).max(S::lit(TINY)).rsqrt())
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
        let length = vector.dot(*vector).max(S::lit(TINY));
        let way = vector.scale(length.rsqrt());
        let end = S::select(way.z.lt(S::zero()), -cylinder.half_length, cylinder.half_length);
        let rim = Rim { radius: cylinder.radius, end };
        let extreme = middle - oval.support(way).point - rim.support(way).point;
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
    let ([long, short], radii) = ellipse(form, [Vec3::new(one, o, o), Vec3::new(o, one, o)]);
    // A middle on the axis is a little beside it.
    let (_, [along_long, along_short]) = nearest(radii, [-long.dot(middle), -short.dot(middle)]);
    -(long.scale(along_long) + short.scale(along_short))
}

/// How an ellipsoid and the cylinder are apart along a direction.
#[inline(always)]
fn along<S: Scalar>(cylinder: &Cylinder<S>, oval: &Oval<S>, middle: Vec3<S>, direction: Vec3<S>) -> Apart<S> {
    let end = S::select(direction.z.lt(S::zero()), -cylinder.half_length, cylinder.half_length);
    let Apart { distance, normal, .. } = apart(&Rim { radius: cylinder.radius, end }, oval, middle, direction);
    let point = middle - oval.support(direction).point;
    Apart { distance, normal, at: point - normal.scale(distance * S::lit(0.5)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::support::tests::{always_the_same, oval as ovals, spiral, vector};
    use proptest::prelude::*;

    fn cylinders() -> impl Strategy<Value = Cylinder<f64>> {
        (0.02..0.3, 0.02..0.3).prop_map(|(radius, half_length)| Cylinder { radius, half_length, margin: 0.0 })
    }

    /// How far it reaches.
    fn reach(cylinder: &Cylinder<f64>, n: Vec3<f64>) -> f64 {
        cylinder.radius * n.x.hypot(n.y) + cylinder.half_length * n.z.abs()
    }

    proptest! {
        #![proptest_config(always_the_same())]

        #[test]
        fn a_capsule_is_moved_out_by_the_least_way(
            cylinder in cylinders(), middle in prop::array::uniform3(-0.4..0.4), half in prop::array::uniform3(-0.3..0.3),
            radius in 0.01..0.1
        ) {
            let (middle, half) = (vector(middle), vector(half));
            let found = nearest_of_rod(&cylinder, middle, half, radius);
            let gap = |n: Vec3<f64>| n.dot(middle) - n.dot(half).abs() - reach(&cylinder, n) - radius;
            prop_assert!((found.distance - gap(found.normal)).abs() < 1e-9, "{} {}", found.distance, gap(found.normal));
            let farthest = spiral(2000).map(gap).fold(f64::NEG_INFINITY, f64::max);
            // Where its axis is deep in the cylinder there are several ways, of which the least may be another.
            let is_deep = found.distance <= -radius - 0.5 * cylinder.radius.min(cylinder.half_length);
            prop_assert!(is_deep || farthest < found.distance + 1e-9, "{} and {farthest}", found.distance);
        }

        #[test]
        fn an_ellipsoid_is_moved_out_by_the_least_way(
            cylinder in cylinders(), other in ovals(), middle in prop::array::uniform3(-0.4..0.4)
        ) {
            let middle = vector(middle);
            let found = oval(&cylinder, &other, middle);
            let gap = |n: Vec3<f64>| n.dot(middle) - other.support(n).reach - reach(&cylinder, n);
            prop_assert!((found.distance - gap(found.normal)).abs() < 1e-9, "{} {}", found.distance, gap(found.normal));
            let farthest = spiral(2000).map(gap).fold(f64::NEG_INFINITY, f64::max);
            let thinnest = other.radii.into_iter().fold(cylinder.radius.min(cylinder.half_length), f64::min);
            let is_deep = found.distance <= -0.1 * thinnest;
            prop_assert!(is_deep || farthest < found.distance + 1e-9, "{} and {farthest}", found.distance);
        }
    }

    #[test]
    fn a_capsule_lies_on_an_end_with_both_its_own() {
        let cylinder = Cylinder { radius: 0.5, half_length: 0.2, margin: 0.002 };
        let lying = |lean: f64, x: f64| {
            let half = Vec3::new(0.1 * (1.0 - lean * lean).sqrt(), 0.0, 0.1 * lean);
            rod(&cylinder, Vec3::new(x, 0.0, 0.205), half, 0.02)
        };
        // What MuJoCo 4.0.0 says of one that leans by five degrees, with a margin of a millimetre each.
        let lean = 5.0_f64.to_radians().sin();
        let [low, high] = lying(lean, 0.0);
        assert!((low.distance + 0.023_556_055_68).abs() < 1e-9 && (high.distance + 0.006_124_907_13).abs() < 1e-9);
        assert!((low.at.x + 0.097_796_163_9).abs() < 1e-9 && (low.at.z - 0.188_221_972).abs() < 1e-8);
        // One that leans more stands on one end, and one beyond the rim is there as far as that.
        let [low, high] = lying(0.1, 0.0);
        assert!(low.distance < 0.0 && high.distance > 1.0);
        let [low, high] = lying(0.02, 0.45);
        assert!((high.at.x - 0.5).abs() < 1e-12 && high.distance < 0.0 && low.distance < high.distance);
    }
}
