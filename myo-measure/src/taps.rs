//! Taps in a contact force.

use crate::{Result, check, statistics};

/// When a contact counts as a press, in N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// A press begins with the first sample of at least this force; 0.3 by default.
    pub press: f64,
    /// It ends with the first sample below this force; 0.1 by default.
    pub release: f64,
    /// Contacts with less time (s) between them are one press: a fingertip that bounces does not press twice; 0.03 by default.
    pub bounce_s: f64,
}

impl Default for Contact {
    fn default() -> Self {
        Self { press: 0.3, release: 0.1, bounce_s: 0.03 }
    }
}

/// One press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// First sample.
    pub begin: usize,
    /// Sample of the release, the first that does not belong to it.
    pub end: usize,
    /// From begin to end, in s.
    pub contact_time_s: f64,
    /// Largest force in N.
    pub peak: f64,
    /// Integral of the force over its samples, in N s.
    pub impulse: f64,
}

/// Presses in a contact force. On glass people press with 0.50 N (0.09) for 133 ms (83) (Asakawa et al. 2017, J Electromyogr
/// Kinesiol 34:6).
#[derive(Clone, Debug, PartialEq)]
pub struct Taps {
    /// Those that begin and end within the recording, in order.
    pub presses: Vec<Press>,
    /// Presses that the recording cuts off at its begin or end; they are not among `presses`.
    pub cut_off: usize,
    /// From the begin of each press to that of the next, in s.
    pub intervals_s: Vec<f64>,
}

impl Taps {
    /// Of a `force`, (n), in N at a fixed rate in Hz; none is a result too. Sampled as fast as the physics: at 500 Hz a
    /// contact time is right to 2 ms.
    ///
    /// # Errors
    /// No samples, forces that are not finite or negative, a rate that is not positive, a release that is not below the press.
    pub fn of(force: &[f64], rate_hz: f64, contact: Contact) -> Result<Self> {
        check::at_least("samples of force", force.len(), 1)?;
        check::within("contact force in N", force, "0 or more", |f| f >= 0.0)?;
        check::rate(rate_hz)?;
        let Contact { press, release, bounce_s } = contact;
        check::setting("release in N", release, "greater than 0", release > 0.0)?;
        check::setting("press in N", press, "greater than the release", press > release)?;
        check::setting("bounce in s", bounce_s, "0 or more", bounce_s >= 0.0)?;
        let contacts = without_bounces(contacts(force, contact), bounce_s * rate_hz);
        // What begins while nothing was let go yet may have been pressed before the recording.
        let whole = |&(begin, end): &(usize, usize)| force[..begin].iter().any(|&f| f < release) && end < force.len();
        let presses: Vec<Press> =
            contacts.iter().copied().filter(whole).map(|(begin, end)| of_press(force, begin, end, rate_hz)).collect();
        let intervals_s = presses.windows(2).map(|pair| (pair[1].begin - pair[0].begin) as f64 / rate_hz).collect();
        Ok(Self { cut_off: contacts.len() - presses.len(), presses, intervals_s })
    }

    /// Median time from press to press, in s.
    ///
    /// # Errors
    /// Fewer than two presses.
    pub fn median_interval_s(&self) -> Result<f64> {
        check::at_least("whole presses", self.presses.len(), 2)?;
        statistics::median(&self.intervals_s)
    }

    /// Median contact time in s.
    ///
    /// # Errors
    /// No whole press.
    pub fn median_contact_time_s(&self) -> Result<f64> {
        self.median(|press| press.contact_time_s)
    }

    /// Median of peak forces in N.
    ///
    /// # Errors
    /// No whole press.
    pub fn median_peak(&self) -> Result<f64> {
        self.median(|press| press.peak)
    }

    /// Median impulse in N s.
    ///
    /// # Errors
    /// No whole press.
    pub fn median_impulse(&self) -> Result<f64> {
        self.median(|press| press.impulse)
    }

    fn median(&self, of: fn(&Press) -> f64) -> Result<f64> {
        check::at_least("whole presses", self.presses.len(), 1)?;
        statistics::median(&self.presses.iter().map(of).collect::<Vec<_>>())
    }
}

/// First samples of presses and of what follows them; the end of the recording for one that lasts.
fn contacts(force: &[f64], contact: Contact) -> Vec<(usize, usize)> {
    let (mut contacts, mut from) = (Vec::new(), 0);
    let next = |from: usize, is: &dyn Fn(f64) -> bool| force[from..].iter().position(|&f| is(f)).map(|i| from + i);
    while let Some(begin) = next(from, &|f| f >= contact.press) {
        from = next(begin, &|f| f < contact.release).unwrap_or(force.len());
        contacts.push((begin, from));
    }
    contacts
}

/// Contacts with so many samples or more between them.
fn without_bounces(contacts: Vec<(usize, usize)>, least: f64) -> Vec<(usize, usize)> {
    let mut whole: Vec<(usize, usize)> = Vec::with_capacity(contacts.len());
    for (begin, end) in contacts {
        match whole.last_mut() {
            Some(before) if ((begin - before.1) as f64) < least => before.1 = end,
            _ => whole.push((begin, end)),
        }
    }
    whole
}

fn of_press(force: &[f64], begin: usize, end: usize, rate_hz: f64) -> Press {
    let inside = &force[begin..end];
    Press {
        begin,
        end,
        contact_time_s: (end - begin) as f64 / rate_hz,
        peak: inside.iter().copied().fold(0.0, f64::max),
        impulse: inside.iter().sum::<f64>() / rate_hz,
    }
}
