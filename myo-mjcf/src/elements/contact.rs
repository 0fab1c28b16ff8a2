//! Contacts that are asked for, or ruled out.

use crate::reading::{Partly, ToBody, ToGeom};
use crate::table::table;

table! {
    /// Two geoms that may touch whatever their bits say, with contact parameters of their own: those of the geoms do not count.
    pub struct Pair {
        required {
            /// The name of one geom.
            geom1: String as ToGeom;
            /// The name of the other.
            geom2: String as ToGeom;
        }
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
        }
        classed {
            /// Dimensions of the contact force: 1, 3, 4 or 6.
            condim: i32 = 3;
            /// Friction: two sliding, torsional (m), two rolling (m).
            friction: [f64; 5] as Partly = [1.0, 1.0, 0.005, 0.0001, 0.0001];
            /// Softness of the normal force.
            solref: [f64; 2] as Partly = [0.02, 1.0];
            /// Softness of friction; zeros mean that of the normal force.
            solreffriction: [f64; 2] as Partly = [0.0; 2];
            /// Impedance.
            solimp: [f64; 5] as Partly = [0.9, 0.95, 0.001, 0.5, 2.0];
            /// Distance (m) at which the contact appears.
            margin: f64 = 0.0;
            /// Distance (m) within the margin without force.
            gap: f64 = 0.0;
            /// Force (N) that holds the two together.
            adhesion: f64 = 0.0;
        }
    }
}

table! {
    /// Two bodies that never touch.
    pub struct Exclude {
        required {
            /// The name of one body.
            body1: String as ToBody;
            /// The name of the other.
            body2: String as ToBody;
        }
        own {
            /// Its name.
            name: String;
        }
    }
}
