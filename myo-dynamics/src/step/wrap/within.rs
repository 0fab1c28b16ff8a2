//! Through a circle, touching it: two straight lines that meet at a point of the circle, with equal angles on both sides.
//!
//! With `A = radius / distance` of an end, the line from it meets the circle's radius at an angle psi at an angle
//! `psi - asin(A sin psi)` from the end, seen from the centre. Both such angles add up to the angle between the ends, which
//! is an equation for psi. Its left side is convex and rises, so Newton's method never overshoots from the right, and lands there
//! from the left.

use super::flat::{Bend, Ends, Flat, TINY};
use myo_scalar::{Carried, Scalar, Stage, Visitor, atan2};
use std::f64::consts::FRAC_PI_2;

/// Most rounds. The slope halves with each until psi is near; ends within a millionth of the circle take 15.
const MOST_ROUNDS: usize = 24;
/// What may be left of the angle (rad): in units of the precision, and at least.
const LEFT_OVER: (f64, f64) = (4.0, 1e-13);
/// Least slope; with both ends on the circle there is none.
const LEAST_SLOPE: f64 = 1e-9;
/// Shortest line (m^2) with a direction.
const SHORTEST_SQUARED: f64 = 1e-20;

/// A rotation of the plane: cosine and sine of its angle.
#[derive(Clone, Copy)]
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
#[derive(Clone, Copy)]
struct End<S> {
    /// Radius by distance, its square, and what the square lacks of one.
    ratio: S,
    square: S,
    rest: S,
}

impl<S: Scalar> End<S> {
    #[inline(always)]
    fn new(radius: S, inverse: S, tangent: S) -> Self {
        let (ratio, rest) = (radius * inverse, tangent * inverse);
        Self { ratio, square: ratio * ratio, rest: rest * rest }
    }

    /// `psi - asin(A sin psi)` as a rotation, and `cos psi` times the slope of its subtrahend.
    #[inline(always)]
    fn turn(&self, psi: Turn<S>) -> (Turn<S>, S) {
        let square = self.square.mul_add(psi.cos * psi.cos, self.rest).max(S::lit(TINY));
        let inverse = square.rsqrt();
        let less = Turn { cos: square * inverse, sin: self.ratio * psi.sin };
        (psi.and(less.back()), self.ratio * inverse * psi.cos)
    }
}

/// The unknown, and where it is not good enough.
struct Search<S: Scalar> {
    psi: S,
    goes_on: S::Mask,
}

impl<S: Scalar> Carried<S> for Search<S> {
    #[inline(always)]
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.number(&mut self.psi);
        visitor.mask(&mut self.goes_on);
    }
}

/// Where to begin: half the angle between the ends would be psi if both were far away, and this is one step nearer, Kepler's equation
/// being what is left of the one to solve then.
#[inline(always)]
fn guess<S: Scalar>(ends: [End<S>; 2], between: Turn<S>) -> S {
    let half = S::lit(0.5);
    let mean = atan2(between.sin, between.cos) * half;
    let square_cos = between.cos.mul_add(half, half).clamp(0.0, 1.0);
    let (sin, cos) = ((S::lit(1.0) - square_cos).sqrt(), square_cos.sqrt());
    let ratio = (ends[0].ratio + ends[1].ratio) * half;
    let slope = (S::lit(1.0) - ratio * cos).max(S::lit(LEAST_SLOPE));
    (ratio * sin).mul_add(slope.recip(), mean).clamp(0.0, FRAC_PI_2)
}

/// The angle psi (rad) where it is looked for.
#[inline(always)]
fn psi<S: Scalar>(wanted: S::Mask, ends: [End<S>; 2], between: Turn<S>) -> S {
    // Where the straight line cuts the circle there is no such angle, and no end of rounds.
    let mut search = Search { psi: guess(ends, between), goes_on: wanted };
    S::repeat_while(MOST_ROUNDS, &mut search, |search| {
        S::outline(Nearer { ends, between, search });
        search.goes_on
    });
    search.psi
}

/// A round of the search. A stage, since a closure that is not inlined would be compiled without its level's instructions.
struct Nearer<'a, S: Scalar> {
    ends: [End<S>; 2],
    between: Turn<S>,
    search: &'a mut Search<S>,
}

impl<S: Scalar> Stage<S> for Nearer<'_, S> {
    const NAME: &'static str = "way through a circle";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { ends, between, search } = self;
        let left_over = S::lit((LEFT_OVER.0 * S::EPSILON).max(LEFT_OVER.1));
        let (sin, cos) = search.psi.sin_cos();
        let (first, slope_first) = ends[0].turn(Turn { cos, sin });
        let (second, slope_second) = ends[1].turn(Turn { cos, sin });
        let error = first.and(second).and(between.back());
        // The sine, and one beyond a quarter turn: less than the angle, and next to it where it is small.
        let far = S::select(error.sin.lt(S::zero()), S::lit(-1.0), S::lit(1.0));
        let error = S::select(error.cos.lt(S::zero()), far, error.sin);
        let slope = (S::lit(2.0) - slope_first - slope_second).max(S::lit(LEAST_SLOPE));
        let next = (search.psi - error * slope.recip()).clamp(0.0, FRAC_PI_2);
        // A lane that has arrived must stay what it is, whatever the others do.
        search.goes_on = search.goes_on & left_over.lt(error.abs());
        search.psi = S::select(search.goes_on, next, search.psi);
    }
}

/// The path that touches the circle, where the straight line does not cut it and no end is inside.
#[inline(always)]
pub(super) fn touching<S: Scalar>(from: Flat<S>, to: Flat<S>, radius: S) -> Bend<S> {
    let ends = Ends::new(from, to, radius);
    let [first, second] = ends.squares;
    let inverses = [first.max(S::lit(TINY)).rsqrt(), second.max(S::lit(TINY)).rsqrt()];
    let [start, end] = [from.scale(inverses[0]), to.scale(inverses[1])];
    let cross = start.cross(end);
    let turn = S::select(cross.lt(S::zero()), S::lit(-1.0), S::lit(1.0));
    let between = Turn { cos: start.dot(end), sin: turn * cross };
    let first_end = End::new(radius, inverses[0], ends.tangents[0]);
    let second_end = End::new(radius, inverses[1], ends.tangents[1]);
    let squared_radius = radius * radius;
    let bends = squared_radius.lt(first) & squared_radius.lt(second) & !ends.is_cut;
    let (sin, cos) = psi(bends, [first_end, second_end], between).sin_cos();
    let (from_start, _) = first_end.turn(Turn { cos, sin });
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
