//! Contacts of convex meshes, in double precision and one body at a time: they are rare, and branch a lot.
//!
//! The rules are MuJoCo's, see `docs/mesh-contacts.md`.

mod apart;
mod box_box;
mod cap;
mod capsule;
mod clip;
mod contacts;
mod cylinder;
mod descent;
mod difference;
mod ellipsoid;
mod face;
mod hull;
mod placed;
mod plane;
mod polytope;
mod quad;
mod root;
mod round;
mod scratch;
mod seed;
#[cfg(test)]
mod tests;
mod touch;
mod walked;

pub use box_box::{BOX_CONTACTS, box_box};
pub use contacts::{Contacts, MOST_CONTACTS};
pub use hull::Hull;
pub use scratch::Scratch;

use capsule::Capsule;
use cylinder::Cylinder;
use ellipsoid::Ellipsoid;
use face::Side;
use nalgebra::{Matrix3, Vector3};
use placed::Placed;

/// What a mesh may touch; what is round has its axis along z.
#[derive(Clone, Copy, Debug)]
pub enum Other<'a> {
    /// The half space below z = 0.
    Plane,
    /// A cylinder (m).
    Cylinder { radius: f64, half_length: f64 },
    /// An ellipsoid of these semi-axes (m).
    Ellipsoid { radii: [f64; 3] },
    /// A capsule (m).
    Capsule { radius: f64, half_length: f64 },
    /// Another mesh.
    Mesh(&'a Hull),
}

/// Where a mesh is in the frame of what it may touch.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Its axes as columns.
    pub rotation: Matrix3<f64>,
    /// Its origin (m).
    pub position: Vector3<f64>,
}

/// Contacts of a mesh, the second, with something else, the first, in the frame of this; up to a margin (m). They are looked for from a direction on, from the first
/// to the second, which may be any, but for what it costs, and becomes that along which they are least in each other or furthest apart, if it is found.
#[inline(never)]
pub fn contacts(
    first: Other<'_>,
    second: &Hull,
    place: &Place,
    towards: &mut Vector3<f64>,
    margin: f64,
    scratch: &mut Scratch,
) -> Contacts {
    let mesh = Placed { hull: second, rotation: place.rotation, position: place.position };
    match first {
        Other::Plane => plane::plane_mesh(&mesh, margin),
        Other::Cylinder { radius, half_length } => {
            Cylinder { radius, half_length }.contacts(&mesh, towards, margin, scratch)
        }
        Other::Ellipsoid { radii } => Ellipsoid { radii: radii.into() }.contacts(&mesh, towards, margin, scratch),
        Other::Capsule { radius, half_length } => {
            Capsule { radius, half_length }.contacts(&mesh, towards, margin, scratch)
        }
        Other::Mesh(first) => mesh_mesh(&Placed::at_rest(first), &mesh, towards, margin, scratch),
    }
}

fn mesh_mesh(
    one: &Placed<'_>,
    other: &Placed<'_>,
    towards: &mut Vector3<f64>,
    margin: f64,
    scratch: &mut Scratch,
) -> Contacts {
    let touch = touch::hulls(one, other, towards, margin, scratch);
    *towards = touch.normal;
    if touch.depth <= -margin {
        return Contacts::default();
    }
    let [feature, other_feature] = touch.features;
    contacts::several(&touch, [&Side::Hull(one, feature), &Side::Hull(other, other_feature)], margin, scratch)
}
