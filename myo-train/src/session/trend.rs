//! How much better a user becomes by further training, and when that has come to an end.

use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::means::EpisodeMeans;

/// How a training does after so many steps is the mean over this last part of them.
pub(super) const WINDOW: f64 = 0.25;

/// Share of its time per episode by which four times the steps may still change it.
const TIME: f64 = 0.03;

/// Share of episodes by which they may change its success.
const SUCCESS: f64 = 0.01;

/// Share of all that its return has gained since the start by which they may change it.
const RETURN: f64 = 0.02;

/// By what factor improvement shrinks from one doubling to the next: as in the last two, within these limits. What is learned
/// quickly is learned first, so a smaller factor, which is often seen early, tells nothing of what comes.
const RATIO: (f64, f64) = (0.65, 0.8);

/// Share of itself that a return counts as having gained at least: where nothing is gained, rounding is no change.
const LEAST_GAIN: f64 = 1e-3;

/// The factor in forecasts of when a training ends.
const DECAY: f64 = 0.65;

/// Changes of what a user does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Of the duration of an episode, as a share of it: negative where it becomes shorter.
    pub episode_time: f64,
    /// Of the share of episodes that succeed.
    pub success: f64,
    /// Of the return of an episode, as a share of what it has gained since the start.
    #[serde(rename = "return")]
    pub episode_return: f64,
}

impl Change {
    /// The greatest one, in units of what counts as none.
    fn excess(self) -> f64 {
        let Self { episode_time, success, episode_return } = self;
        (episode_time / TIME).abs().max((success / SUCCESS).abs()).max((episode_return / RETURN).abs())
    }
}

/// Where a training leads: what its last doubling brought, and what is to be expected of four times its steps.
///
/// The first is the mean over the last quarter of its steps less that over the last quarter of their first half. The second is the
/// sum over two further doublings, each of which brings so much less than the one before as the last brought less than that
/// before it. Both are about the policy without its noise, or with it where too few environments act without. Steps are counted from
/// when all of what movements cost counted, as soon as enough is known of them: before, the user practised something else.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trend {
    /// Control steps that this is about.
    pub env_steps: u64,
    /// Those from which on they are counted.
    #[serde(default)]
    pub since: u64,
    /// What the last doubling brought.
    pub last_doubling: Change,
    /// What four times as many steps would bring in addition.
    pub four_times: Change,
}

impl Trend {
    /// After `steps` control steps, from how the training did after a quarter, half and all of those in them, and from the return at
    /// its start.
    pub(super) fn new(steps: Range<u64>, first_return: f64, did: [&EpisodeMeans; 3]) -> Self {
        let share = |change: f64, of: f64| if of > 0.0 { change / of } else { 0.0 };
        let [_, half, whole] = did;
        let changes = |change: fn([f64; 3]) -> f64, time: f64, gained: f64| Change {
            episode_time: share(change(did.map(|recent| recent.length)), time),
            success: change(did.map(|recent| recent.success)),
            episode_return: share(change(did.map(|recent| recent.episode_return)), gained),
        };
        let gained = (whole.episode_return - first_return).abs().max(LEAST_GAIN * whole.episode_return.abs());
        Self {
            env_steps: steps.end,
            since: steps.start,
            last_doubling: changes(|[_, half, whole]| whole - half, half.length, gained),
            four_times: changes(to_come, whole.length, gained),
        }
    }

    /// Whether nothing changes any more that is worth further training.
    pub fn is_plateau(&self) -> bool {
        self.four_times.excess() <= 1.0
    }

    /// The one that is farther from a plateau.
    pub(super) fn or_farther(self, other: Self) -> Self {
        if other.four_times.excess() > self.four_times.excess() { other } else { self }
    }

    /// Control steps that training may still take until a plateau.
    pub fn steps_left(&self) -> u64 {
        let doublings = (self.four_times.excess().max(1.0).ln() / -DECAY.ln()).min(32.0);
        ((self.env_steps - self.since) as f64 * (doublings.exp2() - 1.0)) as u64
    }
}

/// The change that two further doublings bring, where one quantity was so much after a quarter, half, and all steps.
fn to_come([quarter, half, whole]: [f64; 3]) -> f64 {
    let (before, last) = (half - quarter, whole - half);
    let (least, most) = RATIO;
    // What has just turned round may go on for long.
    let ratio = if before * last > 0.0 { (last / before).clamp(least, most) } else { most };
    last / lag(ratio) * (ratio + ratio * ratio)
}

/// How much more the last doubling changed means over windows than it changed what they are means of, where each doubling changes
/// that by `ratio` times what the one before did: the mean of such a power of the steps over a window, less its value at the end.
fn lag(ratio: f64) -> f64 {
    let power = 1.0 + ratio.log2();
    (1.0 - (1.0 - WINDOW).powf(power)) / (WINDOW * power)
}

impl fmt::Display for Trend {
    /// Half a sentence: what the last doubling of the training brought, and what more of it would.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let longer =
            |share: f64| format!("{:.1} % {}", 100.0 * share.abs(), if share > 0.0 { "longer" } else { "shorter" });
        write!(f, "the last doubling of training made episodes {}", longer(self.last_doubling.episode_time))?;
        let success = 100.0 * self.last_doubling.success;
        if success.abs() >= 0.05 {
            let more = if success > 0.0 { "more" } else { "less" };
            write!(f, " and {:.1} % {more} of them succeed", success.abs())?;
        }
        write!(f, "; four times as much would make them about {}", longer(self.four_times.episode_time))
    }
}
