//! Contact of parts of the body with each other and with what stands around: MuJoCo's geometry of planes, capsules and boxes, and the least way out
//! of ellipsoids, cylinders and meshes.

use super::contact::{Directions, Edges, Meeting, cone, pyramid, slide};
use super::cuboid::{self, Cuboid};
use super::cylinder::{self, Cylinder};
use super::ellipsoid::{Deepest, TINY, deepest};
use super::mesh;
use super::support::{Apart, Oval, Segment, Smooth, ovals};
use crate::plan::{ContactPair, Part, PartForm, Plan};
use crate::spatial::{Frame, Rotation, Vec3};
use crate::workspace::{Contact, State, Workspace};
use myo_scalar::{Carried, Mask, Real, Scalar, Stage, Visitor};

/// Squares of distances (m^2) below which two points are one, in reach of single precision.
const SAME: f64 = 1e-24;
/// Points in which something with corners stands on a plane.
pub(crate) const LOWEST: usize = 4;
/// Share of its greatest value below which the square of the sine between two axes is lost in rounding, in units of it.
const PARALLEL: f64 = 8.0;

/// Fills the contacts of pairs, which stand after those with boxes, and their Jacobians.
#[inline(always)]
pub fn pairs<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    for pair in &plan.pairs {
        let near = is_near(pair, ws);
        S::when(near, &mut Found { ws, pair }, |Found { ws, .. }| {
            S::outline(Near { plan, pair, near, state, ws });
        });
    }
}

/// Whether the balls around two parts are near enough to touch, or that around the second to a first one that is flat, or that around a capsule to a box.
#[inline(always)]
fn is_near<S: Scalar>(pair: &ContactPair<S::Const>, ws: &Workspace<S>) -> S::Mask {
    let [one, other] = &pair.parts;
    let apart = ws.place(&other.frame.origin) - ws.place(&one.frame.origin);
    let far = S::splat(pair.far);
    if let (PartForm::Capsule { .. }, PartForm::Box { half_size }) = (one.form, other.form) {
        let seen = ws.fixed(&other.frame).rotation.apply_inverse(-apart);
        return Cuboid { half_size: half_size.map(S::splat) }.square_outside(seen).lt(far.sq());
    }
    match one.form {
        PartForm::Plane => apart.dot(axis(one, ws)).lt(far),
        PartForm::Cylinder { radius, half_length } => {
            let [radius, half_length, margin] = [radius, half_length, pair.margin].map(S::splat);
            let seen = ws.fixed(&one.frame).rotation.apply_inverse(apart);
            Cylinder { radius, half_length, margin }.beside(seen).distance.lt(far)
        }
        _ => apart.dot(apart).lt(far.sq()),
    }
}

/// What a closer look finds.
struct Found<'a, S: Scalar> {
    ws: &'a mut Workspace<S>,
    pair: &'a ContactPair<S::Const>,
}

impl<S: Scalar> Carried<S> for Found<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        for slot in 0..self.pair.slots() {
            let number = self.ws.box_slots + self.pair.slot + slot;
            let Contact { exists, distance, normal, .. } = &mut self.ws.contacts[number];
            visitor.mask(exists);
            visitor.numbers([distance, &mut normal.x, &mut normal.y, &mut normal.z]);
            Edges { ws: self.ws, number, movers: &self.pair.movers.each }.visit(visitor);
        }
    }
}

/// A closer look at a pair.
struct Near<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    pair: &'a ContactPair<S::Const>,
    near: S::Mask,
    state: &'a State<S>,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Near<'_, S> {
    const NAME: &'static str = "parts that touch";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, pair, near, state, ws } = self;
        match pair.parts.each_ref().map(|part| part.form) {
            [_, PartForm::Mesh(hull)] => {
                let meets = mesh::meet(plan, pair, hull, near, ws);
                touch_where(plan, pair, state, &meets, ws);
            }
            [PartForm::Box { half_size: one }, PartForm::Box { half_size: other }] => {
                let meets = mesh::meet_boxes(pair, [one, other], near, ws);
                touch_where(plan, pair, state, &meets, ws);
            }
            [PartForm::Plane, PartForm::Box { .. } | PartForm::Cylinder { .. }] => {
                let meets = stands(&pair.parts[0], &pair.parts[1], ws);
                touch_where(plan, pair, state, &meets.map(|meets| (near, meets)), ws);
            }
            _ => touch_where(plan, pair, state, &meet(pair, ws).map(|meets| (near, meets)), ws),
        }
    }
}

/// Points in which a pair touches, of those that it may.
#[inline(always)]
fn touch_where<S: Scalar>(
    plan: &Plan<S::Const>,
    pair: &ContactPair<S::Const>,
    state: &State<S>,
    meets: &[(S::Mask, Meets<S>)],
    ws: &mut Workspace<S>,
) {
    for (point, &(exists, meets)) in meets.iter().take(pair.points).enumerate() {
        // Contacts are not there unless they are told of.
        if exists.any() {
            touch(plan, pair, state, (point, exists, meets), ws);
        }
    }
}

/// A point in which a pair touches, as a contact, where it does.
#[inline(always)]
fn touch<S: Scalar>(
    plan: &Plan<S::Const>,
    pair: &ContactPair<S::Const>,
    state: &State<S>,
    (point, near, Meets { distance, normal, at }): (usize, S::Mask, Meets<S>),
    ws: &mut Workspace<S>,
) {
    let along = pair.is_along_axis.then(|| axis(&pair.parts[1], ws));
    let first = ws.box_slots + pair.slot + point * pair.slots_each();
    let violation = distance - S::splat(pair.margin);
    let exists = near & violation.lt(S::zero());
    for contact in &mut ws.contacts[first..first + pair.slots_each()] {
        (contact.exists, contact.distance, contact.normal) = (exists, distance, normal);
    }
    let meeting = Meeting {
        at,
        normal,
        along,
        violation,
        impedance: &pair.impedance,
        diagonal: pair.diagonal,
        least: pair.least,
        movers: &pair.movers.each,
    };
    if pair.condim == 1 {
        slide(plan, &meeting, state, first, ws);
        return;
    }
    let dimensions = &dimensions(pair, &meeting)[..pair.condim];
    if pair.is_cone {
        return cone(plan, &meeting, dimensions, state, first, ws);
    }
    // Two to each contact of a point, of sliding or of turning.
    for (slot, two) in dimensions[1..].chunks(2).enumerate() {
        let (first_way, turn) = two[0];
        let directions = Directions { first: first_way, second: two.get(1).map(|&(way, _)| way), turn };
        pyramid(plan, &meeting, directions, state, first + slot, ws);
    }
}

/// The directions in which a pair resists, the normal first, as long as they count, and whether what resists is a turn about them.
#[inline(always)]
fn dimensions<S: Scalar>(pair: &ContactPair<S::Const>, meeting: &Meeting<'_, S>) -> [(Vec3<S>, bool); 6] {
    let (normal, [first, second]) = (meeting.normal, meeting.tangents());
    let [along, across, twisting, rolling, rolling_across] = pair.friction.map(S::splat);
    [
        (normal.scale(S::splat(pair.opening)), false),
        (first.scale(along), false),
        (second.scale(across), false),
        (normal.scale(twisting), true),
        (first.scale(rolling), true),
        (second.scale(rolling_across), true),
    ]
}

/// How two parts meet in a point.
#[derive(Clone, Copy)]
pub(super) struct Meets<S> {
    /// Distance of their surfaces (m), negative where they overlap.
    pub distance: S,
    /// From the first to the second.
    pub normal: Vec3<S>,
    /// Midway between the surfaces (m, from O).
    pub at: Vec3<S>,
}

/// Where a pair meets (m, from O), in as many points as it may; of meaning for the contacts that are there.
pub(crate) fn places(plan: &Plan<f64>, pair: &ContactPair<f64>, ws: &mut Workspace<f64>) -> Vec<Vec3<f64>> {
    let [one, other] = &pair.parts;
    let mut places: Vec<Vec3<f64>> = match [one.form, other.form] {
        [_, PartForm::Mesh(hull)] => mesh::meet(plan, pair, hull, true, ws).map(|(_, meets)| meets.at).into(),
        [PartForm::Box { half_size: one }, PartForm::Box { half_size: other }] => {
            mesh::meet_boxes(pair, [one, other], true, ws).map(|(_, meets)| meets.at).into()
        }
        [PartForm::Plane, PartForm::Box { .. } | PartForm::Cylinder { .. }] => {
            stands(one, other, ws).map(|meets| meets.at).into()
        }
        _ => meet(pair, ws).map(|meets| meets.at).into(),
    };
    places.truncate(pair.points);
    places
}

/// How two parts meet, in as many points as they may: of those that meet in one the second says nothing.
#[inline(always)]
fn meet<S: Scalar>(pair: &ContactPair<S::Const>, ws: &Workspace<S>) -> [Meets<S>; 2] {
    let [one, other] = &pair.parts;
    let alone = |meets| [meets; 2];
    match (one.form, other.form) {
        (PartForm::Plane, PartForm::Ellipsoid { radii }) => alone(oval_on_plane(one, other, radii, ws)),
        (PartForm::Plane, _) => rod_on_plane(one, other, ws),
        (PartForm::Cylinder { radius, half_length }, _) => {
            let [radius, half_length, margin] = [radius, half_length, pair.margin].map(S::splat);
            by_cylinder(&Cylinder { radius, half_length, margin }, one, other, ws)
        }
        (PartForm::Ellipsoid { radii }, PartForm::Ellipsoid { radii: others }) => {
            alone(two_ovals((one, radii), (other, others), ws))
        }
        (PartForm::Ellipsoid { radii }, _) => alone(rod_in_oval(one, other, radii, ws)),
        (PartForm::Capsule { .. }, PartForm::Box { half_size }) => rod_on_box(one, other, half_size, ws),
        (PartForm::Capsule { .. }, _) => alone(rods(one, other, ws)),
        (PartForm::Box { .. } | PartForm::Mesh(_), _) => {
            unreachable!("boxes and meshes are the last of all forms, and looked for apart")
        }
    }
}

/// Two ellipsoids.
#[inline(always)]
fn two_ovals<S: Scalar>(
    (first, radii): (&Part<S::Const>, [S::Const; 3]),
    (second, others): (&Part<S::Const>, [S::Const; 3]),
    ws: &Workspace<S>,
) -> Meets<S> {
    let (first, second) = (ws.fixed(&first.frame), ws.fixed(&second.frame));
    let one = Oval { axes: first.rotation, radii: radii.map(S::splat) };
    let other = Oval { axes: second.rotation, radii: others.map(S::splat) };
    let Apart { distance, normal, at } = ovals(&one, &other, second.position - first.position);
    Meets { distance, normal, at: first.position + at }
}

/// A capsule and an ellipsoid.
#[inline(always)]
fn rod_in_oval<S: Scalar>(
    one: &Part<S::Const>,
    other: &Part<S::Const>,
    radii: [S::Const; 3],
    ws: &Workspace<S>,
) -> Meets<S> {
    let (radius, middle, half) = rod(other, ws);
    let frame = ws.fixed(&one.frame);
    let turned = frame.rotation.apply_inverse(half);
    let Deepest { along, distance, normal } = deepest(radii.map(S::splat), frame.seen(middle), turned);
    let normal = frame.rotation.apply(normal);
    let point = half.mul_add(along, middle);
    // From the point of the axis to the middle between the surfaces.
    let back = (distance + radius) * S::lit(0.5);
    Meets { distance: distance - radius, normal, at: point - normal.scale(back) }
}

/// Two capsules.
#[inline(always)]
fn rods<S: Scalar>(one: &Part<S::Const>, other: &Part<S::Const>, ws: &Workspace<S>) -> Meets<S> {
    let (radius, middle, half) = rod(other, ws);
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

/// An ellipsoid over a plane.
#[inline(always)]
fn oval_on_plane<S: Scalar>(
    plane: &Part<S::Const>,
    other: &Part<S::Const>,
    radii: [S::Const; 3],
    ws: &Workspace<S>,
) -> Meets<S> {
    let (normal, frame) = (axis(plane, ws), ws.fixed(&other.frame));
    let oval = Oval { axes: frame.rotation, radii: radii.map(S::splat) };
    over_plane(plane, frame.position - oval.support(normal).point, normal, ws)
}

/// The ends of a capsule over a plane.
#[inline(always)]
fn rod_on_plane<S: Scalar>(plane: &Part<S::Const>, other: &Part<S::Const>, ws: &Workspace<S>) -> [Meets<S>; 2] {
    let (normal, (radius, middle, half)) = (axis(plane, ws), rod(other, ws));
    let low = middle - normal.scale(radius);
    [over_plane(plane, low + half, normal, ws), over_plane(plane, low - half, normal, ws)]
}

/// The lowest points of a box or a cylinder over a plane.
#[inline(always)]
fn stands<S: Scalar>(plane: &Part<S::Const>, other: &Part<S::Const>, ws: &Workspace<S>) -> [Meets<S>; LOWEST] {
    let (normal, frame) = (axis(plane, ws), ws.fixed(&other.frame));
    let lowest = match other.form {
        PartForm::Box { half_size } => cuboid::lowest(&frame, half_size.map(S::splat), normal),
        PartForm::Cylinder { radius, half_length } => {
            cylinder::lowest(&frame, [radius, half_length].map(S::splat), normal)
        }
        _ => unreachable!("nothing else stands on corners"),
    };
    lowest.map(|point| over_plane(plane, point, normal, ws))
}

/// A capsule on a box.
#[inline(always)]
fn rod_on_box<S: Scalar>(
    one: &Part<S::Const>,
    other: &Part<S::Const>,
    half_size: [S::Const; 3],
    ws: &Workspace<S>,
) -> [Meets<S>; 2] {
    let (radius, middle, half) = rod(one, ws);
    let frame = ws.fixed(&other.frame);
    let axis = Segment { middle: frame.seen(middle), half: frame.rotation.apply_inverse(half) };
    let [first, second] = cuboid::rod(&Cuboid { half_size: half_size.map(S::splat) }, &axis, radius);
    [placed(&frame, first), placed(&frame, second)]
}

/// What has its lowest point here.
#[inline(always)]
fn over_plane<S: Scalar>(plane: &Part<S::Const>, lowest: Vec3<S>, normal: Vec3<S>, ws: &Workspace<S>) -> Meets<S> {
    let distance = (lowest - ws.place(&plane.frame.origin)).dot(normal);
    Meets { distance, normal, at: lowest - normal.scale(distance * S::lit(0.5)) }
}

/// A capsule or an ellipsoid beside a cylinder.
#[inline(always)]
fn by_cylinder<S: Scalar>(
    cylinder: &Cylinder<S>,
    one: &Part<S::Const>,
    other: &Part<S::Const>,
    ws: &Workspace<S>,
) -> [Meets<S>; 2] {
    let frame = ws.fixed(&one.frame);
    let local = |v: Vec3<S>| frame.rotation.apply_inverse(v);
    let [first, second] = match other.form {
        PartForm::Ellipsoid { radii } => {
            let seen = ws.fixed(&other.frame);
            let Rotation { x, y, z } = seen.rotation;
            let axes = Rotation { x: local(x), y: local(y), z: local(z) };
            [cylinder::oval(cylinder, &Oval { axes, radii: radii.map(S::splat) }, frame.seen(seen.position)); 2]
        }
        _ => {
            let (radius, middle, half) = rod(other, ws);
            cylinder::rod(cylinder, &Segment { middle: frame.seen(middle), half: local(half) }, radius)
        }
    };
    [placed(&frame, first), placed(&frame, second)]
}

/// The same in the world, of what is seen in a frame.
#[inline(always)]
fn placed<S: Scalar>(frame: &Frame<S>, Apart { distance, normal, at }: Apart<S>) -> Meets<S> {
    Meets { distance, normal: frame.rotation.apply(normal), at: frame.place(at) }
}

/// The z axis of a part.
#[inline(always)]
fn axis<S: Scalar>(part: &Part<S::Const>, ws: &Workspace<S>) -> Vec3<S> {
    let axis = Vec3::splat(part.frame.axes[2]);
    if part.frame.origin.link == 0 { axis } else { ws.rotation[part.frame.origin.link].apply(axis) }
}

/// Radius, middle, and half of the axis of a capsule (m, world axes).
#[inline(always)]
fn rod<S: Scalar>(part: &Part<S::Const>, ws: &Workspace<S>) -> (S, Vec3<S>, Vec3<S>) {
    let PartForm::Capsule { radius, half_length } = part.form else {
        unreachable!("capsules are the last of all forms but boxes and meshes")
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
