//! A cylinder and a convex mesh. An end of the cylinder counts as a vertex that has one face, of sixteen corners; the side as an edge that has none.

use super::cap::Cap;
use super::contacts::{Contacts, several, single};
use super::descent::{Descent, Two};
use super::face::{Side, edge_on_face, on_each_other};
use super::placed::{Feature, Placed};
use super::polytope::Grown;
use super::round::{Round, Search, across, at_second};
use super::scratch::Scratch;
use super::touch::Touch;
use nalgebra::Vector3;

/// A normal is level, that is, square to the axis, if its cosine with it is less.
const LEVEL: f64 = 1e-9;
/// The cylinder stands on its end if the cosine between its axis and the normal of the touch is this near to one.
const STANDING: f64 = 1e-12;
/// A direction this near to the axis (squares of lengths) has the middle of an end for its furthest point.
const STRAIGHT: f64 = 1e-15;

/// The share of the least overlap that is left for the walk around it.
const ENOUGH: f64 = 0.05;

/// A cylinder about z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cylinder {
    pub radius: f64,
    pub half_length: f64,
}

impl Round for Cylinder {
    fn furthest(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        let length = (direction.x * direction.x + direction.y * direction.y).sqrt();
        let scale = if length > STRAIGHT { self.radius / length } else { 0.0 };
        Vector3::new(direction.x * scale, direction.y * scale, self.half_length * outward(direction))
    }
}

/// Which end a direction points out of: 1 along the axis, -1 against it.
fn outward(direction: &Vector3<f64>) -> f64 {
    if direction.z >= 0.0 { 1.0 } else { -1.0 }
}

impl Cylinder {
    /// Contacts with a mesh, up to a margin (m).
    ///
    /// Where the cylinder stands on a vertex, MuJoCo tries a line of its side that is left over from its search. If that lies along a steep face, all of it is
    /// clipped away, as good as always, and the single contact stays.
    pub fn contacts(
        &self,
        mesh: &Placed<'_>,
        towards: &mut Vector3<f64>,
        margin: f64,
        scratch: &mut Scratch,
    ) -> Contacts {
        let touch = self.nearest(mesh, towards, scratch);
        *towards = touch.normal;
        if touch.depth <= -margin {
            return Contacts::default();
        }
        let (normal, feature) = (touch.normal, touch.features[1]);
        let upright = normal.z.abs();
        let end = Cap { radius: self.radius, half_length: self.half_length, outward: outward(&normal) };
        let own = Side::Cylinder((upright >= LEVEL).then_some(end), self.side_line(&normal));
        let other = Side::Hull(mesh, feature);
        let stands = upright > 1.0 - STANDING && feature.size == 1;
        if stands && on_each_other(&own, &other, &normal).is_none() && edge_on_face(&own, &other, &-normal).is_some() {
            return single(&touch, 0.0);
        }
        several(&touch, [&own, &other], margin, scratch)
    }

    /// The line of the side that a normal points out of, from its end to the other.
    fn side_line(&self, normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let on_rim = self.furthest(normal);
        [on_rim, Vector3::new(on_rim.x, on_rim.y, -on_rim.z)]
    }

    /// Where it and a mesh touch, or are nearest to each other, found from a direction on.
    pub(super) fn nearest(&self, mesh: &Placed<'_>, towards: &Vector3<f64>, scratch: &mut Scratch) -> Touch {
        self.over_end(mesh).unwrap_or_else(|| self.beside(mesh, towards, scratch))
    }

    /// Where a mesh is right over one of the ends: nothing is nearer than the lowest vertex there and its foot.
    fn over_end(&self, mesh: &Placed<'_>) -> Option<Touch> {
        let normal = Vector3::new(0.0, 0.0, outward(&mesh.position));
        let depth_of = |second: &Vector3<f64>| self.half_length - second.dot(&normal);
        // What a walk finds is enough to tell that it is not.
        if depth_of(&mesh.vertex(mesh.climbed(&-normal, None))) > 0.0 {
            return None;
        }
        let lowest = mesh.furthest(&-normal);
        let second = mesh.vertex(lowest);
        let depth = depth_of(&second);
        let is_over = depth <= 0.0 && second.x * second.x + second.y * second.y <= self.radius * self.radius;
        is_over.then(|| at_second(normal, depth, second, Feature::vertex(lowest)))
    }

    /// The same of a mesh that is anywhere.
    fn beside(&self, mesh: &Placed<'_>, towards: &Vector3<f64>, scratch: &mut Scratch) -> Touch {
        let overlap = |corner: usize| (self.furthest(towards) - mesh.vertex(corner)).dot(towards);
        let climbed = overlap(mesh.climbed(&-towards, None));
        if climbed < 0.0 && overlap(mesh.furthest(&-towards)) < 0.0 {
            return self.walk(Descent::apart(self, mesh, towards, &mut scratch.walked));
        }
        let grown = scratch.polytope.grown(towards, ENOUGH, &Two { shape: self, hull: mesh });
        let Scratch { polytope, walked, .. } = scratch;
        match grown {
            None => self.touch(mesh, scratch),
            Some(Grown::Apart(normal, _)) => self.walk(Descent::apart(self, mesh, &normal, walked)),
            Some(Grown::Least { depth, .. }) => {
                self.walk(Descent::overlapping(self, mesh, polytope.within(depth), walked))
            }
        }
    }

    /// The least overlap that a walk finds.
    fn walk(&self, mut descent: Descent<'_, Self>) -> Touch {
        while let Some(corner) = descent.next() {
            let vertex = descent.hull.vertex(corner);
            descent.at_faces(corner);
            let ends = [Vector3::z(), -Vector3::z()];
            for normal in ends.into_iter().chain(across(&vertex)).chain(self.off_rim(&vertex)) {
                descent.at_vertex(&normal, corner);
            }
            descent.at_edges(corner, &Vector3::z(), |normal| self.radius * normal, |normal| normal.z.abs() > LEVEL);
        }
        descent.best
    }

    /// Where it and a mesh touch, wherever they are, by trying everything.
    pub(super) fn touch(&self, mesh: &Placed<'_>, scratch: &mut Scratch) -> Touch {
        let mut search = Search::new(self, mesh, scratch);
        for normal in [Vector3::z(), -Vector3::z()] {
            search.at_vertex(&normal, search.deepest(&normal));
        }
        for (number, vertex) in search.vertices().iter().enumerate() {
            if let Some(normal) = across(vertex) {
                search.at_vertex(&normal, number);
            }
            if let Some(normal) = self.off_rim(vertex) {
                search.at_vertex(&normal, number);
            }
        }
        search.along_line(&Vector3::z(), |normal| self.radius * normal);
        search.along_arcs(|normal| normal.z.abs() > LEVEL);
        search.best
    }

    /// The normal from the rim to a point that is beyond both the side and an end.
    fn off_rim(&self, point: &Vector3<f64>) -> Option<Vector3<f64>> {
        let from_axis = point.x.hypot(point.y);
        let is_beyond = from_axis > self.radius && point.z.abs() > self.half_length;
        let scale = self.radius / from_axis;
        let on_rim = Vector3::new(point.x * scale, point.y * scale, self.half_length.copysign(point.z));
        is_beyond.then(|| (point - on_rim).normalize())
    }
}
