//! Sliders: where a handle is, and where it must be let go.

use super::{CompiledTask, Point, TaskState};
use crate::flat::{Action, Step};
use crate::slider::{Direction, Slider};
use myo_model::StaticBox;
use myo_scalar::{Counter, Real, Scalar, Word, philox, unit};

/// Random streams of where handles stand when an episode begins; that of object `i` is this and `i`.
const SLIDER_STREAM: u32 = 0x300;

/// The handle of a slider. Its way is a box that can be touched.
#[derive(Clone, Debug, PartialEq)]
pub struct Handle<T> {
    /// Along the way, to where the value rises.
    pub along: [T; 3],
    /// One where the way goes across the face, zero where it goes up.
    pub across: T,
    /// How far it can be moved (m).
    pub length: T,
    /// Half its own length along the way (m).
    pub half: T,
    /// Where it stands when an episode begins, as a share of the way: the least,
    pub start: T,
    /// and how much more at most.
    pub start_extent: T,
    /// Number of the slider among all objects, which its random draws depend on.
    pub number: u32,
}

/// Where a step wants a handle; zeros where the step is no drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DragStep<T> {
    /// One if it is a drag.
    pub is_drag: T,
    /// Number of the slider among sliders.
    pub slider: T,
    /// Where the handle must be let go, as a share of the way.
    pub to: T,
    /// How far off that it may be, as a share of the way.
    pub within: T,
}

/// A handle that is to be dragged.
#[derive(Clone, Debug)]
pub struct GoalDrag<S: Scalar> {
    /// Where the step is a drag; the rest means nothing elsewhere.
    pub is_drag: S::Mask,
    /// Number of the slider among sliders.
    pub slider: S,
    /// Middle of the way (m).
    pub middle: Point<S>,
    /// Along the way.
    pub along: Point<S>,
    /// How far the handle can be moved (m).
    pub length: S,
    /// Half the handle's length as a share of the way.
    pub half: S,
    /// Where it must be let go, as a share of the way.
    pub to: S,
    /// How far off that it may be.
    pub within: S,
    /// Where it stands at the beginning of the control step.
    pub value: S,
}

impl<C: Real> Handle<C> {
    pub(super) fn new(slider: &Slider, number: usize) -> Self {
        let c = C::from_f64;
        Self {
            along: slider.along().map(c),
            across: c(if slider.rises == Direction::Right { 1.0 } else { 0.0 }),
            length: c(slider.length),
            half: c(0.5 * slider.handle),
            start: c(slider.start.min),
            start_extent: c(slider.start.max - slider.start.min),
            number: number as u32,
        }
    }
}

impl<T> Handle<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Handle<U> {
        Handle {
            along: self.along.each_ref().map(&mut *f),
            across: f(&self.across),
            length: f(&self.length),
            half: f(&self.half),
            start: f(&self.start),
            start_extent: f(&self.start_extent),
            number: self.number,
        }
    }
}

impl<C: Real> DragStep<C> {
    /// `slider` gives the number of an object among sliders.
    pub(super) fn new(step: &Step, slider: impl Fn(usize) -> usize) -> Self {
        let c = C::from_f64;
        match step.action {
            Action::Drag { to, within } => {
                Self { is_drag: c(1.0), slider: c(slider(step.object) as f64), to: c(to), within: c(within) }
            }
            _ => Self { is_drag: c(0.0), slider: c(0.0), to: c(0.0), within: c(0.0) },
        }
    }
}

impl<T> DragStep<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> DragStep<U> {
        DragStep { is_drag: f(&self.is_drag), slider: f(&self.slider), to: f(&self.to), within: f(&self.within) }
    }
}

/// Draws where handles stand, where the mask is true.
#[inline(always)]
pub(super) fn draw_values<S: Scalar>(
    task: &CompiledTask<S>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    state: &mut TaskState<S>,
) {
    for (handle, value) in task.handles.iter().zip(&mut state.values) {
        let stream = S::Word::splat(SLIDER_STREAM + handle.number);
        let [word, ..] = philox::<S>(Counter { stream, step: S::Word::splat(0), ..counter });
        *value = S::select(mask, unit::<S>(word).mul_add(handle.start_extent, handle.start), *value);
    }
}

/// Middle of the handle (m) where step number `step` is a drag, whose way has its middle there; else that middle.
#[inline(always)]
pub(super) fn handle_of_step<S: Scalar>(
    task: &CompiledTask<S>,
    state: &TaskState<S>,
    step: S,
    middle: Point<S>,
) -> Point<S> {
    let [is_drag, slider] = S::gather(task.drags.len(), |k| [task.drags[k].is_drag, task.drags[k].slider], step);
    let row = |k: usize| {
        let Handle { along: [x, y, z], length, .. } = task.handles[k];
        [x, y, z, length, state.values[k]]
    };
    let [x, y, z, length, value] = S::gather(task.handles.len(), row, slider);
    let from_middle = ((value - S::lit(0.5)) * length).only(S::lit(0.5).lt(is_drag));
    [x.mul_add(from_middle, middle[0]), y.mul_add(from_middle, middle[1]), z.mul_add(from_middle, middle[2])]
}

impl<S: Scalar> GoalDrag<S> {
    /// Of the current step, whose box is `way`: it becomes that of the handle, which is what must be touched.
    #[inline(always)]
    pub(super) fn of(task: &CompiledTask<S>, state: &TaskState<S>, way: &mut StaticBox<S>) -> Self {
        let drags = &task.drags;
        let entry = |k: usize| {
            let DragStep { is_drag, slider, to, within } = drags[k];
            [is_drag, slider, to, within]
        };
        let [is_drag, slider, to, within] = S::gather(drags.len(), entry, state.step_ahead(0));
        let row = |k: usize| {
            let Handle { along: [x, y, z], across, length, half, .. } = task.handles[k];
            [x, y, z, across, length, half, state.values[k]]
        };
        let [x, y, z, across, length, half, value] = S::gather(task.handles.len(), row, slider);
        let mut is_drag = S::lit(0.5).lt(is_drag);
        if let Some(corrects) = state.corrects() {
            is_drag = is_drag & !corrects;
        }
        let middle = way.centre;
        let from_middle = ((value - S::lit(0.5)) * length).only(is_drag);
        for (centre, along) in way.centre.iter_mut().zip([x, y, z]) {
            *centre = along.mul_add(from_middle, *centre);
        }
        let is_across = S::lit(0.5).lt(across);
        let [height, width, _] = &mut way.half_size;
        *height = S::select(is_drag & !is_across, half, *height);
        *width = S::select(is_drag & is_across, half, *width);
        let half = half * length.recip();
        Self { is_drag, slider, middle, along: [x, y, z], length, half, to, within, value }
    }

    /// Where along the way a point is, as a share of it.
    #[inline(always)]
    pub(super) fn share(&self, point: Point<S>) -> S {
        super::dot(super::difference(point, self.middle), self.along) * self.length.recip() + S::lit(0.5)
    }

    /// How far (m) a handle that stands at `value` must go, to where the value rises.
    #[inline(always)]
    pub fn left(&self, value: S) -> S {
        ((self.to - value) * self.length).only(self.is_drag)
    }

    /// The same as a vector.
    #[inline(always)]
    pub fn way_left(&self, value: S) -> Point<S> {
        let left = self.left(value);
        [self.along[0] * left, self.along[1] * left, self.along[2] * left]
    }
}
