//! The learning curve: how training went, where it leads, and whether it leads anywhere.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::means::EpisodeMeans;
use super::trend::{Trend, WINDOW};
use crate::Episodes;

/// Episodes over which recent ones are averaged.
const MEMORY: f64 = 500.0;

/// A point is the mean of so many episodes at least.
const POINT_EPISODES: u64 = 200;

/// From one point to the next the steps grow by this share, so that a long training has hardly more points than a short one.
const SPACING: f64 = 1.0 / 32.0;

/// But by so many at most.
const SPACING_MAX: u64 = 1_000_000;

/// Points that a forecast needs; it looks back on half of all steps.
const FORECAST_POINTS: usize = 12;

/// Simulated seconds that must not have brought anything for a curve to be flat.
const FLAT_S: f64 = 300_000.0;

/// Share by which success, targets done or distance must have improved for it not to be flat.
const WORTH: f64 = 0.03;

/// Episodes that such a mean needs.
const WINDOW_EPISODES: u64 = 200;

/// One point of the curve: the mean over episodes that ended since the point before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    /// Control steps at its end.
    env_steps: u64,
    /// Until format 2 of checkpoints a point was a mean over about 500 episodes.
    #[serde(default = "until_format_2")]
    episodes: u64,
    #[serde(alias = "recent")]
    mean: EpisodeMeans,
}

fn until_format_2() -> u64 {
    MEMORY as u64
}

impl Point {
    /// With the episodes that ended in an update.
    fn with(self, env_steps: u64, episodes: u64, newer: EpisodeMeans) -> Self {
        let Self { episodes: before, mut mean, .. } = self;
        let episodes = before + episodes;
        mean.follow(newer, 1.0 - before as f64 / episodes as f64);
        Self { env_steps, episodes, mean }
    }
}

/// The curve so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Control steps before which episodes do not count.
    start: u64,
    recent: Option<EpisodeMeans>,
    points: Vec<Point>,
    /// The next point, of the episodes that have ended since the last one.
    #[serde(default)]
    next: Option<Point>,
}

impl Curve {
    /// Nothing known yet. Episodes that end before `start` control steps do not count: the first ones to end are short,
    /// and short ones are mostly successes.
    pub fn new(start: u64) -> Self {
        Self { start, ..Self::default() }
    }

    /// Hears of the episodes that ended in the update after which there were so many control steps.
    pub fn hear(&mut self, env_steps: u64, ended: &Episodes) {
        let episodes = ended.count;
        let Some(newer) = EpisodeMeans::of(ended).filter(|_| env_steps >= self.start && episodes > 0) else { return };
        let weight = 1.0 - (-(episodes as f64) / MEMORY).exp();
        self.recent.get_or_insert_with(|| newer.clone()).follow(newer.clone(), weight);
        let next = match self.next.take() {
            Some(next) => next.with(env_steps, episodes, newer),
            None => Point { env_steps, episodes, mean: newer },
        };
        if next.episodes >= POINT_EPISODES && env_steps >= self.next_at() {
            self.points.push(next);
        } else {
            self.next = Some(next);
        }
    }

    /// Control steps from which on there may be another point.
    fn next_at(&self) -> u64 {
        let spaced = |last: &Point| last.env_steps + ((last.env_steps as f64 * SPACING) as u64).min(SPACING_MAX);
        self.points.last().map_or(0, spaced)
    }

    /// Forgets what came after `env_steps`.
    pub fn cut(&mut self, env_steps: u64) {
        self.points.retain(|point| point.env_steps <= env_steps);
        self.next = None;
        self.recent = self.points.last().map(|point| point.mean.clone());
    }

    /// Means over recent episodes, if any has ended.
    pub fn recent(&self) -> Option<&EpisodeMeans> {
        self.recent.as_ref()
    }

    /// Control steps of the newest point.
    fn now(&self) -> Option<u64> {
        self.points.last().map(|point| point.env_steps)
    }

    /// Points after `range.start` control steps, up to `range.end`.
    fn between(&self, range: Range<u64>) -> &[Point] {
        let after = |env_steps: u64| self.points.partition_point(|point| point.env_steps <= env_steps);
        &self.points[after(range.start)..after(range.end)]
    }

    /// Control steps until training success is `goal`, if it goes on as it did lately; none where nobody can tell.
    ///
    /// The log-odds of success grow about as the logarithm of the steps does, so a line is fitted to them.
    pub fn steps_to(&self, goal: f64) -> Option<u64> {
        let now = self.now()?;
        let back = self.between(now / 2..now).len().max(FORECAST_POINTS);
        let points = &self.points[self.points.len().checked_sub(back)?..];
        if points.iter().any(|point| point.mean.success < 0.01) {
            return None;
        }
        let x = |env_steps: u64| (env_steps.max(1) as f64).ln();
        let y = |point: &Point| log_odds(point.mean.success);
        let (slope, reached) = line(points.iter().map(|point| (x(point.env_steps), y(point))), x(now));
        let left = ((log_odds(goal) - reached) / slope).max(0.0).exp_m1() * now as f64;
        (slope > 0.0 && left.is_finite()).then_some(left as u64)
    }

    /// What the last doubling brought and four times the steps would, steps counted from `start`, in a training whose return was
    /// `first_return` at first; none before the user could do what it can do now half as often, two doublings ago.
    pub fn trend_since(&self, start: u64, first_return: f64) -> Option<Trend> {
        let now = self.now()?;
        let steps = now.checked_sub(start)?;
        let [quarter, half, whole] = [steps / 4, steps / 2, steps].map(|steps| self.around(start, steps));
        let (quarter, half, whole) = (quarter?, half?, whole?);
        let learnt = self.points.iter().find(|point| 2.0 * point.mean.success >= whole.success)?;
        let is_told = whole.success >= 0.01 && learnt.env_steps <= start + steps / 4;
        is_told.then(|| Trend::new(start..now, first_return, [&quarter, &half, &whole]))
    }

    /// Return of the first episodes, when nothing had been learnt and next to nothing was paid.
    pub fn first_return(&self) -> Option<f64> {
        Some(self.points.first()?.mean.episode_return)
    }

    /// How the training did so many steps after `start`, if enough is known of it.
    fn around(&self, start: u64, steps: u64) -> Option<EpisodeMeans> {
        let end = start + steps;
        let mut points = self.between(end - (WINDOW * steps as f64) as u64..end).iter().cloned();
        let first = points.next()?;
        let all = points.fold(first, |all, Point { env_steps, episodes, mean }| all.with(env_steps, episodes, mean));
        (all.episodes >= WINDOW_EPISODES).then_some(all.mean)
    }

    /// Whether success, targets done and distance have not improved for long; since how many control steps of `control_dt` seconds.
    pub fn flat_for(&self, control_dt: f64) -> Option<u64> {
        let (now, long) = (self.now()?, (FLAT_S / control_dt) as u64);
        let before = now.checked_sub(long)?;
        let since = self.points.iter().rfind(|point| point.env_steps <= before)?.env_steps;
        let (older, newer) = (self.between(before..before + long / 3), self.between(now - long / 3..now));
        if older.is_empty() || newer.is_empty() {
            return None;
        }
        let change = |f| mean(newer, f) - mean(older, f);
        let targets = older[0].mean.target_success.len().max(1) as f64;
        let distance = mean(older, |recent| recent.final_distance);
        let grows = change(|recent| recent.success) > WORTH
            || change(|recent| recent.targets_done) > WORTH * targets
            || change(|recent| recent.final_distance) < -WORTH * distance;
        (!grows).then(|| now - since)
    }
}

/// Mean of a quantity over points.
fn mean(points: &[Point], f: fn(&EpisodeMeans) -> f64) -> f64 {
    points.iter().map(|point| f(&point.mean)).sum::<f64>() / points.len() as f64
}

fn log_odds(p: f64) -> f64 {
    let p = p.clamp(0.005, 0.995);
    (p / (1.0 - p)).ln()
}

/// Least-squares line through some points: its slope and its height at `at`.
fn line(points: impl Iterator<Item = (f64, f64)> + Clone, at: f64) -> (f64, f64) {
    let n = points.clone().count() as f64;
    let (sum_x, sum_y) = points.clone().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x, sy + y));
    let (mean_x, mean_y) = (sum_x / n, sum_y / n);
    let (xy, xx) = points
        .fold((0.0, 0.0), |(xy, xx), (x, y)| (xy + (x - mean_x) * (y - mean_y), xx + (x - mean_x) * (x - mean_x)));
    let slope = xy / xx;
    (slope, mean_y + slope * (at - mean_x))
}

#[cfg(test)]
mod tests {
    use super::super::trend::Change;
    use super::*;

    impl Curve {
        /// From the beginning.
        fn trend(&self) -> Option<Trend> {
            self.trend_since(0, self.first_return()?)
        }
    }

    fn episodes(count: u64, means: &[(&str, f64)]) -> Episodes {
        Episodes { count, means: means.iter().map(|&(name, mean)| (name.to_owned(), mean)).collect() }
    }

    /// The curve after updates with `success` and `distance` as functions of the control steps.
    fn curve(until: u64, success: impl Fn(f64) -> f64, distance: impl Fn(f64) -> f64) -> Curve {
        let mut curve = Curve::default();
        for env_steps in (0..until).step_by(16_384) {
            let x = env_steps as f64;
            let means = [("success", success(x)), ("targets_done", 2.0 * success(x)), ("final_distance", distance(x))];
            curve.hear(env_steps, &episodes(500, &means));
        }
        curve
    }

    /// Odds of success that grow as the third power of the steps.
    fn logistic(x: f64) -> f64 {
        1.0 / (1.0 + (4e6 / x.max(1.0)).powi(3))
    }

    #[test]
    fn a_curve_that_goes_on_as_before_is_foreseen() {
        // It reaches 90 % when the odds are nine.
        let expected = 4e6 * 9.0_f64.cbrt();
        for now in [4_000_000, 5_000_000, 7_000_000] {
            let forecast = (now + curve(now, logistic, |_| 0.1).steps_to(0.9).unwrap()) as f64;
            assert!((forecast / expected - 1.0).abs() < 0.05, "{forecast} {expected}");
        }
        assert_eq!(curve(9_000_000, logistic, |_| 0.1).steps_to(0.9), Some(0), "it is there");
    }

    #[test]
    fn nothing_is_foretold_without_success_or_growth() {
        assert_eq!(curve(4_000_000, |_| 0.0, |_| 0.1).steps_to(0.9), None);
        assert_eq!(curve(4_000_000, |x| 0.5 - x / 1e8, |_| 0.1).steps_to(0.9), None);
        assert_eq!(curve(500_000, logistic, |_| 0.1).steps_to(0.9), None, "too few points");
    }

    #[test]
    fn a_curve_is_flat_when_neither_success_nor_distance_improve() {
        assert!(curve(7_000_000, |_| 0.6, |_| 0.1).flat_for(0.05).is_some_and(|steps| steps >= 6_000_000));
        assert_eq!(curve(7_000_000, |x| 0.5 + x / 5e7, |_| 0.1).flat_for(0.05), None, "success grows");
        assert_eq!(curve(7_000_000, |_| 0.0, |x| 0.5 - x / 5e7).flat_for(0.05), None, "it comes nearer");
        assert_eq!(curve(5_000_000, |_| 0.0, |_| 0.5).flat_for(0.05), None, "too early to tell");
    }

    /// The curve of a user who takes so many seconds after so many million steps, and can do nothing before two.
    fn practised(until: u64, seconds: impl Fn(f64) -> f64) -> Curve {
        let mut curve = Curve::default();
        for env_steps in (16_384..=until).step_by(16_384) {
            let x = env_steps as f64 / 1e6;
            let seconds = if x < 2.0 { 4.0 } else { seconds(x) };
            let means = [("success", f64::from(x >= 2.0)), ("length", 20.0 * seconds), ("return", 10.0 - seconds)];
            curve.hear(env_steps, &episodes(500, &means));
        }
        curve
    }

    /// Control steps after which it is at its plateau for the first time.
    fn plateau(seconds: impl Fn(f64) -> f64 + Copy) -> u64 {
        let is_there = |n: &u64| practised(*n, seconds).trend().is_some_and(|trend| trend.is_plateau());
        (1..200).map(|n| n * 1_000_000).find(is_there).expect("it ends")
    }

    #[test]
    fn four_times_the_steps_of_a_plateau_bring_three_percent() {
        // Power laws of practice: a doubling brings so much less than the one before.
        for (ratio, size) in [(0.65_f64, 0.6), (0.7, 0.5), (0.8, 0.3)] {
            let seconds = |x: f64| 1.0 + size * x.powf(ratio.log2());
            let steps = plateau(seconds);
            let gain = |millions: f64| 1.0 - seconds(4.0 * millions) / seconds(millions);
            let (gained, before) = (gain(steps as f64 / 1e6), gain(steps as f64 / 2e6));
            // Windows lag by an eighth of the steps.
            assert!((0.02..0.031).contains(&gained), "{ratio}: {gained} after {steps}");
            assert!(before > 0.03, "{ratio}: {before} after half of {steps}, which would have been enough");
            let trend = practised(steps / 2, seconds).trend().unwrap();
            assert!((-trend.four_times.episode_time - before).abs() < 0.15 * before, "{trend:?}");
            assert!((1..2 * steps).contains(&trend.steps_left()), "{trend:?}");
        }
    }

    #[test]
    fn who_learns_faster_than_others_is_stopped_later_than_need_be_not_sooner() {
        // Half as much per doubling: smaller than the factors that are believed.
        let seconds = |x: f64| 1.0 + 1.0 / x;
        let steps = plateau(seconds) as f64 / 1e6;
        let gain = |millions: f64| 1.0 - seconds(4.0 * millions) / seconds(millions);
        assert!((0.015..0.03).contains(&gain(steps)) && gain(0.5 * steps) > 0.03, "{steps}");
    }

    /// Twenty trainings of 256 million steps on an H200, 2026-11-22: episodes of the policy without noise, `myo train TASK --seeds 5
    /// --until off --steps 256M`.
    const RECORDED: &str = include_str!("recorded.csv");

    /// Episodes of one recorded training: control steps, and what ended there.
    fn recorded(task: &str, seed: &str) -> Vec<(u64, Episodes)> {
        let rows = RECORDED.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
        let of = rows.filter(|row| row[0] == task && row[1] == seed);
        of.map(|row| {
            let number = |k: usize| row[k].parse::<f64>().unwrap();
            let means = [("success", number(4)), ("length", number(5)), ("return", number(6))];
            (number(2) as u64, episodes(number(3) as u64, &means))
        })
        .collect()
    }

    /// Control steps after which a recorded training is at its plateau, and by what share its episodes become shorter until four
    /// times as many, or the end of the record.
    fn recorded_plateau(task: &str, seed: &str) -> (u64, f64) {
        let (all, mut curve, mut plateau) = (recorded(task, seed), Curve::default(), None);
        for (env_steps, ended) in &all {
            curve.hear(*env_steps, ended);
            let is_there = || curve.trend().is_some_and(|trend| trend.is_plateau());
            if plateau.is_none() && is_there() {
                plateau = Some(*env_steps);
            }
        }
        let plateau = plateau.unwrap_or(all[all.len() - 1].0);
        // A window around it tells where it was, as the mean of its middle.
        let level =
            |env_steps: u64| curve.around(0, (1.14 * env_steps as f64) as u64).expect("it is in the record").length;
        let last = 220_000_000.min(4 * plateau);
        (plateau, 1.0 - level(last.max(plateau)) / level(plateau.min(last)))
    }

    #[test]
    fn recorded_trainings_stop_where_four_times_the_steps_bring_three_percent() {
        for task in ["pointing", "public-display", "ar"] {
            for seed in ["1", "2", "3", "4", "5"] {
                let (plateau, gain) = recorded_plateau(task, seed);
                assert!((45_000_000..170_000_000).contains(&plateau), "{task} {seed}: {plateau}");
                assert!((-0.005..0.035).contains(&gain), "{task} {seed}: {gain} after {plateau}");
            }
        }
        // It goes on and on: by 2 to 3 per cent per doubling to the end of the record.
        for seed in ["1", "2", "3", "4", "5"] {
            let (plateau, gain) = recorded_plateau("mobile-typing", seed);
            assert!(plateau > 55_000_000 && gain < 0.055, "mobile-typing {seed}: {gain} after {plateau}");
        }
    }

    #[test]
    fn rounding_of_a_return_that_gains_nothing_is_no_change() {
        let mut curve = Curve::default();
        for update in 1..=200_u64 {
            let episode_return = 0.1 + f64::EPSILON * update as f64;
            let means = [("success", 1.0), ("length", 20.0), ("return", episode_return)];
            curve.hear(16_384 * update, &episodes(500, &means));
        }
        assert!(curve.trend().unwrap().is_plateau(), "{:?}", curve.trend());
    }

    #[test]
    fn who_becomes_worse_is_at_no_plateau() {
        let seconds = |x: f64| if x < 20.0 { 1.0 } else { 1.0 + 0.01 * (x - 20.0) };
        assert!(practised(20_000_000, seconds).trend().unwrap().is_plateau());
        let trend = practised(35_000_000, seconds).trend().unwrap();
        assert!(!trend.is_plateau() && trend.four_times.episode_time > 0.1, "{trend:?}");
    }

    #[test]
    fn no_trend_is_told_before_there_is_one() {
        let seconds = |x: f64| 1.0 + 1.0 / x;
        assert_eq!(practised(7_900_000, seconds).trend(), None, "it could do nothing two doublings ago");
        assert!(practised(8_600_000, seconds).trend().is_some());
        assert_eq!(curve(9_000_000, |_| 0.0, |_| 0.1).trend(), None, "it can do nothing");
        assert_eq!(curve(100_000, |_| 0.9, |_| 0.1).trend(), None, "too few episodes");
        assert!(curve(9_000_000, |_| 0.9, |_| 0.1).trend().unwrap().is_plateau());
        let grows = curve(9_000_000, |x| 0.5 + x / 5e7, |_| 0.1).trend().unwrap();
        // From 3.9 to 7.9 million, in the middle of the windows.
        assert!(!grows.is_plateau() && (grows.last_doubling.success - 0.079).abs() < 0.003, "{grows:?}");
    }

    #[test]
    fn a_long_training_has_few_points_of_many_episodes() {
        let curve = practised(100_000_000, |_| 1.0);
        assert!(curve.points.len() < 300, "{}", curve.points.len());
        let apart = curve.points.windows(2).map(|pair| pair[1].env_steps - pair[0].env_steps).max();
        assert!(apart.is_some_and(|apart| apart < SPACING_MAX + 16_384), "{apart:?}");
        assert!(curve.points.iter().all(|point| point.episodes >= POINT_EPISODES));
        let heard = curve.points.iter().chain(&curve.next).map(|point| point.episodes).sum::<u64>();
        assert_eq!(heard, 500 * (100_000_000 / 16_384), "every episode counts once");
    }

    #[test]
    fn a_point_is_the_mean_over_its_episodes() {
        let mut curve = Curve::default();
        for (env_steps, count, success) in [(1, 150, 1.0), (2, 50, 0.0)] {
            curve.hear(env_steps, &episodes(count, &[("success", success)]));
        }
        let [point] = &curve.points[..] else { panic!("{curve:?}") };
        assert_eq!((point.env_steps, point.episodes, point.mean.success), (2, 200, 0.75));
    }

    #[test]
    fn a_trend_is_told_in_half_a_sentence() {
        let change = |episode_time, success| Change { episode_time, success, episode_return: 0.0 };
        let trend =
            Trend { env_steps: 1, since: 0, last_doubling: change(-0.081, 0.02), four_times: change(-0.1, 0.0) };
        assert_eq!(
            trend.to_string(),
            "the last doubling of training made episodes 8.1 % shorter and 2.0 % more of them succeed; four times as much \
             would make them about 10.0 % shorter"
        );
        let trend = Trend { last_doubling: change(0.004, 0.0), four_times: change(0.006, 0.0), ..trend };
        assert_eq!(
            trend.to_string(),
            "the last doubling of training made episodes 0.4 % longer; four times as much would make them about 0.6 % longer"
        );
    }

    #[test]
    fn a_curve_of_an_older_checkpoint_is_read() {
        let text = serde_json::to_string(&practised(9_000_000, |x| 1.0 + 1.0 / x)).unwrap();
        let mut older: serde_json::Value = serde_json::from_str(&text).unwrap();
        older.as_object_mut().unwrap().remove("next");
        for point in older["points"].as_array_mut().unwrap() {
            let point = point.as_object_mut().unwrap();
            let mean = point.remove("mean").unwrap();
            point.remove("episodes");
            point.insert("recent".into(), mean);
        }
        let read: Curve = serde_json::from_value(older).unwrap();
        assert!(read.trend().is_some() && read.points.iter().all(|point| point.episodes == 500));
    }

    #[test]
    fn episodes_that_ended_before_all_could_do_not_count() {
        let mut curve = Curve::new(1000);
        curve.hear(999, &episodes(1, &[("success", 1.0)]));
        assert_eq!(curve.recent(), None);
        curve.hear(1000, &episodes(1, &[("success", 1.0)]));
        assert_eq!(curve.recent().unwrap().success, 1.0);
    }

    #[test]
    fn recent_success_follows_with_the_weight_of_500_episodes() {
        let mut curve = Curve::default();
        for (env_steps, success) in [(1, 1.0), (2, 0.0)] {
            curve.hear(env_steps, &episodes(500, &[("success", success)]));
        }
        // 500 newer episodes weigh 1 - 1/e.
        assert!((curve.recent().unwrap().success - (-1.0_f64).exp()).abs() < 1e-15);
        let text = serde_json::to_string(&curve).unwrap();
        assert_eq!(serde_json::from_str::<Curve>(&text).unwrap(), curve);
    }

    #[test]
    fn what_came_after_a_step_is_forgotten() {
        let mut curve = curve(4_000_000, logistic, |_| 0.1);
        let before = curve.recent().unwrap().success;
        curve.cut(2_000_000);
        assert!(curve.recent().unwrap().success < before);
        assert!(curve.points.iter().all(|point| point.env_steps <= 2_000_000));
    }
}
