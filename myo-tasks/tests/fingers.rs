//! Other fingers: in spheres of their own, and coming to the fingertip.

use crate::common::run::{Deed, Run, SUBSTEPS, Touching, refusal, task, text};
use myo_model::MOST_FINGERS;
use myo_tasks::Task;
use myo_tasks::logic::{Goal, distance_to_goal};

const SPHERES: &str = "  a: {kind: sphere, at: [0.4, 0.1, 0], radius: 0.02}\n  b: {kind: sphere, at: [0.4, 0, 0], radius: 0.02}\n  far: {kind: sphere, at: [0.4, -0.1, 0], radius: 0.02}";
const ITEM: [f64; 3] = [0.4, 0.1, 0.0];
const AWAY: [f64; 3] = [0.3, 0.1, 0.0];

/// Other fingers, the first of them here.
fn first(place: [f64; 3]) -> [[f64; 3]; MOST_FINGERS] {
    let mut fingers = [[0.0; 3]; MOST_FINGERS];
    fingers[0] = place;
    fingers
}

/// The fingertip here, and the thumb so far from it (m).
fn pinching(fingertip: [f64; 3], gap: f64) -> (Deed, [[f64; 3]; MOST_FINGERS]) {
    let [x, y, z] = fingertip;
    ((fingertip, None), first([x, y, z - gap]))
}

#[test]
fn a_dwell_with_two_fingers_is_one_while_both_are_inside() {
    let task = task(SPHERES, "  - dwell: {in: a, for_s: 0.1, also: {thumb: b}}");
    assert_eq!(task.flat().unwrap().fingers, ["thumb"]);
    let (inside, outside) = ([0.4, 0.01, 0.0], [0.4, 0.05, 0.0]);
    let mut run = Run::new(&task);
    assert!(!run.run_hand(4, |_, _| ((ITEM, None), first(outside))), "the thumb is outside");
    assert!(!run.run_hand(4, |_, _| ((AWAY, None), first(inside))), "the fingertip is outside");
    assert!(!run.run_hand(1, |_, _| ((ITEM, None), first(inside))), "not long enough");
    // The thumb slips for a physics step, and the dwell begins anew.
    let slip = |now: usize| if now == 9 * SUBSTEPS { outside } else { inside };
    assert!(!run.run_hand(2, |_, now| ((ITEM, None), first(slip(now)))));
    assert!(run.run_hand(1, |_, _| ((ITEM, None), first(inside))));
    assert_eq!(run.state.reached_at[0], (9 * SUBSTEPS + 1) as f64);
}

#[test]
fn what_a_finger_still_has_to_go_is_part_of_the_distance() {
    let task = task(SPHERES, "  - dwell: {in: a, for_s: 0.1, also: {thumb: b}}\n  - dwell: {in: far, for_s: 0.1}");
    let mut run = Run::new(&task);
    let distance = |run: &Run, thumb: [f64; 3]| {
        let mut sensed = run.sensed_at([0.4, 0.1, 0.06]);
        sensed.body.fingers = first(thumb);
        distance_to_goal(&run.task, &sensed, &run.goal())
    };
    assert!((distance(&run, [0.4, 0.0, 0.0]) - 0.04).abs() < 1e-12);
    assert!((distance(&run, [0.4, 0.0, -0.05]) - 0.07).abs() < 1e-12);
    // The second step asks nothing of the thumb.
    run.run_hand(2, |_, _| ((ITEM, None), first([0.4, 0.0, 0.0])));
    assert_eq!(run.state.phase, 1.0);
    let far = (0.2_f64.powi(2) + 0.06_f64.powi(2)).sqrt() - 0.02;
    assert!((distance(&run, [0.0; 3]) - far).abs() < 1e-12);
}

#[test]
fn a_pinch_is_one_that_closes_on_its_target() {
    let task = task(SPHERES, "  - pinch: {in: [a, a]}");
    let flat = task.flat().unwrap();
    assert_eq!((flat.label(0), flat.steps[0].dwell_s()), ("pinch a".into(), Some(0.0)));
    let (open, closed) = (0.05, 0.01);
    let mut run = Run::new(&task);
    // Who comes with closed fingers pinches nothing, however long.
    assert!(!run.run_hand(3, |_, _| pinching(ITEM, closed)));
    assert_eq!((run.state.phase, run.state.open), (0.0, Some(0.0)));
    // Nor who opens them on the way and closes them before it is there.
    run.run_hand(1, |_, _| pinching(AWAY, open));
    assert_eq!(run.state.open, Some(1.0));
    run.run_hand(1, |_, _| pinching(AWAY, closed));
    run.run_hand(1, |_, _| pinching(ITEM, closed));
    assert_eq!((run.state.phase, run.state.open), (0.0, Some(0.0)));
    // Half open is not open.
    run.run_hand(1, |_, _| pinching(ITEM, 0.03));
    run.run_hand(1, |_, _| pinching(ITEM, closed));
    assert_eq!(run.state.phase, 0.0);
    // Open it comes, and closes at a physics step.
    let closes = 9 * SUBSTEPS + 7;
    run.run_hand(1, |_, _| pinching(ITEM, open));
    assert!(!run.run_hand(1, |_, now| pinching(ITEM, if now < closes { open } else { closed })));
    assert_eq!((run.state.phase, run.state.reached_at[0]), (1.0, closes as f64));
    // The second time it must open first.
    assert!(!run.run_hand(2, |_, _| pinching(ITEM, closed)));
    run.run_hand(1, |_, _| pinching(ITEM, open));
    assert!(run.run_hand(1, |_, _| pinching(ITEM, closed)));
}

#[test]
fn a_pinch_is_held_as_long_as_it_says() {
    let task = task(SPHERES, "  - pinch: {in: a, with: middle, for_s: 0.1, closer_than: 0.03, apart: 0.03}");
    assert_eq!(task.flat().unwrap().fingers, ["middle"]);
    let mut run = Run::new(&task);
    run.run_hand(1, |_, _| pinching(ITEM, 0.031));
    assert!(!run.run_hand(1, |_, _| pinching(ITEM, 0.029)));
    assert!(run.run_hand(1, |_, _| pinching(ITEM, 0.029)));
}

#[test]
fn the_way_to_a_pinch_goes_through_open_fingers() {
    let task = task(SPHERES, "  - pinch: {in: a, closer_than: 0.02, apart: 0.04}");
    let run = Run::new(&task);
    let distance = |at: [f64; 3], gap: f64, open: f64| {
        let mut sensed = run.sensed_at(at);
        sensed.body.fingers = pinching(at, gap).1;
        sensed.stay.open = open;
        distance_to_goal(&run.task, &sensed, &run.goal())
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    // Closed fingers open by 3 cm and close again by 2; at the turn there is no jump.
    near(distance(ITEM, 0.01, 0.0), 0.05);
    near(distance(ITEM, 0.04, 0.0), distance(ITEM, 0.04, 1.0));
    near(distance(ITEM, 0.03, 1.0), 0.01);
    near(distance(ITEM, 0.02, 1.0), 0.0);
    // Before it is there, closing them brings nothing.
    near(distance(AWAY, 0.03, 1.0), 0.08 + 0.02);
    near(distance(AWAY, 0.06, 1.0), 0.08 + 0.04);
}

#[test]
fn fingers_that_cannot_be_are_refused() {
    let script = |script: &str| refusal(&text(SPHERES, script));
    for (line, words) in [
        ("  - dwell: {in: a, for_s: 0.1, also: {thumb: d}}", "`d` is no object of the scene"),
        ("  - dwell: {in: a, for_s: 0.1, also: {fingertip: b}}", "`fingertip` is no other finger"),
        ("  - dwell: {in: a, for_s: 0.1, also: {a: a, b: a, c: a, d: a, e: a}}", "one more than 4 other fingers"),
        ("  - pinch: {in: a, closer_than: 0.3}", "it must be from 0.001 to 0.2 m"),
        ("  - pinch: {in: a, closer_than: 0.05}", "is 0.035; it must be from 0.05 (`closer_than`) to 0.4 m"),
        ("  - pinch: {in: a, apart: .nan}", "is NaN; it must be from 0.02"),
        ("  - pinch: {in: a, for_s: -1}", "the dwell is -1 s; it must be from 0"),
        ("  - pinch: a", "it must be a group of keys"),
        ("  - dwell: {in: a, for_s: 0, with: thumb, also: {thumb: b}}", "asks twice for one finger"),
        ("  - press_with: {}", "names no finger"),
        ("  - press_with: {thumb: a}", "only buttons can be pressed"),
    ] {
        let said = script(line);
        assert!(said.contains(words), "{line}: {said}");
    }
    let button = "  a: {kind: button, at: [0.4, 0.1, 0], size: [0.02, 0.02, 0.01]}\n  s: {kind: sphere, at: [0.4, 0, 0], radius: 0.02}";
    for (line, words) in [
        ("  - pinch: {in: a}", "is a button; take a sphere to pinch in"),
        ("  - dwell: {in: s, for_s: 0.1, also: {thumb: a}}", "is a button; fingers can be in spheres only"),
    ] {
        let said = refusal(&text(button, line));
        assert!(said.contains(words), "{line}: {said}");
    }
}

#[test]
fn without_other_fingers_nothing_is_remembered_of_them() {
    let run = Run::new(&task(SPHERES, "  - dwell: {in: a, for_s: 0.1}"));
    let goal: Goal<f64> = run.goal();
    assert!(goal.fingers.is_empty() && goal.pinch.is_none() && run.state.open.is_none());
}

/// Three keys in a row, boxes 0 to 2.
const KEYS: &str = "  keys: {kind: grid, at: [0.4, 0, 0], rows: 1, columns: 3, pitch: 0.03, names: [c, e, g], of: {kind: button, size: [0.02, 0.02, 0.01]}}";
const HARD: f64 = 3.0;

/// Fingers in the air, and what they touch: which finger (0 is the fingertip), which key, how hard.
fn touching(touches: &[(usize, usize, f64)]) -> Touching {
    ([0.3, 0.0, 0.0], first([0.3, 0.0, 0.0]), touches.to_vec())
}

#[test]
fn a_chord_is_done_once_all_its_keys_are_down() {
    let task = task(KEYS, "  - press_with: {thumb: e, fingertip: c}\n  - press_with: {thumb: g}");
    let flat = task.flat().unwrap();
    assert_eq!((flat.steps[0].lead, flat.steps[0].object, flat.steps[1].lead), (None, 0, Some(0)));
    let labels = [0, 1].map(|step| flat.label(step));
    assert_eq!(labels, ["press keys.c and keys.e with thumb", "press keys.g with thumb"]);
    let mut run = Run::new(&task);
    // One key alone, however long, and the same key by the wrong finger.
    run.run_touching(2, |_, _| touching(&[(0, 0, HARD)]));
    run.run_touching(2, |_, _| touching(&[]));
    run.run_touching(2, |_, _| touching(&[(0, 1, HARD), (1, 0, HARD)]));
    assert_eq!((run.state.phase, run.wrong_presses), (0.0, 0.0));
    // The thumb comes later, while the other is held.
    run.run_touching(2, |_, _| touching(&[]));
    let late = 8 * SUBSTEPS + 30;
    run.run_touching(
        2,
        |_, now| {
            if now < late { touching(&[(0, 0, HARD)]) } else { touching(&[(0, 0, HARD), (1, 1, HARD)]) }
        },
    );
    assert_eq!((run.state.phase, run.state.reached_at[0]), (1.0, late as f64));
    // With the thumb alone: first it must be lifted from what it pressed.
    run.run_touching(1, |_, _| touching(&[(1, 2, HARD)]));
    assert_eq!(run.state.phase, 1.0);
    run.run_touching(1, |_, _| touching(&[]));
    assert!(run.run_touching(1, |_, _| touching(&[(1, 2, HARD)])));
    assert_eq!(run.wrong_presses, 0.0);
}

#[test]
fn every_finger_that_may_press_may_press_wrongly() {
    let task = task(KEYS, "  - press_with: {thumb: e, fingertip: c}");
    let mut run = Run::new(&task);
    run.run_touching(1, |_, _| touching(&[(1, 2, HARD)]));
    assert_eq!(run.wrong_presses, 1.0);
    // It stays on it, which is no further press, and does not hinder the other.
    run.run_touching(1, |_, _| touching(&[(1, 2, HARD), (0, 0, HARD)]));
    assert_eq!((run.wrong_presses, run.state.holds.clone()), (1.0, vec![1.0, 0.0]));
    // Who lets go of the first before the second is down has not pressed both.
    run.run_touching(2, |_, _| touching(&[]));
    run.run_touching(1, |_, _| touching(&[(1, 1, HARD)]));
    assert_eq!(run.state.phase, 0.0);
    assert!(run.run_touching(1, |_, _| touching(&[(1, 1, HARD), (0, 0, HARD)])));
}

#[test]
fn the_way_to_a_chord_is_that_of_all_its_fingers() {
    let run = Run::new(&task(KEYS, "  - press_with: {thumb: e, fingertip: c}"));
    let face = |key: usize| {
        let shape = &run.task.boxes[key].shape;
        [0, 1, 2].map(|k| shape.centre[k] + shape.half_size[2] * shape.axes[2][k])
    };
    let before = |key: usize, by: f64| {
        let (face, out) = (face(key), run.task.boxes[key].shape.axes[2]);
        [0, 1, 2].map(|k| face[k] + by * out[k])
    };
    let distance = |holds: f64| {
        let mut sensed = run.sensed_at(before(0, 0.05));
        sensed.body.fingers = first(before(1, 0.02));
        sensed.stay.holds[1] = holds;
        distance_to_goal(&run.task, &sensed, &run.goal())
    };
    assert!((distance(0.0) - 0.07).abs() < 1e-12 && (distance(1.0) - 0.05).abs() < 1e-12);
}

#[test]
fn another_finger_may_point() {
    let task = task(SPHERES, "  - dwell: {in: a, for_s: 0, with: thumb}\n  - dwell: {in: b, for_s: 0}");
    let mut run = Run::new(&task);
    assert!(!run.run_hand(1, |_, _| ((ITEM, None), first(AWAY))), "the fingertip does not count");
    run.run_hand(1, |_, _| ((AWAY, None), first(ITEM)));
    assert_eq!(run.state.phase, 1.0);
    assert!(run.run_hand(1, |_, _| (([0.4, 0.0, 0.0], None), first(AWAY))));
}

/// Keys and spheres: what fingers press, and where they point.
const BOTH: &str = "  keys: {kind: grid, at: [0.4, 0, 0], rows: 1, columns: 3, pitch: 0.03, names: [c, e, g], of: {kind: button, size: [0.02, 0.02, 0.01]}}\n  a: {kind: sphere, at: [0.3, 0, 0], radius: 0.02}\n  b: {kind: sphere, at: [0.3, 0.1, 0], radius: 0.02}";

#[test]
fn a_dwell_beside_chords_counts_inside_alone() {
    let task = task(BOTH, "  - dwell: {in: a, for_s: 0.1}\n  - press_with: {fingertip: c, thumb: e}");
    let mut run = Run::new(&task);
    let at = |x: f64| ([x, 0.0, 0.0], first([0.0; 3]), vec![]);
    run.run_touching(10, |_, _| at(0.1));
    assert_eq!((run.state.held, run.state.dwell), (0.0, 0.0));
    run.run_touching(1, |_, _| at(0.3));
    assert_eq!((run.state.phase, run.state.held), (0.0, SUBSTEPS as f64));
    run.run_touching(1, |_, _| at(0.3));
    assert_eq!((run.state.phase, run.state.reached_at[0]), (1.0, (10 * SUBSTEPS) as f64));
}

#[test]
fn before_it_lights_up_a_chord_asks_nothing_of_any_finger() {
    let task = task(KEYS, "  - wait: 0.1\n  - press_with: {fingertip: c, thumb: e}");
    let mut run = Run::new(&task);
    // The thumb comes too soon: as wrong as any press before its time, and nothing is done by it.
    run.run_touching(1, |_, _| touching(&[(1, 1, HARD)]));
    assert_eq!((run.state.phase, run.wrong_presses), (0.0, 1.0));
    run.run_touching(2, |_, _| touching(&[]));
    // One of both does not do for both.
    run.run_touching(2, |_, _| touching(&[(1, 1, HARD)]));
    assert_eq!(run.state.phase, 0.0);
    assert!(run.run_touching(1, |_, _| touching(&[(1, 1, HARD), (0, 0, HARD)])));
}

#[test]
fn the_fingertip_alone_takes_a_wrong_press_back() {
    let scene = format!("{BOTH}\n  delete: {{kind: button, at: [0.4, 0.2, 0], size: [0.02, 0.02, 0.01]}}");
    for script in [
        "  - press_with: {fingertip: c, thumb: e}",
        "  - press_with: {thumb: e}\n  - dwell: {in: a, for_s: 0, also: {thumb: b}}",
        "  - pinch: {in: a}\n  - press: c",
    ] {
        let text = text(&scene, script).replace("user: fastest", "correction: delete\nuser: fastest");
        let mut run = Run::new(&Task::from_yaml(&text, "t.yaml").unwrap());
        run.run_touching(1, |_, _| touching(&[(1, 2, HARD)]));
        run.run_touching(1, |_, _| touching(&[]));
        assert_eq!((run.wrong_presses, run.state.errors), (1.0, Some(1.0)), "{script}");
        // Not by another finger, and not by pressing anything else.
        run.run_touching(1, |_, _| touching(&[(1, 3, HARD)]));
        run.run_touching(1, |_, _| touching(&[]));
        assert_eq!(run.state.errors, Some(1.0), "{script}");
        assert!(run.goal().fingers.iter().all(|finger| !finger.is_asked), "{script}");
        assert!(run.goal().pinch.is_none_or(|pinch| !pinch.is_pinch), "{script}");
        run.run_touching(1, |_, _| touching(&[(0, 3, HARD)]));
        assert_eq!((run.state.errors, run.state.phase), (Some(0.0), 0.0), "{script}");
    }
}

#[test]
fn a_press_of_the_fingertip_is_not_done_by_a_thumb_that_pinches_elsewhere() {
    let scene = "  a: {kind: sphere, at: [0.3, 0, 0], radius: 0.02}\n  key: {kind: button, at: [0.4, 0, 0], size: [0.02, 0.02, 0.01]}";
    let mut run = Run::new(&task(scene, "  - press: key\n  - pinch: {in: a}"));
    run.run_touching(1, |_, _| touching(&[(1, 0, HARD)]));
    assert_eq!(run.state.phase, 0.0);
    run.run_touching(1, |_, _| touching(&[(0, 0, HARD)]));
    assert_eq!(run.state.phase, 1.0);
}

#[test]
fn pinches_may_come_in_any_order_and_chords_may_not() {
    let mut run = Run::new(&task(SPHERES, "  - any_order: [{pinch: {in: [a, b]}}]"));
    let b = [0.4, 0.0, 0.0];
    run.run_hand(1, |_, _| pinching(b, 0.05));
    run.run_hand(1, |_, _| pinching(b, 0.01));
    assert_eq!((run.state.phase, run.state.order.clone()), (1.0, vec![1.0, 0.0]));
    run.run_hand(1, |_, _| pinching(ITEM, 0.05));
    assert!(run.run_hand(1, |_, _| pinching(ITEM, 0.01)));
    for (scene, script) in [
        (KEYS, "  - any_order: [{press_with: {fingertip: c, thumb: e}}, {press: g}]"),
        (SPHERES, "  - any_order: [{dwell: {in: [a, b], for_s: 0, also: {thumb: far}}}]"),
    ] {
        let said = refusal(&text(scene, script));
        assert!(said.contains("asks for several fingers at once"), "{said}");
    }
}
