//! Whether parts are apart, of which one is a convex mesh: along a direction that is remembered, all lanes at once.
//!
//! What is apart along any direction needs no closer look; so what is remembered, perhaps of another body, counts for nothing but time. A closer look tells the best one.

use crate::mesh::Hull;
use crate::plan::{ContactPair, PartForm, Plan};
use crate::spatial::{Frame, Vec3};
use myo_scalar::Scalar;

/// What rounding may add to a gap, in units of it for lengths like those of the parts.
const ROUNDINGS: f64 = 64.0;
/// A direction is remembered if the square of its length is so near to one; other numbers are none.
const NEAR_ONE: [f64; 2] = [0.5, 2.0];
/// The least square of a length that tells a direction (m^2).
const TINY: f64 = 1e-20;

/// A mesh and what it may touch, in the frame of this.
pub(super) struct Two<'a, S: Scalar> {
    pub plan: &'a Plan<S::Const>,
    pub pair: &'a ContactPair<S::Const>,
    pub hull: &'a Hull,
    pub place: Frame<S>,
}

impl<S: Scalar> Two<'_, S> {
    /// Where they are apart by more than the margin along a direction from the first to the second, or, where there is none, along that to the middle of the second.
    /// Where they are near, it becomes the one that was tried.
    #[inline(always)]
    pub fn are_apart(&self, near: S::Mask, towards: &mut Vec3<S>) -> S::Mask {
        let (square, [least, most]) = (towards.dot(*towards), NEAR_ONE.map(S::lit));
        let is_known = least.lt(square) & square.lt(most);
        let tried = match self.pair.parts[0].form {
            PartForm::Plane => Vec3::new(S::zero(), S::zero(), S::lit(1.0)),
            _ => Vec3::select(is_known, *towards, unit(self.place.position)),
        };
        *towards = Vec3::select(near, tried, *towards);
        (S::splat(self.pair.margin) + self.slack()).lt(self.gap(tried))
    }

    /// What rounding may add to a gap (m), that of corners to single precision included.
    #[inline(always)]
    fn slack(&self) -> S {
        let Vec3 { x, y, z } = self.place.position;
        let size = x.abs() + y.abs() + z.abs() + S::lit(2.0 * self.hull.reach());
        let first = match self.pair.parts[0].form {
            PartForm::Mesh(first) => self.plan.hulls[first].reach(),
            _ => 0.0,
        };
        let corners = (self.hull.reach() + first) * f64::from(f32::EPSILON);
        size.mul_add(S::lit(ROUNDINGS * S::EPSILON), S::lit(corners))
    }

    /// How far they are apart along a direction (m).
    #[inline(always)]
    fn gap(&self, direction: Vec3<S>) -> S {
        let back = self.place.rotation.apply_inverse(-direction);
        self.place.position.dot(direction) - height(self.hull, back) - self.first_height(direction)
    }

    /// How far the first reaches in a direction (m).
    #[inline(always)]
    fn first_height(&self, Vec3 { x, y, z }: Vec3<S>) -> S {
        match self.pair.parts[0].form {
            PartForm::Plane => S::zero(),
            PartForm::Cylinder { radius, half_length } => {
                length(Vec3::new(x, y, S::zero())).mul_add(S::splat(radius), z.abs() * S::splat(half_length))
            }
            PartForm::Ellipsoid { radii: [a, b, c] } => {
                length(Vec3::new(x * S::splat(a), y * S::splat(b), z * S::splat(c)))
            }
            PartForm::Capsule { radius, half_length } => z.abs() * S::splat(half_length) + S::splat(radius),
            PartForm::Mesh(first) => height(&self.plan.hulls[first], Vec3::new(x, y, z)),
            PartForm::Box { .. } => unreachable!("beside a mesh a box is one, too"),
        }
    }
}

/// A vector at length one; shorter if it has hardly any.
#[inline(always)]
fn unit<S: Scalar>(vector: Vec3<S>) -> Vec3<S> {
    vector.scale(vector.dot(vector).max(S::lit(TINY)).rsqrt())
}

/// The length of a vector that has one.
#[inline(always)]
fn length<S: Scalar>(vector: Vec3<S>) -> S {
    let square = vector.dot(vector).max(S::lit(TINY));
    square * square.rsqrt()
}

/// How far a hull reaches in a direction of its frame (m).
#[inline(always)]
fn height<S: Scalar>(hull: &Hull, direction: Vec3<S>) -> S {
    let low = S::lit(f64::from(f32::MIN));
    // Two at a time, because each waits for the one before.
    let (mut greatest, mut other_greatest) = (low, low);
    let (pairs, rest) = hull.corners().as_chunks::<2>();
    for [one, other] in pairs {
        greatest = greatest.max(along(one, direction));
        other_greatest = other_greatest.max(along(other, direction));
    }
    for one in rest {
        greatest = greatest.max(along(one, direction));
    }
    greatest.max(other_greatest)
}

#[inline(always)]
fn along<S: Scalar>(&[x, y, z]: &[f32; 3], direction: Vec3<S>) -> S {
    Vec3::new(S::lit(f64::from(x)), S::lit(f64::from(y)), S::lit(f64::from(z))).dot(direction)
}
