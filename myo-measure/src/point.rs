//! Arithmetic of points in space.

/// Coordinates in metres, in any frame that does not turn.
pub type Point = [f64; 3];

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// Mean of some points (m); NaN of none.
pub fn centre(points: &[Point]) -> Point {
    let n = points.len() as f64;
    [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / n)
}
