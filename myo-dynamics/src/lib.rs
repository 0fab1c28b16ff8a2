//! Rigid-body dynamics of muscle-driven models: one physics, written once, in `f64` for one body and in lanes for many.
//!
//! - [`Plan`] is a model compiled into tables. [`Plan::exact`] is the reference, compared with MuJoCo; [`Plan::specialised`]
//!   computes the same from cheaper tables; [`Plan::cast`] rounds them.
//! - [`State`] is what changes from step to step, [`Workspace`] what a step computes on the way. The caller owns both;
//!   a step allocates nothing.
//! - [`step::step`] advances a state; [`step::forward`] stops at the acceleration.
//! - [`Obstacles`] are boxes to press with the fingertip, the forces on them are in [`Workspace::contacts`].
//! - [`Batch`] steps many bodies on all lanes and threads. Its results depend neither on threads nor on a body's place, bit
//!   for bit; other widths of lanes differ by rounding.
//! - Positions and rates are counted apart: [`Plan::nq`] numbers of `qpos` and [`Plan::ndof`] of `qvel`, in MuJoCo's order. They differ where
//!   a ball joint or a free body has a quaternion.
//! - [`Sensors`] read what a model's sensors measure, for whoever asks; a step knows nothing of them.
//! - [`ReachableSpace`] tells how near the fingertip comes to a point, [`Strength`] whether muscles can hold it there.
//!
//! Joint couplings are compiled away ([`CouplingMode::Reduced`]) or kept as MuJoCo's soft constraints ([`CouplingMode::Soft`]).
//! Joint limits and contacts are MuJoCo's soft constraints in both cases, solved to convergence. Positions are relative to
//! the shoulder centre in the zero pose ([`Plan::origin`] says where that is), x forward, y to the left, z up, in metres.
//!
//! ```
//! use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
//! use myo_model::{Model, builtin};
//!
//! let arm = Model::new(&builtin("mobl-arms")?)?;
//! let plan = Plan::exact(&arm, CouplingMode::Reduced)?;
//! let (mut state, mut ws) = (State::<f64>::new(&plan), Workspace::<f64>::new(&plan));
//! // A tenth of a second with all muscles at a tenth.
//! let ctrl = vec![0.1; plan.nmuscle()];
//! for _ in 0..50 {
//!     step::step(&plan, &Obstacles::none(&plan), &ctrl, &mut state, &mut ws);
//! }
//! let [x, y, z] = step::fingertip(&plan, &ws);
//! println!("The fingertip is at {x:.3}, {y:.3}, {z:.3} m.");
//! # assert!(z < 0.0 && x.is_finite() && y.is_finite());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The same on every core, a thousand bodies at once:
//!
//! ```
//! # use myo_dynamics::{Batch, CouplingMode, Plan};
//! # use myo_model::{Model, builtin};
//! use myo_scalar::Level;
//!
//! # let plan = Plan::exact(&Model::new(&builtin("mobl-arms")?)?, CouplingMode::Reduced)?;
//! let mut arms = Batch::new(&plan.specialised(), 1000, Level::detect()?);
//! arms.set_ctrl(7, &vec![0.5; plan.nmuscle()]);
//! arms.step(25);
//! assert!(arms.act(7)[0] > 0.4 && arms.act(8)[0] == 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! This crate does not know tasks, rewards, observations, random numbers of an environment, files or Python. So far it has
//! hinges, slides, ball joints and free bodies, bodies that are pinned and welded, muscle paths through points and over spheres and cylinders, one sphere that presses boxes, and contacts of
//! planes, spheres, capsules, ellipsoids, cylinders, boxes and convex meshes with each other but for two cylinders, in friction pyramids and cones; steps are semi-implicit, `implicitfast` or `implicit`; what it cannot simulate faithfully it refuses ([`PlanError`]); whether a model's numbers go together tells [`Plan::try_out`].

mod batch;
mod cast;
mod crowd;
mod exertion;
mod impedance;
mod isometric;
mod mesh;
mod native;
mod obstacles;
pub mod plan;
mod polynomial;
mod reach;
mod sense;
pub mod spatial;
pub mod step;
mod strength;
mod trial;
mod workspace;

pub use batch::Batch;
pub use crowd::{MovedBox, most_at_once};
pub use exertion::{Exerter, Exertion};
pub use isometric::{Isometric, Pull};
pub use myo_model::StaticBox;
pub use native::NotCompiled;
pub use obstacles::{Obstacles, Surface};
pub use plan::{CouplingMode, Plan, PlanError, Sensors};
pub use reach::{BodyPlaces, Nearest, PointerPlace, ReachableSpace};
pub use strength::Strength;
pub use workspace::{Clearance, SolverCount, SolverTally, State, Workspace};
