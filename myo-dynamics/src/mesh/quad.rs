//! Four of many corners: a walk that moves corners on as long as the quadrilateral grows, as MuJoCo does it. It is a local search, and ends now and then
//! below the largest, or with a corner twice.

use nalgebra::Vector3;

/// Numbers of four corners.
type Quad = [usize; 4];

/// The corners of a convex polygon.
struct Corners<F> {
    at: F,
    count: usize,
}

impl<F: Fn(usize) -> Vector3<f64>> Corners<F> {
    fn area(&self, quad: Quad) -> f64 {
        let [a, b, c, d] = quad.map(&self.at);
        0.5 * (c - a).cross(&(d - b)).norm()
    }

    /// Moves one corner on to the next point as long as the area grows; whether it moved at all.
    fn moves(&self, quad: &mut Quad, area: &mut f64, corner: usize) -> bool {
        let mut moved = *quad;
        moved[corner] = (moved[corner] + 1) % self.count;
        let larger = self.area(moved);
        let grows = larger > *area;
        if grows {
            (*quad, *area) = (moved, larger);
        }
        grows
    }

    /// Moves all corners but the first.
    fn grow(&self, quad: &mut Quad, area: &mut f64) {
        while self.moves(quad, area, 3) {
            for corner in [2, 1] {
                while self.moves(quad, area, corner) {}
            }
        }
    }
}

/// Four corners of a convex polygon of at least four with which a quadrilateral through one of them becomes large.
pub(super) fn through(count: usize, first: usize, at: impl Fn(usize) -> Vector3<f64>) -> Quad {
    let corners = Corners { at, count };
    let mut quad = [0, 1, 2, 3].map(|k| (first + k) % count);
    let mut area = corners.area(quad);
    corners.grow(&mut quad, &mut area);
    quad
}

/// Four of at least four corners of a convex polygon that span a large quadrilateral, nearly always the largest. One corner goes all round and pushes the
/// others, as calipers turn.
pub(super) fn large(points: &[Vector3<f64>]) -> Quad {
    let corners = Corners { at: |number: usize| points[number], count: points.len() };
    let mut quad = [0, 1, 2, 3];
    let (mut best, mut area) = (quad, corners.area(quad));
    for first in 0..points.len() {
        quad[0] = first;
        let mut larger = area;
        corners.grow(&mut quad, &mut larger);
        if larger > area {
            (best, area) = (quad, larger);
        }
        for corner in 1..4 {
            if quad[corner] != quad[corner - 1] {
                break;
            }
            quad[corner] = (quad[corner] + 1) % points.len();
        }
    }
    best
}
