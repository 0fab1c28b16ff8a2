//! Equality constraints.

use crate::reading::{Partly, ToBody, ToJoint, ToSite, ToTendon};
use crate::table::table;

table! {
    /// A constraint that holds at all times.
    pub struct Equality {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
        }
        classed {
            /// Whether it holds at the start.
            active: bool = true;
            /// Its softness.
            solref: [f64; 2] as Partly = [0.02, 1.0];
            /// Its impedance.
            solimp: [f64; 5] as Partly = [0.9, 0.95, 0.001, 0.5, 2.0];
        }
        plus {
            /// What it constrains.
            constraint: Constraint;
        }
    }
}

/// What an equality constrains.
#[derive(Clone, Debug, PartialEq)]
pub enum Constraint {
    /// Two points coincide.
    Connect(Connect),
    /// Two bodies move as one.
    Weld(Weld),
    /// A joint follows another one.
    Joint(JointCoupling),
    /// A tendon follows another one.
    Tendon(TendonCoupling),
}

impl Default for Constraint {
    fn default() -> Self {
        Self::Connect(Connect::default())
    }
}

table! {
    /// Two points that coincide: an anchor on two bodies, or two sites.
    pub struct Connect {
        own {
            /// The name of one body.
            body1: String as ToBody;
            /// The name of the other; the world if nothing is said.
            body2: String as ToBody;
            /// The point, in the first body (m).
            anchor: [f64; 3] = [0.0; 3];
            /// The name of one site.
            site1: String as ToSite;
            /// The name of the other.
            site2: String as ToSite;
        }
    }
}

table! {
    /// Two bodies, or two sites, that move as one.
    pub struct Weld {
        own {
            /// The name of one body.
            body1: String as ToBody;
            /// The name of the other; the world if nothing is said.
            body2: String as ToBody;
            /// Pose of the second body in the first one (m and quaternion w, x, y, z); zeros are the pose of `qpos0`.
            relpose: [f64; 7] = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            /// The point, in the second body (m).
            anchor: [f64; 3] = [0.0; 3];
            /// The name of one site.
            site1: String as ToSite;
            /// The name of the other.
            site2: String as ToSite;
            /// Length (m) by which angles weigh against distances.
            torquescale: f64 = 1.0;
        }
    }
}

table! {
    /// A joint whose position is a polynomial of another one's.
    pub struct JointCoupling {
        required {
            /// The name of the joint that follows.
            joint1: String as ToJoint;
        }
        own {
            /// The name of the joint that leads; without it `joint1` keeps a constant position.
            joint2: String as ToJoint;
            /// Coefficients of position, from constant to fourth power; both positions count from `qpos0`.
            polycoef: [f64; 5] as Partly = [0.0, 1.0, 0.0, 0.0, 0.0];
        }
    }
}

table! {
    /// A tendon whose length is a polynomial of another one's.
    pub struct TendonCoupling {
        required {
            /// The name of the tendon that follows.
            tendon1: String as ToTendon;
        }
        own {
            /// The name of the tendon that leads; without it `tendon1` keeps a constant length.
            tendon2: String as ToTendon;
            /// Coefficients of length, from constant to fourth power; both lengths count from those in `qpos0`.
            polycoef: [f64; 5] as Partly = [0.0, 1.0, 0.0, 0.0, 0.0];
        }
    }
}
