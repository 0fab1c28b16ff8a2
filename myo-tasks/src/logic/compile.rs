//! The task in numbers.

use crate::stage::{Action, Block, Object, Shape, Stage, Step};
use crate::{InvalidTask, Reward, Task};
use myo_scalar::Real;
use nalgebra::Vector3;

/// A task ready to run, with numbers of type `T`: plain ones as it is compiled, one per lane as it runs. Lengths m from the
/// shoulder centre, times in control steps, forces N.
///
/// What is no `T` is its structure: code is compiled for it. All numbers may differ between tasks of one structure, those
/// included that say which object a step asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct CompiledTask<T> {
    /// Spheres, in the order of the scene.
    pub spheres: Vec<DrawnSphere<T>>,
    /// Boxes that can be touched, in the order of the scene.
    pub boxes: Vec<TouchBox<T>>,
    /// What is to do, one after the other.
    pub steps: Vec<TaskStep<T>>,
    /// Which kinds of steps there are.
    pub kinds: Kinds,
    /// Control steps until the episode is cut.
    pub time_limit: T,
    /// Reward weights.
    pub weights: Weights<T>,
}

/// Kinds of steps that code is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds {
    /// Some step is a dwell.
    pub dwell: bool,
    /// Some step is a press.
    pub press: bool,
    /// It matters when a button is let go, and what else is pressed: some step asks to let go, or there are several presses or boxes.
    pub release: bool,
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
    /// Per press of a button that was not asked for.
    pub wrong_press: T,
    /// Per squared control.
    pub neural_effort: T,
    /// Per squared acceleration.
    pub acceleration_effort: T,
}

/// Where a sphere may lie.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnSphere<T> {
    /// Corner of the box of centres.
    pub lo: [T; 3],
    /// Size of that box.
    pub extent: [T; 3],
    /// Least radius.
    pub radius: T,
    /// Greatest radius minus the least.
    pub radius_extent: T,
    /// Least distance from the object before.
    pub min_distance: T,
    /// That object.
    pub previous: Option<Which>,
    /// Its number among all objects, which its random draws depend on.
    pub number: u32,
}

/// An object by its number among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// A sphere.
    Sphere(usize),
    /// A box.
    Box(usize),
}

/// A box that can be touched.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchBox<T> {
    /// Centre.
    pub centre: [T; 3],
    /// Own axes as columns: up the face, across it, out of it.
    pub axes: [[T; 3]; 3],
    /// Half sizes along the own axes.
    pub half_size: [T; 3],
    /// Radius of the ball around it.
    pub radius: T,
    /// Force that counts as pressed.
    pub min_force: T,
}

/// Something to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskStep<T> {
    /// One if it is a press, zero if it is a dwell.
    pub is_press: T,
    /// Number of the sphere or box.
    pub object: T,
    /// Control steps to stay in a sphere.
    pub dwell: T,
    /// One if the button must be let go, too.
    pub releases: T,
}

impl<C: Real> CompiledTask<C> {
    /// Works a task out.
    ///
    /// # Errors
    /// What is wrong with its values.
    pub fn new(task: &Task) -> Result<Self, InvalidTask> {
        let stage = task.stage()?;
        let numbers = Numbers::of(&stage);
        let sphere = |(number, object): (usize, &Object)| sphere(object, number, &numbers);
        let step = |step: &Step| TaskStep::new(step, numbers.0[step.object], task.control_dt_s);
        Ok(Self {
            spheres: stage.objects.iter().enumerate().filter_map(sphere).collect(),
            boxes: stage.objects.iter().filter_map(|object| object.block().map(TouchBox::new)).collect(),
            steps: stage.steps.iter().map(step).collect(),
            kinds: Kinds::of(&stage),
            time_limit: C::from_f64(f64::from(task.time_limit_steps())),
            weights: Weights::new(&task.reward, task.control_dt_s),
        })
    }
}

impl<T> CompiledTask<T> {
    /// The same structure with other numbers: each is what `f` makes of this one, in a fixed order.
    #[inline(always)]
    pub fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> CompiledTask<U> {
        CompiledTask {
            spheres: self.spheres.iter().map(|sphere| sphere.map(f)).collect(),
            boxes: self.boxes.iter().map(|each| each.map(f)).collect(),
            steps: self.steps.iter().map(|step| step.map(f)).collect(),
            kinds: self.kinds,
            time_limit: f(&self.time_limit),
            weights: self.weights.map(f),
        }
    }
}

impl Kinds {
    fn of(stage: &Stage) -> Self {
        let is_dwell = |step: &Step| matches!(step.action, Action::Dwell(_));
        let asks_for_release = |step: &Step| step.action == Action::PressAndRelease;
        let presses = stage.steps.iter().filter(|step| !is_dwell(step)).count();
        let boxes = stage.objects.iter().filter(|object| object.block().is_some()).count();
        Self {
            dwell: stage.steps.iter().any(is_dwell),
            press: presses > 0,
            release: stage.steps.iter().any(asks_for_release) || presses > 0 && presses.max(boxes) > 1,
        }
    }
}

/// Number of each object among those of its kind.
struct Numbers(Vec<Which>);

impl Numbers {
    fn of(stage: &Stage) -> Self {
        let (mut spheres, mut boxes) = (0.., 0..);
        let number = |object: &Object| match object.shape {
            Shape::Sphere(_) => Which::Sphere(spheres.next().expect("there is no end")),
            Shape::Button(_) | Shape::Obstacle(_) => Which::Box(boxes.next().expect("there is no end")),
        };
        Self(stage.objects.iter().map(number).collect())
    }
}

fn sphere<C: Real>(object: &Object, number: usize, numbers: &Numbers) -> Option<DrawnSphere<C>> {
    let c = C::from_f64;
    let sphere = object.sphere()?;
    let axes = [sphere.region.x, sphere.region.y, sphere.region.z];
    Some(DrawnSphere {
        lo: axes.map(|range| c(range.min)),
        extent: axes.map(|range| c(range.max - range.min)),
        radius: c(sphere.radius.min),
        radius_extent: c(sphere.radius.max - sphere.radius.min),
        min_distance: c(sphere.apart.map_or(0.0, |(_, least)| least)),
        previous: sphere.apart.map(|(previous, _)| numbers.0[previous]),
        number: number as u32,
    })
}

impl<T> DrawnSphere<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> DrawnSphere<U> {
        DrawnSphere {
            lo: self.lo.each_ref().map(&mut *f),
            extent: self.extent.each_ref().map(&mut *f),
            radius: f(&self.radius),
            radius_extent: f(&self.radius_extent),
            min_distance: f(&self.min_distance),
            previous: self.previous,
            number: self.number,
        }
    }
}

impl<C: Real> TouchBox<C> {
    fn new(block: &Block) -> Self {
        let c = C::from_f64;
        let column = |k: usize| [0, 1, 2].map(|row| c(block.rotation[(row, k)]));
        Self {
            centre: block.centre.map(c),
            axes: [column(0), column(1), column(2)],
            half_size: block.half_extents().map(c),
            radius: c(Vector3::from(block.half_extents()).norm()),
            min_force: c(block.min_force_n.min(f64::from(f32::MAX))),
        }
    }
}

impl<T> TouchBox<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> TouchBox<U> {
        TouchBox {
            centre: self.centre.each_ref().map(&mut *f),
            axes: self.axes.each_ref().map(|axis| axis.each_ref().map(&mut *f)),
            half_size: self.half_size.each_ref().map(&mut *f),
            radius: f(&self.radius),
            min_force: f(&self.min_force),
        }
    }
}

impl<T: Copy> TouchBox<T> {
    /// All numbers, in the order of the fields.
    #[inline(always)]
    pub(super) fn row(&self) -> [T; 17] {
        let ([x, y, z], [h, w, d]) = (self.centre, self.half_size);
        let [[a, b, c], [e, f, g], [i, j, k]] = self.axes;
        [x, y, z, a, b, c, e, f, g, i, j, k, h, w, d, self.radius, self.min_force]
    }

    /// The opposite of [`row`](Self::row).
    #[inline(always)]
    pub(super) fn from_row(row: [T; 17]) -> Self {
        let [x, y, z, a, b, c, e, f, g, i, j, k, h, w, d, radius, min_force] = row;
        Self { centre: [x, y, z], axes: [[a, b, c], [e, f, g], [i, j, k]], half_size: [h, w, d], radius, min_force }
    }
}

impl<C: Real> TaskStep<C> {
    fn new(step: &Step, which: Which, control_dt_s: f64) -> Self {
        let c = C::from_f64;
        let truth = |truth: bool| c(f64::from(u8::from(truth)));
        let (Which::Sphere(object) | Which::Box(object)) = which;
        Self {
            is_press: truth(step.dwell_s().is_none()),
            object: c(object as f64),
            dwell: c(f64::from(step.dwell_steps(control_dt_s))),
            releases: truth(step.action == Action::PressAndRelease),
        }
    }
}

impl<T> TaskStep<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> TaskStep<U> {
        TaskStep {
            is_press: f(&self.is_press),
            object: f(&self.object),
            dwell: f(&self.dwell),
            releases: f(&self.releases),
        }
    }
}

impl<T> Weights<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Weights<U> {
        Weights {
            distance: f(&self.distance),
            inside_is_zero: self.inside_is_zero,
            remaining_path: self.remaining_path,
            time_cost: f(&self.time_cost),
            subtask_bonus: f(&self.subtask_bonus),
            completion_bonus: f(&self.completion_bonus),
            wrong_press: f(&self.wrong_press),
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
            wrong_press: c(reward.wrong_press),
            neural_effort: c(reward.neural_effort),
            acceleration_effort: c(reward.acceleration_effort),
        }
    }
}
