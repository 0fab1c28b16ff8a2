//! What lies on what: faces of both shapes, and edges along them.

use super::cap::Cap;
use super::placed::{Feature, Placed};
use nalgebra::Vector3;

/// Two faces lie on each other if the cosine between one's normal and the other's opposite is greater: 5.13 degrees.
const FACING_COSINE: f64 = 0.996;
/// An edge lies along a face if its direction's cosine with the face's normal is less: 5.09 degrees. A face that lies on another has at least this
/// cosine with the direction towards it.
const LYING_COSINE: f64 = 0.0888;
/// A face is turned towards a direction if the cosine between it and the normal is greater.
const TURNED_COSINE: f64 = 1e-15;

/// A face of a shape.
#[derive(Clone, Copy, Debug)]
pub(super) enum Face<'a> {
    /// A polygon of a hull, by its number.
    Polygon(&'a Placed<'a>, usize),
    /// An end of a cylinder.
    Cap(Cap),
}

impl Face<'_> {
    /// How many corners there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Polygon(placed, number) => placed.hull.polygons[*number].corners.len(),
            Self::Cap(_) => super::cap::CAP_CORNERS,
        }
    }

    /// A corner (m); they are clockwise as seen from outside.
    pub fn corner(&self, number: usize) -> Vector3<f64> {
        match self {
            Self::Polygon(placed, polygon) => {
                let corners = &placed.hull.polygons[*polygon].corners;
                placed.vertex(corners[corners.len() - 1 - number])
            }
            Self::Cap(cap) => cap.corner(number),
        }
    }

    /// Unit, outward.
    pub fn normal(&self) -> Vector3<f64> {
        match self {
            Self::Polygon(placed, number) => placed.rotation * placed.hull.polygons[*number].normal,
            Self::Cap(cap) => cap.normal(),
        }
    }

    /// The plane that it lies in.
    pub fn plane(&self) -> Plane {
        Plane { corner: self.corner(0), normal: self.normal() }
    }
}

/// The plane of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// The first corner (m).
    pub corner: Vector3<f64>,
    /// Unit, outward.
    pub normal: Vector3<f64>,
}

impl Plane {
    /// How high a point is over it (m).
    pub fn height(&self, point: &Vector3<f64>) -> f64 {
        (point - self.corner).dot(&self.normal)
    }
}

/// What of a shape takes part in a touch.
#[derive(Clone, Copy, Debug)]
pub(super) enum Side<'a> {
    /// A part of a hull.
    Hull(&'a Placed<'a>, Feature),
    /// An end of a cylinder or none, and a line along its side.
    Cylinder(Option<Cap>, [Vector3<f64>; 2]),
}

impl<'a> Side<'a> {
    /// How many corners it counts as; the end of a cylinder is one, its side two.
    pub fn size(&self) -> usize {
        match self {
            Self::Hull(_, feature) => feature.size,
            Self::Cylinder(end, _) => {
                if end.is_some() {
                    1
                } else {
                    2
                }
            }
        }
    }

    /// Faces that may lie on something.
    pub fn faces(&self) -> impl Iterator<Item = Face<'a>> + '_ {
        let (hull, end) = match self {
            Self::Hull(placed, feature) => (Some((*placed, *feature)), None),
            Self::Cylinder(end, _) => (None, *end),
        };
        let polygons = hull
            .map(|(placed, feature)| feature.polygons(placed.hull).map(move |number| Face::Polygon(placed, number)));
        polygons.into_iter().flatten().chain(end.map(Face::Cap))
    }

    /// Edges that may lie along something, by their ends.
    pub fn edges(&self) -> impl Iterator<Item = [Vector3<f64>; 2]> + '_ {
        let (hull, line) = match self {
            Self::Hull(placed, feature) => (Some((*placed, *feature)), None),
            Self::Cylinder(_, line) => (None, Some(*line)),
        };
        let edges =
            hull.map(|(placed, feature)| feature.edge_ends(placed.hull).map(|ends| ends.map(|end| placed.vertex(end))));
        edges.into_iter().flatten().chain(line)
    }
}

/// The two faces that face each other most squarely, if any lie on each other.
pub(super) fn on_each_other<'a>(
    side: &Side<'a>,
    other: &Side<'a>,
    normal: &Vector3<f64>,
) -> Option<(Face<'a>, Face<'a>)> {
    let (mut best, mut found) = (-FACING_COSINE, None);
    for face in side.faces().filter(|face| face.normal().dot(normal) > LYING_COSINE) {
        for other in other.faces().filter(|other| other.normal().dot(normal) < -LYING_COSINE) {
            let cosine = face.normal().dot(&other.normal());
            if cosine < best {
                (best, found) = (cosine, Some((face, other)));
            }
        }
    }
    found
}

/// The first face of one side that is turned towards a direction and that an edge of the other lies along, behind the first such edge.
pub(super) fn edge_on_face<'a>(
    edges: &Side<'_>,
    faces: &Side<'a>,
    towards: &Vector3<f64>,
) -> Option<([Vector3<f64>; 2], Face<'a>)> {
    faces.faces().filter(|face| face.normal().dot(towards) > TURNED_COSINE).find_map(|face| {
        let normal = face.normal();
        let lies = |[from, to]: &[Vector3<f64>; 2]| (to - from).normalize().dot(&normal).abs() < LYING_COSINE;
        edges.edges().find(lies).map(|edge| (edge, face))
    })
}
