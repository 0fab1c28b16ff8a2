//! Vectors in the plane in which a path bends.

use myo_scalar::{Mask, Scalar};

/// A vector in the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat<S> {
    pub x: S,
    pub y: S,
}

impl<S: Scalar> Flat<S> {
    #[inline(always)]
    pub fn new(x: S, y: S) -> Self {
        Self { x, y }
    }
    #[inline(always)]
    pub fn scale(self, by: S) -> Self {
        Self::new(self.x * by, self.y * by)
    }
    /// `self * by + other`.
    #[inline(always)]
    pub fn mul_add(self, by: S, other: Self) -> Self {
        Self::new(self.x.mul_add(by, other.x), self.y.mul_add(by, other.y))
    }
    #[inline(always)]
    pub fn minus(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
    #[inline(always)]
    pub fn dot(self, other: Self) -> S {
        self.x.mul_add(other.x, self.y * other.y)
    }
    /// Positive where the other one lies to the left.
    #[inline(always)]
    pub fn cross(self, other: Self) -> S {
        self.x.mul_add(other.y, -(self.y * other.x))
    }
    /// Turned by a quarter to the left.
    #[inline(always)]
    pub fn left(self) -> Self {
        Self::new(-self.y, self.x)
    }
    #[inline(always)]
    pub fn select(mask: S::Mask, a: Self, b: Self) -> Self {
        Self::new(S::select(mask, a.x, b.x), S::select(mask, a.y, b.y))
    }
}

/// Two points, a circle about the origin, and the straight line between the points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends<S: Scalar> {
    pub from: Flat<S>,
    pub to: Flat<S>,
    /// Squared distances from the centre (m^2).
    pub squares: [S; 2],
    /// Lengths of the tangents to the circle (m); zero from inside.
    pub tangents: [S; 2],
    /// Where the straight line cuts the circle between the ends.
    pub is_cut: S::Mask,
}

/// Keeps reciprocals finite (m^2).
pub(super) const TINY: f64 = 1e-30;

/// Square root; a tiny one of nothing, and of less. Reciprocal roots are what processors are fast at.
#[inline(always)]
pub(super) fn root<S: Scalar>(x: S) -> S {
    let x = x.max(S::lit(TINY));
    x * x.rsqrt()
}

impl<S: Scalar> Ends<S> {
    #[inline(always)]
    pub fn new(from: Flat<S>, to: Flat<S>, radius: S) -> Self {
        let squared_radius = radius * radius;
        let squares = [from.dot(from), to.dot(to)];
        let [first, second] = squares;
        let tangents = [root(first - squared_radius), root(second - squared_radius)];
        let between = to.minus(from);
        let is_between = between.dot(from).lt(S::zero()) & S::zero().lt(between.dot(to));
        // The area that both ends span with the centre is the distance of the line times that between them.
        let area = from.cross(to);
        let is_cut = is_between & (area * area).le(squared_radius * between.dot(between));
        Self { from, to, squares, tangents, is_cut }
    }
}

/// How a path gets past a circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend<S: Scalar> {
    /// Where it touches the circle at all; elsewhere it is straight, and the rest says nothing.
    pub bends: S::Mask,
    /// Its lengths before, along and after the circle (m). The middle one may be a rounding below zero.
    pub lengths: [S; 3],
    /// Unit vectors along the path at its ends.
    pub directions: [Flat<S>; 2],
    /// One where it turns to the left, minus one where it turns to the right.
    pub turn: S,
}

impl<S: Scalar> Bend<S> {
    /// It does not.
    #[inline(always)]
    pub fn straight() -> Self {
        let (o, zero) = (S::zero(), Flat::new(S::zero(), S::zero()));
        Self { bends: S::Mask::splat(false), lengths: [o; 3], directions: [zero; 2], turn: o }
    }

    #[inline(always)]
    pub fn select(mask: S::Mask, a: &Self, b: &Self) -> Self {
        let length = |k: usize| S::select(mask, a.lengths[k], b.lengths[k]);
        Self {
            bends: (mask & a.bends) | (!mask & b.bends),
            lengths: [length(0), length(1), length(2)],
            directions: [
                Flat::select(mask, a.directions[0], b.directions[0]),
                Flat::select(mask, a.directions[1], b.directions[1]),
            ],
            turn: S::select(mask, a.turn, b.turn),
        }
    }
}
