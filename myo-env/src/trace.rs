//! Every physics step, for those who measure movements: a control step is far too long to tell a peak of speed or of force.

use myo_dynamics::{Plan, Workspace, step};
use myo_scalar::{Real, Scalar};

/// Columns ahead of the activations: the fingertip's three, and the force.
const BEFORE_ACTIVATIONS: usize = 4;

/// Sizes of what [`BatchEnv::step_traced`](crate::BatchEnv::step_traced) writes: of each environment `samples` rows of `columns`
/// numbers. A row is a physics step: where the fingertip is before it (m from the shoulder centre), the sum of all forces on the
/// fingertip in it (N), and the activations of all muscles after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceShape {
    /// Physics steps in a control step.
    pub samples: usize,
    /// Numbers of each.
    pub columns: usize,
    /// Physics steps per second.
    pub rate_hz: f64,
}

impl TraceShape {
    pub(crate) fn new<C: Real>(plan: &Plan<C>, substeps: u32, timestep: f64) -> Self {
        let columns = BEFORE_ACTIVATIONS + plan.nmuscle();
        Self { samples: substeps as usize, columns, rate_hz: timestep.recip() }
    }

    /// Numbers of each environment.
    pub fn len_per_env(&self) -> usize {
        self.samples * self.columns
    }
}

/// One row of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceSample<'a> {
    /// Where the fingertip is (m from the shoulder centre).
    pub fingertip: [f64; 3],
    /// Sum of all forces on it (N).
    pub force: f64,
    /// Activations of all muscles, in [0, 1].
    pub activations: &'a [f32],
}

impl<'a> TraceSample<'a> {
    /// A row that was written; one that is too short is not one.
    pub fn of(row: &'a [f32]) -> Option<Self> {
        let (&[x, y, z, force], activations) = row.split_first_chunk::<BEFORE_ACTIVATIONS>()?;
        Some(Self { fingertip: [x, y, z].map(f64::from), force: f64::from(force), activations })
    }
}

/// Appends the physics step that was just made.
#[inline(always)]
pub fn record<S: Scalar>(plan: &Plan<S::Const>, physics: &Workspace<S>, activations: &[S], trace: &mut Vec<S>) {
    trace.extend(step::fingertip(plan, physics));
    let mut force = S::zero();
    for contact in &physics.contacts {
        force += contact.force.only(contact.exists);
    }
    trace.push(force);
    trace.extend_from_slice(activations);
}
