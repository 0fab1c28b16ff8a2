//! Protocol K4: how the speed along an ellipse goes with its curvature.

use myo_measure::power_law::PowerLaw;
use myo_measure::signal;
use serde::Serialize;

use super::ProtocolError;
use super::pointing::OverUsers;
use super::practice::{BEFORE_WAY, LAP_PIECES, LAPS};
use super::reach::CUT_OFF_HZ;
use super::recording::Recording;

/// Fewest episodes of a user that figures are taken from.
const LEAST: usize = 2;
/// The last step of the first lap, which begins at rest and is left out, and of the last one.
const FIRST: usize = BEFORE_WAY + LAP_PIECES - 1;
const LAST: usize = BEFORE_WAY + LAPS * LAP_PIECES - 1;

/// Laps of an ellipse of 20 by 10 cm on a way of 3 cm, as fast as the users go: means over episodes, over users.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EllipseLaps {
    /// How many users.
    pub users: usize,
    /// Laps per second.
    pub laps_per_s: OverUsers,
    /// Exponent of the speed over the curvature; -1/3 is the two-thirds law.
    pub exponent: OverUsers,
    /// Share of the variance of the logarithms of speeds that it explains.
    pub r2: OverUsers,
    /// Share of the episodes in which all laps were gone.
    pub finished: f64,
}

impl EllipseLaps {
    /// Of one user or more, each with its recordings.
    ///
    /// # Errors
    /// A user did not go all laps twice.
    pub fn of(users: &[Vec<Recording>]) -> Result<Self, ProtocolError> {
        let all = users.iter().map(|recordings| Laps::of(recordings)).collect::<Result<Vec<_>, _>>()?;
        let over = |of: fn(&Laps) -> f64| OverUsers::of(&all.iter().map(of).collect::<Vec<_>>(), "laps of the ellipse");
        Ok(Self {
            users: users.len(),
            laps_per_s: over(|laps| laps.per_s)?,
            exponent: over(|laps| laps.exponent)?,
            r2: over(|laps| laps.r2)?,
            finished: over(|laps| laps.finished)?.median,
        })
    }
}

/// What one user did.
struct Laps {
    per_s: f64,
    exponent: f64,
    r2: f64,
    finished: f64,
}

impl Laps {
    fn of(recordings: &[Recording]) -> Result<Self, ProtocolError> {
        let whole = recordings.iter().filter_map(between_laps).collect::<Vec<_>>();
        let (found, asked) = (whole.len(), recordings.len());
        if found < LEAST {
            let what = format!("episodes of {LAPS} laps of the ellipse");
            return Err(ProtocolError::TooFew { what, found, asked, least: LEAST });
        }
        let measuring = ProtocolError::measuring("laps of the ellipse");
        let law = |(recording, [begin, end]): &(&Recording, [usize; 2])| {
            let smooth = signal::low_pass_points(&recording.fingertip, recording.rate_hz, CUT_OFF_HZ)?;
            PowerLaw::of(&smooth[*begin..*end], recording.rate_hz)
        };
        let laws = whole.iter().map(law).collect::<Result<Vec<_>, _>>().map_err(measuring)?;
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / found as f64;
        let rate = |(recording, [begin, end]): &(&Recording, [usize; 2])| {
            (LAPS - 1) as f64 * recording.rate_hz / (end - begin) as f64
        };
        Ok(Self {
            per_s: mean(&mut whole.iter().map(rate)),
            exponent: mean(&mut laws.iter().map(|law| law.fit.slope)),
            r2: mean(&mut laws.iter().map(|law| law.fit.r2)),
            finished: found as f64 / asked as f64,
        })
    }
}

/// Samples from the end of the first lap to that of the last; none where there was none.
fn between_laps(recording: &Recording) -> Option<(&Recording, [usize; 2])> {
    let (begin, end) = (recording.done.get(FIRST)?.end, recording.done.get(LAST)?.entry);
    (begin < end && end <= recording.fingertip.len()).then_some((recording, [begin, end]))
}
