//! Tendons and the ways they take.

use crate::reading::{OneForBoth, Partly, ToGeom, ToJoint, ToMaterial, ToSite};
use crate::table::table;
use crate::value::Auto;

table! {
    /// A tendon: a path through space, or a sum of joint positions.
    pub struct Tendon {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
        }
        classed {
            /// A group, for what is seen.
            group: i32 = 0;
            /// Whether `range` limits its length.
            limited: Auto = Auto::Auto;
            /// Whether `actuatorfrcrange` limits the force of its actuators.
            actuatorfrclimited: Auto = Auto::Auto;
            /// Limits of its length (m, or the unit of the sum; never converted from degrees).
            range: [f64; 2] = [0.0; 2];
            /// Limits of the sum of actuator forces (N).
            actuatorfrcrange: [f64; 2] = [0.0; 2];
            /// Softness of the limit.
            solreflimit: [f64; 2] as Partly = [0.02, 1.0];
            /// Impedance of the limit.
            solimplimit: [f64; 5] as Partly = [0.9, 0.95, 0.001, 0.5, 2.0];
            /// Softness of friction loss.
            solreffriction: [f64; 2] as Partly = [0.02, 1.0];
            /// Impedance of friction loss.
            solimpfriction: [f64; 5] as Partly = [0.9, 0.95, 0.001, 0.5, 2.0];
            /// Dry friction (N).
            frictionloss: f64 = 0.0;
            /// Lengths (m) between which its spring makes no force; -1 is the length in the pose of `qpos0`.
            springlength: [f64; 2] as OneForBoth = [-1.0; 2];
            /// Stretch (m) at which its spring yields; 0 is never.
            springyield: f64 = 0.0;
            /// Radius it is drawn with (m).
            width: f64 = 0.003;
            /// The name of its material.
            material: String as ToMaterial;
            /// Distance to the limit (m) at which it becomes active.
            margin: f64 = 0.0;
            /// Stiffness (N/m), and of the square and cube of the stretch.
            stiffness: [f64; 3] as Partly = [0.0; 3];
            /// Damping (N s/m), and of the square and cube of the velocity.
            damping: [f64; 3] as Partly = [0.0; 3];
            /// Inertia of its length (kg).
            armature: f64 = 0.0;
            /// Its colour.
            rgba: [f64; 4] = [0.5, 0.5, 0.5, 1.0];
            /// Numbers of the user.
            user: Vec<f64>;
        }
        plus {
            /// The way it takes.
            path: TendonPath;
        }
    }
}

/// What the length of a tendon is.
#[derive(Clone, Debug, PartialEq)]
pub enum TendonPath {
    /// The shortest way through points and around shapes.
    Spatial(Vec<PathPoint>),
    /// A sum of joint positions.
    Fixed(Vec<JointTerm>),
}

impl Default for TendonPath {
    fn default() -> Self {
        Self::Spatial(Vec::new())
    }
}

/// What a tendon passes.
#[derive(Clone, Debug, PartialEq)]
pub enum PathPoint {
    /// Through a site.
    Site(PathSite),
    /// Around a sphere or cylinder, if it is in the way.
    Geom(PathGeom),
    /// What follows is another branch, whose length counts less.
    Pulley(Pulley),
}

table! {
    /// A site that a tendon passes through.
    pub struct PathSite {
        required {
            /// The name of the site.
            site: String as ToSite;
        }
    }
}

table! {
    /// A shape that a tendon wraps over.
    pub struct PathGeom {
        required {
            /// The name of the geom.
            geom: String as ToGeom;
        }
        own {
            /// The name of the site that tells on which side the tendon passes.
            sidesite: String as ToSite;
        }
    }
}

table! {
    /// The start of another branch of a tendon.
    pub struct Pulley {
        required {
            /// What the length of the branch is divided by.
            divisor: f64;
        }
    }
}

table! {
    /// A joint in the sum that is the length of a tendon.
    pub struct JointTerm {
        required {
            /// The name of the joint.
            joint: String as ToJoint;
            /// What its position is multiplied by.
            coef: f64;
        }
    }
}
