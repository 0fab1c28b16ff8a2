//! The precisions that environments run in.

use crate::control::Script;
use crate::job::Runner;
use myo_dynamics::Plan;
use myo_scalar::{LaneTask, Level, Real, Scalar, dispatch};
use std::sync::Arc;

/// A precision that environments can run in.
pub trait Precision: Real + Scalar<Const = Self> {
    /// Environments per value.
    fn lanes(level: Level) -> usize;
    /// The plan that environments of this precision run, from the one that is compiled in the obvious way.
    fn plan(exact: &Plan<f64>) -> Plan<Self>;
    /// The script of a task as the judge, compiled once, in this crate.
    fn script() -> Arc<dyn Runner<Self>>;
    /// Numbers as machine code takes them, if it does.
    fn narrow(numbers: &mut [Self]) -> Option<&mut [f32]>;
    /// Runs a job on the numbers of this precision.
    fn run<J: Job<Self>>(level: Level, job: J);
}

/// Generic work; `run` and all it calls must be inlined.
pub trait Job<C>: Send {
    /// Runs the work on one kind of number.
    fn run<S: Scalar<Const = C>>(self);
}

/// The reference: one environment at a time, with the plan that is compiled in the obvious way.
impl Precision for f64 {
    fn lanes(_: Level) -> usize {
        1
    }
    fn plan(exact: &Plan<f64>) -> Plan<Self> {
        exact.cast()
    }
    fn script() -> Arc<dyn Runner<Self>> {
        Arc::new(Script)
    }
    fn narrow(_: &mut [Self]) -> Option<&mut [f32]> {
        None
    }
    fn run<J: Job<Self>>(_: Level, job: J) {
        job.run::<Self>();
    }
}

/// The fast one: SIMD lanes, with the specialised plan.
impl Precision for f32 {
    fn lanes(level: Level) -> usize {
        level.lanes()
    }
    fn plan(exact: &Plan<f64>) -> Plan<Self> {
        exact.specialised().cast()
    }
    fn script() -> Arc<dyn Runner<Self>> {
        Arc::new(Script)
    }
    fn narrow(numbers: &mut [Self]) -> Option<&mut [f32]> {
        Some(numbers)
    }
    fn run<J: Job<Self>>(level: Level, job: J) {
        dispatch(level, OnLanes(job));
    }
}

struct OnLanes<J>(J);

impl<J: Job<f32>> LaneTask for OnLanes<J> {
    type Output = ();
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) {
        self.0.run::<S>();
    }
}
