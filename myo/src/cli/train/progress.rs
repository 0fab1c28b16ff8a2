//! Progress of training, on standard error.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use myo::train::{UpdateMetrics, session};

use crate::cli::failure::complain;
use crate::cli::output::{duration, percent, rounded};

/// Time between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Share of a new rate in the one shown.
const FRESH: f64 = 0.1;

/// A bar on a terminal, a line every few seconds elsewhere.
pub struct Progress {
    bar: Option<ProgressBar>,
    /// What its lines begin with.
    name: String,
    limit: u64,
    rate: Option<f64>,
    last_line: Instant,
}

impl Progress {
    /// For a training of at most `limit` control steps.
    pub fn new(limit: u64) -> Self {
        Self::with(String::new(), limit, bar)
    }

    /// For one of several trainings at once.
    pub fn among(all: &MultiProgress, seed: u64, limit: u64) -> Self {
        Self::with(format!("seed {seed}: "), limit, |limit| all.add(bar(limit)))
    }

    fn with(name: String, limit: u64, bar: impl FnOnce(u64) -> ProgressBar) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| bar(limit));
        Self { bar, name, limit, rate: None, last_line: Instant::now() }
    }

    /// Shows an update.
    pub fn show(&mut self, progress: &session::Progress) {
        let Some(metrics) = &progress.metrics else { return };
        let now = metrics.steps_per_s();
        let rate = self.rate.map_or(now, |rate| rate + FRESH * (now - rate));
        self.rate = Some(rate);
        if let Some(bar) = &self.bar {
            bar.set_position(metrics.env_steps);
            bar.set_message(self.sentence(progress, metrics, rate));
        } else if self.last_line.elapsed() >= LINE_EVERY {
            self.last_line = Instant::now();
            complain(&self.sentence(progress, metrics, rate));
        }
    }

    /// Tells something that is to stay on the screen.
    pub fn tell(&self, text: &str) {
        let text = &format!("{}{text}", self.name);
        match &self.bar {
            Some(bar) => bar.suspend(|| complain(text)),
            None => complain(text),
        }
    }

    fn sentence(&self, progress: &session::Progress, metrics: &UpdateMetrics, rate: f64) -> String {
        let mean = |x: Option<f64>, show: fn(f64) -> String| x.map_or("-".into(), show);
        let limit = self.limit.saturating_sub(metrics.env_steps);
        let left = match progress.steps_left {
            Some(0) => "close to the goal".into(),
            Some(steps) if steps < limit => format!("about {} left", duration(steps as f64 / rate)),
            _ => format!("at most {} left", duration(limit as f64 / rate)),
        };
        format!(
            "{}{} steps, {}/s, success {}, return {}, {left}",
            self.name,
            rounded(metrics.env_steps as f64),
            rounded(rate),
            mean(progress.success, percent),
            mean(metrics.episode_mean("return"), |x| format!("{x:.1}")),
        )
    }
}

impl Drop for Progress {
    /// Takes the bar away.
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar(limit: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:10} {wide_msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(limit).with_style(style)
}
