//! What F1, K1 and K2 share: users who pointed, and figures over several of them.

use myo_measure::bands::{Figure, Figures};
use myo_measure::fitts::Condition;
use myo_measure::{Movement, Spread, statistics};
use serde::{Deserialize, Serialize};

use super::ProtocolError;
use super::practice::{SELECTIONS, conditions};
use super::reach::Reach;

/// Least share of selections of a condition that must be made.
const LEAST_SHARE: f64 = 0.5;
/// The distance (m) at which speeds and times are told.
pub(super) const USUAL_DISTANCE: f64 = 0.3;

/// A figure of several users.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OverUsers {
    /// The middle one.
    pub median: f64,
    /// 95 % confidence interval of the mean; null with one user.
    pub interval: Option<[f64; 2]>,
}

impl From<Spread> for OverUsers {
    fn from(spread: Spread) -> Self {
        Self { median: spread.median, interval: spread.interval }
    }
}

impl OverUsers {
    pub(crate) fn of(values: &[f64], what: &str) -> Result<Self, ProtocolError> {
        Ok(Spread::of(values).map_err(ProtocolError::measuring(what))?.into())
    }
}

/// Reaches of one user, for so many episodes of each condition.
pub struct UserReaches {
    /// All of them.
    pub reaches: Vec<Reach>,
    /// Episodes of each condition.
    pub repeats: usize,
}

impl UserReaches {
    /// Those from target to target.
    pub(super) fn between(&self) -> impl Iterator<Item = &Reach> {
        self.reaches.iter().filter(|reach| reach.selection > 0)
    }

    pub(super) fn of_condition(&self, condition: usize) -> Result<Condition, ProtocolError> {
        let [distance, width] = conditions()[condition];
        // A fingertip that was there already did not move.
        let has_moved = |reach: &&Reach| reach.condition == condition && reach.trial.movement_time_s > 0.0;
        let trials: Vec<_> = self.between().filter(has_moved).map(|reach| reach.trial).collect();
        let asked = self.asked();
        let least = (LEAST_SHARE * asked as f64).ceil() as usize;
        if trials.len() < least {
            let what = format!("targets of {:.0} mm at {:.0} mm", 1e3 * width, 1e3 * distance);
            return Err(ProtocolError::TooFew { what, found: trials.len(), asked, least });
        }
        Ok(Condition { distance, width, trials })
    }

    pub(super) fn missed(&self, condition: usize) -> f64 {
        let made = self.between().filter(|reach| reach.condition == condition).count();
        1.0 - made as f64 / self.asked() as f64
    }

    /// Selections of a condition that were asked for, the first ones aside.
    fn asked(&self) -> usize {
        self.repeats * (SELECTIONS - 1)
    }

    /// Distance, width and movement of each reach from target to target.
    pub(super) fn movements(&self) -> impl Iterator<Item = ([f64; 2], &Movement)> {
        self.between().filter_map(|reach| Some((conditions()[reach.condition], reach.movement.as_ref()?)))
    }
}

/// Sets figures.
pub(super) fn set_all(
    figures: &mut Figures,
    values: impl IntoIterator<Item = (Figure, f64)>,
) -> Result<(), ProtocolError> {
    for (figure, value) in values {
        figures.set(figure, value).map_err(ProtocolError::measuring(format!("{figure:?}")))?;
    }
    Ok(())
}

/// Change of the second numbers per unit of the first.
pub(super) fn slope(points: impl Iterator<Item = (f64, f64)>) -> Result<f64, ProtocolError> {
    let (x, y): (Vec<f64>, Vec<f64>) = points.unzip();
    statistics::slope(&x, &y).map_err(ProtocolError::measuring("a change per bit"))
}
