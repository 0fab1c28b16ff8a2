//! Positions and orientations: five ways to write one, frames, end points.

use crate::document::Node;
use crate::elements::{Compiler, Shape};
use crate::error::MjcfError;
use crate::place::{Kind, Place};
use crate::table::{Scope, Table, exclusive};
use crate::value::{Fault, Value};
use nalgebra::{Matrix3, Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};

/// Shorter vectors have no direction; MuJoCo's `mjEPS`.
const SHORTEST: f64 = 1e-14;

/// Where something is in its body or parent.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Pose {
    /// Position (m).
    pub pos: Option<[f64; 3]>,
    /// Orientation: a unit quaternion w, x, y, z, however the file writes it.
    pub quat: Option<[f64; 4]>,
    /// An orientation that waits for the compiler's angles.
    turn: Option<Turn>,
}

/// Orientations other than quaternions.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turn {
    AxisAngle([f64; 4]),
    XyAxes([f64; 6]),
    ZAxis([f64; 3]),
    Euler([f64; 3]),
}

const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];

impl Pose {
    /// Position (m), else the origin.
    pub fn pos(&self) -> [f64; 3] {
        self.pos.unwrap_or_default()
    }

    /// Orientation as a unit quaternion w, x, y, z, else none.
    pub fn quat(&self) -> [f64; 4] {
        self.quat.unwrap_or([1.0, 0.0, 0.0, 0.0])
    }

    /// Orientation as a rotation.
    pub fn rotation(&self) -> UnitQuaternion<f64> {
        let [w, x, y, z] = self.quat();
        UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
    }

    /// What is said, as MJCF writes it.
    pub fn said(&self) -> Vec<(&'static str, String)> {
        let pos = self.pos.iter().map(|pos| ("pos", pos.write()));
        pos.chain(self.quat.iter().map(|quat| ("quat", quat.write()))).collect()
    }

    /// Makes a unit quaternion of whatever orientation there is.
    pub(crate) fn settle(&mut self, node: &Node, compiler: &Compiler) -> Result<(), MjcfError> {
        exclusive(node, &ORIENTATIONS)?;
        let rotation = match (self.turn.take(), self.quat) {
            (Some(turn), _) => Some(turn.rotation(compiler)),
            (None, Some(quat)) => Some(normalized(quat).ok_or("quat")),
            (None, None) => None,
        };
        let Some(rotation) = rotation else { return Ok(()) };
        let rotation = rotation.map_err(|attribute| zero_length(node, attribute))?;
        self.quat = Some(wxyz(&rotation));
        Ok(())
    }

    pub(crate) fn frame(&self) -> Frame {
        Frame { pos: self.pos().into(), rotation: self.rotation() }
    }

    /// Moves it from within a frame to what the frame is in.
    pub(crate) fn enter(&mut self, frame: &Frame) {
        if *frame == Frame::identity() {
            return;
        }
        let moved = frame.times(&self.frame());
        self.pos = Some(moved.pos.into());
        self.quat = Some(wxyz(&moved.rotation));
    }
}

impl Turn {
    /// The rotation, or the attribute that has no direction.
    fn rotation(self, compiler: &Compiler) -> Result<UnitQuaternion<f64>, &'static str> {
        match self {
            Self::AxisAngle([x, y, z, angle]) => {
                let axis = direction([x, y, z].into()).ok_or("axisangle")?;
                Ok(UnitQuaternion::from_axis_angle(&axis, compiler.radians(angle)))
            }
            Self::XyAxes([x1, x2, x3, y1, y2, y3]) => {
                xy_rotation([x1, x2, x3].into(), [y1, y2, y3].into()).ok_or("xyaxes")
            }
            Self::ZAxis(axis) => Ok(z_rotation(direction(axis.into()).ok_or("zaxis")?)),
            Self::Euler(angles) => Ok(euler_rotation(angles, compiler)),
        }
    }
}

fn normalized([w, x, y, z]: [f64; 4]) -> Option<UnitQuaternion<f64>> {
    let largest = [w, x, y, z].iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    if largest == 0.0 {
        return None;
    }
    // First to a size whose square neither overflows nor vanishes, unless it is fine as it is.
    let scale = if (1e-100..1e100).contains(&largest) { 1.0 } else { largest };
    UnitQuaternion::try_new(Quaternion::new(w / scale, x / scale, y / scale, z / scale), 0.0)
}

fn direction(vector: Vector3<f64>) -> Option<Unit<Vector3<f64>>> {
    let largest = vector.amax();
    let scale = if largest < 1e100 { 1.0 } else { largest };
    Unit::try_new(vector / scale, SHORTEST)
}

/// x axis as given, y axis made orthogonal to it.
fn xy_rotation(x: Vector3<f64>, y: Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let x = direction(x)?.into_inner();
    let scale = if y.amax() < 1e100 { 1.0 } else { y.amax() };
    let y = y / scale;
    let y = direction(y - x * x.dot(&y))?.into_inner();
    let axes = Matrix3::from_columns(&[x, y, x.cross(&y)]);
    Some(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes)))
}

/// The least rotation that takes z to `axis`, about x for the opposite of z.
fn z_rotation(axis: Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    let about = Vector3::z().cross(&axis);
    let angle = about.norm().atan2(axis.z);
    let about = Unit::try_new(about, 1e-10).unwrap_or(Vector3::x_axis());
    UnitQuaternion::from_axis_angle(&about, angle)
}

pub(crate) fn euler_rotation(angles: [f64; 3], compiler: &Compiler) -> UnitQuaternion<f64> {
    let mut rotation = UnitQuaternion::identity();
    for (angle, name) in angles.into_iter().zip(compiler.eulerseq().0) {
        let axis = match name.to_ascii_lowercase() {
            'x' => Vector3::x_axis(),
            'y' => Vector3::y_axis(),
            _ => Vector3::z_axis(),
        };
        let turn = UnitQuaternion::from_axis_angle(&axis, compiler.radians(angle));
        // Capital letters are axes that stand still.
        rotation = if name.is_ascii_uppercase() { turn * rotation } else { rotation * turn };
    }
    rotation
}

fn wxyz(rotation: &UnitQuaternion<f64>) -> [f64; 4] {
    [rotation.w, rotation.i, rotation.j, rotation.k]
}

fn zero_length(node: &Node, attribute: &'static str) -> MjcfError {
    let text = node.get(attribute).unwrap_or_default().to_owned();
    MjcfError::OutOfRange { at: node.at_attribute(attribute), attribute, text, expected: "longer than zero" }
}

impl Table for Pose {
    fn set(&mut self, _: Scope, name: &str, text: &str) -> Result<bool, Fault> {
        match name {
            "pos" => self.pos = Some(Value::read(text)?),
            // The last one to be written wins over its class; within one element there is one.
            "quat" => (self.quat, self.turn) = (Some(Value::read(text)?), None),
            "axisangle" => (self.quat, self.turn) = (None, Some(Turn::AxisAngle(Value::read(text)?))),
            "xyaxes" => (self.quat, self.turn) = (None, Some(Turn::XyAxes(Value::read(text)?))),
            "zaxis" => (self.quat, self.turn) = (None, Some(Turn::ZAxis(Value::read(text)?))),
            "euler" => (self.quat, self.turn) = (None, Some(Turn::Euler(Value::read(text)?))),
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn attributes(&self, _: Scope) -> Vec<&'static str> {
        [&["pos"], &ORIENTATIONS[..]].concat()
    }

    fn required(&self) -> &'static [&'static str] {
        &[]
    }

    fn set_place(&mut self, _: &Place) {}

    fn references(&mut self, _: &mut dyn FnMut(Kind, &mut String)) {}

    fn tidy(&mut self) {}

    fn held(&self) -> usize {
        0
    }
}

/// A frame, which moves and turns what stands in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub pos: Vector3<f64>,
    pub rotation: UnitQuaternion<f64>,
}

impl Frame {
    pub fn identity() -> Self {
        Self { pos: Vector3::zeros(), rotation: UnitQuaternion::identity() }
    }

    pub fn times(&self, inner: &Self) -> Self {
        let rotation = UnitQuaternion::new_normalize((self.rotation * inner.rotation).into_inner());
        Self { pos: self.pos + self.rotation * inner.pos, rotation }
    }

    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        (self.pos + self.rotation * Vector3::from(point)).into()
    }

    pub fn vector(&self, vector: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(vector)).into()
    }

    /// Full inertia xx, yy, zz, xy, xz, yz, turned with the frame.
    pub fn inertia(&self, [xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [f64; 6] {
        let turn = self.rotation.to_rotation_matrix().into_inner();
        let full = turn * Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) * turn.transpose();
        [full.m11, full.m22, full.m33, full.m12, full.m13, full.m23]
    }
}

/// Makes position, orientation and size of two end points; z points from the second to the first.
pub(crate) fn stretch(
    node: &Node,
    shape: Shape,
    fromto: [f64; 6],
    pose: &mut Pose,
    size: [f64; 3],
) -> Result<[f64; 3], MjcfError> {
    let wrong = |why| Err(node.misplaced(why));
    if !matches!(shape, Shape::Capsule | Shape::Cylinder | Shape::Ellipsoid | Shape::Box) {
        return wrong("`fromto` is for capsules, cylinders, ellipsoids and boxes; leave it out or change the type");
    }
    if pose.pos() != [0.0; 3] {
        return wrong("`pos` and `fromto` exclude each other; give one of them");
    }
    let [x1, y1, z1, x2, y2, z2] = fromto;
    let (from, to) = (Vector3::new(x1, y1, z1), Vector3::new(x2, y2, z2));
    let Some(axis) = direction(from - to) else {
        return wrong("the two points of `fromto` are one; move them apart");
    };
    let half = (from - to).norm() / 2.0;
    pose.pos = Some(((from + to) / 2.0).into());
    pose.quat = Some(wxyz(&z_rotation(axis)));
    Ok(match shape {
        Shape::Capsule | Shape::Cylinder => [size[0], half, size[2]],
        _ => [size[0], size[0], half],
    })
}
