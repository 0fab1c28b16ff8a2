//! What holds for the whole simulation: options, flags, sizes, statistics.

use crate::reading::Partly;
use crate::table::table;
use crate::value::{Switch, keywords};

keywords! {
    /// How time is integrated.
    pub enum Integrator {
        /// Semi-implicit Euler.
        Euler = "Euler",
        /// Runge-Kutta of fourth order.
        Rk4 = "RK4",
        /// Implicit in velocity.
        Implicit = "implicit",
        /// Implicit in velocity, without Coriolis terms.
        ImplicitFast = "implicitfast",
        /// Implicit in velocity and constraints (MuJoCo 4).
        Discrete = "discrete",
    }

    /// The shape of friction cones.
    pub enum Cone {
        /// Pyramids.
        Pyramidal = "pyramidal",
        /// Ellipses.
        Elliptic = "elliptic",
    }

    /// How the constraint Jacobian is stored.
    pub enum Jacobian {
        /// As a full matrix.
        Dense = "dense",
        /// As a sparse matrix.
        Sparse = "sparse",
        /// Sparse for 60 or more degrees of freedom.
        Auto = "auto",
    }

    /// How constraint forces are computed.
    pub enum Solver {
        /// Projected Gauss-Seidel.
        Pgs = "PGS",
        /// Conjugate gradients.
        Cg = "CG",
        /// Newton.
        Newton = "Newton",
    }
}

table! {
    /// How the model is simulated.
    pub struct Options {
        own {
            /// Time step (s).
            timestep: f64 = 0.002;
            /// Ratio of frictional to normal impedance.
            impratio: f64 = 1.0;
            /// Relative improvement at which the solver stops.
            tolerance: f64 = 1e-8;
            /// The same for its line search.
            ls_tolerance: f64 = 0.01;
            /// The same for the solver against slip.
            noslip_tolerance: f64 = 1e-6;
            /// The same for collisions of convex shapes.
            ccd_tolerance: f64 = 1e-6;
            /// Velocity below which bodies fall asleep.
            sleep_tolerance: f64 = 1e-3;
            /// Acceleration of gravity (m/s^2).
            gravity: [f64; 3] = [0.0, 0.0, -9.81];
            /// Velocity of the medium (m/s).
            wind: [f64; 3] = [0.0; 3];
            /// Magnetic flux.
            magnetic: [f64; 3] = [0.0, -0.5, 0.0];
            /// Density of the medium (kg/m^3).
            density: f64 = 0.0;
            /// Viscosity of the medium (kg/(m s)).
            viscosity: f64 = 0.0;
            /// Margin of all contacts if `override` is on (m).
            o_margin: f64 = 0.0;
            /// Softness of all contacts if `override` is on.
            o_solref: [f64; 2] as Partly = [0.02, 1.0];
            /// Impedance of all contacts if `override` is on.
            o_solimp: [f64; 5] as Partly = [0.9, 0.95, 0.001, 0.5, 2.0];
            /// Friction of all contacts if `override` is on.
            o_friction: [f64; 5] as Partly = [1.0, 1.0, 0.005, 0.0001, 0.0001];
            /// How time is integrated.
            integrator: Integrator = Integrator::Euler;
            /// The shape of friction cones.
            cone: Cone = Cone::Pyramidal;
            /// How the constraint Jacobian is stored.
            jacobian: Jacobian = Jacobian::Auto;
            /// How constraint forces are computed.
            solver: Solver = Solver::Newton;
            /// Most iterations of the solver.
            iterations: i32 = 100;
            /// Most iterations of its line search.
            ls_iterations: i32 = 50;
            /// Iterations of the solver against slip.
            noslip_iterations: i32 = 0;
            /// Most iterations of collisions of convex shapes.
            ccd_iterations: i32 = 35;
            /// Most iterations of collisions of distance fields.
            sdf_iterations: i32 = 10;
            /// Starting points of collisions of distance fields.
            sdf_initpoints: i32 = 40;
            /// Groups of actuators that are off.
            actuatorgroupdisable: Vec<i32>;
            /// Steps a second of a socket (before MuJoCo 3.4; it has no effect).
            apirate: f64;
            /// Older name of `ccd_tolerance` (before MuJoCo 3.2.3).
            mpr_tolerance: f64;
            /// Older name of `ccd_iterations` (before MuJoCo 3.2.3).
            mpr_iterations: i32;
        }
    }
}

table! {
    /// Parts of the simulation that can be switched.
    pub struct Flags {
        own {
            /// All constraints.
            constraint: Switch = Switch::On;
            /// Equality constraints.
            equality: Switch = Switch::On;
            /// Dry friction of joints and tendons.
            frictionloss: Switch = Switch::On;
            /// Limits of joints and tendons.
            limit: Switch = Switch::On;
            /// Contacts.
            contact: Switch = Switch::On;
            /// Springs and dampers (before MuJoCo 3.3.4).
            passive: Switch = Switch::On;
            /// Springs.
            spring: Switch = Switch::On;
            /// Dampers.
            damper: Switch = Switch::On;
            /// Gravity.
            gravity: Switch = Switch::On;
            /// Clamping of controls to their range.
            clampctrl: Switch = Switch::On;
            /// Start of the solver from the last step.
            warmstart: Switch = Switch::On;
            /// No contact between a body and its parent.
            filterparent: Switch = Switch::On;
            /// Actuator forces.
            actuation: Switch = Switch::On;
            /// Time constants at least twice the time step.
            refsafe: Switch = Switch::On;
            /// Sensors.
            sensor: Switch = Switch::On;
            /// Collisions between parts of bodies found by trees.
            midphase: Switch = Switch::On;
            /// Implicit joint damping with Euler.
            eulerdamp: Switch = Switch::On;
            /// Reset when numbers become too large.
            autoreset: Switch = Switch::On;
            /// MuJoCo's own collision of convex shapes.
            nativeccd: Switch = Switch::On;
            /// Islands of constraints.
            island: Switch = Switch::On;
            /// Several contacts between flat sides. Off before MuJoCo 3.9.
            multiccd: Switch = Switch::On;
            /// Contact parameters of the options for all.
            overriding "override": Switch = Switch::Off;
            /// Computation of energy.
            energy: Switch = Switch::Off;
            /// Comparison of forward and inverse dynamics.
            fwdinv: Switch = Switch::Off;
            /// Inverse dynamics of discrete time.
            invdiscrete: Switch = Switch::Off;
            /// Noise of sensors (before MuJoCo 3.1.4).
            sensornoise: Switch = Switch::Off;
            /// Sleep of bodies.
            sleep: Switch = Switch::Off;
            /// Exact diagonal of the constraint inertia.
            diagexact: Switch = Switch::Off;
            /// Incremental potential contact.
            ipc: Switch = Switch::Off;
            /// Contacts ahead of time.
            speculative: Switch = Switch::Off;
        }
    }
}

table! {
    /// Sizes of memory.
    pub struct Sizes {
        own {
            /// Memory, in bytes with an optional K, M, G and so on, as text.
            memory: String;
            /// Most scalar constraints (older models).
            njmax: i32 = -1;
            /// Most contacts (older models).
            nconmax: i32 = -1;
            /// Numbers on the stack (older models).
            nstack: i32 = -1;
            /// Numbers of user data.
            nuserdata: i32 = 0;
            /// Stored states.
            nkey: i32 = 0;
            /// Numbers of the user in bodies; -1 is as many as needed.
            nuser_body: i32 = -1;
            /// Numbers of the user in joints.
            nuser_jnt: i32 = -1;
            /// Numbers of the user in geoms.
            nuser_geom: i32 = -1;
            /// Numbers of the user in sites.
            nuser_site: i32 = -1;
            /// Numbers of the user in cameras.
            nuser_cam: i32 = -1;
            /// Numbers of the user in tendons.
            nuser_tendon: i32 = -1;
            /// Numbers of the user in actuators.
            nuser_actuator: i32 = -1;
            /// Numbers of the user in sensors.
            nuser_sensor: i32 = -1;
        }
    }
}

table! {
    /// Typical sizes, for what is seen; where nothing is said MuJoCo computes them.
    pub struct Statistic {
        own {
            /// Mean diagonal of the inertia matrix.
            meaninertia: f64;
            /// Mean mass of bodies (kg).
            meanmass: f64;
            /// Mean size of bodies (m).
            meansize: f64;
            /// Half size of the model (m).
            extent: f64;
            /// Its centre (m).
            center: [f64; 3];
        }
    }
}
