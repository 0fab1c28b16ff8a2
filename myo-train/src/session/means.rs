//! What training episodes came to on average.

use serde::{Deserialize, Serialize};

use crate::Episodes;

/// A target counts once this share of episodes gets to it.
const HARDLY_ANY: f64 = 0.02;

/// Targets whose success differs by less are alike.
const TIE: f64 = 0.02;

/// Means over some training episodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EpisodeMeans {
    /// Share that succeeded.
    pub success: f64,
    /// Targets done.
    pub targets_done: f64,
    /// Distance to the last target at the end, in metres.
    pub final_distance: f64,
    /// Control steps of an episode.
    pub length: f64,
    /// Sum of its rewards.
    #[serde(rename = "return")]
    pub episode_return: f64,
    /// Share of episodes in which each target was done.
    pub target_success: Vec<f64>,
}

/// The target at which a training makes least headway.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bottleneck {
    /// Index of the target, from 0.
    pub target: usize,
    /// Share of the episodes that get to it in which it is done.
    pub success: f64,
}

impl EpisodeMeans {
    /// Of some episodes; none if there are none. All numbers are finite.
    pub(super) fn of(episodes: &Episodes) -> Option<Self> {
        let mean = |name: &str| episodes.mean(name).filter(|mean| mean.is_finite());
        Some(Self {
            success: mean("success")?,
            targets_done: mean("targets_done").unwrap_or(0.0),
            final_distance: mean("final_distance").unwrap_or(0.0),
            length: mean("length").unwrap_or(0.0),
            episode_return: mean("return").unwrap_or(0.0),
            target_success: (1..).map_while(|k| mean(&format!("target_{k}_success"))).collect(),
        })
    }

    /// The earliest of the targets that the fewest of the episodes that get to them do; none before an episode has ended,
    /// or where all is done. Targets that hardly any episode gets to do not count.
    pub fn bottleneck(&self) -> Option<Bottleneck> {
        let before = [1.0].into_iter().chain(self.target_success.iter().copied());
        let reached = before.zip(&self.target_success).enumerate().filter(|(_, (before, _))| *before >= HARDLY_ANY);
        let shares = reached.map(|(target, (before, after))| Bottleneck { target, success: after / before });
        let least = |least: Bottleneck, next: Bottleneck| if next.success < least.success - TIE { next } else { least };
        shares.reduce(least).filter(|bottleneck| bottleneck.success < 1.0)
    }

    fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let Self { success, targets_done, final_distance, length, episode_return, target_success } = self;
        [success, targets_done, final_distance, length, episode_return].into_iter().chain(target_success)
    }

    /// Moves towards newer episodes.
    pub(super) fn follow(&mut self, mut newer: Self, weight: f64) {
        self.numbers().zip(newer.numbers()).for_each(|(x, y)| *x += weight * (*y - *x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bottleneck_is_the_earliest_target_that_fails_most_of_those_who_get_there() {
        let bottleneck = |target_success: &[f64]| {
            let target_success = target_success.to_vec();
            EpisodeMeans {
                success: 0.0,
                targets_done: 0.0,
                final_distance: 0.0,
                length: 0.0,
                episode_return: 0.0,
                target_success,
            }
            .bottleneck()
        };
        let at = |target, success| Some(Bottleneck { target, success });
        assert_eq!(bottleneck(&[0.5, 0.1]), at(1, 0.2), "fewer fail there, but of fewer");
        assert_eq!(bottleneck(&[0.5, 0.25, 0.125]), at(0, 0.5), "the earliest of equals");
        assert_eq!(bottleneck(&[0.25, 0.2475, 0.125]), at(0, 0.25));
        assert_eq!(bottleneck(&[0.004, 0.0]), at(0, 0.004), "what nobody gets to is not to blame");
        assert_eq!(bottleneck(&[1.0, 1.0]), None);
        assert_eq!(bottleneck(&[]), None);
    }
}
