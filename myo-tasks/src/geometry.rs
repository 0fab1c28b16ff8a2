//! Distances between regions and boxes, and points spread evenly without chance.

use nalgebra::Vector3;

use crate::target::Region;

/// Greatest distance in m between a point of `a` and a point of `b`.
pub(crate) fn farthest(a: &Region, b: &Region) -> f64 {
    let axis = |a: crate::Range, b: crate::Range| (b.max - a.min).max(a.max - b.min);
    norm([axis(a.x, b.x), axis(a.y, b.y), axis(a.z, b.z)])
}

/// Over all points of `from`: the least of the distances in m to the farthest point of `to`.
///
/// The farthest point is a corner, so each axis counts for itself: `|p - c| + w / 2` with centre `c` and width `w` of
/// `to`; the least is reached at the point of `from` nearest to `c`.
pub(crate) fn farthest_at_worst(from: &Region, to: &Region) -> f64 {
    let axis = |from: crate::Range, to: crate::Range| {
        let c = to.centre();
        (c.clamp(from.min, from.max) - c).abs() + 0.5 * to.width()
    };
    norm([axis(from.x, to.x), axis(from.y, to.y), axis(from.z, to.z)])
}

/// Point `k` of a sequence that fills the unit cube evenly (Halton 1960), the same on every run; in at most six dimensions.
///
/// Only points in a row are spread evenly: every second one, say, lies in one half of the cube.
pub fn spread<const N: usize>(k: u32) -> [f64; N] {
    const PRIMES: [u32; 6] = [2, 3, 5, 7, 11, 13];
    const { assert!(N <= PRIMES.len()) };
    std::array::from_fn(|i| radical_inverse(k + 1, PRIMES[i]))
}

fn radical_inverse(mut k: u32, base: u32) -> f64 {
    let (mut sum, mut scale) = (0.0, 1.0);
    while k > 0 {
        scale /= f64::from(base);
        sum += scale * f64::from(k % base);
        k /= base;
    }
    sum
}

/// Euclidean distance.
pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm([a[0] - b[0], a[1] - b[1], a[2] - b[2]])
}

fn norm(v: [f64; 3]) -> f64 {
    Vector3::from(v).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Block, Pressing, Range};

    fn button(position: [f64; 3], size: [f64; 3], tilt_deg: f64) -> Block {
        Pressing { position, size, tilt_deg, min_force_n: 1.0 }.block()
    }

    /// The nearest two of many points of the two boxes: never nearer than the boxes are.
    fn nearest_points(a: &Block, b: &Block) -> f64 {
        let points = |button: &Block| -> Vec<Vector3<f64>> {
            let (rot, h) = (button.rotation, Vector3::from(button.half_extents()));
            (0..3000)
                .map(|k| {
                    // Stretched beyond the box and cut back, so that faces and edges are met too.
                    let t = spread::<3>(k).map(|t| (3.0 * t - 1.5).clamp(-1.0, 1.0));
                    Vector3::from(button.centre) + rot * h.component_mul(&Vector3::from(t))
                })
                .collect()
        };
        let (points_a, points_b) = (points(a), points(b));
        points_a.iter().flat_map(|p| points_b.iter().map(move |q| (p - q).norm())).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn gap_of_separate_boxes_is_at_most_the_distance_of_their_points() {
        let size = [0.05, 0.04, 0.02];
        for k in 0..20 {
            let [x, z, tilt] = spread(k);
            let a = button([0.4, 0.0, 0.0], size, 30.0);
            let b = button([0.3 + 0.2 * x, 0.01, 0.1 - 0.2 * z], size, 180.0 * tilt);
            let (gap, near) = (a.gap(&b), nearest_points(&a, &b));
            assert!(gap <= near, "pair {k}: {gap} {near}");
            // Corner to corner the axes underestimate; all else is met within the spacing of the points.
            assert!(gap < 0.0 || near < 1.5 * gap + 0.006, "pair {k}: {gap} {near}");
        }
    }

    #[test]
    fn gap_of_aligned_boxes_is_exact() {
        let a = button([0.4, 0.0, 0.0], [0.05, 0.04, 0.02], 90.0);
        let beside = button([0.4, 0.06, 0.0], [0.05, 0.04, 0.02], 90.0);
        let above = button([0.4, 0.0, 0.06], [0.05, 0.04, 0.02], 90.0);
        assert!((a.gap(&beside) - 0.01).abs() < 1e-12, "width runs along y");
        assert!((a.gap(&above) - 0.02).abs() < 1e-12, "height runs along z");
        assert!((a.gap(&a) + 0.02).abs() < 1e-12, "the same box twice overlaps by its thinnest side");
    }

    #[test]
    fn farthest_distances_agree_with_samples() {
        let from = Region { x: 0.3.into(), y: Range::new(-0.1, 0.3), z: Range::new(0.0, 0.2) };
        let to = Region { x: Range::new(0.2, 0.5), y: Range::new(-0.3, 0.1), z: (-0.2).into() };
        let per_point = |k| {
            let p = from.at(spread(k));
            to.corners().iter().map(|q| distance(p, *q)).fold(0.0, f64::max)
        };
        let (least, most) =
            (0..2000).map(per_point).fold((f64::MAX, 0.0), |(lo, hi), d| (f64::min(lo, d), f64::max(hi, d)));
        let (worst, best) = (farthest_at_worst(&from, &to), farthest(&from, &to));
        assert!(least >= worst && least - worst < 0.01, "{least} {worst}");
        assert!(most <= best && best - most < 0.01, "{most} {best}");
    }
}
