//! Protocol T3: how fast a user types, and how often beside the key, on keys of several sizes.

use myo_measure::statistics;
use serde::Serialize;

use super::ProtocolError;
use super::plot::{Plot, PlotPoint, PlotSeries};
use super::pointing::OverUsers;
use super::practice::{KEY_WIDTHS, TYPED};
use super::recording::Recording;

/// Letters of a word, as words per minute are counted.
const WORD: f64 = 5.0;
/// Least share of the episodes in which the whole sentence is typed.
const LEAST_SHARE: f64 = 0.5;

/// A sentence on phones with keys of four sizes, with one finger. It is always the same: users come to know it by heart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Typing {
    /// How many users.
    pub users: usize,
    /// Each size of keys.
    pub rows: Vec<TypingRow>,
}

/// Keys of one size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TypingRow {
    /// Width and height of a key (m).
    pub key_m: f64,
    /// Words of five letters per minute, from the first press to the last; mean over episodes, median over users, as all that follow.
    pub words_per_min: f64,
    /// 95 % confidence interval of the mean over users.
    pub words_per_min_interval: Option<[f64; 2]>,
    /// From a letter to the next (s).
    pub letter_s: f64,
    /// Wrong presses for a hundred letters.
    pub wrong_per_100: f64,
    /// Its interval.
    pub wrong_per_100_interval: Option<[f64; 2]>,
    /// Share of the episodes in which the sentence was not finished; all else is of those in which it was.
    pub unfinished: f64,
}

impl Typing {
    /// Of one user or more, each with its recordings of all sizes, in their order.
    ///
    /// # Errors
    /// A user who did not finish the sentence in half of its episodes.
    pub fn of(users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let row = |(number, &key): (usize, &f64)| {
            let of_users = users.iter().map(|user| Typed::of(key, &user[number])).collect::<Result<Vec<_>, _>>()?;
            TypingRow::of(key, &of_users)
        };
        Ok(Self { users: users.len(), rows: KEY_WIDTHS.iter().enumerate().map(row).collect::<Result<_, _>>()? })
    }

    /// Wrong presses over the width of keys.
    pub fn plot(&self) -> Plot {
        let point = |row: &TypingRow| PlotPoint {
            at: [1e3 * row.key_m, row.wrong_per_100],
            interval: row.wrong_per_100_interval,
        };
        let line = self.rows.iter().map(|row| point(row).at).collect();
        Plot {
            title: "Wrong presses while typing".into(),
            axes: ["width of a key, mm".into(), "wrong presses for a hundred letters".into()],
            series: vec![PlotSeries { name: String::new(), points: self.rows.iter().map(point).collect(), line }],
        }
    }
}

/// What one user did on keys of one size.
struct Typed {
    words_per_min: f64,
    letter_s: f64,
    wrong_per_100: f64,
    unfinished: f64,
}

impl Typed {
    fn of(key: f64, recordings: &[Recording]) -> Result<Self, ProtocolError> {
        let letters = TYPED.chars().count();
        let whole: Vec<&Recording> = recordings.iter().filter(|recording| recording.done.len() == letters).collect();
        let (found, asked) = (whole.len(), recordings.len());
        let least = ((LEAST_SHARE * asked as f64).ceil() as usize).max(1);
        if found < least {
            let what = format!("the sentence on keys of {:.0} mm", 1e3 * key);
            return Err(ProtocolError::TooFew { what, found, asked, least });
        }
        let seconds = |recording: &&Recording| {
            let [first, last] = [recording.done[0], recording.done[letters - 1]].map(|done| done.entry);
            (last - first) as f64 / recording.rate_hz / (letters - 1) as f64
        };
        let letter_s = whole.iter().map(seconds).sum::<f64>() / found as f64;
        let wrong = whole.iter().map(|recording| recording.wrong_presses).sum::<f64>();
        Ok(Self {
            words_per_min: 60.0 / (WORD * letter_s),
            letter_s,
            wrong_per_100: 100.0 * wrong / (found * letters) as f64,
            unfinished: 1.0 - found as f64 / asked as f64,
        })
    }
}

impl TypingRow {
    fn of(key_m: f64, users: &[Typed]) -> Result<Self, ProtocolError> {
        let all = |of: fn(&Typed) -> f64| users.iter().map(of).collect::<Vec<_>>();
        let over = |of: fn(&Typed) -> f64| OverUsers::of(&all(of), "typing");
        let middle = |of: fn(&Typed) -> f64| statistics::median(&all(of)).map_err(ProtocolError::measuring("typing"));
        let (words, wrong) = (over(|user| user.words_per_min)?, over(|user| user.wrong_per_100)?);
        Ok(Self {
            key_m,
            words_per_min: words.median,
            words_per_min_interval: words.interval,
            letter_s: middle(|user| user.letter_s)?,
            wrong_per_100: wrong.median,
            wrong_per_100_interval: wrong.interval,
            unfinished: middle(|user| user.unfinished)?,
        })
    }
}
