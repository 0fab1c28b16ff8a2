//! The point of a segment that is deepest in an ellipsoid, or nearest to it, and which way is out.
//!
//! Along any direction they are some distance apart, and the greatest of these is their signed distance: the least way by which the segment
//! has to be moved out. It is along the way out of one of the ends, or across the segment, or near this where the segment pierces the middle.

use crate::spatial::{Rotation, Vec3};
use crate::step::contact::tangents;
use crate::step::support::{self, Oval, Segment, Smooth, climb};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor};

/// Most rounds of the search; it takes six or seven.
const MAX_ROUNDS: usize = 40;
/// What nothing is divided by below, in reach of single precision.
pub(super) const TINY: f64 = 1e-30;
/// What is as good as on the surface, in units of rounding.
const SETTLED: f64 = 16.0;

/// A point of a segment beside an ellipsoid, in the axes of that.
#[derive(Clone, Copy, Debug)]
pub struct Deepest<S> {
    /// Where on the segment, from -1 to 1.
    pub along: S,
    /// Signed distance from the surface (m), negative inside.
    pub distance: S,
    /// Out of the ellipsoid.
    pub normal: Vec3<S>,
}

/// The deepest point of `middle + along * half`, from -1 to 1, in the axes of an ellipsoid with these semi-axes.
#[inline(always)]
pub fn deepest<S: Scalar>(radii: [S; 3], middle: Vec3<S>, half: Vec3<S>) -> Deepest<S> {
    let (o, one) = (S::zero(), S::lit(1.0));
    let first = of_end(radii, middle, half, -one);
    let last = of_end(radii, middle, half, one);
    let between = across(radii, middle, half);
    // A ball has nothing across.
    let is_long = S::lit(TINY).lt(half.dot(half));
    let mut best = last.or(first.distance.lt(last.distance), first);
    best = between.or(is_long & best.distance.lt(between.distance), best);
    // An end is out along its own way, unless the other end is less so.
    let is_settled = first.along.lt(o) & o.lt(last.along);
    let is_odd = is_long & best.distance.lt(o) & !is_settled;
    let ways = [first, last, between];
    S::when(is_odd, &mut best, |best| S::outline(Pierced { radii, middle, half, ways, is_odd, best }));
    best
}

/// Where a segment pierces an ellipsoid, the way out of its deepest end may be another than that of the end alone: one near the way out of the
/// other end, or across.
struct Pierced<'a, S: Scalar> {
    radii: [S; 3],
    middle: Vec3<S>,
    half: Vec3<S>,
    ways: [Deepest<S>; 3],
    is_odd: S::Mask,
    best: &'a mut Deepest<S>,
}

impl<S: Scalar> Stage<S> for Pierced<'_, S> {
    const NAME: &'static str = "pierced ellipsoid";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { radii, middle, half, ways, is_odd, best } = self;
        let oval = Oval { axes: Rotation::identity(), radii };
        for Deepest { along, normal, .. } in ways {
            let normal = climb(&oval, &support::Point, half.mul_add(along, middle), normal);
            let way = outward(radii, middle, half, normal);
            *best = way.or(is_odd & best.distance.lt(way.distance), *best);
        }
    }
}

impl<S: Scalar> Carried<S> for Deepest<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self { along, distance, normal } = self;
        visitor.numbers([along, distance, &mut normal.x, &mut normal.y, &mut normal.z]);
    }
}

impl<S: Scalar> Deepest<S> {
    /// This where the mask is true, else another.
    #[inline(always)]
    fn or(self, mask: S::Mask, other: Self) -> Self {
        Self {
            along: S::select(mask, self.along, other.along),
            distance: S::select(mask, self.distance, other.distance),
            normal: Vec3::select(mask, self.normal, other.normal),
        }
    }
}

/// How far the segment is out along the way out of one of its ends.
#[inline(always)]
fn of_end<S: Scalar>(radii: [S; 3], middle: Vec3<S>, half: Vec3<S>, along: S) -> Deepest<S> {
    let (_, [x, y, z]) = nearest(radii, half.mul_add(along, middle).array());
    outward(radii, middle, half, Vec3::new(x, y, z))
}

/// How far the segment is out along a direction, and with which point: an end, or of a segment across it the one beside the outermost point
/// of the ellipsoid.
#[inline(always)]
fn outward<S: Scalar>(radii: [S; 3], middle: Vec3<S>, half: Vec3<S>, normal: Vec3<S>) -> Deepest<S> {
    let (distance, along) =
        Segment { middle, half }.out(&Oval { axes: Rotation::identity(), radii }.support(normal), normal);
    Deepest { along, distance, normal }
}

/// The same across the segment: seen along it, the segment is a point and the ellipsoid an
/// ellipse.
#[inline(always)]
fn across<S: Scalar>(radii: [S; 3], middle: Vec3<S>, half: Vec3<S>) -> Deepest<S> {
    let [x, y] = tangents(half.unit());
    let stretched = |v: Vec3<S>| Vec3::new(v.x * radii[0].sq(), v.y * radii[1].sq(), v.z * radii[2].sq());
    let form = [stretched(x).dot(x), stretched(x).dot(y), stretched(y).dot(y)];
    outward(radii, middle, half, past_ellipse(form, [x, y], middle))
}

/// The way out of an ellipse at a place, as both are seen across two directions. Its squared support function is a quadratic form of these.
#[inline(always)]
pub(super) fn past_ellipse<S: Scalar>(form: [S; 3], across: [Vec3<S>; 2], place: Vec3<S>) -> Vec3<S> {
    let ([long, short], radii) = ellipse(form, across);
    let (_, [along_long, along_short]) = nearest(radii, [long.dot(place), short.dot(place)]);
    long.scale(along_long) + short.scale(along_short)
}

/// Directions and lengths of the semi-axes of an ellipse, from its squared support function as a quadratic form of two directions: of the
/// first, both, the second.
#[inline(always)]
fn ellipse<S: Scalar>([xx, xy, yy]: [S; 3], [x, y]: [Vec3<S>; 2]) -> ([Vec3<S>; 2], [S; 2]) {
    let tiny = S::lit(TINY);
    let (mean, half_difference) = ((xx + yy) * S::lit(0.5), (xx - yy) * S::lit(0.5));
    let spread = half_difference.mul_add(half_difference, xy * xy).max(tiny).sqrt();
    let cosine = (half_difference * spread.recip()).clamp(-1.0, 1.0);
    let [c, s] = [cosine, -cosine].map(|cosine| (S::lit(0.5) * (S::lit(1.0) + cosine)).max(S::zero()).sqrt());
    let s = S::select(xy.lt(S::zero()), -s, s);
    let axes = [x.scale(c) + y.scale(s), y.scale(c) - x.scale(s)];
    (axes, [mean + spread, mean - spread].map(|square| square.max(tiny).sqrt()))
}

/// Signed distance of a point from the surface of an ellipsoid, and the direction out of it there.
///
/// The surface point is `a_i^2 p_i / (a_i^2 + shift)`, with the shift at which it lies on the surface; it is found by Newton's
/// method on the reciprocal of its norm in semi-axes, which is almost a straight line (as in trust regions; More and Sorensen 1983,
/// doi 10.1137/0904038). What is looked for is by how much the shift is above the least that there can be, `-a_i^2` of the shortest
/// semi-axis, which it comes near to where a point is deep in a flat ellipsoid.
#[inline(always)]
pub fn nearest<S: Scalar, const N: usize>(radii: [S; N], mut point: [S; N]) -> (S, [S; N]) {
    let squares = radii.map(|radius| radius * radius);
    let mut least = squares[0];
    for &square in &squares[1..] {
        least = least.min(square);
    }
    let mut above = S::zero();
    for k in 0..N {
        // A point in a plane of symmetry is on one side of it, so that there is one way out.
        let off = radii[k] * S::lit(S::EPSILON);
        point[k] = S::select(point[k].abs().lt(off), off, point[k]);
        // Each coordinate alone tells how much there is at least.
        above = above.max(radii[k].mul_add(point[k].abs(), least - squares[k]));
    }
    let mut search = Shift { above, goes_on: S::Mask::splat(true) };
    S::repeat_while(MAX_ROUNDS, &mut search, |search| {
        S::outline(Seek { radii, squares, least, point, search });
        search.goes_on
    });
    let mut square = S::zero();
    for k in 0..N {
        point[k] = point[k] * (squares[k] - least + search.above).recip();
        square = point[k].mul_add(point[k], square);
    }
    let inverse = square.rsqrt();
    for component in &mut point {
        *component = *component * inverse;
    }
    ((search.above - least) * square * inverse, point)
}

/// A round of the search: a stage, since a closure that is not inlined would be compiled without its level's instructions.
struct Seek<'a, S: Scalar, const N: usize> {
    radii: [S; N],
    squares: [S; N],
    least: S,
    point: [S; N],
    search: &'a mut Shift<S>,
}

impl<S: Scalar, const N: usize> Stage<S> for Seek<'_, S, N> {
    const NAME: &'static str = "way out of an ellipsoid";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { radii, squares, least, point, search: Shift { above, goes_on } } = self;
        let (mut square, mut slope) = (S::zero(), S::zero());
        for k in 0..N {
            let inverse = (squares[k] - least + *above).recip();
            let scaled = radii[k] * point[k] * inverse;
            square = scaled.mul_add(scaled, square);
            slope = (scaled * scaled).mul_add(inverse, slope);
        }
        let excess = square.sqrt() - S::lit(1.0);
        let next = (square * excess).mul_add(slope.recip(), *above);
        *above = S::select(*goes_on, next, *above);
        *goes_on = *goes_on & S::lit(SETTLED * S::EPSILON).lt(excess.abs());
    }
}

/// See [`nearest`].
struct Shift<S: Scalar> {
    above: S,
    goes_on: S::Mask,
}

impl<S: Scalar> Carried<S> for Shift<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.number(&mut self.above);
        visitor.mask(&mut self.goes_on);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    fn vector([x, y, z]: [f64; 3]) -> Vec3<f64> {
        Vec3::new(x, y, z)
    }

    /// How far a segment is from an ellipsoid along a direction: what their support functions leave over.
    fn gap(radii: [f64; 3], middle: Vector3<f64>, half: Vector3<f64>, n: &Vector3<f64>) -> f64 {
        let support = (0..3).map(|k| (radii[k] * n[k]).powi(2)).sum::<f64>().sqrt();
        n.dot(&middle) - n.dot(&half).abs() - support
    }

    /// Directions all over a ball.
    fn spiral(count: u32) -> impl Iterator<Item = Vector3<f64>> {
        (0..count).map(move |k| {
            let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / f64::from(count);
            let (sin, cos) = (f64::from(k) * 2.399_963_229_728_653).sin_cos();
            let across = (1.0 - z * z).sqrt();
            Vector3::new(across * cos, across * sin, z)
        })
    }

    fn radii() -> impl Strategy<Value = [f64; 3]> {
        prop::array::uniform3(0.02..0.2)
    }

    proptest! {
        #[test]
        fn the_distance_is_that_of_a_point_on_the_surface(radii in radii(), point in prop::array::uniform3(-0.4..0.4)) {
            let (distance, normal) = nearest(radii, point);
            let surface: [f64; 3] = std::array::from_fn(|k| point[k] - normal[k] * distance);
            let level: f64 = (0..3).map(|k| (surface[k] / radii[k]).powi(2)).sum();
            prop_assert!((level - 1.0).abs() < 1e-9, "{level}");
            // Along the gradient.
            let gradient = Vector3::new(surface[0] / radii[0].powi(2), surface[1] / radii[1].powi(2), surface[2] / radii[2].powi(2));
            prop_assert!((gradient.normalize() - Vector3::from(normal)).norm() < 1e-8);
            let inside = (0..3).map(|k| (point[k] / radii[k]).powi(2)).sum::<f64>() < 1.0;
            prop_assert_eq!(distance < 0.0, inside);
        }

        #[test]
        fn a_segment_is_moved_out_by_the_least_way(
            radii in radii(), middle in prop::array::uniform3(-0.3..0.3), half in prop::array::uniform3(-0.3..0.3)
        ) {
            let found = deepest(radii, vector(middle), vector(half));
            let gap = |n: &Vector3<f64>| gap(radii, middle.into(), half.into(), n);
            // Along its normal it is as far as that, and along no other direction farther.
            let along_it = gap(&Vector3::from(found.normal.array()));
            prop_assert!((found.distance - along_it).abs() < 1e-9, "{} and {along_it}", found.distance);
            let farthest = spiral(2000).map(|n| gap(&n)).fold(f64::NEG_INFINITY, f64::max);
            prop_assert!(farthest < found.distance + 1e-9, "{} and {farthest}", found.distance);
            prop_assert!((-1.0..=1.0).contains(&found.along));
        }
    }

    #[test]
    fn a_ball_is_an_ellipsoid() {
        let (distance, normal) = nearest([0.1; 3], [0.0, 0.0, 0.25]);
        assert!((distance - 0.15).abs() < 1e-15 && (normal[2] - 1.0).abs() < 1e-15, "{distance} {normal:?}");
        // A rod across its upper half, longer than the ball is wide.
        let rod = deepest([0.1; 3], vector([0.02, 0.0, 0.05]), vector([0.3, 0.0, 0.0]));
        assert!((rod.distance + 0.05).abs() < 1e-12 && (rod.along + 0.02 / 0.3).abs() < 1e-9, "{rod:?}");
        // One that points at it.
        let pole = deepest([0.1; 3], vector([0.0, 0.0, 0.3]), vector([0.0, 0.0, 0.1]));
        assert!((pole.distance - 0.1).abs() < 1e-12 && pole.along == -1.0, "{pole:?}");
    }
}
