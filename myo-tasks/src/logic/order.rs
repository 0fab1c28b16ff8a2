//! Steps that change places with each other: in an order that each episode draws, or in any that the user takes.
//!
//! An order is which step stands at each place of the script. A random one is drawn when an episode begins. Where any order
//! counts, what is nearest to the pointer comes to the place that is due, as long as nothing was begun.

use super::{CompiledTask, Landmarks, TaskState, difference, fingers, goal, is_same, norm};
use crate::flat::Order;
use myo_scalar::{Counter, Mask, Scalar, Word, philox, unit};

/// Random stream of orders.
const ORDER_STREAM: u32 = 0x600;

/// Draws the order of an episode where the mask is true: what comes to each place is any of what is left (Fisher and Yates).
#[inline(always)]
pub(super) fn draw_order<S: Scalar>(
    task: &CompiledTask<S>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    state: &mut TaskState<S>,
) {
    for &Order { first, count, .. } in &task.orders {
        let mut steps: Vec<S> = (first..first + count).map(|step| S::lit(step as f64)).collect();
        for place in 0..count - 1 {
            let left = (count - place) as f64;
            let stream = S::Word::splat(ORDER_STREAM + (first + place) as u32);
            let [word, ..] = philox::<S>(Counter { stream, step: S::Word::splat(0), ..counter });
            let ahead = (unit::<S>(word) * S::lit(left)).floor().min(S::lit(left - 1.0));
            exchange(&mut steps[place..], S::zero(), ahead);
        }
        for (step, drawn) in state.order[first..].iter_mut().zip(steps) {
            *step = S::select(mask, drawn, *step);
        }
    }
}

/// Where any order counts and nothing was begun, the step whose object is nearest to the pointer becomes the current one.
#[inline(always)]
pub fn choose_nearest<S: Scalar>(task: &CompiledTask<S>, body: &Landmarks<S>, state: &mut TaskState<S>) {
    let half = S::lit(0.5);
    let is_idle = state.held.lt(half) & state.down.lt(half);
    for order in task.orders.iter().filter(|order| order.is_any) {
        let far = S::lit(f64::from(f32::MAX));
        let (mut nearest, mut chosen) = (far, state.phase);
        for (place, is_open) in open_places(order, state) {
            let step = state.order[place];
            let centre = goal::centre_of_step(task, state, step, None);
            let pointer = fingers::place_of(task, body, fingers::lead_of(task, step), centre);
            let distance = norm(difference(pointer, centre));
            let is_nearer = is_open & is_idle & distance.lt(nearest);
            nearest = S::select(is_nearer, distance, nearest);
            chosen = S::select(is_nearer, S::lit(place as f64), chosen);
        }
        let first = S::lit(order.first as f64);
        exchange(&mut state.order[order.first..order.first + order.count], state.phase - first, chosen - first);
        let due = state.step_ahead(0);
        let Some(cue) = &mut state.cue else { continue };
        let [object] = S::gather(task.steps.len(), |k| [task.steps[k].object], due);
        cue.object = S::select(nearest.lt(far), object, cue.object);
    }
}

/// Places of an order, and where their steps are not done yet and may be done now: the current one and what may come before it.
#[inline(always)]
pub(super) fn open_places<'a, S: Scalar>(
    order: &'a Order,
    state: &'a TaskState<S>,
) -> impl Iterator<Item = (usize, S::Mask)> + 'a {
    let begins = S::lit(order.first as f64 - 0.5).lt(state.phase) & S::Mask::splat(order.is_any);
    let phase = state.phase;
    (order.first..order.first + order.count).map(move |place| (place, begins & phase.lt(S::lit(place as f64 + 0.5))))
}

/// Two values change places, where both numbers are those of values.
#[inline(always)]
fn exchange<S: Scalar>(values: &mut [S], a: S, b: S) {
    let count = values.len();
    let [at_a] = S::gather(count, |k| [values[k]], a);
    let [at_b] = S::gather(count, |k| [values[k]], b);
    for (k, value) in values.iter_mut().enumerate() {
        let k = S::lit(k as f64);
        *value = S::select(is_same(a, k), at_b, S::select(is_same(b, k), at_a, *value));
    }
}
