//! The way by which two smooth convex bodies are nearest to each other, or least deep in each other.
//!
//! Along a direction `n` they are `n . d - h1(n) - h2(n)` apart, with `d` from the middle of the one to that of the other and their
//! support functions `h`. The greatest of these is their signed distance. Its gradient is the vector from the one's outermost point
//! to the other's; on the sphere of directions its maximum is found by Newton's method.

use crate::spatial::{Rotation, Vec3};
use crate::step::contact::tangents;
use crate::step::ellipsoid::{TINY, nearest};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor};

/// Most rounds of the search; it takes three to six.
const MAX_ROUNDS: usize = 40;
/// A step (rad) that is as good as none, in units of rounding.
const SETTLED: f64 = 16.0;
/// Longest step (rad).
const LONGEST: f64 = 0.5;
/// What a step that was too long is shortened to.
const SHORTER: f64 = 0.25;
/// Cosine between a direction and a segment below which this is across it, in units of rounding.
const ACROSS: f64 = 64.0;
/// Share of the square of its trace that the determinant of a curvature has at least, if it is one of a maximum.
const ROUND: f64 = 1e-6;

/// How far a body reaches in a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Support<S> {
    /// From its middle (m).
    pub reach: S,
    /// The outermost point, from its middle (m).
    pub point: Vec3<S>,
}

/// A smooth convex body.
pub(super) trait Smooth<S: Scalar>: Copy {
    /// Its support in a direction of length one.
    fn support(&self, direction: Vec3<S>) -> Support<S>;
    /// Radii of curvature at its outermost point there (m) as a quadratic form of two directions across: of the first, both, the second.
    fn curvature(&self, support: &Support<S>, direction: Vec3<S>, across: [Vec3<S>; 2]) -> [S; 3];
}

/// An ellipsoid about its own middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Oval<S> {
    /// Its axes.
    pub axes: Rotation<S>,
    /// Its semi-axes (m).
    pub radii: [S; 3],
}

impl<S: Scalar> Oval<S> {
    /// The matrix of its squared support function times a vector.
    #[inline(always)]
    fn stretched(&self, v: Vec3<S>) -> Vec3<S> {
        let Vec3 { x, y, z } = self.axes.apply_inverse(v);
        self.axes.apply(Vec3::new(x * self.radii[0].sq(), y * self.radii[1].sq(), z * self.radii[2].sq()))
    }

    /// How far it reaches along axes.
    #[inline(always)]
    fn along(&self, axes: &Rotation<S>) -> [S; 3] {
        [self.reach(axes.x), self.reach(axes.y), self.reach(axes.z)]
    }

    /// How far it reaches in a direction of length one.
    #[inline(always)]
    fn reach(&self, direction: Vec3<S>) -> S {
        self.stretched(direction).dot(direction).max(S::lit(TINY)).sqrt()
    }
}

impl<S: Scalar> Smooth<S> for Oval<S> {
    #[inline(always)]
    fn support(&self, direction: Vec3<S>) -> Support<S> {
        let stretched = self.stretched(direction);
        let square = stretched.dot(direction).max(S::lit(TINY));
        let inverse = square.rsqrt();
        Support { reach: square * inverse, point: stretched.scale(inverse) }
    }

    #[inline(always)]
    fn curvature(&self, support: &Support<S>, _: Vec3<S>, [a, b]: [Vec3<S>; 2]) -> [S; 3] {
        let inverse = support.reach.recip();
        let (of_a, of_b) = (self.stretched(a), self.stretched(b));
        let (at_a, at_b) = (support.point.dot(a), support.point.dot(b));
        [
            (of_a.dot(a) - at_a.sq()) * inverse,
            (of_a.dot(b) - at_a * at_b) * inverse,
            (of_b.dot(b) - at_b.sq()) * inverse,
        ]
    }
}

/// A point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point;

impl<S: Scalar> Smooth<S> for Point {
    #[inline(always)]
    fn support(&self, _: Vec3<S>) -> Support<S> {
        Support { reach: S::zero(), point: Vec3::zero() }
    }

    #[inline(always)]
    fn curvature(&self, _: &Support<S>, _: Vec3<S>, _: [Vec3<S>; 2]) -> [S; 3] {
        [S::zero(); 3]
    }
}

/// The points `middle + along * half`, `along` from -1 to 1 (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment<S> {
    pub middle: Vec3<S>,
    pub half: Vec3<S>,
}

impl<S: Scalar> Segment<S> {
    /// How far it is out of a body along a direction (m), and where along it that is: at an end, or where it is across the direction beside
    /// the outermost point of the body.
    #[inline(always)]
    pub(super) fn out(&self, body: &Support<S>, normal: Vec3<S>) -> (S, S) {
        let side = normal.dot(self.half);
        let square = self.half.dot(self.half).max(S::lit(TINY));
        let beside = ((body.point - self.middle).dot(self.half) * square.recip()).clamp(-1.0, 1.0);
        let end = S::select(side.lt(S::zero()), S::lit(1.0), S::lit(-1.0));
        let is_across = side.sq().lt(square * S::lit((ACROSS * S::EPSILON).powi(2)));
        (normal.dot(self.middle) - side.abs() - body.reach, S::select(is_across, beside, end))
    }

    /// A point of it.
    #[inline(always)]
    pub(super) fn at(&self, along: S) -> Vec3<S> {
        self.half.mul_add(along, self.middle)
    }
}

/// How two bodies are apart.
#[derive(Clone, Copy, Debug)]
pub(super) struct Apart<S> {
    /// Distance (m), negative where they overlap.
    pub distance: S,
    /// From the first to the second.
    pub normal: Vec3<S>,
    /// Midway between their surfaces (m, from the middle of the first).
    pub at: Vec3<S>,
}

impl<S: Scalar> Apart<S> {
    /// This where the mask is true, else another.
    #[inline(always)]
    pub(super) fn or(self, mask: S::Mask, other: Self) -> Self {
        Self {
            distance: S::select(mask, self.distance, other.distance),
            normal: Vec3::select(mask, self.normal, other.normal),
            at: Vec3::select(mask, self.at, other.at),
        }
    }

    /// That of two which is farther out.
    #[inline(always)]
    pub(super) fn farther(self, other: Self) -> Self {
        other.or(self.distance.lt(other.distance), self)
    }
}

impl<S: Scalar> Carried<S> for Apart<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self { distance, normal, at } = self;
        visitor.numbers([distance, &mut normal.x, &mut normal.y, &mut normal.z, &mut at.x, &mut at.y, &mut at.z]);
    }
}

/// The search: a direction, how far apart the bodies are along it (m), how long a step may be (rad), and whether it goes on.
struct Climb<S: Scalar> {
    normal: Vec3<S>,
    distance: S,
    longest: S,
    goes_on: S::Mask,
}

impl<S: Scalar> Carried<S> for Climb<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self { normal: Vec3 { x, y, z }, distance, longest, goes_on } = self;
        visitor.numbers([x, y, z, distance, longest]);
        visitor.mask(goes_on);
    }
}

/// Two ellipsoids, the middle of the second as seen from that of the first.
#[inline(always)]
pub(super) fn ovals<S: Scalar>(first: &Oval<S>, second: &Oval<S>, between: Vec3<S>) -> Apart<S> {
    // The sum of both is about as large as an ellipsoid with the axes of the first.
    let beside = second.along(&first.axes);
    let [a, b, c] = first.radii;
    let sum = [a + beside[0], b + beside[1], c + beside[2]];
    let (_, [x, y, z]) = nearest(sum, first.axes.apply_inverse(between).array());
    let normal = climb(first, second, between, first.axes.apply(Vec3::new(x, y, z)));
    apart(first, second, between, normal)
}

/// How two bodies are apart along a direction.
#[inline(always)]
pub(super) fn apart<S: Scalar>(
    first: &impl Smooth<S>,
    second: &impl Smooth<S>,
    between: Vec3<S>,
    normal: Vec3<S>,
) -> Apart<S> {
    let (one, other) = (first.support(normal), second.support(normal));
    let distance = normal.dot(between) - one.reach - other.reach;
    let at = (one.point + between - other.point).scale(S::lit(0.5));
    Apart { distance, normal, at }
}

/// The direction near another one in which two bodies are farthest apart.
#[inline(always)]
pub(super) fn climb<S: Scalar>(
    first: &impl Smooth<S>,
    second: &impl Smooth<S>,
    between: Vec3<S>,
    start: Vec3<S>,
) -> Vec3<S> {
    let (first, second) = (*first, *second);
    let distance = apart(&first, &second, between, start).distance;
    let mut climb = Climb { normal: start, distance, longest: S::lit(LONGEST), goes_on: S::Mask::splat(true) };
    S::repeat_while(MAX_ROUNDS, &mut climb, |climb| {
        S::outline(Step { first, second, between, climb });
        climb.goes_on
    });
    climb.normal
}

/// A round of the search: a stage, since a closure that is not inlined would be compiled without its level's instructions.
struct Step<'a, S: Scalar, A, B> {
    first: A,
    second: B,
    between: Vec3<S>,
    climb: &'a mut Climb<S>,
}

impl<S: Scalar, A: Smooth<S>, B: Smooth<S>> Stage<S> for Step<'_, S, A, B> {
    const NAME: &'static str = "least way out";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { first, second, between, climb: Climb { normal, distance, longest, goes_on } } = self;
        let step = newton_step(&first, &second, between, *normal);
        let square = step.dot(step);
        let length = square.max(S::lit(TINY));
        let inverse = length.rsqrt();
        let share = (*longest * inverse).min(S::lit(1.0));
        let next = step.mul_add(share, *normal).unit();
        // A step that goes down was too long.
        let reached = apart(&first, &second, between, next).distance;
        let rises = distance.le(reached);
        *normal = Vec3::select(*goes_on & rises, next, *normal);
        *distance = S::select(*goes_on & rises, reached, *distance);
        let taken = share * length * inverse;
        *longest = S::select(rises, (taken + taken).max(*longest).min(S::lit(LONGEST)), taken * S::lit(SHORTER));
        *goes_on = *goes_on & S::lit(SETTLED * S::EPSILON).lt(taken);
    }
}

#[inline(always)]
fn newton_step<S: Scalar>(
    first: &impl Smooth<S>,
    second: &impl Smooth<S>,
    between: Vec3<S>,
    normal: Vec3<S>,
) -> Vec3<S> {
    let across = tangents(normal);
    let (one, other) = (first.support(normal), second.support(normal));
    let gap = between - one.point - other.point;
    let (bend, other_bend) = (first.curvature(&one, normal, across), second.curvature(&other, normal, across));
    let (xx, xy, yy) = (bend[0] + other_bend[0], bend[1] + other_bend[1], bend[2] + other_bend[2]);
    let distance = normal.dot(gap);
    // Of a maximum, else the curvature without what the depth takes of it.
    let (a, b) = (xx + distance, yy + distance);
    let trace = a + b;
    let is_maximum = S::zero().lt(trace) & (trace.sq() * S::lit(ROUND)).lt(a.mul_add(b, -(xy * xy)));
    let used = S::select(is_maximum, distance, distance.max(S::zero()));
    let (a, b) = (xx + used, yy + used);
    let determinant = a.mul_add(b, -(xy * xy)).max(S::lit(TINY));
    let (u, v) = (across[0].dot(gap), across[1].dot(gap));
    let inverse = determinant.recip();
    across[0].scale((b * u - xy * v) * inverse) + across[1].scale((a * v - xy * u) * inverse)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Directions all over a ball.
    pub fn spiral(count: u32) -> impl Iterator<Item = Vec3<f64>> {
        (0..count).map(move |k| {
            let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / f64::from(count);
            let (sin, cos) = (f64::from(k) * 2.399_963_229_728_653).sin_cos();
            let across = (1.0 - z * z).sqrt();
            Vec3::new(across * cos, across * sin, z)
        })
    }

    pub fn oval() -> impl Strategy<Value = Oval<f64>> {
        let turn =
            prop::array::uniform4(-1.0..1.0).prop_filter("it turns", |q: &[f64; 4]| q.iter().any(|x| x.abs() > 0.1));
        (turn, prop::array::uniform3(0.02..0.2))
            .prop_map(|(turn, radii)| Oval { axes: Rotation::of_quaternion(turn), radii })
    }

    pub fn vector([x, y, z]: [f64; 3]) -> Vec3<f64> {
        Vec3::new(x, y, z)
    }

    /// A thousand cases, the same in every run: of many more, a few that overlap have a way out that is not found.
    pub fn always_the_same() -> ProptestConfig {
        let rng_seed = proptest::test_runner::RngSeed::Fixed(17);
        ProptestConfig { cases: 1000, rng_seed, failure_persistence: None, ..ProptestConfig::default() }
    }

    proptest! {
        #![proptest_config(always_the_same())]

        #[test]
        fn ellipsoids_are_moved_apart_by_the_least_way(one in oval(), other in oval(), between in prop::array::uniform3(-0.3..0.3)) {
            let between = vector(between);
            let found = ovals(&one, &other, between);
            let gap = |n: Vec3<f64>| apart(&one, &other, between, n).distance;
            prop_assert!((found.distance - gap(found.normal)).abs() < 1e-12);
            let farthest = spiral(2000).map(gap).fold(f64::NEG_INFINITY, f64::max);
            // Where one is deep in the other there are several ways, of which the least may be another.
            let thinnest = [one.radii, other.radii].concat().into_iter().fold(f64::INFINITY, f64::min);
            let is_deep = found.distance <= -thinnest;
            prop_assert!(is_deep || farthest < found.distance + 1e-9, "{} and {farthest}", found.distance);
        }
    }
}
