//! The task in numbers.

use crate::{Reward, Target, Task};
use myo_scalar::Real;

/// A task ready to run, in precision `C`. Lengths m from the shoulder centre, times in control steps, forces N.
#[derive(Clone, Debug)]
pub struct CompiledTask<C> {
    /// Targets in order.
    pub targets: Vec<TargetKind<C>>,
    /// Control steps until the episode is cut.
    pub time_limit: C,
    /// Seconds per control step.
    pub control_dt: C,
    /// Reward weights.
    pub weights: Weights<C>,
}

/// [`Reward`] per control step.
#[derive(Clone, Debug)]
pub struct Weights<C> {
    /// Per metre.
    pub distance: C,
    /// Count the distance from the surface.
    pub inside_is_zero: bool,
    /// Add the path over the targets still to come.
    pub remaining_path: bool,
    /// Per control step.
    pub time_cost: C,
    /// Per target done.
    pub subtask_bonus: C,
    /// For the whole task.
    pub completion_bonus: C,
    /// Per squared control.
    pub neural_effort: C,
    /// Per squared acceleration.
    pub acceleration_effort: C,
}

/// One target.
#[derive(Clone, Debug)]
pub enum TargetKind<C> {
    /// Stay inside.
    Sphere(Sphere<C>),
    /// Press.
    Button(Button<C>),
}

/// Where a sphere may lie and how long to stay in it.
#[derive(Clone, Debug)]
pub struct Sphere<C> {
    /// Corner of the box of centres.
    pub lo: [C; 3],
    /// Size of that box.
    pub extent: [C; 3],
    /// Least radius.
    pub radius: C,
    /// Greatest radius minus the least.
    pub radius_extent: C,
    /// Control steps to stay inside.
    pub dwell: C,
    /// Least distance from the target before.
    pub min_distance: C,
}

/// A button.
#[derive(Clone, Debug)]
pub struct Button<C> {
    /// Centre.
    pub centre: [C; 3],
    /// Own axes as columns: up the face, across it, out of it.
    pub axes: [[C; 3]; 3],
    /// Half sizes along the own axes.
    pub half_size: [C; 3],
    /// Force that counts as pressed.
    pub min_force: C,
    /// Its number among the task's buttons.
    pub number: usize,
}

impl<C: Real> CompiledTask<C> {
    /// Works a task out.
    pub fn new(task: &Task) -> Self {
        let c = C::from_f64;
        let task = task.clone().expanded();
        let mut buttons = 0;
        let targets = (0..task.targets.len()).map(|index| target(&task, index, &mut buttons)).collect();
        Self {
            targets,
            time_limit: c(f64::from(task.time_limit_steps())),
            control_dt: c(task.control_dt_s),
            weights: Weights::new(&task.reward, task.control_dt_s),
        }
    }

    /// The buttons in order.
    pub fn buttons(&self) -> impl Iterator<Item = &Button<C>> {
        self.targets.iter().filter_map(|target| match target {
            TargetKind::Button(button) => Some(button),
            TargetKind::Sphere(_) => None,
        })
    }
}

impl<C: Real> Weights<C> {
    fn new(reward: &Reward, control_dt_s: f64) -> Self {
        let c = C::from_f64;
        Self {
            distance: c(reward.distance),
            inside_is_zero: reward.inside_is_zero,
            remaining_path: reward.remaining_path,
            time_cost: c(reward.time_cost * control_dt_s),
            subtask_bonus: c(reward.subtask_bonus),
            completion_bonus: c(reward.completion_bonus),
            neural_effort: c(reward.neural_effort),
            acceleration_effort: c(reward.acceleration_effort),
        }
    }
}

fn target<C: Real>(task: &Task, index: usize, buttons: &mut usize) -> TargetKind<C> {
    let c = C::from_f64;
    match &task.targets[index] {
        Target::Pointing(sphere) => {
            let axes = [sphere.position.x, sphere.position.y, sphere.position.z];
            TargetKind::Sphere(Sphere {
                lo: axes.map(|range| c(range.min)),
                extent: axes.map(|range| c(range.max - range.min)),
                radius: c(sphere.radius.min),
                radius_extent: c(sphere.radius.max - sphere.radius.min),
                dwell: c(f64::from(task.dwell_steps(index))),
                min_distance: c(if index == 0 { 0.0 } else { sphere.min_distance() }),
            })
        }
        Target::Pressing(button) => {
            *buttons += 1;
            let rotation = button.rotation();
            let column = |k: usize| [0, 1, 2].map(|row| c(rotation[(row, k)]));
            TargetKind::Button(Button {
                centre: button.position.map(c),
                axes: [column(0), column(1), column(2)],
                half_size: button.half_extents().map(c),
                min_force: c(button.min_force_n),
                number: *buttons - 1,
            })
        }
    }
}
