//! Many bodies stepped together on the CPU: lanes across bodies, threads across blocks of lanes.

use crate::native::{NativeStep, NotCompiled};
use crate::obstacles::{Obstacles, Surface};
use crate::plan::Plan;
use crate::step::step;
use crate::workspace::{SolverCount, State, Workspace};
use myo_model::StaticBox;
use myo_native::{LANES, NativeError};
use myo_scalar::{LaneTask, Level, Scalar, dispatch};
use rayon::prelude::*;
use std::sync::Arc;

/// States of many bodies of one plan, in single precision.
///
/// Memory is a sequence of blocks, one per [`Level::lanes`] bodies; a block holds `qpos`, `qvel`, `act` and `ctrl`, each
/// entry once per lane. The last block is padded with bodies that nobody looks at.
#[derive(Clone, Debug)]
pub struct Batch {
    plan: Plan<f32>,
    obstacles: Obstacles<f32>,
    /// Boxes that can be touched at once, at most.
    contacts: usize,
    level: Level,
    /// Machine code for this plan, in place of lanes.
    native: Option<Arc<NativeStep>>,
    size: usize,
    blocks: Vec<f32>,
    solver: Vec<SolverCount>,
}

/// An array of a block.
#[derive(Clone, Copy, Debug)]
enum Field {
    Qpos,
    Qvel,
    Act,
    Ctrl,
}

impl Batch {
    /// `size` bodies at rest in the pose of reference, with nothing to touch.
    pub fn new(plan: &Plan<f64>, size: usize, level: Level) -> Self {
        let plan = plan.cast();
        let obstacles = Obstacles::none(&plan);
        let nblock = size.div_ceil(level.lanes());
        let blocks = vec![0.0; nblock * entries(&plan) * level.lanes()];
        let solver = vec![SolverCount::default(); size];
        let mut batch = Self { plan, obstacles, contacts: 1, level, native: None, size, blocks, solver };
        batch.fill_qpos();
        batch
    }

    /// Puts all bodies, those that nobody looks at as well, into the pose of reference.
    fn fill_qpos(&mut self) {
        let lanes = self.level.lanes();
        for block in self.blocks.chunks_exact_mut(entries(&self.plan) * lanes) {
            for (entry, &position) in block.chunks_exact_mut(lanes).zip(&self.plan.qpos0) {
                entry.fill(position);
            }
        }
    }

    /// The same with boxes that every fingertip can press, on lanes.
    pub fn touching(mut self, boxes: &[StaticBox], surface: Surface) -> Self {
        self.obstacles = Obstacles::new(&self.plan, boxes, surface);
        self.contacts = self.obstacles.most_at_once(&self.plan);
        self.native = None;
        self
    }

    /// Bodies at rest in the pose of reference that are stepped by machine code made for their plan, which processors with AVX-512 run
    /// faster than lanes go through tables. Compiling takes milliseconds to a second.
    ///
    /// # Errors
    /// The processor has no AVX-512, or the plan is not one to compile.
    pub fn compiled(plan: &Plan<f64>, size: usize) -> Result<Self, NotCompiled> {
        let level = Level::widest();
        if level.lanes() != LANES {
            return Err(NativeError::Unsupported.into());
        }
        Ok(Self { native: Some(Arc::new(NativeStep::compile(plan)?)), ..Self::new(plan, size, level) })
    }

    /// Number of bodies.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Positions of one body.
    pub fn qpos(&self, body: usize) -> Vec<f32> {
        self.get(body, Field::Qpos)
    }
    /// Rates of its generalised coordinates.
    pub fn qvel(&self, body: usize) -> Vec<f32> {
        self.get(body, Field::Qvel)
    }
    /// Activations of one body.
    pub fn act(&self, body: usize) -> Vec<f32> {
        self.get(body, Field::Act)
    }
    /// What the constraint solver did for each body since the beginning.
    pub fn solver_counts(&self) -> &[SolverCount] {
        &self.solver
    }

    /// Sets the state of one body.
    ///
    /// # Panics
    /// If a slice has the wrong length or `body` is out of range.
    pub fn set_state(&mut self, body: usize, qpos: &[f64], qvel: &[f64], act: &[f64]) {
        for (field, values) in [(Field::Qpos, qpos), (Field::Qvel, qvel), (Field::Act, act)] {
            self.set(body, field, values.iter().map(|&x| x as f32));
        }
    }

    /// Sets the excitations of one body, held until set again.
    ///
    /// # Panics
    /// As [`Batch::set_state`].
    pub fn set_ctrl(&mut self, body: usize, ctrl: &[f32]) {
        self.set(body, Field::Ctrl, ctrl.iter().copied());
    }

    /// Advances every body by `steps` physics steps, on the current rayon threads.
    pub fn step(&mut self, steps: usize) {
        let Self { plan, obstacles, contacts, level, native, blocks, solver, .. } = self;
        let (block, native) = (entries(plan) * level.lanes(), native.as_deref());
        // Several blocks to a task, so that scratch memory is allocated rarely.
        let per_task = (blocks.len() / block).div_ceil(4 * rayon::current_num_threads()).max(1);
        let solver = solver.par_chunks_mut(level.lanes() * per_task);
        blocks.par_chunks_mut(block * per_task).zip(solver).for_each(|(blocks, solver)| match native {
            Some(native) => native.run(blocks, block, steps, solver),
            None => dispatch(*level, Steps { plan, obstacles, contacts: *contacts, blocks, solver, steps }),
        });
    }

    fn index(&self, body: usize, field: Field, entry: usize) -> usize {
        assert!(body < self.size, "body {body} of {}", self.size);
        let (lanes, offset) = (self.level.lanes(), offset(&self.plan, field));
        (body / lanes * entries(&self.plan) + offset + entry) * lanes + body % lanes
    }
    fn get(&self, body: usize, field: Field) -> Vec<f32> {
        (0..length(&self.plan, field)).map(|entry| self.blocks[self.index(body, field, entry)]).collect()
    }
    fn set(&mut self, body: usize, field: Field, values: impl ExactSizeIterator<Item = f32>) {
        let count = length(&self.plan, field);
        assert_eq!(values.len(), count, "{field:?} of a body are {count} numbers");
        for (entry, value) in values.enumerate() {
            let index = self.index(body, field, entry);
            self.blocks[index] = value;
        }
    }
}

fn length<C>(plan: &Plan<C>, field: Field) -> usize {
    match field {
        Field::Qpos => plan.nq(),
        Field::Qvel => plan.ndof(),
        Field::Act | Field::Ctrl => plan.nmuscle(),
    }
}

/// Where an array starts in a block, in entries.
fn offset<C>(plan: &Plan<C>, field: Field) -> usize {
    let (positions, coordinates) = (plan.nq(), plan.nq() + plan.ndof());
    match field {
        Field::Qpos => 0,
        Field::Qvel => positions,
        Field::Act => coordinates,
        Field::Ctrl => coordinates + plan.nmuscle(),
    }
}

fn entries<C>(plan: &Plan<C>) -> usize {
    plan.nq() + plan.ndof() + 2 * plan.nmuscle()
}

/// Steps of consecutive blocks.
struct Steps<'a> {
    plan: &'a Plan<f32>,
    obstacles: &'a Obstacles<f32>,
    contacts: usize,
    blocks: &'a mut [f32],
    /// Of the bodies that somebody looks at.
    solver: &'a mut [SolverCount],
    steps: usize,
}

impl LaneTask for Steps<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) {
        let Self { plan, obstacles, contacts, blocks, solver, steps } = self;
        let (mut state, mut ws) = (State::<S>::new(plan), Workspace::<S>::with_contacts(plan, contacts));
        let obstacles = &obstacles.splat::<S>();
        let mut ctrl = vec![S::zero(); plan.nmuscle()];
        let blocks = blocks.chunks_exact_mut(entries(plan) * S::LANES);
        for (block, solver) in blocks.zip(solver.chunks_mut(S::LANES)) {
            let mut entry = block.chunks_exact(S::LANES);
            let arrays = [&mut state.qpos, &mut state.qvel, &mut state.act, &mut ctrl];
            for x in arrays.into_iter().flatten() {
                *x = S::load(entry.next().expect("a block holds every entry"));
            }
            ws.forget_touches();
            for _ in 0..steps {
                step(plan, obstacles, &ctrl, &mut state, &mut ws);
            }
            ws.tally.take(steps, solver);
            let mut entry = block.chunks_exact_mut(S::LANES);
            for x in [&state.qpos, &state.qvel, &state.act].into_iter().flatten() {
                x.store(entry.next().expect("a block holds every entry"));
            }
        }
    }
}
