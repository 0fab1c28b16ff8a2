//! What pages are told of a training while it runs.

use std::time::{Duration, Instant};

use myo_lab::Device;
use myo_lab::progress::{Rate, time_left};
use myo_train::session::Progress;

use super::training::Training;
use crate::protocol::{Before, Bottleneck, Doubling, JobProgress};

/// Pages hear of a training at most so often.
const TELL_EVERY: Duration = Duration::from_millis(100);

/// What is told of a training from one update to the next.
pub struct Following {
    limit: u64,
    control_dt_s: f64,
    steps: usize,
    device: String,
    environments: usize,
    rate: Rate,
    told: Option<Instant>,
    /// How the user did this task before it learned it.
    pub before: Option<Before>,
    /// What the last doubling of its practice brought.
    pub doubling: Option<Doubling>,
}

impl Following {
    /// Before the first update.
    pub fn new(training: &Training) -> Self {
        let (session, task) = (&training.session, &training.task);
        Self {
            limit: session.goal().steps,
            control_dt_s: task.control_dt_s,
            steps: task.flat().map_or(0, |flat| flat.steps.len()),
            device: device(&training.device),
            environments: session.trainer().spec().num_envs,
            rate: Rate::default(),
            told: None,
            before: None,
            doubling: None,
        }
    }

    /// What pages are told before the first update.
    pub fn at_first(&self) -> JobProgress {
        let (device, environments) = (self.device.clone(), self.environments);
        JobProgress { limit: self.limit, before: self.before.clone(), device, environments, ..JobProgress::default() }
    }

    /// What pages are told after an update, if it is time to.
    pub fn after(&mut self, progress: &Progress) -> Option<JobProgress> {
        let metrics = progress.metrics.as_ref()?;
        self.rate.after(metrics.steps_per_s());
        if self.told.is_some_and(|told| told.elapsed() < TELL_EVERY) {
            return None;
        }
        self.told = Some(Instant::now());
        self.last(progress)
    }

    /// The same whenever it is.
    pub fn last(&self, progress: &Progress) -> Option<JobProgress> {
        let metrics = progress.metrics.as_ref()?;
        let rate = self.rate.get()?;
        let mean = |name: &str| metrics.episodes.mean(name);
        let seconds = |steps: u64| steps as f64 / rate;
        Some(JobProgress {
            env_steps: metrics.env_steps,
            limit: self.limit,
            wall_s: metrics.wall_s,
            rate,
            success: progress.success,
            episode_s: mean("length").map(|steps| steps * self.control_dt_s),
            effort: mean("effort"),
            step_success: (1..=self.steps).filter_map(|k| mean(&format!("target_{k}_success"))).collect(),
            left: time_left(progress.steps_left.map(seconds), seconds(self.limit.saturating_sub(metrics.env_steps))),
            bottleneck: progress
                .bottleneck
                .map(|bottleneck| Bottleneck { step: bottleneck.target, success: bottleneck.success }),
            before: self.before.clone(),
            doubling: self.doubling.clone(),
            device: self.device.clone(),
            environments: self.environments,
        })
    }
}

fn device(device: &Device) -> String {
    device.card().map_or_else(|| format!("cpu ({} threads)", rayon::current_num_threads()), str::to_owned)
}
