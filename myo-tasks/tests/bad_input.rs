//! Every kind of mistake in a task file, and the sentence that it gets.

use myo_tasks::{Anywhere, Observation, Reach, Source, Task, check, load, preset_text};

/// Lines are counted in this text by the tests below.
const TASK: &str = "\
version: 1
name: two
targets:
  - kind: pointing
    position:
      x: 0.4
      y: [-0.1, 0.1]
      z: [-0.3, 0.3]
    radius: [0.04, 0.08]
    dwell_s: 0.25
  - kind: pressing
    position: [0.4, 0.1, -0.2]
    size: [0.05, 0.04, 0.02]
    tilt_deg: 45
    min_force_n: 1
time_limit_s: 4
";

/// [`TASK`] with the first `from` replaced.
fn edited(from: &str, to: &str) -> String {
    assert!(TASK.contains(from), "{from} is not in the text");
    TASK.replacen(from, to, 1)
}

/// The text with this edit is refused with exactly this message.
#[track_caller]
fn refused(from: &str, to: &str, message: &str) {
    let error = Task::from_yaml(&edited(from, to), "my.yaml").expect_err("the text must be refused");
    assert_eq!(error.to_string(), message);
}

/// The text with this edit is read, and its check says exactly these sentences.
#[track_caller]
fn checked(from: &str, to: &str, reach: &dyn Reach, messages: &[&str]) {
    let source = Source::parse(&edited(from, to), "my.yaml").expect("the text must be read");
    assert_eq!(source.messages(&source.check(reach)), messages);
}

#[test]
fn text_without_edit_is_fine() {
    checked("two", "two", &Anywhere, &[]);
}

#[test]
fn unknown_keys_get_the_nearest_valid_ones() {
    refused("dwell_s", "dwel_s", "my.yaml:10:5: unknown key `dwel_s` in target 1; did you mean `dwell_s`?");
    refused("time_limit_s", "time_limt", "my.yaml:16:1: unknown key `time_limt`; did you mean `time_limit_s`?");
    refused("x: 0.4", "w: 0.4", "my.yaml:6:7: unknown key `w` in `position` of target 1; valid are `x`, `y`, `z`");
    refused(
        "time_limit_s: 4",
        "reward: { distanc_cost: 1 }",
        "my.yaml:16:11: unknown key `distanc_cost` in `reward`; did you mean `distance_cost`?",
    );
    refused(
        "kind: pressing",
        "kind: presing",
        "my.yaml:11:11: unknown value `presing` in target 2; did you mean `pressing`?",
    );
    refused(
        "time_limit_s: 4",
        "reset: { pose: none }",
        "my.yaml:16:16: unknown value `none` in `reset`; valid are `range_uniform`, `near_zero`, `zero`",
    );
}

#[test]
fn keys_in_any_order_are_read_and_located() {
    let reordered =
        edited("- kind: pressing\n    position: [0.4, 0.1, -0.2]", "- position: [0.4, 0.1, -0.2]\n    kind: pressing");
    assert_eq!(Task::from_yaml(&reordered, "").unwrap(), Task::from_yaml(TASK, "").unwrap());
    let wrong = reordered.replace("min_force_n", "min_force");
    let error = Task::from_yaml(&wrong, "my.yaml").unwrap_err();
    assert_eq!(error.to_string(), "my.yaml:15:5: unknown key `min_force` in target 2; did you mean `min_force_n`?");
}

#[test]
fn missing_and_double_keys() {
    refused("    radius: [0.04, 0.08]\n", "", "my.yaml:4:5: the key `radius` in target 1 is missing");
    refused("version: 1\n", "", "my.yaml:1:1: the key `version` is missing");
    refused("kind: pressing", "sort: pressing", "my.yaml:11:5: the key `kind` in target 2 is missing");
    refused("dwell_s: 0.25", "dwell_s: 1\n    dwell_s: 2", "my.yaml:11:5: the key `dwell_s` stands here a second time");
}

#[test]
fn wrong_types() {
    refused(
        "min_force_n: 1",
        "min_force_n: much",
        "my.yaml:15:18: `min_force_n` of target 2 is `much`; it must be a number",
    );
    refused(
        "[0.04, 0.08]",
        "[1, 2, 3]",
        "my.yaml:9:13: `radius` of target 1 is a list of 3; it must be a number or [min, max]",
    );
    refused(
        "[0.4, 0.1, -0.2]",
        "[0.4, 0.1]",
        "my.yaml:12:15: `position` of target 2 is a list of 2; it must be a list of length 3",
    );
    refused("time_limit_s: 4", "time_limit_s: soon", "my.yaml:16:15: `time_limit_s` is `soon`; it must be a number");
    refused(
        "time_limit_s: 4",
        "observation: { phase: 3 }",
        "my.yaml:16:23: `observation.phase` is `3`; it must be true or false",
    );
}

#[test]
fn values_out_of_bounds() {
    let radius = "my.yaml:9:13: the radius of target 1 (pointing)";
    let bounds = "it must be from 0.001 to 2 m";
    refused("[0.04, 0.08]", "0", &format!("{radius} is 0 m; {bounds}"));
    refused("[0.04, 0.08]", "-0.1", &format!("{radius} is -0.1 m; {bounds}"));
    refused("[0.04, 0.08]", ".nan", &format!("{radius} is NaN; {bounds}"));
    refused("[0.04, 0.08]", "[0.04, .inf]", &format!("{radius} is inf; {bounds}"));
    refused(
        "[0.04, 0.08]",
        "[0.08, 0.04]",
        &format!("{radius} goes from 0.08 m to 0.04 m; the smaller end must come first"),
    );
    refused(
        "[-0.1, 0.1]",
        "[-0.1, .nan]",
        "my.yaml:7:10: the y position of target 1 (pointing) is NaN; it must be from -2 to 2 m",
    );
    refused(
        "0.04, 0.02]",
        "0, 0.02]",
        "my.yaml:13:18: the height of target 2 (pressing) is 0 m; it must be from 0.001 to 2 m",
    );
    refused(
        "dwell_s: 0.25",
        "dwell_s: -1",
        "my.yaml:10:14: the `dwell_s` of target 1 (pointing) is -1 s; it must be from 0 to 600 s",
    );
    refused(
        "tilt_deg: 45",
        "tilt_deg: 200",
        "my.yaml:14:15: the `tilt_deg` of target 2 (pressing) is 200 deg; it must be from 0 to 180 deg",
    );
    refused(
        "min_force_n: 1",
        "min_force_n: 0",
        "my.yaml:15:18: the `min_force_n` of target 2 (pressing) is 0 N; it must be from 0.01 to 1000 N",
    );
    refused(
        "time_limit_s: 4",
        "time_limit_s: -4",
        "my.yaml:16:15: `time_limit_s` is -4 s; it must be from 0.001 to 600 s",
    );
    refused("version: 1", "version: 3", "my.yaml:1:10: `version` is 3; versions 1 to 2 are known");
    refused("name: two", "name: ''", "my.yaml:2:7: `name` has 0 characters; it must have from 1 to 64");
    refused(
        "dwell_s: 0.25",
        "dwell_s: 0.25\n    min_distance_from_previous: -1",
        "my.yaml:11:33: the `min_distance_from_previous` of target 1 (pointing) is -1 m; it must be from 0 to 4 m",
    );
}

/// Numbers that a computer can hold and no arm can use, in every field that holds one.
#[test]
fn absurd_numbers_are_refused_wherever_they_stand() {
    let all = format!(
        "{}{}",
        edited("dwell_s: 0.25", "dwell_s: 0.25\n    min_distance_from_previous: 0.1"),
        "control_dt_s: 0.05
reset: { pose_spread_rad: 0.1, velocity_spread_rad_s: 0.1, activation_max: 0.5 }
reward: { distance_cost: 1, time_cost: 1, subtask_bonus: 1, completion_bonus: 1, effort_cost: 1, acceleration_cost: 1 }
noise: { signal_dependent: 0.1, constant: 0.1 }
"
    );
    Task::from_yaml(&all, "my.yaml").expect("the text itself is fine");
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    let mut refusals = 0;
    for (number, line) in all.lines().enumerate().skip(2) {
        let cut = |c: char| !(c.is_ascii_digit() || c == '.' || c == '-');
        for (at, word) in line.match_indices(|c: char| !cut(c)).filter_map(|(at, _)| {
            let begins = at == 0 || line[..at].ends_with([' ', '[']);
            let word = line[at..].split(cut).next()?;
            (begins && is_number(word)).then_some((at, word))
        }) {
            for absurd in ["1e308", "-1e308", "-1e-300", ".inf", ".nan"] {
                let changed = format!("{}{absurd}{}", &line[..at], &line[at + word.len()..]);
                let lines: Vec<&str> =
                    all.lines().enumerate().map(|(k, l)| if k == number { &*changed } else { l }).collect();
                // Coordinates may be a little less than zero.
                if absurd == "-1e-300"
                    && (line.contains("x:") || line.contains("y:") || line.contains("z:") || line.contains("position"))
                {
                    continue;
                }
                let error = Task::from_yaml(&lines.join("\n"), "my.yaml").expect_err(&changed).to_string();
                assert!(error.starts_with(&format!("my.yaml:{}:", number + 1)), "{changed}: {error}");
                assert!(error.contains("must"), "{changed}: {error}");
                refusals += 1;
            }
        }
    }
    assert!(refusals >= 130, "only {refusals} numbers were found");
}

#[test]
fn numbers_that_single_precision_cannot_divide_by_are_refused() {
    refused(
        "min_force_n: 1",
        "min_force_n: 1e-300",
        "my.yaml:15:18: the `min_force_n` of target 2 (pressing) is 1e-300 N; it must be from 0.01 to 1000 N",
    );
    refused(
        "[0.04, 0.08]",
        "1e-30",
        "my.yaml:9:13: the radius of target 1 (pointing) is 1e-30 m; it must be from 0.001 to 2 m",
    );
}

#[test]
fn an_observation_without_parts_is_refused() {
    let parts = Observation::default().parts().map(|(name, _)| format!("{name}: false")).join(", ");
    refused(
        "time_limit_s: 4",
        &format!("observation: {{ {parts} }}"),
        "my.yaml:16:14: `observation` has no part; at least one must be true",
    );
    let one = parts.replace("phase: false", "phase: true");
    checked("time_limit_s: 4", &format!("observation: {{ {one} }}"), &Anywhere, &[]);
}

#[test]
fn texts_that_a_terminal_would_obey_are_refused() {
    let obeyed = "has the control character U+001B, which a terminal would obey; leave it out";
    refused("name: two", "name: \"a\\e[31mb\"", &format!("my.yaml:2:7: `name` {obeyed}"));
    refused("name: two", "name: two\ndescription: \"\\e[2J\"", &format!("my.yaml:3:14: `description` {obeyed}"));
    refused("name: two", "name: two\nmodel: \"\\e[2J\"", &format!("my.yaml:3:8: `model` {obeyed}"));
    checked("name: two", "name: two\ndescription: \"two\\nlines\"", &Anywhere, &[]);
    let long = "x".repeat(10_001);
    refused(
        "name: two",
        &format!("name: two\ndescription: {long}"),
        "my.yaml:3:14: `description` has 10001 characters; it must have from 0 to 10000",
    );
}

/// A body of which no more is known than its physics step.
struct Step(f64);

impl Reach for Step {
    fn nearest_in_reach(&self, point: [f64; 3]) -> [f64; 3] {
        point
    }
    fn physics_dt_s(&self) -> Option<f64> {
        Some(self.0)
    }
}

#[test]
fn a_control_step_between_physics_steps_is_refused_with_those_that_fit() {
    let errors = |control_dt_s: &str, physics_dt_s| {
        let text = edited("time_limit_s: 4", &format!("control_dt_s: {control_dt_s}"));
        let source = Source::parse(&text, "my.yaml").unwrap();
        let report = source.check(&Step(physics_dt_s));
        report.errors.iter().map(|error| format!("{}: {error}", source.place(&error.path()))).collect::<Vec<_>>()
    };
    let uneven = |control_dt_s: &str, physics_dt_s: &str, fitting: &str| {
        format!(
            "my.yaml:16:15: `control_dt_s` is {control_dt_s} s, which is not a whole multiple of the model's physics step of \
             {physics_dt_s} s; take {fitting} s"
        )
    };
    assert_eq!(errors("0.033", 0.002), [uneven("0.033", "0.002", "0.032 or 0.034")]);
    assert_eq!(errors("0.033", 0.02), [uneven("0.033", "0.02", "0.02 or 0.04")]);
    assert_eq!(errors("0.004", 0.01), [uneven("0.004", "0.01", "0.01")]);
    for fine in ["0.002", "0.05", "0.5", "0.034"] {
        let text = format!("control_dt_s: {fine}\ntime_limit_s: 600");
        let source = Source::parse(&edited("time_limit_s: 4", &text), "my.yaml").unwrap();
        assert!(source.check(&Step(0.002)).is_ok(), "{fine}");
    }
    let source = Source::parse(&edited("time_limit_s: 4", "control_dt_s: 0.033"), "my.yaml").unwrap();
    assert!(source.check(&Anywhere).is_ok(), "whoever knows no model is not asked");
}

#[test]
fn texts_that_are_no_task_at_all() {
    for text in [
        "",
        "null",
        "3",
        "[]",
        "{}",
        "- a\n- b",
        "name: [ar",
        "\t",
        "a: b: c",
        "version: 1\n---\nversion: 1",
        "&a [*a]",
    ] {
        let message = Task::from_yaml(text, "my.yaml").expect_err(text).to_string();
        assert!(message.starts_with("my.yaml:"), "{text:?}: {message}");
    }
}

#[test]
fn several_bad_values_are_all_said() {
    refused(
        "radius: [0.04, 0.08]\n    dwell_s: 0.25",
        "radius: 0\n    dwell_s: -1",
        "my.yaml:9:13: the radius of target 1 (pointing) is 0 m; it must be from 0.001 to 2 m\n\
         my.yaml:10:14: the `dwell_s` of target 1 (pointing) is -1 s; it must be from 0 to 600 s",
    );
}

#[test]
fn zero_and_more_than_ten_targets() {
    refused(
        "dwell_s: 0.25",
        "dwell_s: 0.25\n    repeat: 10",
        "my.yaml:4:3: the task has 11 targets, repetitions counted; a task has from 1 to 10",
    );
    refused(
        "dwell_s: 0.25",
        "dwell_s: 0.25\n    repeat: 0",
        "my.yaml:11:13: the `repeat` of target 1 (pointing) is 0; it must be from 1 to 10",
    );
    let (head, _) = TASK.split_once("targets:").unwrap();
    let error = Task::from_yaml(&format!("{head}targets: []\n"), "my.yaml").unwrap_err();
    assert_eq!(error.to_string(), "my.yaml:3:10: the task has no target; a task has from 1 to 10");
}

#[test]
fn unknown_presets_get_the_nearest_valid_ones() {
    let message = |name| load(name).expect_err("no such preset").to_string();
    assert_eq!(message("pointng"), "there is no preset and no file called `pointng`; did you mean `pointing`?");
    assert!(message("typing").ends_with("did you mean `mobile-typing`?"));
    assert!(message("qqqq").ends_with(
        "valid are `pointing`, `pointing-single`, `ar`, `public-display`, `mobile-typing`, `ticket`, `hello`, `slider`, `choice`, `wall-ray`, `pinch`, `ar-pinch`, `ar-menu`, `chord`, `hand-pointing`, `hand-press`, `pointing-uitb`, `pointing-replication`, `tracking-uitb`, `choice-uitb`, `driving-uitb`"
    ));
    assert!(message("no/such.yaml").starts_with("cannot read no/such.yaml: "));
}

#[test]
fn dwells_that_do_not_fit_into_the_time_limit() {
    checked(
        "dwell_s: 0.25",
        "dwell_s: 5",
        &Anywhere,
        &[
            "my.yaml:10:14: target 1 (pointing) needs a dwell of 5 s but the time limit is 4 s; raise the limit or shorten the dwell",
        ],
    );
    checked(
        "dwell_s: 0.25",
        "dwell_s: 1\n    repeat: 5",
        &Anywhere,
        &[
            "my.yaml:17:15: the dwells of all targets add up to 5.00 s but the time limit is 4 s; raise the limit or shorten the dwells",
        ],
    );
}

#[test]
fn times_between_control_steps_are_told() {
    checked(
        "time_limit_s: 4",
        "time_limit_s: 4.02",
        &Anywhere,
        &[
            "my.yaml:16:15: warning: the time limit of 4.02 s is not a whole number of control steps and counts as 4.0000 s \
         (80 steps)",
        ],
    );
    // Dwells are none of control steps, and may be as long as the limit.
    checked("dwell_s: 0.25", "dwell_s: 0.27", &Anywhere, &[]);
    checked("dwell_s: 0.25", "dwell_s: 4", &Anywhere, &[]);
    checked("dwell_s: 0.25", "dwell_s: 0.8\n    repeat: 5", &Anywhere, &[]);
}

#[test]
fn distance_rule_that_no_pair_of_positions_keeps() {
    // The farthest two points of the range are opposite corners: sqrt(0.2^2 + 0.6^2) = 0.632 m.
    checked(
        "dwell_s: 0.25",
        "dwell_s: 0.25\n    repeat: 2\n    min_distance_from_previous: 0.633",
        &Anywhere,
        &[
            "my.yaml:12:33: target 2 (pointing) must lie at least 0.633 m from target 1 (pointing), but their ranges allow \
         no more than 0.632 m; widen a range or lower `min_distance_from_previous`",
        ],
    );
}

#[test]
fn distance_rule_that_few_positions_keep() {
    checked(
        "dwell_s: 0.25",
        "dwell_s: 0.25\n    repeat: 3\n    min_distance_from_previous: 0.61",
        &Anywhere,
        &[
            "my.yaml:12:33: warning: only 0.0 % of the positions of target 2 (pointing) lie at least 0.61 m from target 1 \
         (pointing); widen a range or lower `min_distance_from_previous`",
        ],
    );
    let source = Source::parse(
        &edited("dwell_s: 0.25", "dwell_s: 0.25\n    repeat: 2\n    min_distance_from_previous: 0.35"),
        "t",
    )
    .unwrap();
    let messages = source.messages(&source.check(&Anywhere));
    assert_eq!(messages.len(), 1);
    assert!(messages[0].contains(
        "of the positions of target 1 (pointing) leave no position for target 2 (pointing) at least 0.35 m away"
    ));
}

#[test]
fn distance_rule_after_a_button_is_checked_too() {
    let sphere_after = "  - kind: pointing\n    position: { x: 0.4, y: 0.1, z: -0.2 }\n    radius: 0.05\n    dwell_s: 0.1\ntime_limit_s: 4";
    checked(
        "time_limit_s: 4",
        sphere_after,
        &Anywhere,
        &[
            "my.yaml:16:5: target 3 (pointing) must lie at least 0.1 m from target 2 (pressing), but their ranges allow \
         no more than 0.000 m; widen a range or lower `min_distance_from_previous`",
        ],
    );
}

#[test]
fn boxes_that_overlap() {
    // 5 cm wide faces, tilted alike, one beside the other.
    let beside = |y: f64| {
        format!(
            "  - kind: pressing\n    position: [0.4, {y}, -0.2]\n    size: [0.05, 0.04, 0.02]\n    tilt_deg: 45\n    min_force_n: 1\ntime_limit_s: 4"
        )
    };
    checked(
        "time_limit_s: 4",
        &beside(0.145),
        &Anywhere,
        &[
            "my.yaml:17:15: target 2 (pressing) and target 3 (pressing) overlap by 5.0 mm; move one of them, or make it smaller",
        ],
    );
    checked(
        "time_limit_s: 4",
        &beside(0.12),
        &Anywhere,
        &[
            "my.yaml:17:15: target 2 (pressing) and target 3 (pressing) overlap by 20.0 mm; move one of them, or make it smaller",
        ],
    );
    for touching in [0.15, 0.151, 0.155] {
        checked("time_limit_s: 4", &beside(touching), &Anywhere, &[]);
    }
}

/// In reach: everything up to so many metres from the shoulder.
struct Ball(f64);

impl Reach for Ball {
    fn nearest_in_reach(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let share = (self.0 / f64::hypot(f64::hypot(x, y), z)).min(1.0);
        [x * share, y * share, z * share]
    }
}

#[test]
fn targets_out_of_reach_say_which_and_how_far() {
    checked(
        "position: [0.4, 0.1, -0.2]",
        "position: [0.9, 0.01, 0]",
        &Ball(0.8),
        &[
            "my.yaml:12:15: target 2 (pressing) is out of reach of the model: at (0.91, 0.04, 0.02) m its face by 10.8 cm; \
         move it 11.0 cm to (0.79, 0.006, -0.003) m, that is 11.0 cm back",
        ],
    );
    checked(
        "x: 0.4",
        "x: [1, 1.1]",
        &Ball(0.8),
        &[
            "my.yaml:6:7: target 1 (pointing) is out of reach of the model: at (1.10, -0.10, -0.30) m its surface by 30.5 cm; \
         move the range 36.7 cm to x 0.633 to 0.733, y -0.1 to 0.1, z -0.3 to 0.3 m, that is 36.7 cm back",
        ],
    );
}

#[test]
fn a_sphere_counts_as_reached_as_soon_as_its_surface_is() {
    checked("x: 0.4", "x: 0.7", &Anywhere, &[]);
    // Centre 5 cm beyond the reach, radius 4 to 8 cm: about a quarter of them, the smallest, cannot be entered.
    let sphere = edited(
        "position:\n      x: 0.4\n      y: [-0.1, 0.1]\n      z: [-0.3, 0.3]",
        "position: { x: 0.65, y: 0, z: 0 }",
    );
    let source = Source::parse(&sphere, "my.yaml").unwrap();
    let messages = source.messages(&source.check(&Ball(0.6)));
    assert_eq!(messages.len(), 1);
    assert!(
        messages[0].starts_with("my.yaml:5:15: warning: 25.0 % of the range of target 1 (pointing) is out of reach"),
        "{messages:?}"
    );
}

#[test]
fn equal_targets_are_spoken_of_once() {
    let new = preset_text("pointing").unwrap();
    let old = include_str!("version-1/pointing.yaml");
    for (text, name) in [(new, "ball.1 to ball.10"), (old, "targets 1 to 10 (pointing)")] {
        let source = Source::parse(text, "pointing").unwrap();
        let messages = source.messages(&source.check(&Ball(0.5)));
        assert_eq!(messages.len(), 1);
        assert!(messages[0].contains(&format!("of the range of {name} is out of reach")), "{messages:?}");
        assert!(check(&source.task, &Ball(0.77)).is_ok(), "the published task can be trained");
    }
}

#[test]
fn tasks_built_in_code_get_the_same_sentences() {
    let mut task = Task::from_yaml(TASK, "").unwrap();
    task.time_limit_s = f64::NAN;
    let report = check(&task, &Anywhere);
    assert_eq!(report.errors[0].to_string(), "`time_limit_s` is NaN; it must be from 0.001 to 600 s");
    task.targets.clear();
    assert_eq!(check(&task, &Anywhere).errors[0].to_string(), "the task has no target; a task has from 1 to 10");
}
