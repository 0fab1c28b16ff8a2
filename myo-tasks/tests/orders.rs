//! Orders other than that of the script, what is shown of it, and wrong presses that must be corrected.

use crate::common::run::{Deed, OFF, Run, SUBSTEPS, refusal, task, text};
use myo_tasks::logic::{Goal, remember};
use myo_tasks::{Order, Stimulus};

/// Four keys in a row, 5 cm apart from left to right, and one to take back.
const KEYS: &str = "  keys: {kind: grid, at: [0.4, 0, 0], rows: 1, columns: 4, pitch: 0.05, of: {kind: button, size: [0.03, 0.03, 0.01]}}\n  back: {kind: button, at: [0.4, 0, 0.2], size: [0.03, 0.03, 0.01]}";
const BALLS: &str = "  balls: {kind: grid, at: [0.4, 0, 0], rows: 1, columns: 4, pitch: 0.05, of: {kind: sphere, at: [0, 0, 0], radius: 0.02}}";

/// On a box, pressing.
fn on(number: usize) -> Deed {
    let places = [[0.4, 0.075, 0.0], [0.4, 0.025, 0.0], [0.4, -0.025, 0.0], [0.4, -0.075, 0.0], [0.4, 0.0, 0.2]];
    (places[number], Some((number, 2.0)))
}

/// A tap on a box in a control step.
fn tap(number: usize) -> impl Fn(&Goal<f64>, usize) -> Deed {
    move |_, now| if now % SUBSTEPS < 10 { on(number) } else { (on(number).0, None) }
}

fn assert_near(a: [f64; 3], b: [f64; 3]) {
    assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-12), "{a:?}, {b:?}");
}

#[test]
fn an_order_that_is_drawn_is_each_as_often_as_any_other() {
    let task = task(KEYS, "  - random_order:\n    - press: [1, 2, 3, 4]");
    assert_eq!(task.flat().unwrap().orders, [Order { first: 0, count: 4, is_any: false }]);
    let mut seen = std::collections::BTreeMap::new();
    const EPISODES: u32 = 4_800;
    for episode in 1..=EPISODES {
        let order = Run::episode(&task, episode).state.order.clone();
        *seen.entry(order.iter().map(|&step| step as usize).collect::<Vec<_>>()).or_insert(0_u32) += 1;
    }
    assert_eq!(seen.len(), 24, "all of them, and each is a permutation");
    let expected = f64::from(EPISODES) / 24.0;
    let chi_squared: f64 = seen.values().map(|&count| (f64::from(count) - expected).powi(2) / expected).sum();
    // 23 degrees of freedom: one in a thousand is beyond 49.7.
    assert!(chi_squared < 49.7, "{chi_squared}");
}

#[test]
fn steps_of_a_drawn_order_are_done_in_it_and_told_by_their_own_number() {
    let task = task(KEYS, "  - press: back\n  - random_order:\n    - press: [1, 2, 3, 4]\n  - press: back");
    for episode in 1..20 {
        let mut run = Run::episode(&task, episode);
        let order = run.state.order.clone();
        assert_eq!((order[0], order[5]), (0.0, 5.0), "the others stand where they are written");
        assert!(!run.run(1, tap(4)));
        for (place, &step) in order[1..5].iter().enumerate() {
            let number = step as usize - 1;
            assert_near(run.goal().centre, on(number).0);
            assert!(!run.run(1, tap(number)));
            assert_eq!(run.state.done_at[step as usize], (place + 2) as f64);
            assert_eq!(run.state.cue.as_ref().unwrap().shown_at[step as usize], (place + 1) as f64);
        }
        assert!(run.run(1, tap(4)));
        assert_eq!(run.wrong_presses, 0.0);
        // Any other is a wrong one.
        let mut run = Run::episode(&task, episode);
        run.run(1, tap(4));
        run.run(1, tap(order[2] as usize - 1));
        assert_eq!((run.wrong_presses, run.state.phase), (1.0, 1.0));
    }
}

#[test]
fn in_any_order_what_is_nearest_counts_and_each_counts_once() {
    let task = task(KEYS, "  - any_order:\n    - press: [1, 2, 3, 4]\n  - press: back");
    let mut run = Run::new(&task);
    for (done, number) in [2, 0, 3, 1].into_iter().enumerate() {
        // Over it first, so that it is the current one.
        run.run(1, |_, _| (on(number).0, None));
        assert_near(run.goal().centre, on(number).0);
        assert!(!run.run(1, tap(number)));
        assert_eq!(run.state.phase, (done + 1) as f64);
        assert_eq!(run.state.done_at[number], run.state.step);
    }
    assert_eq!(run.state.order, [2.0, 0.0, 3.0, 1.0, 4.0]);
    assert_near(run.goal().centre, on(4).0);
    assert_eq!(run.wrong_presses, 0.0);
    // What is done already is none that counts.
    let mut run = Run::new(&task);
    for _ in 0..2 {
        run.run(1, |_, _| (on(2).0, None));
        run.run(1, tap(2));
        run.run(1, |_, _| OFF);
    }
    assert_eq!((run.state.phase, run.wrong_presses), (1.0, 1.0));
    // One that is not nearest yet, and not done, is no wrong press.
    let mut run = Run::new(&task);
    run.run(1, |_, _| (on(0).0, None));
    run.run(1, |_, now| if now < 45 { (on(0).0, None) } else { on(3) });
    assert_eq!((run.state.phase, run.wrong_presses), (0.0, 0.0));
    run.run(1, |_, _| on(3));
    assert_eq!(run.state.done_at[3], 3.0, "a press that goes on counts");
}

#[test]
fn a_dwell_that_was_begun_is_not_left_for_what_is_nearer() {
    let task = task(BALLS, "  - any_order:\n    - dwell: {in: balls, for_s: 0.2}");
    let mut run = Run::new(&task);
    // Inside the second, and nearer to no other.
    let at = |y: f64| move |_: &Goal<f64>, _: usize| ([0.4, y, 0.0], None);
    run.run(1, at(0.046));
    run.run(2, at(0.025));
    assert_eq!(run.state.dwell, 2.0);
    run.run(1, at(0.0445));
    assert_near(run.goal().centre, [0.4, 0.025, 0.0]);
    run.run(1, at(0.06));
    assert_eq!(run.state.dwell, 0.0);
    assert_near(run.goal().centre, [0.4, 0.075, 0.0]);
    assert!(!run.run(4, at(0.07)));
    assert_eq!(run.state.done_at, [9.0, -1.0, -1.0, -1.0]);
}

#[test]
fn a_wrong_press_is_taken_back_before_the_script_goes_on() {
    let text = text(KEYS, "  - press: [1, 2]") + "correction: back\n";
    let task = myo_tasks::Task::from_yaml(&text, "t.yaml").unwrap();
    let mut run = Run::new(&task);
    run.run(1, tap(0));
    assert_eq!((run.state.phase, run.state.errors), (1.0, Some(0.0)));
    // Two wrong ones, with the hand lifted in between.
    run.run(1, tap(2));
    run.run(1, tap(3));
    assert_eq!(run.state.errors, Some(2.0));
    assert_near(run.goal().centre, on(4).0);
    // The right key is a wrong one now.
    run.run(1, tap(1));
    assert_eq!((run.state.phase, run.state.errors, run.wrong_presses), (1.0, Some(3.0), 3.0));
    for left in [2.0, 1.0, 0.0] {
        assert!(!run.run(1, tap(4)));
        assert_eq!((run.state.phase, run.state.errors), (1.0, Some(left)));
    }
    assert_eq!(run.state.done_at, [1.0, -1.0], "what corrects is no step");
    // Nothing to take back: that is no wrong press.
    run.run(1, tap(4));
    assert_eq!((run.state.errors, run.wrong_presses), (Some(0.0), 3.0));
    assert!(run.run(1, tap(1)));
    assert_eq!(run.state.done_at, [1.0, 9.0]);
}

#[test]
fn a_dwell_begins_again_after_a_correction() {
    let scene = format!("{KEYS}\n  ball: {{kind: sphere, at: [0.4, 0, 0.1], radius: 0.02}}");
    let text = text(&scene, "  - press: 1\n  - dwell: {in: ball, for_s: 0.2}") + "correction: back\n";
    let mut run = Run::new(&myo_tasks::Task::from_yaml(&text, "t.yaml").unwrap());
    let inside = ([0.4, 0.0, 0.1], None);
    run.run(1, tap(0));
    // Three of four control steps inside, with a neighbour pressed in the last, which breaks nothing by itself.
    run.run(3, move |_, now| if (80..83).contains(&now) { (inside.0, Some((1, 2.0))) } else { inside });
    assert_eq!((run.state.dwell, run.state.errors), (3.0, Some(1.0)));
    assert!(!run.run(1, tap(4)));
    assert_eq!((run.state.dwell, run.state.errors), (0.0, Some(0.0)));
    assert!(run.run(4, move |_, _| inside));
    // All four again, from the end of the correction on.
    assert_eq!((run.state.done_at[1], run.state.reached_at[1]), (9.0, 125.0));
}

#[test]
fn a_task_is_not_done_while_something_is_to_be_corrected() {
    let text = text(KEYS, "  - press: 1") + "correction: back\n";
    let mut run = Run::new(&myo_tasks::Task::from_yaml(&text, "t.yaml").unwrap());
    // The neighbour and the key in one control step.
    let both = |_: &Goal<f64>, now: usize| match now % SUBSTEPS {
        0..2 => on(1),
        17..20 => on(0),
        _ => OFF,
    };
    assert!(!run.run(1, both));
    assert_eq!((run.state.phase, run.state.errors), (1.0, Some(1.0)));
    assert!(!run.run(1, |_, _| OFF));
    assert!(run.run(1, tap(4)));
    assert_eq!(run.state.done_at, [1.0]);
}

#[test]
fn what_corrects_must_be_in_reach() {
    /// Reaches no higher than this (m).
    struct Low(f64);
    impl myo_tasks::Reach for Low {
        fn nearest_in_reach(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
            [x, y, z.min(self.0)]
        }
    }
    let task = myo_tasks::Task::from_yaml(&(text(KEYS, "  - press: 1") + "correction: back\n"), "t.yaml").unwrap();
    let report = myo_tasks::check(&task, &Low(0.1));
    assert_eq!(report.errors.iter().map(myo_tasks::TaskError::path).collect::<Vec<_>>(), ["scene.back.at"]);
    assert!(myo_tasks::check(&task, &Low(0.3)).is_ok());
}

#[test]
fn what_an_order_cannot_hold_is_refused() {
    let refused = |scene: &str, script: &str, end: &str| {
        let message = refusal(&text(scene, script));
        assert!(message.contains(end), "{message}");
    };
    refused(
        KEYS,
        "  - any_order: []",
        "t.yaml:7:16: `any_order` of entry 1 of the script has 0 steps; it must be from 2 to 32",
    );
    refused(KEYS, "  - random_order: [{press: 1}]", "has 1 step; it must be from 2 to 32");
    let many = "  - random_order: [{repeat: {times: 33, steps: [{press: 1}]}}]";
    refused(KEYS, many, "has 33 steps; it must be from 2 to 32");
    refused(
        KEYS,
        "  - random_order: [{press: 1}, {any_order: [{press: [2, 3]}]}]",
        "stands in another order; write them one after the other",
    );
    refused(KEYS, "  - wait: 1\n  - random_order: [{press: [1, 2]}]", "comes after a wait, which belongs to one step");
    refused(KEYS, "  - random_order: [{press: [1, 2]}, {wait: 1}]", "ends with a wait");
    refused(KEYS, "  - any_order: [{press: 1}, {wait: 1}, {press: 2}]", "has a step that is waited for");
    refused(KEYS, "  - any_order: [{press: 1}, {react: {among: keys, after_s: 1}}]", "has a step that is waited for");
    let corrected = |name: &str, end: &str| {
        let message =
            refusal(&(text(&format!("{KEYS}\n{BALLS}"), "  - press: keys.1") + &format!("correction: {name}\n")));
        assert!(message.contains(end), "{message}");
    };
    corrected("balls.1", "`balls.1` is a sphere; a button takes wrong presses back");
    corrected("keys", "the correction `keys` stands for 4 objects; name one button");
    corrected("bakc", "`bakc` is no object of the scene; did you mean `back`?");
}

/// What is remembered is one object: of another there is something to see.
#[test]
fn a_correction_is_seen_although_the_movement_had_begun() {
    let text = text(KEYS, "  - press: [1, 2]") + "stimulus: before_movement\ncorrection: back\n";
    let mut run = Run::new(&myo_tasks::Task::from_yaml(&text, "t.yaml").unwrap());
    let mut known = |errors: f64, pointer: [f64; 3], begins: bool| {
        run.state.errors = Some(errors);
        remember(&run.goal(), pointer, begins, &mut run.state).unwrap()
    };
    let (near, away) = ([0.4, 0.0, 0.0], [0.4, 0.05, 0.0]);
    assert!(known(0.0, near, true).is_seen());
    assert!(!known(0.0, away, false).is_seen());
    let back = known(1.0, away, false);
    assert!(back.is_seen());
    assert_near(back.centre, on(4).0);
    assert!(!known(1.0, near, false).is_seen());
    let first = known(0.0, near, false);
    assert!(first.is_seen());
    assert_near(first.centre, on(0).0);
}

#[test]
fn what_is_shown_is_said_in_a_word() {
    let text = text(KEYS, "  - press: [1, 2]") + "stimulus: current\n";
    let task = myo_tasks::Task::from_yaml(&text, "t.yaml").unwrap();
    assert_eq!(task.flat().unwrap().stimulus, Stimulus::Current);
    let message = refusal(&text.replace("current", "nothing"));
    assert_eq!(message, "t.yaml:10:11: unknown value `nothing`; valid are `all`, `current`, `before_movement`");
}
