//! What users of one body differ in.

use myo_tasks::Task;
use serde::Serialize;

/// Natures that are practised.
pub(super) const PRACTISED: usize = 64;
/// How many traits there are.
pub(super) const COUNT: usize = 4;

/// Something in which users of one body differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trait {
    /// Its place in a task file.
    pub key: &'static str,
    /// What it is.
    pub what: &'static str,
    /// Least and greatest value; in between, ratios count.
    pub range: [f64; 2],
}

/// All of them, in the order in which they are observed. The user `human` is in the midst.
pub const TRAITS: [Trait; COUNT] = [
    Trait { key: "noise.signal_dependent", what: "motor noise", range: [0.02, 0.2] },
    Trait { key: "perception.vision_noise", what: "misjudged targets", range: [0.05, 0.4] },
    Trait { key: "reward.effort_cost", what: "what effort costs", range: [1.0, 64.0] },
    Trait { key: "reward.control_change_cost", what: "what changes of control cost", range: [3.0, 44.0] },
];

/// A user: a value of each of [`TRAITS`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Nature(pub [f64; COUNT]);

impl Nature {
    /// That of the user of a task.
    pub fn of(task: &Task) -> Self {
        let Task { noise, perception, reward, .. } = task;
        Self([noise.signal_dependent, perception.vision_noise, reward.effort_cost, reward.control_change_cost])
    }

    /// The task done by such a user, who observes what it is like.
    #[must_use]
    pub fn doing(self, mut task: Task) -> Task {
        let Self([signal_dependent, vision_noise, effort_cost, control_change_cost]) = self;
        task.noise.signal_dependent = signal_dependent;
        task.perception.vision_noise = vision_noise;
        task.reward.effort_cost = effort_cost;
        task.reward.control_change_cost = control_change_cost;
        task.observation.traits = true;
        task
    }

    /// That at a place among all, -1 to 1 for each trait.
    pub(super) fn at(place: [f64; COUNT]) -> Self {
        let value = |number: usize| {
            let [least, most] = TRAITS[number].range;
            least * (most / least).powf(0.5 * (1.0 + place[number]))
        };
        Self(std::array::from_fn(value))
    }

    /// Its place among all.
    #[cfg(test)]
    fn place(self) -> [f64; COUNT] {
        std::array::from_fn(|number| {
            let [least, most] = TRAITS[number].range;
            2.0 * (self.0[number] / least).ln() / (most / least).ln() - 1.0
        })
    }
}

/// So many natures, spread evenly over all.
pub fn natures(count: usize) -> Vec<Nature> {
    places(count, [0.0; COUNT], 1.0).into_iter().map(Nature::at).collect()
}

/// So many other natures than those, away from the edges: users to be found again.
pub fn others(count: usize) -> Vec<Nature> {
    let all = places(PRACTISED + count, [0.0; COUNT], 0.8);
    all[PRACTISED..].iter().map(|&place| Nature::at(place)).collect()
}

/// So many places, spread evenly about one, up to so far away in each trait (Halton 1960, doi 10.1007/BF01386213).
pub(super) fn places(count: usize, about: [f64; COUNT], reach: f64) -> Vec<[f64; COUNT]> {
    let bases = [2, 3, 5, 7];
    let place = |index: usize| {
        std::array::from_fn(|number| {
            let [low, high] = [about[number] - reach, about[number] + reach].map(|end| end.clamp(-1.0, 1.0));
            low + (high - low) * radical_inverse(index, bases[number])
        })
    };
    (1..=count).map(place).collect()
}

/// The digits of a number behind the point, in reverse.
fn radical_inverse(mut index: usize, base: usize) -> f64 {
    let (mut value, mut share) = (0.0, 1.0);
    while index > 0 {
        share /= base as f64;
        value += share * (index % base) as f64;
        index /= base;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn natures_are_spread_over_all() {
        let all = natures(64);
        for (number, one) in TRAITS.iter().enumerate() {
            let [least, most] = one.range;
            let own: Vec<f64> = all.iter().map(|nature| nature.0[number]).collect();
            assert!(own.iter().all(|value| (least..=most).contains(value)), "{}: {own:?}", one.key);
            // As many in the lower half as in the upper.
            let low = own.iter().filter(|&&value| value < (least * most).sqrt()).count();
            assert!((30..=34).contains(&low), "{}: {low}", one.key);
        }
    }

    #[test]
    fn places_and_natures_are_one() {
        let place = [-1.0, 0.25, 0.5, 1.0];
        let (nature, back) = (Nature::at(place), Nature::at(place).place());
        assert!((nature.0[0] - 0.02).abs() < 1e-12 && (nature.0[3] - 44.0).abs() < 1e-9, "{nature:?}");
        assert!(back.iter().zip(place).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
    }

    #[test]
    fn tasks_are_done_by_the_nature_that_was_given() {
        let nature = Nature([0.1, 0.3, 2.0, 20.0]);
        let task = nature.doing(myo_tasks::preset("pointing").unwrap());
        assert!(task.observation.traits);
        assert_eq!(Nature::of(&task), nature);
        // The keys are those of task files.
        let text = serde_json::to_value(&task).unwrap();
        for (one, value) in TRAITS.iter().zip(nature.0) {
            let found = one.key.split('.').fold(&text, |value, key| &value[key]);
            assert_eq!(found, value, "{}", one.key);
        }
    }
}
