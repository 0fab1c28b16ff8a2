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
    /// Which size a user has not learnt, if there is one, and what would help.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unlearnt: Option<String>,
}

/// Keys of one size. Figures are of the users who have learnt it; none where nobody has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TypingRow {
    /// Width and height of a key (m).
    pub key_m: f64,
    /// Words of five letters per minute, from the first press to the last; mean over episodes, median over users, as all that follow.
    pub words_per_min: Option<f64>,
    /// 95 % confidence interval of the mean over users.
    pub words_per_min_interval: Option<[f64; 2]>,
    /// From a letter to the next (s).
    pub letter_s: Option<f64>,
    /// Wrong presses for a hundred letters.
    pub wrong_per_100: Option<f64>,
    /// Its interval.
    pub wrong_per_100_interval: Option<[f64; 2]>,
    /// Share of the episodes in which the sentence was not finished, of all users; all else is of those in which it was.
    pub unfinished: f64,
}

impl Typing {
    /// Of one user or more, each with its recordings of all sizes, in their order. [`unlearnt`](Self::unlearnt) says who did not finish the sentence in half
    /// of its episodes.
    ///
    /// # Errors
    /// Nobody has learnt anything.
    pub fn of(users: &[Vec<Vec<Recording>>]) -> Result<Self, ProtocolError> {
        let of_size = |(number, &key): (usize, &f64)| {
            let of_users: Vec<Typed> = users.iter().map(|user| Typed::of(&user[number])).collect();
            let unlearnt = of_users.iter().find_map(|typed| typed.learnt(key).err());
            (TypingRow::of(key, &of_users), unlearnt)
        };
        let (rows, unlearnt): (Vec<_>, Vec<_>) = KEY_WIDTHS.iter().enumerate().map(of_size).unzip();
        let rows = rows.into_iter().collect::<Result<Vec<_>, _>>()?;
        match unlearnt.into_iter().flatten().next() {
            Some(error) if rows.iter().all(|row| row.letter_s.is_none()) => Err(error),
            first => Ok(Self { users: users.len(), rows, unlearnt: first.map(|error| error.to_string()) }),
        }
    }

    /// Wrong presses over the width of keys.
    pub fn plot(&self) -> Plot {
        let point = |row: &TypingRow| {
            Some(PlotPoint { at: [1e3 * row.key_m, row.wrong_per_100?], interval: row.wrong_per_100_interval })
        };
        let points: Vec<PlotPoint> = self.rows.iter().filter_map(point).collect();
        let line = points.iter().map(|point| point.at).collect();
        Plot {
            title: "Wrong presses while typing".into(),
            axes: ["width of a key, mm".into(), "wrong presses for a hundred letters".into()],
            series: vec![PlotSeries { name: String::new(), points, line }],
        }
    }
}

/// What one user did on keys of one size.
struct Typed<'a> {
    /// Episodes in which the whole sentence was typed.
    whole: Vec<&'a Recording>,
    /// Episodes in all.
    asked: usize,
}

impl<'a> Typed<'a> {
    fn of(recordings: &'a [Recording]) -> Self {
        let whole = recordings.iter().filter(|recording| recording.done.len() == letters());
        Self { whole: whole.collect(), asked: recordings.len() }
    }

    /// Refuses who did not finish often enough.
    fn learnt(&self, key: f64) -> Result<(), ProtocolError> {
        let (found, asked) = (self.whole.len(), self.asked);
        let least = ((LEAST_SHARE * asked as f64).ceil() as usize).max(1);
        if found < least {
            let what = format!("the sentence on keys of {:.0} mm", 1e3 * key);
            return Err(ProtocolError::TooFew { what, found, asked, least });
        }
        Ok(())
    }

    /// From a letter to the next (s), mean over episodes.
    fn letter_s(&self) -> f64 {
        let seconds = |recording: &&Recording| {
            let [first, last] = [recording.done[0], recording.done[letters() - 1]].map(|done| done.entry);
            (last - first) as f64 / recording.rate_hz / (letters() - 1) as f64
        };
        self.whole.iter().map(seconds).sum::<f64>() / self.whole.len() as f64
    }

    fn wrong_per_100(&self) -> f64 {
        let wrong = self.whole.iter().map(|recording| recording.wrong_presses).sum::<f64>();
        100.0 * wrong / (self.whole.len() * letters()) as f64
    }

    fn unfinished(&self) -> f64 {
        1.0 - self.whole.len() as f64 / self.asked as f64
    }
}

/// How many letters there are.
fn letters() -> usize {
    TYPED.chars().count()
}

impl TypingRow {
    fn of(key_m: f64, users: &[Typed<'_>]) -> Result<Self, ProtocolError> {
        let learnt: Vec<&Typed<'_>> = users.iter().filter(|user| user.learnt(key_m).is_ok()).collect();
        let over = |of: &dyn Fn(&Typed<'_>) -> f64| {
            let values: Vec<f64> = learnt.iter().map(|user| of(user)).collect();
            if values.is_empty() { Ok(None) } else { OverUsers::of(&values, "typing").map(Some) }
        };
        let unfinished: Vec<f64> = users.iter().map(Typed::unfinished).collect();
        let words = over(&|user| 60.0 / (WORD * user.letter_s()))?;
        let (letter, wrong) = (over(&|user| user.letter_s())?, over(&|user| user.wrong_per_100())?);
        Ok(Self {
            key_m,
            words_per_min: words.map(|words| words.median),
            words_per_min_interval: words.and_then(|words| words.interval),
            letter_s: letter.map(|letter| letter.median),
            wrong_per_100: wrong.map(|wrong| wrong.median),
            wrong_per_100_interval: wrong.and_then(|wrong| wrong.interval),
            unfinished: statistics::median(&unfinished).map_err(ProtocolError::measuring("typing"))?,
        })
    }
}
