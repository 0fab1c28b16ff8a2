//! Contact of fingers' spheres with boxes: MuJoCo's sphere-box geometry and its pyramidal friction cone, one contact per
//! box that is near enough.
//!
//! Most of the time the fingertip is far from everything, so the distance to the nearest box is remembered as a clearance:
//! as long as the fingertip has moved by less, nothing is looked at. Where it has, all boxes are gone through, most of which a
//! ball around them rules out; where there are many, and numbers that read rows from memory, the [nearest are listed](super::nearby). How many can be touched at once is known when a task is compiled
//! ([`most_at_once`](crate::most_at_once)), so there is a slot for each of them, and none is left out.

use super::boxes::{Boxes, Which};
use super::nearby::{self, List};
use crate::impedance::Impedance;
use crate::obstacles::{Obstacles, Touch};
use crate::plan::{ContactSphere, Mover, Plan};
use crate::spatial::{Rotation, Vec3};
use crate::workspace::{self, Clearance, Contact, Nearby, PYRAMID, State, Workspace};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor};

/// Farther than anything in reach (m).
const FAR: f64 = 1e3;
/// Centres nearer to the surface than this are inside (m); MuJoCo's smallest norm, in reach of single precision.
const SURFACE: f64 = 1e-15;
/// Square of the sine between a normal and a direction below which this tells no way across.
const UPRIGHT: f64 = 1e-10;
/// What rounding may add to a distance (m).
pub const ROUNDING: f64 = 1e-6;

/// Fills `contacts` and `contact_jacobian`.
#[inline(always)]
pub fn contact<S: Scalar>(
    plan: &Plan<S::Const>,
    obstacles: &Obstacles<S::Const, S>,
    state: &State<S>,
    ws: &mut Workspace<S>,
) {
    for contact in &mut ws.contacts {
        if contact.exists.any() {
            contact.clear();
        }
    }
    if obstacles.boxes.is_empty() {
        return;
    }
    for (number, (sphere, touch)) in plan.contact_spheres.iter().zip(&obstacles.touches).enumerate() {
        press(plan, Finger { number, sphere, touch }, obstacles, state, ws);
    }
}

/// What presses.
struct Finger<'a, C> {
    /// Its number among those that press.
    number: usize,
    sphere: &'a ContactSphere<C>,
    touch: &'a Touch<C>,
}

// By hand: derived, they would ask the same of the number.
impl<C> Clone for Finger<'_, C> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<C> Copy for Finger<'_, C> {}

/// What a finger touches.
#[inline(always)]
fn press<S: Scalar>(
    plan: &Plan<S::Const>,
    finger: Finger<'_, S::Const>,
    obstacles: &Obstacles<S::Const, S>,
    state: &State<S>,
    ws: &mut Workspace<S>,
) {
    let Finger { number: one, sphere, .. } = finger;
    let centre = ws.uncarried(ws.place(&sphere.centre));
    let moved = centre - ws.clearance[one].from;
    let near = !moved.dot(moved).lt(ws.clearance[one].free.sq());
    let slots = ws.slots_of(one);
    let Workspace { contacts, clearance, nearby, offsets, .. } = &mut *ws;
    let (contacts, clearance, nearby) = (&mut contacts[slots.clone()], &mut clearance[one], &mut nearby[one]);
    let boxes = Boxes { obstacles, offsets };
    let mut around =
        Around { contacts, clearance, nearby, found: S::zero(), lists: nearby::lists::<S>(obstacles.boxes.len()) };
    S::when(near, &mut around, |around| S::outline(LookAround { finger, boxes, centre, around }));
    for number in slots {
        let exists = ws.contacts[number].exists;
        let mut edges = Edges { ws, number, movers: &sphere.movers.each };
        S::when(exists, &mut edges, |Edges { ws, .. }| {
            S::outline(Pressed { plan, finger, state, centre, number, ws });
        });
    }
}

/// See [`look_around`]. Branches of this size are stages: a closure that is not inlined would be compiled without its level's
/// instructions.
struct LookAround<'a, 'b, S: Scalar> {
    finger: Finger<'a, S::Const>,
    boxes: Boxes<'a, S>,
    centre: Vec3<S>,
    around: &'a mut Around<'b, S>,
}

impl<S: Scalar> Stage<S> for LookAround<'_, '_, S> {
    const NAME: &'static str = "boxes around";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        look_around(self.finger, self.boxes, self.centre, self.around);
    }
}

/// What a finger presses, as rows.
struct Pressed<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    finger: Finger<'a, S::Const>,
    state: &'a State<S>,
    centre: Vec3<S>,
    number: usize,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Pressed<'_, S> {
    const NAME: &'static str = "friction pyramid";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, finger: Finger { sphere, touch, .. }, state, centre, number, ws } = self;
        let Contact { distance, normal, .. } = ws.contacts[number];
        // Midway between the two surfaces.
        let depth = distance.mul_add(S::lit(0.5), S::splat(sphere.radius));
        let meeting = Meeting {
            at: ws.carried(centre - normal.scale(depth)),
            normal,
            along: None,
            violation: distance - S::splat(touch.margin),
            impedance: &touch.impedance,
            diagonal: touch.diagonal,
            least: touch.least,
            movers: &sphere.movers.each,
        };
        let friction = S::splat(touch.friction);
        let [first, second] = meeting.tangents().map(|tangent| tangent.scale(friction));
        pyramid(plan, &meeting, Directions { first, second: Some(second), turn: false }, state, number, ws);
    }
}

/// What a look around finds.
struct Around<'a, S: Scalar> {
    contacts: &'a mut [Contact<S>],
    clearance: &'a mut Clearance<S>,
    nearby: &'a mut Nearby<S>,
    /// Contacts found so far.
    found: S,
    /// Whether the nearest boxes are listed.
    lists: bool,
}

/// Shows what a look around finds of a contact; its rows and its force come later.
fn visit_found<S: Scalar>(contact: &mut Contact<S>, visitor: &mut impl Visitor<S>) {
    let Contact { exists, index, distance, normal, facing, .. } = contact;
    visitor.mask(exists);
    visitor.numbers([index, distance, &mut normal.x, &mut normal.y, &mut normal.z, facing]);
}

impl<S: Scalar> Carried<S> for Around<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        self.contacts.iter_mut().for_each(|contact| visit_found(contact, visitor));
        let Clearance { from, free } = &mut *self.clearance;
        visitor.numbers([&mut from.x, &mut from.y, &mut from.z, free, &mut self.found]);
        if self.lists {
            self.nearby.visit(visitor);
        }
    }
}

/// Goes through all boxes, or those nearby: what is touched, and how far away the nearest one is otherwise. Where the clearance
/// is not used up, nothing is touched, and a new one does no harm.
#[inline(always)]
fn look_around<S: Scalar>(
    Finger { sphere, touch, .. }: Finger<'_, S::Const>,
    boxes: Boxes<'_, S>,
    centre: Vec3<S>,
    around: &mut Around<'_, S>,
) {
    let reach = S::splat(sphere.radius) + S::splat(touch.margin);
    *around.clearance = Clearance { from: centre, free: S::lit(FAR) };
    if around.lists {
        let moved = centre - around.nearby.from;
        let is_stale = !moved.dot(moved).lt(around.nearby.free.sq());
        S::when(is_stale, around.nearby, |nearby| S::outline(List { boxes, centre, reach, nearby }));
        let moved = centre - around.nearby.from;
        around.clearance.free = (around.nearby.free - moved.dot(moved).sqrt()).max(S::zero());
        for number in around.nearby.boxes.clone() {
            look_at(sphere, boxes, centre, reach, Which::Listed(number), around);
        }
    } else {
        S::for_each_row(boxes.count(), around, |around, row| {
            look_at(sphere, boxes, centre, reach, Which::Row(row), around);
        });
    }
}

/// Looks at one box.
#[inline(always)]
fn look_at<S: Scalar>(
    sphere: &ContactSphere<S::Const>,
    boxes: Boxes<'_, S>,
    centre: Vec3<S>,
    reach: S,
    which: Which<S>,
    around: &mut Around<'_, S>,
) {
    let (away, radius) = boxes.seen_from(centre, which);
    // From the ball around the box.
    let clear = away.dot(away).sqrt() - radius - reach;
    let near = clear.lt(S::zero());
    let mut beside = Beside { around, clear };
    S::when(near, &mut beside, |beside| S::outline(Inspect { sphere, boxes, which, away, near, reach, beside }));
    let Beside { around, clear } = beside;
    around.clearance.free = around.clearance.free.min((clear - S::lit(ROUNDING)).max(S::zero()));
}

/// A closer look at a box.
struct Inspect<'a, 'b, 'c, S: Scalar> {
    sphere: &'a ContactSphere<S::Const>,
    boxes: Boxes<'a, S>,
    /// The box.
    which: Which<S>,
    /// The fingertip, from its centre.
    away: Vec3<S>,
    /// Where it is looked at.
    near: S::Mask,
    /// From the centre of the fingertip to where contact begins (m).
    reach: S,
    beside: &'a mut Beside<'b, 'c, S>,
}

impl<S: Scalar> Stage<S> for Inspect<'_, '_, '_, S> {
    const NAME: &'static str = "box nearby";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { sphere, boxes, which, away, near, reach, beside: Beside { around, clear } } = self;
        let (axes, half_size) = boxes.sides(which);
        let (distance, normal) = surface(axes, half_size, away);
        *clear = S::select(near, distance - reach, *clear);
        let touches = near & clear.lt(S::zero());
        let distance = distance - S::splat(sphere.radius);
        let [x, y, z] = axes[2];
        let facing = normal.dot(Vec3::new(x, y, z));
        around.add(touches, Contact { index: which.number(), distance, normal, facing, ..Contact::none() });
    }
}

/// A box that is looked at.
struct Beside<'a, 'b, S: Scalar> {
    around: &'a mut Around<'b, S>,
    /// Distance from what can be touched (m).
    clear: S,
}

impl<S: Scalar> Carried<S> for Beside<'_, '_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        self.around.contacts.iter_mut().for_each(|contact| visit_found(contact, visitor));
        visitor.numbers([&mut self.clear, &mut self.around.found]);
    }
}

impl<S: Scalar> Around<'_, S> {
    /// Puts a contact into the next free slot where the mask is true.
    #[inline(always)]
    fn add(&mut self, mask: S::Mask, new: Contact<S>) {
        for (slot, contact) in self.contacts.iter_mut().enumerate() {
            let here = mask & (self.found - S::lit(slot as f64)).abs().lt(S::lit(0.5));
            contact.exists = contact.exists | here;
            contact.index = S::select(here, new.index, contact.index);
            contact.distance = S::select(here, new.distance, contact.distance);
            contact.normal = Vec3::select(here, new.normal, contact.normal);
            contact.facing = S::select(here, new.facing, contact.facing);
        }
        self.found += S::indicator(mask);
    }
}

/// The rows that [`pyramid`] writes, of the contact of this number.
pub(super) struct Edges<'a, S: Scalar> {
    pub ws: &'a mut Workspace<S>,
    pub number: usize,
    pub movers: &'a [Mover],
}

impl<S: Scalar> Carried<S> for Edges<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self { ws, number, movers } = self;
        let n = ws.qacc.len();
        for (k, row) in ws.contacts[*number].rows.iter_mut().enumerate() {
            visitor.mask(&mut row.exists);
            visitor.mask(&mut row.active);
            visitor.numbers([&mut row.weight, &mut row.reference, &mut row.slope]);
            let jacobian = &mut ws.contact_jacobian[(*number * PYRAMID + k) * n..][..n];
            movers.iter().for_each(|mover| visitor.number(&mut jacobian[mover.dof]));
        }
    }
}

/// Signed distance of a point from the surface of a box with these axes as columns, and the direction out of the box (world
/// axes). The point is given from the centre of the box.
#[inline(always)]
pub fn surface<S: Scalar>(axes: [[S; 3]; 3], half_size: [S; 3], point: Vec3<S>) -> (S, Vec3<S>) {
    let [x, y, z] = axes.map(|[x, y, z]| Vec3::new(x, y, z));
    let axes = Rotation { x, y, z };
    let local = axes.apply_inverse(point).array();
    let mut excess = [S::zero(); 3];
    let (mut depth, mut face) = (S::lit(FAR), [S::zero(); 3]);
    for k in 0..3 {
        let half = half_size[k];
        excess[k] = local[k] - local[k].max(-half).min(half);
        // Depth below the nearer of the two faces across this axis; the negative face wins ties.
        let inside = half - local[k].abs();
        let nearer = inside.lt(depth);
        let sign = S::select(S::zero().lt(local[k]), S::lit(1.0), S::lit(-1.0));
        depth = S::select(nearer, inside, depth);
        for (j, component) in face.iter_mut().enumerate() {
            *component = S::select(nearer, if j == k { sign } else { S::zero() }, *component);
        }
    }
    let [x, y, z] = excess;
    let excess = Vec3::new(x, y, z);
    let square = excess.dot(excess);
    let outside = S::lit(SURFACE * SURFACE).lt(square);
    let inverse = square.max(S::lit(SURFACE * SURFACE)).rsqrt();
    let [fx, fy, fz] = face;
    let normal = Vec3::select(outside, excess.scale(inverse), Vec3::new(fx, fy, fz));
    (S::select(outside, square * inverse, -depth), axes.apply(normal))
}

/// Where two surfaces meet, and how they resist.
pub(super) struct Meeting<'a, S: Scalar> {
    /// Midway between the surfaces (m, from O).
    pub at: Vec3<S>,
    /// From the first to the second.
    pub normal: Vec3<S>,
    /// A direction along which friction is measured, as far as it is across the normal; without one as MuJoCo chooses.
    pub along: Option<Vec3<S>>,
    /// Distance of the surfaces less their margin (m).
    pub violation: S,
    /// Softness.
    pub impedance: &'a Impedance<S::Const>,
    /// Inverse inertia of every row.
    pub diagonal: S::Const,
    /// What the share of it in the regularisation is not below.
    pub least: S::Const,
    /// Coordinates that move the surfaces against each other.
    pub movers: &'a [Mover],
}

impl<S: Scalar> Meeting<'_, S> {
    /// The two directions across the normal along which friction is measured.
    #[inline(always)]
    pub(super) fn tangents(&self) -> [Vec3<S>; 2] {
        match self.along {
            Some(along) => tangents_along(self.normal, along),
            None => tangents(self.normal),
        }
    }
}

/// Directions in which surfaces resist each other, as long as their friction: along them, or about them.
#[derive(Clone, Copy)]
pub(super) struct Directions<S> {
    pub first: Vec3<S>,
    /// There may be one only.
    pub second: Option<Vec3<S>>,
    /// Whether what resists is a turn about them.
    pub turn: bool,
}

/// Two opposite edges of a contact's friction pyramid for each direction, as constraint rows.
#[inline(always)]
pub(super) fn pyramid<S: Scalar>(
    plan: &Plan<S::Const>,
    meeting: &Meeting<'_, S>,
    Directions { first, second, turn }: Directions<S>,
    state: &State<S>,
    number: usize,
    ws: &mut Workspace<S>,
) {
    let o = S::zero();
    let (mut apart, mut along, mut across) = (o, o, o);
    for mover in meeting.movers {
        let (dof, way, rate) = (mover.dof, moved(mover, meeting.at, ws), state.qvel[mover.dof]);
        let resisted = if turn { turned(mover, ws) } else { way };
        let out = way.dot(meeting.normal);
        let (u, v) = (resisted.dot(first), second.map_or(o, |second| resisted.dot(second)));
        for (k, entry) in [out + u, out - u, out + v, out - v].into_iter().enumerate() {
            ws.contact_jacobian[(number * PYRAMID + k) * plan.ndof() + dof] = entry;
        }
        apart = out.mul_add(rate, apart);
        along = u.mul_add(rate, along);
        across = v.mul_add(rate, across);
    }
    for (k, velocity) in [apart + along, apart - along, apart + across, apart - across].into_iter().enumerate() {
        if k < 2 || second.is_some() {
            row(meeting, velocity, (number, k), ws);
        } else {
            ws.contacts[number].rows[k] = workspace::Row::none();
        }
    }
}

/// A contact whose force is in an elliptic cone, as one row for each dimension: a direction, the normal first, and whether it is turned about.
#[inline(always)]
pub(super) fn cone<S: Scalar>(
    plan: &Plan<S::Const>,
    meeting: &Meeting<'_, S>,
    dimensions: &[(Vec3<S>, bool)],
    state: &State<S>,
    first: usize,
    ws: &mut Workspace<S>,
) {
    let (n, exists) = (plan.ndof(), ws.contacts[first].exists);
    for (k, &(direction, turn)) in dimensions.iter().enumerate() {
        let mut velocity = S::zero();
        for mover in meeting.movers {
            let way = if turn { turned(mover, ws) } else { moved(mover, meeting.at, ws) };
            let entry = way.dot(direction);
            ws.contact_jacobian[(first * PYRAMID + k) * n + mover.dof] = entry;
            velocity = entry.mul_add(state.qvel[mover.dof], velocity);
        }
        // Only along the normal are they anywhere.
        let away = if k == 0 { meeting.violation * direction.dot(meeting.normal) } else { S::zero() };
        let (weight, reference) = meeting.impedance.row_of(
            meeting.violation,
            away,
            velocity,
            S::splat(meeting.diagonal),
            S::splat(meeting.least),
        );
        let row = workspace::Row { exists, active: exists, weight, reference, slope: S::lit(1.0) };
        ws.contacts[first + k / PYRAMID].rows[k % PYRAMID] = row;
    }
}

/// A contact without friction as one row, along the normal; the others of the pyramid are not there.
#[inline(always)]
pub(super) fn slide<S: Scalar>(
    plan: &Plan<S::Const>,
    meeting: &Meeting<'_, S>,
    state: &State<S>,
    number: usize,
    ws: &mut Workspace<S>,
) {
    let mut velocity = S::zero();
    for mover in meeting.movers {
        let out = moved(mover, meeting.at, ws).dot(meeting.normal);
        ws.contact_jacobian[number * PYRAMID * plan.ndof() + mover.dof] = out;
        velocity = out.mul_add(state.qvel[mover.dof], velocity);
    }
    row(meeting, velocity, (number, 0), ws);
    for k in 1..PYRAMID {
        ws.contacts[number].rows[k] = workspace::Row::none();
    }
}

/// How a coordinate moves the second surface at a point (m or 1), as seen from the first.
#[inline(always)]
fn moved<S: Scalar>(mover: &Mover, at: Vec3<S>, ws: &Workspace<S>) -> Vec3<S> {
    match (mover.under, mover.over) {
        (None, Some(over)) => ws.screw[over].at(at),
        (Some(under), None) => -ws.screw[under].at(at),
        (Some(under), Some(over)) => (ws.screw[over] - ws.screw[under]).at(at),
        (None, None) => Vec3::zero(),
    }
}

/// How a coordinate turns the second surface (1 or 1/m), as seen from the first.
#[inline(always)]
fn turned<S: Scalar>(mover: &Mover, ws: &Workspace<S>) -> Vec3<S> {
    let of = |screw: Option<usize>| screw.map_or_else(Vec3::zero, |screw| ws.screw[screw].ang);
    of(mover.over) - of(mover.under)
}

/// A row of a contact whose surfaces move apart with a velocity (m/s) along its direction.
#[inline(always)]
fn row<S: Scalar>(meeting: &Meeting<'_, S>, velocity: S, (number, k): (usize, usize), ws: &mut Workspace<S>) {
    let exists = ws.contacts[number].exists;
    let (diagonal, least) = (S::splat(meeting.diagonal), S::splat(meeting.least));
    let (weight, reference) = meeting.impedance.row_of(meeting.violation, meeting.violation, velocity, diagonal, least);
    ws.contacts[number].rows[k] = workspace::Row { exists, active: exists, weight, reference, slope: S::lit(1.0) };
}

/// Two directions across a normal, the first as nearly along another direction as can be; of the normal's own any.
#[inline(always)]
fn tangents_along<S: Scalar>(normal: Vec3<S>, along: Vec3<S>) -> [Vec3<S>; 2] {
    let across = along - normal.scale(normal.dot(along));
    let square = across.dot(across);
    let tells = S::lit(UPRIGHT).lt(square);
    let [any, _] = tangents(normal);
    let first = Vec3::select(tells, across.scale(square.max(S::lit(UPRIGHT)).rsqrt()), any);
    [first, normal.cross(first)]
}

/// Two directions across a normal, as MuJoCo chooses them: from the world's y axis, or z where the normal is near y.
#[inline(always)]
pub(super) fn tangents<S: Scalar>(normal: Vec3<S>) -> [Vec3<S>; 2] {
    let (o, i) = (S::zero(), S::lit(1.0));
    let steep = normal.y.abs().lt(S::lit(0.5));
    let guide = Vec3::select(steep, Vec3::new(o, i, o), Vec3::new(o, o, i));
    let across = guide - normal.scale(normal.dot(guide));
    let first = across.scale(across.dot(across).rsqrt());
    [first, normal.cross(first)]
}
