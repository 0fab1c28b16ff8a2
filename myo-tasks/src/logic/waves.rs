//! Spheres that move: waves about their places.

use super::{CompiledTask, Point, TaskState};
use crate::motion::{Path, PathSines, SINES, WAVES_MAX};
use myo_scalar::{Counter, Real, Scalar, Word, philox, unit};
use std::f64::consts::TAU;

/// Random streams of where paths begin; that of object `i` is this and `i`.
const MOTION_STREAM: u32 = 0x200;
/// Numbers of a wave.
const ROW: usize = 7;

/// Waves of the path of a sphere that are added up, see [`Path`]; those that are not needed have no size.
#[derive(Clone, Debug, PartialEq)]
pub struct Waves<T>(pub [Wave<T>; WAVES_MAX]);

/// One of the waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave<T> {
    /// Goes with the cosine (m).
    pub cosine: [T; 3],
    /// Goes with the sine (m).
    pub sine: [T; 3],
    /// Turns per control step.
    pub rate: T,
}

/// Waves of a sphere that every episode draws, see [`PathSines`]; no size where there are none.
#[derive(Clone, Debug, PartialEq)]
pub struct Sines<T> {
    /// How far those of each axis go at most (m).
    pub axes: [[T; 3]; 3],
    /// Turns per control step of the fastest.
    pub rate: T,
}

/// What an episode draws of a wave: its share of how far the waves of its axis go together, its turns per control step, and where it begins (turns).
pub type DrawnSine<S> = [S; 3];

/// Of all waves of a sphere, axis by axis.
pub type DrawnSines<S> = [DrawnSine<S>; 3 * SINES];

impl<C: Real> Sines<C> {
    /// Those of a path; of a sphere without, ones that do not move it.
    pub(super) fn new(sines: Option<&PathSines>, control_dt_s: f64) -> Self {
        let axes = sines.map_or([[0.0; 3]; 3], |sines| sines.axes);
        let rate = sines.map_or(0.0, |sines| sines.rate * control_dt_s / TAU);
        Self { axes: axes.map(|axis| axis.map(C::from_f64)), rate: C::from_f64(rate) }
    }
}

impl<T> Sines<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Sines<U> {
        Sines { axes: self.axes.each_ref().map(|axis| axis.each_ref().map(&mut *f)), rate: f(&self.rate) }
    }
}

impl<C: Real> Waves<C> {
    /// Those of a path; of a sphere that stands still without one.
    pub(super) fn new(path: Option<&Path>, control_dt_s: f64) -> Self {
        let c = C::from_f64;
        let wave = |k: usize| path.and_then(|path| path.waves.get(k));
        Self(std::array::from_fn(|k| Wave {
            cosine: wave(k).map_or([0.0; 3], |wave| wave.cosine).map(c),
            sine: wave(k).map_or([0.0; 3], |wave| wave.sine).map(c),
            rate: c(wave(k).map_or(0.0, |wave| wave.rate * control_dt_s / TAU)),
        }))
    }
}

impl<T> Waves<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Waves<U> {
        Waves(self.0.each_ref().map(|wave| Wave {
            cosine: wave.cosine.each_ref().map(&mut *f),
            sine: wave.sine.each_ref().map(&mut *f),
            rate: f(&wave.rate),
        }))
    }
}

/// Draws where the paths of an episode begin, where the mask is true.
#[inline(always)]
pub(super) fn draw_phases<S: Scalar>(
    task: &CompiledTask<S>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    state: &mut TaskState<S>,
) {
    for (sphere, phases) in task.spheres.iter().zip(&mut state.phases) {
        let stream = S::Word::splat(MOTION_STREAM + sphere.number);
        let words = philox::<S>(Counter { stream, step: S::Word::splat(0), ..counter });
        for (phase, word) in phases.iter_mut().zip(words) {
            *phase = S::select(mask, unit(word), *phase);
        }
    }
    for ((sphere, sines), drawn) in task.spheres.iter().zip(&task.sines).zip(&mut state.sines) {
        let stream = S::Word::splat(MOTION_STREAM + sphere.number);
        for (axis, drawn) in drawn.chunks_mut(SINES).enumerate() {
            draw_axis(sines.rate, mask, Counter { stream, ..counter }, axis, drawn);
        }
    }
}

/// Draws the waves of an axis, the fastest of so many turns per control step, where the mask is true.
#[inline(always)]
fn draw_axis<S: Scalar>(fastest: S, mask: S::Mask, counter: Counter<S::Word>, axis: usize, drawn: &mut [DrawnSine<S>]) {
    let mut sum = S::zero();
    let mut fresh = [[S::zero(); 3]; SINES];
    for (k, wave) in fresh.iter_mut().enumerate() {
        // The first draw is that of the phases.
        let step = S::Word::splat((1 + SINES * axis + k) as u32);
        let [weight, rate, phase, _] = philox::<S>(Counter { step, ..counter });
        *wave = [unit::<S>(weight).mul_add(S::lit(4.0), S::lit(1.0)), unit::<S>(rate) * fastest, unit(phase)];
        sum += wave[0];
    }
    let share = sum.recip();
    for (old, [weight, rate, phase]) in drawn.iter_mut().zip(fresh) {
        for (old, new) in old.iter_mut().zip([weight * share, rate, phase]) {
            *old = S::select(mask, new, *old);
        }
    }
}

/// Where sphere `number` is off its place at the beginning of a control step (m), and how much farther at its end.
#[inline(always)]
pub(super) fn moved<S: Scalar>(
    task: &CompiledTask<S>,
    state: &TaskState<S>,
    number: S,
    step: S,
) -> (Point<S>, Point<S>) {
    let phases = S::gather(task.spheres.len(), |k| state.phases[k], number);
    let (mut from, mut to) = ([S::zero(); 3], [S::zero(); 3]);
    for (k, phase) in phases.into_iter().enumerate() {
        let row = |sphere: usize| {
            let Wave { cosine: [a, b, c], sine: [d, e, f], rate } = task.waves[sphere].0[k];
            [a, b, c, d, e, f, rate]
        };
        let [a, b, c, d, e, f, rate]: [S; ROW] = S::gather(task.spheres.len(), row, number);
        let begin = rate.mul_add(step, phase);
        for (sum, turns) in [(&mut from, begin), (&mut to, begin + rate)] {
            let (sin, cos) = ((turns - turns.floor()) * S::lit(TAU)).sin_cos();
            for (x, (cosine, sine)) in sum.iter_mut().zip([(a, d), (b, e), (c, f)]) {
                *x = cosine.mul_add(cos, sine.mul_add(sin, *x));
            }
        }
    }
    if task.kinds.sines {
        add_sines(task, state, number, step, [&mut from, &mut to]);
    }
    (from, super::difference(to, from))
}

/// Adds what the drawn waves of sphere `number` move it at the beginning and at the end of a control step (m).
#[inline(always)]
fn add_sines<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, number: S, step: S, places: [&mut Point<S>; 2]) {
    let count = task.sines.len();
    let now = [step, step + S::lit(1.0)];
    let mut places = places;
    for axis in 0..3 {
        let along = S::gather(count, |sphere| task.sines[sphere].axes[axis], number);
        let mut sums = [S::zero(); 2];
        for wave in SINES * axis..SINES * (axis + 1) {
            let [share, rate, phase] = S::gather(count, |sphere| state.sines[sphere][wave], number);
            for (sum, &step) in sums.iter_mut().zip(&now) {
                let turns = rate.mul_add(step, phase);
                let (sin, _) = ((turns - turns.floor()) * S::lit(TAU)).sin_cos();
                *sum = share.mul_add(sin, *sum);
            }
        }
        for (place, sum) in places.iter_mut().zip(sums) {
            for (x, along) in place.iter_mut().zip(along) {
                *x = along.mul_add(sum, *x);
            }
        }
    }
}
