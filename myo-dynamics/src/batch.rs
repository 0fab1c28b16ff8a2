//! Many bodies stepped together on the CPU: lanes across bodies, threads across blocks of lanes.

use crate::obstacles::{Obstacles, StaticBox, Surface};
use crate::plan::Plan;
use crate::step::step;
use crate::workspace::{State, Workspace};
use myo_scalar::{Kernel, Level, Scalar, dispatch};
use rayon::prelude::*;

/// States of many bodies of one plan, in single precision.
///
/// Memory is a sequence of blocks, one per [`Level::lanes`] bodies; a block holds `qpos`, `qvel`, `act` and `ctrl`, each
/// entry once per lane. The last block is padded with bodies that nobody looks at.
#[derive(Clone, Debug)]
pub struct Batch {
    plan: Plan<f32>,
    obstacles: Obstacles<f32>,
    level: Level,
    size: usize,
    blocks: Vec<f32>,
}

/// Where an array starts in a block, in entries.
#[derive(Clone, Copy)]
enum Part {
    Qpos,
    Qvel,
    Act,
    Ctrl,
}

impl Batch {
    /// `size` bodies at rest in the zero pose, with nothing to touch.
    pub fn new(plan: &Plan<f64>, size: usize, level: Level) -> Self {
        let plan = plan.cast();
        let obstacles = Obstacles::none(&plan);
        let nblock = size.div_ceil(level.lanes());
        let blocks = vec![0.0; nblock * entries(&plan) * level.lanes()];
        Self { plan, obstacles, level, size, blocks }
    }

    /// The same with boxes that every fingertip can press.
    pub fn touching(mut self, boxes: &[StaticBox], surface: Surface) -> Self {
        self.obstacles = Obstacles::new(&self.plan, boxes, surface);
        self
    }

    /// Number of bodies.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Generalised coordinates of one body.
    pub fn qpos(&self, body: usize) -> Vec<f32> {
        self.get(body, Part::Qpos, self.plan.ndof())
    }
    /// Their rates.
    pub fn qvel(&self, body: usize) -> Vec<f32> {
        self.get(body, Part::Qvel, self.plan.ndof())
    }
    /// Activations of one body.
    pub fn act(&self, body: usize) -> Vec<f32> {
        self.get(body, Part::Act, self.plan.nmuscle())
    }
    /// Sets the state of one body. Panics if a slice has the wrong length or `body` is out of range.
    pub fn set_state(&mut self, body: usize, qpos: &[f64], qvel: &[f64], act: &[f64]) {
        for (part, values) in [(Part::Qpos, qpos), (Part::Qvel, qvel), (Part::Act, act)] {
            self.set(body, part, values.iter().map(|&x| x as f32));
        }
    }
    /// Sets the excitations of one body, held until set again.
    pub fn set_ctrl(&mut self, body: usize, ctrl: &[f32]) {
        self.set(body, Part::Ctrl, ctrl.iter().copied());
    }

    /// Advances every body by `steps` physics steps, on the current rayon threads.
    pub fn step(&mut self, steps: usize) {
        let Self { plan, obstacles, level, blocks, .. } = self;
        let block = entries(plan) * level.lanes();
        // Several blocks to a task, so that scratch memory is allocated rarely.
        let per_task = (blocks.len() / block).div_ceil(4 * rayon::current_num_threads()).max(1);
        blocks.par_chunks_mut(block * per_task).for_each(|blocks| {
            dispatch(*level, Steps { plan, obstacles, blocks, steps });
        });
    }

    fn index(&self, body: usize, part: Part, entry: usize) -> usize {
        assert!(body < self.size, "body {body} of {}", self.size);
        let (lanes, offset) = (self.level.lanes(), offset(&self.plan, part));
        (body / lanes * entries(&self.plan) + offset + entry) * lanes + body % lanes
    }
    fn get(&self, body: usize, part: Part, count: usize) -> Vec<f32> {
        (0..count).map(|entry| self.blocks[self.index(body, part, entry)]).collect()
    }
    fn set(&mut self, body: usize, part: Part, values: impl Iterator<Item = f32>) {
        for (entry, value) in values.enumerate() {
            let index = self.index(body, part, entry);
            self.blocks[index] = value;
        }
    }
}

fn offset<C>(plan: &Plan<C>, part: Part) -> usize {
    let (n, m) = (plan.ndof(), plan.nmuscle());
    match part {
        Part::Qpos => 0,
        Part::Qvel => n,
        Part::Act => 2 * n,
        Part::Ctrl => 2 * n + m,
    }
}

fn entries<C>(plan: &Plan<C>) -> usize {
    2 * plan.ndof() + 2 * plan.nmuscle()
}

/// Steps of consecutive blocks.
struct Steps<'a> {
    plan: &'a Plan<f32>,
    obstacles: &'a Obstacles<f32>,
    blocks: &'a mut [f32],
    steps: usize,
}

impl Kernel for Steps<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) {
        let Self { plan, obstacles, blocks, steps } = self;
        let (mut state, mut ws) = (State::<S>::new(plan), Workspace::<S>::new(plan));
        let mut ctrl = vec![S::zero(); plan.nmuscle()];
        for block in blocks.chunks_exact_mut(entries(plan) * S::LANES) {
            let mut entry = block.chunks_exact(S::LANES);
            let arrays = [&mut state.qpos, &mut state.qvel, &mut state.act, &mut ctrl];
            for x in arrays.into_iter().flatten() {
                *x = S::load(entry.next().expect("a block holds every entry"));
            }
            for _ in 0..steps {
                step(plan, obstacles, &ctrl, &mut state, &mut ws);
            }
            let mut entry = block.chunks_exact_mut(S::LANES);
            for x in [&state.qpos, &state.qvel, &state.act].into_iter().flatten() {
                x.store(entry.next().expect("a block holds every entry"));
            }
        }
    }
}
