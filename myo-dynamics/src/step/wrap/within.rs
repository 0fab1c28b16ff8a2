//! Through a circle, touching it: two straight lines that meet at a point of the circle, with equal angles on both sides.
//!
//! With `A = radius / distance` of an end, the line from it meets the circle's radius at an angle psi at an angle
//! `psi - asin(A sin psi)` from the end, seen from the centre. Both such angles add up to the angle between the ends, which
//! is an equation for psi. Its left side is convex and rises, so Halley's method never overshoots from the right, and from the left
//! it lands there or nearer. All that are looked for in a step are looked for together: each waits for itself only.

use super::flat::{Bend, Ends, Flat, TINY, root};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor, atan2};
use std::f64::consts::FRAC_PI_2;

/// Most rounds. Two or three are enough for ends that keep away from the circle, seven for those within a ten-millionth of it.
const MOST_ROUNDS: usize = 16;
/// What may be left of the angle (rad): in units of the precision, and at least.
const LEFT_OVER: (f64, f64) = (4.0, 1e-13);
/// How much more may be left than the cube that tells of it; 11 was the most in two million ways, close to the circle and far.
const DOUBT: f64 = 16.0;
/// Least slope; with both ends on the circle there is none.
const LEAST_SLOPE: f64 = 1e-9;
/// Shortest line (m^2) with a direction.
const SHORTEST_SQUARED: f64 = 1e-20;

/// A rotation of the plane: cosine and sine of its angle.
#[derive(Clone, Copy, Debug)]
struct Turn<S> {
    cos: S,
    sin: S,
}

impl<S: Scalar> Turn<S> {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self {
            cos: self.cos.mul_add(other.cos, -(self.sin * other.sin)),
            sin: self.sin.mul_add(other.cos, self.cos * other.sin),
        }
    }
    #[inline(always)]
    fn back(self) -> Self {
        Self { cos: self.cos, sin: -self.sin }
    }
}

/// An end of the path.
#[derive(Clone, Copy, Debug)]
struct End<S> {
    /// Radius by distance, its square, and what the square lacks of one.
    ratio: S,
    square: S,
    rest: S,
}

impl<S: Scalar> End<S> {
    #[inline(always)]
    fn new(radius: S, inverse: S, tangent: S) -> Self {
        let rest = tangent * inverse;
        Self::of(radius * inverse, rest * rest)
    }

    #[inline(always)]
    fn of(ratio: S, rest: S) -> Self {
        Self { ratio, square: ratio * ratio, rest }
    }

    /// `psi - asin(A sin psi)` as a rotation, and what its subtrahend adds to slope and curvature.
    #[inline(always)]
    fn turn(&self, psi: Turn<S>) -> (Turn<S>, [S; 2]) {
        let square = self.square.mul_add(psi.cos * psi.cos, self.rest).max(S::lit(TINY));
        let inverse = square.rsqrt();
        let less = Turn { cos: square * inverse, sin: self.ratio * psi.sin };
        let slope = self.ratio * inverse * psi.cos;
        let curvature = less.sin * self.rest * (inverse * inverse * inverse);
        (psi.and(less.back()), [slope, curvature])
    }
}

/// A way through a circle, and the angle psi (rad) that is looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap<S: Scalar> {
    ends: [End<S>; 2],
    between: Turn<S>,
    psi: S,
    /// Where it is not good enough.
    goes_on: S::Mask,
}

/// How many numbers a gap is.
pub(super) const GAP: usize = 8;

impl<S: Scalar> Gap<S> {
    /// Between two points.
    #[inline(always)]
    pub(super) fn new(from: Flat<S>, to: Flat<S>, radius: S) -> Self {
        let Sight { ends, between, bends, .. } = Sight::new(from, to, radius);
        // Where the straight line cuts the circle there is no such angle, and no end of rounds.
        Self { ends, between, psi: guess(ends, between), goes_on: bends }
    }

    /// Of none.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self::from_array([S::zero(); GAP])
    }

    /// What was found.
    #[inline(always)]
    pub(super) fn psi(&self) -> S {
        self.psi
    }

    #[inline(always)]
    pub(super) fn array(self) -> [S; GAP] {
        let [first, second] = self.ends;
        let Turn { cos, sin } = self.between;
        [first.ratio, first.rest, second.ratio, second.rest, cos, sin, self.psi, S::indicator(self.goes_on)]
    }

    #[inline(always)]
    pub(super) fn from_array(x: [S; GAP]) -> Self {
        let ends = [End::of(x[0], x[1]), End::of(x[2], x[3])];
        Self { ends, between: Turn { cos: x[4], sin: x[5] }, psi: x[6], goes_on: S::lit(0.5).lt(x[7]) }
    }
}

/// Where to begin: half the angle between the ends would be psi if both were far away, and this is one step nearer, Kepler's equation
/// being what is left of the one to solve then.
#[inline(always)]
fn guess<S: Scalar>(ends: [End<S>; 2], between: Turn<S>) -> S {
    let half = S::lit(0.5);
    let mean = atan2(between.sin, between.cos) * half;
    let square_cos = between.cos.mul_add(half, half).clamp(0.0, 1.0);
    let (sin, cos) = (root(S::lit(1.0) - square_cos), root(square_cos));
    let ratio = (ends[0].ratio + ends[1].ratio) * half;
    let slope = (S::lit(1.0) - ratio * cos).max(S::lit(LEAST_SLOPE));
    (ratio * sin).mul_add(slope.recip(), mean).clamp(0.0, FRAC_PI_2)
}

/// Looks for the angles of all gaps at once.
#[inline(always)]
pub(super) fn settle<S: Scalar>(gaps: &mut [Gap<S>]) {
    S::repeat_while(MOST_ROUNDS, &mut Search(gaps), |Search(gaps)| S::outline(Nearer { gaps }));
}

/// What changes from round to round.
struct Search<'a, S: Scalar>(&'a mut [Gap<S>]);

impl<S: Scalar> Carried<S> for Search<'_, S> {
    #[inline(always)]
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        for gap in &mut *self.0 {
            visitor.number(&mut gap.psi);
            visitor.mask(&mut gap.goes_on);
        }
    }
}

/// A round of the search; tells where it is not over. A stage, since a closure that is not inlined would be compiled without its
/// level's instructions.
struct Nearer<'a, S: Scalar> {
    gaps: &'a mut [Gap<S>],
}

impl<S: Scalar> Stage<S> for Nearer<'_, S> {
    const NAME: &'static str = "way through a circle";
    type Output = S::Mask;
    #[inline(always)]
    fn run(self) -> S::Mask {
        let mut goes_on = S::Mask::splat(false);
        for gap in self.gaps {
            come_nearer(gap);
            goes_on = goes_on | gap.goes_on;
        }
        goes_on
    }
}

/// A step of Halley's method.
#[inline(always)]
fn come_nearer<S: Scalar>(gap: &mut Gap<S>) {
    let left_over = S::lit((LEFT_OVER.0 * S::EPSILON).max(LEFT_OVER.1) / DOUBT);
    let (sin, cos) = gap.psi.sin_cos();
    let (first, [slope_first, curvature_first]) = gap.ends[0].turn(Turn { cos, sin });
    let (second, [slope_second, curvature_second]) = gap.ends[1].turn(Turn { cos, sin });
    let error = first.and(second).and(gap.between.back());
    // The sine, and one beyond a quarter turn: less than the angle, and next to it where it is small.
    let far = S::select(error.sin.lt(S::zero()), S::lit(-1.0), S::lit(1.0));
    let error = S::select(error.cos.lt(S::zero()), far, error.sin);
    let inverse = (S::lit(2.0) - slope_first - slope_second).max(S::lit(LEAST_SLOPE)).recip();
    let straight = error * inverse;
    let bent = straight * inverse * (curvature_first + curvature_second);
    let factor = (S::lit(1.0) - bent * S::lit(0.5)).max(S::lit(0.5)).recip();
    let next = (gap.psi - straight * factor).clamp(0.0, FRAC_PI_2);
    // A lane that has arrived must stay what it is, whatever the others do.
    gap.psi = S::select(gap.goes_on, next, gap.psi);
    // The method is of third order: this much is left after the step.
    gap.goes_on = gap.goes_on & left_over.lt(error.abs() * bent * bent);
}

/// Two points and a circle, seen from its centre.
struct Sight<S: Scalar> {
    ends: [End<S>; 2],
    /// Unit vector to the first point.
    start: Flat<S>,
    /// One where the second point lies to the left of the first, else minus one.
    turn: S,
    /// The angle between them.
    between: Turn<S>,
    /// Where there is a path that touches the circle: the straight line does not cut it, and no end is inside.
    bends: S::Mask,
}

impl<S: Scalar> Sight<S> {
    #[inline(always)]
    fn new(from: Flat<S>, to: Flat<S>, radius: S) -> Self {
        let Ends { squares: [first, second], tangents, is_cut, .. } = Ends::new(from, to, radius);
        let inverses = [first.max(S::lit(TINY)).rsqrt(), second.max(S::lit(TINY)).rsqrt()];
        let [start, end] = [from.scale(inverses[0]), to.scale(inverses[1])];
        let cross = start.cross(end);
        let turn = S::select(cross.lt(S::zero()), S::lit(-1.0), S::lit(1.0));
        let squared_radius = radius * radius;
        Self {
            ends: [End::new(radius, inverses[0], tangents[0]), End::new(radius, inverses[1], tangents[1])],
            start,
            turn,
            between: Turn { cos: start.dot(end), sin: turn * cross },
            bends: squared_radius.lt(first) & squared_radius.lt(second) & !is_cut,
        }
    }
}

/// The path that touches the circle, of which psi was found.
#[inline(always)]
pub(super) fn touching<S: Scalar>(from: Flat<S>, to: Flat<S>, radius: S, psi: S) -> Bend<S> {
    let Sight { ends: [first, _], start, turn, bends, .. } = Sight::new(from, to, radius);
    let (sin, cos) = psi.sin_cos();
    let (from_start, _) = first.turn(Turn { cos, sin });
    let touched = start.left().mul_add(turn * from_start.sin, start.scale(from_start.cos)).scale(radius);
    let (before, leaving) = length_and_direction(touched.minus(from));
    let (after, arriving) = length_and_direction(to.minus(touched));
    Bend { bends, lengths: [before, S::zero(), after], directions: [leaving, arriving], turn }
}

#[inline(always)]
fn length_and_direction<S: Scalar>(along: Flat<S>) -> (S, Flat<S>) {
    let square = along.dot(along).max(S::lit(SHORTEST_SQUARED));
    let inverse = square.rsqrt();
    (square * inverse, along.scale(inverse))
}
