//! Users at work, recorded at every physics step.

use myo_env::{CpuEnv, EnvConfig, EnvSpec, Skeleton, Snapshot, StepStorage, TraceShape, VectorEnv};
use myo_model::Model;
use myo_tasks::{Object, Task};
use myo_train::Policy;

use super::ProtocolError;

/// An episode from its start to its end.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Samples per second.
    pub rate_hz: f64,
    /// Where the fingertip was (m from the shoulder centre).
    pub fingertip: Vec<[f64; 3]>,
    /// Sum of all forces on it (N).
    pub force: Vec<f64>,
    /// Positions of the independent joints (rad; m for slides), (samples, joints).
    pub qpos: Vec<f32>,
    /// Velocities of the independent joints (rad/s; m/s for slides), (samples, joints).
    pub qvel: Vec<f32>,
    /// Activations, (samples, muscles).
    pub activations: Vec<f32>,
    /// Steps of the script that were done, in order.
    pub done: Vec<Done>,
    /// How often a way was left that was to be steered along.
    pub exits: f64,
    /// How often something was pressed that was not asked for.
    pub wrong_presses: f64,
    /// What was asked for and where it was; none in scenes where nothing moves.
    pub targets: Option<Targets>,
}

/// What was asked for at the beginning of each control step, and where it was.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Targets {
    /// Samples of a control step.
    pub samples: usize,
    /// Number of the step of the script.
    pub step: Vec<usize>,
    /// Centre of its object (m from the shoulder centre).
    pub centre: Vec<[f64; 3]>,
}

impl Targets {
    /// Where it was at every sample: within a control step it goes straight.
    pub fn path(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let ends = self.centre.iter().skip(1).chain(self.centre.last());
        self.centre.iter().zip(ends).flat_map(move |(begin, end)| {
            (0..self.samples).map(move |sample| {
                let share = sample as f64 / self.samples as f64;
                [0, 1, 2].map(|k| begin[k] + share * (end[k] - begin[k]))
            })
        })
    }
}

/// A step of the script that was done, in samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// The end of the step before, or the start of the episode.
    pub begin: usize,
    /// The last entry into the target.
    pub entry: usize,
    /// The end of the dwell.
    pub end: usize,
}

impl Recording {
    fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            fingertip: vec![],
            force: vec![],
            qpos: vec![],
            qvel: vec![],
            activations: vec![],
            done: vec![],
            exits: 0.0,
            wrong_presses: 0.0,
            targets: None,
        }
    }

    /// Where what is asked for is as a control step of so many samples begins.
    fn look(&mut self, skeleton: &Skeleton, before: &Snapshot, samples: usize) -> Result<(), ProtocolError> {
        let pose = skeleton.pose(before)?;
        let targets = self.targets.get_or_insert(Targets { samples, ..Targets::default() });
        if let (Some(step), Some(object)) = (pose.step, pose.current) {
            targets.step.push(step);
            targets.centre.push(pose.objects[object].frame.position.array());
        }
        Ok(())
    }

    fn add(&mut self, shape: &TraceShape, rows: &[f32]) {
        for sample in rows.chunks_exact(shape.columns).filter_map(|row| shape.sample(row)) {
            self.fingertip.push(sample.fingertip);
            self.force.push(sample.force);
            self.qpos.extend_from_slice(sample.qpos);
            self.qvel.extend_from_slice(sample.qvel);
            self.activations.extend_from_slice(sample.activations);
        }
    }

    /// Takes in the summary of the episode.
    fn end(&mut self, spec: &EnvSpec, summary: &[f32]) {
        self.done = Done::of(spec, summary, (self.rate_hz, self.fingertip.len()));
        let count = |name: &str| {
            let column = spec.episode_names.iter().position(|other| other == name);
            column.and_then(|column| summary.get(column)).map_or(0.0, |&count| f64::from(count))
        };
        (self.exits, self.wrong_presses) = (count("exits"), count("wrong_presses"));
    }
}

impl Done {
    /// Whether a step, counted from zero, was done, by the summary of an episode.
    pub(crate) fn is_done(spec: &EnvSpec, summary: &[f32], step: usize) -> bool {
        let name = format!("target_{}_success", step + 1);
        let column = spec.episode_names.iter().position(|other| *other == name);
        column.and_then(|column| summary.get(column)).is_some_and(|&success| success > 0.5)
    }

    /// How many samples there were from the last entry into the target of a step, counted from zero, to its end, by the summary of an episode.
    pub(crate) fn after_entry(spec: &EnvSpec, summary: &[f32], step: usize, rate_hz: f64) -> Option<usize> {
        let value = |quantity: &str| {
            let name = format!("target_{}_{quantity}", step + 1);
            let column = spec.episode_names.iter().position(|other| *other == name)?;
            Some(f64::from(*summary.get(column)?)).filter(|value| value.is_finite())
        };
        Some(((value("time")? - value("movement_time")?) * rate_hz).round() as usize)
    }

    /// What was done in an episode of so many samples at a rate (Hz), by its summary.
    pub(crate) fn of(spec: &EnvSpec, summary: &[f32], (rate_hz, length): (f64, usize)) -> Vec<Self> {
        let value = |name: String| {
            let column = spec.episode_names.iter().position(|other| *other == name)?;
            Some(f64::from(*summary.get(column)?)).filter(|value| value.is_finite())
        };
        let samples = |seconds: f64| (seconds * rate_hz).round() as usize;
        let (mut all, mut begin) = (vec![], 0);
        for target in 1.. {
            let time = value(format!("target_{target}_time"));
            let (Some(time), Some(movement)) = (time, value(format!("target_{target}_movement_time"))) else { break };
            let done = Self { begin, entry: begin + samples(movement), end: begin + samples(time) };
            if done.end > length {
                break;
            }
            all.push(done);
            begin = done.end;
        }
        all
    }
}

/// What shows where objects are, of each layout; none where nothing moves.
fn moving(model: &Model, layouts: &[Task]) -> Result<Option<Vec<Skeleton>>, ProtocolError> {
    let skeletons = layouts.iter().map(|task| Skeleton::new(model, task)).collect::<Result<Vec<_>, _>>()?;
    let moves = |object: &Object| object.sphere().is_some_and(|sphere| sphere.path.is_some());
    let any = skeletons.iter().any(|skeleton| skeleton.task().objects.iter().any(moves));
    Ok(any.then_some(skeletons))
}

/// The first episodes of `repeats` environments for each layout, acted in with the means of the policy, the task's noise on; in the
/// order of the layouts.
///
/// # Errors
/// The policy does not fit the layouts, or these cannot be simulated.
pub fn record(
    policy: &mut Policy,
    model: &Model,
    layouts: &[Task],
    (repeats, seed): (usize, u64),
) -> Result<Vec<Vec<Recording>>, ProtocolError> {
    let num_envs = repeats * layouts.len();
    let mut env = CpuEnv::with_layouts(model, layouts, &EnvConfig { num_envs, seed, ..EnvConfig::default() })?;
    let (spec, shape) = (env.spec().clone(), env.trace_shape());
    policy.check(&spec)?;
    let (mut step, mut actions) = (StepStorage::new(&spec), vec![0.0; num_envs * spec.action_size()]);
    let mut trace = vec![0.0; num_envs * shape.len_per_env()];
    let mut recordings = vec![Recording::new(shape.rate_hz); num_envs];
    let mut going: Vec<bool> = vec![true; num_envs];
    let skeletons = moving(model, layouts)?;
    env.reset(Some(seed), None, &mut step.observation)?;
    while going.contains(&true) {
        policy.act_deterministic(&step.observation, &mut actions);
        if let Some(skeletons) = &skeletons {
            for (number, before) in env.peek(0..num_envs)?.iter().enumerate().filter(|&(number, _)| going[number]) {
                recordings[number].look(&skeletons[number % layouts.len()], before, shape.samples)?;
            }
        }
        env.step_traced(&actions, step.buffers(), &mut trace)?;
        for number in (0..num_envs).filter(|&number| going[number]) {
            recordings[number].add(&shape, &trace[number * shape.len_per_env()..][..shape.len_per_env()]);
        }
        for number in 0..num_envs {
            if going[number] && (step.terminated[number] || step.truncated[number]) {
                let summary = &step.episode[number * spec.episode_size()..][..spec.episode_size()];
                recordings[number].end(&spec, summary);
                going[number] = false;
            }
        }
    }
    let mut by_layout: Vec<Vec<Recording>> = vec![vec![]; layouts.len()];
    for (number, recording) in recordings.into_iter().enumerate() {
        by_layout[number % layouts.len()].push(recording);
    }
    Ok(by_layout)
}
