//! Contacts of convex meshes and of two boxes: looked for in double precision, one body at a time.

use super::gap::Two;
use super::pair::Meets;
use crate::mesh::{BOX_CONTACTS, Contacts, MOST_CONTACTS, Other, Place, box_box, contacts};
use crate::plan::{ContactPair, PartForm, Plan};
use crate::spatial::{Frame, Rotation, Vec3};
use crate::workspace::{MAX_LANES, Workspace};
use myo_scalar::{Mask, Real, Scalar};
use nalgebra::{Matrix3, Vector3};

/// Numbers that tell where a part is in the frame of another, a direction to it and which lane it is; those of a contact, of all of them, and
/// of a direction behind.
const PLACE: usize = 16;
const EACH: usize = 8;
const OF_MESH: usize = EACH * MOST_CONTACTS;
const OF_BOXES: usize = EACH * BOX_CONTACTS;
const WITH_DIRECTION: usize = OF_MESH + 3;

/// Where a mesh and the first part of a pair meet, in up to four points.
#[inline(always)]
pub(super) fn meet<S: Scalar>(
    plan: &Plan<S::Const>,
    pair: &ContactPair<S::Const>,
    hull: usize,
    near: S::Mask,
    ws: &mut Workspace<S>,
) -> [(S::Mask, Meets<S>); MOST_CONTACTS] {
    let (frame, place) = second_in_first(pair, ws);
    let hull = &plan.hulls[hull];
    let near = near & !Two { plan, pair, hull, place }.are_apart(near, &mut ws.towards[pair.slot]);
    if !near.any() {
        return nowhere();
    }
    let (form, margin) = (pair.parts[0].form, pair.margin.to_f64());
    let inputs = inputs(&place, ws.towards[pair.slot]);
    let scratch = &mut ws.touching;
    let found: [S; WITH_DIRECTION] = S::lane_by_lane(near, inputs, |place| {
        let first = other(plan, form);
        scratch.recall(seed::<S>(pair.slot) + place[PLACE - 1] as usize);
        let (place, mut towards) = placed(place);
        let contacts = contacts(first, hull, &place, &mut towards, margin, scratch);
        let mut numbers = [0.0; WITH_DIRECTION];
        write(&mut numbers, &contacts);
        numbers[OF_MESH..].copy_from_slice(towards.as_slice());
        numbers
    });
    let better = Vec3::new(found[OF_MESH], found[OF_MESH + 1], found[OF_MESH + 2]);
    ws.towards[pair.slot] = Vec3::select(near, better, ws.towards[pair.slot]);
    meets(&found, near, &frame)
}

/// Where two boxes meet, in up to eight points.
#[inline(always)]
pub(super) fn meet_boxes<S: Scalar>(
    pair: &ContactPair<S::Const>,
    half_sizes: [[S::Const; 3]; 2],
    near: S::Mask,
    ws: &mut Workspace<S>,
) -> [(S::Mask, Meets<S>); BOX_CONTACTS] {
    let (frame, place) = second_in_first(pair, ws);
    let (margin, inputs) = (pair.margin.to_f64(), inputs(&place, Vec3::zero()));
    let scratch = &mut ws.touching;
    let found: [S; OF_BOXES] = S::lane_by_lane(near, inputs, |place| {
        let half_sizes = half_sizes.map(|sizes| sizes.map(S::Const::to_f64).into());
        let mut numbers = [0.0; OF_BOXES];
        write(&mut numbers, &box_box(half_sizes, &placed(place).0, margin, scratch));
        numbers
    });
    meets(&found, near, &frame)
}

/// The frame of the first part of a pair, and that of the second seen from it.
#[inline(always)]
fn second_in_first<S: Scalar>(pair: &ContactPair<S::Const>, ws: &Workspace<S>) -> (Frame<S>, Frame<S>) {
    let frame = ws.fixed(&pair.parts[0].frame);
    let seen = ws.fixed(&pair.parts[1].frame);
    let Rotation { x, y, z } = seen.rotation;
    let [x, y, z] = [frame.rotation.apply_inverse(x), frame.rotation.apply_inverse(y), frame.rotation.apply_inverse(z)];
    let place = Frame { rotation: Rotation { x, y, z }, position: frame.seen(seen.position) };
    (frame, place)
}

/// What one body at a time is asked with.
#[inline(always)]
fn inputs<S: Scalar>(place: &Frame<S>, towards: Vec3<S>) -> [S; PLACE] {
    let Rotation { x, y, z } = place.rotation;
    let mut inputs = [S::zero(); PLACE];
    for (numbers, vector) in inputs.chunks_exact_mut(3).zip([x, y, z, place.position, towards]) {
        numbers.copy_from_slice(&vector.array());
    }
    inputs[PLACE - 1] = lane_numbers();
    inputs
}

/// Contacts that are not there.
#[inline(always)]
fn nowhere<S: Scalar, const MOST: usize>() -> [(S::Mask, Meets<S>); MOST] {
    [(S::Mask::splat(false), Meets { distance: S::zero(), normal: Vec3::zero(), at: Vec3::zero() }); MOST]
}

/// The contacts that numbers tell of, in the world.
#[inline(always)]
fn meets<S: Scalar, const MOST: usize>(found: &[S], near: S::Mask, frame: &Frame<S>) -> [(S::Mask, Meets<S>); MOST] {
    let mut meets = nowhere();
    for (point, (exists, meets)) in meets.iter_mut().enumerate() {
        let of = |k: usize| found[EACH * point + k];
        *exists = S::zero().lt(of(0)) & near;
        meets.distance = of(1);
        meets.normal = frame.rotation.apply(Vec3::new(of(2), of(3), of(4)));
        meets.at = frame.place(Vec3::new(of(5), of(6), of(7)));
    }
    meets
}

/// Which lane each is.
#[inline(always)]
fn lane_numbers<S: Scalar>() -> S {
    let mut numbers = [S::Const::default(); MAX_LANES];
    for (number, lane) in numbers.iter_mut().enumerate() {
        *lane = S::Const::from_f64(number as f64);
    }
    S::load(&numbers[..S::LANES])
}

/// How many touches are remembered.
pub(crate) fn seeds<S: Scalar>(plan: &Plan<S::Const>) -> usize {
    if plan.hulls.is_empty() { 0 } else { seed::<S>(plan.pair_contacts() + MOST_CONTACTS) }
}

/// The number of a pair's first by its first contact: two meshes have so many contacts at least.
fn seed<S: Scalar>(slot: usize) -> usize {
    slot / MOST_CONTACTS * S::LANES
}

/// What a mesh may touch.
fn other<C: Real>(plan: &Plan<C>, form: PartForm<C>) -> Other<'_> {
    match form {
        PartForm::Plane => Other::Plane,
        PartForm::Cylinder { radius, half_length } => {
            Other::Cylinder { radius: radius.to_f64(), half_length: half_length.to_f64() }
        }
        PartForm::Ellipsoid { radii } => Other::Ellipsoid { radii: radii.map(C::to_f64) },
        PartForm::Capsule { radius, half_length } => {
            Other::Capsule { radius: radius.to_f64(), half_length: half_length.to_f64() }
        }
        PartForm::Mesh(first) => Other::Mesh(&plan.hulls[first]),
        PartForm::Box { .. } => unreachable!("beside a mesh a box is one, too"),
    }
}

/// Where the second part is, and a direction to it.
fn placed(numbers: &[f64; PLACE]) -> (Place, Vector3<f64>) {
    let vector = |first: usize| Vector3::from_column_slice(&numbers[first..first + 3]);
    (Place { rotation: Matrix3::from_column_slice(&numbers[..9]), position: vector(9) }, vector(12))
}

/// One if there is a contact, its distance, normal and place; of all of them.
fn write<const MOST: usize>(numbers: &mut [f64], contacts: &Contacts<MOST>) {
    for (numbers, contact) in numbers.chunks_exact_mut(EACH).zip(contacts.iter()) {
        (numbers[0], numbers[1]) = (1.0, contact.distance);
        numbers[2..5].copy_from_slice(contact.normal.as_slice());
        numbers[5..].copy_from_slice(contact.at.as_slice());
    }
}
