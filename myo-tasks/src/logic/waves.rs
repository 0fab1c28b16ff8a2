//! Spheres that move: waves about their places.

use super::{CompiledTask, Point, TaskState};
use crate::motion::{Path, WAVES_MAX};
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
    (from, super::difference(to, from))
}
