//! The point of a segment that is deepest in an ellipsoid, or nearest to it, and which way is out.
//!
//! The signed distance from an ellipsoid is a convex function in space, so along a segment its slope only grows: where it is
//! zero is the point that is looked for, else it is an end. As every point of the segment is at least as far out along the
//! normal there, this is also the least way by which the segment has to be moved out. (Where a segment pierces the middle of an
//! ellipsoid, and the slope jumps, the least way across the segment is taken.)

use crate::spatial::Vec3;
use crate::step::contact::tangents;
use myo_scalar::{Carried, Mask, Scalar, Visitor};

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
    let zero = S::zero();
    let [first, last] = [middle - half, middle + half].map(Vec3::array);
    let [(at_first, out_of_first), (at_last, out_of_last)] = [nearest(radii, first), nearest(radii, last)];
    let [out_of_first, out_of_last] = [out_of_first, out_of_last].map(|[x, y, z]| Vec3::new(x, y, z));
    let falls_to_the_end = out_of_last.dot(half).lt(zero);
    let rises_from_the_start = zero.le(out_of_first.dot(half));
    let side = S::select(falls_to_the_end, S::lit(1.0), S::lit(-1.0));
    let end = Deepest {
        along: side,
        distance: S::select(falls_to_the_end, at_last, at_first),
        normal: Vec3::select(falls_to_the_end, out_of_last, out_of_first),
    };
    let between = across(radii, middle, half);
    let is_end = falls_to_the_end | rises_from_the_start;
    Deepest {
        along: S::select(is_end, end.along, between.along),
        distance: S::select(is_end, end.distance, between.distance),
        normal: Vec3::select(is_end, end.normal, between.normal),
    }
}

/// The same if it is no end. The way out is then across the segment: seen along it, the segment is a point and the ellipsoid an
/// ellipse.
#[inline(always)]
fn across<S: Scalar>(radii: [S; 3], middle: Vec3<S>, half: Vec3<S>) -> Deepest<S> {
    let tiny = S::lit(TINY);
    let length_square = half.dot(half).max(tiny);
    let [x, y] = tangents(half.scale(length_square.rsqrt()));
    let stretched = |v: Vec3<S>| Vec3::new(v.x * radii[0].sq(), v.y * radii[1].sq(), v.z * radii[2].sq());
    // The squared support function is a quadratic form; its axes in the plane are those of the ellipse.
    let form = [stretched(x).dot(x), stretched(x).dot(y), stretched(y).dot(y)];
    let ([long, short], ellipse) = ellipse(form, [x, y]);
    let (distance, [along_long, along_short]) = nearest(ellipse, [long.dot(middle), short.dot(middle)]);
    let normal = long.scale(along_long) + short.scale(along_short);
    // The point of the ellipsoid that has this normal is beside the point of the segment that is looked for.
    let outward = stretched(normal);
    let surface = outward.scale(outward.dot(normal).max(tiny).rsqrt());
    let along = ((surface - middle).dot(half) * length_square.recip()).clamp(-1.0, 1.0);
    Deepest { along, distance, normal }
}

/// Directions and lengths of the semi-axes of an ellipse, from its squared support function as a quadratic form of two directions: of the
/// first, both, the second.
#[inline(always)]
pub(super) fn ellipse<S: Scalar>([xx, xy, yy]: [S; 3], [x, y]: [Vec3<S>; 2]) -> ([Vec3<S>; 2], [S; 2]) {
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
    S::repeat_while(MAX_ROUNDS, &mut search, |Shift { above, goes_on }| {
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
        *goes_on
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
            // Unless the segment pierces the middle, which is where its deepest point is as far out on either side.
            let at = |k: u32| nearest(radii, std::array::from_fn(|i| middle[i] + (0.001 * f64::from(k) - 1.0) * half[i])).0;
            let deepest = (0..=2000).map(at).fold(f64::INFINITY, f64::min);
            prop_assume!(found.distance > deepest - 1e-5);
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
