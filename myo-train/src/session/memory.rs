//! What a session remembers from one update to the next.

use serde::{Deserialize, Serialize};

use super::balance::Balance;
use super::curve::Curve;
use super::looks::Looks;
use super::trend::Trend;
use crate::rollout::told_layouts;
use crate::{Evaluation, Trainer, UpdateMetrics};

/// Part of what its targets earn it that a user can spend on its movements: trying must pay, also where it is hard.
const PART: f64 = 2.0 / 3.0;

/// Share of the most that a user earned which it keeps while more of the costs comes to count than it can afford. Who falls below is let off; each time
/// less is asked of it by this factor, or a task that is not worth all of its costs would never be learnt to an end.
const KEPT: f64 = 0.9;

/// The least share of costs: what it comes to tells what all would.
const LEAST: f64 = 1.0 / 4096.0;

/// Steps in which the logarithm of the share changes.
const COST_STEP: f64 = 1.0 / 64.0;

/// What the next decisions of a session depend on besides its trainer and the state to go back to; part of a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Memory {
    /// When to look at the goal.
    pub looks: Looks,
    /// How success grew.
    pub curve: Curve,
    /// How the policy without its noise did.
    #[serde(default)]
    pub noise_free: Curve,
    /// How success grew in each layout; empty where there is one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layouts: Vec<Curve>,
    /// Share of what movement and errors cost that counts.
    #[serde(default = "all")]
    pub cost_share: f64,
    /// Control steps after which more or less of it began to count.
    #[serde(default, alias = "costs_raised_at")]
    pub costs_changed_at: u64,
    /// What the user earns and spends.
    #[serde(default)]
    pub balance: Balance,
    /// The same in each layout; empty where there is one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layout_balances: Vec<Balance>,
    /// Whether nothing improved with less: from then on all counts, unless the user loses by it what it could do.
    #[serde(default)]
    pub all_counts: bool,
    /// How often it lost that, and control steps after which it did last.
    #[serde(default)]
    pub falls: u32,
    #[serde(default)]
    pub fell_at: u64,
    /// Evaluations taken: the next one has other episodes.
    pub evaluations: u64,
    /// How often the training went back to its good state.
    pub tries: u32,
    /// How long steps were allowed to be at first; 0 where that is not known any more.
    #[serde(default)]
    pub learning_rate_max: f64,
    /// Whether it was told that nothing improves.
    pub told_flat: bool,
    /// Seconds spent on evaluations.
    pub evaluation_s: f64,
    /// The newest evaluation that confirmed a goal.
    pub confirmed: Option<Evaluation>,
}

impl Memory {
    /// Nothing seen yet of a training that is about to go on from where it is.
    pub fn new(trainer: &Trainer) -> Self {
        let (start, layouts) = (first_whole_episodes(trainer), told_layouts(trainer.spec()));
        Self {
            looks: Looks::new(trainer.env_steps()),
            curve: Curve::new(start),
            noise_free: Curve::new(start),
            layouts: vec![Curve::new(start); layouts],
            cost_share: first_cost_share(trainer),
            costs_changed_at: 0,
            balance: Balance::new(start),
            layout_balances: vec![Balance::new(start); layouts],
            all_counts: first_cost_share(trainer) == 1.0,
            falls: 0,
            fell_at: 0,
            evaluations: 0,
            tries: 0,
            learning_rate_max: trainer.config().learning_rate_max,
            told_flat: false,
            evaluation_s: 0.0,
            confirmed: None,
        }
    }

    /// Lets so much of the costs count as the user can afford: never more than a part of what its targets earn it.
    ///
    /// Who does nothing of its task yet pays nearly nothing, or it would learn to keep still. As more gets done, and by cheaper movements, more counts:
    /// small shares grow by the same factor and great ones by the same amount in the same time, all at the earliest when the sum of
    /// `growth` is 2. Of several layouts none is given up: a user who earns less in one than in another can afford as much less, or it would leave what is hard,
    /// and be rich by what is not done. From when nothing improves with what the user can afford, it comes to be all in any case, at least as fast as the
    /// steps grow, of which the newest are `newest`; but who loses by that what it could do is let off, and begins anew with what it can afford.
    pub fn follow_costs(&mut self, env_steps: u64, newest: u64, growth: f64) {
        let counted = self.share_that_counts();
        self.all_counts |= self.overall_trend(self.fell_at).is_some_and(|trend| trend.is_plateau());
        if self.all_counts && self.balance.has_lost(KEPT.powi(1 + self.falls as i32)) {
            (self.all_counts, self.falls, self.fell_at) = (false, self.falls + 1, env_steps);
        }
        let share = self.cost_share;
        let grown = |growth: f64| share + growth.min(share * (LEAST.powf(-growth) - 1.0));
        self.cost_share = if self.all_counts {
            grown(growth.max(newest as f64 / env_steps as f64))
        } else {
            self.affordable().map_or(share, |most| grown(growth).min(most))
        }
        .clamp(LEAST, 1.0);
        if self.share_that_counts() != counted {
            self.costs_changed_at = env_steps;
        }
    }

    /// The share that a user can afford, as far as it does all of its layouts.
    fn affordable(&self) -> Option<f64> {
        let earned = || self.layout_balances.iter().filter_map(Balance::earned);
        let (least, most) = (earned().reduce(f64::min), earned().reduce(f64::max));
        let evenness = least.zip(most).map_or(1.0, |(least, most)| if most > 0.0 { least / most } else { 1.0 });
        Some(self.balance.affordable(PART)? * evenness)
    }

    /// The share in steps: to write it into a card's memory takes time.
    pub fn share_that_counts(&self) -> f64 {
        ((self.cost_share.ln() / COST_STEP).floor() * COST_STEP).exp()
    }

    /// Whether nothing improves any more, with all of the costs for at least as long as with less.
    pub fn has_settled(&self) -> bool {
        let settled = |trend: Trend| trend.is_plateau() && trend.env_steps >= 2 * self.costs_changed_at;
        self.cost_share == 1.0 && self.trend().is_some_and(settled)
    }

    /// The layout in which recent episodes succeed least, and its curve: what a goal has to wait for. Without a number where there
    /// is but one layout; none before an episode has ended in every layout.
    pub fn least(&self) -> Option<(Option<usize>, &Curve)> {
        let success = |curve: &Curve| curve.recent().map(|recent| recent.success);
        let mut least = (None, &self.curve, success(&self.curve)?);
        for (layout, curve) in self.layouts.iter().enumerate() {
            let own = success(curve)?;
            if least.0.is_none() || own < least.2 {
                least = (Some(layout), curve, own);
            }
        }
        Some((least.0, least.1))
    }

    /// Success of recent training episodes, in the layout where it is least.
    pub fn least_success(&self) -> Option<f64> {
        self.least()?.1.recent().map(|recent| recent.success)
    }

    /// Control steps that training may still take until success is `until` in every layout, judged by the learning curves.
    pub fn steps_to(&self, until: f64) -> Option<u64> {
        let threshold = self.looks.threshold(until);
        match &self.layouts[..] {
            [] => self.curve.steps_to(threshold),
            layouts => layouts.iter().try_fold(0, |most, curve| Some(most.max(curve.steps_to(threshold)?))),
        }
    }

    /// Hears of a look at the policy after `env_steps`, how many control steps a quick one takes at most, and what it found.
    pub fn looked(&mut self, env_steps: u64, cost: u64, taken: &[Evaluation]) {
        self.evaluations += taken.len() as u64;
        let found = taken.last().and_then(Evaluation::least_success);
        self.looks.looked(env_steps, cost, found, self.least_success());
    }

    /// Hears of an update.
    pub fn hear(&mut self, metrics: &UpdateMetrics, num_envs: usize) {
        let UpdateMetrics { env_steps, cost_share, .. } = *metrics;
        self.balance.hear(env_steps, &metrics.episodes, num_envs, cost_share);
        let of_layout = num_envs / self.layout_balances.len().max(1);
        for (balance, ended) in self.layout_balances.iter_mut().zip(&metrics.layouts) {
            balance.hear(env_steps, ended, of_layout, cost_share);
        }
        self.curve.hear(metrics.env_steps, &metrics.episodes);
        self.noise_free.hear(metrics.env_steps, &metrics.noise_free);
        for (curve, ended) in self.layouts.iter_mut().zip(&metrics.layouts) {
            curve.hear(metrics.env_steps, ended);
        }
    }

    /// What the last doubling brought and more would, if that can be told: of the policy without its noise, as it will be
    /// evaluated, or of training episodes where too few act without. Where there are several layouts, that of the one that is
    /// farthest from a plateau, by its training episodes, if it is farther than all together.
    ///
    /// Steps are counted from when all of what movements cost counted, once that tells enough.
    pub fn trend(&self) -> Option<Trend> {
        let paid = (self.cost_share == 1.0).then(|| self.trend_since(self.costs_changed_at)).flatten();
        paid.or_else(|| self.trend_since(0))
    }

    /// The same with the steps counted from `start`.
    fn trend_since(&self, start: u64) -> Option<Trend> {
        let all = self.overall_trend(start)?;
        let of_layout = |curve: &Curve| curve.trend_since(start, curve.first_return()?);
        self.layouts.iter().try_fold(all, |farthest, curve| Some(farthest.or_farther(of_layout(curve)?)))
    }

    /// The same over all layouts together. What the return gained is counted from the first training episodes: when enough have ended of those
    /// without noise, much may have been learnt.
    fn overall_trend(&self, start: u64) -> Option<Trend> {
        let first = self.curve.first_return()?;
        self.noise_free.trend_since(start, first).or_else(|| self.curve.trend_since(start, first))
    }

    /// Forgets what came after `env_steps`.
    pub fn go_back(&mut self, env_steps: u64) {
        self.curve.cut(env_steps);
        self.noise_free.cut(env_steps);
        self.layouts.iter_mut().for_each(|curve| curve.cut(env_steps));
        self.fell_at = self.fell_at.min(env_steps);
        self.looks.gone_back(env_steps);
    }
}

/// A user who has learnt something already pays for its movements.
fn first_cost_share(trainer: &Trainer) -> f64 {
    let knows_nothing = trainer.updates() == 0 && trainer.inherited().is_none();
    if knows_nothing && trainer.config().cost_ramp_s > 0.0 { LEAST } else { 1.0 }
}

/// Before there was a share, all counted.
fn all() -> f64 {
    1.0
}

/// Control steps after which every environment has ended an episode.
fn first_whole_episodes(trainer: &Trainer) -> u64 {
    let spec = trainer.spec();
    trainer.env_steps() + (spec.num_envs * spec.max_episode_steps) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Episodes;

    /// A user who takes so many seconds after so many million steps, and succeeds in such a share of its episodes.
    fn curve(seconds: fn(f64) -> f64, success: f64) -> Curve {
        let mut curve = Curve::new(0);
        for env_steps in (16_384..=32_000_000).step_by(16_384) {
            let seconds = seconds(env_steps as f64 / 1e6);
            let means = [("success", success), ("length", 20.0 * seconds), ("return", 10.0 - seconds)];
            let means = means.iter().map(|&(name, mean)| (name.to_owned(), mean)).collect();
            curve.hear(env_steps, &Episodes { count: 500, means });
        }
        curve
    }

    fn memory(layouts: Vec<Curve>) -> Memory {
        Memory {
            looks: Looks::new(0),
            curve: curve(|_| 1.0, 0.9),
            noise_free: Curve::new(0),
            layouts,
            cost_share: 1.0,
            costs_changed_at: 0,
            balance: Balance::new(0),
            layout_balances: vec![],
            all_counts: true,
            falls: 0,
            fell_at: 0,
            evaluations: 0,
            tries: 0,
            learning_rate_max: 0.0,
            told_flat: false,
            evaluation_s: 0.0,
            confirmed: None,
        }
    }

    /// A user of whom nothing is known but how success grew, and what an episode earned, and spent while all that movement costs counted.
    fn with(earned: f64, spent: f64, curve: Curve) -> Memory {
        let mut memory = Memory { curve, cost_share: LEAST, all_counts: false, ..memory(vec![]) };
        let means = [("reward_completion", earned), ("reward_neural_effort", -spent)];
        let means = means.map(|(name, mean)| (name.to_owned(), mean)).to_vec();
        let episodes = Episodes { count: 1_000_000, means };
        memory.balance.hear(32_000_000, &episodes, 1, 1.0);
        memory
    }

    /// What counts of the costs after an update.
    fn charged(memory: &mut Memory, growth: f64) -> f64 {
        memory.follow_costs(32_000_000, 8_000_000, growth);
        memory.share_that_counts()
    }

    /// Whether two shares are the same step of the scale on which they are charged.
    fn same(a: f64, b: f64) -> bool {
        (a / b).ln().abs() <= COST_STEP
    }

    #[test]
    fn costs_follow_what_the_user_can_afford() {
        let still_learning = || curve(|_| 4.0, 0.0);
        let mut rich = with(8.0, 2.0, still_learning());
        let shares = [0.25; 8].map(|growth| charged(&mut rich, growth));
        let expected = [LEAST.powf(0.75), LEAST.powf(0.5), LEAST.powf(0.25), 0.375, 0.625, 0.875, 1.0, 1.0];
        assert!(
            shares.iter().zip(expected).all(|(&a, b)| same(a, b)),
            "first by a factor, then by an amount: {shares:?}"
        );
        assert_eq!(rich.costs_changed_at, 32_000_000);
        assert!(same(charged(&mut with(3.0, 8.0, still_learning()), 1.0), 0.25), "two thirds of what is earned");
        assert!(
            same(charged(&mut with(0.0, 4.0, still_learning()), 1.0), LEAST),
            "who earns nothing pays next to nothing"
        );
    }

    #[test]
    fn no_layout_is_given_up_for_being_dear() {
        let still_learning = || curve(|_| 4.0, 0.0);
        let earning = |earned: f64| with(earned, 1.0, still_learning()).balance;
        let mut memory = with(3.0, 8.0, still_learning());
        memory.layout_balances = vec![earning(4.0), earning(2.0), Balance::new(0)];
        assert!(same(charged(&mut memory, 1.0), 0.125), "a half of a quarter; of the third nothing is known yet");
        memory.layout_balances[2] = earning(0.0);
        assert!(same(charged(&mut memory, 1.0), LEAST), "a layout that nothing is done in");
        memory.layout_balances = vec![earning(0.0), earning(0.0)];
        assert!(same(charged(&mut memory, 1.0), 0.25), "all alike");
    }

    #[test]
    fn the_share_stays_until_earnings_are_known() {
        let earlier = Memory { curve: curve(|_| 4.0, 0.0), all_counts: false, cost_share: 0.2, ..memory(vec![]) };
        assert!(same(charged(&mut { earlier }, 1.0), 0.2), "a training of an earlier program goes on as it was");
    }

    #[test]
    fn all_counts_when_nothing_improves_with_less() {
        let mut settled = with(0.0, 1.0, curve(|_| 1.0, 0.9));
        assert!(same(charged(&mut settled, 0.0), LEAST.powf(0.75)), "as fast as the steps grow");
        assert!(same(charged(&mut settled, 0.75), 0.75));
        assert_eq!(charged(&mut settled, 1.0), 1.0);
        assert_eq!(charged(&mut settled, 0.0), 1.0, "for good");
    }

    #[test]
    fn who_loses_by_all_costs_what_it_could_do_is_let_off() {
        let mut settled = with(8.0, 12.0, curve(|_| 1.0, 0.9));
        let shares = [1.0; 2].map(|growth| charged(&mut settled, growth));
        assert_eq!(shares[1], 1.0, "more than it can afford");
        let earn = |memory: &mut Memory, earned: f64| {
            let means = [("reward_completion", earned), ("reward_neural_effort", -12.0)];
            let means = means.map(|(name, mean)| (name.to_owned(), mean)).to_vec();
            memory.balance.hear(32_000_000, &Episodes { count: 1_000_000, means }, 1, 1.0);
        };
        earn(&mut settled, 7.5);
        assert_eq!(charged(&mut settled, 1.0), 1.0, "nearly as much as before");
        earn(&mut settled, 6.0);
        assert!(same(charged(&mut settled, 1.0), 1.0 / 3.0), "what it can afford");
        assert_eq!((settled.falls, settled.fell_at), (1, 32_000_000));
        earn(&mut settled, 8.0);
        assert!(same(charged(&mut settled, 1.0), 4.0 / 9.0), "until nothing improves with that, either");
        settled.fell_at = 8_000_000;
        assert_eq!(charged(&mut settled, 1.0), 1.0);
        earn(&mut settled, 6.9);
        assert_eq!(charged(&mut settled, 1.0), 1.0, "less is asked of who fell before");
        settled.go_back(4_000_000);
        assert_eq!(settled.fell_at, 4_000_000);
    }

    #[test]
    fn all_counts_also_where_one_layout_is_never_done() {
        // Else who does the others would never pay.
        let mut settled = with(0.0, 1.0, curve(|_| 1.0, 0.9));
        settled.layouts = vec![curve(|_| 1.0, 0.9), curve(|_| 4.0, 0.0)];
        assert!(settled.trend().is_none(), "and it is at no plateau");
        assert_eq!([0.75, 1.0].map(|growth| charged(&mut settled, growth)).last(), Some(&1.0));
        assert!(!settled.has_settled());
    }

    /// A user of whom episodes without noise first end when it has learnt its task, for whom costs then grow until 60 million steps, and who goes on
    /// becoming cheaper and faster by so little that nobody would wait for it.
    fn paying(until: u64) -> Memory {
        let (mut trained, mut noise_free) = (Curve::new(0), Curve::new(0));
        for env_steps in (16_384..=until).step_by(16_384) {
            let x = env_steps as f64 / 1e6;
            let paid = (x / 60.0).min(1.0);
            let since = 1.0 + (x - 60.0).max(0.0) / 10.0;
            let (seconds, earned) = (5.0 + 4.0 * paid - 0.2 * since.ln(), 27.0 - 7.0 * paid + 0.3 * since.ln());
            let means = |episode_return, success| {
                let means = [("success", success), ("length", 25.0 * seconds), ("return", episode_return)];
                let means = means.map(|(name, mean)| (String::from(name), mean)).to_vec();
                Episodes { count: 500, means }
            };
            if x < 3.0 {
                trained.hear(env_steps, &means(-14.0, 0.0));
            } else {
                trained.hear(env_steps, &means(earned, 1.0));
                noise_free.hear(env_steps, &means(earned, 1.0));
            }
        }
        Memory { curve: trained, noise_free, costs_changed_at: 60_000_000, ..memory(vec![]) }
    }

    #[test]
    fn practice_is_counted_from_when_all_costs_counted() {
        let [early, settled] = [100_000_000, 140_000_000].map(|until| paying(until).has_settled());
        assert!(!early && settled, "as long with all of the costs as with less: {early}, {settled}");
        let trend = paying(140_000_000).trend().unwrap();
        assert_eq!((trend.since, trend.env_steps / 1_000_000), (60_000_000, 139));
        assert!(trend.last_doubling.episode_time < 0.0, "from 100 million on it became faster: {trend:?}");
        // A return of 27 with nothing to pay is no measure of what was learnt: it is 20 with all of the costs.
        assert!(trend.last_doubling.episode_return.abs() < 0.01, "{trend:?}");
    }

    #[test]
    fn a_half_learned_layout_does_not_hide_behind_the_mean() {
        let [done, learning, hopeless] = [curve(|_| 1.0, 0.9), curve(|x| 1.0 + 8.0 / x, 0.8), curve(|_| 4.0, 0.0)];
        let is_plateau = |layouts: &[&Curve]| {
            memory(layouts.iter().map(|&curve| curve.clone()).collect()).trend().map(|trend| trend.is_plateau())
        };
        assert_eq!(is_plateau(&[]), Some(true));
        assert_eq!(is_plateau(&[&done, &done]), Some(true));
        assert_eq!(is_plateau(&[&done, &learning]), Some(false));
        assert_eq!(is_plateau(&[&learning, &done]), Some(false));
        assert_eq!(is_plateau(&[&done, &hopeless]), None, "nobody can tell before it can be done");

        let memory = memory(vec![done, learning]);
        assert_eq!((memory.least().unwrap().0, memory.least_success()), (Some(1), Some(0.8)));
        assert!(memory.steps_to(0.95).is_none() || memory.steps_to(0.95) > Some(0), "the second is not there yet");
    }
}
