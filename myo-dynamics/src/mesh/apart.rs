//! The nearest points of two hulls that are apart, or of a segment and a hull.

use super::placed::{Feature, Placed};
use super::touch::Touch;
use nalgebra::Vector3;

/// What a distance may be off by rounding (m).
pub(super) const ROUNDING: f64 = 1e-12;

/// The part of a hull that can be near the other one: what is beyond a height along a direction.
struct Beyond<'a> {
    placed: &'a Placed<'a>,
    direction: Vector3<f64>,
    height: f64,
}

impl Beyond<'_> {
    fn has(&self, vertex: usize) -> bool {
        self.placed.vertex(vertex).dot(&self.direction) >= self.height
    }

    fn edges(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let edges = self.placed.hull.edges.iter().map(|edge| edge.ends);
        edges.filter(|ends| ends.iter().any(|&end| self.has(end)))
    }

    fn vertices(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.placed.hull.vertices.len()).filter(|&vertex| self.has(vertex))
    }

    /// Numbers of triangles.
    fn triangles(&self) -> impl Iterator<Item = usize> + '_ {
        let triangles = self.placed.hull.triangles.iter().enumerate();
        triangles.filter(|(_, triangle)| triangle.corners.iter().any(|&corner| self.has(corner))).map(|(k, _)| k)
    }
}

/// The nearest points of two hulls that a direction, from the first to the second, separates; right if they are less than `reach` (m) apart.
pub(super) fn apart(one: &Placed<'_>, other: &Placed<'_>, direction: &Vector3<f64>, reach: f64) -> Touch {
    let end = one.vertex(one.furthest(direction)).dot(direction);
    let begin = other.vertex(other.furthest(&-direction)).dot(direction);
    // Each point is at least as far from the other hull as from what separates it.
    let near = Beyond { placed: one, direction: *direction, height: begin - reach - ROUNDING };
    let other_near = Beyond { placed: other, direction: -direction, height: -end - reach - ROUNDING };
    let on_other = vertex_over_face(&near, &other_near);
    let on_one = vertex_over_face(&other_near, &near).map(Touch::swapped);
    let edges = edge_to_edge(&near, &other_near);
    let depths = [on_other, on_one, edges].into_iter().flatten().map(|touch| touch.depth);
    let best = depths.fold(f64::NEG_INFINITY, f64::max);
    // A face is named before the edges that bound it.
    let over = [on_other, on_one].into_iter().flatten().find(|touch| touch.depth >= best - ROUNDING);
    over.or(edges).unwrap_or_else(|| nothing(direction))
}

/// A touch of what is out of reach.
fn nothing(direction: &Vector3<f64>) -> Touch {
    let (none, origin) = (Feature::vertex(0), Vector3::zeros());
    Touch { depth: f64::NEG_INFINITY, normal: *direction, points: [origin; 2], features: [none; 2] }
}

/// The vertex of one that is nearest to a triangle of the other, of those right over it.
fn vertex_over_face(near: &Beyond<'_>, other_near: &Beyond<'_>) -> Option<Touch> {
    let (one, other) = (near.placed, other_near.placed);
    let mut best: Option<Touch> = None;
    for vertex in near.vertices() {
        let first = one.vertex(vertex);
        let seen = other.seen(&first);
        for number in other_near.triangles() {
            let triangle = &other.hull.triangles[number];
            let height = triangle.normal.dot(&seen) - triangle.height;
            let is_nearer = height > 0.0 && best.is_none_or(|best| -height > best.depth);
            if is_nearer
                && is_over(&triangle.corners.map(|corner| other.hull.vertices[corner]), &triangle.normal, &seen)
            {
                let normal = other.triangle_normal(number);
                let features = [Feature::vertex(vertex), Feature::triangle(triangle.corners)];
                let points = [first, first - height * normal];
                best = Some(Touch { depth: -height, normal: -normal, points, features });
            }
        }
    }
    best
}

/// Whether a point is right over or under a triangle.
pub(super) fn is_over(corners: &[Vector3<f64>; 3], normal: &Vector3<f64>, point: &Vector3<f64>) -> bool {
    (0..3).all(|side| {
        let (begin, end) = (corners[side], corners[(side + 1) % 3]);
        normal.cross(&(end - begin)).dot(&(point - begin)) >= 0.0
    })
}

/// The two edges that are nearest to each other.
fn edge_to_edge(near: &Beyond<'_>, other_near: &Beyond<'_>) -> Option<Touch> {
    let mut best: Option<Touch> = None;
    for ends in near.edges() {
        let segment = ends.map(|end| near.placed.vertex(end));
        for other_ends in other_near.edges() {
            let other_segment = other_ends.map(|end| other_near.placed.vertex(end));
            let (points, [s, t]) = nearest(&segment, &other_segment);
            let between = points[1] - points[0];
            let distance = between.norm();
            if distance > 0.0 && best.is_none_or(|best| -distance > best.depth) {
                let features = [part_of_edge(ends, s), part_of_edge(other_ends, t)];
                best = Some(Touch { depth: -distance, normal: between / distance, points, features });
            }
        }
    }
    best
}

/// The nearest points of two segments, and where on them they are, from 0 to 1.
pub(super) fn nearest(
    [begin, end]: &[Vector3<f64>; 2],
    [other_begin, other_end]: &[Vector3<f64>; 2],
) -> ([Vector3<f64>; 2], [f64; 2]) {
    let (edge, other_edge, between) = (end - begin, other_end - other_begin, begin - other_begin);
    let (square, other_square, mixed) = (edge.norm_squared(), other_edge.norm_squared(), edge.dot(&other_edge));
    let (along, other_along) = (between.dot(&edge), between.dot(&other_edge));
    let determinant = square * other_square - mixed * mixed;
    let free = (mixed * other_along - along * other_square) / determinant;
    let s = if determinant > 0.0 { free.clamp(0.0, 1.0) } else { 0.0 };
    let free = (mixed * s + other_along) / other_square;
    let t = free.clamp(0.0, 1.0);
    // A segment without length has one point.
    let s = if t == free || square == 0.0 { s } else { ((mixed * t - along) / square).clamp(0.0, 1.0) };
    ([begin + s * edge, other_begin + t * other_edge], [s, t])
}

/// What a point of an edge is a part of: an end, or the edge.
pub(super) fn part_of_edge(ends: [usize; 2], place: f64) -> Feature {
    if place == 0.0 {
        Feature::vertex(ends[0])
    } else if place == 1.0 {
        Feature::vertex(ends[1])
    } else {
        Feature::edge(ends)
    }
}
