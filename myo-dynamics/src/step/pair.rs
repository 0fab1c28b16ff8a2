//! Contact of parts of the body with each other: MuJoCo's geometry of capsules, and the least way out of an ellipsoid.

use super::contact::{Edges, Meeting, pyramid, slide};
use super::ellipsoid::{Deepest, TINY, deepest};
use crate::plan::{ContactPair, Part, PartForm, Plan};
use crate::spatial::Vec3;
use crate::workspace::{Contact, State, Workspace};
use myo_scalar::{Carried, Real, Scalar, Stage, Visitor};

/// Squares of distances (m^2) below which two points are one, in reach of single precision.
const SAME: f64 = 1e-24;
/// Share of its greatest value below which the square of the sine between two axes is lost in rounding, in units of it.
const PARALLEL: f64 = 8.0;

/// Fills the contacts of pairs, which stand after those with boxes, and their Jacobians.
#[inline(always)]
pub fn pairs<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    for (k, pair) in plan.pairs.iter().enumerate() {
        let number = ws.box_slots + k;
        let [one, other] = &pair.parts;
        let apart = ws.place(&other.frame.origin) - ws.place(&one.frame.origin);
        let near = apart.dot(apart).lt(S::splat(pair.far));
        S::when(near, &mut Found(Edges(ws, number)), |Found(Edges(ws, number))| {
            S::outline(Near { plan, pair, near, state, number: *number, ws });
        });
    }
}

/// What a closer look finds.
struct Found<'a, S: Scalar>(Edges<'a, S>);

impl<S: Scalar> Carried<S> for Found<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self(Edges(ws, number)) = self;
        let Contact { exists, distance, normal, .. } = &mut ws.contacts[*number];
        visitor.mask(exists);
        visitor.numbers([distance, &mut normal.x, &mut normal.y, &mut normal.z]);
        self.0.visit(visitor);
    }
}

/// A closer look at a pair.
struct Near<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    pair: &'a ContactPair<S::Const>,
    near: S::Mask,
    state: &'a State<S>,
    number: usize,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Near<'_, S> {
    const NAME: &'static str = "parts that touch";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, pair, near, state, number, ws } = self;
        let Meets { distance, normal, at } = meet(pair, ws);
        let violation = distance - S::splat(pair.margin);
        let contact = &mut ws.contacts[number];
        (contact.exists, contact.distance, contact.normal) = (near & violation.lt(S::zero()), distance, normal);
        let meeting = Meeting {
            at,
            normal,
            violation,
            friction: pair.friction,
            impedance: &pair.impedance,
            diagonal: pair.diagonal,
            links: pair.links(),
        };
        if pair.is_slippery {
            slide(plan, &meeting, state, number, ws);
        } else {
            pyramid(plan, &meeting, state, number, ws);
        }
    }
}

/// How two parts meet.
struct Meets<S> {
    /// Distance of their surfaces (m), negative where they overlap.
    distance: S,
    /// From the first to the second.
    normal: Vec3<S>,
    /// Midway between the surfaces (m, from O).
    at: Vec3<S>,
}

#[inline(always)]
fn meet<S: Scalar>(pair: &ContactPair<S::Const>, ws: &Workspace<S>) -> Meets<S> {
    let [one, other] = &pair.parts;
    let (radius, middle, half) = rod(other, ws);
    match one.form {
        PartForm::Ellipsoid { radii } => {
            let frame = ws.fixed(&one.frame);
            let turned = frame.rotation.apply_inverse(half);
            let Deepest { along, distance, normal } = deepest(radii.map(S::splat), frame.seen(middle), turned);
            let normal = frame.rotation.apply(normal);
            let point = half.mul_add(along, middle);
            // From the point of the axis to the middle between the surfaces.
            let back = (distance + radius) * S::lit(0.5);
            Meets { distance: distance - radius, normal, at: point - normal.scale(back) }
        }
        PartForm::Capsule { .. } => {
            let (first_radius, first_middle, first_half) = rod(one, ws);
            let (a, b) = closest([first_middle, middle], [first_half, half]);
            let between = b - a;
            let square = between.dot(between);
            let apart = S::lit(SAME).lt(square);
            let inverse = square.max(S::lit(SAME)).rsqrt();
            let up = Vec3::new(S::zero(), S::zero(), S::lit(1.0));
            let normal = Vec3::select(apart, between.scale(inverse), up);
            let distance = (square * inverse).only(apart) - radius - first_radius;
            let out = distance.mul_add(S::lit(0.5), first_radius);
            Meets { distance, normal, at: normal.mul_add(out, a) }
        }
    }
}

/// Radius, middle, and half of the axis of a capsule (m, world axes).
#[inline(always)]
fn rod<S: Scalar>(part: &Part<S::Const>, ws: &Workspace<S>) -> (S, Vec3<S>, Vec3<S>) {
    let PartForm::Capsule { radius, half_length } = part.form else {
        unreachable!("of two parts an ellipsoid is the first, and there is at most one")
    };
    let half = part.frame.axes[2].map(|x| S::Const::from_f64(x.to_f64() * half_length.to_f64()));
    let half = ws.rotation[part.frame.origin.link].apply(Vec3::splat(half));
    (S::splat(radius), ws.place(&part.frame.origin), half)
}

/// The points of two segments `middle + x half`, `x` from -1 to 1, that are nearest to each other. Of parallel
/// segments, which have many, the one across from the middle of the first, as near as it comes.
#[inline(always)]
fn closest<S: Scalar>(middles: [Vec3<S>; 2], halves: [Vec3<S>; 2]) -> (Vec3<S>, Vec3<S>) {
    let between = middles[0] - middles[1];
    let [a, b] = halves;
    let (aa, ab, bb) = (a.dot(a), -a.dot(b), b.dot(b));
    let (u, v) = (-a.dot(between), b.dot(between));
    let tiny = S::lit(TINY);
    let determinant = aa.mul_add(bb, -(ab * ab));
    let crosses = (aa * bb * S::lit(PARALLEL * S::EPSILON)).lt(determinant);
    let safe = S::select(crosses, determinant, S::lit(1.0));
    let x = (bb * u - ab * v) * safe.recip();
    let x = x.only(crosses).clamp(-1.0, 1.0);
    let y = ((v - ab * x) * bb.max(tiny).recip()).clamp(-1.0, 1.0);
    let x = ((u - ab * y) * aa.max(tiny).recip()).clamp(-1.0, 1.0);
    (a.mul_add(x, middles[0]), b.mul_add(y, middles[1]))
}
