//! Progress of training, on standard error.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use myo::ProgressLine;
use myo::tasks::Task;
use myo::train::session;

use crate::cli::failure::complain;

/// Time between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// A bar on a terminal, a line every few seconds elsewhere.
pub struct Progress {
    bar: Option<ProgressBar>,
    /// What its lines begin with.
    name: String,
    line: ProgressLine,
    last_line: Instant,
}

impl Progress {
    /// For a training of one or several layouts, of at most `limit` control steps.
    pub fn new(layouts: &[Task], limit: u64) -> Self {
        Self::with(String::new(), layouts, limit, bar)
    }

    /// For one of several trainings at once.
    pub fn among(all: &MultiProgress, name: &str, layouts: &[Task], limit: u64) -> Self {
        Self::with(format!("{name}: "), layouts, limit, |limit| all.add(bar(limit)))
    }

    fn with(name: String, layouts: &[Task], limit: u64, bar: impl FnOnce(u64) -> ProgressBar) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| bar(limit));
        Self { bar, name, line: ProgressLine::new(layouts, limit), last_line: Instant::now() }
    }

    /// Shows an update.
    pub fn show(&mut self, progress: &session::Progress) {
        let Some((line, metrics)) = self.line.after(progress).zip(progress.metrics.as_ref()) else { return };
        let line = format!("{}{line}", self.name);
        if let Some(bar) = &self.bar {
            bar.set_position(metrics.env_steps);
            bar.set_message(line);
        } else if self.last_line.elapsed() >= LINE_EVERY {
            self.last_line = Instant::now();
            complain(&line);
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
