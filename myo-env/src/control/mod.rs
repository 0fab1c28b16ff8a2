//! One control step of the whole environment, written once for every kind of number.

mod episode;
mod excite;
pub mod explore;
mod judge;
mod own;
mod simulate;
mod stages;
mod summary;

pub use episode::{reseed, reset};
pub use excite::excitation;
pub use judge::{Judge, Script};
pub use own::Own;
pub use simulate::{Following, Unwatched, offsets, simulate};
pub use summary::{EPISODE_COLUMNS, TARGET_COLUMNS, episode_names};

use crate::misjudge;
use crate::parameters::World;
use crate::perceive;
use crate::state::{EnvState, RESET_NOW};
use crate::tables::Tables;
use crate::vector::Autoreset;
use myo_dynamics::Workspace;
use myo_scalar::{Carried, Mask, Scalar, Visitor};
use myo_tasks::logic::{self, Efforts, Goal, Landmarks, Point, Progress, Sensed, Stay};

/// Scratch memory and results of one control step.
pub struct Scratch<S: Scalar> {
    /// Of the physics.
    pub physics: Workspace<S>,
    /// Muscle excitations.
    pub ctrl: Vec<S>,
    /// Sum over muscles of squared changes of the control, without noise, where that costs something; else 0.
    pub squared_change: S,
    /// Sum of the squared controls that are asked for in the control step, noise included.
    pub squared_control: S,
    /// Standard normal numbers for motor noise, a multiple of four.
    draws: Vec<S>,
    /// Every physics step of the control step, where somebody wants to know, as [`TraceShape`](crate::TraceShape) says.
    pub trace: Option<Vec<S>>,
    /// Observation after the step, before any reset.
    pub observation: Vec<S>,
    /// Observation after resets.
    pub next_observation: Vec<S>,
    /// Summary of the episode so far, in the order of [`episode_names`].
    pub episode: Vec<S>,
}

impl<S: Scalar> Scratch<S> {
    /// Memory for these tables.
    #[inline(always)]
    pub fn new(tables: &Tables<S::Const>) -> Self {
        Self {
            physics: Workspace::with_contacts(&tables.plan, tables.contacts),
            ctrl: vec![S::zero(); tables.plan.nmuscle()],
            squared_change: S::zero(),
            squared_control: S::zero(),
            draws: vec![S::zero(); tables.plan.nmuscle().next_multiple_of(4)],
            trace: None,
            observation: vec![],
            next_observation: vec![],
            episode: vec![],
        }
    }
}

/// What a control step returns besides the vectors in [`Scratch`].
pub struct Outcome<S: Scalar> {
    /// Sum of the reward terms.
    pub reward: S,
    /// The task is done.
    pub terminated: S::Mask,
    /// The time is up and the task is not done.
    pub truncated: S::Mask,
}

/// Actions in [-1, 1] to a control step of a script: noise, physics, judgement, reward, observation, summary.
#[inline(always)]
pub fn control_step<S: Scalar>(world: &World<'_, S>, env: &mut EnvState<S>, ws: &mut Scratch<S>) -> Outcome<S> {
    S::outline(stages::Excite { world, env, ws });
    let goal = Goal::of(&world.parameters.task, &env.task);
    let mut stay = Stay::new(&env.task, &goal);
    S::outline(stages::Physics { world, env, ws, watch: &mut Following { goal: &goal, stay: &mut stay } });
    let mut sensed = sense(world, &goal, goal.centre_after(S::lit(1.0)), env, stay, &mut ws.physics);
    let (distance, progress) = judge(world, &goal, env, &sensed);
    // After the last step is over it stays the current one.
    let begins = progress.target_over & !progress.task_over;
    logic::begin_step(&world.parameters.task, begins, env.counter(), &mut env.task);
    misjudge::look_again(world, begins, env);
    choose(world, &sensed.body, env);
    let goal = Goal::of(&world.parameters.task, &env.task);
    sensed.pointer = goal.pointer(&world.parameters.task, &sensed.body, goal.centre);
    let effort = ws.squared_control;
    let efforts = Efforts {
        squared_control: effort,
        squared_acceleration: sum_of_squares(&env.qacc),
        squared_change: ws.squared_change,
        squared_force: sensed.stay.squared_force * S::lit(world.tables.share()),
    };
    let terms = logic::reward(&world.parameters.task, &progress, distance, efforts);
    let errors = [progress.wrong_presses, progress.exits];
    summary::add_up(world, env, &terms.array(), errors, effort, &ws.physics.tally);
    let known = logic::remember(&goal, sensed.pointer, progress.target_over, &mut env.task);
    let known = known.as_ref().unwrap_or(&goal);
    S::outline(stages::Observe { world, goal: known, env, sensed: &sensed, out: &mut ws.observation });
    perceive::after_step(&world.tables.delays, &mut env.late, &mut ws.observation);
    summary::summarise(world, &goal, env, &sensed, &progress, &mut ws.episode);
    Outcome { reward: terms.sum(), terminated: progress.task_done, truncated: progress.timed_out }
}

/// Lets what is nearest be the current step where any order counts, and tells whether the task has such steps.
#[inline(always)]
fn choose<S: Scalar>(world: &World<'_, S>, body: &Landmarks<S>, env: &mut EnvState<S>) -> bool {
    let is_free = world.parameters.task.orders.iter().any(|order| order.is_any);
    if is_free {
        S::outline(stages::Choose { world, body, env });
    }
    is_free
}

/// Where body and pointer are at the state reached, with the current object at `at`, and what happened on the way. The
/// control step is not counted yet.
#[inline(always)]
fn sense<S: Scalar>(
    world: &World<'_, S>,
    goal: &Goal<S>,
    at: Point<S>,
    env: &EnvState<S>,
    stay: Stay<S>,
    physics: &mut Workspace<S>,
) -> Sensed<S> {
    let mut body = Landmarks::unknown();
    S::outline(stages::Look { world, env, physics, cursor: stay.cursor, out: &mut body });
    let pointer = goal.pointer(&world.parameters.task, &body, at);
    let now = (env.task.step + S::lit(1.0)) * S::lit(f64::from(world.tables.substeps));
    Sensed { body, pointer, stay, now }
}

/// How far (m) the pointer still has to go, as the reward counts it; and what became of the current step.
#[inline(always)]
fn judge<S: Scalar>(
    world: &World<'_, S>,
    goal: &Goal<S>,
    env: &mut EnvState<S>,
    sensed: &Sensed<S>,
) -> (S, Progress<S>) {
    let task = &world.parameters.task;
    let mut distance = logic::distance_to_goal(task, sensed, goal);
    if task.weights.remaining_path {
        distance += logic::remaining_path(task, &env.task);
    }
    let progress = logic::advance(task, goal, sensed, &mut env.task, world.tables.share());
    env.touch = sensed.stay.touch;
    (distance, progress)
}

#[inline(always)]
fn sum_of_squares<S: Scalar>(values: &[S]) -> S {
    let mut sum = S::zero();
    for &x in values {
        sum = x.mul_add(x, sum);
    }
    sum
}

/// A control step, and in [`EnvState::pending`] what must follow. Observations are in `observation`, the summary in `episode`. Where the mask that comes
/// back is true, the reset must come next; a card leaves it to the kernel of resets, which reads as much in `pending`.
#[inline(always)]
pub fn step_until_reset<S: Scalar>(
    judge: &impl Judge,
    world: &World<'_, S>,
    autoreset: Autoreset,
    env: &mut EnvState<S>,
    ws: &mut Scratch<S>,
) -> (Outcome<S>, S::Mask) {
    let waiting = S::lit(0.5).lt(env.pending);
    let outcome = judge.control_step(world, env, ws);
    let terminated = outcome.terminated & !waiting;
    let truncated = outcome.truncated & !waiting;
    let done = terminated | truncated;
    let (again, later) = match autoreset {
        Autoreset::SameStep => (done, S::Mask::splat(false)),
        Autoreset::NextStep => (waiting, done),
        Autoreset::Disabled => (S::Mask::splat(false), done),
    };
    env.pending = S::select(again, S::lit(RESET_NOW), S::indicator(later));
    (Outcome { reward: outcome.reward.only(!waiting), terminated, truncated }, again)
}

/// A control step and what follows the end of an episode. Observations are in `observation` (before any reset) and
/// `next_observation`, the summary in `episode`.
#[inline(always)]
pub fn step_and_autoreset<S: Scalar>(
    judge: &impl Judge,
    world: &World<'_, S>,
    autoreset: Autoreset,
    env: &mut EnvState<S>,
    ws: &mut Scratch<S>,
) -> Outcome<S> {
    let (outcome, again) = step_until_reset(judge, world, autoreset, env, ws);
    let Scratch { observation, next_observation, .. } = ws;
    next_observation.clone_from(observation);
    S::when(again, &mut Fresh { env, ws }, |Fresh { env, ws }| judge.reset(world, again, env, ws));
    outcome
}

/// What a reset changes.
struct Fresh<'a, S: Scalar> {
    env: &'a mut EnvState<S>,
    ws: &'a mut Scratch<S>,
}

impl<S: Scalar> Carried<S> for Fresh<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers(self.env.numbers());
        for word in self.env.words() {
            visitor.word(word);
        }
        visitor.numbers(&mut self.ws.next_observation);
    }
}
