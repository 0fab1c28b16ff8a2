//! What a viewer sees of one environment, out of its memory or out of a saved state.

use crate::saved::Saved;
use crate::state::EnvState;
use crate::tables::Tables;
use crate::vector::EnvError;
use myo_dynamics::State;
use myo_scalar::Real;
use myo_tasks::logic::TaskState;

/// Where an integer stands among those of a state.
const EPISODE: usize = EnvState::<f64>::EPISODE_ROW;

/// One environment at one moment, in double precision whatever it is simulated in.
/// [`VectorEnv::peek`](crate::VectorEnv::peek) takes it, [`Skeleton`](crate::Skeleton) tells where everything is in it.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The body: `qpos` and `qvel` of the independent joints (rad, rad/s; m, m/s for slides), `(ndof)` each, and the
    /// activations `act` of the muscles in [0, 1], `(nmuscle)`.
    pub body: State<f64>,
    /// What of each muscle is fatigued, a share, `(nmuscle)`; empty where muscles do not tire.
    pub fatigue: Vec<f64>,
    /// Where spheres are in this episode (m from the shoulder centre, world axes), how large, and how far the task is.
    pub task: TaskState<f64>,
    /// Greatest force on the current button in the last control step (N); zero for a sphere and after a reset.
    pub touch: f64,
    /// What rules of one's own remember; empty where a script judges.
    pub remembered: Vec<f64>,
    /// Whether the episode is over and no other one has begun. An environment that starts the next one in the same step is never
    /// seen like this.
    pub ended: bool,
    /// Number of the episode, counted from the last seed, from one on.
    pub episode: u32,
}

impl Snapshot {
    /// Environment `env` of a state that [`VectorEnv::save_state`](crate::VectorEnv::save_state) returned.
    ///
    /// # Errors
    /// The state is damaged, is not one of this model and task, or has no such environment.
    pub fn read<C: Real>(tables: &Tables<C>, state: &[u8], env: usize) -> Result<Self, EnvError> {
        let saved = Saved::read(state).and_then(|saved| saved.with_env(env));
        let saved = saved.map_err(|reason| EnvError::BadState { reason })?;
        let count = EnvState::<f64>::new(tables).numbers().count();
        if saved.header.identity != tables.identity || saved.header.count != count {
            return Err(EnvError::BadState { reason: "it is of another model or task".into() });
        }
        Ok(Self::of(tables, |k| saved.number(env, k), |k| saved.word(env, k)))
    }

    /// From the numbers and integers of a state, by their places in it.
    pub(crate) fn of<C: Real>(tables: &Tables<C>, number: impl Fn(usize) -> f64, word: impl Fn(usize) -> u32) -> Self {
        let mut env = EnvState::<f64>::new(tables);
        for (k, x) in env.numbers().enumerate() {
            *x = number(k);
        }
        let EnvState { body, fatigue, task, touch, pending, remembered, .. } = env;
        Self { body, fatigue, task, touch, remembered, ended: pending > 0.5, episode: word(EPISODE) }
    }
}
