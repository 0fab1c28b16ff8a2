//! Users at work, recorded at every physics step.

use myo_env::{CpuEnv, EnvConfig, EnvSpec, StepStorage, TraceSample, VectorEnv};
use myo_model::Model;
use myo_tasks::Task;
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
    /// Activations, (samples, muscles).
    pub activations: Vec<f32>,
    /// Steps of the script that were done, in order.
    pub done: Vec<Done>,
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
        Self { rate_hz, fingertip: vec![], force: vec![], activations: vec![], done: vec![] }
    }

    fn add(&mut self, rows: std::slice::ChunksExact<'_, f32>) {
        for sample in rows.filter_map(TraceSample::of) {
            self.fingertip.push(sample.fingertip);
            self.force.push(sample.force);
            self.activations.extend_from_slice(sample.activations);
        }
    }

    /// Takes in the summary of the episode.
    fn end(&mut self, spec: &EnvSpec, summary: &[f32]) {
        let value = |name: String| {
            let column = spec.episode_names.iter().position(|other| *other == name)?;
            Some(f64::from(*summary.get(column)?)).filter(|value| value.is_finite())
        };
        let samples = |seconds: f64| (seconds * self.rate_hz).round() as usize;
        let mut begin = 0;
        for target in 1.. {
            let time = value(format!("target_{target}_time"));
            let (Some(time), Some(movement)) = (time, value(format!("target_{target}_movement_time"))) else { break };
            let done = Done { begin, entry: begin + samples(movement), end: begin + samples(time) };
            if done.end > self.fingertip.len() {
                break;
            }
            self.done.push(done);
            begin = done.end;
        }
    }
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
    env.reset(Some(seed), None, &mut step.observation)?;
    while going.contains(&true) {
        policy.act_deterministic(&step.observation, &mut actions);
        env.step_traced(&actions, step.buffers(), &mut trace)?;
        for number in (0..num_envs).filter(|&number| going[number]) {
            let rows = trace[number * shape.len_per_env()..][..shape.len_per_env()].chunks_exact(shape.columns);
            recordings[number].add(rows);
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
