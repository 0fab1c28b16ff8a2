//! One control step of the whole environment, written once for every kind of number.

use crate::observe::observe;
use crate::state::{EnvState, REWARD_TERMS};
use crate::tables::Tables;
use crate::vector::Autoreset;
use myo_dynamics::{Workspace, step};
use myo_muscle::noisy_excitation;
use myo_scalar::{Carried, Counter, Mask, Real, Scalar, Stage, Visitor, Word, normal_pair, philox, unit};
use myo_tasks::logic::{self, Progress, RewardTerms, Sensed};

/// Random streams of this crate.
const NOISE_STREAM: u32 = 0x1000;
const POSE_STREAM: u32 = 0x2000;
const VELOCITY_STREAM: u32 = 0x3000;
const ACTIVATION_STREAM: u32 = 0x4000;

/// Scratch memory and results of one control step.
pub struct Scratch<S: Scalar> {
    /// Of the physics.
    pub physics: Workspace<S>,
    /// Muscle excitations.
    pub ctrl: Vec<S>,
    /// The same while noise is added, an even number.
    noisy: Vec<S>,
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
            physics: Workspace::new(&tables.plan),
            ctrl: vec![S::zero(); tables.plan.nmuscle()],
            noisy: vec![S::zero(); tables.plan.nmuscle().next_multiple_of(2)],
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

/// Columns of an episode summary.
pub fn episode_names(ntarget: usize) -> Vec<String> {
    let fixed = [
        "return",
        "length",
        "success",
        "targets_done",
        "final_distance",
        "effort",
        "reward_distance",
        "reward_subtask",
        "reward_completion",
        "reward_neural_effort",
        "reward_acceleration_effort",
    ];
    let per_target = (1..=ntarget).flat_map(|k| [format!("target_{k}_success"), format!("target_{k}_time")]);
    fixed.into_iter().map(String::from).chain(per_target).collect()
}

/// Actions in [-1, 1] to a control step: noise, physics, judgement, reward, observation, summary.
#[inline(always)]
pub fn control_step<S: Scalar>(tables: &Tables<S::Const>, env: &mut EnvState<S>, ws: &mut Scratch<S>) -> Outcome<S> {
    S::outline(stages::Excite { tables, env, ws });
    S::outline(stages::Physics { tables, env, ws });
    let sensed = sense(tables, env, &mut ws.physics);
    let distance = distance_before(tables, env, &sensed);
    let progress = logic::advance(&tables.task, &sensed, &mut env.task);
    let effort = sum_of_squares(&ws.ctrl);
    let terms = logic::reward(&tables.task, &progress, distance, effort, sum_of_squares(&env.qacc));
    add_up(tables, env, &terms, effort);
    S::outline(stages::Observe { tables, env, sensed: &sensed, out: &mut ws.observation });
    summarise(tables, env, &sensed, &progress, &mut ws.episode);
    Outcome { reward: terms.sum(), terminated: progress.task_done, truncated: progress.timed_out }
}

/// Maps actions (in `ctrl`) to excitations `(a + 1) / 2` and adds motor noise.
#[inline(always)]
fn excite<S: Scalar>(tables: &Tables<S::Const>, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
    let Scratch { ctrl, noisy, .. } = ws;
    for u in ctrl.iter_mut() {
        *u = u.clamp(-1.0, 1.0).mul_add(S::lit(0.5), S::lit(0.5));
    }
    if let Some([signal_dependent, constant]) = tables.noise {
        let n = ctrl.len();
        noisy[..n].copy_from_slice(ctrl);
        let counter = env.counter();
        // One block of random words serves two muscles.
        S::map_chunks(noisy, |pair, two: [S; 2]| {
            let words = philox::<S>(Counter { stream: S::Word::splat(NOISE_STREAM) + pair, ..counter });
            let add = |u, a, b| {
                let (z1, z2) = normal_pair(a, b);
                noisy_excitation(u, signal_dependent, constant, z1, z2)
            };
            [add(two[0], words[0], words[1]), add(two[1], words[2], words[3])]
        });
        ctrl.copy_from_slice(&noisy[..n]);
    }
    env.step = env.step + S::Word::splat(1);
}

/// The stages of a control step that are functions of their own.
mod stages {
    use super::*;

    /// Noise.
    pub struct Excite<'a, S: Scalar> {
        pub tables: &'a Tables<S::Const>,
        pub env: &'a mut EnvState<S>,
        pub ws: &'a mut Scratch<S>,
    }

    impl<S: Scalar> Stage<S> for Excite<'_, S> {
        const NAME: &'static str = "excitation and noise";
        type Output = ();
        #[inline(always)]
        fn run(self) {
            excite(self.tables, self.env, self.ws);
        }
    }

    /// All physics steps of a control step.
    pub struct Physics<'a, S: Scalar> {
        pub tables: &'a Tables<S::Const>,
        pub env: &'a mut EnvState<S>,
        pub ws: &'a mut Scratch<S>,
    }

    impl<S: Scalar> Stage<S> for Physics<'_, S> {
        const NAME: &'static str = "physics";
        type Output = ();
        #[inline(always)]
        fn run(self) {
            simulate(self.tables, self.env, self.ws);
        }
    }

    /// Kinematics and observation of the state reached.
    pub struct Look<'a, S: Scalar> {
        pub tables: &'a Tables<S::Const>,
        pub env: &'a EnvState<S>,
        pub physics: &'a mut Workspace<S>,
        pub out: &'a mut [S; 3],
    }

    impl<S: Scalar> Stage<S> for Look<'_, S> {
        const NAME: &'static str = "fingertip";
        type Output = ();
        #[inline(always)]
        fn run(self) {
            let Self { tables, env, physics, out } = self;
            step::kinematics::kinematics(&tables.plan, &env.body.qpos, &env.body.qvel, physics);
            *out = step::fingertip(&tables.plan, physics);
        }
    }

    /// The observation.
    pub struct Observe<'a, S: Scalar> {
        pub tables: &'a Tables<S::Const>,
        pub env: &'a EnvState<S>,
        pub sensed: &'a Sensed<S>,
        pub out: &'a mut Vec<S>,
    }

    impl<S: Scalar> Stage<S> for Observe<'_, S> {
        const NAME: &'static str = "observation";
        type Output = ();
        #[inline(always)]
        fn run(self) {
            self.out.clear();
            observe(self.tables, self.env, self.sensed, self.out);
        }
    }

    /// Draws of a new episode.
    pub struct Draw<'a, S: Scalar> {
        pub tables: &'a Tables<S::Const>,
        pub mask: S::Mask,
        pub env: &'a mut EnvState<S>,
    }

    impl<S: Scalar> Stage<S> for Draw<'_, S> {
        const NAME: &'static str = "draws of a new episode";
        type Output = ();
        #[inline(always)]
        fn run(self) {
            draw_episode(self.tables, self.mask, self.env);
        }
    }
}

/// Runs the physics; a short tap between two control steps counts, so the greatest force is kept.
#[inline(always)]
pub fn simulate<S: Scalar>(tables: &Tables<S::Const>, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
    let Scratch { physics, ctrl, .. } = ws;
    (env.touch, env.touched) = (S::zero(), S::lit(-1.0));
    S::repeat(tables.substeps as usize, &mut Substep { env, physics }, |Substep { env, physics }| {
        step::step(&tables.plan, &tables.obstacles, ctrl, &mut env.body, physics);
        let contact = &physics.contact;
        let harder = contact.exists & env.touch.lt(contact.force);
        env.touch = S::select(harder, contact.force, env.touch);
        env.touched = S::select(harder, contact.index, env.touched);
    });
    env.qacc.copy_from_slice(&ws.physics.qacc);
}

/// What a physics step hands on.
struct Substep<'a, S: Scalar> {
    env: &'a mut EnvState<S>,
    physics: &'a mut Workspace<S>,
}

impl<S: Scalar> Carried<S> for Substep<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let body = &mut self.env.body;
        visitor.numbers(body.qpos.iter_mut().chain(&mut body.qvel).chain(&mut body.act));
        visitor.numbers([&mut self.env.touch, &mut self.env.touched]);
        visitor.numbers(&mut self.physics.qacc);
        visitor.word(&mut self.physics.tally.rounds);
        visitor.word(&mut self.physics.tally.unsolved);
    }
}

/// Where the fingertip is at the state reached, and what it touched on the way.
#[inline(always)]
fn sense<S: Scalar>(tables: &Tables<S::Const>, env: &EnvState<S>, physics: &mut Workspace<S>) -> Sensed<S> {
    let mut fingertip = [S::zero(); 3];
    S::outline(stages::Look { tables, env, physics, out: &mut fingertip });
    Sensed { fingertip, touch_force: env.touch, touched: env.touched }
}

#[inline(always)]
fn distance_before<S: Scalar>(tables: &Tables<S::Const>, env: &EnvState<S>, sensed: &Sensed<S>) -> S {
    let distance = logic::distance_to_target(&tables.task, sensed, &env.task);
    if tables.task.weights.remaining_path { distance + logic::remaining_path(&env.task) } else { distance }
}

#[inline(always)]
fn sum_of_squares<S: Scalar>(values: &[S]) -> S {
    let mut sum = S::zero();
    for &x in values {
        sum = x.mul_add(x, sum);
    }
    sum
}

#[inline(always)]
fn add_up<S: Scalar>(tables: &Tables<S::Const>, env: &mut EnvState<S>, terms: &RewardTerms<S>, effort: S) {
    let terms = terms.array();
    for (sum, term) in env.sums.iter_mut().zip(terms) {
        *sum += term;
    }
    env.sums[REWARD_TERMS] += effort * S::lit(1.0 / tables.plan.nmuscle().max(1) as f64);
}

/// Summary of the episode up to now; meaningful where it just ended.
#[inline(always)]
fn summarise<S: Scalar>(
    tables: &Tables<S::Const>,
    env: &EnvState<S>,
    sensed: &Sensed<S>,
    progress: &Progress<S>,
    out: &mut Vec<S>,
) {
    let task = &env.task;
    let mut total = S::zero();
    for &term in &env.sums[..REWARD_TERMS] {
        total += term;
    }
    out.clear();
    out.push(total);
    out.push(task.step);
    out.push(S::indicator(progress.task_done));
    out.push(task.phase);
    out.push(logic::norm(logic::difference(sensed.fingertip, task.centre(0))));
    out.push(env.sums[REWARD_TERMS] * task.step.recip());
    out.extend_from_slice(&env.sums[..REWARD_TERMS]);
    let dt = tables.task.control_dt.to_f64();
    let mut before = S::zero();
    for &done_at in &task.done_at {
        let done = S::zero().lt(done_at);
        out.push(S::indicator(done));
        // Time since the target before was done.
        out.push(S::select(done, (done_at - before) * S::lit(dt), S::lit(f64::NAN)));
        before = done_at;
    }
}

/// A control step and what follows the end of an episode. Observations are in `observation` (before any reset) and
/// `next_observation`, the summary in `episode`.
#[inline(always)]
pub fn step_and_autoreset<S: Scalar>(
    tables: &Tables<S::Const>,
    autoreset: Autoreset,
    env: &mut EnvState<S>,
    ws: &mut Scratch<S>,
) -> Outcome<S> {
    let waiting = S::lit(0.5).lt(env.pending);
    let outcome = control_step(tables, env, ws);
    let terminated = outcome.terminated & !waiting;
    let truncated = outcome.truncated & !waiting;
    let done = terminated | truncated;
    let again = match autoreset {
        Autoreset::SameStep => done,
        Autoreset::NextStep => waiting,
        Autoreset::Disabled => S::Mask::splat(false),
    };
    let Scratch { observation, next_observation, .. } = ws;
    next_observation.clone_from(observation);
    S::when(again, &mut Fresh { env, ws }, |Fresh { env, ws }| reset(tables, again, env, ws));
    if autoreset == Autoreset::NextStep {
        env.pending = S::indicator(done);
    }
    Outcome { reward: outcome.reward.only(!waiting), terminated, truncated }
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

/// Starts the random streams of environments where the mask is true anew.
#[inline(always)]
pub fn reseed<S: Scalar>(seed: [S::Word; 2], mask: S::Mask, env: &mut EnvState<S>) {
    for (old, new) in env.seed.iter_mut().zip(seed) {
        *old = S::select_word(mask, new, *old);
    }
    env.episode = S::select_word(mask, S::Word::splat(0), env.episode);
}

/// Starts a new episode where the mask is true: body, targets, phase and all counters. Observations of all follow in
/// `next_observation`.
#[inline(always)]
pub fn reset<S: Scalar>(tables: &Tables<S::Const>, mask: S::Mask, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
    if mask.any() {
        S::outline(stages::Draw { tables, mask, env });
    }
    let sensed = sense(tables, env, &mut ws.physics);
    S::outline(stages::Observe { tables, env, sensed: &sensed, out: &mut ws.next_observation });
}

#[inline(always)]
fn draw_episode<S: Scalar>(tables: &Tables<S::Const>, mask: S::Mask, env: &mut EnvState<S>) {
    let (zero, one) = (S::Word::splat(0), S::Word::splat(1));
    env.episode = S::select_word(mask, env.episode + one, env.episode);
    env.step = S::select_word(mask, zero, env.step);
    draw_body(tables, mask, env);
    logic::draw_targets(&tables.task, mask, env.counter(), &mut env.task);
    env.task.restart(mask);
    let counters = env.sums.iter_mut().chain(&mut env.qacc).chain([&mut env.touch, &mut env.pending]);
    for x in counters {
        *x = S::select(mask, S::zero(), *x);
    }
}

#[inline(always)]
fn draw_body<S: Scalar>(tables: &Tables<S::Const>, mask: S::Mask, env: &mut EnvState<S>) {
    let start = &tables.start;
    let (counter, body) = (env.counter(), &mut env.body);
    let (ndof, nmuscle) = (body.qpos.len(), body.act.len());
    for (k, draw) in uniform::<S>(counter, POSE_STREAM, ndof).into_iter().enumerate() {
        let position = draw.mul_add(S::splat(start.width[k]), S::splat(start.lowest[k]));
        body.qpos[k] = S::select(mask, position, body.qpos[k]);
    }
    for (velocity, draw) in body.qvel.iter_mut().zip(uniform::<S>(counter, VELOCITY_STREAM, ndof)) {
        let share = draw.mul_add(S::lit(2.0), S::lit(-1.0));
        *velocity = S::select(mask, share * S::splat(start.speed), *velocity);
    }
    for (act, draw) in body.act.iter_mut().zip(uniform::<S>(counter, ACTIVATION_STREAM, nmuscle)) {
        *act = S::select(mask, draw * S::splat(start.activation), *act);
    }
}

/// The first `count` uniform numbers in [0, 1) of a stream.
#[inline(always)]
fn uniform<S: Scalar>(counter: Counter<S::Word>, stream: u32, count: usize) -> Vec<S> {
    let mut draws = vec![S::zero(); count.next_multiple_of(4)];
    S::map_chunks(&mut draws, |block, _: [S; 4]| {
        philox::<S>(Counter { stream: S::Word::splat(stream) + block, ..counter }).map(unit)
    });
    draws.truncate(count);
    draws
}
