//! The task in numbers.

use crate::{Reward, Target, Task};
use myo_scalar::Real;

/// A task ready to run, with numbers of type `T`: plain ones as it is compiled, one per lane as it runs. Lengths m from the
/// shoulder centre, times in control steps, forces N.
///
/// What is no `T` is its structure: code is compiled for it. All numbers may differ between tasks of one structure.
#[derive(Clone, Debug, PartialEq)]
pub struct CompiledTask<T> {
    /// Targets in order.
    pub targets: Vec<TargetKind<T>>,
    /// Control steps until the episode is cut.
    pub time_limit: T,
    /// Reward weights.
    pub weights: Weights<T>,
}

/// [`Reward`] per control step.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights<T> {
    /// Per metre.
    pub distance: T,
    /// Count the distance from the surface.
    pub inside_is_zero: bool,
    /// Add the path over the targets still to come.
    pub remaining_path: bool,
    /// Per control step.
    pub time_cost: T,
    /// Per target done.
    pub subtask_bonus: T,
    /// For the whole task.
    pub completion_bonus: T,
    /// Per squared control.
    pub neural_effort: T,
    /// Per squared acceleration.
    pub acceleration_effort: T,
}

/// One target.
#[derive(Clone, Debug, PartialEq)]
pub enum TargetKind<T> {
    /// Stay inside.
    Sphere(Sphere<T>),
    /// Press.
    Button(Button<T>),
}

/// Where a sphere may lie and how long to stay in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere<T> {
    /// Corner of the box of centres.
    pub lo: [T; 3],
    /// Size of that box.
    pub extent: [T; 3],
    /// Least radius.
    pub radius: T,
    /// Greatest radius minus the least.
    pub radius_extent: T,
    /// Control steps to stay inside.
    pub dwell: T,
    /// Least distance from the target before.
    pub min_distance: T,
}

/// A button.
#[derive(Clone, Debug, PartialEq)]
pub struct Button<T> {
    /// Centre.
    pub centre: [T; 3],
    /// Own axes as columns: up the face, across it, out of it.
    pub axes: [[T; 3]; 3],
    /// Half sizes along the own axes.
    pub half_size: [T; 3],
    /// Force that counts as pressed.
    pub min_force: T,
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
            weights: Weights::new(&task.reward, task.control_dt_s),
        }
    }
}

impl<T> CompiledTask<T> {
    /// The buttons in order.
    pub fn buttons(&self) -> impl Iterator<Item = &Button<T>> {
        self.targets.iter().filter_map(|target| match target {
            TargetKind::Button(button) => Some(button),
            TargetKind::Sphere(_) => None,
        })
    }

    /// The same structure with other numbers: each is what `f` makes of this one, in a fixed order.
    pub fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> CompiledTask<U> {
        CompiledTask {
            targets: self.targets.iter().map(|target| target.map(f)).collect(),
            time_limit: f(&self.time_limit),
            weights: self.weights.map(f),
        }
    }
}

impl<T> TargetKind<T> {
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> TargetKind<U> {
        match self {
            Self::Sphere(sphere) => TargetKind::Sphere(sphere.map(f)),
            Self::Button(button) => TargetKind::Button(button.map(f)),
        }
    }
}

impl<T> Sphere<T> {
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Sphere<U> {
        Sphere {
            lo: self.lo.each_ref().map(&mut *f),
            extent: self.extent.each_ref().map(&mut *f),
            radius: f(&self.radius),
            radius_extent: f(&self.radius_extent),
            dwell: f(&self.dwell),
            min_distance: f(&self.min_distance),
        }
    }
}

impl<T> Button<T> {
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Button<U> {
        Button {
            centre: self.centre.each_ref().map(&mut *f),
            axes: self.axes.each_ref().map(|axis| axis.each_ref().map(&mut *f)),
            half_size: self.half_size.each_ref().map(&mut *f),
            min_force: f(&self.min_force),
            number: self.number,
        }
    }
}

impl<T> Weights<T> {
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Weights<U> {
        Weights {
            distance: f(&self.distance),
            inside_is_zero: self.inside_is_zero,
            remaining_path: self.remaining_path,
            time_cost: f(&self.time_cost),
            subtask_bonus: f(&self.subtask_bonus),
            completion_bonus: f(&self.completion_bonus),
            neural_effort: f(&self.neural_effort),
            acceleration_effort: f(&self.acceleration_effort),
        }
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
