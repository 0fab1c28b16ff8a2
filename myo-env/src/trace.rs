//! Every physics step, for those who measure movements: a control step is far too long to tell a peak of speed or of force.

use myo_dynamics::{Plan, State, Workspace, step};
use myo_scalar::{Real, Scalar};

/// Columns ahead of the joints: the fingertip's three, and the force.
const BEFORE_JOINTS: usize = 4;

/// Sizes of what [`BatchEnv::step_traced`](crate::BatchEnv::step_traced) writes: of each environment `samples` rows of `columns`
/// numbers. A row is a physics step: where the fingertip is before it (m from the shoulder centre), the sum of all forces on the
/// fingertip in it (N), positions and velocities of the independent joints (rad, rad/s; m, m/s for slides) and activations of all muscles after it,
/// and the forces with which muscles pulled in it (N).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceShape {
    /// Physics steps in a control step.
    pub samples: usize,
    /// Numbers of each.
    pub columns: usize,
    /// How many of them are of independent joints.
    pub joints: usize,
    /// How many of them are of muscles.
    pub muscles: usize,
    /// Physics steps per second.
    pub rate_hz: f64,
}

impl TraceShape {
    pub(crate) fn new<C: Real>(plan: &Plan<C>, substeps: u32, timestep: f64) -> Self {
        let (joints, muscles) = (plan.ndof(), plan.nmuscle());
        let columns = BEFORE_JOINTS + 2 * (joints + muscles);
        Self { samples: substeps as usize, columns, joints, muscles, rate_hz: timestep.recip() }
    }

    /// Numbers of each environment.
    pub fn len_per_env(&self) -> usize {
        self.samples * self.columns
    }

    /// A row that was written; one that is too short is not one.
    pub fn sample<'a>(&self, row: &'a [f32]) -> Option<TraceSample<'a>> {
        let (&[x, y, z, force], rest) = row.split_first_chunk::<BEFORE_JOINTS>()?;
        let (qpos, rest) = rest.split_at_checked(self.joints)?;
        let (qvel, rest) = rest.split_at_checked(self.joints)?;
        let (activations, muscle_forces) = rest.split_at_checked(self.muscles)?;
        let (fingertip, force) = ([x, y, z].map(f64::from), f64::from(force));
        Some(TraceSample { fingertip, force, qpos, qvel, activations, muscle_forces })
    }
}

/// One row of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceSample<'a> {
    /// Where the fingertip is (m from the shoulder centre).
    pub fingertip: [f64; 3],
    /// Sum of all forces on it (N).
    pub force: f64,
    /// Positions of the independent joints (rad; m for slides).
    pub qpos: &'a [f32],
    /// Velocities of the independent joints (rad/s; m/s for slides).
    pub qvel: &'a [f32],
    /// Activations of all muscles, in [0, 1].
    pub activations: &'a [f32],
    /// Forces with which muscles pull (N).
    pub muscle_forces: &'a [f32],
}

/// Appends the physics step that was just made.
#[inline(always)]
pub fn record<S: Scalar>(plan: &Plan<S::Const>, physics: &Workspace<S>, body: &State<S>, trace: &mut Vec<S>) {
    trace.extend(step::fingertip(plan, physics));
    let mut force = S::zero();
    for contact in physics.box_contacts().flatten() {
        force += contact.force.only(contact.exists);
    }
    trace.push(force);
    trace.extend_from_slice(&body.qpos);
    trace.extend_from_slice(&body.qvel);
    trace.extend_from_slice(&body.act);
    // Of an actuator that pulls the force is negative.
    trace.extend(physics.muscle_force[..plan.nmuscle()].iter().map(|&force| -force));
}
