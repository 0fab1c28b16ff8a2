//! A step of one body as machine code.

use crate::obstacles::Obstacles;
use crate::plan::Plan;
use crate::step::step;
use crate::workspace::{MAX_LANES, SolverCount, State, Workspace};
use myo_native::{BLOCKS, LANES, Memory, NativeError, Routine, View};
use myo_scalar::symbolic::{Buffer, Program, Sharing, Sym, trace};

/// Positions, rates, activations and controls, one after the other.
const ROWS: Buffer = Buffer { binding: 0, sharing: Sharing::PerEnv };
/// Rounds of the solver, and steps that it left unsolved.
const COUNTS: Buffer = Buffer { binding: 1, sharing: Sharing::PerEnv };

/// Why there is no machine code of a body.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NotCompiled {
    /// What touches is looked for one body at a time.
    #[error(
        "contacts of meshes, and of boxes with anything but planes, spheres and capsules, are looked for one body at a time"
    )]
    OneByOne,
    /// The processor, or the system.
    #[error(transparent)]
    Native(#[from] NativeError),
}

/// A step of one plan.
#[derive(Debug)]
pub(crate) struct NativeStep(Routine);

impl NativeStep {
    pub fn compile(plan: &Plan<f64>) -> Result<Self, NotCompiled> {
        if plan.touches_one_by_one() {
            return Err(NotCompiled::OneByOne);
        }
        Ok(Self(Routine::compile(&record(plan))?))
    }

    /// Advances blocks of bodies, each of so many entries, whose rows are in the order of [`record`].
    pub fn run(&self, blocks: &mut [f32], block: usize, steps: usize, solver: &mut [SolverCount]) {
        let mut memory = Memory::default();
        for (blocks, solver) in blocks.chunks_mut(BLOCKS * block).zip(solver.chunks_mut(BLOCKS * LANES)) {
            let mut counts = [[0; 2 * LANES]; BLOCKS];
            let rows = blocks.chunks_exact_mut(block).zip(&mut counts);
            let mut views: Vec<_> =
                rows.map(|(rows, counts)| [View::NumbersMut(rows), View::WordsMut(counts)]).collect();
            for _ in 0..steps {
                self.0.run_blocks(&mut views, &mut memory);
            }
            for (solver, counts) in solver.chunks_mut(LANES).zip(&counts) {
                let (rounds, unsolved) = counts.split_at(LANES);
                SolverCount::add(solver, steps, [rounds, unsolved]);
            }
        }
    }
}

const _: () = assert!(LANES == MAX_LANES, "a block has a body for each lane of a routine");

fn record(plan: &Plan<f64>) -> Program {
    let sizes = [plan.nq(), plan.ndof(), plan.nmuscle(), plan.nmuscle()];
    trace(|| {
        let mut rows = 0..;
        let [qpos, qvel, act, ctrl] =
            sizes.map(|size| rows.by_ref().take(size).map(|row| ROWS.number(row)).collect::<Vec<Sym>>());
        let mut state = State { qpos, qvel, act };
        let mut ws = Workspace::<Sym>::new(plan);
        step(plan, &Obstacles::none(plan).splat(), &ctrl, &mut state, &mut ws);
        for (row, &x) in [&state.qpos, &state.qvel, &state.act].into_iter().flatten().enumerate() {
            ROWS.set_number(row, x);
        }
        for (row, word) in [ws.tally.rounds, ws.tally.unsolved].into_iter().enumerate() {
            COUNTS.set_word(row, COUNTS.word(row) + word);
        }
    })
}
