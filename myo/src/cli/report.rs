//! Evaluations for people.

use myo::layout_names;
use myo::tasks::{Action, Step, Task};
use myo::train::Evaluation;
use myo::train::session::Trend;
use serde_json::Value;

use super::failure::Result;
use super::output::{grouped, name, percent, row, table};

/// A short report on one or several layouts; lines of the same form may be added.
pub fn evaluation(layouts: &[Task], evaluation: &Evaluation) -> String {
    match layouts {
        [task] => of_task(task, evaluation),
        several => of_layouts(&layout_names(several), evaluation),
    }
}

/// As JSON, where each of several layouts has its name as `task`.
pub fn json(layouts: &[Task], evaluation: &Evaluation) -> Result<Value> {
    let mut value = serde_json::to_value(evaluation)?;
    let told = value.get_mut("layouts").and_then(Value::as_array_mut).into_iter().flatten();
    for (layout, name) in told.zip(layout_names(layouts)) {
        layout["task"] = name.into();
    }
    Ok(value)
}

/// Each layout in a row, and the mean.
fn of_layouts(names: &[String], evaluation: &Evaluation) -> String {
    let cells = |layout: &str, evaluation: &Evaluation| {
        let cell = |value: Option<f64>, interval, kind: &Kind| value.map_or("-".into(), |x| kind.text(x, interval));
        vec![
            name(layout),
            cell(evaluation.success, evaluation.success_interval, &PERCENT),
            cell(evaluation.episode_length_s, evaluation.episode_length_s_interval, &SECONDS),
            cell(evaluation.final_distance_m, evaluation.final_distance_m_interval, &CENTIMETRES),
            cell(evaluation.effort, evaluation.effort_interval, &Kind { unit: "", ..EFFORT }),
            cell(evaluation.fatigue, evaluation.fatigue_interval, &Kind { unit: " %", ..FATIGUE }),
        ]
    };
    let heading = row(["layout", "success", "episode", "final distance", "effort", "fatigue"]);
    let mut rows: Vec<_> = [heading].into_iter().collect();
    rows.extend(names.iter().zip(&evaluation.layouts).map(|(layout, evaluation)| cells(layout, evaluation)));
    rows.push(cells("mean", evaluation));
    let head = headline(&format!("{} layouts", names.len()), evaluation);
    format!("{head}\n\n{}\n{LAYOUTS_NOTE}", table(&rows))
}

fn of_task(task: &Task, evaluation: &Evaluation) -> String {
    let mut text = format!("{}\n", headline(&task.name, evaluation));
    if !evaluation.targets.is_empty() {
        text += &format!("\n{}\n", targets(task, evaluation));
    }
    let mut line = |quantity: &str, value: Option<f64>, interval, kind: &Kind| {
        if let Some(value) = value {
            text += &format!("  {quantity:<14}  {}\n", kind.text(value, interval));
        }
    };
    let (distance, effort, length) = (evaluation.final_distance_m, evaluation.effort, evaluation.episode_length_s);
    line("final distance", distance, evaluation.final_distance_m_interval, &CENTIMETRES);
    line("effort", effort, evaluation.effort_interval, &EFFORT);
    line("fatigue", evaluation.fatigue, evaluation.fatigue_interval, &FATIGUE);
    let wrong = evaluation.wrong_presses.filter(|_| has(task, |step| step.dwell_s().is_none()));
    line("wrong presses", wrong, evaluation.wrong_presses_interval, &PER_EPISODE);
    let exits = evaluation.exits.filter(|_| has(task, |step| matches!(step.action, Action::Steer { .. })));
    line("exits", exits, evaluation.exits_interval, &PER_EPISODE);
    line("on target", evaluation.on_target, evaluation.on_target_interval, &OF_THE_TIME);
    line("tracking error", evaluation.tracking_error_m, evaluation.tracking_error_m_interval, &CENTIMETRES);
    line("episode", length, evaluation.episode_length_s_interval, &SECONDS);
    line("return", evaluation.episode_return, evaluation.episode_return_interval, &RETURN);
    text + NOTE
}

/// What the numbers mean.
const NOTE: &str = "  in brackets     95 % confidence interval of the mean\n  movement time   from the start of the target to the last \
                    entry or the touch, without dwell\n  fatigue         what of the strength of all muscles fatigues, without what recovers \
                    (3CC-r)\n";

/// The same where there are several layouts.
const LAYOUTS_NOTE: &str =
    "  in brackets     95 % confidence interval of the mean\n  targets         of each layout: --json\n";

/// How a kind of quantity is written.
struct Kind {
    /// Of the unit that is shown in the one that the quantity has.
    factor: f64,
    digits: usize,
    unit: &'static str,
}

const CENTIMETRES: Kind = Kind { factor: 100.0, digits: 2, unit: " cm" };
const EFFORT: Kind = Kind { factor: 1.0, digits: 4, unit: " mean squared muscle control" };
const OF_THE_TIME: Kind = Kind { factor: 100.0, digits: 1, unit: " % of the time of tracking" };
const FATIGUE: Kind = Kind { factor: 100.0, digits: 3, unit: " % of muscle strength per episode" };
const PER_EPISODE: Kind = Kind { factor: 1.0, digits: 3, unit: " per episode" };
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

/// Whether a task asks for anything of a kind.
fn has(task: &Task, is_it: impl Fn(&Step) -> bool) -> bool {
    task.flat().is_ok_and(|flat| flat.steps.iter().any(is_it))
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

fn targets(task: &Task, evaluation: &Evaluation) -> String {
    let flat = task.flat().ok().filter(|flat| flat.steps.len() == evaluation.targets.len());
    let asked = |index| flat.as_ref().and_then(|flat| flat.asked(index));
    let heading = [Some("target"), asked(0).map(|_| "step")].into_iter().flatten();
    let quantities = ["success", "movement time", "sd", "with dwell"];
    let mut rows = vec![heading.chain(quantities).map(String::from).collect()];
    rows.extend(evaluation.targets.iter().enumerate().map(|(index, target)| {
        let seconds = |s: Option<f64>, interval| s.map_or("-".into(), |s| SECONDS.text(s, interval));
        let quantities = [
            PERCENT.text(target.success, target.success_interval),
            seconds(target.movement_time_s, target.movement_time_s_interval),
            seconds(target.movement_time_s_sd, None),
            seconds(target.time_s, target.time_s_interval),
        ];
        [Some((index + 1).to_string()), asked(index)].into_iter().flatten().chain(quantities).collect()
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

#[cfg(test)]
mod tests {
    use myo::tasks::preset_text;

    use super::*;

    #[test]
    fn quantities_stand_with_their_intervals_and_movement_times_without_dwell() {
        let second = serde_json::json!({"success": 0.0, "success_interval": [0.0, 0.004]});
        let first = serde_json::json!({
            "success": 0.998, "success_interval": [0.993, 0.999],
            "movement_time_s": 0.6203, "movement_time_s_sd": 0.3464, "movement_time_s_interval": [0.5984, 0.6423],
            "time_s": 0.8447, "time_s_sd": 0.3471, "time_s_interval": [0.8227, 0.8667],
        });
        let read: Evaluation = serde_json::from_value(serde_json::json!({
            "success": 0.5, "success_interval": [0.25, 0.75], "episodes": 1000, "targets": [first, second],
            "final_distance_m": 0.0519, "final_distance_m_interval": [0.0499, 0.0539], "fatigue": 0.0021, "fatigue_interval": [0.002, 0.0022], "episode_length_s": 0.974,
        }))
        .unwrap();
        let want = "\
pair: 50.0 % of 1,000 fresh episodes succeeded (95 % interval 25.0 to 75.0 %)

  target  step                           success           movement time       sd              with dwell
       1  press upper_right  99.8 % [99.3, 99.9]  0.620 s [0.598, 0.642]  0.346 s  0.845 s [0.823, 0.867]
       2  press upper_left      0.0 % [0.0, 0.4]                       -        -                       -

  final distance  5.19 cm [4.99, 5.39]
  fatigue         0.210 % of muscle strength per episode [0.200, 0.220]
  episode         0.974 s
  in brackets     95 % confidence interval of the mean
  movement time   from the start of the target to the last entry or the touch, without dwell
  fatigue         what of the strength of all muscles fatigues, without what recovers (3CC-r)
";
        let display = preset_text("public-display").unwrap().replace("name: public-display", "name: pair");
        let two_buttons = display.replace(", lower_right, lower_left]", "]");
        assert_eq!(evaluation(&[Task::from_yaml(&two_buttons, "pair").unwrap()], &read), want);
        // In version 1 targets have numbers and no names.
        let sphere = "{kind: pointing, position: {x: 0.3, y: 0, z: 0}, radius: 0.1, dwell_s: 0.1, repeat: 2}";
        let two_spheres = format!("{{version: 1, name: pair, targets: [{sphere}]}}");
        let told = evaluation(&[Task::from_yaml(&two_spheres, "pair").unwrap()], &read);
        assert!(told.contains("\n  target              success "), "{told}");
        assert!(told.contains("\n       1  99.8 % [99.3, 99.9]  "), "{told}");
    }
}
