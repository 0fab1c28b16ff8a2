//! How much better a user becomes per doubling of its training, and when that has come to an end.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Share of its time per episode by which a user may still become faster per doubling.
const TIME: f64 = 0.03;

/// Share of episodes by which its success may still grow.
const SUCCESS: f64 = 0.01;

/// Share of all that its return has gained since the start by which it may still grow.
const RETURN: f64 = 0.01;

/// By what factor improvement shrinks from one doubling to the next, at worst; for forecasts. Of the trainings looked at it
/// was 0.5 to 0.65.
const DECAY: f64 = 0.65;

/// What the last doubling of a training brought: the mean over its second half less that over the quarter before, of training
/// episodes, which act with noise.
///
/// Where every doubling brings at most two thirds of the one before, four times as many steps bring less than what is told
/// here: `(1 + r) r^1.5` of it, for a factor `r` from one doubling to the next.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trend {
    /// Control steps that this is about.
    pub env_steps: u64,
    /// Change of the duration of an episode, as a share of it: negative where it becomes shorter.
    pub episode_time: f64,
    /// Change of the share of episodes that succeed.
    pub success: f64,
    /// Change of the return of an episode, as a share of what it has gained since the start.
    #[serde(rename = "return")]
    pub episode_return: f64,
}

impl Trend {
    /// Whether nothing improves any more that is worth further training.
    pub fn is_plateau(&self) -> bool {
        self.excess() <= 1.0
    }

    /// The greatest improvement, in units of what still counts as none.
    fn excess(&self) -> f64 {
        (-self.episode_time / TIME).max(self.success / SUCCESS).max(self.episode_return / RETURN)
    }

    /// Control steps that training may still take until a plateau.
    pub fn steps_left(&self) -> u64 {
        let doublings = (self.excess().max(1.0).ln() / -DECAY.ln()).min(32.0);
        (self.env_steps as f64 * (doublings.exp2() - 1.0)) as u64
    }
}

impl fmt::Display for Trend {
    /// Half a sentence: what the last doubling of the training brought.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (time, success) = (100.0 * self.episode_time, 100.0 * self.success);
        let longer = if time > 0.0 { "longer" } else { "shorter" };
        write!(f, "the last doubling of training made episodes {:.1} % {longer}", time.abs())?;
        if success.abs() >= 0.05 {
            let more = if success > 0.0 { "more" } else { "less" };
            write!(f, " and {:.1} % {more} of them succeed", success.abs())?;
        }
        Ok(())
    }
}
