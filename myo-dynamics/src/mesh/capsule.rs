//! A capsule, or a ball, and a convex mesh: the axis and the hull touch, or are apart, and the radius is added. A capsule lies on a face with the line of its surface, half
//! a margin outside; it has no faces of its own.

use super::apart::{ROUNDING, is_over, nearest, part_of_edge};
use super::contacts::{Contacts, Lying, of_edge, single};
use super::face::{Side, edge_on_face};
use super::placed::{Feature, Placed};
use super::round::{Round, Search};
use super::scratch::Scratch;
use super::touch::{Touch, are_quickly_apart};
use nalgebra::Vector3;

/// A capsule about z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capsule {
    pub radius: f64,
    pub half_length: f64,
}

/// Its axis.
impl Round for Capsule {
    fn furthest(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(0.0, 0.0, if direction.z > 0.0 { self.half_length } else { -self.half_length })
    }
}

impl Capsule {
    /// Contacts with a mesh, up to a margin (m).
    pub fn contacts(
        &self,
        mesh: &Placed<'_>,
        towards: &mut Vector3<f64>,
        margin: f64,
        scratch: &mut Scratch,
    ) -> Contacts {
        let axis = |direction: &Vector3<f64>| self.furthest(direction);
        if are_quickly_apart(axis, mesh, *towards, self.radius + margin) {
            return Contacts::default();
        }
        let touch = self.touch(mesh, scratch);
        *towards = touch.normal;
        if touch.depth + self.radius <= -margin {
            return Contacts::default();
        }
        let half = 0.5 * margin;
        let line = Side::Cylinder(None, self.line(self.radius + half, &touch.normal));
        let found = edge_on_face(&line, &Side::Hull(mesh, touch.features[1]), &-touch.normal);
        let lying = Lying { margin: half, sign: -1.0, outset: half };
        let contacts = found.map(|(ends, face)| of_edge(&ends, &face, &lying, scratch)).unwrap_or_default();
        if contacts.is_empty() { single(&touch, self.radius) } else { contacts }
    }

    /// The axis moved by a height times what of a direction is square to it.
    fn line(&self, height: f64, direction: &Vector3<f64>) -> [Vector3<f64>; 2] {
        self.ends().map(|end| end + height * Vector3::new(direction.x, direction.y, 0.0))
    }

    fn ends(&self) -> [Vector3<f64>; 2] {
        [-self.half_length, self.half_length].map(|z| Vector3::new(0.0, 0.0, z))
    }

    /// Where the axis and a mesh touch, wherever they are.
    fn touch(&self, mesh: &Placed<'_>, scratch: &mut Scratch) -> Touch {
        let mut search = Search::new(self, mesh, scratch);
        search.along_line(&Vector3::z(), |_| Vector3::zeros());
        if search.best.depth > 0.0 { search.best } else { self.apart(mesh) }
    }

    /// The nearest points of the axis and a mesh that are apart.
    fn apart(&self, mesh: &Placed<'_>) -> Touch {
        let edges = self.nearest_edge(mesh);
        let faces = self.nearest_face(mesh);
        // A face is named before the edges that bound it.
        faces.filter(|faces| faces.depth >= edges.depth - ROUNDING).unwrap_or(edges)
    }

    /// The edge of a mesh that is nearest to the axis.
    fn nearest_edge(&self, mesh: &Placed<'_>) -> Touch {
        let origin = Vector3::zeros();
        let none = Feature::vertex(0);
        let mut best =
            Touch { depth: f64::NEG_INFINITY, normal: Vector3::z(), points: [origin; 2], features: [none; 2] };
        for edge in &mesh.hull.edges {
            let (points, [_, place]) = nearest(&self.ends(), &edge.ends.map(|end| mesh.vertex(end)));
            let between = points[1] - points[0];
            let distance = between.norm();
            if -distance > best.depth && distance > 0.0 {
                let features = [none, part_of_edge(edge.ends, place)];
                best = Touch { depth: -distance, normal: between / distance, points, features };
            }
        }
        best
    }

    /// The triangle of a mesh that is nearest to an end of the axis, of those that it is right over.
    fn nearest_face(&self, mesh: &Placed<'_>) -> Option<Touch> {
        let mut best: Option<Touch> = None;
        for first in self.ends() {
            let seen = mesh.seen(&first);
            for (number, triangle) in mesh.hull.triangles.iter().enumerate() {
                let height = triangle.normal.dot(&seen) - triangle.height;
                let is_nearer = height > 0.0 && best.is_none_or(|best| -height > best.depth);
                let corners = triangle.corners.map(|corner| mesh.hull.vertices[corner]);
                if is_nearer && is_over(&corners, &triangle.normal, &seen) {
                    let normal = mesh.triangle_normal(number);
                    let features = [Feature::vertex(0), Feature::triangle(triangle.corners)];
                    let points = [first, first - height * normal];
                    best = Some(Touch { depth: -height, normal: -normal, points, features });
                }
            }
        }
        best
    }
}
