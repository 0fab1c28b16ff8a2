//! Boxes that are turned, and the gap between two of them.

use nalgebra::{Matrix3, Vector3};

/// A box in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Its centre (m).
    pub centre: Vector3<f64>,
    /// Its axes as columns.
    pub axes: Matrix3<f64>,
    /// Half sizes along the axes (m).
    pub half_size: Vector3<f64>,
}

impl OrientedBox {
    /// Gap (m) to another box; negative when they overlap.
    ///
    /// Separating axis test (Gottschalk, Lin and Manocha 1996, <https://doi.org/10.1145/237170.237244>): the widest gap over
    /// the 15 candidate axes. Where two corners face each other the true gap is a little larger.
    pub fn gap(&self, other: &Self) -> f64 {
        self.least_gap(other, &[])
    }

    /// The least gap (m) to a box that may be moved by any share, from minus one half to one half, of each of these ways (m).
    ///
    /// What such a box sweeps over is bounded by faces that two of its edges and ways span, so that the same test holds with the
    /// ways as further edges.
    pub fn least_gap(&self, other: &Self, ways: &[Vector3<f64>]) -> f64 {
        let d = other.centre - self.centre;
        let sides = [self, other].into_iter().flat_map(|each| each.axes.column_iter().zip(&each.half_size));
        let sides = sides.map(|(axis, &half)| (axis.into_owned(), half));
        let ways = ways.iter().filter_map(|way| Some((way.try_normalize(1e-9)?, 0.5 * way.norm())));
        let edges: Vec<(Vector3<f64>, f64)> = sides.chain(ways).collect();
        let extent = |axis: &Vector3<f64>| edges.iter().map(|(edge, half)| half * edge.dot(axis).abs()).sum::<f64>();
        let pairs = edges.iter().enumerate().flat_map(|(k, (u, _))| edges[..k].iter().map(move |(v, _)| u.cross(v)));
        pairs
            // Parallel edges give no axis of their own.
            .filter_map(|axis| axis.try_normalize(1e-9))
            .map(|axis| d.dot(&axis).abs() - extent(&axis))
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn block(centre: [f64; 3], turn: f64) -> OrientedBox {
        let axes = Rotation3::from_euler_angles(turn, 0.3 * turn, -turn).into_inner();
        OrientedBox { centre: centre.into(), axes, half_size: Vector3::new(0.02, 0.03, 0.01) }
    }

    #[test]
    fn a_box_that_is_moved_comes_as_near_as_the_nearest_of_its_places() {
        let ways = [Vector3::new(0.2, 0.1, 0.0), Vector3::new(0.0, 0.0, 0.05)];
        let mut overlapping = 0;
        for k in 0..60 {
            let turn = 0.1 * f64::from(k);
            let (a, b) = (block([0.0; 3], 0.0), block([0.13 * turn.cos(), 0.12 * turn.sin(), 0.05], turn));
            let shares = (0..=20).flat_map(|u| (0..=20).map(move |v| [u, v].map(|k| f64::from(k) / 20.0 - 0.5)));
            let moved = shares.map(|[u, v]| OrientedBox { centre: b.centre + ways[0] * u + ways[1] * v, ..b });
            let nearest = moved.map(|moved| a.gap(&moved)).fold(f64::INFINITY, f64::min);
            let least = a.least_gap(&b, &ways);
            assert!(nearest >= 0.0 || least < 0.0, "{k}: places that overlap were missed, {least} {nearest}");
            // Places tried lie up to 6 mm from the nearest of all.
            assert!(least > -0.012 || nearest < 0.0, "{k}: there is no such overlap, {least} {nearest}");
            // Between corners both tell less than the distance, each by its own axes.
            assert!((least - nearest).abs() < 0.02, "{k}: {least} {nearest}");
            overlapping += u32::from(least < 0.0);
        }
        assert!((10..50).contains(&overlapping), "{overlapping} of 60");
    }
}
