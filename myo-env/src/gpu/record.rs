//! The environment as symbolic programs: the same generic code as on every other backend, run once on symbols.

use crate::control::{Scratch, reseed, reset, simulate, step_and_autoreset};
use crate::state::EnvState;
use crate::tables::Tables;
use crate::vector::Autoreset;
use myo_scalar::symbolic::{Buffer, Form, Program, Sharing, Sym, SymMask, SymWord, trace_as};
use myo_scalar::{Carried, Scalar, Visitor, Word};

/// Buffers of a step, in the order of their bindings; entries are counted per environment.
pub const STEP_BUFFERS: [&str; 7] =
    ["numbers", "words", "actions", "observation", "final_observation", "episode", "result"];
/// Bit of the buffer `command` that asks for a reset.
pub const RESET: u32 = 1;
/// Bit of the buffer `command` that asks for a new seed.
pub const RESEED: u32 = 2;
/// Buffers of a reset.
pub const RESET_BUFFERS: [&str; 5] = ["numbers", "words", "command", "observation", "seed"];
/// Buffers of the physics alone.
pub const PHYSICS_BUFFERS: [&str; 3] = ["numbers", "words", "ctrl"];

/// Rows of the buffer `result`.
pub const RESULT_ROWS: usize = 3;

/// Bindings that every program begins with.
const NUMBERS: Buffer = per_env(0);
const WORDS: Buffer = per_env(1);

const fn per_env(binding: u32) -> Buffer {
    Buffer { binding, sharing: Sharing::PerEnv }
}

/// One control step with everything that belongs to it.
pub fn step(tables: &Tables<f64>, autoreset: Autoreset, form: Form) -> Program {
    let [actions, observation, final_observation, episode, result] = [2, 3, 4, 5, 6].map(per_env);
    trace_as(form, || {
        let (mut env, mut ws) = load(tables);
        for (row, u) in ws.ctrl.iter_mut().enumerate() {
            *u = actions.number(row);
        }
        let outcome = step_and_autoreset(tables, autoreset, &mut env, &mut ws);
        set_rows(observation, &ws.next_observation);
        Sym::when(outcome.terminated | outcome.truncated, &mut Nothing, |_| {
            set_rows(final_observation, &ws.observation);
            set_rows(episode, &ws.episode);
        });
        let flags = [outcome.terminated, outcome.truncated].map(Sym::indicator);
        set_rows(result, &[outcome.reward, flags[0], flags[1]]);
        store(&mut env);
    })
}

/// A reset by mask, and the observations of all environments.
pub fn reset_program(tables: &Tables<f64>, form: Form) -> Program {
    let [command, observation] = [2, 3].map(per_env);
    let seed = Buffer { binding: 4, sharing: Sharing::Shared };
    trace_as(form, || {
        let (mut env, mut ws) = load(tables);
        let command = command.word(0);
        let asked = |bit: u32| Sym::lit(0.5).lt(Sym::from_word(command & SymWord::splat(bit)));
        let (mask, anew): (SymMask, SymMask) = (asked(RESET), asked(RESEED));
        reseed([seed.word(0), seed.word(1)], anew, &mut env);
        reset(tables, mask, &mut env, &mut ws);
        set_rows(observation, &ws.next_observation);
        store(&mut env);
    })
}

/// The physics of one control step alone, for measurements.
pub fn physics(tables: &Tables<f64>, form: Form) -> Program {
    let ctrl = per_env(2);
    trace_as(form, || {
        let (mut env, mut ws) = load(tables);
        for (row, u) in ws.ctrl.iter_mut().enumerate() {
            *u = ctrl.number(row);
        }
        simulate(tables, &mut env, &mut ws);
        store(&mut env);
    })
}

fn load(tables: &Tables<f64>) -> (EnvState<Sym>, Scratch<Sym>) {
    let mut env = EnvState::<Sym>::new(tables);
    for (row, x) in env.numbers().enumerate() {
        *x = NUMBERS.number(row);
    }
    for (row, x) in env.words().into_iter().enumerate() {
        *x = WORDS.word(row);
    }
    (env, Scratch::new(tables))
}

/// Writes back what the program changed.
fn store(env: &mut EnvState<Sym>) {
    for (row, x) in env.numbers().enumerate() {
        if !x.is_same(NUMBERS.number(row)) {
            NUMBERS.set_number(row, *x);
        }
    }
    for (row, x) in env.words().into_iter().enumerate() {
        if !x.is_same(WORDS.word(row)) {
            WORDS.set_word(row, *x);
        }
    }
}

fn set_rows(buffer: Buffer, values: &[Sym]) {
    for (row, &x) in values.iter().enumerate() {
        buffer.set_number(row, x);
    }
}

/// A branch without variables: it only writes.
struct Nothing;

impl Carried<Sym> for Nothing {
    fn visit(&mut self, _: &mut impl Visitor<Sym>) {}
}
