//! Scenes and scripts: what stands where, what is to do with it, and what is refused.

use crate::common::{VERSION_1, version_1};
use myo_tasks::logic::{CompiledTask, Contact, Goal, Landmarks, Sensed, Stay, TaskState, advance};
use myo_tasks::{Action, Anywhere, FlatTask, Source, Task, User, preset, preset_text};

/// A task of version 2 with this scene and script, lines counted from its own first one.
fn text(scene: &str, script: &str) -> String {
    format!("version: 2\nname: t\nscene:\n{scene}\nscript:\n{script}\nuser: fastest\nmodel: mobl-arms\n")
}

fn flat(scene: &str, script: &str) -> FlatTask {
    Task::from_yaml(&text(scene, script), "t.yaml").unwrap().flat().unwrap()
}

#[track_caller]
fn refused(scene: &str, script: &str, message: &str) {
    let error = Task::from_yaml(&text(scene, script), "t.yaml").expect_err("the text must be refused");
    assert_eq!(error.to_string(), message);
}

/// Where an object is.
fn place(flat: &FlatTask, name: &str) -> [f64; 3] {
    let object = flat.objects.iter().find(|object| object.name == name);
    object.unwrap_or_else(|| panic!("no {name}")).region().at([0.5; 3])
}

#[track_caller]
fn assert_at(flat: &FlatTask, name: &str, want: [f64; 3]) {
    let got = place(flat, name);
    assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{name} is at {got:?}, not {want:?}");
}

/// Names of the objects that the steps ask for.
fn asked(flat: &FlatTask) -> Vec<&str> {
    flat.steps.iter().map(|step| flat.objects[step.object].name.as_str()).collect()
}

const KEYS: &str = "  keys: {kind: keyboard, at: [0.3, 0, -0.3], pitch: 0.01, key: 0.009}";

#[test]
fn the_keys_of_a_keyboard_stand_where_they_do_on_a_phone() {
    let flat = flat(KEYS, "  - type: Hello you");
    assert_eq!(flat.objects.len(), 27);
    assert_at(&flat, "keys.q", [0.315, 0.045, -0.3]);
    assert_at(&flat, "keys.p", [0.315, -0.045, -0.3]);
    assert_at(&flat, "keys.a", [0.305, 0.04, -0.3]);
    assert_at(&flat, "keys.z", [0.295, 0.03, -0.3]);
    assert_at(&flat, "keys.space", [0.285, 0.0, -0.3]);
    let typed: String =
        asked(&flat).iter().map(|name| name.trim_start_matches("keys.").replace("space", " ")).collect();
    assert_eq!(typed, "hello you");
}

#[test]
fn groups_are_moved_tilted_turned_and_scaled_as_one() {
    let scene = "  wall:\n    kind: group\n    at: [0.5, 0.1, 0.2]\n    tilt_deg: 90\n    scale: 2\n    objects:\n      knob: {kind: button, at: [0.1, 0.02, 0.03], size: [0.02, 0.03, 0.01]}";
    let flat = flat(scene, "  - press: knob");
    // Own x is up, own y to the left, own z towards the user.
    assert_at(&flat, "wall.knob", [0.5 - 0.06, 0.1 + 0.04, 0.2 + 0.2]);
    let block = flat.objects[0].block().unwrap();
    assert_eq!(block.size, [0.04, 0.06, 0.02]);
    assert!((block.normal()[0] + 1.0).abs() < 1e-12);

    let turned = scene.replace("tilt_deg: 90", "turn_deg: 90");
    let turned = self::flat(&turned, "  - press: knob");
    assert_at(&turned, "wall.knob", [0.5 - 0.04, 0.1 + 0.2, 0.2 + 0.06]);
}

#[test]
fn a_grid_is_named_row_by_row_from_the_upper_left() {
    let grid = "  pad: {kind: grid, at: [0.4, 0, 0], tilt_deg: 90, rows: 2, columns: 3, pitch: [0.05, 0.06], of: {kind: button, size: [0.03, 0.03, 0.01]}}";
    let numbered = flat(grid, "  - press_and_release: [1, 3, 3, pad.5]");
    assert_at(&numbered, "pad.1", [0.4, 0.05, 0.03]);
    assert_at(&numbered, "pad.3", [0.4, -0.05, 0.03]);
    assert_at(&numbered, "pad.5", [0.4, 0.0, -0.03]);
    assert_eq!(asked(&numbered), ["pad.1", "pad.3", "pad.3", "pad.5"]);
    assert!(numbered.steps.iter().all(|step| step.action == Action::PressAndRelease));
    let named = grid.replace("of:", "names: [a, b, c, d, e, 7], of:");
    assert_eq!(asked(&flat(&named, "  - press: [7, b]")), ["pad.7", "pad.b"]);
    // A group stands for all of its objects.
    assert_eq!(asked(&flat(&named, "  - repeat: {times: 2, steps: [{press: pad}]}")).len(), 12);
}

#[test]
fn a_circle_goes_across_and_all_ways_are_equal() {
    let scene = "  ring: {kind: circle, at: [0.4, 0, 0], tilt_deg: 90, count: 9, diameter: 0.2, of: {kind: sphere, radius: 0.01, min_distance_from_previous: 0}}";
    let flat = flat(scene, "  - dwell: {in: ring, for_s: 0.1}");
    assert_eq!(flat.steps.len(), 9);
    let places: Vec<[f64; 3]> = (1..=9).map(|k| place(&flat, &format!("ring.{k}"))).collect();
    let way = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let ways: Vec<f64> = (0..9).map(|k| way(places[k], places[(k + 1) % 9])).collect();
    // The longest chord between nine points of the circle: 0.2 cos(10 deg).
    assert!(ways.iter().all(|way| (way - 0.2 * 10_f64.to_radians().cos()).abs() < 1e-12), "{ways:?}");
    assert_at(&flat, "ring.1", [0.4, 0.0, 0.1]);
}

#[test]
fn copies_are_drawn_each_for_itself_and_keep_apart() {
    let scene = "  ball: {kind: sphere, copies: 3, at: [0.5, [-0.2, 0.2], 0], radius: [0.02, 0.03]}";
    let flat = flat(scene, "  - dwell: {in: ball, for_s: 0.25}");
    assert_eq!(asked(&flat), ["ball.1", "ball.2", "ball.3"]);
    let apart: Vec<_> = flat.objects.iter().map(|object| object.sphere().unwrap().apart).collect();
    assert_eq!(apart, [None, Some((0, 0.06)), Some((1, 0.06))]);
}

#[test]
fn what_is_wrong_with_equal_steps_in_a_row_is_said_once() {
    let said = |script: &str| {
        let scene = "  ball: {kind: sphere, copies: 3, at: [0.5, [-0.2, 0.2], 0], radius: [0.02, 0.03]}";
        let source = Source::parse(&text(scene, script), "t.yaml").unwrap();
        source.messages(&source.check(&Anywhere))
    };
    let too_long = " needs a dwell of 13 s but the time limit is 12 s; raise the limit or shorten the dwell";
    let all = "t.yaml:6:30: steps 1 to 3 (dwell in ball.1 to ball.3)";
    assert_eq!(said("  - dwell: {in: ball, for_s: 13}"), [format!("{all}{too_long}")]);
    let one = "t.yaml:6:32: step 1 (dwell in ball.2)";
    assert_eq!(said("  - dwell: {in: ball.2, for_s: 13}"), [format!("{one}{too_long}")]);
    let twice = "t.yaml:6:42: steps 1 to 2 (dwell in ball.2)";
    assert_eq!(said("  - dwell: {in: [ball.2, ball.2], for_s: 13}"), [format!("{twice}{too_long}")]);
    assert_eq!(said("  - dwell: {in: ball, for_s: 0.27}"), [""; 0], "no dwell is rounded to control steps");
}

#[test]
fn a_task_of_version_1_is_the_same_task_in_version_2() {
    for (name, _) in VERSION_1 {
        let old = version_1(name);
        // What the presets were before people did them, at their ease.
        let renamed = if name == "pointing" { "pointing-uitb" } else { name };
        // The wall behind the buttons is new.
        let text: String = preset_text(renamed)
            .unwrap()
            .lines()
            .filter(|line| !line.contains("wall:"))
            .flat_map(|line| [line, "\n"])
            .collect();
        let new = Source::parse(&text, name).unwrap().done_by(User::Fastest).task;
        assert_eq!((old.version, new.version), (1, 2));
        let Task { name: its_name, description, model, time_limit_s, .. } = old.clone();
        let new = Task { name: its_name, description, model, time_limit_s, ..new };
        // The same in numbers, bit for bit: what is drawn where, how far apart, what is asked for, how it is rewarded.
        assert_eq!(CompiledTask::<f64>::new(&new).unwrap(), CompiledTask::new(&old).unwrap(), "{name}");
        let [old_flat, new_flat] = [&old, &new].map(|task| task.flat().unwrap());
        assert!(old_flat.objects.iter().map(|object| &object.shape).eq(new_flat.objects.iter().map(|o| &o.shape)));
        // All that is not its targets, too.
        let Task { version, targets, scene, script, .. } = old.clone();
        assert_eq!(Task { version, targets, scene, script, ..new }, old, "{name}");
    }
}

#[test]
fn a_group_at_the_origin_changes_nothing() {
    let old = version_1("public-display");
    let wall = "  wall:\n    kind: group\n    objects:\n";
    let button = |name: &str, y: f64, z: f64| {
        format!("      {name}: {{kind: button, at: [0.42, {y}, {z}], size: [0.05, 0.05, 0.02], tilt_deg: 90}}\n")
    };
    let buttons: String = [("a", -0.15, 0.01), ("b", 0.15, 0.01), ("c", -0.15, -0.29), ("d", 0.15, -0.29)]
        .map(|(n, y, z)| button(n, y, z))
        .concat();
    let new = Task::from_yaml(&text(&format!("{wall}{buttons}"), "  - press: wall"), "t.yaml").unwrap();
    let new = Task { time_limit_s: old.time_limit_s, ..new };
    assert_eq!(CompiledTask::<f64>::new(&new).unwrap(), CompiledTask::new(&old).unwrap());
}

#[test]
fn what_a_script_asks_for_must_be_there_and_fit() {
    refused(
        KEYS,
        "  - press: keys.1",
        "t.yaml:6:12: `keys.1` is no object of the scene; did you mean `keys.a`, `keys.b` or `keys.c`?",
    );
    refused(KEYS, "  - type: h3", "t.yaml:6:11: `keys` has no key for '3' of the text \"h3\"");
    refused(
        KEYS,
        "  - type: {text: hi, on: kays}",
        "t.yaml:6:26: `kays` is no object of the scene; did you mean `keys`?",
    );
    refused(
        KEYS,
        "  - dwell: {in: h, for_s: 0.1}",
        "t.yaml:6:17: `keys.h` is a button; the fingertip can dwell in spheres only",
    );
    let two = format!("{KEYS}\n  other: {{kind: keyboard, at: [0.3, 0, 0], pitch: 0.01, key: 0.009}}");
    refused(&two, "  - type: hi", "t.yaml:7:11: typing must say on which keyboard (`on`): `keys` or `other`");
    refused(&two, "  - press: h", "t.yaml:7:12: `h` may stand for `keys.h` or `other.h`; write which");
    let ball = "  ball: {kind: sphere, at: [0.3, 0, 0], radius: 0.02}\n  desk: {kind: obstacle, at: [0.3, 0, -0.5], size: [1, 1, 0.02]}";
    refused(ball, "  - press: ball", "t.yaml:7:12: `ball` is a sphere; only buttons can be pressed");
    refused(ball, "  - press: desk", "t.yaml:7:12: `desk` is an obstacle; only buttons can be pressed");
    refused(ball, "  - dwell: {in: ball, for_s: -1}", "t.yaml:7:30: the dwell is -1 s; it must be from 0 to 600 s");
    refused(ball, "  []", "t.yaml:7:3: the script has no step; write what is to do, such as `- press: [1, 2]`");
    refused(
        ball,
        "  - repeat: {times: 300, steps: [{press: ball}]}",
        "t.yaml:7:21: `repeat.times` of entry 1 of the script is 300; it must be from 1 to 256",
    );
    refused(
        ball,
        "  - repeat: {times: 200, steps: [{repeat: {times: 200, steps: [{dwell: {in: ball, for_s: 0}}]}}]}",
        "t.yaml:7:3: the script has more than 256 steps, repetitions counted",
    );
}

#[test]
fn mistakes_of_a_script_are_told_by_entries_counted_from_one() {
    let ball = "  ball: {kind: sphere, at: [0.3, 0, 0], radius: 0.02}";
    let dwell = "  - dwell: {in: ball, for_s: 0.1}";
    refused(
        ball,
        &format!("{dwell}\n  - dwell: {{in: ball, fors: 0.1}}"),
        "t.yaml:7:23: unknown key `fors` in `dwell` of entry 2 of the script; did you mean `for_s`?",
    );
    refused(
        ball,
        &format!("{dwell}\n  - repeat: {{times: 2, steps: [{{dwell: {{in: ball}}}}]}}"),
        "t.yaml:7:40: the key `for_s` in `dwell` of entry 1 of the repetition in entry 2 of the script is missing",
    );
    refused(
        ball,
        &format!("{dwell}\n  - dwell: {{in: ball, for_s: long}}"),
        "t.yaml:7:30: `dwell.for_s` of entry 2 of the script is `long`; it must be a number",
    );
    refused(
        ball,
        &format!("{dwell}\n  - dwel: ball"),
        "t.yaml:7:5: unknown value `dwel` in entry 2 of the script; did you mean `dwell`?",
    );
}

#[test]
fn a_word_that_stands_alone_is_told_what_it_lacks() {
    let ball = "  ball: {kind: sphere, at: [0.3, 0, 0], radius: 0.02}";
    for (word, whole) in [
        ("dwell", "dwell: {in: NAME, for_s: 0.3}"),
        ("press", "press: NAME"),
        ("press_and_release", "press_and_release: NAME"),
        ("drag", "drag: {slider: NAME, to: 70, within: 2}"),
        ("follow", "follow: {target: NAME, for_s: 3}"),
        ("react", "react: {among: NAME, after_s: [0.5, 1.5]}"),
        ("wait", "wait: 0.5"),
        ("type", "type: hello"),
        ("repeat", "repeat: {times: 3, steps: [...]}"),
    ] {
        let alone = format!("`{word}` stands alone; write `- {whole}`");
        refused(ball, &format!("  - wait: 1\n  - {word}"), &format!("t.yaml:7:5: {alone}"));
        refused(
            ball,
            &format!("  - repeat:\n      times: 2\n      steps:\n        - {word}\n  - wait: 1"),
            &format!("t.yaml:9:11: {alone}"),
        );
    }
    refused(
        ball,
        "  - pres",
        "t.yaml:6:5: unknown value `pres` in `script`; did you mean `press`, `press_with` or `press_and_release`?",
    );
    refused(
        ball,
        "  - wait: 1\n    press: ball",
        "t.yaml:6:5: `wait` and `press` stand in one entry of the script; write `- ` before each",
    );
    refused(
        ball,
        "  - {}",
        "t.yaml:6:5: an entry of the script is empty; write what is to do, such as `- press: NAME`",
    );
}

#[test]
fn what_a_scene_cannot_hold_is_refused() {
    let press = "  - press: b";
    let button = "{kind: button, at: [0.4, 0, 0], size: [0.03, 0.03, 0.01]}";
    refused(
        &format!("  b: {{kind: grid, rows: 256, columns: 256, pitch: 0.01, of: {button}}}"),
        press,
        "t.yaml:4:3: the scene has more than 256 objects, what generators write included",
    );
    refused(
        &format!("  b: {{kind: grid, rows: 1000000, columns: 1, pitch: 0.01, of: {button}}}"),
        press,
        "t.yaml:4:25: `scene.b.rows` is 1000000; it must be from 1 to 256",
    );
    refused(
        &format!("  b: {{kind: grid, rows: 1, columns: 2, pitch: 0.05, names: [x], of: {button}}}"),
        press,
        "t.yaml:4:60: the names of `b` are 1 for 2 places",
    );
    refused(
        &format!("  b: {{kind: grid, rows: 1, columns: 2, pitch: 0.05, names: [x, x], of: {button}}}"),
        press,
        "t.yaml:4:72: the name `b.x` is that of another object; names must differ",
    );
    refused("  b: {kind: group, objects: {}}", press, "t.yaml:4:6: the group `b` has no objects");
    refused(&format!("  a.b: {button}"), press, "t.yaml:4:3: the name \"a.b\" has the character '.'; leave it out");
    refused(
        &format!("  b: {}", button.replace("0.01]", "0]")),
        press,
        "t.yaml:4:57: the depth of `scene.b` is 0 m; it must be from 0.001 to 2 m",
    );
    refused(
        "  b: {kind: group, tilt_deg: 30, objects: {s: {kind: sphere, at: [0, [0, 0.1], 0], radius: 0.1}}}",
        press,
        "t.yaml:4:66: the place of `b.s` is a range of places in a group that is tilted or turned, in which no distance from the one before \
         can be kept; write `min_distance_from_previous: 0`, or give single numbers",
    );
    let even = format!("  b: {{kind: circle, count: 8, diameter: 0.2, of: {button}}}");
    refused(
        &even,
        press,
        "t.yaml:4:28: `scene.b.count` is 8; it must be an odd number from 3 to 255, so that every way across the circle is as \
         long as the others",
    );
    refused("  b: {kind: bottom}", press, "t.yaml:4:13: unknown value `bottom` in `scene.b`; did you mean `button`?");
    refused(
        &format!("  b: {}", button.replace("size", "sise")),
        press,
        "t.yaml:4:38: unknown key `sise` in `scene.b`; did you mean `size`?",
    );
    let deep = format!("{}{button}{}", "{kind: group, objects: {g: ".repeat(20), "}}".repeat(20));
    let error = Task::from_yaml(&text(&format!("  b: {deep}"), press), "t.yaml").unwrap_err().to_string();
    assert!(error.contains("within another; write fewer groups within groups"), "{error}");
}

#[test]
fn parts_of_the_other_version_are_refused() {
    let old = "version: 1\nname: t\nscene:\n  b: {kind: button, size: [0.1, 0.1, 0.1]}\n";
    let error = Task::from_yaml(old, "t.yaml").unwrap_err().to_string();
    assert_eq!(error, "t.yaml:4:3: a task of version 1 has no scene; write `version: 2`, or targets alone");
    let new = "version: 2\nname: t\ntargets:\n  - {kind: pressing, position: [0.4, 0, 0], size: [0.1, 0.1, 0.1], tilt_deg: 0, min_force_n: 1}\n";
    let error = Task::from_yaml(new, "t.yaml").unwrap_err().to_string();
    assert!(error.starts_with("t.yaml:4:3: a task of version 2 has no targets; write what stands there"), "{error}");
}

#[test]
fn boxes_may_touch_but_not_overlap() {
    let scene = |y: f64| {
        format!(
            "  a: {{kind: button, at: [0.4, 0, 0], size: [0.03, 0.03, 0.01]}}\n  b: {{kind: obstacle, at: [0.4, {y}, 0], size: [0.03, 0.03, 0.01]}}"
        )
    };
    let findings = |y: f64| {
        let source = Source::parse(&text(&scene(y), "  - press: a"), "t.yaml").unwrap();
        source.messages(&source.check(&Anywhere))
    };
    assert_eq!(findings(0.03), [""; 0]);
    let source = Source::parse(&text(&KEYS.replace("0.009", "0.012"), "  - type: hi"), "t.yaml").unwrap();
    let said = source.messages(&source.check(&Anywhere));
    assert_eq!(said, ["t.yaml:4:30: keys.q and keys.w overlap by 2.0 mm; move one of them, or make it smaller"]);
    assert_eq!(findings(0.028), ["t.yaml:5:27: a and b overlap by 2.0 mm; move one of them, or make it smaller"]);
}

/// Presses one button through a task, contact in these physics steps; returns when its steps were done and reached.
fn press(script: &str, contact: impl Fn(usize) -> Option<f64>) -> Vec<(f64, f64)> {
    const SUBSTEPS: usize = 25;
    let scene = "  b: {kind: button, at: [0.4, 0, 0], size: [0.03, 0.03, 0.01], min_force_n: 2}";
    let task = Task::from_yaml(&text(scene, script), "t.yaml").unwrap();
    let task = CompiledTask::<f64>::new(&task).unwrap();
    let mut state = TaskState::new(&task);
    state.restart(true);
    for step in 0..20 {
        let goal = Goal::of(&task, &state);
        let mut stay = Stay::new(&state, &goal);
        for now in step * SUBSTEPS..(step + 1) * SUBSTEPS {
            let touch = contact(now);
            let contact =
                Contact { exists: touch.is_some(), finger: 0, number: 0.0, force: touch.unwrap_or(0.0), facing: 1.0 };
            stay.follow(&task, &goal, &Landmarks::unknown(), [0.0; 3], 1.0 / SUBSTEPS as f64, std::iter::once(contact));
        }
        let sensed =
            Sensed { body: Landmarks::unknown(), pointer: [0.0; 3], stay, now: ((step + 1) * SUBSTEPS) as f64 };
        if advance(&task, &goal, &sensed, &mut state, 0.04).task_done {
            break;
        }
    }
    state.done_at.into_iter().zip(state.reached_at).collect()
}

/// Contact of 3 N within these physics steps, the second of each pair excluded.
fn during(contacts: &[(usize, usize)]) -> impl Fn(usize) -> Option<f64> {
    move |now| contacts.iter().any(|(from, to)| (*from..*to).contains(&now)).then_some(3.0)
}

#[test]
fn a_button_that_is_pressed_twice_must_be_let_go_in_between() {
    let twice = "  - press: [b, b]";
    // Held down from 30 on: the second press never comes.
    assert_eq!(press(twice, during(&[(30, 500)])), [(2.0, 30.0), (-1.0, -1.0)]);
    // Let go at 80, pressed again at 100; who comes back within 30 ms bounced.
    assert_eq!(press(twice, during(&[(30, 80), (100, 500)])), [(2.0, 30.0), (5.0, 100.0)]);
    assert_eq!(press(twice, during(&[(30, 80), (94, 500)])), [(2.0, 30.0), (-1.0, -1.0)]);
    // Let go within the control step of the first press: what comes after its end counts.
    assert_eq!(press(twice, during(&[(30, 35), (60, 65)])), [(2.0, 30.0), (3.0, 60.0)]);
    // Two presses within one control step are one.
    assert_eq!(press(twice, during(&[(30, 35), (40, 45)])), [(2.0, 30.0), (-1.0, -1.0)]);
    // To press lightly in between is not to let go.
    let light = |now: usize| match now {
        30..60 | 90..120 => Some(3.0),
        60..90 => Some(0.5),
        _ => None,
    };
    assert_eq!(press(twice, light), [(2.0, 30.0), (-1.0, -1.0)]);
}

#[test]
fn press_and_release_is_done_when_the_button_is_let_go() {
    let once = "  - press_and_release: b";
    assert_eq!(press(once, during(&[(30, 110)])), [(5.0, 30.0)]);
    assert_eq!(press(once, during(&[(30, 34)])), [(2.0, 30.0)], "a tap within a control step");
    assert_eq!(press(once, during(&[(30, 40)])), [(3.0, 30.0)], "let go 30 ms after the last touch, in the next one");
    assert_eq!(press(once, during(&[(30, 1000)])), [(-1.0, 30.0)], "reached, but never let go");
    let twice = "  - press_and_release: [b, b]";
    assert_eq!(press(twice, during(&[(30, 60), (80, 130)])), [(3.0, 30.0), (6.0, 80.0)]);
    // Off for less than 30 ms: a bounce.
    assert_eq!(press(twice, during(&[(30, 60), (74, 90)])), [(5.0, 30.0), (-1.0, -1.0)]);
    // Still down from the press before: to let go of that is no release of this one.
    let mixed = "  - press: b\n  - press_and_release: b";
    assert_eq!(press(mixed, during(&[(30, 80)])), [(2.0, 30.0), (-1.0, -1.0)]);
    assert_eq!(press(mixed, during(&[(30, 80), (100, 140)])), [(2.0, 30.0), (7.0, 100.0)]);
}

/// How often a wrong button is counted in each control step of a task that asks for `a`, then `b`; `contact` tells which
/// boxes are touched at a physics step, and how hard.
fn wrong_presses(contact: impl Fn(usize) -> Vec<(f64, f64)>) -> Vec<f64> {
    let scene = "  a: {kind: button, at: [0.4, 0, 0], size: [0.03, 0.03, 0.01], min_force_n: 2}\n  b: {kind: button, at: [0.4, 0.1, 0], size: [0.03, 0.03, 0.01], min_force_n: 1}\n  desk: {kind: obstacle, at: [0.4, 0, -0.5], size: [1, 1, 0.01]}";
    let task = Task::from_yaml(&text(scene, "  - press: [a, b]"), "t.yaml").unwrap();
    let task = CompiledTask::<f64>::new(&task).unwrap();
    let mut state = TaskState::new(&task);
    state.restart(true);
    let mut counted = vec![];
    for step in 0..6 {
        let goal = Goal::of(&task, &state);
        let mut stay = Stay::new(&state, &goal);
        for now in step * 25..(step + 1) * 25 {
            let none = Contact { exists: false, finger: 0, number: 0.0, force: 0.0, facing: 1.0 };
            let mut contacts = [none; 2];
            for (slot, (number, force)) in contacts.iter_mut().zip(contact(now)) {
                *slot = Contact { exists: true, finger: 0, number, force, facing: 1.0 };
            }
            stay.follow(&task, &goal, &Landmarks::unknown(), [0.0; 3], 0.04, contacts.into_iter());
        }
        let sensed = Sensed { body: Landmarks::unknown(), pointer: [0.0; 3], stay, now: ((step + 1) * 25) as f64 };
        counted.push(advance(&task, &goal, &sensed, &mut state, 0.04).wrong_presses);
    }
    counted
}

#[test]
fn presses_that_were_not_asked_for_are_counted_once_each() {
    let at = |ranges: &'static [(usize, usize, f64, f64)]| {
        move |now: usize| -> Vec<(f64, f64)> {
            let here = ranges.iter().filter(|(from, to, ..)| (*from..*to).contains(&now));
            here.map(|&(_, _, number, force)| (number, force)).collect()
        }
    };
    // The second button first, held over control steps: once. Lightly touched: not at all.
    assert_eq!(wrong_presses(at(&[(30, 80, 1.0, 1.0)])), [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(wrong_presses(at(&[(30, 80, 1.0, 0.9)])), [0.0; 6]);
    // Let go, and again; off for less than 30 ms it is one press.
    assert_eq!(wrong_presses(at(&[(30, 40, 1.0, 1.0), (55, 60, 1.0, 1.0)])), [0.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(wrong_presses(at(&[(30, 40, 1.0, 1.0), (54, 60, 1.0, 1.0)])), [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    // Together with the right one: the one on which there is more force.
    assert_eq!(wrong_presses(at(&[(30, 40, 0.0, 2.0), (30, 40, 1.0, 1.0)])), [0.0; 6]);
    assert_eq!(wrong_presses(at(&[(30, 40, 0.0, 2.0), (30, 40, 1.0, 2.1)])), [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    // The first button is right, and still down while the second is asked for; once let go, it is wrong.
    let again = at(&[(30, 70, 0.0, 3.0), (90, 100, 0.0, 3.0), (110, 120, 1.0, 1.0)]);
    assert_eq!(wrong_presses(again), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    // What only stands in the way cannot be pressed.
    assert_eq!(wrong_presses(at(&[(30, 80, 2.0, 500.0)])), [0.0; 6]);
}

#[test]
fn converted_tasks_are_the_same_tasks_and_come_out_of_their_files_again() {
    let mut one_of_each = version_1("ar");
    one_of_each.targets.truncate(2);
    for old in VERSION_1.map(|(name, _)| version_1(name)).into_iter().chain([one_of_each]) {
        let new = old.clone().converted();
        assert!(new.targets.is_empty() && new.version == 2);
        assert_eq!(CompiledTask::<f64>::new(&new).unwrap(), CompiledTask::new(&old).unwrap(), "{}", old.name);
        let text = new.to_yaml();
        assert_eq!(Task::from_yaml(&text, "t.yaml").unwrap(), new, "{text}");
        assert_eq!(new.clone().converted(), new);
    }
    let text = version_1("public-display").converted().to_yaml();
    assert!(text.contains("- press: [button1, button2, button3, button4]"), "{text}");
}

/// Runs keep their task as JSON, and what is drawn depends on the order of objects.
#[test]
fn the_order_of_objects_outlives_json() {
    for name in ["public-display", "ar", "wall-ray"] {
        let task = preset(name).unwrap();
        let value = serde_json::to_value(&task).unwrap();
        let read: Task = serde_json::from_value(value).unwrap();
        assert_eq!(format!("{read:?}"), format!("{task:?}"));
    }
}
