//! Actuators: motors, servos, muscles.

use crate::reading::{Partly, ToBody, ToJoint, ToSite, ToTendon};
use crate::table::table;
use crate::value::{Auto, keywords};

keywords! {
    /// How activation follows control.
    pub enum DynKind {
        /// There is no activation.
        None = "none",
        /// It is the integral of control.
        Integrator = "integrator",
        /// A filter of first order.
        Filter = "filter",
        /// The same, integrated exactly.
        FilterExact = "filterexact",
        /// Activation of a muscle.
        Muscle = "muscle",
        /// A motor's current (MuJoCo 3.6).
        DcMotor = "dcmotor",
        /// A controller's states (MuJoCo 4).
        Pid = "pid",
        /// Left to the user.
        User = "user",
    }

    /// How force depends on control or activation.
    pub enum GainKind {
        /// `gainprm[0]`.
        Fixed = "fixed",
        /// `gainprm[0] + gainprm[1] * length + gainprm[2] * velocity`.
        Affine = "affine",
        /// The active force of a muscle.
        Muscle = "muscle",
        /// A motor's (MuJoCo 3.6).
        DcMotor = "dcmotor",
        /// An orientation servo's (MuJoCo 4).
        So3 = "so3",
        /// A controller's (MuJoCo 4).
        Pid = "pid",
        /// Left to the user.
        User = "user",
    }

    /// Force without control.
    pub enum BiasKind {
        /// None.
        None = "none",
        /// `biasprm[0] + biasprm[1] * length + biasprm[2] * velocity`.
        Affine = "affine",
        /// The passive force of a muscle.
        Muscle = "muscle",
        /// A motor's (MuJoCo 3.6).
        DcMotor = "dcmotor",
        /// An orientation servo's (MuJoCo 4).
        So3 = "so3",
        /// Left to the user.
        User = "user",
    }

    /// What stands between delayed samples.
    pub enum Interpolation {
        /// The last sample.
        Hold = "zoh",
        /// A line.
        Linear = "linear",
        /// A cubic.
        Cubic = "cubic",
    }
}

table! {
    /// An actuator. Shortcuts such as `motor` and `muscle` have set the general parameters, as MuJoCo does.
    pub struct Actuator {
        own {
            /// Its name.
            name: String;
            /// The default class.
            class: String;
            /// Least and greatest length of what it moves (m or rad).
            lengthrange: [f64; 2] = [0.0; 2];
            /// The name of the joint it moves.
            joint: String as ToJoint;
            /// The name of the joint it moves, in the axes of the parent.
            jointinparent: String as ToJoint;
            /// The name of the tendon it pulls.
            tendon: String as ToTendon;
            /// The name of the site that slides, of a slider-crank.
            slidersite: String as ToSite;
            /// The name of the site of the crank.
            cranksite: String as ToSite;
            /// The name of the site it pushes.
            site: String as ToSite;
            /// The name of the site in whose axes it pushes.
            refsite: String as ToSite;
            /// The name of the body whose contacts it holds.
            body: String as ToBody;
        }
        classed {
            /// A group.
            group: i32 = 0;
            /// Samples of delayed control that are kept.
            nsample: i32 = 0;
            /// What stands between them.
            interp: Interpolation = Interpolation::Hold;
            /// Delay (s).
            delay: f64 = 0.0;
            /// Whether `ctrlrange` clamps control.
            ctrllimited: Auto = Auto::Auto;
            /// Whether `forcerange` clamps force.
            forcelimited: Auto = Auto::Auto;
            /// Whether `actrange` clamps activation.
            actlimited: Auto = Auto::Auto;
            /// Limits of control.
            ctrlrange: [f64; 2] = [0.0; 2];
            /// Limits of force (N or N m).
            forcerange: [f64; 2] = [0.0; 2];
            /// Limits of activation.
            actrange: [f64; 2] = [0.0; 2];
            /// Part of the target's range that becomes the range of control; 0 is none.
            inheritrange: f64 = 0.0;
            /// How its length and force relate to those of its target.
            gear: [f64; 6] as Partly = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            /// Length of the crank (m).
            cranklength: f64 = 0.0;
            /// Damping of its target, and of the square and cube of the velocity.
            damping: [f64; 3] as Partly = [0.0; 3];
            /// Inertia of its target.
            armature: f64 = 0.0;
            /// Numbers of the user.
            user: Vec<f64>;
            /// Size of its activation, -1 is as its dynamics need.
            actdim: i32 = -1;
            /// Inputs, as words (MuJoCo 4).
            input: String;
            /// Limits of a velocity input (MuJoCo 4).
            velrange: [f64; 2] = [0.0; 2];
            /// Limits of a force input (MuJoCo 4).
            ffrange: [f64; 2] = [0.0; 2];
            /// How activation follows control.
            dyntype: DynKind = DynKind::None;
            /// How force depends on it.
            gaintype: GainKind = GainKind::Fixed;
            /// Force without it.
            biastype: BiasKind = BiasKind::None;
            /// Parameters of `dyntype`.
            dynprm: [f64; 10] as Partly = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            /// Parameters of `gaintype`.
            gainprm: [f64; 10] as Partly = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            /// Parameters of `biastype`.
            biasprm: [f64; 10] as Partly = [0.0; 10];
            /// Whether force uses the activation after the step.
            actearly: bool = false;
        }
        plus {
            /// How the file says it.
            shortcut: Shortcut;
        }
    }
}

/// How the file says what an actuator is, with what it says itself; a class has acted on the general parameters only.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Shortcut {
    /// With general parameters.
    #[default]
    General,
    /// Force is control.
    Motor,
    /// Control is a position.
    Position(Servo),
    /// Control is a velocity.
    Velocity(VelocityServo),
    /// Control is a velocity, integrated to a position.
    IntVelocity(Servo),
    /// Control is damping.
    Damper(VelocityServo),
    /// A pneumatic or hydraulic cylinder.
    Cylinder(Cylinder),
    /// A muscle.
    Muscle(Muscle),
    /// Control is adhesion.
    Adhesion(Adhesion),
}

table! {
    /// Parameters of a position or integrated velocity servo.
    pub struct Servo {
        classed {
            /// Gain of position (N/m or N m/rad).
            kp: f64;
            /// Damping (N s/m or N m s/rad).
            kv: f64;
            /// Damping ratio, instead of `kv`.
            dampratio: f64;
            /// Time constant of a filter of control (s).
            timeconst: f64;
        }
    }
}

table! {
    /// The parameter of a velocity servo or damper.
    pub struct VelocityServo {
        classed {
            /// Gain of velocity.
            kv: f64;
        }
    }
}

table! {
    /// Parameters of a cylinder.
    pub struct Cylinder {
        classed {
            /// Time constant of pressure (s).
            timeconst: f64;
            /// Area (m^2).
            area: f64;
            /// Diameter (m), instead of the area.
            diameter: f64;
            /// Force without control: constant, by length, by velocity.
            bias: [f64; 3];
        }
    }
}

table! {
    /// Parameters of a muscle.
    pub struct Muscle {
        own {
            /// Smoothing between the two time constants.
            tausmooth: f64;
        }
        classed {
            /// Time constants of activation and deactivation (s).
            timeconst: [f64; 2];
            /// Operating length range, in units of the optimal length.
            range: [f64; 2];
            /// Peak active force (N); -1 is `scale` over the muscle's acceleration.
            force: f64;
            /// Force by which the former is computed.
            scale: f64;
            /// Shortest length that makes force, in units of the optimal length.
            lmin: f64;
            /// Longest one.
            lmax: f64;
            /// Velocity at which there is no force, in optimal lengths a second.
            vmax: f64;
            /// Passive force at `lmax`, in units of the peak force.
            fpmax: f64;
            /// Active force at the greatest lengthening velocity, in units of the peak force.
            fvmax: f64;
        }
    }
}

table! {
    /// The parameter of an adhesion actuator.
    pub struct Adhesion {
        classed {
            /// Force (N) by control.
            gain: f64;
        }
    }
}
