//! Vehicles: what a stick drives along a line, and where it must stop.
//!
//! The stick accelerates it, drag slows it, and at the ends of its line it stops. Between the ends of two control steps it is followed at every
//! physics step, as the stick is.

use super::{CompiledTask, Point, TaskState, difference, goal, is_same, norm, swing};
use crate::flat::{Action, FlatTask, Object, Shape, Step};
use myo_scalar::{Real, Scalar};
use nalgebra::Vector3;

/// How a step wants a vehicle; zeros where it is about none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveStep<T> {
    /// One if it is about a vehicle.
    pub is_drive: T,
    /// Number of the vehicle among spheres,
    pub vehicle: T,
    /// and of the sphere in which it must stop.
    pub into: T,
    /// Acceleration per angle of the stick (m/s^2/rad).
    pub push: T,
    /// Share of its speed that it loses by time (1/s).
    pub drag: T,
    /// How far it may go from its place to either side (m).
    pub half: T,
    /// How slow it must be where it stops (m/s).
    pub slower_than: T,
}

/// Where vehicles are on their lines.
#[derive(Clone, Debug)]
pub struct Vehicles<S> {
    /// Per sphere, how far it is off its place (m).
    pub along: Vec<S>,
    /// Speed of the current one (m/s); all others stand still.
    pub speed: S,
}

/// Where the current vehicle is, followed to the physics step.
#[derive(Clone, Copy, Debug)]
pub struct Ride<S> {
    /// How far it is off its place (m).
    pub along: S,
    /// Its speed (m/s).
    pub speed: S,
}

/// A vehicle that is to be driven.
#[derive(Clone, Copy, Debug)]
pub struct GoalDrive<S: Scalar> {
    /// Where the step is about a vehicle; the rest means nothing elsewhere.
    pub is_drive: S::Mask,
    /// What the step says, see [`DriveStep`].
    pub step: DriveStep<S>,
    /// Along its line, to where it goes when the angle of the stick rises.
    pub line: Point<S>,
    /// From its place to where it must stop (m).
    pub to: Point<S>,
    /// How far off that it may be (m).
    pub within: S,
    /// Where it is at the beginning of the control step.
    pub ride: Ride<S>,
}

/// Unit vector along the line of a vehicle; zeros of what is none.
pub(super) fn line<C: Real>(object: &Object) -> [C; 3] {
    let driven = object.sphere().and_then(|sphere| sphere.path.as_ref()?.driven);
    let line = driven.map_or(Vector3::zeros(), |driven| Vector3::from(driven.by).normalize());
    <[f64; 3]>::from(line).map(C::from_f64)
}

impl<C: Real> DriveStep<C> {
    /// `number` gives the number of an object among spheres.
    pub(super) fn new(step: &Step, flat: &FlatTask, number: impl Fn(usize) -> C) -> Self {
        Self::asked(step, flat, number).unwrap_or_else(|| {
            let o = C::from_f64(0.0);
            Self { is_drive: o, vehicle: o, into: o, push: o, drag: o, half: o, slower_than: o }
        })
    }

    fn asked(step: &Step, flat: &FlatTask, number: impl Fn(usize) -> C) -> Option<Self> {
        let Action::Drive { vehicle, into, slower_than } = step.action else { return None };
        let driven = flat.objects[vehicle].sphere()?.path.as_ref()?.driven?;
        let Shape::Stick(stick) = &flat.objects[step.object].shape else { return None };
        let full = stick.range.min.abs().max(stick.range.max.abs());
        let c = C::from_f64;
        Some(Self {
            is_drive: c(1.0),
            vehicle: number(vehicle),
            into: number(into),
            push: c(driven.acceleration / full),
            drag: c(driven.drag),
            half: c(Vector3::from(driven.by).norm()),
            slower_than: c(slower_than),
        })
    }
}

impl<T> DriveStep<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> DriveStep<U> {
        DriveStep {
            is_drive: f(&self.is_drive),
            vehicle: f(&self.vehicle),
            into: f(&self.into),
            push: f(&self.push),
            drag: f(&self.drag),
            half: f(&self.half),
            slower_than: f(&self.slower_than),
        }
    }
}

impl<S: Scalar> Vehicles<S> {
    /// Before the first episode of a task with so many spheres.
    #[inline(always)]
    pub(super) fn new(spheres: usize) -> Self {
        Self { along: vec![S::zero(); spheres], speed: S::zero() }
    }

    /// Every number, in a fixed order.
    #[inline(always)]
    pub(super) fn numbers(&mut self) -> impl Iterator<Item = &mut S> {
        let Self { along, speed } = self;
        along.iter_mut().chain([speed])
    }

    /// Takes over what became of the current vehicle; it stands where the step is done.
    #[inline(always)]
    pub(super) fn update(&mut self, goal: &GoalDrive<S>, ride: &Ride<S>, done: S::Mask) {
        for (number, along) in self.along.iter_mut().enumerate() {
            let is_it = goal.is_drive & is_same(goal.step.vehicle, S::lit(number as f64));
            *along = S::select(is_it, ride.along, *along);
        }
        self.speed = ride.speed.only(goal.is_drive & !done);
    }
}

/// How far the sphere of this number is off its place because it was driven (m).
#[inline(always)]
pub(super) fn driven<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, number: S) -> Point<S> {
    let Some(vehicles) = &state.vehicles else { return [S::zero(); 3] };
    let row = |k: usize| {
        let ([x, y, z], along) = (task.lines[k], vehicles.along[k]);
        [x * along, y * along, z * along]
    };
    S::gather(task.lines.len(), row, number)
}

impl<S: Scalar> GoalDrive<S> {
    /// Of step number `step`.
    #[inline(always)]
    pub(super) fn of(task: &CompiledTask<S>, state: &TaskState<S>, step: S) -> Self {
        let entry = |k: usize| {
            let DriveStep { is_drive, vehicle, into, push, drag, half, slower_than } = task.drive_steps[k];
            [is_drive, vehicle, into, push, drag, half, slower_than]
        };
        let [is_drive, vehicle, into, push, drag, half, slower_than] = S::gather(task.drive_steps.len(), entry, step);
        let step = DriveStep { is_drive, vehicle, into, push, drag, half, slower_than };
        let mut is_drive = S::lit(0.5).lt(is_drive);
        if let Some(corrects) = state.corrects() {
            is_drive = is_drive & !corrects;
        }
        let along = |k: usize| state.vehicles.as_ref().map_or(S::zero(), |vehicles| vehicles.along[k]);
        let row = |k: usize| {
            let ([x, y, z], [a, b, c]) = (task.lines[k], state.position[k]);
            [x, y, z, a, b, c, along(k)]
        };
        let [x, y, z, a, b, c, along] = S::gather(task.lines.len(), row, vehicle);
        let (place, within, _) = goal::sphere(task, state, into);
        let speed = state.vehicles.as_ref().map_or(S::zero(), |vehicles| vehicles.speed);
        let to = difference(place, [a, b, c]);
        Self { is_drive, step, line: [x, y, z], to, within, ride: Ride { along, speed } }
    }

    /// From a vehicle that is so far off its place (m) to where it must stop (m).
    #[inline(always)]
    pub fn way_left(&self, along: S) -> Point<S> {
        [0, 1, 2].map(|k| (self.to[k] - self.line[k] * along).only(self.is_drive))
    }

    /// How far (m) the vehicle must still go: to the middle of where it must stop, or to within.
    #[inline(always)]
    pub(super) fn left(&self, along: S, inside_is_zero: bool) -> S {
        let left = norm(self.way_left(along));
        if inside_is_zero { (left - self.within).max(S::zero()) } else { left }
    }
}

impl<S: Scalar> Ride<S> {
    /// At the beginning of a control step.
    #[inline(always)]
    pub(super) fn new(goal: Option<&GoalDrive<S>>) -> Self {
        goal.map_or(Self { along: S::zero(), speed: S::zero() }, |goal| goal.ride)
    }

    /// Counts a physics step of `seconds` with the stick at this angle (rad). Tells where the vehicle stands where it must.
    #[inline(always)]
    pub(super) fn follow(&mut self, goal: &GoalDrive<S>, hold: &swing::Hold<S>, seconds: S) -> S::Mask {
        let DriveStep { push, drag, half, slower_than, .. } = goal.step;
        // However strong drag is, nothing turns round by it.
        let slower = (-drag * seconds).max(S::lit(-1.0)).mul_add(self.speed, self.speed);
        let speed = hold.angle.mul_add(push * seconds, slower);
        let along = speed.mul_add(seconds, self.along);
        let kept = along.max(-half).min(half);
        let is_free = (along - kept).abs().lt(S::lit(1e-9));
        self.speed = S::select(goal.is_drive, speed.only(is_free), self.speed);
        self.along = S::select(goal.is_drive, kept, self.along);
        let is_there = norm(goal.way_left(self.along)).lt(goal.within);
        goal.is_drive & is_there & self.speed.abs().lt(slower_than)
    }
}
