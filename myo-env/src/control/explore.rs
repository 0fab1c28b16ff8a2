//! Exploring starts: episodes that begin in the middle of the task.
//!
//! A target that is not done hides all that come after it, and a posture in which the arm comes to rest near a target hides
//! the one in which it would do it. So some environments of a training begin their episodes with any of the targets, late,
//! and in that of several random poses from which the fingertip has the least way to go: to the front of a button, not to its back, from where
//! nobody comes to press it. Mostly they begin with the target at which their last episode ended, if it was not done: what fails is practised most. After a success every other episode
//! is a whole one: the better the user, the less is left to explore.

use super::episode::uniform;
use super::stages;
use crate::parameters::World;
use crate::state::{EXPLORES, EnvState};
use myo_dynamics::Workspace;
use myo_scalar::{Carried, Counter, Scalar, Visitor, Word};
use myo_tasks::logic::{self, Landmarks, Point};

/// Random stream of the target and of the time.
const MOMENT_STREAM: u32 = 0x5000;
/// Random stream of poses.
const POSE_STREAM: u32 = 0x6000;
/// Poses that are drawn, and so many more for a target that was not done before.
const POSES: usize = 8;
const MORE_POSES: usize = 24;
/// Least and greatest share of the time limit that is left: the shorter episodes are, the more of them begin.
pub const LEFT: [f64; 2] = [0.1, 0.5];
/// Share of episodes after a failure that begin with the target that was not done.
const AGAIN: f64 = 0.75;
/// Share of episodes after a success that are whole.
const WHOLE: f64 = 0.5;
/// Share of those that begin in the middle whose fingers were open before, where they must be for a pinch.
const OPEN: f64 = 0.5;

/// Changes how an episode begins, of those in the mask where environments explore. `done_before` of the targets were done when
/// the last episode ended.
#[inline(always)]
pub fn explore<S: Scalar>(
    world: &World<'_, S>,
    mask: S::Mask,
    done_before: S,
    env: &mut EnvState<S>,
    physics: &mut Workspace<S>,
) {
    let explores = mask & S::lit(0.5).lt(S::from_word(env.env >> EXPLORES.trailing_zeros()));
    S::when(explores, &mut Beginning { env, physics }, |Beginning { env, physics }| {
        S::outline(stages::BeginAnywhere { world, explores, done_before, env, physics });
    });
}

/// Begins in the middle of the task, where the mask is true and nothing speaks for a whole episode.
#[inline(always)]
pub fn begin_anywhere<S: Scalar>(
    world: &World<'_, S>,
    explores: S::Mask,
    done_before: S,
    env: &mut EnvState<S>,
    physics: &mut Workspace<S>,
) {
    let draws = uniform::<S>(env.counter(), MOMENT_STREAM, if env.task.open.is_some() { 5 } else { 4 });
    let (targets, is_not_first) = (world.parameters.task.steps.len() as f64, S::lit(1.5).lt(S::from_word(env.episode)));
    let failed = is_not_first & done_before.lt(S::lit(targets));
    let succeeded = is_not_first & S::lit(targets).le(done_before);
    let middle = explores & !(succeeded & draws[3].lt(S::lit(WHOLE)));
    let again = middle & failed & draws[2].lt(S::lit(AGAIN));
    let done = S::select(again, done_before, any_target(world, draws[0]));
    env.task.phase = S::select(middle, done, env.task.phase);
    env.task.step = S::select(middle, late(world, draws[1]), env.task.step);
    logic::begin_step(&world.parameters.task, middle, env.counter(), &mut env.task);
    if let Some(open) = &mut env.task.open {
        *open = S::select(middle & draws[4].lt(S::lit(OPEN)), S::lit(1.0), *open);
    }
    draw_pose(world, middle, again, env, physics);
}

/// Any target.
#[inline(always)]
fn any_target<S: Scalar>(world: &World<'_, S>, draw: S) -> S {
    let targets = world.parameters.task.steps.len();
    let mut done = S::zero();
    for target in 1..targets {
        done += S::indicator(S::lit(target as f64 / targets as f64).le(draw));
    }
    done
}

/// A step of the later part of an episode.
#[inline(always)]
fn late<S: Scalar>(world: &World<'_, S>, draw: S) -> S {
    let limit = world.parameters.task.time_limit;
    let left = draw.mul_add(S::lit(LEFT[1] - LEFT[0]), S::lit(LEFT[0])) * limit;
    limit - left.floor().max(S::lit(1.0))
}

/// The pose of several from which the fingertip is nearest to the current target: of more where it is tried `again`, which is within the mask.
#[inline(always)]
fn draw_pose<S: Scalar>(
    world: &World<'_, S>,
    mask: S::Mask,
    again: S::Mask,
    env: &mut EnvState<S>,
    physics: &mut Workspace<S>,
) {
    let (nearest, looked, draw) = (S::lit(f64::from(f32::MAX)), S::zero(), S::Word::splat(0));
    let mut search = Search { best: env.body.qpos.clone(), nearest, looked, draw, env, physics };
    let target = logic::begins_at(&world.parameters.task, &search.env.task);
    S::repeat_while(POSES + MORE_POSES, &mut search, |search| {
        S::outline(stages::TryPose { world, target, mask, again, search })
    });
    search.env.body.qpos = search.best;
}

/// Looks at one pose more; true where another is asked for.
#[inline(always)]
pub fn try_pose<S: Scalar>(
    world: &World<'_, S>,
    target: Point<S>,
    mask: S::Mask,
    again: S::Mask,
    search: &mut Search<'_, S>,
) -> S::Mask {
    let Search { best, nearest, looked, draw, env, physics } = search;
    draw_any_pose(world, *draw, env);
    let mut body = Landmarks::unknown();
    S::outline(stages::Look { world, env, physics, cursor: [S::zero(); 2], out: &mut body });
    let distance = logic::gap(&world.parameters.task, &env.task, &body, target);
    let is_asked_for = again | mask & looked.lt(S::lit(POSES as f64));
    let nearer = is_asked_for & distance.lt(*nearest);
    *nearest = S::select(nearer, distance, *nearest);
    for (best, &position) in best.iter_mut().zip(&env.body.qpos) {
        *best = S::select(nearer, position, *best);
    }
    *draw = *draw + S::Word::splat(1);
    *looked += S::lit(1.0);
    again | mask & looked.lt(S::lit(POSES as f64))
}

/// Any pose, everywhere.
#[inline(always)]
fn draw_any_pose<S: Scalar>(world: &World<'_, S>, draw: S::Word, env: &mut EnvState<S>) {
    let ndof = env.body.qpos.len();
    let draws = uniform::<S>(Counter { step: draw, ..env.counter() }, POSE_STREAM, ndof);
    for (position, drawn) in env.body.qpos.iter_mut().zip(world.parameters.start.any_pose.at(draws)) {
        *position = drawn;
    }
}

/// What exploring changes: these numbers and no others, so that no others take a register of a card while it searches.
struct Beginning<'a, S: Scalar> {
    env: &'a mut EnvState<S>,
    physics: &'a mut Workspace<S>,
}

impl<S: Scalar> Carried<S> for Beginning<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let EnvState { body, task, .. } = self.env;
        let cue = task.cue.iter_mut().flat_map(|cue| [&mut cue.object, &mut cue.lit_at]);
        visitor.numbers(body.qpos.iter_mut().chain([&mut task.phase, &mut task.step]).chain(cue).chain(&mut task.open));
    }
}

/// The search for a pose.
pub struct Search<'a, S: Scalar> {
    /// The best so far.
    best: Vec<S>,
    /// Its distance from the target (m).
    nearest: S,
    /// Poses looked at so far.
    looked: S,
    /// The same, for random numbers.
    draw: S::Word,
    /// In the pose that is looked at.
    env: &'a mut EnvState<S>,
    physics: &'a mut Workspace<S>,
}

impl<S: Scalar> Carried<S> for Search<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers(self.best.iter_mut().chain([&mut self.nearest, &mut self.looked]));
        visitor.word(&mut self.draw);
    }
}
