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
    let mut line = |quantity: &str, value: Option<String>| {
        if let Some(value) = value {
            text += &format!("  {quantity:<14}  {value}\n");
        }
    };
    line("final distance", evaluation.final_distance_m.map(|m| format!("{:.1} cm", 100.0 * m)));
    line("effort", evaluation.effort.map(|effort| format!("{effort:.4} (mean squared muscle control)")));
    line("episode", evaluation.episode_length_s.map(|s| format!("{s:.2} s")));
    line("return", evaluation.episode_return.map(|x| format!("{x:.2}")));
    text
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
    let mut rows = vec![row(["target", "success", "movement time", "sd"])];
    rows.extend(evaluation.targets.iter().enumerate().map(|(index, target)| {
        let seconds = |s: Option<f64>| s.map_or("-".into(), |s| format!("{s:.2} s"));
        vec![
            (index + 1).to_string(),
            percent(target.success),
            seconds(target.movement_time_s),
            seconds(target.movement_time_s_sd),
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
