//! Joints.

use crate::reading::Partly;
use crate::table::table;
use crate::value::{Auto, keywords};

keywords! {
    /// Kinds of joints.
    pub enum JointKind {
        /// Moves and turns freely, six degrees of freedom.
        Free = "free",
        /// Turns freely about a point.
        Ball = "ball",
        /// Slides along an axis.
        Slide = "slide",
        /// Turns about an axis.
        Hinge = "hinge",
    }
}

table! {
    /// A degree of freedom of a body, or several. Angles are in rad, whatever the file uses.
    pub struct Joint {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
        }
        classed {
            /// What it is.
            kind "type": JointKind = JointKind::Hinge;
            /// A group, for what is seen.
            group: i32 = 0;
            /// Where it is in its body (m); nothing for a free joint.
            pos: [f64; 3] = [0.0; 3];
            /// Its axis in the body, of any length; for slide and hinge.
            axis: [f64; 3] = [0.0, 0.0, 1.0];
            /// Time constant (s) and damping ratio, from which MuJoCo computes stiffness and damping.
            springdamper: [f64; 2] = [0.0; 2];
            /// Whether `range` limits it.
            limited: Auto = Auto::Auto;
            /// Whether `actuatorfrcrange` limits it.
            actuatorfrclimited: Auto = Auto::Auto;
            /// Softness of the limit.
            solreflimit: [f64; 2] as Partly = [0.02, 1.0];
            /// Impedance of the limit.
            solimplimit: [f64; 5] as Partly = [0.9, 0.95, 0.001, 0.5, 2.0];
            /// Softness of friction loss.
            solreffriction: [f64; 2] as Partly = [0.02, 1.0];
            /// Impedance of friction loss.
            solimpfriction: [f64; 5] as Partly = [0.9, 0.95, 0.001, 0.5, 2.0];
            /// Stiffness (N/m or N m/rad), and of the square and cube of the displacement.
            stiffness: [f64; 3] as Partly = [0.0; 3];
            /// Limits (m or rad); of a ball 0 and the greatest angle.
            range: [f64; 2] = [0.0; 2];
            /// Limits of the sum of actuator forces (N or N m).
            actuatorfrcrange: [f64; 2] = [0.0; 2];
            /// Whether compensated weight counts as actuator force.
            actuatorgravcomp: bool = false;
            /// Distance to the limit (m or rad) at which it becomes active; not converted, as in MuJoCo.
            margin: f64 = 0.0;
            /// Position (m or rad) in the pose in which the model is written.
            reference "ref": f64 = 0.0;
            /// Position (m or rad) at which the spring makes no force.
            springref: f64 = 0.0;
            /// Displacement (m or rad) at which the spring yields; 0 is never.
            springyield: f64 = 0.0;
            /// Inertia that moves with it (kg or kg m^2).
            armature: f64 = 0.0;
            /// Damping (N s/m or N m s/rad), and of the square and cube of the velocity.
            damping: [f64; 3] as Partly = [0.0; 3];
            /// Dry friction (N or N m).
            frictionloss: f64 = 0.0;
            /// Numbers of the user.
            user: Vec<f64>;
        }
        plus {
            /// Whether MuJoCo aligns the body's axes with its inertia; said by `freejoint` only.
            align: Option<Auto>;
        }
    }
}
