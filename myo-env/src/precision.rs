//! The precisions that environments run in.

use crate::config::BuildError;
use crate::tables::Tables;
use myo_model::Model;
use myo_scalar::{LaneTask, Level, Real, Scalar, dispatch};
use myo_tasks::Task;

/// A precision that environments can run in.
pub trait Precision: Real + Scalar<Const = Self> {
    /// Environments per value.
    fn lanes(level: Level) -> usize;
    /// Compiles a model and a task as environments of this precision run them.
    ///
    /// # Errors
    /// As for [`Tables::new`].
    fn tables(model: &Model, task: &Task) -> Result<Tables<Self>, BuildError>;
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
    fn tables(model: &Model, task: &Task) -> Result<Tables<Self>, BuildError> {
        Tables::exact(model, task)
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
    fn tables(model: &Model, task: &Task) -> Result<Tables<Self>, BuildError> {
        Tables::new(model, task)
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
