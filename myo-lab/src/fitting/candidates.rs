//! Users who differ in what is built into their simulation, so that each learns to be anybody for itself: how late they see, and how tall they are.

use myo_tasks::Task;
use serde::Serialize;

use super::{Anybody, Fitted, FittingError};
use crate::recordings::Participant;

/// Squared deviations by which another user has to be farther to be ruled out: 95 of 100 for one trait (chi-squared).
const RULED_OUT: f64 = 3.84;

/// In what a user differs from the one who was told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Candidate {
    /// How late it sees (ms, `perception.vision_delay_ms`); nothing as told.
    pub vision_delay_ms: Option<f64>,
    /// Its stature (m, `body.height_m`); nothing as told.
    pub height_m: Option<f64>,
}

impl Candidate {
    /// Each delay (ms) with each stature (m), for users who decide every so many seconds; of what there is none, as told.
    ///
    /// # Errors
    /// A value stands there twice, or two delays are as many control steps.
    pub fn all(delays_ms: &[f64], heights_m: &[f64], control_dt_s: f64) -> Result<Vec<Self>, FittingError> {
        let step_ms = 1e3 * control_dt_s;
        if let Some((a, b)) = alike(delays_ms, |ms| (ms / step_ms).round()) {
            return Err(FittingError::SameDelay { a, b, step_ms });
        }
        if let Some((height_m, _)) = alike(heights_m, |height| height) {
            return Err(FittingError::SameHeight { height_m });
        }
        let [delays, heights] = [delays_ms, heights_m].map(or_as_told);
        let with_each =
            |&vision_delay_ms: &Option<f64>| heights.iter().map(move |&height_m| Self { vision_delay_ms, height_m });
        Ok(delays.iter().flat_map(with_each).collect())
    }

    /// Puts it in place of the user of a task.
    pub fn change(self, task: &mut Task) {
        if let Some(delay_ms) = self.vision_delay_ms {
            task.perception.vision_delay_ms = delay_ms;
        }
        if self.height_m.is_some() {
            task.body.height_m = self.height_m;
        }
    }

    /// What its folder is called behind that of the user who was told: `-120ms-1.6m`; nothing if it is that user.
    pub fn suffix(self) -> String {
        let Self { vision_delay_ms, height_m } = self;
        let words = [vision_delay_ms.map(|ms| format!("-{ms}ms")), height_m.map(|height| format!("-{height}m"))];
        words.into_iter().flatten().collect()
    }
}

/// Two values that are the same by a measure.
fn alike(values: &[f64], measure: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
    let pair =
        |(number, &a): (usize, &f64)| values[number + 1..].iter().find(|&&b| measure(a) == measure(b)).map(|&b| (a, b));
    values.iter().enumerate().find_map(pair)
}

fn or_as_told(values: &[f64]) -> Vec<Option<f64>> {
    if values.is_empty() { vec![None] } else { values.iter().copied().map(Some).collect() }
}

/// The user who comes nearest to a person, of several.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedAmong {
    /// Who it became.
    #[serde(flatten)]
    pub fitted: Fitted,
    /// All of them, each become somebody, the nearest first.
    pub candidates: Vec<Ranked>,
}

/// One of several users who tried to move as a person does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ranked {
    /// Which one.
    #[serde(flatten)]
    pub candidate: Candidate,
    /// How far it is from the person when it has become as near as it can: as [`Fitted::distance_after`], measured alike for all, of many users at once. Nothing where it cannot do
    /// what the person did.
    pub distance: Option<f64>,
    /// Whether the recordings do not rule it out.
    pub is_possible: bool,
}

impl FittedAmong {
    /// The nearest of several users who can be anybody, or nobody once `go_on` says no.
    ///
    /// # Errors
    /// As [`Anybody::fitted`]; there is no user.
    pub fn of(
        users: &[(Candidate, Anybody)],
        person: &Participant,
        seed: u64,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Self>, FittingError> {
        let mut fitted = vec![];
        for (candidate, anybody) in users {
            let Some(own) = anybody.fitted(person, seed, go_on).transpose() else { return Ok(None) };
            fitted.push((*candidate, own));
        }
        Self::nearest(fitted).map(Some)
    }

    /// The nearest of users who were fitted to one person. Who [cannot do](FittingError::Unlearnt) what the person did comes last.
    ///
    /// # Errors
    /// There is no user, none can do it, or one was not fitted for another reason.
    pub fn nearest(all: Vec<(Candidate, Result<Fitted, FittingError>)>) -> Result<Self, FittingError> {
        let (mut fitted, mut unable, mut why) = (vec![], vec![], None);
        for (candidate, own) in all {
            match own {
                Ok(own) => fitted.push((candidate, own)),
                Err(error @ FittingError::Unlearnt { .. }) => {
                    unable.push(Ranked { candidate, distance: None, is_possible: false });
                    why = why.or(Some(error));
                }
                Err(error) => return Err(error),
            }
        }
        if fitted.is_empty() { Err(why.unwrap_or(FittingError::NoUser)) } else { Self::among(fitted, unable) }
    }

    /// Of those who can and those who cannot.
    fn among(fitted: Vec<(Candidate, Fitted)>, unable: Vec<Ranked>) -> Result<Self, FittingError> {
        let scale = scale(&fitted);
        let mut measured: Vec<(f64, Candidate, Fitted)> =
            fitted.into_iter().map(|(candidate, own)| (squared(&own, &scale), candidate, own)).collect();
        measured.sort_by(|a, b| a.0.total_cmp(&b.0));
        let least = measured.first().ok_or(FittingError::NoUser)?.0;
        let figures = scale.len() as f64;
        // Who differs from people in a way that no trait changes is farther than chance lets him be; so is then every step between two of them.
        let free = (figures - measured[0].2.traits.len() as f64).max(1.0);
        let most = least + RULED_OUT * (least / free).max(1.0);
        let ranked = |&(squared, candidate, _): &(f64, Candidate, Fitted)| Ranked {
            candidate,
            distance: Some((squared / figures).sqrt()),
            is_possible: squared <= most,
        };
        let candidates = measured.iter().map(ranked).chain(unable).collect();
        Ok(Self { fitted: measured.swap_remove(0).2, candidates })
    }

    /// What the recordings tell of a trait in which candidates differ: its value, if they rule out all who have another. Who cannot do what the person did is none of these: it may not
    /// have learnt it.
    pub fn told(&self, of: impl Fn(&Candidate) -> Option<f64>) -> Option<f64> {
        let value = of(&self.candidates.first()?.candidate)?;
        let differ = self.candidates.iter().any(|one| of(&one.candidate) != Some(value));
        let ruled_out = self
            .candidates
            .iter()
            .all(|one| of(&one.candidate) == Some(value) || one.distance.is_some() && !one.is_possible);
        (differ && ruled_out).then_some(value)
    }
}

/// Standard deviations of each figure, as of all users together.
fn scale(fitted: &[(Candidate, Fitted)]) -> Vec<f64> {
    let own: Vec<&[f64]> = fitted.iter().map(|(_, own)| &own.compared.deviations[..]).collect();
    let figures = own.first().map_or(0, |first| first.len());
    let pooled = |figure: usize| own.iter().map(|own| own[figure] * own[figure]).sum::<f64>() / own.len() as f64;
    (0..figures).map(|figure| pooled(figure).sqrt()).collect()
}

/// Squared distance of a person from who is nearest of one kind, in deviations.
fn squared(fitted: &Fitted, scale: &[f64]) -> f64 {
    let compared = &fitted.compared;
    let off = compared
        .person
        .iter()
        .zip(&compared.nearest)
        .zip(scale)
        .map(|((person, nearest), one)| (person - nearest) / one);
    off.map(|off| off * off).sum()
}

#[cfg(test)]
mod tests {
    use super::super::search::tests::{PAIRS, USUAL, moves};
    use super::super::{Aim, Nature};
    use super::*;

    #[test]
    fn each_delay_meets_each_stature() {
        let all = Candidate::all(&[40.0, 120.0], &[1.6, 1.9], 0.04).unwrap();
        let names: Vec<String> = all.iter().map(|one| one.suffix()).collect();
        assert_eq!(names, ["-40ms-1.6m", "-40ms-1.9m", "-120ms-1.6m", "-120ms-1.9m"]);
        assert_eq!(Candidate::all(&[], &[], 0.04).unwrap(), [Candidate::default()]);
        assert_eq!(Candidate::default().suffix(), "");
        let mut task = myo_tasks::preset("pointing").unwrap();
        all[2].change(&mut task);
        assert_eq!((task.perception.vision_delay_ms, task.body.height_m), (120.0, Some(1.6)));
        let before = task.clone();
        Candidate::default().change(&mut task);
        assert_eq!(task, before);
    }

    #[test]
    fn candidates_who_are_the_same_are_refused() {
        let refused = Candidate::all(&[40.0, 80.0, 50.0], &[], 0.04).unwrap_err().to_string();
        assert!(refused.contains("40 and 50 ms are the same number of control steps of 40 ms"), "{refused}");
        let refused = Candidate::all(&[], &[1.6, 1.7, 1.6], 0.04).unwrap_err().to_string();
        assert!(refused.contains("1.6 m stands there twice"), "{refused}");
    }

    /// Users who see late are slower to get there in a way that no trait can make up for.
    fn seeing_late(delay_ms: f64, nature: Nature, count: usize, seed: u64) -> Vec<Aim> {
        let mut all = moves(nature, &PAIRS, count, seed);
        all.iter_mut().for_each(|aim| aim.later(1e-3 * delay_ms));
        all
    }

    fn among(delays: &[f64], known_ms: f64, count: usize) -> FittedAmong {
        let person = seeing_late(known_ms, Nature([0.09, 0.13, 9.0, 22.0]), count, 5);
        let fit = |&delay_ms: &f64| {
            let simulate = |natures: &[(Nature, usize)], _: &[[f64; 2]]| {
                let all = (1..).zip(natures);
                Ok::<_, FittingError>(
                    all.map(|(seed, &(nature, _))| seeing_late(delay_ms, nature, 60, 1000 * seed)).collect(),
                )
            };
            let fitted = Fitted::of(("somebody", &person), &[], (USUAL, 1), simulate);
            (Candidate { vision_delay_ms: Some(delay_ms), height_m: None }, fitted)
        };
        FittedAmong::nearest(delays.iter().map(fit).collect()).unwrap()
    }

    #[test]
    fn a_delay_is_found_and_others_are_ruled_out() {
        for known in [40.0, 160.0] {
            let found = among(&[40.0, 100.0, 160.0], known, 400);
            assert_eq!(found.told(|one| one.vision_delay_ms), Some(known), "{:?}", found.candidates);
            assert_eq!(found.told(|one| one.height_m), None);
            assert!(
                found.candidates.is_sorted_by(|a, b| a.distance.unwrap() <= b.distance.unwrap()),
                "{:?}",
                found.candidates
            );
        }
    }

    #[test]
    fn users_who_move_alike_are_not_told_apart() {
        let found = among(&[100.0, 100.5], 100.0, 60);
        assert!(found.candidates.iter().all(|one| one.is_possible), "{:?}", found.candidates);
        assert_eq!(found.told(|one| one.vision_delay_ms), None);
        // One alone has nobody to be told from.
        assert_eq!(among(&[100.0], 100.0, 60).told(|one| one.vision_delay_ms), None);
        assert!(matches!(FittedAmong::nearest(vec![]), Err(FittingError::NoUser)));
    }

    #[test]
    fn who_cannot_do_it_is_not_possible_and_tells_nothing() {
        let unable = || Err(FittingError::Unlearnt { who: "somebody".into(), natures: 2, able: 1, least: 2 });
        let [tall, small] = [1.9, 1.5].map(|height| Candidate { vision_delay_ms: None, height_m: Some(height) });
        let person = moves(USUAL, &PAIRS, 60, 5);
        let own = Fitted::of(("somebody", &person), &[], (USUAL, 1), super::super::search::tests::simulate);
        let found = FittedAmong::nearest(vec![(small, unable()), (tall, own)]).unwrap();
        assert_eq!((found.candidates[0].candidate, found.told(|one| one.height_m)), (tall, None));
        assert_eq!(found.candidates[1], Ranked { candidate: small, distance: None, is_possible: false });
        assert!(matches!(FittedAmong::nearest(vec![(small, unable())]), Err(FittingError::Unlearnt { .. })));
    }
}
