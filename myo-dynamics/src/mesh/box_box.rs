//! Contacts of two boxes, as MuJoCo makes them since 3.13.
//!
//! Of fifteen directions, those across the faces of both and those across an edge of each, the one along which they overlap least says how they touch: a face with
//! all of the other's face that is over it, or an edge with an edge in one point. S. Gottschalk, M. C. Lin and D. Manocha 1996 (doi 10.1145/237170.237244) on why
//! there are no others.

use super::Place;
use super::contacts::{Contact, Contacts};
use super::scratch::Scratch;
use nalgebra::{Matrix3, Vector3};

/// Contacts that two boxes have at most: a face clipped by another.
pub const BOX_CONTACTS: usize = 8;

/// What rounding does to an overlap, in sizes of both boxes.
const ROUNDING: f64 = 1e-13;
/// Square of the sine between two edges below which no direction across both is told.
const PARALLEL: f64 = 1e-16;
/// By how much, as a share, edges have to be better than faces: several points hold better than one.
const PREFERENCE: f64 = 1e-6;
/// Where a face and a pair of edges have nearly the same normal, by its cosine, edges have to be better by a share of the face's overlap.
const ALIKE_COSINE: f64 = 0.99;
const MUCH_BETTER: f64 = 0.05;
/// Less than any overlap that counts (m).
const NOTHING: f64 = 1e-15;
/// A direction that leans less along an axis does not tell which of two edges is meant.
const UNDECIDED: f64 = 1e-9;
/// Square of the distance below which two corners are one, in sizes of the face.
const SAME_CORNER: f64 = 1e-14;

/// Two boxes, seen from the first.
struct Pair {
    /// Half of their sides (m).
    half_sizes: [Vector3<f64>; 2],
    /// Axes of the second as columns.
    rotation: Matrix3<f64>,
    /// Middle of the second (m).
    position: Vector3<f64>,
}

/// The two do not touch.
struct Separated;

/// A direction along which the two may be apart.
#[derive(Clone, Copy, Debug)]
enum Way {
    /// Across a face, of the first box or the second, across which axis of it.
    Face { of: usize, axis: usize },
    /// Across an edge of each, by the axes that they run along.
    Edges { axes: [usize; 2], normal: Vector3<f64> },
}

/// A direction across an edge of each box, and how far the two are apart along it (m).
struct Across {
    /// The axes that the edges run along.
    axes: [usize; 2],
    /// Unit.
    normal: Vector3<f64>,
    apart: f64,
}

/// Contacts of two boxes of these half sizes (m), the second of which is at a place seen from the first; up to a margin (m).
#[inline(never)]
pub fn box_box(
    half_sizes: [Vector3<f64>; 2],
    place: &Place,
    margin: f64,
    scratch: &mut Scratch,
) -> Contacts<BOX_CONTACTS> {
    let pair = Pair { half_sizes, rotation: place.rotation, position: place.position };
    let slack = margin + ROUNDING * (half_sizes[0].sum() + half_sizes[1].sum());
    match pair.best_way(slack) {
        Err(Separated) => Contacts::default(),
        Ok(Way::Face { of, axis }) => pair.of_face(of, axis, margin, scratch),
        Ok(Way::Edges { axes, normal }) => pair.of_edges(axes, normal, slack),
    }
}

impl Pair {
    /// The same as seen from one of them.
    fn seen_from(&self, which: usize) -> Self {
        let [one, other] = self.half_sizes;
        if which == 0 {
            return Self { half_sizes: [one, other], rotation: self.rotation, position: self.position };
        }
        let rotation = self.rotation.transpose();
        Self { half_sizes: [other, one], rotation, position: -(rotation * self.position) }
    }

    /// How far they are apart along a unit direction (m).
    fn apart(&self, normal: &Vector3<f64>) -> f64 {
        let [one, other] = self.half_sizes;
        let turned = self.rotation.tr_mul(normal);
        normal.dot(&self.position).abs() - normal.abs().dot(&one) - turned.abs().dot(&other)
    }

    /// The direction along which they overlap least, if not more than `slack` (m) apart.
    fn best_way(&self, slack: f64) -> Result<Way, Separated> {
        let ([of, axis], face_apart) = self.best_face(slack)?;
        let face = Way::Face { of, axis };
        let Some(Across { axes, normal, apart }) = self.best_edges(slack, face_apart)? else { return Ok(face) };
        let across = if of == 0 { normal[axis] } else { self.rotation.column(axis).dot(&normal) };
        let is_alike = across.abs() > ALIKE_COSINE;
        let is_hardly_better = apart < face_apart + MUCH_BETTER * face_apart.abs() + NOTHING;
        Ok(if is_alike && is_hardly_better { face } else { Way::Edges { axes, normal } })
    }

    /// The best face, by its box and axis, and how far they are apart across it.
    fn best_face(&self, slack: f64) -> Result<([usize; 2], f64), Separated> {
        let mut best = ([0, 0], f64::NEG_INFINITY);
        for of in 0..2 {
            let seen = self.seen_from(of);
            for axis in 0..3 {
                let mut normal = Vector3::zeros();
                normal[axis] = 1.0;
                let apart = seen.apart(&normal);
                if apart > slack {
                    return Err(Separated);
                }
                if apart > best.1 {
                    best = ([of, axis], apart);
                }
            }
        }
        Ok(best)
    }

    /// The best pair of edges, if they are further apart than across the best face.
    fn best_edges(&self, slack: f64, face: f64) -> Result<Option<Across>, Separated> {
        let (mut best, mut found) = (face, None);
        for one in 0..3 {
            for other in 0..3 {
                let mut along = Vector3::zeros();
                along[one] = 1.0;
                let across = along.cross(&self.rotation.column(other));
                if across.norm_squared() < PARALLEL {
                    continue;
                }
                let normal = across.normalize();
                let apart = self.apart(&normal);
                if apart > slack {
                    return Err(Separated);
                }
                if apart - PREFERENCE * apart.abs() > best && apart > face {
                    (best, found) = (apart, Some(Across { axes: [one, other], normal, apart }));
                }
            }
        }
        Ok(found)
    }

    /// The point in which an edge of each touch.
    fn of_edges(&self, axes: [usize; 2], normal: Vector3<f64>, slack: f64) -> Contacts<BOX_CONTACTS> {
        let normal = if normal.dot(&self.position) < 0.0 { -normal } else { normal };
        let mut nearest: Option<[Vector3<f64>; 2]> = None;
        let [first, second] = self.half_sizes;
        for one in edges(&first, axes[0], &normal) {
            for other in edges(&second, axes[1], &-self.rotation.tr_mul(&normal)) {
                let points = self.between_edges(axes, one, self.rotation * other + self.position);
                let is_nearer =
                    nearest.is_none_or(|[a, b]| (points[1] - points[0]).norm_squared() < (b - a).norm_squared());
                if is_nearer {
                    nearest = Some(points);
                }
            }
        }
        let mut contacts = Contacts::default();
        if let Some([one, other]) = nearest {
            let distance = (other - one).dot(&normal);
            if distance <= slack {
                contacts.push(Contact { distance, at: 0.5 * (one + other), normal });
            }
        }
        contacts
    }

    /// The points of two edges, given by their middles (m), that are nearest to each other.
    fn between_edges(&self, [one, other]: [usize; 2], first: Vector3<f64>, second: Vector3<f64>) -> [Vector3<f64>; 2] {
        let [half, other_half] = [self.half_sizes[0][one], self.half_sizes[1][other]];
        let along = Vector3::from(self.rotation.column(other));
        let (between, cosine) = (second - first, along[one]);
        let (ahead, other_ahead) = (between[one], along.dot(&between));
        let square = 1.0 - cosine * cosine;
        let free = if square < NOTHING { 0.0 } else { (ahead - cosine * other_ahead) / square };
        let place = (cosine * free.clamp(-half, half) - other_ahead).clamp(-other_half, other_half);
        let mut point = first;
        point[one] += (ahead + cosine * place).clamp(-half, half);
        [point, second + place * along]
    }

    /// A face of one of them with what of the other's face is over it.
    fn of_face(&self, of: usize, axis: usize, margin: f64, scratch: &mut Scratch) -> Contacts<BOX_CONTACTS> {
        let seen = self.seen_from(of);
        let [size, _] = seen.half_sizes;
        let side = if seen.position[axis] >= 0.0 { 1.0 } else { -1.0 };
        // Corners as two places on the face and a height over it.
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let Scratch { corners, left, .. } = scratch;
        corners.clear();
        corners.extend(
            seen.facing(axis, side)
                .map(|corner| Vector3::new(corner[across[0]], corner[across[1]], side * corner[axis] - size[axis])),
        );
        for (place, &axis) in across.iter().enumerate() {
            for sign in [1.0, -1.0] {
                left.clear();
                cut(corners, place, sign, size[axis], left);
                std::mem::swap(corners, left);
            }
        }
        let same = SAME_CORNER * (size[across[0]].powi(2) + size[across[1]].powi(2));
        let mut normal = Vector3::zeros();
        normal[axis] = side;
        let mut contacts = Contacts::default();
        for (number, corner) in corners.iter().enumerate() {
            let is_same = |other: &Vector3<f64>| (other.xy() - corner.xy()).norm_squared() < same;
            if corner.z > margin || corners[..number].iter().any(|other| other.z <= margin && is_same(other)) {
                continue;
            }
            let mut at = Vector3::zeros();
            (at[across[0]], at[across[1]], at[axis]) = (corner.x, corner.y, side * (size[axis] + 0.5 * corner.z));
            contacts.push(self.unseen(of, Contact { distance: corner.z, at, normal }));
        }
        contacts
    }

    /// What is seen from one of them, as the first sees it.
    fn unseen(&self, of: usize, contact: Contact) -> Contact {
        if of == 0 {
            return contact;
        }
        let at = self.rotation * contact.at + self.position;
        Contact { at, normal: -(self.rotation * contact.normal), ..contact }
    }

    /// Corners of the second's face that faces the first's across an axis on a side the most, in turn.
    fn facing(&self, axis: usize, side: f64) -> [Vector3<f64>; 4] {
        let row = self.rotation.row(axis);
        let across = [1, 2].into_iter().fold(0, |best, k| if row[k].abs() > row[best].abs() { k } else { best });
        let towards = if side * row[across] > 0.0 { -1.0 } else { 1.0 };
        let [_, size] = self.half_sizes;
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[u, v]| {
            let mut corner = Vector3::zeros();
            corner[across] = towards * size[across];
            corner[(across + 1) % 3] = u * size[(across + 1) % 3];
            corner[(across + 2) % 3] = v * size[(across + 2) % 3];
            self.rotation * corner + self.position
        })
    }
}

/// Middles of the edges along an axis that are the furthest in a direction: one, or both where the direction does not tell.
fn edges(half_size: &Vector3<f64>, along: usize, direction: &Vector3<f64>) -> impl Iterator<Item = Vector3<f64>> {
    let [a, b] = [(along + 1) % 3, (along + 2) % 3];
    let mut middle = half_size.zip_map(direction, f64::copysign);
    middle[along] = 0.0;
    let undecided = [a, b].into_iter().find(|&axis| direction[axis].abs() < UNDECIDED);
    let other = undecided.map(|axis| {
        let mut other = middle;
        other[axis] = -other[axis];
        other
    });
    std::iter::once(middle).chain(other)
}

/// The part of a polygon within a limit (m) on one side.
///
/// I. Sutherland and G. Hodgman 1974 (doi 10.1145/360767.360802).
fn cut(polygon: &[Vector3<f64>], axis: usize, sign: f64, limit: f64, kept: &mut Vec<Vector3<f64>>) {
    let outside = |point: &Vector3<f64>| sign * point[axis] - limit;
    for (number, begin) in polygon.iter().enumerate() {
        let end = &polygon[(number + 1) % polygon.len()];
        let [from, to] = [begin, end].map(outside);
        if from <= 0.0 {
            kept.push(*begin);
        }
        if from * to < 0.0 {
            kept.push(begin + from / (from - to) * (end - begin));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Hull;
    use crate::mesh::placed::Placed;
    use crate::mesh::tests::Draws;
    use crate::mesh::touch::least_overlap;

    /// Two boxes that may touch.
    fn pair(draws: &mut Draws) -> ([Vector3<f64>; 2], Place) {
        let sizes = [0, 1].map(|_| draws.vector().map(|x| 0.11 + 0.09 * x));
        (sizes, draws.place(0.3))
    }

    fn distances(contacts: &Contacts<BOX_CONTACTS>) -> Vec<f64> {
        let mut all: Vec<f64> = contacts.iter().map(|contact| contact.distance).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    #[test]
    fn boxes_are_as_deep_in_each_other_as_hulls_of_their_corners() {
        let (mut scratch, mut hulls) = (Scratch::default(), Scratch::default());
        let (mut touching, mut draws) = ([0; 2], Draws(1));
        for number in 0..3000 {
            let (sizes, place) = pair(&mut draws);
            let contacts = box_box(sizes, &place, 0.0, &mut scratch);
            let [one, other] = sizes.map(|size| Hull::of_box(size.into()));
            let second = Placed { hull: &other, rotation: place.rotation, position: place.position };
            let depth = least_overlap(&Placed::at_rest(&one), &second, &mut hulls).depth;
            let Some(deepest) = distances(&contacts).first().copied() else {
                assert!(depth < 1e-12, "{number}: {depth} m deep, and no contact");
                continue;
            };
            // Several points are taken for one that is a twentieth better.
            let is_one = contacts.iter().count() == 1;
            touching[usize::from(is_one)] += 1;
            let most = depth * (1.0 + MUCH_BETTER) / (1.0 - MUCH_BETTER);
            assert!(
                -deepest <= most + 1e-12 && (!is_one || -deepest < depth * 1.06),
                "{number}: {deepest} and {depth} m"
            );
        }
        assert!(touching.iter().all(|&count| count > 300), "{touching:?}");
    }

    #[test]
    fn it_is_the_same_from_the_other_side() {
        let (mut scratch, mut draws) = (Scratch::default(), Draws(2));
        for number in 0..2000 {
            let (sizes, place) = pair(&mut draws);
            let contacts = box_box(sizes, &place, 0.003, &mut scratch);
            let rotation = place.rotation.transpose();
            let back = Place { rotation, position: -(rotation * place.position) };
            let mirrored = box_box([sizes[1], sizes[0]], &back, 0.003, &mut scratch);
            let [one, other] = [&contacts, &mirrored].map(distances);
            assert_eq!(one.len(), other.len(), "{number}");
            assert!(one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-12), "{number}: {one:?} {other:?}");
            for contact in contacts.iter() {
                let seen = rotation * (contact.at - place.position);
                let is_there = |other: &Contact| {
                    (other.at - seen).norm() < 1e-10 && (other.normal + rotation * contact.normal).norm() < 1e-10
                };
                assert!(mirrored.iter().any(is_there), "{number}: {contact:?}");
            }
        }
    }
}
