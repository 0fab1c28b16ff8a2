//! Shapes: what collides, what tendons wrap over, what is only seen.

use crate::pose::Pose;
use crate::reading::{Partly, ToHeightField, ToMaterial, ToMesh};
use crate::table::table;
use crate::value::keywords;

keywords! {
    /// Shapes of geoms and sites.
    pub enum Shape {
        /// A plane, seen and touched from its +z side only.
        Plane = "plane",
        /// Terrain, see [`HeightField`](crate::HeightField).
        HeightField = "hfield",
        /// A ball; size: radius.
        Sphere = "sphere",
        /// A cylinder with two half balls; size: radius, half length of the cylinder.
        Capsule = "capsule",
        /// An ellipsoid; size: half axes.
        Ellipsoid = "ellipsoid",
        /// A cylinder along z; size: radius, half length.
        Cylinder = "cylinder",
        /// A box; size: half lengths of the edges.
        Box = "box",
        /// A mesh, or its convex hull where it collides.
        Mesh = "mesh",
        /// A signed distance field, computed by a plugin.
        Sdf = "sdf",
    }

    /// How a geom feels a fluid.
    pub enum FluidShape {
        /// By the inertia of its body.
        None = "none",
        /// As an ellipsoid of its own.
        Ellipsoid = "ellipsoid",
    }
}

table! {
    /// A shape that belongs to a body.
    pub struct Geom {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
        }
        classed {
            /// Its shape.
            kind "type": Shape = Shape::Sphere;
            /// Bits of what it touches; it touches what has one of them in `conaffinity`.
            contype: i32 = 1;
            /// Bits of what touches it.
            conaffinity: i32 = 1;
            /// Dimensions of the contact force: 1, 3, 4 or 6.
            condim: i32 = 3;
            /// A group, for what is seen and for what counts for inertia.
            group: i32 = 0;
            /// Whose contact parameters hold when two geoms touch: those of the higher priority.
            priority: i32 = 0;
            /// Sizes (m); how many count depends on the shape.
            size: [f64; 3] as Partly = [0.0; 3];
            /// The name of its material.
            material: String as ToMaterial;
            /// Friction: sliding, torsional (m), rolling (m).
            friction: [f64; 3] as Partly = [1.0, 0.005, 0.0001];
            /// Its mass (kg); without it, density and volume tell.
            mass: f64;
            /// Its density (kg/m^3, or kg/m^2 for a shell).
            density: f64 = 1000.0;
            /// Whether the mass is in the surface.
            shellinertia: bool = false;
            /// Weight of its contact parameters when two geoms touch.
            solmix: f64 = 1.0;
            /// Softness of contacts: time constant (s) and damping ratio, or negative stiffness and damping.
            solref: [f64; 2] as Partly = [0.02, 1.0];
            /// Impedance of contacts.
            solimp: [f64; 5] as Partly = [0.9, 0.95, 0.001, 0.5, 2.0];
            /// Distance (m) at which contacts appear.
            margin: f64 = 0.0;
            /// Distance (m) within the margin at which contacts make no force yet.
            gap: f64 = 0.0;
            /// Velocity of its surface: linear (m/s), angular (rad/s).
            surfacevel: [f64; 6] as Partly = [0.0; 6];
            /// Force (N) that holds what touches it.
            adhesion: f64 = 0.0;
            /// Two end points (m). Once a model is read they have become position, orientation and size.
            fromto: [f64; 6];
            /// The name of its height field.
            hfield: String as ToHeightField;
            /// The name of its mesh; with another shape than `mesh` that shape is fitted to the mesh.
            mesh: String as ToMesh;
            /// Scale of a shape that is fitted to a mesh.
            fitscale: f64 = 1.0;
            /// Its colour.
            rgba: [f64; 4] = [0.5, 0.5, 0.5, 1.0];
            /// How it feels a fluid.
            fluidshape: FluidShape = FluidShape::None;
            /// Coefficients of the fluid's forces: blunt drag, slender drag, angular drag, Kutta lift, Magnus lift.
            fluidcoef: [f64; 5] as Partly = [0.5, 0.25, 1.5, 1.0, 1.0];
            /// Whether it casts a shadow.
            castshadow: bool = true;
            /// Numbers of the user.
            user: Vec<f64>;
        }
        with {
            /// Where it is in its body.
            pose: Pose;
        }
    }
}

table! {
    /// A place on a body, for sensors and tendons.
    pub struct Site {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
        }
        classed {
            /// Its shape.
            kind "type": Shape = Shape::Sphere;
            /// A group, for what is seen.
            group: i32 = 0;
            /// The name of its material.
            material: String as ToMaterial;
            /// The name of the mesh whose shape it has.
            mesh: String as ToMesh;
            /// Sizes (m); how many count depends on the shape.
            size: [f64; 3] as Partly = [0.005; 3];
            /// Two end points (m). Once a model is read they have become position, orientation and size.
            fromto: [f64; 6];
            /// Its colour.
            rgba: [f64; 4] = [0.5, 0.5, 0.5, 1.0];
            /// Numbers of the user.
            user: Vec<f64>;
        }
        with {
            /// Where it is in its body.
            pose: Pose;
        }
    }
}
