//! Steps that may take only so long.

use crate::common::run::{OFF, Run, refusal, task, text};
use myo_tasks::{Task, preset};

const BALLS: &str = "  a: {kind: sphere, at: [0.4, 0, 0], radius: 0.05}\n  b: {kind: sphere, at: [0.4, 0.3, 0], radius: 0.05, min_distance_from_previous: 0}";
const AT_A: ([f64; 3], Option<(usize, f64)>) = ([0.4, 0.0, 0.0], None);
const AT_B: ([f64; 3], Option<(usize, f64)>) = ([0.4, 0.3, 0.0], None);

/// With at most so many control steps for each step of the script.
fn limited(scene: &str, script: &str, steps: u32) -> Task {
    Task { step_limit_s: Some(f64::from(steps) * 0.05), ..task(scene, script) }
}

#[test]
fn what_takes_too_long_is_given_up_and_the_script_goes_on() {
    let mut run = Run::new(&limited(BALLS, "  - dwell: {in: [a, b], for_s: 0.1}", 4));
    assert!(!run.run(3, |_, _| OFF));
    assert_eq!((run.state.phase, run.state.given_up), (0.0, Some(0.0)));
    assert!(!run.run(1, |_, _| OFF));
    assert_eq!((run.state.phase, run.state.given_up, run.bonuses), (1.0, Some(1.0), 0.0));
    // The other is done, and the task is not.
    assert!(!run.run(2, |_, _| AT_B));
    assert_eq!((run.state.phase, run.state.given_up, run.bonuses), (2.0, Some(1.0), 1.0));
    assert_eq!(run.state.done_at, [-1.0, 6.0]);
    assert_eq!(run.state.cue.as_ref().unwrap().shown_at, [0.0, 4.0]);
}

#[test]
fn what_is_done_as_the_time_is_up_is_done() {
    let mut run = Run::new(&limited(BALLS, "  - dwell: {in: [a, b], for_s: 0.1}", 2));
    assert!(!run.run(2, |_, _| AT_A));
    assert_eq!((run.state.phase, run.state.given_up), (1.0, Some(0.0)));
    assert!(run.run(2, |_, _| AT_B), "all is done");
    // A stay that began for what was given up counts for nothing.
    let mut run = Run::new(&limited(BALLS, "  - dwell: {in: [a, a], for_s: 0.1}", 2));
    let late = |_: &myo_tasks::logic::Goal<f64>, now: usize| if now < 30 { OFF } else { AT_A };
    assert!(!run.run(3, late));
    assert_eq!((run.state.phase, run.state.given_up, run.state.held), (1.0, Some(1.0), 25.0));
}

#[test]
fn time_passes_from_when_a_step_counts() {
    let mut run =
        Run::new(&limited(BALLS, "  - wait: 0.5\n  - dwell: {in: a, for_s: 0.1}\n  - dwell: {in: b, for_s: 0.1}", 3));
    run.run(12, |_, _| OFF);
    assert_eq!((run.state.phase, run.state.given_up), (0.0, Some(0.0)));
    run.run(1, |_, _| OFF);
    assert_eq!((run.state.phase, run.state.given_up), (1.0, Some(1.0)));
    run.run(3, |_, _| OFF);
    assert_eq!((run.state.phase, run.state.given_up), (2.0, Some(2.0)));
}

#[test]
fn an_episode_that_begins_in_the_middle_is_done_by_what_is_left() {
    let mut run = Run::new(&limited(BALLS, "  - dwell: {in: [a, b], for_s: 0.1}", 4));
    run.state.phase = 1.0;
    run.state.cue.as_mut().unwrap().object = 1.0;
    assert!(run.run(2, |_, _| AT_B));
}

#[test]
fn limits_that_cannot_be_kept_are_refused() {
    let with = |line: &str| format!("{}{line}\n", text(BALLS, "  - dwell: {in: [a, b], for_s: 0.5}"));
    let told = refusal(&with("step_limit_s: 0.4"));
    assert!(
        told.contains("needs a dwell of 0.5 s but a step is given up after 0.4 s (step_limit_s); raise the limit or shorten the dwell"),
        "{told}"
    );
    assert!(refusal(&with("step_limit_s: 0")).contains("`step_limit_s` is 0 s; it must be from 0.001 to 600 s"));
    assert!(
        refusal(&with("step_limit_s: 0.52")).contains("the limit of a step"),
        "{}",
        refusal(&with("step_limit_s: 0.52"))
    );
    assert_eq!(refusal(&with("step_limit_s: 0.5")), "");
    let told = refusal(&with("control: additive"));
    assert!(told.contains("`additive`") && told.contains("`absolute`, `relative`"), "{told}");
}

/// User-in-the-Box's reward of a control step, 0.05 s: `(exp(-10 d) - 1) / 10` outside, 8 for a hit, `1e-4` times the sum of squared controls.
#[test]
fn the_replication_is_rewarded_as_user_in_the_box() {
    let task = preset("pointing-replication").unwrap();
    let weights = myo_tasks::logic::CompiledTask::<f64>::new(&task).unwrap().weights;
    for distance in [0.01, 0.1, 0.5] {
        let cost = weights.distance_cost * myo_tasks::logic::felt(distance, weights.distance_scale);
        assert!((cost - (1.0 - (-10.0 * distance).exp()) / 10.0).abs() < 1e-12, "{cost} at {distance} m");
    }
    assert!(
        (weights.subtask_bonus - 8.0).abs() < 1e-12 && (weights.effort_cost * weights.cost_share - 1e-4).abs() < 1e-12
    );
    assert_eq!((weights.time_cost, weights.completion_bonus, weights.inside_is_zero), (0.0, 0.0, true));
}
