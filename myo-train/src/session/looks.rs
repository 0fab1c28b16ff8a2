//! When to look whether the goal is reached.

use serde::{Deserialize, Serialize};

/// Training success lags behind: the policy that collects acts at random around its mean. The first look is worth its
/// time when that success comes this near to the goal.
const NEAR: f64 = 0.2;

/// Least distance to the goal that counts as near.
const CLOSE: f64 = 0.01;

/// Control steps of training for each control step of evaluation at least, so that looking costs little.
const STEPS_PER_LOOK: u64 = 4;

/// Simulated seconds after which a look is taken in any case: some policies act well only without their noise.
const LONGEST_WAIT_S: f64 = 200_000.0;

/// Decides by steps, not by the clock, so that a seed stops at the same update on every machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Looks {
    /// By how much mean actions were better than those of training when last looked at.
    lead: f64,
    last_look: u64,
    wait: u64,
}

impl Looks {
    /// Nothing seen yet; training goes on from `env_steps`.
    pub fn new(env_steps: u64) -> Self {
        Self { lead: NEAR, last_look: env_steps, wait: 0 }
    }

    /// The success of training from which on a goal of `until` may be reached.
    pub fn threshold(&self, until: f64) -> f64 {
        until - self.lead
    }

    /// Whether to look now if the goal is `until`, after control steps of `control_dt` seconds; `recent` is the mean success of recent training episodes.
    ///
    /// It is not once a look was taken, so that a look that was cut off can be told from one that was not.
    pub fn is_due(&self, until: f64, env_steps: u64, control_dt: f64, recent: Option<f64>) -> bool {
        let waited = env_steps.saturating_sub(self.last_look);
        let near = recent.is_some_and(|success| success >= self.threshold(until));
        waited >= if near { self.wait } else { (LONGEST_WAIT_S / control_dt) as u64 }
    }

    /// Hears that a look was taken, how many control steps a quick one takes at most, and what it found.
    pub fn looked(&mut self, env_steps: u64, cost: u64, found: Option<f64>, recent: Option<f64>) {
        self.last_look = env_steps;
        self.wait = STEPS_PER_LOOK * cost.max(1);
        if let (Some(found), Some(recent)) = (found, recent) {
            self.lead = (found - recent).clamp(CLOSE, NEAR);
        }
    }

    /// Hears that training went back to an earlier state.
    pub fn gone_back(&mut self, env_steps: u64) {
        self.last_look = self.last_look.min(env_steps);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due(looks: &Looks, env_steps: u64, recent: f64) -> bool {
        looks.is_due(0.95, env_steps, 0.05, Some(recent))
    }

    #[test]
    fn looks_begin_near_the_goal_and_wait_for_what_the_last_one_lacked() {
        let mut looks = Looks::new(0);
        assert!(!due(&looks, 1_000_000, 0.7) && due(&looks, 1_000_000, 0.76));
        // Mean actions were better by 5 %, so training must come up to 90 %.
        looks.looked(1_000_000, 50_000, Some(0.85), Some(0.8));
        assert!(!due(&looks, 1_100_000, 0.95), "too soon");
        assert!(!due(&looks, 1_200_000, 0.89) && due(&looks, 1_200_000, 0.905));
        assert!(due(&looks, 5_000_000, 0.0), "a look in any case");
        looks.gone_back(500_000);
        assert!(due(&looks, 700_000, 0.905));
    }
}
