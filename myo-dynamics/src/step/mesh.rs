//! Contacts of convex meshes and of two boxes: looked for in double precision, one body at a time.

use super::pair::Meets;
use crate::mesh::{BOX_CONTACTS, Contacts, MOST_CONTACTS, Other, Place, box_box, contacts};
use crate::plan::{ContactPair, PartForm, Plan};
use crate::spatial::{Frame, Rotation, Vec3};
use crate::workspace::Workspace;
use myo_scalar::{Mask, Real, Scalar};
use nalgebra::{Matrix3, Vector3};

/// Numbers that tell where a part is in the frame of another, and those of a contact and of all of them.
const PLACE: usize = 12;
const EACH: usize = 8;
const OF_MESH: usize = EACH * MOST_CONTACTS;
const OF_BOXES: usize = EACH * BOX_CONTACTS;

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
    let (form, margin) = (pair.parts[0].form, pair.margin.to_f64());
    let scratch = &mut ws.touching;
    let found: [S; OF_MESH] = S::lane_by_lane(near, place, |place| {
        let first = other(plan, form);
        numbers(&contacts(first, &plan.hulls[hull], &placed(place), margin, scratch))
    });
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
    let margin = pair.margin.to_f64();
    let scratch = &mut ws.touching;
    let found: [S; OF_BOXES] = S::lane_by_lane(near, place, |place| {
        let half_sizes = half_sizes.map(|sizes| sizes.map(S::Const::to_f64).into());
        numbers(&box_box(half_sizes, &placed(place), margin, scratch))
    });
    meets(&found, near, &frame)
}

/// The frame of the first part of a pair, and where the second is in it.
#[inline(always)]
fn second_in_first<S: Scalar>(pair: &ContactPair<S::Const>, ws: &Workspace<S>) -> (Frame<S>, [S; PLACE]) {
    let frame = ws.fixed(&pair.parts[0].frame);
    let seen = ws.fixed(&pair.parts[1].frame);
    let Rotation { x, y, z } = seen.rotation;
    let mut place = [S::zero(); PLACE];
    for (numbers, vector) in place.chunks_exact_mut(3).zip([
        frame.rotation.apply_inverse(x),
        frame.rotation.apply_inverse(y),
        frame.rotation.apply_inverse(z),
        frame.seen(seen.position),
    ]) {
        numbers.copy_from_slice(&vector.array());
    }
    (frame, place)
}

/// The contacts that numbers tell of, in the world.
#[inline(always)]
fn meets<S: Scalar, const MOST: usize>(found: &[S], near: S::Mask, frame: &Frame<S>) -> [(S::Mask, Meets<S>); MOST] {
    let mut meets =
        [(S::Mask::splat(false), Meets { distance: S::zero(), normal: Vec3::zero(), at: Vec3::zero() }); MOST];
    for (point, (exists, meets)) in meets.iter_mut().enumerate() {
        let of = |k: usize| found[EACH * point + k];
        *exists = S::zero().lt(of(0)) & near;
        meets.distance = of(1);
        meets.normal = frame.rotation.apply(Vec3::new(of(2), of(3), of(4)));
        meets.at = frame.place(Vec3::new(of(5), of(6), of(7)));
    }
    meets
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

fn placed(numbers: &[f64; PLACE]) -> Place {
    Place { rotation: Matrix3::from_column_slice(&numbers[..9]), position: Vector3::from_column_slice(&numbers[9..]) }
}

/// One if there is a contact, its distance, normal and place; of all of them.
fn numbers<const MOST: usize, const ALL: usize>(contacts: &Contacts<MOST>) -> [f64; ALL] {
    let mut numbers = [0.0; ALL];
    for (numbers, contact) in numbers.chunks_exact_mut(EACH).zip(contacts.iter()) {
        (numbers[0], numbers[1]) = (1.0, contact.distance);
        numbers[2..5].copy_from_slice(contact.normal.as_slice());
        numbers[5..].copy_from_slice(contact.at.as_slice());
    }
    numbers
}
