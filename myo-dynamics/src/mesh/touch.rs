//! Where two hulls touch: the least way out of each other.
//!
//! It is the least over normals of the faces of one, with what of the other is deepest behind them, both ways, and over normals of pairs of
//! edges whose arcs on the sphere of directions cross. Their [difference](difference) tells it quickly, or else, if a face of that is none of these, all are looked
//! at: most edges are ruled out before they are paired.

use super::difference;
use super::placed::{Feature, Placed};
use super::scratch::{Arc, Scratch};
use nalgebra::Vector3;

/// Steps of the quick search for a direction along which two hulls are apart.
const QUICK_STEPS: usize = 12;

/// The least way out of each other, or, with a negative depth, the least distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub depth: f64,
    /// Unit, from the first to the second.
    pub normal: Vector3<f64>,
    /// The points that touch.
    pub points: [Vector3<f64>; 2],
    /// What they are parts of.
    pub features: [Feature; 2],
}

impl Touch {
    pub fn swapped(self) -> Self {
        let ([first, second], [one, other]) = (self.points, self.features);
        Self { depth: self.depth, normal: -self.normal, points: [second, first], features: [other, one] }
    }
}

/// How two hulls touch that overlap or are less than `reach` (m) apart; else a direction along which they are apart at least that much.
pub(super) fn hulls(
    one: &Placed<'_>,
    other: &Placed<'_>,
    towards: &Vector3<f64>,
    reach: f64,
    scratch: &mut Scratch,
) -> Touch {
    let found = difference::least(one, other, towards, scratch);
    let touch = found.unwrap_or_else(|| least_overlap(one, other, scratch));
    if touch.depth > 0.0 || touch.depth <= -reach {
        return touch;
    }
    let nearest = super::apart::apart(one, other, &touch.normal, reach);
    // What is out of reach has no nearest points here.
    if nearest.depth.is_finite() { nearest } else { Touch { depth: -reach, ..touch } }
}

/// Whether a few steps, the first in a direction from a shape to a hull, find one along which they are at least `reach` apart. Of each direction the
/// points that are nearest along it tell a better one (K. Chung and W. Wang 1996, doi 10.1145/3304181.3304186).
pub(super) fn are_quickly_apart(
    furthest: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    hull: &Placed<'_>,
    mut direction: Vector3<f64>,
    reach: f64,
) -> bool {
    for _ in 0..QUICK_STEPS {
        let length = direction.norm();
        if length <= f64::MIN_POSITIVE {
            return false;
        }
        direction /= length;
        let between = hull.vertex(hull.furthest(&-direction)) - furthest(&direction);
        let gap = between.dot(&direction);
        if gap >= reach && gap > 0.0 {
            return true;
        }
        let square = between.norm_squared();
        if square <= f64::MIN_POSITIVE {
            return false;
        }
        direction -= between * (2.0 * gap / square);
    }
    false
}

/// The least overlap over faces, and over edges if it is one at all.
pub(super) fn least_overlap(one: &Placed<'_>, other: &Placed<'_>, scratch: &mut Scratch) -> Touch {
    let Scratch { least, deep: [deep, other_deep], arcs: [arcs, other_arcs], .. } = scratch;
    let first = face_in_vertex(one, other, least, deep);
    let second = face_in_vertex(other, one, least, other_deep).swapped();
    let faces = if second.depth < first.depth { second } else { first };
    if faces.depth <= 0.0 {
        return faces;
    }
    near_edges(one, other, deep, faces.depth, arcs);
    near_edges(other, one, other_deep, faces.depth, other_arcs);
    edge_in_edge(one, other, [arcs, other_arcs], faces.depth).unwrap_or(faces)
}

/// The face of one hull that is the least way to push a vertex of the other out of it.
///
/// Each point of the other tells of every face how deep it is behind it at least. The face for which this is least is looked at, until what is deepest
/// behind it is known already: then no face has less. These points are left in `deep`.
fn face_in_vertex(one: &Placed<'_>, other: &Placed<'_>, least: &mut Vec<f64>, deep: &mut Vec<Vector3<f64>>) -> Touch {
    least.clear();
    least.resize(one.hull.triangles.len(), f64::NEG_INFINITY);
    deep.clear();
    let mut vertex = other.furthest(&(one.position - other.position));
    loop {
        let second = other.vertex(vertex);
        deep.push(second);
        let seen = one.seen(&second);
        let (mut face, mut depth) = (0, f64::INFINITY);
        for (number, (triangle, least)) in one.hull.triangles.iter().zip(least.iter_mut()).enumerate() {
            *least = least.max(triangle.height - triangle.normal.dot(&seen));
            if *least < depth {
                (face, depth) = (number, *least);
            }
        }
        let normal = one.triangle_normal(face);
        vertex = other.furthest(&-normal);
        let second = other.vertex(vertex);
        // Numbers that are none are never known already; there are no more points than corners.
        if deep.contains(&second) || deep.len() > other.hull.vertices.len() {
            let features = [Feature::triangle(one.hull.triangles[face].corners), Feature::vertex(vertex)];
            return Touch { depth, normal, points: [second + depth * normal, second], features };
        }
    }
}

/// Edges of one hull along whose arcs of normals it may overlap the other by less than `least` (m), as far as points of the other tell. `deep` are some, and
/// become more.
///
/// Along a normal n of the arc the overlap is at least n (e - b), e on the edge and b any point of the other. That is, between normals at which
/// it is positive, no less than at both ends: n is shorter than what it is mixed of.
fn near_edges(one: &Placed<'_>, other: &Placed<'_>, deep: &mut Vec<Vector3<f64>>, least: f64, arcs: &mut Vec<Arc>) {
    arcs.clear();
    for (number, edge) in one.hull.edges.iter().enumerate() {
        let point = one.vertex(edge.ends[0]);
        let [begin, end] = edge.sides.map(|side| one.triangle_normal(side));
        let is_far = |deep: &Vector3<f64>| {
            let off = point - deep;
            begin.dot(&off) >= least && end.dot(&off) >= least
        };
        if deep.iter().rev().any(is_far) {
            continue;
        }
        let deepest = other.vertex(other.furthest(&-(begin + end)));
        if !deep.contains(&deepest) {
            deep.push(deepest);
            if is_far(&deepest) {
                continue;
            }
        }
        let along = one.vertex(edge.ends[1]) - point;
        let turn = begin.cross(&end).dot(&along).signum();
        arcs.push(Arc { edge: number, point, along, begin, end, turn });
    }
}

/// The pair of edges that is a way out of each other that is shorter than `least` (m), and the least.
fn edge_in_edge(
    one: &Placed<'_>,
    other: &Placed<'_>,
    [arcs, other_arcs]: [&[Arc]; 2],
    mut least: f64,
) -> Option<Touch> {
    let mut best = None;
    for arc in arcs {
        for other_arc in other_arcs {
            if !cross(arc, other_arc) {
                continue;
            }
            let normal = arc.along.cross(&other_arc.along).normalize();
            let normal = normal * normal.dot(&(arc.begin + arc.end)).signum();
            let overlap = (arc.point - other_arc.point).dot(&normal);
            if overlap < least {
                (least, best) = (overlap, Some((arc, other_arc, normal)));
            }
        }
    }
    let (arc, other_arc, normal) = best?;
    let points = nearest(arc, other_arc);
    let ends = [one.hull.edges[arc.edge].ends, other.hull.edges[other_arc.edge].ends];
    Some(Touch { depth: least, normal, points, features: ends.map(Feature::edge) })
}

/// Whether the arc of an edge and the opposite of another's cross: then their normal is that of a face of the Minkowski difference.
fn cross(arc: &Arc, other: &Arc) -> bool {
    let [side_begin, side_end] = [other.begin, other.end].map(|normal| -arc.along.dot(&normal));
    if side_begin * side_end >= 0.0 {
        return false;
    }
    let [other_side_begin, other_side_end] = [arc.begin, arc.end].map(|normal| other.along.dot(&normal));
    // Both on one half of the sphere.
    other_side_begin * other_side_end < 0.0 && side_end * arc.turn * other_side_begin * other.turn > 0.0
}

/// The points of two lines along edges that are nearest to each other.
pub(super) fn nearest(arc: &Arc, other: &Arc) -> [Vector3<f64>; 2] {
    let (u, v, between) = (arc.along, other.along, other.point - arc.point);
    let (uu, uv, vv) = (u.norm_squared(), u.dot(&v), v.norm_squared());
    let determinant = uu * vv - uv * uv;
    let (u_between, v_between) = (u.dot(&between), v.dot(&between));
    let s = (vv * u_between - uv * v_between) / determinant;
    let t = (uv * u_between - uu * v_between) / determinant;
    [arc.point + s * u, other.point + t * v]
}
