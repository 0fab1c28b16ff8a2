//! One physics step, written once for every kind of number.
//!
//! Everything here is `#[inline(always)]`: code that is not inlined into its level's entry point would be compiled without
//! that level's instructions.

pub mod boxes;
pub mod cholesky;
mod cone;
mod connection;
pub mod constraint;
pub mod contact;
mod coriolis;
mod cuboid;
mod cylinder;
pub mod ellipsoid;
pub mod force;
mod gap;
mod implicit;
pub mod inertia;
pub mod kinematics;
pub(crate) mod lu;
mod mesh;
pub mod nearby;
pub mod pair;
mod support;
pub mod tendon;
pub mod tendon_limit;
pub mod wrap;

pub use cone::ConeSearch;
pub use coriolis::{Coriolis, Turning};
pub(crate) use mesh::seeds;
pub(crate) use pair::LOWEST;

use crate::obstacles::Obstacles;
use crate::plan::{DofKind, Plan};
use crate::spatial::{Vec3, turned_on};
use crate::workspace::{State, Workspace};
use myo_muscle::{ActivationDynamics, ForceCurves};
use myo_scalar::{Scalar, Stage};
use std::marker::PhantomData;

/// Advances the state by one time step under muscle excitations `ctrl` in [0, 1].
#[inline(always)]
pub fn step<S: Scalar>(
    plan: &Plan<S::Const>,
    obstacles: &Obstacles<S::Const, S>,
    ctrl: &[S],
    state: &mut State<S>,
    ws: &mut Workspace<S>,
) {
    forward(plan, obstacles, state, ws);
    integrate(plan, ctrl, state, ws);
}

/// Computes the acceleration and everything on the way to it; the state stays as it is.
#[inline(always)]
pub fn forward<S: Scalar>(
    plan: &Plan<S::Const>,
    obstacles: &Obstacles<S::Const, S>,
    state: &State<S>,
    ws: &mut Workspace<S>,
) {
    outlined::<S, Positions>(plan, obstacles, state, ws);
    outlined::<S, Paths>(plan, obstacles, state, ws);
    outlined::<S, Forces>(plan, obstacles, state, ws);
    outlined::<S, Constraints>(plan, obstacles, state, ws);
}

/// Part of a step that is a function of its own; see [`Scalar::outline`].
trait StepStage {
    const NAME: &'static str;
    fn apply<S: Scalar>(
        plan: &Plan<S::Const>,
        obstacles: &Obstacles<S::Const, S>,
        state: &State<S>,
        ws: &mut Workspace<S>,
    );
}

/// Where everything is and how fast it moves.
struct Positions;

impl StepStage for Positions {
    const NAME: &'static str = "positions";
    #[inline(always)]
    fn apply<S: Scalar>(plan: &Plan<S::Const>, _: &Obstacles<S::Const, S>, state: &State<S>, ws: &mut Workspace<S>) {
        kinematics::kinematics(plan, &state.qpos, &state.qvel, ws);
    }
}

/// Muscle paths and forces.
struct Paths;

impl StepStage for Paths {
    const NAME: &'static str = "muscle paths and forces";
    #[inline(always)]
    fn apply<S: Scalar>(plan: &Plan<S::Const>, _: &Obstacles<S::Const, S>, state: &State<S>, ws: &mut Workspace<S>) {
        tendon::lengths(plan, ws);
        tendon_limit::tendon_limits(plan, ws);
        muscle_forces(plan, state, ws);
    }
}

/// Generalised forces and the mass matrix.
struct Forces;

impl StepStage for Forces {
    const NAME: &'static str = "generalised forces and mass matrix";
    #[inline(always)]
    fn apply<S: Scalar>(plan: &Plan<S::Const>, _: &Obstacles<S::Const, S>, state: &State<S>, ws: &mut Workspace<S>) {
        force::passive(plan, state, ws);
        force::profiles(plan, ws);
        tendon::pull(plan, ws);
        inertia::resist(plan, ws);
        force::project(plan, ws);
        inertia::mass_matrix(plan, state, ws);
    }
}

/// Limits, couplings, contact, and the acceleration.
struct Constraints;

impl StepStage for Constraints {
    const NAME: &'static str = "constraints and acceleration";
    #[inline(always)]
    fn apply<S: Scalar>(
        plan: &Plan<S::Const>,
        obstacles: &Obstacles<S::Const, S>,
        state: &State<S>,
        ws: &mut Workspace<S>,
    ) {
        constraint::limits(plan, state, ws);
        constraint::equalities(plan, state, ws);
        connection::connections(plan, ws);
        contact::contact(plan, obstacles, state, ws);
        pair::pairs(plan, state, ws);
        constraint::solve(plan, ws);
    }
}

/// Runs a part in a function of its own.
#[inline(always)]
fn outlined<S: Scalar, P: StepStage>(
    plan: &Plan<S::Const>,
    obstacles: &Obstacles<S::Const, S>,
    state: &State<S>,
    ws: &mut Workspace<S>,
) {
    struct Call<'a, S: Scalar, P> {
        plan: &'a Plan<S::Const>,
        obstacles: &'a Obstacles<S::Const, S>,
        state: &'a State<S>,
        ws: &'a mut Workspace<S>,
        part: PhantomData<P>,
    }
    impl<S: Scalar, P: StepStage> Stage<S> for Call<'_, S, P> {
        const NAME: &'static str = P::NAME;
        type Output = ();
        #[inline(always)]
        fn run(self) {
            P::apply(self.plan, self.obstacles, self.state, self.ws);
        }
    }
    S::outline(Call { plan, obstacles, state, ws, part: PhantomData::<P> });
}

/// Fills `muscle_force`.
#[inline(always)]
pub fn muscle_forces<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    let nmuscle = plan.nmuscle();
    let inputs = [&ws.tendon_length[..], &ws.tendon_velocity[..], &state.act[..]];
    let curves = |muscle: usize| plan.muscles[muscle].curves.row();
    S::for_rows(curves, inputs, &mut ws.muscle_force[..nmuscle], |curves, [length, velocity, act], _| {
        ForceCurves::from_row(curves).force(length, velocity, act)
    });
    tendon::divide(plan, ws);
}

/// Semi-implicit Euler: new velocities first, then positions with them; activations beside.
#[inline(always)]
pub fn integrate<S: Scalar>(plan: &Plan<S::Const>, ctrl: &[S], state: &mut State<S>, ws: &mut Workspace<S>) {
    let h = S::splat(plan.timestep);
    // Before activations change.
    if plan.implicit_damping {
        damp_implicitly(plan, state, ws);
    } else {
        ws.step_qacc.copy_from_slice(&ws.qacc);
    }
    let dynamics = |muscle: usize| plan.muscles[muscle].dynamics.row();
    let is_smooth = plan.smooth_activation;
    S::for_rows(dynamics, [ctrl], &mut state.act, |dynamics, [excitation], act| {
        ActivationDynamics::from_row(dynamics).rate(is_smooth, excitation, act).mul_add(h, act)
    });
    for (k, dof) in plan.dofs.iter().enumerate() {
        state.qvel[k] = ws.step_qacc[k].mul_add(h, state.qvel[k]);
        if dof.kind != DofKind::Turn {
            state.qpos[dof.at] = state.qvel[k].mul_add(h, state.qpos[dof.at]);
        }
    }
    for ball in &plan.balls {
        let velocity = Vec3::new(state.qvel[ball.dof], state.qvel[ball.dof + 1], state.qvel[ball.dof + 2]);
        let turned = turned_on([0, 1, 2, 3].map(|k| state.qpos[ball.at + k]), velocity, h);
        state.qpos[ball.at..ball.at + 4].copy_from_slice(&turned);
    }
}

/// Damping at the end of the step instead of its beginning: `(M + h B) step_qacc = M qacc`, MuJoCo's `eulerdamp`, with muscles as dampers its `implicitfast`, and with Coriolis
/// forces its `implicit`, whose matrix is not symmetric. The forces of constraints stay those of the explicit acceleration.
#[inline(always)]
fn damp_implicitly<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    let n = plan.ndof();
    cholesky::product(&plan.elimination, &ws.mass, &ws.qacc, &mut ws.step_qacc);
    let h = S::splat(plan.timestep);
    cholesky::copy(&plan.elimination, &ws.mass, &mut ws.matrix);
    for (k, dof) in plan.dofs.iter().enumerate() {
        ws.matrix[k * n + k] += h * S::splat(dof.damping);
    }
    for joint in &plan.curved_joints {
        let slope = kinematics::joint_state(&joint.drive, &state.qpos, &state.qvel).slope;
        let dof = joint.drive.dof.expect("curved joints follow a coordinate");
        ws.matrix[dof * n + dof] += h * S::splat(joint.damping) * slope * slope;
    }
    if !plan.implicit_muscles.is_empty() {
        implicit::resist(plan, state, ws);
    }
    match &plan.unsymmetric {
        None => cholesky::factor_and_solve(&plan.elimination, &mut ws.matrix, &mut ws.pivot, &mut ws.step_qacc),
        Some(elimination) => {
            lu::mirror(elimination, &mut ws.matrix);
            coriolis::resist(plan, state, ws);
            lu::factor_and_solve(elimination, &mut ws.matrix, &mut ws.pivot, &mut ws.step_qacc);
        }
    }
}

/// Positions of the fingers that the plan [keeps](Plan::with_fingers) (m, from the shoulder centre), after [`kinematics::kinematics`].
#[inline(always)]
pub fn fingers<S: Scalar>(plan: &Plan<S::Const>, ws: &Workspace<S>) -> impl Iterator<Item = [S; 3]> {
    plan.fingers.iter().map(|point| ws.uncarried(ws.place(point)).array())
}

/// Position of the fingertip (m, from the shoulder centre), after [`kinematics::kinematics`].
#[inline(always)]
pub fn fingertip<S: Scalar>(plan: &Plan<S::Const>, ws: &Workspace<S>) -> [S; 3] {
    ws.uncarried(ws.place(&plan.fingertip)).array()
}
