//! Groups and boxes that stand elsewhere, or are of other sizes, in every episode: how far each is off its place, and how much larger
//! than the middle of its range.

use super::{Point, TaskState};
use crate::flat::{FlatTask, Object, Shift};
use myo_scalar::{Counter, Real, Scalar, Word, philox, unit};

/// Random streams of shifts; that of draw `i` is this and `i`.
const SHIFT_STREAM: u32 = 0x500;

/// What is drawn of places and sizes; all empty where everything stands still, and only spheres are drawn each for itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shifts<T> {
    /// Per draw: three ways (m), of each of which from minus one half to one half is drawn.
    pub spans: Vec<[[T; 3]; 3]>,
    /// Per sphere, the number of its draw; where it has none, one that there is not.
    pub spheres: Vec<T>,
    /// The same per box.
    pub boxes: Vec<T>,
    /// The same of half its sizes; empty where none are drawn.
    pub sizes: Vec<T>,
    /// As of places, of each step's object.
    pub steps: Vec<T>,
}

impl<C: Real> Shifts<C> {
    pub(super) fn new(flat: &FlatTask) -> Self {
        let shifts = flat.shifts();
        if shifts.is_empty() {
            return Self { spans: vec![], spheres: vec![], boxes: vec![], sizes: vec![], steps: vec![] };
        }
        let of = |shift: Option<Shift>| C::from_f64(shift.map_or(shifts.len(), |shift| shift.number) as f64);
        let number = |object: &Object| of(object.shift);
        let (spheres, boxes): (Vec<&Object>, Vec<&Object>) = flat.objects.iter().partition(|object| object.is_round());
        Self {
            spans: shifts.iter().map(|shift| shift.spans.map(|span| span.map(C::from_f64))).collect(),
            spheres: spheres.into_iter().map(number).collect(),
            sizes: if flat.objects.iter().any(|object| object.growth.is_some()) {
                boxes.iter().map(|object| of(object.growth)).collect()
            } else {
                vec![]
            },
            boxes: boxes.into_iter().map(number).collect(),
            steps: flat.steps.iter().map(|step| number(&flat.objects[step.object])).collect(),
        }
    }
}

impl<T> Shifts<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Shifts<U> {
        Shifts {
            spans: self.spans.iter().map(|spans| spans.each_ref().map(|span| span.each_ref().map(&mut *f))).collect(),
            spheres: self.spheres.iter().map(&mut *f).collect(),
            boxes: self.boxes.iter().map(&mut *f).collect(),
            sizes: self.sizes.iter().map(&mut *f).collect(),
            steps: self.steps.iter().map(&mut *f).collect(),
        }
    }
}

impl<S: Scalar> Shifts<S> {
    /// Where the box of this number stands (m) whose place is here.
    #[inline(always)]
    pub(super) fn move_box(&self, state: &TaskState<S>, number: S, place: Point<S>) -> Point<S> {
        moved(&self.boxes, state, number, place)
    }

    /// Half the sizes (m) of the box of this number, the middles of whose ranges these are.
    #[inline(always)]
    pub(super) fn grow_box(&self, state: &TaskState<S>, number: S, half_size: Point<S>) -> Point<S> {
        moved(&self.sizes, state, number, half_size)
    }

    /// Where what the step of this number asks for stands (m) whose place is here.
    #[inline(always)]
    pub(super) fn move_step(&self, state: &TaskState<S>, number: S, place: Point<S>) -> Point<S> {
        moved(&self.steps, state, number, place)
    }
}

/// A place, or half sizes (m), and what is drawn of it for what has this number.
#[inline(always)]
fn moved<S: Scalar>(draws: &[S], state: &TaskState<S>, number: S, place: Point<S>) -> Point<S> {
    if draws.is_empty() {
        return place;
    }
    let [draw] = S::gather(draws.len(), |k| [draws[k]], number);
    let shift = drawn(&state.shifts, draw);
    [place[0] + shift[0], place[1] + shift[1], place[2] + shift[2]]
}

/// Draw of this number (m); none where there is no such draw.
#[inline(always)]
pub(super) fn drawn<S: Scalar>(shifts: &[Point<S>], number: S) -> Point<S> {
    let none = [S::zero(); 3];
    S::gather(shifts.len() + 1, |k| shifts.get(k).copied().unwrap_or(none), number)
}

/// Draws all shifts, where the mask is true.
#[inline(always)]
pub(super) fn draw_shifts<S: Scalar>(
    shifts: &Shifts<S>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    state: &mut TaskState<S>,
) {
    for (number, (spans, shift)) in shifts.spans.iter().zip(&mut state.shifts).enumerate() {
        let stream = S::Word::splat(SHIFT_STREAM + number as u32);
        let words = philox::<S>(Counter { stream, step: S::Word::splat(0), ..counter });
        let mut new = [S::zero(); 3];
        for (span, word) in spans.iter().zip(words) {
            let share = unit::<S>(word) - S::lit(0.5);
            for (x, &way) in new.iter_mut().zip(span) {
                *x = way.mul_add(share, *x);
            }
        }
        for (x, new) in shift.iter_mut().zip(new) {
            *x = S::select(mask, new, *x);
        }
    }
}
