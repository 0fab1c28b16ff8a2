//! Ways between spheres that must not be left.

use crate::common::run::{Deed, Run, SUBSTEPS, refusal, task, text};
use myo_tasks::logic::{Goal, begins_at};
use myo_tasks::{Action, Task};

/// A corner: 20 cm to the right, then 10 cm up.
const CORNER: &str = "  a: {kind: sphere, at: [0.4, 0.1, 0], radius: 0.03}\n  b: {kind: sphere, at: [0.4, -0.1, 0], radius: 0.01}\n  c: {kind: sphere, at: [0.4, -0.1, 0.1], radius: 0.0095}";
const SCRIPT: &str = "  - steer: {through: [a, b, c], width: 0.04}";
/// Physics steps per way, so that each of both ends in the middle of a control step.
const EACH: usize = 110;

/// Along both ways from physics step `first` on, off to the side by what `off` says for a physics step since then (m).
fn along(first: usize, off: impl Fn(usize) -> f64) -> impl Fn(&Goal<f64>, usize) -> Deed {
    move |_, now| {
        let since = now.saturating_sub(first);
        let share = |since: usize| (since as f64 / EACH as f64).min(1.0);
        let (right, up) = (share(since), share(since.saturating_sub(EACH)));
        ([0.4 + off(since), 0.1 - 0.2 * right, 0.1 * up], None)
    }
}

#[test]
fn a_way_is_gone_from_its_beginning_over_every_corner_to_its_end() {
    let task = task(CORNER, SCRIPT);
    let flat = task.flat().unwrap();
    let labels: Vec<String> = (0..3).map(|step| flat.label(step)).collect();
    assert_eq!(labels, ["dwell in a", "steer to b", "steer to c"]);
    assert_eq!(flat.steps[2].action, Action::Steer { from: 1, width: 0.04 });
    let mut run = Run::new(&task);
    assert_eq!(begins_at(&run.task, &run.state), [0.4, 0.1, 0.0]);
    // At rest in the first sphere for a control step, then along the middle.
    assert!(!run.run(1, along(SUBSTEPS, |_| 0.0)));
    assert_eq!((run.state.phase, begins_at(&run.task, &run.state)), (1.0, [0.4, 0.1, 0.0]));
    assert_eq!((run.goal().centre, run.goal().size), ([0.4, -0.1, 0.0], 0.02));
    assert!(run.run(10, along(SUBSTEPS, |_| 0.0)));
    // The spheres at the ends are reached after 19 cm of 20 and 9.05 cm of 10, to the physics step.
    assert_eq!(run.state.reached_at[1..], [(SUBSTEPS + 105) as f64, (SUBSTEPS + EACH + 100) as f64]);
    assert_eq!((run.state.done_at.clone(), run.exits), (vec![1.0, 6.0, 10.0], 0.0));
}

#[test]
fn who_leaves_a_way_comes_back_to_where_it_was_left() {
    let task = task(CORNER, SCRIPT);
    let left =
        |begins: usize, ends: usize| move |since: usize| if (begins..ends).contains(&since) { 0.03 } else { 0.0 };
    // Out of it for as long as the hand goes 5 mm on: less than half the width, so it goes on where it comes back.
    let mut run = Run::new(&task);
    assert!(run.run(11, along(SUBSTEPS, left(40, 43))));
    assert_eq!((run.exits, run.state.done_at[1]), (1.0, 6.0));
    // Out of it for 9 cm: coming back in farther ahead is none.
    let mut run = Run::new(&task);
    assert!(!run.run(11, along(SUBSTEPS, left(40, 90))));
    let gone = run.state.steering.unwrap().along;
    assert_eq!((run.exits, run.state.phase), (1.0, 1.0));
    assert!((gone - 0.2 * 39.0 / EACH as f64).abs() < 1e-9, "{gone}");
    let [x, y, z] = run.goal().steer.unwrap().to_gone([0.4, -0.1, 0.1], gone);
    assert!(x.abs() < 1e-12 && (y - (0.2 - gone)).abs() < 1e-12 && (z + 0.1).abs() < 1e-12, "{x} {y} {z}");
    // From there on it can be gone.
    let first = 12 * SUBSTEPS;
    assert!(!run.run(1, move |_, _| ([0.4, 0.1 - gone, 0.0], None)));
    let back = (gone / 0.2 * EACH as f64) as usize;
    assert!(run.run(12, along(first - back, |_| 0.0)));
    assert_eq!(run.exits, 1.0);
}

#[test]
fn beside_a_way_nothing_is_gone_and_nothing_is_left() {
    let mut run = Run::new(&task(CORNER, SCRIPT));
    assert!(!run.run(1, along(SUBSTEPS, |_| 0.0)));
    // Never within it since it began.
    assert!(!run.run(12, along(SUBSTEPS, |_| 0.021)));
    assert_eq!((run.exits, run.state.phase, run.state.steering.unwrap().along), (0.0, 1.0, 0.0));
}

#[test]
fn ways_lead_between_spheres_that_are_drawn() {
    let scene = "  balls: {kind: sphere, at: [0.4, [-0.2, 0.2], [-0.2, 0.2]], radius: 0.03, copies: 2}";
    let task = task(scene, "  - steer: {through: balls, width: 0.04}");
    for episode in 1..20 {
        let mut run = Run::episode(&task, episode);
        let [from, to] = [run.state.position[0], run.state.position[1]];
        let at = move |_: &Goal<f64>, now: usize| {
            let share = (now.saturating_sub(SUBSTEPS) as f64 / 100.0).min(1.0);
            ([0, 1, 2].map(|k| from[k] + share * (to[k] - from[k])), None)
        };
        assert!(run.run(7, at), "episode {episode}: {:?}", run.state.steering);
        assert_eq!(run.exits, 0.0);
    }
}

#[test]
fn what_is_no_way_is_refused() {
    let scene = format!(
        "{CORNER}\n  key: {{kind: button, at: [0.4, 0, 0.3], size: [0.03, 0.03, 0.01]}}\n  fly: {{kind: sphere, at: [0.4, 0, -0.2], radius: 0.02, moves: {{kind: line, by: [0, 0.1, 0], period_s: 2}}}}"
    );
    let refused = |script: &str, end: &str| {
        let message = refusal(&text(&scene, script));
        assert!(message.contains(end), "{message}");
    };
    refused("  - steer: {through: a, width: 0.04}", "is one sphere; a way needs another to lead to");
    refused("  - steer: {through: [a, a], width: 0.04}", "`a` comes twice in a row, and a way has a length");
    refused("  - steer: {through: [a, key], width: 0.04}", "`key` is a button; a way leads from sphere to sphere");
    refused("  - steer: {through: [a, fly], width: 0.04}", "`fly` moves; a way leads along what stands still");
    refused("  - steer: {through: [a, b], width: 0.001}", "the width is 0.001 m; it must be from 0.002 to 4 m");
    refused(
        "  - random_order: [{steer: {through: [a, b], width: 0.04}}]",
        "has a way, whose parts come one after the other",
    );
    let both = "  - steer: {through: [a, b], width: 0.04}\n  - press: key\n  - steer: {through: [b, c], width: 0.02}";
    let task = Task::from_yaml(&text(&scene, both), "t.yaml").unwrap();
    assert_eq!(task.flat().unwrap().steps.len(), 5);
}
