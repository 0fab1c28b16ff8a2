//! One line on how a training goes, for terminals and Python alike.

use myo_tasks::Task;
use myo_train::session::{Bottleneck, LeastLayout, Progress};

use crate::layouts::layout_names;

/// Share of a new rate in the one shown.
const FRESH: f64 = 0.1;

/// Control steps of all environments per second, smoothed over some updates.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rate(Option<f64>);

impl Rate {
    /// The rate after an update that had this one.
    pub fn after(&mut self, now: f64) -> f64 {
        let rate = self.0.map_or(now, |rate| rate + FRESH * (now - rate));
        self.0 = Some(rate);
        rate
    }

    /// The rate so far; none before the first update.
    pub fn get(self) -> Option<f64> {
        self.0
    }
}

/// The learning curve foretells the time left to such a factor.
const UNSURE: f64 = 2.0;

/// A target that is done so often is no bottleneck.
const NEARLY_ALWAYS: f64 = 0.99;

/// Times that people plan by: these many seconds or minutes.
const ROUND: [u32; 18] = [1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 35, 40, 45, 50, 55];

/// Follows a training and says in one line how it goes.
#[derive(Clone, Debug)]
pub struct ProgressLine {
    limit: u64,
    control_dt_s: f64,
    targets: Vec<String>,
    layouts: Vec<String>,
    rate: Rate,
}

impl ProgressLine {
    /// For a training of one or several layouts that ends after `limit` control steps at the latest.
    pub fn new(layouts: &[Task], limit: u64) -> Self {
        // A task that cannot be trained has no line of progress either.
        let flat = layouts.first().and_then(|task| task.flat().ok()).unwrap_or_default();
        let targets = (0..flat.steps.len()).map(|step| flat.label(step)).collect();
        let control_dt_s = layouts.first().map_or(f64::NAN, |task| task.control_dt_s);
        Self { limit, control_dt_s, targets, layouts: layout_names(layouts), rate: Rate::default() }
    }

    /// Control steps, their rate, success, also in the layout where it is least if there are several, and mean duration of training episodes, the target that is missed most, and the time left; none where there
    /// was no update.
    pub fn after(&mut self, progress: &Progress) -> Option<String> {
        let metrics = progress.metrics.as_ref()?;
        let rate = self.rate.after(metrics.steps_per_s());
        let seconds = |steps: u64| steps as f64 / rate;
        let limit = self.limit.saturating_sub(metrics.env_steps);
        Some(format!(
            "{} steps, {}/s, success {}{}, episodes of {}{}, {}",
            rounded(metrics.env_steps as f64),
            rounded(rate),
            progress.success.map_or("-".into(), |share| format!("{:.1} %", 100.0 * share)),
            progress.least.and_then(|least| self.least(least)).unwrap_or_default(),
            metrics.episodes.mean("length").map_or("-".into(), |steps| format!("{:.2} s", self.control_dt_s * steps)),
            progress.bottleneck.and_then(|bottleneck| self.named(bottleneck)).unwrap_or_default(),
            time_left(progress.steps_left.map(seconds), seconds(limit)),
        ))
    }

    /// The layout that is done least, where there are several.
    fn least(&self, LeastLayout { layout, success }: LeastLayout) -> Option<String> {
        Some(format!(" (least in {}: {:.1} %)", self.layouts.get(layout)?, 100.0 * success))
    }

    /// The target that is missed most, where there are several.
    fn named(&self, bottleneck: Bottleneck) -> Option<String> {
        let target = self.targets.get(bottleneck.target).filter(|_| self.targets.len() > 1)?;
        if bottleneck.success > NEARLY_ALWAYS {
            return None;
        }
        Some(format!(", bottleneck {target} at {:.0} %", 100.0 * bottleneck.success))
    }
}

/// How long a training still takes, from what the learning curve foretells, if it does, and the time until the limit of
/// steps: a range with a cautious upper end, or that alone.
pub fn time_left(foretold_s: Option<f64>, limit_s: f64) -> String {
    let Some(foretold_s) = foretold_s.filter(|seconds| seconds / UNSURE < limit_s) else {
        // Without a rate nobody can tell.
        let limit = limit_s.is_finite().then(|| Time::at_least(limit_s));
        return limit.map_or("time left not known yet".into(), |limit| format!("at most {limit} left"));
    };
    if foretold_s == 0.0 {
        return "close to the goal".into();
    }
    let (from, to) = (Time::at_most(foretold_s / UNSURE), Time::at_least((foretold_s * UNSURE).min(limit_s)));
    match from {
        Some(from) if from.unit == to.unit && from.count < to.count => format!("{} to {to} left", from.count),
        Some(from) if from.unit != to.unit => format!("{from} to {to} left"),
        _ => format!("at most {to} left"),
    }
}

/// A round number of seconds, minutes or hours.
#[derive(Clone, Copy)]
struct Time {
    count: u32,
    unit: &'static str,
}

impl Time {
    /// The longest round time that is not longer; none below a second.
    fn at_most(seconds: f64) -> Option<Self> {
        let (whole, unit) = match seconds {
            3600.0.. => return Some(Self { count: (seconds / 3600.0) as u32, unit: "h" }),
            60.0.. => (seconds / 60.0, "min"),
            _ => (seconds, "s"),
        };
        ROUND.iter().rev().find(|&&count| f64::from(count) <= whole).map(|&count| Self { count, unit })
    }

    /// The shortest round time that is not shorter.
    fn at_least(seconds: f64) -> Self {
        let of = |whole: f64, unit| {
            ROUND.iter().find(|&&count| f64::from(count) >= whole).map(|&count| Self { count, unit })
        };
        let hours = || Self { count: (seconds / 3600.0).ceil() as u32, unit: "h" };
        of(seconds, "s").or_else(|| of(seconds / 60.0, "min")).unwrap_or_else(hours)
    }
}

impl std::fmt::Display for Time {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.count, self.unit)
    }
}

/// A count or rate with three significant digits: `12.3 k`, `4.56 M`.
pub fn rounded(x: f64) -> String {
    let (x, unit) = match x.abs() {
        size if size >= 999.5e6 => (x / 1e9, " G"),
        size if size >= 999.5e3 => (x / 1e6, " M"),
        size if size >= 999.5 => (x / 1e3, " k"),
        _ => (x, ""),
    };
    let digits = if x.abs() >= 99.95 { 0 } else { 2 - usize::from(x.abs() >= 9.995) };
    format!("{x:.digits$}{unit}")
}

#[cfg(test)]
mod tests {
    use myo_tasks::preset;
    use myo_train::{Episodes, UpdateMetrics};

    use super::*;

    #[test]
    fn the_time_left_is_a_round_range_that_holds_twice_and_half_of_what_is_foretold() {
        let day = 86_400.0;
        assert_eq!(time_left(Some(90.0), day), "45 s to 3 min left");
        assert_eq!(time_left(Some(130.0), day), "1 to 5 min left");
        assert_eq!(time_left(Some(14.0), day), "6 to 30 s left");
        assert_eq!(time_left(Some(0.7), day), "at most 2 s left");
        assert_eq!(time_left(Some(7000.0), day), "55 min to 4 h left");
        assert_eq!(time_left(Some(130.0), 150.0), "1 to 3 min left", "the limit of steps comes first");
        assert_eq!(time_left(Some(130.0), 40.0), "at most 40 s left");
        assert_eq!(time_left(None, 1900.0), "at most 35 min left");
        assert_eq!(time_left(Some(0.0), day), "close to the goal");
        assert_eq!(time_left(Some(f64::NAN), f64::INFINITY), "time left not known yet");
    }

    #[test]
    fn the_line_names_the_bottleneck_as_the_task_does() {
        let episodes = Episodes { count: 9, means: vec![("length".into(), 31.0)] };
        let metrics = UpdateMetrics { env_steps: 1_000_000, episodes, ..UpdateMetrics::default() };
        let bottleneck = Some(Bottleneck { target: 2, success: 0.625 });
        let progress = Progress { metrics: Some(metrics), success: Some(0.4), bottleneck, ..Progress::default() };
        let line = |name| ProgressLine::new(&[preset(name).unwrap()], 60_000_000).after(&progress).unwrap();
        let text = line("mobile-typing");
        assert!(text.contains("1.00 M steps") && text.contains("success 40.0 %"), "{text}");
        assert!(text.contains(", episodes of 1.24 s, "), "{text}");
        assert!(text.contains(", bottleneck dwell in letter.3 at 62 %, "), "{text}");
        assert!(!line("pointing-single").contains("bottleneck"), "the only target is no news");
        assert_eq!(ProgressLine::new(&[preset("ar").unwrap()], 1).after(&Progress::default()), None);
    }
}
