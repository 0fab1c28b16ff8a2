//! The beginning of an episode: everything is drawn anew.

use super::{Scratch, choose, sense, stages};
use crate::misjudge;
use crate::parameters::World;
use crate::perceive;
use crate::state::EnvState;
use myo_scalar::{Counter, Mask, Scalar, Stage, Word, philox, unit};
use myo_tasks::logic::{self, Goal, Stay};

/// Random streams of the body's state.
const POSE_STREAM: u32 = 0x2000;
const VELOCITY_STREAM: u32 = 0x3000;
const ACTIVATION_STREAM: u32 = 0x4000;
const FATIGUE_STREAM: u32 = 0x4800;

/// Starts the random streams of environments where the mask is true anew.
#[inline(always)]
pub fn reseed<S: Scalar>(seed: [S::Word; 2], mask: S::Mask, env: &mut EnvState<S>) {
    for (old, new) in env.seed.iter_mut().zip(seed) {
        *old = S::select_word(mask, new, *old);
    }
    env.episode = S::select_word(mask, S::Word::splat(0), env.episode);
}

/// Starts a new episode of a script where the mask is true: body, targets, phase and all counters. Observations of all follow in
/// `next_observation`.
#[inline(always)]
pub fn reset<S: Scalar>(world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
    if mask.any() {
        let done_before = env.task.phase;
        S::outline(stages::Draw { world, mask, env });
        logic::begin_step(&world.parameters.task, mask, env.counter(), &mut env.task);
        misjudge::look(world, mask, env);
        S::outline(stages::Explore { world, mask, done_before, env, physics: &mut ws.physics });
    }
    let mut goal = Goal::of(&world.parameters.task, &env.task);
    let mut sensed = sense(world, &goal, goal.centre, env, Stay::new(&env.task, &goal), &mut ws.physics);
    if choose(world, &sensed.body, env) {
        goal = Goal::of(&world.parameters.task, &env.task);
        sensed.pointer = goal.pointer(&world.parameters.task, &sensed.body, goal.centre);
    }
    let known = logic::remember(&goal, sensed.pointer, mask, &mut env.task);
    let known = known.as_ref().unwrap_or(&goal);
    S::outline(stages::Observe { world, goal: known, env, sensed: &sensed, out: &mut ws.next_observation });
    perceive::after_reset(&world.tables.delays, mask, &mut env.late, &mut ws.next_observation);
}

/// Draws body and targets, and starts all counters.
#[inline(always)]
pub fn draw_episode<S: Scalar>(world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>) {
    let (zero, one) = (S::Word::splat(0), S::Word::splat(1));
    env.episode = S::select_word(mask, env.episode + one, env.episode);
    env.step = S::select_word(mask, zero, env.step);
    draw_body(world, mask, env);
    logic::draw_objects(&world.parameters.task, mask, env.counter(), &mut env.task);
    env.task.restart(mask);
    let counters = env.sums.iter_mut().chain(&mut env.qacc).chain(&mut env.remembered);
    let counters = counters.chain([&mut env.touch, &mut env.pending]);
    for x in counters {
        *x = S::select(mask, S::zero(), *x);
    }
}

#[inline(always)]
fn draw_body<S: Scalar>(world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>) {
    let start = &world.parameters.start;
    let (counter, body) = (env.counter(), &mut env.body);
    let (ndof, nmuscle) = (body.qpos.len(), body.act.len());
    for (position, draw) in body.qpos.iter_mut().zip(start.pose.at(uniform::<S>(counter, POSE_STREAM, ndof))) {
        *position = S::select(mask, draw, *position);
    }
    for (velocity, draw) in body.qvel.iter_mut().zip(uniform::<S>(counter, VELOCITY_STREAM, ndof)) {
        let share = draw.mul_add(S::lit(2.0), S::lit(-1.0));
        *velocity = S::select(mask, share * start.speed, *velocity);
    }
    for (act, draw) in body.act.iter_mut().zip(uniform::<S>(counter, ACTIVATION_STREAM, nmuscle)) {
        *act = S::select(mask, draw * start.activation, *act);
    }
    // As if muscles had been asked for long for what they do.
    for (asked, &act) in env.asked.iter_mut().zip(&body.act) {
        *asked = S::select(mask, act, *asked);
    }
    rest(world, mask, env);
}

/// Draws how tired muscles are; where it lasts, in the first episode alone.
#[inline(always)]
fn rest<S: Scalar>(world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>) {
    let Some(tiring) = &world.parameters.fatigue else { return };
    let first = S::from_word(env.episode).lt(S::lit(1.5));
    let fresh = if tiring.lasts { mask & first } else { mask };
    let draws = uniform::<S>(env.counter(), FATIGUE_STREAM, env.fatigue.len());
    for (fatigued, draw) in env.fatigue.iter_mut().zip(draws) {
        *fatigued = S::select(fresh, draw * tiring.initial, *fatigued);
    }
}

/// The first `count` uniform numbers in [0, 1) of a stream.
#[inline(always)]
pub fn uniform<S: Scalar>(counter: Counter<S::Word>, stream: u32, count: usize) -> Vec<S> {
    let mut draws = vec![S::zero(); count.next_multiple_of(4)];
    S::map_chunks(&mut draws, |block, _: [S; 4]| {
        let mut four = [S::zero(); 4];
        S::outline(Four { counter: Counter { stream: S::Word::splat(stream) + block, ..counter }, four: &mut four });
        four
    });
    draws.truncate(count);
    draws
}

/// Four uniform numbers. A stage, since closures that are called from several places are not inlined.
struct Four<'a, S: Scalar> {
    counter: Counter<S::Word>,
    four: &'a mut [S; 4],
}

impl<S: Scalar> Stage<S> for Four<'_, S> {
    const NAME: &'static str = "random numbers";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (x, word) in self.four.iter_mut().zip(philox::<S>(self.counter)) {
            *x = unit(word);
        }
    }
}
