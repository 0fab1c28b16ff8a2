//! A convex mesh where it is, and what of it takes part in a touch.

use super::hull::Hull;
use nalgebra::{Matrix3, Vector3};

/// Polygons that an edge, or a triangle, is a part of at most.
const MOST_FACES: [usize; 4] = [0, usize::MAX, 2, 1];

/// A hull in the frame of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'a> {
    pub hull: &'a Hull,
    pub rotation: Matrix3<f64>,
    /// Of its frame (m).
    pub position: Vector3<f64>,
}

impl<'a> Placed<'a> {
    /// In its own frame.
    pub fn at_rest(hull: &'a Hull) -> Self {
        Self { hull, rotation: Matrix3::identity(), position: Vector3::zeros() }
    }

    pub fn vertex(&self, number: usize) -> Vector3<f64> {
        self.rotation * self.hull.vertices[number] + self.position
    }

    /// Where a point is in the hull's own frame.
    pub fn seen(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(&(point - self.position))
    }

    pub fn triangle_normal(&self, number: usize) -> Vector3<f64> {
        self.rotation * self.hull.triangles[number].normal
    }

    /// The corner that is furthest in a direction.
    pub fn furthest(&self, direction: &Vector3<f64>) -> usize {
        self.hull.furthest(&self.rotation.tr_mul(direction))
    }
}

impl Placed<'_> {
    /// A corner than which no neighbour is further in a direction, see [`Hull::climbed`].
    pub fn climbed(&self, direction: &Vector3<f64>, from: Option<usize>) -> usize {
        self.hull.climbed(&self.rotation.tr_mul(direction), from)
    }
}

/// A vertex, an edge or a triangle of a hull, by one, two or three corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Feature {
    corners: [usize; 3],
    pub size: usize,
}

impl Feature {
    pub fn vertex(number: usize) -> Self {
        Self { corners: [number; 3], size: 1 }
    }

    /// One to three, some of them perhaps twice.
    pub fn corners(self) -> [usize; 3] {
        self.corners
    }

    pub fn edge([from, to]: [usize; 2]) -> Self {
        Self { corners: [from, to, to], size: 2 }
    }

    pub fn triangle(corners: [usize; 3]) -> Self {
        Self { corners, size: 3 }
    }

    /// Polygons of a hull that it belongs to: all around a vertex, at most two beside an edge, one of a triangle. An edge within a merged polygon
    /// has that alone.
    pub fn polygons(self, hull: &Hull) -> impl Iterator<Item = usize> + '_ {
        let has_all = move |&&number: &&usize| {
            let polygon = &hull.polygons[number].corners;
            // All around the first corner have that.
            self.corners[1..self.size].iter().all(|corner| polygon.contains(corner))
        };
        hull.around[self.corners[0]].iter().filter(has_all).take(MOST_FACES[self.size]).copied()
    }

    /// Ends of an edge itself, or of a vertex its edges; none of a triangle.
    pub fn edge_ends(self, hull: &Hull) -> impl Iterator<Item = [usize; 2]> + '_ {
        let [first, second, _] = self.corners;
        let own = (self.size == 2).then_some([first, second]);
        let others: &[usize] = if self.size == 1 { &hull.neighbours[first] } else { &[] };
        own.into_iter().chain(others.iter().map(move |&other| [first, other]))
    }
}
