//! Where a capsule touches a box.
//!
//! The point of the axis that is nearest to the box is at one of its ends, over a face, or where it passes an edge. From there the axis may run along the
//! face or the edge; then there is a second contact as far along as both of them go.
//!
//! An axis that goes through the box is taken as if it did not, as MuJoCo does: an end of it over a face, or a point near an edge. It passes over edges that are exactly
//! parallel to the axis, which are looked at here.

use super::Cuboid;
use crate::spatial::Vec3;
use crate::step::support::{Apart, Segment};
use myo_scalar::{Mask, Scalar};

/// Farther than anything that touches (m), and its square.
const FAR: f64 = 1e3;
/// By how much (m^2) an edge has to be nearer than what was found before it: MuJoCo's.
const NEARER: f64 = 1e-15;
/// Below this a share of the axis is none; in reach of single precision.
const NONE: f64 = 1e-30;
/// Share of its greatest value below which the square of the sine between axis and edge is lost in rounding, in units of it.
const PARALLEL: f64 = 1.0;
/// Square of the cosine between the axis and an edge from which on it runs along the edge and not along a face.
const ALONG: f64 = 0.5;

/// The two points in which a capsule touches, of which the second may be far away; from the capsule to the box.
#[inline(always)]
pub(in crate::step) fn rod<S: Scalar>(cuboid: &Cuboid<S>, axis: &Segment<S>, radius: S) -> [Apart<S>; 2] {
    let nearest = Nearest::of(cuboid, axis);
    let (exists, along) = nearest.second(cuboid, axis);
    let touch = |share: S| cuboid.ball(axis.half.mul_add(share, axis.middle), radius);
    let [first, mut second] = [nearest.share, nearest.share + along].map(touch);
    second.distance = S::select(exists, second.distance, S::lit(FAR));
    [first, second]
}

/// What of an axis is nearest to a box.
#[derive(Clone, Copy)]
struct Nearest<S: Scalar> {
    /// Square of the distance (m^2).
    square: S,
    /// Where on the axis: from -1 to 1.
    share: S,
    /// Whether it is an end over a face, and which axis of the box that stands across; none of an end within the box.
    is_over_face: S::Mask,
    face: [S::Mask; 3],
    /// Else, the edge along which axis of the box, and where on it: from -1 to 1.
    edge: [S::Mask; 3],
    place: S,
    /// Whether that is between its corners.
    is_between: S::Mask,
    /// Which corner it is otherwise; of an edge the ends of which do not count the lower one.
    corner: [S; 3],
}

impl<S: Scalar> Nearest<S> {
    #[inline(always)]
    fn of(cuboid: &Cuboid<S>, axis: &Segment<S>) -> Self {
        let (no, o) = (S::Mask::splat(false), S::zero());
        let mut nearest = Self {
            square: S::lit(FAR * FAR),
            share: o,
            is_over_face: no,
            face: [no; 3],
            edge: [no; 3],
            place: o,
            is_between: no,
            corner: [o; 3],
        };
        for share in [-1.0, 1.0] {
            nearest.look_at_end(cuboid, axis, S::lit(share));
        }
        for along in 0..3 {
            for signs in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
                nearest.look_at_edge(cuboid, axis, along, signs);
            }
        }
        nearest
    }

    /// An end counts where it is within the box along two of its axes.
    #[inline(always)]
    fn look_at_end(&mut self, cuboid: &Cuboid<S>, axis: &Segment<S>, share: S) {
        let beyond = cuboid.beyond(axis.half.mul_add(share, axis.middle));
        let [x, y, z] = beyond.array().map(|x| S::zero().lt(x.abs()));
        let is_over = !((x & y) | (y & z) | (z & x));
        let square = beyond.dot(beyond);
        let is_nearer = is_over & square.lt(self.square);
        self.square = S::select(is_nearer, square, self.square);
        self.share = S::select(is_nearer, share, self.share);
        self.is_over_face = self.is_over_face | is_nearer;
        for (face, is_beyond) in self.face.iter_mut().zip([x, y, z]) {
            *face = choose::<S>(is_nearer, is_beyond, *face);
        }
    }

    /// The point of an edge and that of the axis that are nearest to each other.
    #[inline(always)]
    fn look_at_edge(&mut self, cuboid: &Cuboid<S>, axis: &Segment<S>, along: usize, signs: [f64; 2]) {
        let half = cuboid.half_size[along];
        let others = [0, 1, 2].map(|k| k != along);
        let mut signs = signs.into_iter();
        let signs = others.map(|is_other| if is_other { signs.next().unwrap_or(0.0) } else { 0.0 });
        let corner = [0, 1, 2].map(|k| cuboid.half_size[k] * S::lit(signs[k]));
        let between = Vec3::new(corner[0], corner[1], corner[2]) - axis.middle;
        let (square, cross, axis_square) = (half * half, -half * axis.half.array()[along], axis.half.dot(axis.half));
        let (towards, axis_towards) = (-half * between.array()[along], axis.half.dot(between));
        let determinant = square.mul_add(axis_square, -(cross * cross));
        let crosses = (square * axis_square * S::lit(PARALLEL * S::EPSILON)).lt(determinant);
        let safe = S::select(crosses, determinant, S::lit(1.0));
        let free = (axis_square * towards - cross * axis_towards) * safe.recip();
        let place = free.only(crosses).clamp(-1.0, 1.0);
        let share = ((axis_towards - cross * place) * axis_square.max(S::lit(NONE)).recip()).clamp(-1.0, 1.0);
        let free = (towards - cross * share) * square.max(S::lit(NONE)).recip();
        let place = free.clamp(-1.0, 1.0);
        let on_edge = half * place;
        let point = [0, 1, 2].map(|k| if k == along { between.array()[k] + on_edge } else { between.array()[k] });
        let apart = Vec3::new(point[0], point[1], point[2]) - axis.half.scale(share);
        let square = apart.dot(apart);
        let is_nearer = square.lt(self.square - S::lit(NEARER));
        self.square = S::select(is_nearer, square, self.square);
        self.share = S::select(is_nearer, share, self.share);
        self.is_over_face = self.is_over_face & !is_nearer;
        self.place = S::select(is_nearer, place, self.place);
        let (is_above, is_below) = (S::lit(1.0).lt(free), free.lt(S::lit(-1.0)));
        self.is_between = choose::<S>(is_nearer, !(is_above | is_below), self.is_between);
        let end = S::select(is_above, S::lit(1.0), S::lit(-1.0));
        for (k, sign) in signs.into_iter().enumerate() {
            let sign = if k == along { end } else { S::lit(sign) };
            self.corner[k] = S::select(is_nearer, sign, self.corner[k]);
            self.edge[k] = choose::<S>(is_nearer, S::Mask::splat(k == along), self.edge[k]);
        }
    }

    /// Whether there is a second contact, and how far along the axis from the first.
    #[inline(always)]
    fn second(&self, cuboid: &Cuboid<S>, axis: &Segment<S>) -> (S::Mask, S) {
        let lean = Lean::of(axis, self.corner);
        let over_face = self.past_face(cuboid, axis);
        let [past_corner, past_edge] = [self.past_corner(cuboid, axis, &lean), self.past_edge(cuboid, axis, &lean)];
        let pick =
            |mask: S::Mask, a: (S::Mask, S), b: (S::Mask, S)| (choose::<S>(mask, a.0, b.0), S::select(mask, a.1, b.1));
        pick(self.is_over_face, over_face, pick(self.is_between, past_edge, past_corner))
    }

    /// From an end over a face to where the axis leaves what is over it.
    #[inline(always)]
    fn past_face(&self, cuboid: &Cuboid<S>, axis: &Segment<S>) -> (S::Mask, S) {
        let [x, y, z] = self.face;
        let (end, o) = (axis.half.mul_add(self.share, axis.middle).array(), S::zero());
        let mut length = S::lit(2.0);
        for (k, (end, half)) in end.into_iter().zip(axis.half.array()).enumerate() {
            let ahead = -self.share * half;
            let inverse = inverse_of(ahead.abs());
            let ahead = S::select(ahead.lt(o), -inverse, inverse);
            for side in [cuboid.half_size[k], -cuboid.half_size[k]] {
                let until = (side - end) * ahead;
                let counts = o.lt(until) & until.lt(length) & !self.face[k];
                length = S::select(counts, until, length);
            }
        }
        (x | y | z, -self.share * length)
    }

    /// From a corner along the edge that the axis runs along, or along the face that it is over.
    #[inline(always)]
    fn past_corner(&self, cuboid: &Cuboid<S>, axis: &Segment<S>, lean: &Lean<S>) -> (S::Mask, S) {
        let [x, y, z] = lean.is_odd;
        let one = S::lit(1.0);
        let of_odd = |values: [S; 3]| S::select(x, values[0], S::select(y, values[1], values[2]));
        let toward = S::select((x & lean.leaves[0]) | (y & lean.leaves[1]) | (z & lean.leaves[2]), one, -one);
        let halves = axis.half.array();
        let runs = of_odd(halves.map(|half| half * half));
        let is_along = (axis.half.dot(axis.half) * S::lit(ALONG)).lt(runs);
        let lengths = lean.lengths(cuboid);
        let along_edge = (one - toward * self.share).min(of_odd(lengths));
        let [a, b, c] = lengths;
        let along_face = (one + toward * self.share).min(of_odd([b.min(c), c.min(a), a.min(b)]));
        (x | y | z, toward * S::select(is_along, along_edge, -along_face))
    }

    /// From an edge over the face that the axis leans to less.
    #[inline(always)]
    fn past_edge(&self, cuboid: &Cuboid<S>, axis: &Segment<S>, lean: &Lean<S>) -> (S::Mask, S) {
        let (no, one) = (S::Mask::splat(false), S::lit(1.0));
        let lengths = lean.lengths(cuboid);
        let halves = axis.half.array();
        let (mut exists, mut along) = (no, S::zero());
        for (k, [a, b]) in [[1, 2], [2, 0], [0, 1]].into_iter().enumerate() {
            let [first, second] = [lean.leaves[a], lean.leaves[b]];
            let is_first = halves[b].abs().lt(halves[a].abs());
            let leaves = choose::<S>(is_first, first, second);
            let toward = S::select(leaves, one, -one);
            let across = S::select(is_first, lengths[a], lengths[b]);
            let agrees = !differ::<S>(S::zero().lt(halves[k]), leaves);
            let left = S::select(agrees, one - self.place, one + self.place);
            let edge = lengths[k] * left * S::lit(0.5);
            let length = (one - toward * self.share).min(across).min(edge);
            exists = choose::<S>(self.edge[k], differ::<S>(first, second), exists);
            along = S::select(self.edge[k], toward * length, along);
        }
        (exists, along)
    }
}

/// How an axis lies at a corner.
struct Lean<S: Scalar> {
    /// Of each axis of the box whether the capsule's, which way it points, is not turned as the corner lies.
    leaves: [S::Mask; 3],
    /// The one for which this is otherwise than for the two others, if any.
    is_odd: [S::Mask; 3],
    /// One over how far half of the axis goes along each.
    inverse: [S; 3],
}

impl<S: Scalar> Lean<S> {
    #[inline(always)]
    fn of(axis: &Segment<S>, corner: [S; 3]) -> Self {
        let halves = axis.half.array();
        let leaves = [0, 1, 2].map(|k| differ::<S>(S::zero().lt(halves[k]), S::zero().lt(corner[k])));
        let is_odd = [0, 1, 2]
            .map(|k| differ::<S>(leaves[k], leaves[(k + 1) % 3]) & differ::<S>(leaves[k], leaves[(k + 2) % 3]));
        Self { leaves, is_odd, inverse: halves.map(|half| inverse_of(half.abs())) }
    }

    /// How much of half the axis goes along a whole side of the box.
    #[inline(always)]
    fn lengths(&self, cuboid: &Cuboid<S>) -> [S; 3] {
        [0, 1, 2].map(|k| cuboid.half_size[k] * self.inverse[k] * S::lit(2.0))
    }
}

/// One over what is not negative, or something great.
#[inline(always)]
fn inverse_of<S: Scalar>(x: S) -> S {
    x.max(S::lit(NONE)).recip()
}

#[inline(always)]
fn choose<S: Scalar>(mask: S::Mask, a: S::Mask, b: S::Mask) -> S::Mask {
    (mask & a) | (!mask & b)
}

#[inline(always)]
fn differ<S: Scalar>(a: S::Mask, b: S::Mask) -> S::Mask {
    (a & !b) | (!a & b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The next of numbers between -1 and 1 that go round.
    fn draws() -> impl FnMut() -> f64 {
        let mut at: f64 = 0.3;
        move || {
            at = (at * 997.13 + 0.618).fract();
            2.0 * at - 1.0
        }
    }

    #[test]
    fn the_nearest_point_of_an_axis_is_the_nearest_of_all() {
        let mut next = draws();
        let (mut touching, mut twice) = (0, 0);
        for case in 0..3000 {
            let cuboid = Cuboid { half_size: [0, 1, 2].map(|_| 0.11 + 0.09 * next()) };
            let mut vector = |length: f64| Vec3::new(length * next(), length * next(), length * next());
            let axis = Segment { middle: vector(0.4), half: vector(0.15) };
            let distance = |share: f64| cuboid.square_outside(axis.half.mul_add(share, axis.middle)).sqrt();
            let nearest = (0..=4000).map(|k| distance(f64::from(k) / 2000.0 - 1.0)).fold(f64::INFINITY, f64::min);
            let [first, second] = rod(&cuboid, &axis, 0.03);
            // Of an axis that goes through the box it is another point.
            if nearest == 0.0 {
                continue;
            }
            touching += 1;
            assert!((first.distance + 0.03 - nearest).abs() < 1e-6, "{case}: {} and {nearest}", first.distance);
            twice += u32::from(second.distance < FAR);
            assert!(second.distance >= first.distance - 1e-12, "{case}: {} and {}", first.distance, second.distance);
        }
        assert!(touching > 1000 && twice > 300, "{touching} {twice}");
    }

    /// MuJoCo passes over such edges.
    #[test]
    fn a_capsule_along_an_edge_touches_it() {
        let cuboid = Cuboid { half_size: [0.3, 0.2, 0.1] };
        for half in [Vec3::new(0.1, 0.0, 0.0), Vec3::new(-0.1, 1e-9, 0.0)] {
            let axis = Segment { middle: Vec3::new(0.05, 0.22, 0.12), half };
            let [first, _] = rod::<f64>(&cuboid, &axis, 0.03);
            assert!((first.distance - (0.02f64.hypot(0.02) - 0.03)).abs() < 1e-8, "{}", first.distance);
        }
    }
}
