//! The least way out of two convex shapes that overlap, from points of their difference: all a - b, a being in the first and b in the second. How far that
//! reaches along a normal is how far they overlap along it, so the least way out is its face that is nearest to the origin.
//!
//! A closed surface of triangles between such points grows where it is nearest to the origin, until that is a face of the difference (G. van den Bergen 2001,
//! "Proximity queries and penetration depth computation on 3D game objects"). What is found is proved: if the planes of all triangles are so far from the origin,
//! on the right side of it, then every ray from there meets the surface no nearer, and the difference, which is convex and has its points, reaches no less far
//! along any normal. No matter from which points it grew.

use super::seed::POINTS;
use nalgebra::Vector3;

/// What a height may be off by rounding (m).
const ROUNDING: f64 = 1e-13;
/// Twice the least area of a triangle (m^2).
const NO_AREA: f64 = 1e-16;
/// Points that a surface begins with, how often it grows at most, and triangles that it has at most.
const FIRST: usize = 4;
const MOST_ROUNDS: usize = 60;
const MOST_FACES: usize = 160;

/// A point of the difference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub at: Vector3<f64>,
    /// Corners of both shapes that it is made of, as far as they have any.
    pub of: [usize; 2],
}

/// What tells points of a difference.
pub(super) trait Support {
    /// A point that may be the furthest along a direction, looked for from corners of the shapes on, if there are any.
    fn near(&self, direction: &Vector3<f64>, from: Option<[usize; 2]>) -> Point;
    /// The furthest point along a direction.
    fn surely(&self, direction: &Vector3<f64>) -> Point;
}

/// A triangle between three points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub corners: [usize; 3],
    /// Unit, outward.
    normal: Vector3<f64>,
    /// That of its lowest point along the normal (m).
    height: f64,
}

/// A closed surface.
#[derive(Clone, Debug)]
pub(super) struct Polytope {
    pub points: Vec<Point>,
    pub faces: Vec<Face>,
    /// Edges between what stays and what goes, as triangles that go have them.
    rim: Vec<[usize; 2]>,
}

/// What a surface grew into.
#[derive(Clone, Copy, Debug)]
pub(super) enum Grown {
    /// The origin is outside: along this normal the shapes are apart, by so much (m).
    Apart(Vector3<f64>, f64),
    /// It is inside.
    Least {
        /// Of the nearest triangle.
        normal: Vector3<f64>,
        /// No way out is shorter (m).
        least: f64,
        /// The way out along the normal (m).
        depth: f64,
        points: [Point; 3],
    },
}

impl Polytope {
    /// Memory for any.
    pub fn new() -> Self {
        Self {
            // It may begin with what is remembered.
            points: Vec::with_capacity(POINTS.max(FIRST) + MOST_ROUNDS),
            faces: Vec::with_capacity(MOST_FACES),
            rim: Vec::with_capacity(3 * MOST_FACES),
        }
    }

    /// Grows from a direction on until the least way out is known, but for a share of it. None if too many triangles are needed, or one that has no area.
    pub fn grown(&mut self, towards: &Vector3<f64>, share: f64, support: &impl Support) -> Option<Grown> {
        self.begin(towards, support)?;
        self.ripened(share, support)
    }

    /// The same of a surface that has begun.
    pub fn ripened(&mut self, share: f64, support: &impl Support) -> Option<Grown> {
        for _ in 0..MOST_ROUNDS {
            let nearest = self.nearest()?;
            let Face { normal, height: least, corners } = self.faces[nearest];
            let ends = |depth: f64| depth <= 0.0 || least >= 0.0 && depth - least <= ROUNDING + share * depth;
            let mut point = support.near(&normal, Some(self.points[corners[0]].of));
            if ends(point.at.dot(&normal)) {
                point = support.surely(&normal);
            }
            let depth = point.at.dot(&normal);
            if depth <= 0.0 {
                return Some(Grown::Apart(normal, -depth));
            }
            if ends(depth) {
                let points = corners.map(|corner| self.points[corner]);
                return Some(Grown::Least { normal, least, depth, points });
            }
            self.grow(nearest, point)?;
        }
        None
    }

    /// Normals of triangles whose planes are no further from the origin.
    pub fn within(&self, height: f64) -> impl Iterator<Item = &Vector3<f64>> {
        self.faces.iter().filter(move |face| face.height <= height + ROUNDING).map(|face| &face.normal)
    }

    pub fn clear(&mut self) {
        self.points.clear();
        self.faces.clear();
    }

    /// A tetrahedron.
    fn begin(&mut self, towards: &Vector3<f64>, support: &impl Support) -> Option<()> {
        self.clear();
        self.points.extend(around(towards).map(|direction| support.near(&direction, None)));
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.points[k].at);
        let is_turned = (b - a).cross(&(c - a)).dot(&(d - a)) < 0.0;
        for [a, b, c] in [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]] {
            self.add(if is_turned { [a, c, b] } else { [a, b, c] })?;
        }
        Some(())
    }

    /// Adds a triangle and tells its height (m).
    pub fn add(&mut self, corners: [usize; 3]) -> Option<f64> {
        if self.faces.len() == MOST_FACES {
            return None;
        }
        let [a, b, c] = corners.map(|corner| self.points[corner].at);
        let normal = (b - a).cross(&(c - a)).try_normalize(NO_AREA)?;
        let height = a.dot(&normal).min(b.dot(&normal)).min(c.dot(&normal));
        self.faces.push(Face { corners, normal, height });
        Some(height)
    }

    /// The triangle whose plane is nearest to the origin, or, where that is outside, furthest on its wrong side.
    fn nearest(&self) -> Option<usize> {
        let heights = self.faces.iter().map(|face| face.height).enumerate();
        let (nearest, height) = heights.min_by(|a, b| a.1.total_cmp(&b.1))?;
        height.is_finite().then_some(nearest)
    }

    /// Adds a point that is beyond a triangle, in the place of all that it is beyond.
    fn grow(&mut self, beyond: usize, point: Point) -> Option<()> {
        let Self { points, faces, rim } = self;
        rim.clear();
        let mut number = 0;
        faces.retain(|face| {
            let over = (point.at - points[face.corners[0]].at).dot(&face.normal);
            let stays = number != beyond && over <= ROUNDING;
            number += 1;
            if !stays {
                cut(face, rim);
            }
            stays
        });
        let number = points.len();
        points.push(point);
        (0..self.rim.len()).try_for_each(|side| {
            let [from, to] = self.rim[side];
            self.add([from, to, number]).map(drop)
        })
    }
}

/// Adds the edges of a triangle to those around others; what is between two of them is on none's rim.
fn cut(face: &Face, rim: &mut Vec<[usize; 2]>) {
    let [a, b, c] = face.corners;
    for [from, to] in [[a, b], [b, c], [c, a]] {
        match rim.iter().position(|&edge| edge == [to, from]) {
            Some(back) => _ = rim.swap_remove(back),
            None => rim.push([from, to]),
        }
    }
}

/// Directions from the middle of a regular tetrahedron to its corners, the first of which is given, if it is one.
fn around(first: &Vector3<f64>) -> [Vector3<f64>; FIRST] {
    let first = first.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector3::z);
    // Square to it, beside the axis that it is furthest from.
    let across = first.cross(&Vector3::ith(first.iamin(), 1.0)).normalize();
    let third = first.cross(&across);
    let [out, half, aside] = [8.0_f64.sqrt() / 3.0, 2.0_f64.sqrt() / 3.0, (2.0_f64 / 3.0).sqrt()];
    let back = -first / 3.0;
    [first, back + out * across, back - half * across + aside * third, back - half * across - aside * third]
}
