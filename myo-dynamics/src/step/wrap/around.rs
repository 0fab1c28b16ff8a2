//! Around a circle: two tangents and the arc between them.
//!
//! The tangent points are kept as unit vectors from the centre, which stay accurate however near to the circle an end is;
//! the arc is the angle between them.

use super::flat::{Bend, Ends, Flat, TINY};
use myo_scalar::{Scalar, atan2};

/// How much (relative, in units of the precision) the square of a distance may be below that of the radius and still count
/// as on the circle: what rounding leaves of a point that was put there.
const SURFACE: f64 = 256.0;
/// Ends that are closer together (m^2) are straight, as in MuJoCo.
const CLOSEST_SQUARED: f64 = 1e-15;
/// Goodness of a way that is none; the worst that others can have is minus the distance of the side site.
const NO_WAY: f64 = -1e4;

/// A way around the circle: to the left or to the right.
#[derive(Clone, Copy)]
struct Way<S> {
    /// One to the left, minus one to the right.
    turn: S,
    /// Unit vectors to the tangent points.
    feet: [Flat<S>; 2],
    /// Sine and cosine of the arc.
    sin: S,
    cos: S,
}

impl<S: Scalar> Way<S> {
    #[inline(always)]
    fn new(ends: &Ends<S>, inverses: [S; 2], radius: S, turn: S) -> Self {
        let [before, after] = ends.tangents;
        let first = ends.from.left().mul_add(turn * before, ends.from.scale(radius)).scale(inverses[0]);
        let second = ends.to.left().mul_add(-(turn * after), ends.to.scale(radius)).scale(inverses[1]);
        Self { turn, feet: [first, second], sin: turn * first.cross(second), cos: first.dot(second) }
    }

    /// How well the middle of the tangent points suits the side.
    #[inline(always)]
    fn goodness(&self, side: Flat<S>, is_crossed: S::Mask) -> S {
        let [first, second] = self.feet;
        let middle = first.mul_add(S::lit(1.0), second);
        let goodness = side.dot(middle) * middle.dot(middle).max(S::lit(TINY)).rsqrt();
        S::select(is_crossed, S::lit(NO_WAY), goodness)
    }

    /// Where the two tangents cross before they come to the circle.
    #[inline(always)]
    fn is_crossed(&self, ends: &Ends<S>, radius: S) -> S::Mask {
        // Tangents meet at `radius tan(arc / 2)` from where they touch.
        let shorter = ends.tangents[0].min(ends.tangents[1]);
        self.sin.lt(S::lit(-least_angle::<S>())) & (-(radius * self.sin)).le(shorter * (S::lit(1.0) + self.cos))
    }

    #[inline(always)]
    fn select(mask: S::Mask, a: &Self, b: &Self) -> Self {
        Self {
            turn: S::select(mask, a.turn, b.turn),
            feet: [Flat::select(mask, a.feet[0], b.feet[0]), Flat::select(mask, a.feet[1], b.feet[1])],
            sin: S::select(mask, a.sin, b.sin),
            cos: S::select(mask, a.cos, b.cos),
        }
    }

    /// The arc (rad), below a full turn. One that is a rounding below zero stays so: then lengths are continuous where the
    /// path comes off the circle.
    #[inline(always)]
    fn arc(&self) -> S {
        let arc = atan2(self.sin, self.cos);
        let is_far = arc.lt(S::lit(-least_angle::<S>()));
        arc + S::lit(std::f64::consts::TAU).only(is_far)
    }

    #[inline(always)]
    fn bend(&self, ends: &Ends<S>, radius: S, bends: S::Mask) -> Bend<S> {
        let [before, after] = ends.tangents;
        let [first, second] = self.feet;
        Bend {
            bends,
            lengths: [before, radius * self.arc(), after],
            directions: [first.left().scale(self.turn), second.left().scale(self.turn)],
            turn: self.turn,
        }
    }
}

/// What rounding leaves of the angle (rad) of a tangent from a point on the circle.
#[inline(always)]
fn least_angle<S: Scalar>() -> f64 {
    (SURFACE * S::EPSILON).sqrt()
}

#[inline(always)]
fn inverses<S: Scalar>(ends: &Ends<S>) -> [S; 2] {
    [ends.squares[0].max(S::lit(TINY)).recip(), ends.squares[1].max(S::lit(TINY)).recip()]
}

/// Where no end is inside.
#[inline(always)]
fn is_outside<S: Scalar>(ends: &Ends<S>, radius: S) -> S::Mask {
    let bound = radius * radius * S::lit(1.0 - SURFACE * S::EPSILON);
    bound.le(ends.squares[0]) & bound.le(ends.squares[1])
}

/// The shorter way, where the straight line would cut the circle.
#[inline(always)]
pub(super) fn the_shorter_way<S: Scalar>(from: Flat<S>, to: Flat<S>, radius: S) -> Bend<S> {
    let ends = Ends::new(from, to, radius);
    let turn = S::select(from.cross(to).lt(S::zero()), S::lit(-1.0), S::lit(1.0));
    Way::new(&ends, inverses(&ends), radius, turn).bend(&ends, radius, ends.is_cut & is_outside(&ends, radius))
}

/// The way on the side of a point, where the straight line would cut the circle or pass it on the other side.
#[inline(always)]
pub(super) fn the_way_by<S: Scalar>(side: Flat<S>, from: Flat<S>, to: Flat<S>, radius: S) -> Bend<S> {
    let ends = Ends::new(from, to, radius);
    let inverses = inverses(&ends);
    let right = Way::new(&ends, inverses, radius, S::lit(-1.0));
    let left = Way::new(&ends, inverses, radius, S::lit(1.0));
    let (right_crossed, left_crossed) = (right.is_crossed(&ends, radius), left.is_crossed(&ends, radius));
    let is_right = left.goodness(side, left_crossed).lt(right.goodness(side, right_crossed));
    let is_crossed = right_crossed & left_crossed;
    let between = to.minus(from);
    let are_apart = S::lit(CLOSEST_SQUARED).le(between.dot(between));
    let must = ends.is_cut | side.dot(ends.nearest).lt(S::zero());
    let bends = must & is_outside(&ends, radius) & are_apart & !is_crossed;
    Way::select(is_right, &right, &left).bend(&ends, radius, bends)
}
