//! Everything about one environment (or one per lane) that changes.

use crate::misjudge;
use crate::perceive;
use crate::tables::Tables;
use crate::vector::EnvSpec;
use myo_dynamics::State;
use myo_scalar::{Counter, Real, Scalar, Word};
use myo_tasks::logic::TaskState;

/// Number of weighted reward terms that are summed up over an episode.
pub const REWARD_TERMS: usize = 9;

/// Where the other sums over an episode stand behind those of the reward terms.
pub const EFFORT_SUM: usize = REWARD_TERMS;
/// See [`EnvState::sums`].
pub const FATIGUE_SUM: usize = EFFORT_SUM + 1;
/// See [`EnvState::sums`].
pub const ROUNDS_SUM: usize = FATIGUE_SUM + 1;
/// See [`EnvState::sums`].
pub const UNSOLVED_SUM: usize = ROUNDS_SUM + 1;
/// See [`EnvState::sums`].
pub const WRONG_SUM: usize = UNSOLVED_SUM + 1;
/// See [`EnvState::sums`].
pub const EXIT_SUM: usize = WRONG_SUM + 1;
/// How many sums there are.
const SUMS: usize = EXIT_SUM + 1;

/// [`EnvState::pending`] where a reset is part of the step that was made.
pub const RESET_NOW: f64 = 2.0;

/// State of one environment per lane.
#[derive(Clone, Debug)]
pub struct EnvState<S: Scalar> {
    /// The body.
    pub body: State<S>,
    /// Targets and counters.
    pub task: TaskState<S>,
    /// Accelerations of the last physics step (rad/s^2); zero after a reset.
    pub qacc: Vec<S>,
    /// Motor noise of each muscle, in standard deviations; empty without.
    pub noise: Vec<S>,
    /// What of each muscle is fatigued, a share; empty where muscles do not tire.
    pub fatigue: Vec<S>,
    /// Control that each muscle was last asked for, without noise; empty where changing it costs nothing.
    pub asked: Vec<S>,
    /// What how far off the current target seems is made of, standard normal numbers, see [`misjudge`](crate::misjudge); empty where all is seen as it is.
    pub misjudged: Vec<S>,
    /// Greatest force on all fingers together in the last control step (N), whatever it touches.
    pub touch: S,
    /// One where the episode is over: the next step resets instead of stepping, or is refused until there was a reset. [`RESET_NOW`] from the step to
    /// the reset that ends it.
    pub pending: S,
    /// Sums over the episode: reward terms, mean squared controls, what fatigues, rounds of the constraint solver, physics steps that it left
    /// unsolved, presses that were not asked for, and ways left. Counts are exact up to 2^24.
    pub sums: [S; SUMS],
    /// What rules of one's own remember; empty where a script judges.
    pub remembered: Vec<S>,
    /// What they observed last: an observation that is asked for anew shows it as it was.
    pub observed: Vec<S>,
    /// What was there to perceive lately, see [`perceive`](crate::perceive); empty without delays.
    pub late: Vec<S>,
    /// Seed, low half first.
    pub seed: [S::Word; 2],
    /// Which environment, see [`env_number`].
    pub env: S::Word,
    /// Which episode.
    pub episode: S::Word,
    /// Control steps in this episode, for random draws.
    pub step: S::Word,
}

/// Environments with this bit in their number begin their episodes with any target.
pub const EXPLORES: u32 = 1 << 31;

/// Number of an environment in its state, which its random draws depend on too.
pub fn env_number(spec: &EnvSpec, env: usize) -> u32 {
    let explores = if env < spec.whole_episodes() { 0 } else { EXPLORES };
    env as u32 | explores
}

impl<S: Scalar> EnvState<S> {
    /// Memory, of the sizes of tables in any precision; to be filled by `load` or a reset.
    #[inline(always)]
    pub fn new<C: Real>(tables: &Tables<C>) -> Self {
        let (o, w) = (S::zero(), S::Word::splat(0));
        Self {
            body: State::new(&tables.plan),
            task: TaskState::new(&tables.parameters.task),
            qacc: vec![o; tables.plan.ndof()],
            noise: vec![o; if tables.parameters.noise.is_some() { tables.plan.nmuscle() } else { 0 }],
            fatigue: vec![o; if tables.parameters.fatigue.is_some() { tables.plan.nmuscle() } else { 0 }],
            asked: vec![
                o;
                if tables.parameters.task.weights.change_cost.is_some() { tables.plan.nmuscle() } else { 0 }
            ],
            misjudged: vec![o; if tables.parameters.vision_noise.is_some() { misjudge::DRAWS } else { 0 }],
            touch: o,
            pending: o,
            sums: [o; SUMS],
            remembered: vec![o; tables.rules.as_ref().map_or(0, |rules| rules.remembered)],
            observed: vec![o; tables.rules.as_ref().map_or(0, |rules| rules.observed.len())],
            late: vec![o; perceive::memory(&tables.delays)],
            seed: [w; 2],
            env: w,
            episode: w,
            step: w,
        }
    }

    /// How many integers [`EnvState::words`] visits.
    pub const WORDS: usize = 5;
    /// Which of them is the number of the environment.
    pub const ENV_ROW: usize = 2;
    /// Which of them is the number of the episode.
    pub const EPISODE_ROW: usize = 3;

    /// Every number, in a fixed order.
    ///
    /// The one list of them: memory of lanes, rows on a card, saved states, snapshots, and what a reset hands on have this order. The
    /// pattern names all fields, so that a new one cannot be forgotten. Loops and branches that change a few numbers name these,
    /// since on a card each number that is handed on takes a register.
    #[inline(always)]
    pub fn numbers(&mut self) -> impl Iterator<Item = &mut S> {
        let Self {
            body: State { qpos, qvel, act },
            task,
            qacc,
            noise,
            fatigue,
            asked,
            misjudged,
            touch,
            pending,
            sums,
            remembered,
            observed,
            late,
            seed: _,
            env: _,
            episode: _,
            step: _,
        } = self;
        let body = qpos
            .iter_mut()
            .chain(qvel)
            .chain(act)
            .chain(qacc)
            .chain(noise)
            .chain(fatigue)
            .chain(asked)
            .chain(misjudged);
        body.chain(task.numbers()).chain([touch, pending]).chain(sums).chain(remembered).chain(observed).chain(late)
    }

    /// Every integer, in a fixed order; see [`numbers`](Self::numbers).
    #[inline(always)]
    pub fn words(&mut self) -> [&mut S::Word; 5] {
        let [low, high] = &mut self.seed;
        [low, high, &mut self.env, &mut self.episode, &mut self.step]
    }

    /// Names the random draws of the current step; the caller sets the stream.
    #[inline(always)]
    pub fn counter(&self) -> Counter<S::Word> {
        Counter { seed: self.seed, env: self.env, episode: self.episode, step: self.step, stream: S::Word::splat(0) }
    }
}

/// Where numbers stand among those of a state.
#[derive(Clone, Copy, Debug)]
pub struct StateRows {
    /// How many there are.
    pub count: usize,
    /// Which of them is [`EnvState::pending`].
    pub pending: usize,
}

impl StateRows {
    /// The rows of a model's and task's states.
    pub fn of<C: Real + Scalar<Const = C>>(tables: &Tables<C>) -> Self {
        let mut state = EnvState::<C>::new(tables);
        let count = state.numbers().count();
        // Others may be as large as any number that is set: an order of steps, for one.
        state.numbers().for_each(|number| *number = C::lit(0.0));
        state.pending = C::lit(1.0);
        let pending = state.numbers().position(|x| x.to_f64() > 0.0).expect("one number was set");
        Self { count, pending }
    }
}
