//! Tasks of one's own: observation, judgement and reward as one function, in place of a script.

use crate::columns::{self, Column};
use crate::config::{BuildError, EnvConfig};
use crate::tables::Tables;
use crate::vector::EnvSpec;
use myo_scalar::{Mask, Real, Scalar};
use myo_tasks::logic::Point;
use std::collections::HashSet;
use std::fmt::Debug;

/// What a task of one's own asks for, in place of a script: one function, generic over the kind of number, that observes, judges
/// and rewards. It runs wherever environments do: in double precision ([`ReferenceEnv`](crate::ReferenceEnv)), on the lanes of a
/// processor ([`CpuEnv`](crate::CpuEnv)), and recorded into the kernel of a graphics card (`GpuEnv`); each has `with_rules`.
///
/// Of the [`Task`](myo_tasks::Task) that comes with it count body, scene, time limit, control step, reset, noise and those parts of
/// the observation that are about body and time. Boxes of the scene stand in the way, spheres and places that are ranges are drawn in every episode (where boxes are
/// is observed with `nearest_obstacle`). Its
/// script and its weights of the reward do not count; it may have none ([`Task::without_script`](myo_tasks::Task::without_script)).
///
/// ```
/// use myo_env::{CpuEnv, EnvConfig, Moment, Rules, StepStorage, Verdict, VectorEnv};
/// use myo_scalar::Scalar;
///
/// /// The fingertip is to be as high as it goes, and never lower than it was.
/// #[derive(Clone, Debug)]
/// struct Climb;
///
/// impl Rules for Climb {
///     fn name(&self) -> &str {
///         "climb"
///     }
///     fn observed(&self) -> Vec<String> {
///         vec!["height_lost".into()]
///     }
///     fn remembered(&self) -> usize {
///         1 // The greatest height so far, in m above the lowest that an arm reaches.
///     }
///     #[inline(always)]
///     fn step<S: Scalar>(&self, now: &Moment<'_, S>, memory: &mut [S], observation: &mut Vec<S>) -> Verdict<S> {
///         let height = now.fingertip[2] + S::lit(1.0);
///         let highest = height.max(memory[0]);
///         let gain = highest - memory[0];
///         memory[0] = highest;
///         observation.push(highest - height);
///         Verdict { failed: S::lit(0.1).lt(highest - height), ..Verdict::goes_on(gain) }
///     }
/// }
///
/// let task = myo_tasks::Task { time_limit_s: 3.0, ..myo_tasks::Task::without_script("climb") };
/// let model = myo_model::Model::new(&myo_model::builtin(&task.model)?)?;
/// let mut env = CpuEnv::with_rules(&model, &task, &Climb, &EnvConfig { num_envs: 16, ..Default::default() })?;
/// let mut out = StepStorage::new(env.spec());
/// env.step(&vec![0.0; 16 * env.spec().action_size()], out.buffers())?;
/// assert_eq!(env.spec().observation_names.last().unwrap(), "height_lost");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Rules: Clone + Debug + Send + Sync + 'static {
    /// Their name. Saved states know it, and what `Debug` prints: a state goes on only under rules that say the same.
    fn name(&self) -> &str;

    /// Names of the numbers that [`step`](Self::step) observes, in its order. They stand behind the parts of the observation that
    /// the task asks for.
    fn observed(&self) -> Vec<String>;

    /// How many numbers are remembered from one control step to the next; all are zero when an episode begins.
    fn remembered(&self) -> usize {
        0
    }

    /// Observes, judges and rewards: called when an episode begins (`now.time` is zero and the verdict does not count), then after
    /// every control step. `memory` has [`remembered`](Self::remembered) numbers; `observation` is empty, and as many are to be
    /// pushed as there are [names](Self::observed).
    ///
    /// It is written as all generic code here: no branch depends on a number ([`Scalar::select`], masks), a loop runs a fixed
    /// number of times, and `#[inline(always)]` stands before it and whatever it calls, else it is slow on lanes.
    fn step<S: Scalar>(&self, now: &Moment<'_, S>, memory: &mut [S], observation: &mut Vec<S>) -> Verdict<S>;
}

/// What rules see of an environment, of one per lane. Lengths in m from the shoulder centre, world axes: x forward, y to the left, z up.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a, S> {
    /// Positions of the independent joints (rad; m for slides), in the order of [`Skeleton::joint_names`](crate::Skeleton::joint_names), `(ndof)`.
    pub qpos: &'a [S],
    /// Their velocities (rad/s), `(ndof)`.
    pub qvel: &'a [S],
    /// Their accelerations in the last physics step (rad/s^2), `(ndof)`; zero when an episode begins.
    pub qacc: &'a [S],
    /// Activations of the muscles in [0, 1], in the order of the model, `(nmuscle)`.
    pub activation: &'a [S],
    /// Controls of the muscles in the last control step, noise included and no more than fatigue leaves, `(nmuscle)`; in [0, 1] without noise, zero when an episode begins.
    pub controls: &'a [S],
    /// The point that touches.
    pub fingertip: Point<S>,
    /// Its velocity (m/s).
    pub fingertip_velocity: Point<S>,
    /// The elbow; none where the model names no elbow and wrist in its landmarks.
    pub elbow: Option<Point<S>>,
    /// The wrist, likewise.
    pub wrist: Option<Point<S>>,
    /// The spheres of the scene, in its order, where they are now.
    pub spheres: &'a [Ball<S>],
    /// Time in the episode (s): zero when it begins, at most the limit.
    pub time: S,
    /// The time limit (s), where episodes are cut that are neither done nor failed.
    pub time_limit: S,
    /// Length of a control step (s).
    pub control_dt: f64,
}

/// A sphere of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Ball<S> {
    /// Its centre (m).
    pub centre: Point<S>,
    /// Its radius (m).
    pub radius: S,
}

/// What rules say of a control step.
#[derive(Clone, Copy, Debug)]
pub struct Verdict<S: Scalar> {
    /// Its reward.
    pub reward: S,
    /// Where the task is done: the episode ends, a success.
    pub done: S::Mask,
    /// Where it can no longer be done: the episode ends, no success whatever `done` says.
    pub failed: S::Mask,
}

impl<S: Scalar> Moment<'_, S> {
    /// Squared controls, mean over muscles: what the column `effort` of an episode is the mean of.
    #[inline(always)]
    pub fn effort(&self) -> S {
        let mut sum = S::zero();
        for &control in self.controls {
            sum = control.mul_add(control, sum);
        }
        sum * S::lit(1.0 / self.controls.len().max(1) as f64)
    }
}

impl<S: Scalar> Verdict<S> {
    /// This reward, and the episode goes on.
    #[inline(always)]
    pub fn goes_on(reward: S) -> Self {
        let never = S::Mask::splat(false);
        Self { reward, done: never, failed: never }
    }
}

/// Columns of an episode summary under [`Rules`], in place of those of a script.
pub const RULES_COLUMNS: [Column; 8] = [
    columns::RETURN,
    columns::LENGTH,
    Column::new("success", "", "1 if the rules ended the episode as done, else 0."),
    Column::new("failed", "", "1 if the rules ended it as failed, else 0; neither where the time was up."),
    columns::EFFORT,
    columns::FATIGUE,
    columns::SOLVER_ROUNDS,
    columns::SOLVER_UNSOLVED,
];

/// What tables keep of rules: enough for sizes and names, nothing that runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outline {
    /// See [`Rules::name`].
    pub name: String,
    /// All that they say, as `Debug` prints it.
    pub contents: String,
    /// See [`Rules::observed`].
    pub observed: Vec<String>,
    /// See [`Rules::remembered`].
    pub remembered: usize,
}

impl Outline {
    /// Of rules.
    pub fn of(rules: &impl Rules) -> Self {
        Self {
            name: rules.name().to_owned(),
            contents: format!("{rules:?}"),
            observed: rules.observed(),
            remembered: rules.remembered(),
        }
    }

    fn refuse<T>(&self, problem: String) -> Result<T, BuildError> {
        Err(BuildError::Rules { name: self.name.clone(), problem })
    }

    /// Refuses environments that begin in the middle of a task.
    pub fn check_config(&self, config: &EnvConfig) -> Result<(), BuildError> {
        match config.exploring {
            0 => Ok(()),
            n => self.refuse(format!(
                "know no middle of the task in which {n} environments could begin to explore; set `exploring` to 0, in the settings \
                 of a training `exploring_starts`"
            )),
        }
    }

    /// Refuses names that would not tell numbers apart.
    pub fn check_names(&self, spec: &EnvSpec) -> Result<(), BuildError> {
        let mut known = HashSet::new();
        for name in &spec.observation_names {
            if name.trim().is_empty() {
                return self.refuse("observe a number without a name; name each in `observed`".into());
            }
            if !known.insert(name) {
                return self.refuse(format!("observe `{name}`, a name that another number has; names must differ"));
            }
        }
        Ok(())
    }

    /// Refuses rules that observe another number of numbers than they name. They are tried once, in a body all of whose numbers are zero.
    pub fn check_count<C: Real>(&self, rules: &impl Rules, tables: &Tables<C>) -> Result<(), BuildError> {
        let (o, dofs, muscles) = ([0.0; 3], vec![0.0; tables.plan.ndof()], vec![0.0; tables.plan.nmuscle()]);
        let arm = tables.plan.arm.as_ref().map(|_| o);
        let spheres = vec![Ball { centre: o, radius: 0.0 }; tables.parameters.task.spheres.len()];
        let moment = Moment::<f64> {
            qpos: &dofs,
            qvel: &dofs,
            qacc: &dofs,
            activation: &muscles,
            controls: &muscles,
            fingertip: o,
            fingertip_velocity: o,
            elbow: arm,
            wrist: arm,
            spheres: &spheres,
            time: 0.0,
            time_limit: tables.control_dt() * tables.parameters.task.time_limit.to_f64(),
            control_dt: tables.control_dt(),
        };
        let mut observation = vec![];
        rules.step(&moment, &mut vec![0.0; self.remembered], &mut observation);
        match (observation.len(), self.observed.len()) {
            (pushed, named) if pushed == named => Ok(()),
            (pushed, named) => self.refuse(format!("observe {pushed} numbers and name {named} in `observed`")),
        }
    }
}
