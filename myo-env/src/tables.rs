//! Everything about a model and a task that stays fixed, in the precision of the backend.

use crate::config::BuildError;
use crate::observe::{self, ObservationPart};
use crate::saved::Identity;
use myo_dynamics::{CouplingMode, Obstacles, Plan, StaticBox, Surface};
use myo_model::Model;
use myo_scalar::{Real, Scalar};
use myo_tasks::logic::CompiledTask;
use myo_tasks::{InvalidTask, Pose, Reset, Target, Task};

/// Constants of one environment.
#[derive(Clone, Debug)]
pub struct Tables<C> {
    /// The body.
    pub plan: Plan<C>,
    /// What it can touch.
    pub obstacles: Obstacles<C>,
    /// What it is to do.
    pub task: CompiledTask<C>,
    /// Physics steps per control step.
    pub substeps: u32,
    /// Parts of the observation, in order.
    pub observation: Vec<ObservationPart>,
    /// Standard deviations of motor noise: signal-dependent, constant.
    pub noise: Option<[C; 2]>,
    /// How episodes begin.
    pub start: Start<C>,
    /// Which model and task these are.
    pub(crate) identity: Identity,
}

/// Distribution of the body's state at the start of an episode.
#[derive(Clone, Debug)]
pub struct Start<C> {
    /// Joint positions.
    pub pose: Poses<C>,
    /// Joint positions where environments explore: within all that the joints allow.
    pub any_pose: Poses<C>,
    /// Greatest speed, either way.
    pub speed: C,
    /// Greatest activation.
    pub activation: C,
}
/// Joint positions, uniform in intervals (rad).
#[derive(Clone, Debug)]
pub struct Poses<C> {
    lowest: Vec<C>,
    width: Vec<C>,
}

impl<C: Real> Poses<C> {
    fn new(intervals: impl Iterator<Item = [f64; 2]>) -> Self {
        let (lowest, width) = intervals.map(|[lo, hi]| (C::from_f64(lo), C::from_f64(hi - lo))).unzip();
        Self { lowest, width }
    }

    /// A pose, from a number in [0, 1) per coordinate.
    #[inline(always)]
    pub fn at<S: Scalar<Const = C>>(&self, draws: Vec<S>) -> impl Iterator<Item = S> {
        let within = |((draw, &lowest), &width): ((S, _), _)| draw.mul_add(S::splat(width), S::splat(lowest));
        draws.into_iter().zip(&self.lowest).zip(&self.width).map(within)
    }
}

impl<C: Real> Tables<C> {
    /// Compiles a model and a task, with the specialised plan.
    ///
    /// # Errors
    /// The task has values out of bounds, or the model cannot be simulated.
    pub fn new(model: &Model, task: &Task) -> Result<Self, BuildError> {
        Self::with_plan(model, task, |exact| exact.specialised().cast())
    }

    /// The same with the exact plan, which the specialised one is compared with.
    ///
    /// # Errors
    /// As for [`Tables::new`].
    pub fn exact(model: &Model, task: &Task) -> Result<Self, BuildError> {
        Self::with_plan(model, task, |exact| exact.cast())
    }

    fn with_plan(model: &Model, task: &Task, plan: impl Fn(&Plan<f64>) -> Plan<C>) -> Result<Self, BuildError> {
        task.check_values()?;
        let task = task.clone().expanded();
        let exact = Plan::exact(model, CouplingMode::Reduced)?;
        task.check_control_step(exact.timestep).map_err(InvalidTask::from)?;
        let plan = plan(&exact);
        let noise = &task.noise;
        let noisy = noise.signal_dependent > 0.0 || noise.constant > 0.0;
        let buttons: Vec<StaticBox> = task.targets.iter().filter_map(button).collect();
        Ok(Self {
            obstacles: Obstacles::new(&plan, &buttons, Surface::default()),
            substeps: task.substeps(exact.timestep),
            observation: observe::parts(&task.observation),
            noise: noisy.then(|| [noise.signal_dependent, noise.constant].map(C::from_f64)),
            start: start(&task, &exact),
            identity: Identity::new(model, &task),
            task: CompiledTask::new(&task),
            plan,
        })
    }
}

fn button(target: &Target) -> Option<StaticBox> {
    let Target::Pressing(button) = target else { return None };
    let rotation = button.rotation();
    let column = |k: usize| [0, 1, 2].map(|row| rotation[(row, k)]);
    Some(StaticBox {
        centre: button.position,
        axes: [column(0), column(1), column(2)],
        half_size: button.half_extents(),
    })
}

fn start<C: Real>(task: &Task, plan: &Plan<f64>) -> Start<C> {
    let reset = &task.reset;
    let poses = |pose| Poses::new(plan.dofs.iter().map(|dof| interval(reset, pose, dof.range)));
    let speed = if reset.pose == Pose::Zero { 0.0 } else { reset.velocity_spread_rad_s };
    Start {
        pose: poses(reset.pose),
        any_pose: poses(Pose::RangeUniform),
        speed: C::from_f64(speed),
        activation: C::from_f64(reset.activation_max),
    }
}

/// From where a joint of this range is drawn.
fn interval(reset: &Reset, pose: Pose, range: Option<[f64; 2]>) -> [f64; 2] {
    match (pose, range) {
        (Pose::Zero, _) => [0.0, 0.0],
        (Pose::RangeUniform, Some(range)) => range,
        // A joint without limits has no range to draw from.
        (Pose::NearZero, None) | (Pose::RangeUniform, None) => [-reset.pose_spread_rad, reset.pose_spread_rad],
        (Pose::NearZero, Some([lo, hi])) => [-reset.pose_spread_rad, reset.pose_spread_rad].map(|q| q.clamp(lo, hi)),
    }
}
