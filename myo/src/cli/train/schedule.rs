//! When to look whether the goal is reached.

use myo::train::UpdateMetrics;

/// Training success lags behind: the policy that collects acts at random around its mean. A look is worth its time when
/// that success comes this near to the goal.
const NEAR: f64 = 0.2;

/// Episodes over which training success is averaged.
const MEMORY: f64 = 500.0;

/// Control steps of training for each control step of evaluation at least, so that looking costs little.
const STEPS_PER_LOOK: u64 = 8;

/// Control steps after which a look is taken in any case: some policies act well only without their noise.
const LONGEST_WAIT: u64 = 4_000_000;

/// Decides by steps, not by the clock, so that a seed stops at the same update on every machine.
#[derive(Clone, Debug)]
pub struct Schedule {
    until: f64,
    /// Mean success of recent training episodes.
    recent: Option<f64>,
    last_look: u64,
    wait: u64,
}

impl Schedule {
    /// Nothing seen yet; training goes on from `env_steps`.
    pub fn new(until: f64, env_steps: u64) -> Self {
        Self { until, recent: None, last_look: env_steps, wait: 0 }
    }

    /// Hears of an update; whether to look now.
    pub fn is_due(&mut self, metrics: &UpdateMetrics) -> bool {
        if let Some(success) = metrics.episode_mean("success") {
            let weight = 1.0 - (-(metrics.episodes as f64) / MEMORY).exp();
            let before = self.recent.unwrap_or(success);
            self.recent = Some(before + weight * (success - before));
        }
        let waited = metrics.env_steps - self.last_look;
        let near = self.recent.is_some_and(|success| success >= self.until - NEAR);
        waited >= if near { self.wait } else { LONGEST_WAIT }
    }

    /// Hears that a look was taken and how many control steps it took.
    pub fn looked(&mut self, env_steps: u64, cost: u64) {
        self.last_look = env_steps;
        self.wait = STEPS_PER_LOOK * cost;
    }

    /// Mean success of recent training episodes, if any has ended.
    pub fn recent_success(&self) -> Option<f64> {
        self.recent
    }
}
