//! The nature whose movements are nearest to those of a person.

use myo_model::Model;
use serde::Serialize;

use super::FittingError;
use super::figures::{Aim, FIGURES, Figures, figures, of_person, told};
use super::muscles::Recorded;
use super::nature::{COUNT, Nature, TRAITS, places};
use super::surface::{Nearest, Samples, Surface, TERMS};
use crate::recordings::{Participant, measured};

/// Most trainings of a user who can be anybody: in each round each of them does a few natures at least.
pub const MOST_TRAININGS: usize = 20;

/// Natures of each round, and how far (of 1, half of all) they lie from the nearest of the round before.
const ROUNDS: [(usize, f64); 3] = [(64, 1.0), (40, 0.5), (40, 0.25)];

/// Who comes nearest to a person.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fitted {
    /// The person.
    pub participant: String,
    /// Movements that were compared.
    pub movements: usize,
    /// Pairs of distance and width (m) in which they were.
    pub pairs: Vec<[f64; 2]>,
    /// What the user is like who comes nearest.
    pub traits: Vec<FittedTrait>,
    /// How far the user was from the person before, and is then: root of the mean squared difference of figures, each in standard deviations of that figure between
    /// users of one nature, who learnt apart where there are several trainings. Nothing where the user could not do before what the person did.
    pub distance_before: Option<f64>,
    /// The same of the user who was found.
    pub distance_after: f64,
    /// Trainings that were compared; of one, what another would have done differently is in no interval.
    pub trainings: usize,
    /// What was compared.
    pub figures: Vec<FittedFigure>,
    /// The same as numbers whose differences count.
    #[serde(skip)]
    pub(super) compared: Compared,
}

/// Figures of a person and of who was found, as numbers whose differences count.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Compared {
    pub person: Figures,
    /// Those at the place that was found, by what all users about it did.
    pub nearest: Figures,
    /// Standard deviations of the person's from these, as far as chance and trainings go.
    pub deviations: Figures,
}

/// A trait of who comes nearest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FittedTrait {
    /// Its place in a task file.
    pub key: &'static str,
    /// What it is.
    pub what: &'static str,
    /// What it was.
    pub before: f64,
    /// What it is to be.
    pub found: f64,
    /// 95 % confidence interval; as wide as all that was tried where the recordings do not tell.
    pub interval: [f64; 2],
    /// Whether the recordings tell: whether the interval is narrower than half of all that was tried.
    pub is_told: bool,
}

/// A figure of the person, and of the user before and then.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedFigure {
    /// What it is, with its unit.
    pub what: String,
    /// The person's.
    pub person: f64,
    /// The user's before; nothing where it could not do what the person did.
    pub before: Option<f64>,
    /// The user's who was found.
    pub after: f64,
}

/// One person, with figures, and users who are asked the same.
struct Search<'a, F> {
    who: &'a str,
    pairs: Vec<[f64; 2]>,
    person: Figures,
    movements: usize,
    muscles: &'a [String],
    trainings: usize,
    simulate: F,
}

impl Fitted {
    /// Of one person, beginning from a user who has learnt in so many trainings apart. `simulate` lets natures, each with the number of its training, do targets of pairs of distance and width, and
    /// tells the movements of each, with the activations of `muscles`.
    ///
    /// # Errors
    /// Too few movements, natures who cannot do what the person did, or what `simulate` refuses.
    pub fn of<E: From<FittingError>>(
        (who, movements): (&str, &[Aim]),
        muscles: &[String],
        (before, trainings): (Nature, usize),
        simulate: impl FnMut(&[(Nature, usize)], &[[f64; 2]]) -> Result<Vec<Vec<Aim>>, E>,
    ) -> Result<Self, E> {
        let (pairs, person, count) = of_person(who, movements)?;
        let mut search =
            Search { who, pairs, person, movements: count, muscles, trainings: trainings.max(1), simulate };
        let (mut about, mut found) = ([0.0; COUNT], None);
        for (natures, within) in ROUNDS {
            let surface = search.surface(places(natures, about, within))?;
            let nearest = surface.nearest(&search.person, about, within);
            about = nearest.place;
            found = Some((surface, nearest));
        }
        let Some((surface, nearest)) = found else { return Err(FittingError::Alike { who: who.into() }.into()) };
        search.told(before, &surface, &nearest)
    }
}

/// Refuses recordings that no user with this body can be fitted to.
///
/// # Errors
/// Too few movements of the distances and widths that can be asked, movements that are all alike, muscles that the body has not, or a recording that cannot be measured.
pub fn comparable(person: &Participant, model: &Model) -> Result<(), FittingError> {
    let (_, movements) = compared(person, model)?;
    of_person(&person.name, &movements).map(drop)
}

/// What is compared of a person: muscles, and movements.
pub(super) fn compared(person: &Participant, model: &Model) -> Result<(Recorded, Vec<Aim>), FittingError> {
    let (movements, _) = measured(person)?;
    Ok((Recorded::of(person, model)?, movements.iter().map(Aim::from).collect()))
}

impl<F, E: From<FittingError>> Search<'_, F>
where
    F: FnMut(&[(Nature, usize)], &[[f64; 2]]) -> Result<Vec<Vec<Aim>>, E>,
{
    /// Figures over natures at these places. Of a sequence that is even, each training does a part that is as even.
    fn surface(&mut self, places: Vec<[f64; COUNT]>) -> Result<Surface, E> {
        let count = places.len();
        let training = |number: usize| number * self.trainings / count;
        let natures: Vec<_> = (0..).map(training).zip(&places).map(|(own, &place)| (Nature::at(place), own)).collect();
        let (mut samples, mut movements) = (Samples::default(), 0);
        for ((place, (_, training)), found) in places.into_iter().zip(&natures).zip(self.ask(&natures)?) {
            let Some((figures, own)) = found else { continue };
            samples.places.push(place);
            samples.trainings.push(*training);
            samples.figures.push(figures);
            movements += own;
        }
        // Of each training somebody is needed.
        for training in 0..self.trainings {
            let of_it = natures.iter().filter(|nature| nature.1 == training).count();
            if !samples.trainings.contains(&training) {
                return Err(self.unlearnt((of_it, 0), 1).into());
            }
        }
        let able = samples.places.len();
        // A person's figures are known as well as a nature's, of as many movements.
        let more = 1.0 + movements as f64 / (able.max(1) * self.movements) as f64;
        let surface = Surface::through(&samples, self.trainings, more);
        surface.ok_or_else(|| self.unlearnt((count, able), TERMS + self.trainings).into())
    }

    /// Figures of natures, and how many movements these are; none of who cannot do it.
    fn ask(&mut self, natures: &[(Nature, usize)]) -> Result<Vec<Option<(Figures, usize)>>, E> {
        let recorded = (self.simulate)(natures, &self.pairs)?;
        Ok(recorded.iter().map(|movements| figures(movements, &self.pairs)).collect())
    }

    /// Figures of a nature, the mean over trainings; nothing where it can do it in none.
    fn of_all(&mut self, nature: Nature) -> Result<Option<Figures>, E> {
        let each: Vec<_> = (0..self.trainings).map(|training| (nature, training)).collect();
        let able: Vec<Figures> = self.ask(&each)?.into_iter().flatten().map(|(figures, _)| figures).collect();
        let mean = |k: usize| able.iter().map(|own| own[k]).sum::<f64>() / able.len() as f64;
        Ok((!able.is_empty()).then(|| (0..self.person.len()).map(mean).collect()))
    }

    fn unlearnt(&self, (natures, able): (usize, usize), least: usize) -> FittingError {
        FittingError::Unlearnt { who: self.who.into(), natures, able, least }
    }

    /// What was found, with what the user did before and does then.
    fn told(&mut self, before: Nature, surface: &Surface, nearest: &Nearest) -> Result<Fitted, E> {
        let after = Nature::at(nearest.place);
        let old = self.of_all(before)?;
        let new = self.of_all(after)?.ok_or_else(|| self.unlearnt((1, 0), 1))?;
        let distance = |own: &Figures| {
            let squared = |k: usize| (own[k] - self.person[k]).powi(2) / (surface.within[k] + surface.between[k]);
            ((0..own.len()).map(squared).sum::<f64>() / own.len() as f64).sqrt()
        };
        let figure = |(k, what): (usize, String)| {
            let [person, after] = [self.person[k], new[k]].map(|value| told(k, value));
            FittedFigure { what, person, before: old.as_ref().map(|old| told(k, old[k])), after }
        };
        let hand = FIGURES.iter().map(ToString::to_string);
        let names = hand.chain(self.muscles.iter().map(|muscle| format!("activation of {muscle}")));
        Ok(Fitted {
            participant: self.who.into(),
            movements: self.movements,
            pairs: self.pairs.clone(),
            traits: (0..COUNT).map(|k| FittedTrait::of(k, before, after, nearest)).collect(),
            distance_before: old.as_ref().map(&distance),
            distance_after: distance(&new),
            trainings: self.trainings,
            figures: names.enumerate().map(figure).collect(),
            compared: Compared {
                person: self.person.clone(),
                nearest: surface.at(&nearest.place),
                deviations: surface.deviations.clone(),
            },
        })
    }
}

impl FittedTrait {
    fn of(number: usize, before: Nature, after: Nature, nearest: &Nearest) -> Self {
        let Nearest { place, reaches } = nearest;
        let far = reaches[number];
        let ends = [-far, far].map(|off| {
            let mut there = *place;
            there[number] = (place[number] + off).clamp(-1.0, 1.0);
            there
        });
        let trait_ = TRAITS[number];
        Self {
            key: trait_.key,
            what: trait_.what,
            before: before.0[number],
            found: after.0[number],
            interval: ends.map(|end| Nature::at(end).0[number]),
            is_told: ends[1][number] - ends[0][number] < 1.0,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use myo_measure::Movement;
    use myo_measure::fitts::{Trial, index_of_difficulty};

    use super::*;

    pub const PAIRS: [[f64; 2]; 4] = [[0.1, 0.05], [0.2, 0.05], [0.2, 0.02], [0.4, 0.02]];

    /// Normal numbers, more or less: the middle of twelve even ones, by SplitMix64.
    struct Chance(u64);

    impl Chance {
        fn next(&mut self) -> f64 {
            let mut even = || {
                self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
                let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
                let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
                ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
            };
            (0..12).map(|_| even()).sum::<f64>() - 6.0
        }
    }

    /// Somebody whose movements are known: dear changes make them slow, dear effort makes them straight, noise scatters times, eyes where they end.
    pub fn moves(
        Nature([noise, eyes, effort, change]): Nature,
        pairs: &[[f64; 2]],
        count: usize,
        seed: u64,
    ) -> Vec<Aim> {
        let mut chance = Chance(seed);
        let mut aim = |&[distance, width]: &[f64; 2]| {
            let index = index_of_difficulty(distance, width);
            let time = (0.15 + 0.02 * change.sqrt() * index) * (0.5 * noise.sqrt() * chance.next()).exp();
            let first_stop =
                Some([distance * (0.95 + 0.5 * eyes * chance.next()), 0.1 * eyes * distance * chance.next(), 0.0]);
            let peak_speed = 1.8 * distance / time;
            let movement = Movement {
                onset: 0,
                end: 100,
                duration_s: time,
                peak_speed,
                mean_speed: distance / time,
                peak_over_mean: 1.8,
                time_of_peak: 0.45 + 0.02 * chance.next(),
                speed_maxima: 1,
                path: distance,
                chord: distance,
                path_over_chord: Some(1.01 + 0.1 / effort.sqrt() + 0.01 * chance.next().abs()),
                sparc: -1.45 - 0.1 * noise + 0.02 * chance.next(),
                ldlj: -6.0,
            };
            let (start, target) = ([0.0; 3], [distance, 0.0, 0.0]);
            let trial = Trial { movement_time_s: time, start, target, end: target };
            Aim::known([distance, width], trial, movement, first_stop)
        };
        pairs.iter().flat_map(|pair| std::iter::repeat_n(pair, count)).map(&mut aim).collect()
    }

    pub fn simulate(natures: &[(Nature, usize)], pairs: &[[f64; 2]]) -> Result<Vec<Vec<Aim>>, FittingError> {
        Ok((1..).zip(natures).map(|(seed, &(nature, _))| moves(nature, pairs, 60, 1000 * seed)).collect())
    }

    pub const USUAL: Nature = Nature([0.05, 0.2, 4.0, 11.0]);

    #[test]
    fn who_is_known_is_found_within_a_tenth() {
        for (seed, known) in (7..).zip([[0.09, 0.13, 9.0, 22.0], [0.035, 0.28, 2.5, 6.0]]) {
            let person = moves(Nature(known), &PAIRS, 400, seed);
            let fitted = Fitted::of(("somebody", &person), &[], (USUAL, 1), simulate).unwrap();
            for (found, known) in fitted.traits.iter().zip(known) {
                assert!((found.found / known).ln().abs() < 0.1, "{known}: {found:?}");
                assert!(
                    found.is_told && (found.interval[0]..=found.interval[1]).contains(&known),
                    "{known}: {found:?}"
                );
            }
            assert!(
                fitted.distance_after < 2.0 && fitted.distance_before.unwrap() > 3.0 * fitted.distance_after,
                "{fitted:?}"
            );
            assert_eq!((fitted.movements, fitted.pairs.len()), (1600, PAIRS.len()));
            for figure in &fitted.figures {
                assert!((figure.after - figure.person).abs() <= 0.05 + 0.1 * figure.person.abs(), "{figure:?}");
            }
        }
    }

    /// The same of somebody whose hand knows nothing of effort.
    fn blind(natures: &[(Nature, usize)], pairs: &[[f64; 2]]) -> Result<Vec<Vec<Aim>>, FittingError> {
        let natures: Vec<_> =
            natures.iter().map(|(Nature([a, b, _, d]), of)| (Nature([*a, *b, 8.0, *d]), *of)).collect();
        simulate(&natures, pairs)
    }

    /// What muscles do at it: less where effort is dear, each in its own way.
    fn active(Nature([noise, _, effort, change]): Nature, mut movements: Vec<Aim>, seed: u64) -> Vec<Aim> {
        let mut chance = Chance(seed);
        for one in &mut movements {
            let mut muscle = |own: f64| own * (0.2 * chance.next()).exp();
            one.activations = vec![muscle(0.1 * effort.powf(-0.1)), muscle(0.3 * change.powf(0.1)), muscle(noise)];
        }
        movements
    }

    #[test]
    fn muscles_tell_what_the_hand_does_not() {
        let known = Nature([0.09, 0.13, 20.0, 22.0]);
        let simulate = |natures: &[(Nature, usize)], pairs: &[[f64; 2]]| {
            let all = (1..).zip(natures).zip(blind(natures, pairs)?);
            Ok::<_, FittingError>(all.map(|((seed, &(nature, _)), aims)| active(nature, aims, 2000 * seed)).collect())
        };
        let [hand] = &blind(&[(known, 0)], &PAIRS).unwrap()[..] else { panic!("one nature, one person") };
        let person = active(known, hand.clone(), 5);
        let names = ["DELT1", "BIClong", "ECU"].map(str::to_owned);
        let fitted = Fitted::of(("somebody", &person), &names, (USUAL, 1), simulate).unwrap();
        let effort = &fitted.traits[2];
        assert!(effort.is_told && (effort.found / 20.0).ln().abs() < 0.4, "{effort:?}");
        assert!((effort.interval[0]..=effort.interval[1]).contains(&20.0), "{effort:?}");
        let [.., delt, biceps, _] = &fitted.figures[..] else { panic!("{:?}", fitted.figures) };
        assert_eq!((&*delt.what, &*biceps.what), ("activation of DELT1", "activation of BIClong"));
        assert!((delt.person / (0.1 * 20.0_f64.powf(-0.1)) - 1.02).abs() < 0.02, "{delt:?}");
        assert_eq!(fitted.figures.len(), FIGURES.len() + 3);
    }

    #[test]
    fn a_muscle_that_no_user_needs_hides_nothing() {
        let known = Nature([0.09, 0.13, 9.0, 22.0]);
        let with = |activation: f64, mut aims: Vec<Aim>| {
            aims.iter_mut().for_each(|aim| aim.activations = vec![activation]);
            aims
        };
        let silent = |natures: &[(Nature, usize)], pairs: &[[f64; 2]]| {
            Ok::<_, FittingError>(simulate(natures, pairs)?.into_iter().map(|aims| with(0.0, aims)).collect())
        };
        let person = with(0.02, moves(known, &PAIRS, 400, 7));
        let fitted = Fitted::of(("somebody", &person), &["ECU".into()], (USUAL, 1), silent).unwrap();
        for (found, known) in fitted.traits.iter().zip(known.0) {
            assert!(found.is_told && (found.found / known).ln().abs() < 0.1, "{known}: {found:?}");
        }
        assert!(fitted.distance_after < 20.0, "{}", fitted.distance_after);
    }

    /// Trainings that make their users quicker or slower, each in its own way, whatever they are like.
    fn of_habits(natures: &[(Nature, usize)], pairs: &[[f64; 2]]) -> Result<Vec<Vec<Aim>>, FittingError> {
        let mut all = simulate(natures, pairs)?;
        for (&(_, training), aims) in natures.iter().zip(&mut all) {
            let later_s = [-0.05, 0.02, 0.06, -0.01][training];
            aims.iter_mut().for_each(|aim| aim.later(later_s));
        }
        Ok(all)
    }

    #[test]
    fn what_one_training_does_and_another_does_not_widens_intervals() {
        let known = Nature([0.09, 0.13, 9.0, 22.0]);
        let mut person = moves(known, &PAIRS, 400, 7);
        person.iter_mut().for_each(|aim| aim.later(0.08));
        let fit = |trainings| Fitted::of(("somebody", &person), &[], (USUAL, trainings), of_habits).unwrap();
        let (one, four) = (fit(1), fit(4));
        let [alone, change] = [&one, &four].map(|fitted| fitted.traits[3]);
        assert!(!(alone.interval[0]..=alone.interval[1]).contains(&22.0), "{alone:?}");
        assert!((change.interval[0]..=change.interval[1]).contains(&22.0), "{change:?}");
        for (found, known) in four.traits.iter().zip(known.0) {
            assert!((found.interval[0]..=found.interval[1]).contains(&known), "{found:?}");
        }
        // Where targets seem to be is seen where the first bell of speed ends, whatever habits there are.
        assert!(four.traits[1].is_told, "{:?}", four.traits[1]);
        assert!(four.distance_after < one.distance_after, "{} and {}", four.distance_after, one.distance_after);
        assert_eq!((one.trainings, four.trainings), (1, 4));
    }

    #[test]
    fn what_the_recordings_do_not_tell_is_unknown() {
        let person = moves(Nature([0.09, 0.13, 8.0, 22.0]), &PAIRS, 100, 3);
        let fitted = Fitted::of(("somebody", &person), &[], (USUAL, 1), blind).unwrap();
        let told: Vec<bool> = fitted.traits.iter().map(|one| one.is_told).collect();
        assert_eq!(told, [true, true, false, true], "{:?}", fitted.traits);
    }

    #[test]
    fn movements_that_are_all_alike_are_no_lack_of_learning() {
        let one = moves(USUAL, &PAIRS, 1, 1);
        let same: Vec<Aim> = one.iter().flat_map(|aim| std::iter::repeat_n(aim.clone(), 20)).collect();
        let refused = Fitted::of(("anna", &same), &[], (USUAL, 1), simulate).unwrap_err().to_string();
        assert!(refused.starts_with("anna: nothing can be compared: movement times"), "{refused}");
    }

    #[test]
    fn a_training_that_has_not_learnt_it_is_told() {
        let second = |natures: &[(Nature, usize)], pairs: &[[f64; 2]]| {
            let all = natures.iter().map(|&(nature, training)| moves(nature, pairs, [60, 2, 60][training], 1));
            Ok::<_, FittingError>(all.collect())
        };
        let person = moves(USUAL, &PAIRS, 40, 1);
        let refused = Fitted::of(("anna", &person), &[], (USUAL, 3), second).unwrap_err().to_string();
        assert!(refused.starts_with("of 21 natures only 0 could do what anna did, and at least 1"), "{refused}");
    }

    #[test]
    fn too_few_movements_and_beginners_are_refused() {
        let few = moves(USUAL, &PAIRS[..2], 40, 1);
        let refused = Fitted::of(("anna", &few), &[], (USUAL, 1), simulate).unwrap_err().to_string();
        assert!(refused.starts_with("anna: 80 movements in 2 pairs") && refused.contains("needs 3 pairs"), "{refused}");
        let far: Vec<Aim> = moves(USUAL, &[[0.9, 0.05], [0.8, 0.02], [0.7, 0.03]], 40, 1);
        let refused = Fitted::of(("anna", &far), &[], (USUAL, 1), simulate).unwrap_err().to_string();
        assert!(
            refused.starts_with("anna: 0 movements in 0 pairs") && refused.contains("from 6 to 40 cm"),
            "{refused}"
        );
        let beginner = |natures: &[(Nature, usize)], pairs: &[[f64; 2]]| {
            Ok::<_, FittingError>(natures.iter().map(|&(nature, _)| moves(nature, pairs, 2, 1)).collect())
        };
        let refused =
            Fitted::of(("anna", &moves(USUAL, &PAIRS, 40, 1)), &[], (USUAL, 1), beginner).unwrap_err().to_string();
        assert!(refused.starts_with("of 64 natures only 0 could do what anna did"), "{refused}");
    }
}
