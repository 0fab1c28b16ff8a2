//! Steps that must be waited for, and steps whose object is one of several.

use super::{CompiledTask, Point, TaskState};
use crate::flat::{FlatTask, Shape, Step};
use crate::slider::Slider;
use myo_scalar::{Carried, Counter, Real, Scalar, Visitor, Word, philox, unit};

/// Random stream of times and objects, drawn when a step begins.
const CUE_STREAM: u32 = 0x400;

/// What must be waited for before a step counts, and what is chosen then.
#[derive(Clone, Debug, PartialEq)]
pub struct StepCue<T> {
    /// Least time, in control steps.
    pub least: T,
    /// How many control steps more at most.
    pub extent: T,
    /// One where nothing tells before which object it will be.
    pub hidden: T,
    /// Where its objects begin among [`CompiledTask::choices`].
    pub first: T,
    /// How many there are; zero where there is no choice.
    pub count: T,
    /// Middle of these objects (m): what is seen as long as nothing is lit.
    pub home: [T; 3],
    /// Mean of their sizes (m): radius of a sphere, half the width of a box.
    pub home_size: T,
}

/// What the current step waits for.
#[derive(Clone, Debug)]
pub struct CueState<S> {
    /// Number of its object.
    pub object: S,
    /// Control step from which on it counts.
    pub lit_at: S,
    /// Per step: the control step from which on it counted; negative if it was not the current one yet.
    pub shown_at: Vec<S>,
}

impl<C: Real> StepCue<C> {
    /// Of a step whose choices, if there are any, begin at `first`.
    pub(super) fn new(step: &Step, flat: &FlatTask, first: usize, control_dt_s: f64) -> Self {
        let (c, steps) = (C::from_f64, |seconds: f64| (seconds / control_dt_s).round());
        let [least, most] = step.cue.map_or([0.0; 2], |cue| [steps(cue.after_s.min), steps(cue.after_s.max)]);
        let middle = |object: usize| {
            let region = flat.objects[object].region();
            [region.x, region.y, region.z].map(|range| range.centre())
        };
        let mean = |of: &dyn Fn(usize) -> f64| step.objects().map(of).sum::<f64>() / step.objects().count() as f64;
        let size = |object: usize| match &flat.objects[object].shape {
            Shape::Sphere(sphere) => sphere.radius.centre(),
            Shape::Stick(stick) => stick.knob,
            Shape::Button(block) | Shape::Obstacle(block) | Shape::Slider(Slider { block, .. }) => 0.5 * block.size[0],
        };
        Self {
            least: c(least),
            extent: c(most - least),
            hidden: c(f64::from(u8::from(step.cue.is_some_and(|cue| cue.hidden)))),
            first: c(first as f64),
            count: c(step.among.len() as f64),
            home: [0, 1, 2].map(|axis| c(mean(&|object| middle(object)[axis]))),
            home_size: c(mean(&size)),
        }
    }
}

impl<T> StepCue<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> StepCue<U> {
        StepCue {
            least: f(&self.least),
            extent: f(&self.extent),
            hidden: f(&self.hidden),
            first: f(&self.first),
            count: f(&self.count),
            home: self.home.each_ref().map(&mut *f),
            home_size: f(&self.home_size),
        }
    }
}

impl<S: Scalar> CueState<S> {
    /// Before the first episode.
    #[inline(always)]
    pub(super) fn new(steps: usize) -> Self {
        Self { object: S::zero(), lit_at: S::zero(), shown_at: vec![S::lit(-1.0); steps] }
    }
}

/// Draws how long the current step must be waited for, and which object it asks for, where the mask is true: when an episode or
/// a step begins.
#[inline(always)]
pub fn begin_step<S: Scalar>(
    task: &CompiledTask<S>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    state: &mut TaskState<S>,
) {
    let (number, step) = (state.step_ahead(0), state.step);
    let Some(cue) = &mut state.cue else { return };
    S::when(mask, &mut Drawn(cue), |Drawn(cue)| {
        if task.cues.is_empty() {
            // Where nothing must be waited for, a step begins when the one before is over.
            let [object] = S::gather(task.steps.len(), |k| [task.steps[k].object], number);
            cue.object = S::select(mask, object, cue.object);
            cue.lit_at = S::select(mask, step, cue.lit_at);
            return;
        }
        let entry = |k: usize| {
            let StepCue { least, extent, first, count, .. } = task.cues[k];
            [least, extent, first, count, task.steps[k].object]
        };
        let [least, extent, first, count, object] = S::gather(task.cues.len(), entry, number);
        let [time, which, ..] = philox::<S>(Counter { stream: S::Word::splat(CUE_STREAM), ..counter });
        let more = (unit::<S>(time) * (extent + S::lit(1.0))).floor().min(extent);
        cue.lit_at = S::select(mask, step + least + more, cue.lit_at);
        let mut object = object;
        if !task.choices.is_empty() {
            let last = count - S::lit(1.0);
            let chosen = first + (unit::<S>(which) * count).floor().min(last);
            let [chosen] = S::gather(task.choices.len(), |k| [task.choices[k]], chosen);
            object = S::select(S::lit(0.5).lt(count), chosen, object);
        }
        cue.object = S::select(mask, object, cue.object);
    });
}

/// What a step that begins changes.
struct Drawn<'a, S>(&'a mut CueState<S>);

impl<S: Scalar> Carried<S> for Drawn<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers([&mut self.0.object, &mut self.0.lit_at]);
    }
}

/// Where the current step counts already; none where all of the task count at once.
#[inline(always)]
pub(super) fn is_lit<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>) -> Option<S::Mask> {
    let cue = state.cue.as_ref().filter(|_| task.kinds.cue)?;
    Some(cue.lit_at.le(state.step))
}

/// What is seen before it is known which object it will be.
pub(super) struct Hidden<S: Scalar> {
    /// Where nothing else is seen.
    pub mask: S::Mask,
    /// See [`StepCue::home`].
    pub centre: Point<S>,
    /// See [`StepCue::home_size`].
    pub size: S,
}

/// What is seen of step number `step`, which counts where `is_lit`.
#[inline(always)]
pub(super) fn hidden<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, step: S, is_lit: S::Mask) -> Hidden<S> {
    let entry = |k: usize| {
        let StepCue { hidden, home: [x, y, z], home_size, .. } = task.cues[k];
        [hidden, x, y, z, home_size]
    };
    let [hidden, x, y, z, size] = S::gather(task.cues.len(), entry, step);
    let centre = task.shifts.move_step(state, step, [x, y, z]);
    Hidden { mask: S::lit(0.5).lt(hidden) & !is_lit, centre, size }
}
