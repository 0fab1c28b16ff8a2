//! The frame that MuJoCo gives a mesh: its centre of mass and axes of inertia, of pyramids over its triangles on the centre of their area, with volumes
//! that count as positive whichever way triangles are turned (`inertia="legacy"`).

use super::HullError;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Twice the area of triangles that count as nothing (m^2).
const NOTHING: f64 = 1e-15;
/// Rotations of Jacobi's method at most, and what they leave beside the diagonal.
const ROTATIONS: usize = 500;
const SMALL: f64 = 1e-14;
/// How much more a moment has to be to stand before another.
const MORE: f64 = 1e-12;

/// A frame in that of the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub position: Vector3<f64>,
    pub rotation: Matrix3<f64>,
    pub quaternion: UnitQuaternion<f64>,
}

/// That of triangles with these corners.
pub(super) fn frame(triangles: &[[Vector3<f64>; 3]]) -> Result<Frame, HullError> {
    let faces: Vec<Face> = triangles.iter().map(Face::new).collect();
    let area: f64 = faces.iter().map(|face| face.area).sum();
    let centre: Vector3<f64> = faces.iter().map(|face| face.area * face.middle).sum::<Vector3<f64>>() / area;
    let (mut volume, mut position) = (0.0, Vector3::zeros());
    for face in &faces {
        let part = ((face.middle - centre).dot(&face.normal) * face.area / 3.0).abs();
        volume += part;
        position += part * (0.75 * face.middle + 0.25 * centre);
    }
    position /= volume;
    let mut product = Matrix3::zeros();
    for (face, corners) in faces.iter().zip(triangles) {
        let [a, b, c] = corners.map(|corner| corner - position);
        let part = (((a + b + c) / 3.0).dot(&face.normal) * face.area / 3.0).abs();
        let of = |u: &Vector3<f64>, v: &Vector3<f64>| u * v.transpose();
        let own = 2.0 * (of(&a, &a) + of(&b, &b) + of(&c, &c));
        product += part / 20.0 * (own + of(&a, &b) + of(&b, &a) + of(&a, &c) + of(&c, &a) + of(&b, &c) + of(&c, &b));
    }
    let inertia = Matrix3::from_diagonal_element(product.trace()) - product;
    let quaternion = axes(&inertia);
    let frame =
        Frame { position, rotation: rotation(&quaternion), quaternion: UnitQuaternion::from_quaternion(quaternion) };
    if frame.position.iter().chain(frame.rotation.iter()).all(|x| x.is_finite()) {
        Ok(frame)
    } else {
        Err(HullError::Flat)
    }
}

/// A triangle of a surface.
struct Face {
    middle: Vector3<f64>,
    normal: Vector3<f64>,
    area: f64,
}

impl Face {
    fn new([a, b, c]: &[Vector3<f64>; 3]) -> Self {
        let normal = (b - a).cross(&(c - a));
        let length = normal.norm();
        Self {
            middle: (a + b + c) / 3.0,
            normal: if length > 0.0 { normal / length } else { normal },
            area: if length < NOTHING { 0.0 } else { 0.5 * length },
        }
    }
}

/// Axes of inertia, the greatest moment first, by Jacobi rotations of a quaternion.
fn axes(inertia: &Matrix3<f64>) -> Quaternion<f64> {
    let mut quaternion = Quaternion::identity();
    let mut moments = Vector3::zeros();
    for _ in 0..ROTATIONS {
        let axes = rotation(&quaternion);
        let turned = axes.transpose() * inertia * axes;
        moments = turned.diagonal();
        let Some(turn) = jacobi(&turned) else { break };
        quaternion = (quaternion * turn.normalize()).normalize();
    }
    for k in [0, 1, 0] {
        if moments[k] * (1.0 + MORE) < moments[k + 1] {
            moments.swap_rows(k, k + 1);
            let mut turn = [0.5_f64.sqrt(), 0.0, 0.0, 0.0];
            turn[(k + 2) % 3 + 1] = turn[0];
            let [w, x, y, z] = turn;
            quaternion = (quaternion * Quaternion::new(w, x, y, z)).normalize();
        }
    }
    quaternion
}

/// The rotation about an axis that takes away what is greatest beside the diagonal; none if that is nothing.
fn jacobi(matrix: &Matrix3<f64>) -> Option<Quaternion<f64>> {
    let [a, b, c] = [matrix[(0, 1)], matrix[(0, 2)], matrix[(1, 2)]].map(f64::abs);
    let (row, column, axis) = if a > b && a > c {
        (0, 1, 2)
    } else if b > c {
        (0, 2, 1)
    } else {
        (1, 2, 0)
    };
    let off = matrix[(row, column)];
    if off.abs() < SMALL {
        return None;
    }
    let tau = (matrix[(column, column)] - matrix[(row, row)]) / (2.0 * off);
    let root = (1.0 + tau * tau).sqrt();
    let tangent = if tau >= 0.0 { 1.0 / (tau + root) } else { -1.0 / (root - tau) };
    if 1.0 / (1.0 + tangent * tangent).sqrt() > 1.0 - SMALL {
        return None;
    }
    let half = -(0.5 * tangent.atan()).sin();
    let mut turn = Vector3::zeros();
    turn[axis] = if axis == 1 { -half } else { half };
    Some(Quaternion::from_parts((1.0 - half * half).sqrt(), turn))
}

/// The matrix of a quaternion.
fn rotation(quaternion: &Quaternion<f64>) -> Matrix3<f64> {
    let Quaternion { coords } = quaternion;
    let (w, x, y, z) = (coords.w, coords.x, coords.y, coords.z);
    Matrix3::new(
        w * w + x * x - y * y - z * z,
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        w * w - x * x + y * y - z * z,
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        w * w - x * x - y * y + z * z,
    )
}
