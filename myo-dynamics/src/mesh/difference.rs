//! The least way out of two hulls that overlap, by their difference: a triangle of one and a vertex of the other, or two edges, are a face of it.

use super::placed::{Feature, Placed};
use super::polytope::{Grown, Point, Support};
use super::scratch::{Arc, Scratch};
use super::touch::{Touch, nearest};
use nalgebra::Vector3;

/// What the depth of a face may be off from that of three points of it, where axes are turned in single precision (m).
const ROUNDING: f64 = 1e-6;

/// Two hulls.
struct Hulls<'a> {
    one: &'a Placed<'a>,
    other: &'a Placed<'a>,
}

impl Hulls<'_> {
    fn point(&self, of: [usize; 2]) -> Point {
        Point { at: self.one.vertex(of[0]) - self.other.vertex(of[1]), of }
    }
}

impl Support for Hulls<'_> {
    fn near(&self, direction: &Vector3<f64>, from: Option<[usize; 2]>) -> Point {
        let [from, other_from] = [0, 1].map(|side| from.map(|of| of[side]));
        self.point([self.one.climbed(direction, from), self.other.climbed(&-direction, other_from)])
    }

    fn surely(&self, direction: &Vector3<f64>) -> Point {
        self.point([self.one.furthest(direction), self.other.furthest(&-direction)])
    }
}

/// The least way out of two hulls, looked for from a direction on; if they are apart, a direction along which they are, with a negative depth and no features. None
/// if what is found is no face, as where triangles lie in one plane.
pub(super) fn least(
    one: &Placed<'_>,
    other: &Placed<'_>,
    towards: &Vector3<f64>,
    scratch: &mut Scratch,
) -> Option<Touch> {
    match grown(one, other, towards, scratch)? {
        Grown::Apart(normal, gap) => Some(Touch { depth: -gap, ..Touch::none(&normal) }),
        Grown::Least { normal, least, points, .. } => {
            of_face(one, other, &normal, &points).filter(|touch| touch.depth <= least + ROUNDING)
        }
    }
}

/// What grows of what is remembered, or else anew.
fn grown(one: &Placed<'_>, other: &Placed<'_>, towards: &Vector3<f64>, scratch: &mut Scratch) -> Option<Grown> {
    let (polytope, seed) = scratch.remembered();
    let (hulls, counts) = (Hulls { one, other }, [one, other].map(|placed| placed.hull.vertices.len()));
    let is_sown = seed.sow(counts, polytope, |of| hulls.point(of));
    let grown = if is_sown { polytope.ripened(0.0, &hulls) } else { None };
    let grown = grown.or_else(|| polytope.grown(towards, 0.0, &hulls))?;
    seed.keep(counts, polytope);
    Some(grown)
}

/// The touch along a face of the difference, by three points of it.
fn of_face(one: &Placed<'_>, other: &Placed<'_>, normal: &Vector3<f64>, points: &[Point; 3]) -> Option<Touch> {
    let [corners, other_corners] = [0, 1].map(|side| points.map(|point| point.of[side]));
    match [distinct(&corners), distinct(&other_corners)] {
        [(_, 3), (_, 1)] => vertex_in_face(one, other, corners, other_corners[0]),
        [(_, 1), (_, 3)] => vertex_in_face(other, one, other_corners, corners[0]).map(Touch::swapped),
        [(ends, 2), (other_ends, 2)] => edge_on_edge([one, other], [ends, other_ends], normal),
        _ => None,
    }
}

/// Two of three numbers that differ, if any do, and how many do.
fn distinct(&[a, b, c]: &[usize; 3]) -> ([usize; 2], usize) {
    let second = if b == a { c } else { b };
    let count = 1 + usize::from(b != a) + usize::from(c != a && c != b);
    ([a, second], count)
}

/// A vertex of the other hull behind the triangle that has three corners, if one has.
fn vertex_in_face(one: &Placed<'_>, other: &Placed<'_>, corners: [usize; 3], vertex: usize) -> Option<Touch> {
    let has_all = |&&face: &&usize| corners.iter().all(|corner| one.hull.triangles[face].corners.contains(corner));
    let &face = one.hull.triangles_around[corners[0]].iter().find(has_all)?;
    let (triangle, normal, second) = (&one.hull.triangles[face], one.triangle_normal(face), other.vertex(vertex));
    let depth = triangle.height - triangle.normal.dot(&one.seen(&second));
    let features = [Feature::triangle(triangle.corners), Feature::vertex(vertex)];
    Some(Touch { depth, normal, points: [second + depth * normal, second], features })
}

/// Two edges, if corners are the ends of one each.
fn edge_on_edge(placed: [&Placed<'_>; 2], ends: [[usize; 2]; 2], towards: &Vector3<f64>) -> Option<Touch> {
    let (arc, other) = (arc(placed[0], ends[0])?, arc(placed[1], ends[1])?);
    let across = arc.along.cross(&other.along).normalize();
    let normal = across * across.dot(towards).signum();
    let depth = (arc.point - other.point).dot(&normal);
    let ends = [placed[0].hull.edges[arc.edge].ends, placed[1].hull.edges[other.edge].ends];
    Some(Touch { depth, normal, points: nearest(&arc, &other), features: ends.map(Feature::edge) })
}

/// The edge between two corners, without its normals.
fn arc(placed: &Placed<'_>, [from, to]: [usize; 2]) -> Option<Arc> {
    let is_this = |&&edge: &&usize| placed.hull.edges[edge].ends.contains(&to);
    let &edge = placed.hull.edges_around[from].iter().find(is_this)?;
    let [begin, end] = placed.hull.edges[edge].ends.map(|end| placed.vertex(end));
    let none = Vector3::zeros();
    Some(Arc { edge, point: begin, along: end - begin, begin: none, end: none, turn: 0.0 })
}
