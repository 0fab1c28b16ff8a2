//! Contacts of a touch: of faces that lie on each other, of an edge along a face, or of the touch alone.

use super::clip::clip;
use super::face::{Face, Side, edge_on_face, on_each_other};
use super::quad;
use super::scratch::Scratch;
use super::touch::Touch;
use nalgebra::Vector3;

/// Contacts that a pair has at most.
pub const MOST_CONTACTS: usize = 4;

/// A contact of two shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Distance of the surfaces (m), negative where they overlap.
    pub distance: f64,
    /// Midway between the surfaces (m).
    pub at: Vector3<f64>,
    /// Unit, from the first to the second.
    pub normal: Vector3<f64>,
}

/// Contacts of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Contacts<const MOST: usize = MOST_CONTACTS> {
    all: [Option<Contact>; MOST],
    count: usize,
}

impl<const MOST: usize> Default for Contacts<MOST> {
    fn default() -> Self {
        Self { all: [None; MOST], count: 0 }
    }
}

impl<const MOST: usize> Contacts<MOST> {
    /// Adds one; more than there may be are left out.
    pub(super) fn push(&mut self, contact: Contact) {
        if let Some(slot) = self.all.get_mut(self.count) {
            *slot = Some(contact);
            self.count += 1;
        }
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Contact> {
        self.all.iter().flatten()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }
}

impl Contacts {
    /// These, or without any the one of a touch.
    pub(super) fn or_single(self, touch: &Touch) -> Self {
        if self.is_empty() { single(touch, 0.0) } else { self }
    }
}

/// The one contact of a touch, the first shape grown by a radius (m).
pub(super) fn single(touch: &Touch, radius: f64) -> Contacts {
    let [first, second] = touch.points;
    let at = 0.5 * (first + radius * touch.normal + second);
    let mut contacts = Contacts::default();
    contacts.push(Contact { distance: -touch.depth - radius, at, normal: touch.normal });
    contacts
}

/// Contacts of a touch between two sides, up to a margin (m).
pub(super) fn several(touch: &Touch, [one, other]: [&Side<'_>; 2], margin: f64, scratch: &mut Scratch) -> Contacts {
    if let Some(faces) = on_each_other(one, other, &touch.normal) {
        return of_faces(&faces, margin, scratch).or_single(touch);
    }
    // What is larger than the other's feature is not tried, unless it has no face that the other could lie on.
    let is_smaller = one.size() <= other.size() || one.faces().next().is_none();
    if is_smaller && let Some((edge, face)) = edge_on_face(one, other, &-touch.normal) {
        return of_edge(&edge, &face, &Lying::new(margin, -1.0), scratch).or_single(touch);
    }
    if let Some((edge, face)) = edge_on_face(other, one, &touch.normal) {
        return of_edge(&edge, &face, &Lying::new(margin, 1.0), scratch).or_single(touch);
    }
    single(touch, 0.0)
}

/// Contacts of two faces: of the second's corners, clipped by the first, against the first. Distances are along the normal of the second, which is the
/// contacts', too.
fn of_faces((face, other): &(Face<'_>, Face<'_>), margin: f64, scratch: &mut Scratch) -> Contacts {
    let Scratch { corners, left, .. } = scratch;
    corners.clear();
    corners.extend((0..other.count()).map(|number| other.corner(number)));
    clip(corners, left, face, margin);
    let (plane, towards) = (face.plane(), other.normal());
    let mut contacts = Contacts::default();
    let mut add = |point: &Vector3<f64>| {
        let foot = point - plane.height(point) * plane.normal;
        let distance = (foot - point).dot(&towards);
        contacts.push(Contact { distance, at: foot - 0.5 * distance * towards, normal: -towards });
    };
    if corners.len() > MOST_CONTACTS {
        quad::large(corners).iter().for_each(|&number| add(&corners[number]));
    } else {
        corners.iter().for_each(add);
    }
    contacts
}

/// How an edge lies along a face.
pub(super) struct Lying {
    /// Height over the face up to which there are contacts (m).
    pub margin: f64,
    /// 1 if the face is the first's, else -1.
    pub sign: f64,
    /// By how much the face is moved out (m).
    pub outset: f64,
}

impl Lying {
    fn new(margin: f64, sign: f64) -> Self {
        Self { margin, sign, outset: 0.0 }
    }
}

/// Contacts of an edge that lies along a face: of both ends of what is over it.
pub(super) fn of_edge(
    edge: &[Vector3<f64>; 2],
    face: &Face<'_>,
    &Lying { margin, sign, outset }: &Lying,
    scratch: &mut Scratch,
) -> Contacts {
    let Scratch { corners, left, .. } = scratch;
    corners.clear();
    corners.extend(edge);
    clip(corners, left, face, margin);
    let ends = furthest_two(corners);
    let plane = face.plane();
    let mut contacts = Contacts::default();
    for &number in &ends[..corners.len().min(2)] {
        let point = corners[number];
        let distance = plane.height(&point) + outset;
        let at = point + (outset - 0.5 * distance) * plane.normal;
        contacts.push(Contact { distance, at, normal: sign * plane.normal });
    }
    contacts
}

/// Numbers of the two of some points that are furthest from each other, the first such; of fewer than three the first ones.
fn furthest_two(points: &[Vector3<f64>]) -> [usize; 2] {
    let (mut best, mut furthest) = (f64::NEG_INFINITY, [0, 1]);
    if points.len() > 2 {
        for i in 0..points.len() {
            for j in i + 1..points.len() {
                let square = (points[j] - points[i]).norm_squared();
                if square > best {
                    (best, furthest) = (square, [i, j]);
                }
            }
        }
    }
    furthest
}
