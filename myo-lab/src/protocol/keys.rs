//! Protocol T1: how hard, how long and how fast a user presses keys.

use myo_measure::bands::{Figure, Figures};
use myo_measure::statistics;
use myo_measure::taps::{Contact, Press, Taps};
use serde::Serialize;

use super::ProtocolError;
use super::pointing::set_all;
use super::practice::PRESSES;
use super::recording::Recording;

/// Fewest presses that figures are taken from.
const LEAST_PRESSES: usize = 20;

/// Presses of keys of 6 by 9 mm in random orders, and of one key as fast as possible. Medians over presses and over users.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeyPresses {
    /// How many users.
    pub users: usize,
    /// Presses of keys in random orders, of all users.
    pub presses: usize,
    /// Peak force of a press (N).
    pub peak_force_n: f64,
    /// From 0.3 N on to below 0.1 N (s).
    pub contact_time_s: f64,
    /// Force times time of a press (N s).
    pub impulse_n_s: f64,
    /// From a press to the next (s).
    pub interval_s: f64,
    /// Presses of one key per second.
    pub rate_hz: f64,
}

impl KeyPresses {
    /// Of one user or more, each with its recordings of keys and of tapping.
    ///
    /// # Errors
    /// Too few presses.
    pub fn of(users: &[(Vec<Recording>, Vec<Recording>)]) -> Result<Self, ProtocolError> {
        let users = users
            .iter()
            .map(|(keys, tapping)| Ok((pressed("keys", keys)?, pressed("the same key again and again", tapping)?)))
            .collect::<Result<Vec<_>, ProtocolError>>()?;
        let press = |of: fn(&Press) -> f64| {
            over(&users, |(keys, _)| middle(keys.iter().flat_map(|taps| &taps.presses).map(of)))
        };
        let interval = |taps: &[Taps]| middle(taps.iter().flat_map(|taps| taps.intervals_s.iter().copied()));
        Ok(Self {
            users: users.len(),
            presses: users.iter().flat_map(|(keys, _)| keys).map(|taps| taps.presses.len()).sum(),
            peak_force_n: press(|press| press.peak)?,
            contact_time_s: press(|press| press.contact_time_s)?,
            impulse_n_s: press(|press| press.impulse)?,
            interval_s: over(&users, |(keys, _)| interval(keys))?,
            rate_hz: over(&users, |(_, tapping)| Ok(interval(tapping)?.recip()))?,
        })
    }

    /// What of it people's bands are about.
    pub fn figures(&self, figures: &mut Figures) -> Result<(), ProtocolError> {
        let all = [
            (Figure::TapPeakForce, self.peak_force_n),
            (Figure::TapContactTime, self.contact_time_s),
            (Figure::TapRate, self.rate_hz),
        ];
        set_all(figures, all)
    }
}

/// The presses of each recording.
fn pressed(what: &str, recordings: &[Recording]) -> Result<Vec<Taps>, ProtocolError> {
    let taps = |recording: &Recording| {
        Taps::of(&recording.force, recording.rate_hz, Contact::default()).map_err(ProtocolError::measuring("presses"))
    };
    let taps = recordings.iter().map(taps).collect::<Result<Vec<_>, _>>()?;
    let found = taps.iter().map(|taps| taps.presses.len()).sum();
    if found < LEAST_PRESSES {
        let what = format!("presses of {what}");
        return Err(ProtocolError::TooFew { what, found, asked: PRESSES * recordings.len(), least: LEAST_PRESSES });
    }
    Ok(taps)
}

fn middle(values: impl Iterator<Item = f64>) -> Result<f64, ProtocolError> {
    statistics::median(&values.collect::<Vec<_>>()).map_err(ProtocolError::measuring("presses"))
}

fn over<T>(users: &[T], of: impl Fn(&T) -> Result<f64, ProtocolError>) -> Result<f64, ProtocolError> {
    middle(users.iter().map(of).collect::<Result<Vec<_>, _>>()?.into_iter())
}
