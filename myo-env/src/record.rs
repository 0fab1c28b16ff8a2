//! The environment as symbolic programs: the same generic code as on every other backend, run once on symbols.

#[cfg(feature = "gpu")]
use crate::config::BuildError;
use crate::control::{Following, Judge, Scratch, Script, Unwatched, reseed, simulate, step_until_reset};
use crate::parameters::World;
use crate::state::{EnvState, RESET_NOW, StateRows};
use crate::tables::Tables;
use crate::vector::Autoreset;
use myo_dynamics::SolverTally;
use myo_scalar::symbolic::{Buffer, Form, Program, Sharing, Sym, SymWord, trace_as};
use myo_scalar::{Carried, Scalar, Visitor, Word};
use myo_tasks::logic::{Goal, Stay};

/// Buffers of a step, in the order of their bindings; entries are counted per environment; `parameters` all share, but where every environment has its own.
pub const STEP_BUFFERS: [&str; 7] =
    ["numbers", "words", "parameters", "actions", "observation", "final_observation", "result"];
/// Bit of the buffer `command` that asks for a reset.
pub const RESET: u32 = 1;
/// Bit of the buffer `command` that asks for a new seed.
pub const RESEED: u32 = 2;
/// Bit of the buffer `command` that asks for the observation.
pub const OBSERVE: u32 = 4;
/// Buffers of a reset.
pub const RESET_BUFFERS: [&str; 6] = ["numbers", "words", "parameters", "command", "observation", "seed"];
/// Buffers of the physics alone.
pub const PHYSICS_BUFFERS: [&str; 4] = ["numbers", "words", "parameters", "ctrl"];

/// Rows of the buffer `result` before those of the summary: reward, terminated, truncated.
pub const RESULT_ROWS: usize = 3;

/// Bindings that every program begins with.
const NUMBERS: Buffer = per_env(0);
const WORDS: Buffer = per_env(1);
const PARAMETERS: Buffer = shared(2);
/// What the constraint solver did in a step: rounds, and physics steps that it left unsolved.
const COUNTS: Buffer = per_env(7);
/// The same where every environment has numbers of its own.
const OWN_PARAMETERS: Buffer = per_env(2);

const fn per_env(binding: u32) -> Buffer {
    Buffer { binding, sharing: Sharing::PerEnv }
}

const fn shared(binding: u32) -> Buffer {
    Buffer { binding, sharing: Sharing::Shared }
}

/// Whether what a body does can be recorded.
///
/// # Errors
/// Its meshes touch, or boxes of it touch something else than planes and capsules.
#[cfg(feature = "gpu")]
pub fn check(tables: &Tables<f64>) -> Result<(), BuildError> {
    if tables.plan.touches_one_by_one() { Err(BuildError::MeshesOnGpu) } else { Ok(()) }
}

/// One control step with everything that belongs to it but the reset, which is the next kernel's: in one kernel, all of a state would have to be handed on
/// past the branch of the few that begin anew, and drivers break down over it.
///
/// # Panics
/// The tables are of environments with rules of one's own, which are recorded from the rules, or cannot be recorded, see [`check`].
pub fn step(tables: &Tables<f64>, autoreset: Autoreset, form: Form) -> Program {
    step_by(&Script, tables, autoreset, form)
}

/// The same under a judge.
pub(crate) fn step_by(judge: &impl Judge, tables: &Tables<f64>, autoreset: Autoreset, form: Form) -> Program {
    trace_as(form, || {
        step_once(judge, tables, autoreset);
    })
}

/// The same with what the constraint solver did in the buffer [`COUNTS`], for the processor.
pub(crate) fn counted_step(judge: &impl Judge, tables: &Tables<f64>, autoreset: Autoreset) -> Program {
    trace_as(Form::Straight, || {
        let tally = step_once(judge, tables, autoreset);
        COUNTS.set_word(0, tally.rounds);
        COUNTS.set_word(1, tally.unsolved);
    })
}

/// Tells what the constraint solver did.
fn step_once(judge: &impl Judge, tables: &Tables<f64>, autoreset: Autoreset) -> SolverTally<Sym> {
    let [actions, observation, final_observation, result] = [3, 4, 5, 6].map(per_env);
    let (world, mut env, mut ws) = load(tables);
    for (row, u) in ws.ctrl.iter_mut().enumerate() {
        *u = actions.number(row);
    }
    let (outcome, _) = step_until_reset(judge, &world, autoreset, &mut env, &mut ws);
    set_rows(observation, 0, &ws.observation);
    Sym::when(outcome.terminated | outcome.truncated, &mut Nothing, |_| {
        set_rows(final_observation, 0, &ws.observation);
        set_rows(result, RESULT_ROWS, &ws.episode);
    });
    let flags = [outcome.terminated, outcome.truncated].map(Sym::indicator);
    set_rows(result, 0, &[outcome.reward, flags[0], flags[1]]);
    store(&mut env);
    ws.physics.tally
}

/// A reset of the environments that are told to, or whose step ends with it; and the observations of all that are told anything.
///
/// # Panics
/// As for [`step`].
pub fn reset_program(tables: &Tables<f64>, form: Form) -> Program {
    reset_by(&Script, tables, form)
}

/// The same under a judge.
pub(crate) fn reset_by(judge: &impl Judge, tables: &Tables<f64>, form: Form) -> Program {
    let [command, observation] = [3, 4].map(per_env);
    let seed = shared(5);
    let pending = StateRows::of(tables).pending;
    trace_as(form, || {
        let command = command.word(0);
        let asked = |bit: u32| Sym::lit(0.5).lt(Sym::from_word(command & SymWord::splat(bit)));
        let ends = Sym::lit(RESET_NOW - 0.5).lt(NUMBERS.number(pending));
        Sym::when(asked(OBSERVE | RESET | RESEED) | ends, &mut Nothing, |_| {
            let (world, mut env, mut ws) = load(tables);
            reseed([seed.word(0), seed.word(1)], asked(RESEED), &mut env);
            judge.reset(&world, asked(RESET) | ends, &mut env, &mut ws);
            set_rows(observation, 0, &ws.next_observation);
            store(&mut env);
        });
    })
}

/// The physics of one control step alone, for measurements.
pub fn physics(tables: &Tables<f64>, form: Form) -> Program {
    let ctrl = per_env(3);
    trace_as(form, || {
        let (world, mut env, mut ws) = load(tables);
        for (row, u) in ws.ctrl.iter_mut().enumerate() {
            *u = ctrl.number(row);
        }
        if tables.rules.is_some() {
            simulate(&world, &mut env, &mut ws, &mut Unwatched);
        } else {
            let goal = Goal::of(&world.parameters.task, &env.task);
            let mut stay = Stay::new(&env.task, &goal);
            simulate(&world, &mut env, &mut ws, &mut Following { goal: &goal, stay: &mut stay });
            // Kept, so that following it counts.
            (env.task.held, env.task.dwell, env.touch) = (stay.held, stay.pressed, stay.touch);
        }
        store(&mut env);
    })
}

fn load(tables: &Tables<f64>) -> (World<'_, Sym>, EnvState<Sym>, Scratch<Sym>) {
    let mut rows = 0..;
    let numbers = if tables.own_numbers { OWN_PARAMETERS } else { PARAMETERS };
    let parameter = &mut |_: &f64| numbers.number(rows.next().expect("there is no end"));
    let world = tables.with(tables.parameters.map(parameter));
    let mut env = EnvState::<Sym>::new(tables);
    for (row, x) in env.numbers().enumerate() {
        *x = NUMBERS.number(row);
    }
    for (row, x) in env.words().into_iter().enumerate() {
        *x = WORDS.word(row);
    }
    (world, env, Scratch::new(tables))
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

/// Writes rows from `first` on.
fn set_rows(buffer: Buffer, first: usize, values: &[Sym]) {
    for (row, &x) in (first..).zip(values) {
        buffer.set_number(row, x);
    }
}

/// A branch without variables: it only writes.
struct Nothing;

impl Carried<Sym> for Nothing {
    fn visit(&mut self, _: &mut impl Visitor<Sym>) {}
}
