//! What the tests of this crate share.
#![allow(dead_code)] // every test file uses a part of it

pub mod parts;

use myo_dynamics::plan::DofKind;
use myo_dynamics::{CouplingMode, Plan, State, Workspace};
use myo_model::{Model, builtin};
use myo_scalar::symbolic::{Buffer, Contents, Sharing, Sym, trace};
use myo_scalar::{Counter, LaneTask, Level, Scalar, Word, dispatch, philox, seed_words, unit};

/// A built-in arm.
pub fn arm(name: &str) -> Model {
    Model::new(&builtin(name).unwrap()).unwrap()
}

/// The default arm's reference plan.
pub fn exact(coupling: CouplingMode) -> Plan<f64> {
    Plan::exact(&arm("mobl-arms"), coupling).unwrap()
}

/// Uniform in [0, 1): entry `entry` of stream `stream`.
pub fn draw(stream: u32, entry: usize) -> f64 {
    let word = <f64 as Scalar>::Word::splat;
    let (episode, step) = (word(0), word(0));
    unit(
        philox::<f64>(Counter { seed: seed_words(1), env: word(stream), episode, step, stream: word(entry as u32) })[0],
    )
}

/// A reproducible random state within the joint limits; free bodies are near their places, and turned any way.
pub fn random_state(plan: &Plan<f64>, number: u32) -> State<f64> {
    let mut state = State::<f64>::new(plan);
    for (k, dof) in plan.dofs.iter().enumerate() {
        let [lo, hi] = dof.range.unwrap_or([-1.0, 1.0]);
        let drawn = lo + (hi - lo) * draw(number, k);
        match dof.kind {
            DofKind::Joint => state.qpos[dof.at] = drawn,
            DofKind::Place => state.qpos[dof.at] += 0.3 * drawn,
            DofKind::Turn => {}
        }
        state.qvel[k] = 10.0 * (draw(number, 100 + k) - 0.5);
    }
    for (k, ball) in plan.balls.iter().enumerate() {
        // Of any length, as it counts for nothing.
        (0..4).for_each(|part| state.qpos[ball.at + part] = draw(number, 300 + 4 * k + part) - 0.5);
    }
    for k in 0..plan.nmuscle() {
        state.act[k] = draw(number, 200 + k);
    }
    state
}

/// Greatest difference of two slices.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Greatest absolute value of a slice.
pub fn greatest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// A random state whose numbers lanes can hold.
pub fn narrow_state(plan: &Plan<f64>, number: u32) -> State<f64> {
    let mut state = random_state(plan, number);
    for x in [&mut state.qpos, &mut state.qvel, &mut state.act].into_iter().flatten() {
        *x = f64::from(*x as f32);
    }
    state
}

/// What is asked of a step, whatever its numbers are.
pub trait Look: Copy {
    /// What a step finds.
    fn look<S: Scalar>(self, plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) -> Vec<S>;
}

/// What lanes find in as many states as are a multiple of their number.
pub fn in_lanes(look: impl Look, level: Level, plan: &Plan<f32>, states: &[State<f64>]) -> Vec<Vec<f64>> {
    dispatch(level, Lanes(look, plan, states))
}

struct Lanes<'a, L>(L, &'a Plan<f32>, &'a [State<f64>]);

impl<L: Look> LaneTask for Lanes<'_, L> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) -> Self::Output {
        let Self(look, plan, states) = self;
        let (mut state, mut ws) = (State::<S>::new(plan), Workspace::<S>::new(plan));
        let mut all = vec![];
        for states in states.chunks_exact(S::LANES) {
            let load = |into: &mut [S], of: fn(&State<f64>) -> &[f64]| {
                for (entry, x) in into.iter_mut().enumerate() {
                    *x = S::load(&states.iter().map(|state| of(state)[entry] as f32).collect::<Vec<_>>());
                }
            };
            load(&mut state.qpos, |state| &state.qpos);
            load(&mut state.qvel, |state| &state.qvel);
            load(&mut state.act, |state| &state.act);
            let found = look.look(plan, &state, &mut ws);
            let mut lanes = vec![vec![0.0; S::LANES]; found.len()];
            found.iter().zip(&mut lanes).for_each(|(x, to)| x.store(to));
            all.extend((0..S::LANES).map(|lane| lanes.iter().map(|row| f64::from(row[lane])).collect::<Vec<f64>>()));
        }
        all
    }
}

/// What a program that was recorded of it finds in each of these states.
pub fn recorded(look: impl Look, plan: &Plan<f64>, states: &[State<f64>]) -> Vec<Vec<f64>> {
    let rows = [plan.nq(), plan.ndof(), plan.nmuscle()];
    let [input, output] = [0, 1].map(|binding| Buffer { binding, sharing: Sharing::PerEnv });
    let mut count = 0;
    let program = trace(|| {
        let mut row = 0;
        let mut next = |count: usize| {
            row += count;
            (row - count..row).map(|row| input.number(row)).collect::<Vec<Sym>>()
        };
        let [qpos, qvel, act] = rows.map(&mut next);
        let found = look.look(plan, &State { qpos, qvel, act }, &mut Workspace::<Sym>::new(plan));
        count = found.len();
        found.into_iter().enumerate().for_each(|(row, x)| output.set_number(row, x));
    });
    let of = |state: &State<f64>| {
        let numbers = [&state.qpos[..], &state.qvel, &state.act].concat();
        let mut buffers = [Contents::Numbers(numbers), Contents::Numbers(vec![f64::NAN; count])];
        program.interpret(&mut buffers);
        let [_, Contents::Numbers(found)] = buffers else { unreachable!("made so") };
        found
    };
    states.iter().map(of).collect()
}
