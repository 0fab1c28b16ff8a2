//! From space to the plane in which a path bends, and back.
//!
//! Over a sphere that is the plane through the centre and both ends. Over a cylinder it is the plane across its axis, and
//! along the axis the path climbs evenly: on the cylinder rolled out flat it is a straight line.

use super::around::around;
use super::flat::{Bend, Flat};
use super::within::{Gap, settle, touching};
use crate::plan::RoundShape;
use crate::spatial::{Frame, Vec3};
use myo_model::description::SideRule;
use myo_scalar::{Mask, Scalar};

/// Shorter lines have no direction to speak of (m^2); keeps the reciprocal root finite.
const SHORTEST_SQUARED: f64 = 1e-20;
/// Sine of the angle between two directions, in units of the precision, below which rounding is all that their vector
/// product holds; and the product (m^4, squared) below which MuJoCo takes them for parallel.
const PARALLEL: (f64, f64) = (8.0, 1e-30);

/// What a path may run over. All positions are from O in world axes.
#[derive(Clone, Copy, Debug)]
pub struct Round<S> {
    /// Its kind.
    pub shape: RoundShape,
    /// How a side tells the way around it.
    pub rule: SideRule,
    /// Its radius (m).
    pub radius: S,
    /// Its centre, and its axes: z is that of a cylinder.
    pub frame: Frame<S>,
}

/// The side on which a path is to run.
#[derive(Clone, Copy, Debug)]
pub enum OnSide<S: Scalar> {
    /// The shorter one.
    Any,
    /// That of a point outside (m, in axes of the round thing, from its centre).
    Of(Vec3<S>),
    /// Through it, touching it from within.
    Inside,
    /// That of a point (the same), or through it where the mask is true.
    Either(Vec3<S>, S::Mask),
}

/// A point of a cylinder nearer to its axis than this (m) tells no side.
const ON_AXIS: f64 = 1e-15;

impl OnSide<f64> {
    /// The side that a point asks for (m, from the centre of the round thing and in its axes).
    pub fn told_by(point: Vec3<f64>, shape: RoundShape, radius: f64) -> Self {
        if point.dot(point) < radius * radius {
            Self::Inside
        } else if shape == RoundShape::Cylinder && point.x.hypot(point.y) < ON_AXIS {
            // What tells no side is taken for the x axis, as in MuJoCo.
            Self::Of(Vec3::new(radius, 0.0, point.z))
        } else {
            Self::Of(point)
        }
    }
}

/// A path between two points, in axes of the round thing.
#[derive(Clone, Copy, Debug)]
pub struct Course<S: Scalar> {
    /// Its length (m).
    pub length: S,
    /// Unit vector along it at its beginning.
    pub leaving: Vec3<S>,
    /// Unit vector along it at its end.
    pub arriving: Vec3<S>,
    /// Where it bends.
    pub bends: S::Mask,
}

/// A plane in axes of the round thing: two unit vectors.
#[derive(Clone, Copy)]
struct Plane<S> {
    x: Vec3<S>,
    y: Vec3<S>,
}

impl<S: Scalar> Plane<S> {
    /// Through the centre and two points, the first one along x; how far along.
    #[inline(always)]
    fn through(a: Vec3<S>, b: Vec3<S>) -> (Self, S) {
        let (square_a, square_b) = (a.dot(a), b.dot(b));
        let inverse = square_a.max(S::lit(SHORTEST_SQUARED)).rsqrt();
        let x = a.scale(inverse);
        let normal = a.cross(b);
        let least = (PARALLEL.0 * S::EPSILON).powi(2);
        let least = (square_a * square_b * S::lit(least)).max(S::lit(PARALLEL.1));
        let normal = Vec3::select(normal.dot(normal).lt(least), any_normal(x), normal);
        let y = normal.cross(x);
        (Self { x, y: y.scale(y.dot(y).max(S::lit(1e-37)).rsqrt()) }, square_a * inverse)
    }

    /// Across the axis of a cylinder.
    #[inline(always)]
    fn across() -> Self {
        let (o, i) = (S::zero(), S::lit(1.0));
        Self { x: Vec3::new(i, o, o), y: Vec3::new(o, i, o) }
    }

    #[inline(always)]
    fn lift(&self, v: Flat<S>) -> Vec3<S> {
        self.x.mul_add(v.x, self.y.scale(v.y))
    }
}

/// A vector that is not parallel to a unit vector makes a normal: MuJoCo takes ones in place of all but the greatest entry.
#[inline(always)]
fn any_normal<S: Scalar>(x: Vec3<S>) -> Vec3<S> {
    let (ax, ay, az) = (x.x.abs(), x.y.abs(), x.z.abs());
    let is_y = ax.lt(ay) & az.lt(ay);
    let is_z = ax.lt(az) & ay.lt(az);
    let (o, i) = (S::zero(), S::lit(1.0));
    let is_x = !(is_y | is_z);
    x.cross(Vec3::new(S::select(is_x, o, i), S::select(is_y, o, i), S::select(is_z, o, i)))
}

/// The path from `a` to `b`, both from the centre of the round thing and in its axes (m).
#[inline(always)]
pub fn course<S: Scalar>(
    shape: RoundShape,
    rule: SideRule,
    radius: S,
    side: OnSide<S>,
    ends: [Vec3<S>; 2],
) -> Course<S> {
    course_by(shape, rule, radius, side, angle_through(shape, radius, side, ends), ends)
}

/// The angle [of a way through](gap) (rad); zero where the way leads around.
#[inline(always)]
pub(super) fn angle_through<S: Scalar>(shape: RoundShape, radius: S, side: OnSide<S>, ends: [Vec3<S>; 2]) -> S {
    match side {
        OnSide::Any | OnSide::Of(_) => S::zero(),
        OnSide::Inside | OnSide::Either(..) => {
            let mut gap = [gap(shape, radius, ends)];
            settle(&mut gap);
            gap[0].psi()
        }
    }
}

/// The same path where the angle [of a way through](gap) was found before.
#[inline(always)]
pub(super) fn course_by<S: Scalar>(
    shape: RoundShape,
    rule: SideRule,
    radius: S,
    side: OnSide<S>,
    psi: S,
    [a, b]: [Vec3<S>; 2],
) -> Course<S> {
    let (_, plane, bend) = bent(shape, rule, radius, side, psi, [a, b]);
    let [before, along, after] = bend.lengths;
    let flat = before + along + after;
    let between = b - a;
    let (length, level, climb) = match shape {
        RoundShape::Sphere => (flat, S::lit(1.0), S::zero()),
        RoundShape::Cylinder => {
            let square = flat.mul_add(flat, between.z * between.z).max(S::lit(SHORTEST_SQUARED));
            let inverse = square.rsqrt();
            (square * inverse, flat * inverse, between.z * inverse)
        }
    };
    let leaving = lifted(shape, &plane, bend.directions[0], level, climb);
    let arriving = lifted(shape, &plane, bend.directions[1], level, climb);
    let square = between.dot(between).max(S::lit(SHORTEST_SQUARED));
    let inverse = square.rsqrt();
    let straight = between.scale(inverse);
    Course {
        length: S::select(bend.bends, length, square * inverse),
        leaving: Vec3::select(bend.bends, leaving, straight),
        arriving: Vec3::select(bend.bends, arriving, straight),
        bends: bend.bends,
    }
}

#[inline(always)]
fn lifted<S: Scalar>(shape: RoundShape, plane: &Plane<S>, flat: Flat<S>, level: S, climb: S) -> Vec3<S> {
    match shape {
        RoundShape::Sphere => plane.lift(flat),
        RoundShape::Cylinder => Vec3::new(flat.x * level, flat.y * level, climb),
    }
}

/// What is looked for of a way through something round.
#[inline(always)]
pub(super) fn gap<S: Scalar>(shape: RoundShape, radius: S, ends: [Vec3<S>; 2]) -> Gap<S> {
    let (_, [from, to]) = flattened(shape, ends);
    Gap::new(from, to, radius)
}

/// The plane in which a path bends, and its ends there.
#[inline(always)]
fn flattened<S: Scalar>(shape: RoundShape, [a, b]: [Vec3<S>; 2]) -> (Plane<S>, [Flat<S>; 2]) {
    match shape {
        RoundShape::Sphere => {
            let (plane, reach) = Plane::through(a, b);
            // The second end lies to the left of the first, by the choice of the plane.
            let to = Flat::new(plane.x.dot(b), plane.y.dot(b).max(S::zero()));
            (plane, [Flat::new(reach, S::zero()), to])
        }
        RoundShape::Cylinder => (Plane::across(), [Flat::new(a.x, a.y), Flat::new(b.x, b.y)]),
    }
}

/// The plane in which the path bends, its first end there, and how it bends.
#[inline(always)]
fn bent<S: Scalar>(
    shape: RoundShape,
    rule: SideRule,
    radius: S,
    side: OnSide<S>,
    psi: S,
    ends: [Vec3<S>; 2],
) -> (Flat<S>, Plane<S>, Bend<S>) {
    let (plane, ends) = flattened(shape, ends);
    let (past, through) = match side {
        OnSide::Any => (Some(None), None),
        OnSide::Of(side) => (Some(Some(side)), None),
        OnSide::Inside => (None, Some(S::Mask::splat(true))),
        OnSide::Either(side, is_inside) => (Some(Some(side)), Some(is_inside)),
    };
    (ends[0], plane, Around { shape, rule, radius, plane, past, through, psi, ends }.bend())
}

/// What is to be got past, and how that may be.
struct Around<S: Scalar> {
    shape: RoundShape,
    rule: SideRule,
    radius: S,
    plane: Plane<S>,
    /// Around it, on the side of a point.
    past: Option<Option<Vec3<S>>>,
    /// Through it, where the mask is true.
    through: Option<S::Mask>,
    /// The angle of the way through.
    psi: S,
    ends: [Flat<S>; 2],
}

impl<S: Scalar> Around<S> {
    // No closures: one that is not inlined would be compiled without its level's instructions. One call each: called from several places, the
    // loop in `touching` would not be inlined.
    #[expect(clippy::manual_map, reason = "see above")]
    #[inline(always)]
    fn bend(self) -> Bend<S> {
        let Self { shape, rule, radius, plane, past, through, psi, ends: [from, to] } = self;
        let past = match past {
            Some(side) => {
                let side = match side {
                    Some(side) => Some(in_plane(shape, &plane, side)),
                    None => None,
                };
                Some(around(side, rule, from, to, radius))
            }
            None => None,
        };
        let through = match through {
            Some(is_inside) => Some((is_inside, touching(from, to, radius, psi))),
            None => None,
        };
        match (past, through) {
            (Some(past), Some((is_inside, through))) => Bend::select(is_inside, &through, &past),
            (Some(past), None) => past,
            (None, Some((_, through))) => through,
            (None, None) => Bend::straight(),
        }
    }
}

#[inline(always)]
fn in_plane<S: Scalar>(shape: RoundShape, plane: &Plane<S>, v: Vec3<S>) -> Flat<S> {
    match shape {
        RoundShape::Sphere => Flat::new(plane.x.dot(v), plane.y.dot(v)),
        RoundShape::Cylinder => Flat::new(v.x, v.y),
    }
}

/// Points between the ends of the path from `a` to `b` (m, from O): `count` of them from where it comes to the round thing to
/// where it leaves it; along the straight line where it does not bend. `side` is a point on the side where it runs (from O).
pub fn points(round: &Round<f64>, side: Option<Vec3<f64>>, [a, b]: [Vec3<f64>; 2], count: usize) -> Vec<Vec3<f64>> {
    let to_local = |p: Vec3<f64>| round.frame.rotation.apply_inverse(p - round.frame.position);
    let side = side.map_or(OnSide::Any, |side| OnSide::told_by(to_local(side), round.shape, round.radius));
    let local = [to_local(a), to_local(b)];
    let psi = angle_through(round.shape, round.radius, side, local);
    let (from, plane, bend) = bent(round.shape, round.rule, round.radius, side, psi, local);
    let share = |k: usize| (k as f64 + 0.5) / count as f64;
    if !bend.bends {
        return (0..count).map(|k| (b - a).mul_add(share(k), a)).collect();
    }
    let [before, along, after] = bend.lengths;
    let flat = before + along + after;
    let touched = bend.directions[0].mul_add(before, from);
    let point = |k: usize| {
        let along = along.max(0.0) * if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
        let (sin, cos) = (bend.turn * along / round.radius).sin_cos();
        let turned = touched.left().mul_add(sin, touched.scale(cos));
        let local = match round.shape {
            RoundShape::Sphere => plane.lift(turned),
            RoundShape::Cylinder => {
                let climbed = (before + along) / flat.max(f64::MIN_POSITIVE);
                Vec3::new(turned.x, turned.y, local[0].z + (local[1].z - local[0].z) * climbed)
            }
        };
        round.frame.place(local)
    };
    (0..count).map(point).collect()
}
