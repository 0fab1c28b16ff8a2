//! Distances between regions and boxes, and points spread evenly without chance.

use nalgebra::{Matrix3, Vector3};

use crate::target::{Pressing, Region};

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

/// Gap in m between two oriented boxes; negative when they overlap.
///
/// Separating axis test (Gottschalk, Lin and Manocha 1996): the widest gap over the 15 candidate axes. Where two corners
/// face each other the true gap is a little larger, so the answer errs on the side of refusing.
pub(crate) fn gap(a: &Pressing, b: &Pressing) -> f64 {
    let (rot_a, rot_b) = (a.rotation().into_inner(), b.rotation().into_inner());
    let (h_a, h_b) = (Vector3::from(a.half_extents()), Vector3::from(b.half_extents()));
    let d = Vector3::from(b.position) - Vector3::from(a.position);
    let extent = |rot: &Matrix3<f64>, h: &Vector3<f64>, axis: &Vector3<f64>| (rot.transpose() * axis).abs().dot(h);
    let faces = rot_a.column_iter().chain(rot_b.column_iter()).map(|c| c.into_owned());
    let edges = rot_a.column_iter().flat_map(|u| rot_b.column_iter().map(move |v| u.cross(&v)));
    faces
        .chain(edges)
        // Parallel edges give no axis of their own.
        .filter_map(|axis| axis.try_normalize(1e-9))
        .map(|axis| d.dot(&axis).abs() - extent(&rot_a, &h_a, &axis) - extent(&rot_b, &h_b, &axis))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Point `k` of a sequence that fills the unit cube evenly (Halton 1960), the same on every run.
pub(crate) fn spread<const N: usize>(k: u32) -> [f64; N] {
    const PRIMES: [u32; 6] = [2, 3, 5, 7, 11, 13];
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
