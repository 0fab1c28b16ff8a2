//! The learning curve: how training success grew, where it leads, and whether it grows at all.

use serde::{Deserialize, Serialize};

use super::trend::Trend;
use crate::UpdateMetrics;

/// Episodes over which success is averaged.
const MEMORY: f64 = 500.0;

/// A target counts once this share of episodes gets to it.
const HARDLY_ANY: f64 = 0.02;

/// Targets whose success differs by less are alike.
const TIE: f64 = 0.02;

/// Control steps between two points that are kept.
const SPACING: u64 = 65_536;

/// Points that a forecast needs; it looks back on half of all.
const FORECAST_POINTS: usize = 12;

/// Points that must not have brought anything for a curve to be flat: six million control steps.
const FLAT_POINTS: usize = 93;

/// Share by which success, targets done or distance must have improved for it not to be flat.
const WORTH: f64 = 0.03;

/// Points that the older half of a trend needs.
const TREND_POINTS: usize = 8;

/// What is known of recent episodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recent {
    /// Share that succeeded.
    pub success: f64,
    /// Targets done.
    pub targets_done: f64,
    /// Distance to the last target at the end, in metres.
    pub final_distance: f64,
    /// Control steps of an episode.
    pub length: f64,
    /// Sum of its rewards.
    #[serde(rename = "return")]
    pub episode_return: f64,
    /// Share of episodes in which each target was done.
    pub target_success: Vec<f64>,
}

/// The target at which a training makes least headway.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bottleneck {
    /// Index of the target, from 0.
    pub target: usize,
    /// Share of the episodes that get to it in which it is done.
    pub success: f64,
}

impl Recent {
    /// Of the episodes that ended in an update; none if none ended. All numbers are finite.
    fn of(metrics: &UpdateMetrics) -> Option<Self> {
        let mean = |name: &str| metrics.episode_mean(name).filter(|mean| mean.is_finite());
        Some(Self {
            success: mean("success")?,
            targets_done: mean("targets_done").unwrap_or(0.0),
            final_distance: mean("final_distance").unwrap_or(0.0),
            length: mean("length").unwrap_or(0.0),
            episode_return: mean("return").unwrap_or(0.0),
            target_success: (1..).map_while(|k| mean(&format!("target_{k}_success"))).collect(),
        })
    }

    /// The earliest of the targets that the fewest of the episodes that get to them do; none before an episode has ended,
    /// or where all is done. Targets that hardly any episode gets to do not count.
    pub fn bottleneck(&self) -> Option<Bottleneck> {
        let before = [1.0].into_iter().chain(self.target_success.iter().copied());
        let reached = before.zip(&self.target_success).enumerate().filter(|(_, (before, _))| *before >= HARDLY_ANY);
        let shares = reached.map(|(target, (before, after))| Bottleneck { target, success: after / before });
        let least = |least: Bottleneck, next: Bottleneck| if next.success < least.success - TIE { next } else { least };
        shares.reduce(least).filter(|bottleneck| bottleneck.success < 1.0)
    }

    fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let Self { success, targets_done, final_distance, length, episode_return, target_success } = self;
        [success, targets_done, final_distance, length, episode_return].into_iter().chain(target_success)
    }

    /// Moves towards newer episodes.
    fn follow(&mut self, mut newer: Self, weight: f64) {
        self.numbers().zip(newer.numbers()).for_each(|(x, y)| *x += weight * (*y - *x));
    }
}

/// One point of the curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    env_steps: u64,
    recent: Recent,
}

/// The curve so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Control steps before which episodes do not count.
    start: u64,
    recent: Option<Recent>,
    points: Vec<Point>,
}

impl Curve {
    /// Nothing known yet. Episodes that end before `start` control steps do not count: the first ones to end are short,
    /// and short ones are mostly successes.
    pub fn new(start: u64) -> Self {
        Self { start, ..Self::default() }
    }

    /// Hears of an update.
    pub fn hear(&mut self, metrics: &UpdateMetrics) {
        if metrics.env_steps < self.start {
            return;
        }
        let Some(newer) = Recent::of(metrics) else { return };
        let weight = 1.0 - (-(metrics.episodes as f64) / MEMORY).exp();
        let recent = self.recent.get_or_insert_with(|| newer.clone());
        recent.follow(newer, weight);
        if self.points.last().is_none_or(|last| metrics.env_steps >= last.env_steps + SPACING) {
            self.points.push(Point { env_steps: metrics.env_steps, recent: recent.clone() });
        }
    }

    /// Forgets what came after `env_steps`.
    pub fn cut(&mut self, env_steps: u64) {
        self.points.retain(|point| point.env_steps <= env_steps);
        self.recent = self.points.last().map(|point| point.recent.clone());
    }

    /// Recent episodes, if any has ended.
    pub fn recent(&self) -> Option<&Recent> {
        self.recent.as_ref()
    }

    /// Control steps until training success is `goal`, if it goes on as it did lately; none where nobody can tell.
    ///
    /// The log-odds of success grow about as the logarithm of the steps does, so a line is fitted to them.
    pub fn steps_to(&self, goal: f64) -> Option<u64> {
        let back = (self.points.len() / 2).max(FORECAST_POINTS);
        let points = &self.points[self.points.len().checked_sub(back)?..];
        if points.iter().any(|point| point.recent.success < 0.01) {
            return None;
        }
        let x = |point: &Point| (point.env_steps.max(1) as f64).ln();
        let y = |point: &Point| log_odds(point.recent.success);
        let last = points.last()?;
        let (slope, now) = line(points.iter().map(|point| (x(point), y(point))), x(last));
        let left = ((log_odds(goal) - now) / slope).max(0.0).exp_m1() * last.env_steps as f64;
        (slope > 0.0 && left.is_finite()).then_some(left as u64)
    }

    /// What the last doubling brought; none before the user could do what it can do now half as often, two doublings ago.
    pub fn trend(&self) -> Option<Trend> {
        let (first, last) = (self.points.first()?, self.points.last()?);
        let now = last.env_steps;
        let since = |env_steps: u64| self.points.partition_point(|point| point.env_steps <= env_steps);
        let (older, newer) = (&self.points[since(now / 4)..since(now / 2)], &self.points[since(now / 2)..]);
        let learnt = self.points.iter().find(|point| 2.0 * point.recent.success >= last.recent.success)?;
        if older.len() < TREND_POINTS || last.recent.success < 0.01 || learnt.env_steps > now / 4 {
            return None;
        }
        let change = |f| mean(newer, f) - mean(older, f);
        let (length, gained) =
            (mean(older, |r| r.length), mean(newer, |r| r.episode_return) - first.recent.episode_return);
        let share = |change: f64, of: f64| if of > 0.0 { change / of } else { 0.0 };
        Some(Trend {
            env_steps: now,
            episode_time: share(change(|r| r.length), length),
            success: change(|r| r.success),
            episode_return: share(change(|r| r.episode_return), gained),
        })
    }

    /// Whether success, targets done and distance have not improved for long; since how many control steps.
    pub fn flat_for(&self) -> Option<u64> {
        let window = &self.points[self.points.len().checked_sub(FLAT_POINTS)?..];
        let third = FLAT_POINTS / 3;
        let change = |f| mean(&window[FLAT_POINTS - third..], f) - mean(&window[..third], f);
        let targets = window[0].recent.target_success.len().max(1) as f64;
        let distance = mean(&window[..third], |recent| recent.final_distance);
        let grows = change(|recent| recent.success) > WORTH
            || change(|recent| recent.targets_done) > WORTH * targets
            || change(|recent| recent.final_distance) < -WORTH * distance;
        (!grows).then(|| window[FLAT_POINTS - 1].env_steps - window[0].env_steps)
    }
}

/// Mean of a quantity over points.
fn mean(points: &[Point], f: fn(&Recent) -> f64) -> f64 {
    points.iter().map(|point| f(&point.recent)).sum::<f64>() / points.len() as f64
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
    use super::*;

    /// The curve after updates with `success` and `distance` as functions of the control steps.
    fn curve(until: u64, success: impl Fn(f64) -> f64, distance: impl Fn(f64) -> f64) -> Curve {
        let mut curve = Curve::default();
        for env_steps in (0..until).step_by(16_384) {
            let x = env_steps as f64;
            let means = [("success", success(x)), ("targets_done", 2.0 * success(x)), ("final_distance", distance(x))];
            curve.hear(&UpdateMetrics {
                env_steps,
                episodes: 500,
                episode_means: means.map(|(name, mean)| (name.to_owned(), mean)).to_vec(),
                ..UpdateMetrics::default()
            });
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
        assert!(curve(7_000_000, |_| 0.6, |_| 0.1).flat_for().is_some_and(|steps| steps >= 6_000_000));
        assert_eq!(curve(7_000_000, |x| 0.5 + x / 5e7, |_| 0.1).flat_for(), None, "success grows");
        assert_eq!(curve(7_000_000, |_| 0.0, |x| 0.5 - x / 5e7).flat_for(), None, "it comes nearer");
        assert_eq!(curve(5_000_000, |_| 0.0, |_| 0.5).flat_for(), None, "too early to tell");
    }

    /// The curve of a user whose time per episode falls by a power law of practice towards a second.
    fn practised(until: u64, power: f64) -> Curve {
        let mut curve = Curve::default();
        for env_steps in (SPACING..=until).step_by(SPACING as usize) {
            let x = env_steps as f64 / 1e6;
            let seconds = if x < 2.0 { 4.0 } else { 1.0 + x.powf(-power) };
            let means = [("success", f64::from(x >= 2.0)), ("length", 20.0 * seconds), ("return", 10.0 - seconds)];
            curve.hear(&UpdateMetrics {
                env_steps,
                episodes: 100_000,
                episode_means: means.map(|(name, mean)| (name.to_owned(), mean)).to_vec(),
                ..UpdateMetrics::default()
            });
        }
        curve
    }

    #[test]
    fn four_times_the_steps_of_a_plateau_bring_at_most_three_percent() {
        for power in [0.6, 1.0, 1.5] {
            let stops = |n: &u64| practised(*n, power).trend().is_some_and(|trend| trend.is_plateau());
            let plateau = (1..400).map(|n| n * 1_000_000).find(stops).expect("it ends");
            let seconds = |env_steps: u64| 1.0 + (env_steps as f64 / 1e6).powf(-power);
            let gain = 1.0 - seconds(4 * plateau) / seconds(plateau);
            assert!((0.005..0.03).contains(&gain), "{power}: {gain} after {plateau}");
            // Half as many steps would not have been enough for so much certainty.
            let before = practised(plateau / 2, power).trend().unwrap();
            assert!(!before.is_plateau() && before.steps_left() > plateau / 8, "{before:?}");
        }
    }

    #[test]
    fn no_trend_is_told_before_there_is_one() {
        assert_eq!(practised(7_900_000, 1.0).trend(), None, "it could do nothing two doublings ago");
        assert!(practised(8_200_000, 1.0).trend().is_some());
        assert_eq!(curve(9_000_000, |_| 0.0, |_| 0.1).trend(), None, "it can do nothing");
        assert_eq!(curve(1_000_000, |_| 0.9, |_| 0.1).trend(), None, "too few points");
        assert!(curve(9_000_000, |_| 0.9, |_| 0.1).trend().unwrap().is_plateau());
        let grows = curve(9_000_000, |x| 0.5 + x / 5e7, |_| 0.1).trend().unwrap();
        assert!(!grows.is_plateau() && (grows.success - 0.0675).abs() < 0.003, "{grows:?}");
    }

    #[test]
    fn a_trend_is_told_in_half_a_sentence() {
        let trend = Trend { env_steps: 1, episode_time: -0.081, success: 0.02, episode_return: 0.0 };
        assert_eq!(
            trend.to_string(),
            "the last doubling of training made episodes 8.1 % shorter and 2.0 % more of them succeed"
        );
        let trend = Trend { episode_time: 0.004, success: 0.0, ..trend };
        assert_eq!(trend.to_string(), "the last doubling of training made episodes 0.4 % longer");
    }

    #[test]
    fn episodes_that_ended_before_all_could_do_not_count() {
        let mut curve = Curve::new(1000);
        let update = |env_steps| UpdateMetrics {
            env_steps,
            episodes: 1,
            episode_means: vec![("success".into(), 1.0)],
            ..UpdateMetrics::default()
        };
        curve.hear(&update(999));
        assert_eq!(curve.recent(), None);
        curve.hear(&update(1000));
        assert_eq!(curve.recent().unwrap().success, 1.0);
    }

    #[test]
    fn recent_success_follows_with_the_weight_of_500_episodes() {
        let mut curve = Curve::default();
        for (env_steps, success) in [(1, 1.0), (2, 0.0)] {
            let episode_means = vec![("success".to_owned(), success)];
            curve.hear(&UpdateMetrics { env_steps, episodes: 500, episode_means, ..UpdateMetrics::default() });
        }
        // 500 newer episodes weigh 1 - 1/e.
        assert!((curve.recent().unwrap().success - (-1.0_f64).exp()).abs() < 1e-15);
        let text = serde_json::to_string(&curve).unwrap();
        assert_eq!(serde_json::from_str::<Curve>(&text).unwrap(), curve);
    }

    #[test]
    fn the_bottleneck_is_the_earliest_target_that_fails_most_of_those_who_get_there() {
        let bottleneck = |target_success: &[f64]| {
            let target_success = target_success.to_vec();
            Recent {
                success: 0.0,
                targets_done: 0.0,
                final_distance: 0.0,
                length: 0.0,
                episode_return: 0.0,
                target_success,
            }
            .bottleneck()
        };
        let at = |target, success| Some(Bottleneck { target, success });
        assert_eq!(bottleneck(&[0.5, 0.1]), at(1, 0.2), "fewer fail there, but of fewer");
        assert_eq!(bottleneck(&[0.5, 0.25, 0.125]), at(0, 0.5), "the earliest of equals");
        assert_eq!(bottleneck(&[0.25, 0.2475, 0.125]), at(0, 0.25));
        assert_eq!(bottleneck(&[0.004, 0.0]), at(0, 0.004), "what nobody gets to is not to blame");
        assert_eq!(bottleneck(&[1.0, 1.0]), None);
        assert_eq!(bottleneck(&[]), None);
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
