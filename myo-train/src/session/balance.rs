//! What doing its task brings a user, and what its movements would cost it.

use serde::{Deserialize, Serialize};

use crate::Episodes;

/// Columns of an episode with what it earned.
const EARNED: [&str; 2] = ["reward_subtask", "reward_completion"];

/// Columns with what movement and errors cost, negative.
const SPENT: [&str; 6] = [
    "reward_neural_effort",
    "reward_acceleration_effort",
    "reward_control_change",
    "reward_contact",
    "reward_wrong_press",
    "reward_exit",
];

/// Rewards of an episode, in the mean over as many as there are environments.
///
/// Fewer would be those that happened to end: environments that began together end in waves, the first of which are those who were fast.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Balance {
    /// Control steps before which episodes do not count.
    start: u64,
    /// Whether an episode that counts has ended.
    known: bool,
    /// What was earned by targets.
    earned: f64,
    /// The most that it ever was.
    #[serde(default)]
    most_earned: f64,
    /// What movement and errors would have cost if all of it had counted.
    price: f64,
}

impl Balance {
    /// Nothing known yet. Episodes that end before `start` control steps do not count: they are short, and mostly successes.
    pub const fn new(start: u64) -> Self {
        Self { start, known: false, earned: 0.0, most_earned: 0.0, price: 0.0 }
    }

    /// Hears of episodes that ended in so many environments after `env_steps`, while such a share of the price counted.
    pub fn hear(&mut self, env_steps: u64, episodes: &Episodes, num_envs: usize, cost_share: f64) {
        if env_steps < self.start || episodes.count == 0 || cost_share == 0.0 {
            return;
        }
        let weight = 1.0 - (-(episodes.count as f64) / num_envs as f64).exp();
        self.known = true;
        self.earned += weight * (sum(episodes, &EARNED) - self.earned);
        self.most_earned = self.most_earned.max(self.earned);
        self.price += weight * (-sum(episodes, &SPENT) / cost_share - self.price);
    }

    /// What an episode earned, once that is known.
    pub fn earned(&self) -> Option<f64> {
        self.known.then_some(self.earned)
    }

    /// Whether less is earned than such a share of the most that ever was.
    pub fn has_lost(&self, kept: f64) -> bool {
        self.earned < kept * self.most_earned
    }

    /// The share of the price that comes to such a part of what is earned; all where it costs nothing. Nobody can tell before anything is known.
    pub fn affordable(&self, part: f64) -> Option<f64> {
        self.known.then(|| if self.price > 0.0 { part * self.earned.max(0.0) / self.price } else { 1.0 })
    }
}

fn sum(episodes: &Episodes, columns: &[&str]) -> f64 {
    columns.iter().filter_map(|column| episodes.mean(column)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many episodes that earned and spent so much each.
    fn ended(count: u64, earned: f64, spent: f64) -> Episodes {
        let means = [
            ("reward_subtask", earned),
            ("reward_control_change", -0.25 * spent),
            ("reward_neural_effort", -0.75 * spent),
        ];
        Episodes { count, means: means.map(|(name, mean)| (name.to_owned(), mean)).to_vec() }
    }

    /// Hears of them after a thousand control steps of a hundred environments.
    fn hear(balance: &mut Balance, (count, earned, spent): (u64, f64, f64), cost_share: f64) {
        balance.hear(1_000, &ended(count, earned, spent), 100, cost_share);
    }

    #[test]
    fn a_part_of_what_is_earned_can_be_spent() {
        let mut balance = Balance::new(1_000);
        assert_eq!(balance.affordable(0.5), None, "nothing is known yet");
        hear(&mut balance, (1_000_000, 8.0, 2.0), 0.25);
        assert_eq!(balance.affordable(0.5), Some(0.5), "all of it would be 8");
        hear(&mut balance, (1_000_000, 0.0, 2.0), 0.25);
        assert_eq!(balance.affordable(0.5), Some(0.0), "who does nothing can spend nothing");
        let mut free = Balance::new(0);
        hear(&mut free, (1, 0.0, 0.0), 0.25);
        assert_eq!(free.affordable(0.5), Some(1.0), "what costs nothing");
    }

    #[test]
    fn who_earns_less_than_before_has_lost() {
        let mut balance = Balance::new(1_000);
        assert!(!balance.has_lost(0.9), "who never earned anything");
        hear(&mut balance, (1_000_000, 8.0, 2.0), 0.25);
        assert!(!balance.has_lost(0.9));
        hear(&mut balance, (1_000_000, 7.0, 2.0), 0.25);
        assert!(balance.has_lost(0.9) && !balance.has_lost(0.8), "seven eighths are left");
    }

    #[test]
    fn errors_are_paid_as_movement_is() {
        let mut balance = Balance::new(0);
        let means = [
            ("reward_subtask", 8.0),
            ("reward_control_change", -0.25),
            ("reward_wrong_press", -0.5),
            ("reward_exit", -0.25),
        ];
        let means = means.map(|(name, mean)| (name.to_owned(), mean)).to_vec();
        balance.hear(0, &Episodes { count: 1_000_000, means }, 100, 0.125);
        assert_eq!(balance.earned(), Some(8.0));
        assert_eq!(balance.affordable(0.5), Some(0.5), "an eighth of them was 1");
    }

    #[test]
    fn it_takes_an_episode_of_every_environment_to_learn_of_a_change() {
        let mut balance = Balance::new(0);
        (0..50).for_each(|_| hear(&mut balance, (10, 8.0, 2.0), 0.25));
        let before = balance.affordable(0.5).unwrap();
        hear(&mut balance, (10, 8.0, 8.0), 0.25);
        let after = balance.affordable(0.5).unwrap();
        assert!(
            (0.7..0.8).contains(&(after / before)),
            "a tenth of the environments spent four times as much: {before}, {after}"
        );
    }

    #[test]
    fn the_first_episodes_to_end_do_not_count_nor_those_of_which_no_price_is_known() {
        let mut balance = Balance::new(1_001);
        hear(&mut balance, (10, 8.0, 2.0), 0.25);
        assert_eq!(balance, Balance::new(1_001));
        let mut balance = Balance::new(0);
        hear(&mut balance, (10, 8.0, 0.0), 0.0);
        hear(&mut balance, (0, f64::NAN, f64::NAN), 0.5);
        assert_eq!(balance, Balance::new(0));
    }
}
