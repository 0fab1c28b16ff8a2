//! What a session remembers from one update to the next.

use serde::{Deserialize, Serialize};

use super::curve::Curve;
use super::looks::Looks;
use super::trend::Trend;
use crate::{Evaluation, Trainer, UpdateMetrics};

/// What the next decisions of a session depend on besides its trainer and the state to go back to; part of a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Memory {
    /// When to look at the goal.
    pub looks: Looks,
    /// How success grew.
    pub curve: Curve,
    /// How the policy without its noise did.
    #[serde(default)]
    pub noise_free: Curve,
    /// Evaluations taken: the next one has other episodes.
    pub evaluations: u64,
    /// How often the training went back to its good state.
    pub tries: u32,
    /// Whether it was told that nothing improves.
    pub told_flat: bool,
    /// Seconds spent on evaluations.
    pub evaluation_s: f64,
    /// The newest evaluation that confirmed a goal.
    pub confirmed: Option<Evaluation>,
}

impl Memory {
    /// Nothing seen yet of a training that is about to go on from where it is.
    pub fn new(trainer: &Trainer) -> Self {
        Self {
            looks: Looks::new(trainer.env_steps()),
            curve: Curve::new(first_whole_episodes(trainer)),
            noise_free: Curve::new(first_whole_episodes(trainer)),
            evaluations: 0,
            tries: 0,
            told_flat: false,
            evaluation_s: 0.0,
            confirmed: None,
        }
    }

    /// Control steps that training may still take until success is `until`, judged by the learning curve.
    pub fn steps_to(&self, until: f64) -> Option<u64> {
        self.curve.steps_to(self.looks.threshold(until))
    }

    /// Hears of a look at the policy after `env_steps`, how many control steps a quick one takes at most, and what it found.
    pub fn looked(&mut self, env_steps: u64, cost: u64, taken: &[Evaluation]) {
        self.evaluations += taken.len() as u64;
        let found = taken.last().and_then(|evaluation| evaluation.success);
        self.looks.looked(env_steps, cost, found, self.curve.recent().map(|recent| recent.success));
    }

    /// Hears of an update.
    pub fn hear(&mut self, metrics: &UpdateMetrics) {
        self.curve.hear(metrics.env_steps, &metrics.episodes);
        self.noise_free.hear(metrics.env_steps, &metrics.noise_free);
    }

    /// What the last doubling brought and more would, if that can be told: of the policy without its noise, as it will be
    /// evaluated, or of training episodes where too few act without.
    pub fn trend(&self) -> Option<Trend> {
        self.noise_free.trend().or_else(|| self.curve.trend())
    }

    /// Forgets what came after `env_steps`.
    pub fn go_back(&mut self, env_steps: u64) {
        self.curve.cut(env_steps);
        self.noise_free.cut(env_steps);
        self.looks.gone_back(env_steps);
    }
}

/// Control steps after which every environment has ended an episode.
fn first_whole_episodes(trainer: &Trainer) -> u64 {
    let spec = trainer.spec();
    trainer.env_steps() + (spec.num_envs * spec.max_episode_steps) as u64
}
