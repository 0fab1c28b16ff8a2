//! Why there is no plan of a model.

use myo_nearest::Nearest;

/// Why a model cannot be simulated faithfully.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[non_exhaustive]
pub enum PlanError {
    /// More than one collision shape that presses.
    #[error(
        "geom '{name}': one sphere of each finger touches the boxes of a task, and there is another; remove this geom, name it in a contact, or let a finger have it (`fingers` of the landmarks)"
    )]
    TooManyGeoms {
        /// The geom.
        name: String,
    },
    /// A collision shape that is not a sphere.
    #[error("geom '{name}' is a box; only a sphere can collide with the boxes of a task so far")]
    NotASphere {
        /// The geom.
        name: String,
    },
    /// A ray is asked for, and the model does not tell where the arm is.
    #[error(
        "the model does not tell where its {missing} is, which a ray begins at; name the body in its landmarks (`{missing}: NAME`)"
    )]
    NoArm {
        /// What is missing.
        missing: &'static str,
    },
    /// A finger is asked for that the model does not have.
    #[error(
        "the model has no finger `{name}`; {nearest}; fingers are named in its landmarks (`fingers: {{{name}: SITE}}`)"
    )]
    NoFinger {
        /// Its name.
        name: String,
        /// Names that there are.
        nearest: Nearest,
    },
    /// A finger is to press that has nothing to press with.
    #[error(
        "the finger `{name}` has no ball at its tip that presses; give its body a geom (a sphere) that no contact names"
    )]
    PressesNothing {
        /// Its name.
        name: String,
    },
    /// A contact of shapes that are not compared.
    #[error(
        "contact of geoms '{}' and '{}': all shapes touch each other but two planes and two cylinders; give one of the two another shape",
        .geoms[0], .geoms[1]
    )]
    UnlikeParts {
        /// The geoms.
        geoms: [String; 2],
    },
    /// A limit of a tendon that moves nothing in the reference pose.
    #[error(
        "muscle '{muscle}': no joint changes the length of its tendon in the zero pose, so that its limit would be as hard as nothing is; leave out `limit`, or let its path run beside a joint"
    )]
    StuckTendon {
        /// The muscle.
        muscle: String,
    },
    /// Inertia in the reference pose is singular.
    #[error("joint '{joint}' moves no mass and has no armature; give it an armature (kg m^2) above zero")]
    Singular {
        /// The joint.
        joint: String,
    },
    /// A body of a task that is not held.
    #[error(
        "joint '{joint}' moves in several ways at once; bodies that do tasks are held by hinges and slides so far: lock it \
         (`myo model import --lock {joint}`), or make hinges of it"
    )]
    NotHeld {
        /// The joint, of a kind that has several coordinates.
        joint: String,
    },
    /// All joints are held.
    #[error("no joint can move: every one is coupled to a constant; free at least one")]
    NothingMoves,
    /// There is nothing to control.
    #[error("the model has no muscles; give it at least one")]
    NoMuscles,
    /// Explicit damping that a time step overshoots.
    #[error(
        "joint '{joint}': a damping of {damping} at an inertia of {inertia} swings ever wider in time steps of {timestep_s} s; \
         set `options.implicit_joint_damping` to true, or the damping to at most {most}"
    )]
    Overdamped {
        /// The joint.
        joint: String,
        /// Its damping, with that of joints that follow it (N m s/rad or N s/m).
        damping: f64,
        /// Its inertia in the reference pose (kg m^2 or kg).
        inertia: f64,
        /// Time step (s).
        timestep_s: f64,
        /// The greatest damping that is safe.
        most: f64,
    },
    /// A spring that swings faster than time steps follow.
    #[error(
        "joint '{joint}': a stiffness of {stiffness} at an inertia of {inertia} swings too fast for time steps of \
         {timestep_s} s; set it to at most {most}, or take a smaller `options.timestep`"
    )]
    TooStiff {
        /// The joint.
        joint: String,
        /// Stiffness of its spring, with those of joints that follow it (N m/rad or N/m).
        stiffness: f64,
        /// Its inertia in the reference pose (kg m^2 or kg).
        inertia: f64,
        /// Time step (s).
        timestep_s: f64,
        /// The greatest stiffness that is safe.
        most: f64,
    },
    /// The simulation ran away, see [`Plan::try_out`].
    #[error(
        "joint '{joint}' runs away after {time_s} s of random controls: its forces are too strong for its inertia and time steps \
         of {timestep_s} s; look at the masses, springs, limits and muscles that act on it"
    )]
    Unstable {
        /// The joint.
        joint: String,
        /// After how many seconds of simulated time.
        time_s: f64,
        /// Time step (s).
        timestep_s: f64,
    },
}
