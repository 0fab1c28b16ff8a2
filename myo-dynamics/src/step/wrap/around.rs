//! Around a circle: two tangents and the arc between them.
//!
//! The tangent points are kept as unit vectors from the centre, which stay accurate however near to the circle an end is;
//! the arc is the angle between them.

use super::flat::{Bend, Ends, Flat, TINY};
use myo_model::description::SideRule;
use myo_scalar::{Mask, Scalar, Stage, atan2};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_8, TAU};

/// How much (relative, in units of the precision) the square of a distance may be below that of the radius and still count
/// as on the circle: what rounding leaves of a point that was put there.
const SURFACE: f64 = 256.0;

/// What is as good as nothing in MuJoCo (m^2).
const NOTHING: f64 = 1e-15;

/// The path around a circle. Without a side it takes the shorter way, and only where the straight line would cut the circle.
/// With one it takes that which the rule tells.
#[inline(always)]
pub(super) fn around<S: Scalar>(
    side: Option<Flat<S>>,
    rule: SideRule,
    from: Flat<S>,
    to: Flat<S>,
    radius: S,
) -> Bend<S> {
    let ends = Ends::new(from, to, radius);
    let short = S::select(from.cross(to).lt(S::zero()), S::lit(-1.0), S::lit(1.0));
    let Told { is_long, winds, bends } = match (side, rule) {
        (None, _) => Told { is_long: S::Mask::splat(false), winds: None, bends: ends.is_cut },
        (Some(side), SideRule::Mujoco4) => by_winding(&ends, side, short),
        (Some(side), SideRule::Mujoco3) => S::outline(ByHalfPlane { ends: &ends, side, short, radius }),
    };
    let turn = S::select(is_long, -short, short);
    let [before, after] = ends.tangents;
    let (first, second) = feet(&ends, radius, turn);
    let seam = seam(is_long, (before + after).lt(radius));
    let seam = if let Some(winds) = winds { S::select(winds, S::zero(), seam) } else { seam };
    let arc = arc(seam, turn * first.cross(second), first.dot(second));
    Bend {
        bends: bends & is_outside(&ends, radius),
        lengths: [before, radius * arc, after],
        directions: [first.left().scale(turn), second.left().scale(turn)],
        turn,
    }
}

/// What a side tells.
struct Told<M> {
    /// Whether the longer way is taken.
    is_long: M,
    /// Where the other one is taken and goes all round besides.
    winds: Option<M>,
    /// Whether the path bends at all.
    bends: M,
}

/// As in MuJoCo since 4.0: it goes round as the line from its first end by the side to its last end does.
#[inline(always)]
fn by_winding<S: Scalar>(ends: &Ends<S>, side: Flat<S>, short: S) -> Told<S::Mask> {
    // That line never crosses the ray opposite the side. If this ray is on the shorter way, the line takes the longer one.
    let is_long = S::zero().lt(short * side.cross(ends.from)) & S::zero().lt(short * ends.to.cross(side));
    Told { is_long, winds: None, bends: ends.is_cut | is_long }
}

/// The rule before 4.0, as a stage: who goes by the other must not pay for the size of this one.
struct ByHalfPlane<'a, S: Scalar> {
    ends: &'a Ends<S>,
    side: Flat<S>,
    short: S,
    radius: S,
}

impl<S: Scalar> Stage<S> for ByHalfPlane<'_, S> {
    const NAME: &'static str = "way by a half-plane";
    type Output = Told<S::Mask>;
    #[inline(always)]
    fn run(self) -> Self::Output {
        by_half_plane(self.ends, self.side, self.short, self.radius)
    }
}

/// As in MuJoCo before 4.0: it bends where the straight line cuts the circle, and also where it comes nearest on the half-plane away from
/// the side. It takes the way whose feet are nearer to the side, if its tangents do not cross. Where the line is clear of the circle and the
/// tangents of the shorter way do not cross all the same, that goes all round.
#[inline(always)]
fn by_half_plane<S: Scalar>(ends: &Ends<S>, side: Flat<S>, short: S, radius: S) -> Told<S::Mask> {
    let between = ends.to.minus(ends.from);
    let square = between.dot(between);
    let share = (-between.dot(ends.from) * square.max(S::lit(TINY)).recip()).clamp(0.0, 1.0);
    let nearest = between.mul_add(share, ends.from);
    let is_clear = (radius * radius).lt(nearest.dot(nearest));
    let is_apart = S::lit(NOTHING).le(square);
    let feet_of_short = feet(ends, radius, short);
    let is_farther = closeness(feet_of_short, side).lt(closeness(feet(ends, radius, -short), side));
    // Where the line cuts the circle they do not cross but by rounding, and those of the longer way never do.
    let crosses = is_clear & do_cross(ends, feet_of_short, radius);
    // Paths without a side are among those with one: theirs is in the middle.
    let tells = S::lit(TINY).lt(side.dot(side));
    let is_long = tells & (is_farther | crosses);
    let bends = is_apart & (!is_clear | side.dot(nearest).lt(S::zero()));
    Told { is_long, winds: Some(tells & is_clear & !is_long), bends: (tells & bends) | (!tells & ends.is_cut) }
}

/// Cosine between a side and the middle of the feet of a way around, times what is the same for all ways.
#[inline(always)]
fn closeness<S: Scalar>((first, second): (Flat<S>, Flat<S>), side: Flat<S>) -> S {
    let middle = second.mul_add(S::lit(1.0), first);
    middle.dot(side) * middle.dot(middle).max(S::lit(TINY)).rsqrt()
}

/// Whether the tangents from both ends to their feet cross.
#[inline(always)]
fn do_cross<S: Scalar>(ends: &Ends<S>, (first, second): (Flat<S>, Flat<S>), radius: S) -> S::Mask {
    let (before, after) = (first.scale(radius).minus(ends.from), second.scale(radius).minus(ends.to));
    let between = ends.from.minus(ends.to);
    let determinant = before.cross(after);
    let size = determinant.abs();
    let sign = S::select(determinant.lt(S::zero()), S::lit(-1.0), S::lit(1.0));
    let [a, b] = [sign * after.cross(between), sign * before.cross(between)];
    let is_on_both = S::zero().le(a) & a.le(size) & S::zero().le(b) & b.le(size);
    S::lit(NOTHING).le(size) & is_on_both
}

/// Where no end is inside.
#[inline(always)]
fn is_outside<S: Scalar>(ends: &Ends<S>, radius: S) -> S::Mask {
    let bound = radius * radius * S::lit(1.0 - SURFACE * S::EPSILON);
    bound.le(ends.squares[0]) & bound.le(ends.squares[1])
}

/// Unit vectors from the centre to the tangent points.
#[inline(always)]
fn feet<S: Scalar>(ends: &Ends<S>, radius: S, turn: S) -> (Flat<S>, Flat<S>) {
    let [before, after] = ends.tangents;
    let first = ends.from.left().mul_add(turn * before, ends.from.scale(radius));
    let second = ends.to.left().mul_add(-(turn * after), ends.to.scale(radius));
    let inverse = |square: S| square.max(S::lit(TINY)).recip();
    (first.scale(inverse(ends.squares[0])), second.scale(inverse(ends.squares[1])))
}

/// The least arc (rad) that there is. A shorter way is at most half a turn and at least a rounding below none, which it keeps, so that
/// lengths are continuous where it comes off the circle. A longer one ends near a full turn if both ends are close, and else before the last
/// eighth of it.
#[inline(always)]
fn seam<S: Scalar>(is_long: S::Mask, are_close: S::Mask) -> S {
    let seam = S::select(are_close, S::lit(FRAC_PI_2), S::lit(-FRAC_PI_8));
    S::select(is_long, seam, S::lit(-FRAC_PI_2))
}

/// The arc (rad) of this sine and cosine, from the seam to a full turn more.
#[inline(always)]
fn arc<S: Scalar>(seam: S, sin: S, cos: S) -> S {
    let arc = atan2(sin, cos);
    arc + S::lit(TAU).only(arc.lt(seam))
}
