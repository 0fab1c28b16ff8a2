//! A capsule or an ellipsoid beside a cylinder that has ends.
//!
//! Along each direction they are some distance apart, and the greatest of these is their signed distance. Directions in which it can be are
//! those of the ends, those across the axis, and those past the rims between.

mod lying;
mod oval;
mod rod;
mod standing;

pub(super) use oval::oval;
pub(super) use rod::rod;
pub(super) use standing::lowest;

use crate::spatial::Vec3;
use crate::step::ellipsoid::TINY;
use crate::step::support::{Smooth, Support};
use myo_scalar::Scalar;

/// Farther than anything that touches (m).
const FAR: f64 = 1e3;

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
    /// Distance (m), negative inside.
    pub distance: S,
    /// Out of the cylinder.
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

impl<S: Scalar> Cylinder<S> {
    /// The rim of the end that is up, or down.
    #[inline(always)]
    fn rim(&self, up: S) -> Rim<S> {
        Rim { radius: self.radius, end: self.half_length * up }
    }

    /// How far it reaches in a direction.
    #[inline(always)]
    fn support(&self, direction: Vec3<S>) -> Support<S> {
        let up = S::select(direction.z.lt(S::zero()), S::lit(-1.0), S::lit(1.0));
        self.rim(up).support(direction)
    }
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

#[cfg(test)]
mod tests {
    use super::rod::nearest;
    use super::*;
    use crate::step::support::Segment;
    use crate::step::support::tests::{always_the_same, oval as ovals, spiral, vector};
    use proptest::prelude::*;

    fn cylinders() -> impl Strategy<Value = Cylinder<f64>> {
        // With a margin within which everything is.
        (0.02..0.3, 0.02..0.3).prop_map(|(radius, half_length)| Cylinder { radius, half_length, margin: 10.0 })
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
            let found = nearest(&cylinder, &Segment { middle, half }, radius);
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

        #[test]
        fn what_is_within_the_margin_is_where_it_is_with_any_other(
            cylinder in cylinders(), other in ovals(), middle in prop::array::uniform3(-0.4..0.4),
            half in prop::array::uniform3(-0.3..0.3), margin in 0.0..0.05
        ) {
            let (middle, half) = (vector(middle), vector(half));
            let [exact, found] = [10.0, margin].map(|margin| {
                let cylinder = Cylinder { margin, ..cylinder };
                [oval(&cylinder, &other, middle), nearest(&cylinder, &Segment { middle, half }, 0.03)]
            });
            for (exact, found) in exact.into_iter().zip(found) {
                prop_assert_eq!(exact.distance < margin, found.distance < margin);
                prop_assert!(exact.distance >= margin || (exact.distance - found.distance).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_capsule_lies_on_an_end_with_both_its_own() {
        let cylinder = Cylinder { radius: 0.5, half_length: 0.2, margin: 0.002 };
        let lying = |lean: f64, x: f64| {
            let half = Vec3::new(0.1 * (1.0 - lean * lean).sqrt(), 0.0, 0.1 * lean);
            rod(&cylinder, &Segment { middle: Vec3::new(x, 0.0, 0.205), half }, 0.02)
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
