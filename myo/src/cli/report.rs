//! Evaluations for people.

use myo::train::Evaluation;
use myo::train::session::Trend;

use super::output::{grouped, name, percent, row, table};

/// A short report; lines of the same form may be added.
pub fn evaluation(task: &str, evaluation: &Evaluation) -> String {
    let mut text = format!("{}\n", headline(task, evaluation));
    if !evaluation.targets.is_empty() {
        text += &format!("\n{}\n", targets(evaluation));
    }
    let mut line = |quantity: &str, value: Option<f64>, interval, kind: &Kind| {
        if let Some(value) = value {
            text += &format!("  {quantity:<14}  {}\n", kind.text(value, interval));
        }
    };
    let (distance, effort, length) = (evaluation.final_distance_m, evaluation.effort, evaluation.episode_length_s);
    line("final distance", distance, evaluation.final_distance_m_interval, &CENTIMETRES);
    line("effort", effort, evaluation.effort_interval, &EFFORT);
    line("episode", length, evaluation.episode_length_s_interval, &SECONDS);
    line("return", evaluation.episode_return, evaluation.episode_return_interval, &RETURN);
    text + NOTE
}

/// What the numbers mean.
const NOTE: &str = "  in brackets     95 % confidence interval of the mean\n  movement time   from the start of the target to the last \
                    entry or the touch, without dwell\n";

/// How a kind of quantity is written.
struct Kind {
    /// Of the unit that is shown in the one that the quantity has.
    factor: f64,
    digits: usize,
    unit: &'static str,
}

const CENTIMETRES: Kind = Kind { factor: 100.0, digits: 2, unit: " cm" };
const EFFORT: Kind = Kind { factor: 1.0, digits: 4, unit: " mean squared muscle control" };
const SECONDS: Kind = Kind { factor: 1.0, digits: 3, unit: " s" };
const RETURN: Kind = Kind { factor: 1.0, digits: 2, unit: "" };
const PERCENT: Kind = Kind { factor: 100.0, digits: 1, unit: " %" };

impl Kind {
    /// `0.812 s [0.801, 0.823]`.
    fn text(&self, value: f64, interval: Option<[f64; 2]>) -> String {
        let Self { factor, digits, unit } = self;
        let number = |x: f64| format!("{:.digits$}", factor * x);
        let interval = interval.map_or(String::new(), |ends| format!(" [{}]", ends.map(number).join(", ")));
        format!("{}{unit}{interval}", number(value))
    }
}

fn headline(task: &str, evaluation: &Evaluation) -> String {
    let episodes = grouped(evaluation.episodes);
    let success = evaluation.success.map_or("-".into(), percent);
    let interval = evaluation
        .success_interval
        .map_or(String::new(), |[low, high]| format!(" (95 % interval {:.1} to {:.1} %)", 100.0 * low, 100.0 * high));
    let task = name(task);
    format!("{task}: {success} of {episodes} fresh episodes succeeded{interval}")
}

fn targets(evaluation: &Evaluation) -> String {
    let mut rows = vec![row(["target", "success", "movement time", "sd", "with dwell"])];
    rows.extend(evaluation.targets.iter().enumerate().map(|(index, target)| {
        let seconds = |s: Option<f64>, interval| s.map_or("-".into(), |s| SECONDS.text(s, interval));
        vec![
            (index + 1).to_string(),
            PERCENT.text(target.success, target.success_interval),
            seconds(target.movement_time_s, target.movement_time_s_interval),
            seconds(target.movement_time_s_sd, None),
            seconds(target.time_s, target.time_s_interval),
        ]
    }));
    table(&rows)
}

/// Whether the user had finished learning.
pub fn practice(trend: Option<Trend>) -> String {
    let sentence = match trend {
        Some(trend) if trend.is_plateau() => format!("at its plateau: {trend}"),
        Some(trend) => format!("still improving: {trend}"),
        None => "too short to tell whether it was still improving".into(),
    };
    format!("  practice        {sentence}\n")
}
