//! Sticks on hinges whose knobs are swung.

use crate::common::run::{Deed, OFF, Run, SUBSTEPS, refusal, task, text};
use myo_tasks::logic::{Goal, centre_ahead};
use myo_tasks::{Action, Anywhere, Reach, Shape, Stick, TaskError, check};

/// Ten centimetres long, on a table before the user; it swings to the right.
const LEVER: &str = "  lever: {kind: stick, at: [0.4, 0, -0.2], length: 0.1, knob: 0.02, angle_deg: -30}";
const SWING: &str = "  - swing: {stick: lever, to_deg: 30, within_deg: 4}";

fn stick(scene: &str) -> Stick {
    let flat = task(scene, SWING).flat().unwrap();
    match &flat.objects[0].shape {
        Shape::Stick(stick) => stick.clone(),
        other => panic!("{other:?}"),
    }
}

/// On the knob's circle, at an angle in degrees.
fn at(degrees: f64) -> Deed {
    let (sin, cos) = degrees.to_radians().sin_cos();
    ([0.4, -0.1 * sin, -0.2 + 0.1 * cos], None)
}

/// From -30 degrees on a third of a degree every physics step; away from the circle from `end` on.
fn swung_to(end: f64) -> impl Fn(&Goal<f64>, usize) -> Deed {
    move |_, now| {
        let angle = -30.0 + now as f64 / 3.0;
        if angle < end { at(angle) } else { OFF }
    }
}

fn angle(run: &Run) -> f64 {
    run.state.sticks.as_ref().unwrap().angles[0].to_degrees()
}

#[test]
fn a_knob_follows_the_pointer_from_where_it_was_taken_to_where_it_is_left() {
    let task = task(LEVER, SWING);
    let flat = task.flat().unwrap();
    assert_eq!(flat.label(0), "swing lever to 30 degrees");
    let Action::Swing { to, within } = flat.steps[0].action else { panic!("{:?}", flat.steps[0]) };
    assert!((to.to_degrees() - 30.0).abs() < 1e-12 && (within.to_degrees() - 4.0).abs() < 1e-12);
    let mut run = Run::new(&task);
    assert!((angle(&run) + 30.0).abs() < 1e-12);
    assert!(run.run(10, swung_to(28.0)));
    // Left after 174 physics steps, at the angle of the one before.
    assert!((angle(&run) - (28.0 - 1.0 / 3.0)).abs() < 1e-2, "{}", angle(&run));
    // The pointer was in the knob from the beginning.
    assert_eq!((run.state.reached_at[0], run.state.done_at[0]), (0.0, 7.0));
    assert_eq!(run.state.sticks.as_ref().unwrap().held, 0.0);
}

#[test]
fn who_leaves_it_too_early_finds_it_where_it_was_left() {
    let mut run = Run::new(&task(LEVER, SWING));
    assert!(!run.run(10, swung_to(20.0)));
    assert!((angle(&run) - (20.0 - 1.0 / 3.0)).abs() < 1e-2);
    let goal = run.goal();
    let (centre, _) = at(angle(&run));
    assert_near(goal.centre, centre);
    assert_near(centre_ahead(&run.task, &run.state, 0), centre);
    let swing = goal.swing.unwrap();
    assert!((swing.left(swing.angle) - 0.1 * (30.0 - angle(&run)).to_radians()).abs() < 1e-12);
    let (there, here) = (at(30.0).0, centre);
    assert_near(swing.way_left(), [0, 1, 2].map(|k| there[k] - here[k]));
    // From there to the end of its swing, and back.
    let begin = 10 * SUBSTEPS;
    let back = move |_: &Goal<f64>, now: usize| match now - begin {
        since @ 0..100 => at(19.7 + since as f64 / 3.0),
        since @ 100..140 => at(53.0 - (since - 100) as f64 / 2.0),
        _ => OFF,
    };
    assert!(run.run(10, back));
    assert_eq!(run.state.reached_at[0], begin as f64, "where it was taken for the last time");
    assert!((26.0..=34.0).contains(&angle(&run)), "{}", angle(&run));
}

#[test]
fn a_knob_goes_no_farther_than_it_swings_and_is_lost_to_who_is_beside_it() {
    let mut run = Run::new(&task(LEVER, SWING));
    assert!(!run.run(10, swung_to(90.0)));
    // The knob stays at the end and the pointer goes on, out of it.
    assert!((angle(&run) - 45.0).abs() < 1e-9, "{}", angle(&run));
    let mut run = Run::new(&task(LEVER, SWING));
    let beside = |_: &Goal<f64>, now: usize| {
        let ([x, y, z], _) = at(-30.0 + now as f64 / 3.0);
        ([x + 0.021, y, z], None)
    };
    assert!(!run.run(10, beside));
    assert!((angle(&run) + 30.0).abs() < 1e-12);
    // Pointing at where it should be takes nothing along.
    assert!(!run.run(10, |_, now| if now % 2 == 0 { at(30.0) } else { OFF }));
    assert!((angle(&run) + 30.0).abs() < 1e-12);
}

#[test]
fn sticks_stand_out_of_what_they_stand_on_and_are_scaled_with_it() {
    for (swings, tilt, out, over) in [
        ("right", 0, [0.0, 0.0, 0.1], [0.0, -0.1, 0.0]),
        ("up", 0, [0.0, 0.0, 0.1], [0.1, 0.0, 0.0]),
        ("right", 90, [-0.1, 0.0, 0.0], [0.0, -0.1, 0.0]),
        ("up", 90, [-0.1, 0.0, 0.0], [0.0, 0.0, 0.1]),
    ] {
        let stick = stick(&LEVER.replace("knob", &format!("swings: {swings}, tilt_deg: {tilt}, knob")));
        assert_near(stick.upright, out);
        assert_near(stick.aside, over);
    }
    let own = LEVER.trim_start().replace("[0.4, 0, -0.2]", "[0, 0, 0.1]");
    let group = format!("  box: {{kind: group, at: [0.4, 0, 0], scale: 0.5, objects: {{{own}}}}}");
    let half = stick(&group);
    assert_near(half.hinge, [0.4, 0.0, 0.05]);
    assert!((half.length() - 0.05).abs() < 1e-12 && (half.knob - 0.01).abs() < 1e-12);
}

#[test]
fn angles_and_places_of_sticks_are_drawn() {
    let scene = LEVER.replace("-30", "[-40, 10]").replace("[0.4, 0, -0.2]", "[0.4, [-0.1, 0.1], -0.2]");
    let two = format!("{scene}\n{}", scene.replace("lever", "other"));
    let task = task(&two, &format!("{SWING}\n{}", SWING.replace("lever", "other")));
    let mut seen = vec![];
    for episode in 1..200 {
        let run = Run::episode(&task, episode);
        let [first, second] = [0, 1].map(|k| run.state.sticks.as_ref().unwrap().angles[k].to_degrees());
        assert!((-40.0..=10.0).contains(&first) && (-40.0..=10.0).contains(&second));
        assert!((first - second).abs() > 1e-9, "each is drawn for itself");
        let ([x, y, z], [_, shift, _]) = (at(first).0, run.state.shifts[0]);
        assert_near(run.goal().centre, [x, y + shift, z]);
        seen.push(first);
    }
    let mean = seen.iter().sum::<f64>() / seen.len() as f64;
    assert!((mean + 15.0).abs() < 4.0, "{mean}");
}

#[test]
fn a_knob_nearly_as_wide_as_its_stick_is_long_stays_with_a_pointer_at_rest() {
    let wide = LEVER.replace("knob: 0.02, angle_deg: -30", "knob: 0.095, range_deg: [-180, 180], angle_deg: 0");
    let mut run = Run::new(&task(&wide, SWING));
    assert!(!run.run(4, |_, _| at(52.0)));
    assert!((angle(&run) - 52.0).abs() < 1e-6, "{}", angle(&run));
    assert_eq!(run.state.sticks.as_ref().unwrap().held, 1.0);
}

#[test]
fn sticks_stand_beside_spheres_and_buttons_in_any_order() {
    let scene = format!(
        "  ball: {{kind: sphere, at: [0.4, 0.2, 0], radius: 0.03}}\n{LEVER}\n  key: {{kind: button, at: [0.4, 0.3, 0], size: [0.03, 0.03, 0.01]}}"
    );
    let script = format!("  - dwell: {{in: ball, for_s: 0.05}}\n{SWING}\n  - press: key");
    let mut run = Run::new(&task(&scene, &script));
    assert!(!run.run(1, |_, _| ([0.4, 0.2, 0.0], None)));
    assert_eq!(run.state.phase, 1.0);
    assert_eq!(run.goal().swing.unwrap().knob, 1.0);
    let first = SUBSTEPS;
    assert!(!run.run(8, move |goal, now| swung_to(29.0)(goal, now - first)));
    assert_eq!(run.state.phase, 2.0);
    let angles = run.state.sticks.as_ref().unwrap().angles.clone();
    assert!(angles[0] == 0.0 && (angles[1].to_degrees() - 28.7).abs() < 0.4, "{angles:?}");
    // A button is pressed, and no knob held.
    assert!(run.run(4, |_, _| ([0.4, 0.3, 0.0], Some((0, 2.0)))));
}

#[test]
fn what_cannot_be_swung_is_refused() {
    let ball = "  ball: {kind: sphere, at: [0.4, 0.2, 0], radius: 0.03}";
    let refused = |scene: &str, script: &str, end: &str| {
        let message = refusal(&text(&format!("{scene}\n{ball}"), script));
        assert!(message.contains(end), "{message}");
    };
    refused(
        LEVER,
        "  - swing: {stick: ball, to_deg: 30, within_deg: 4}",
        "`ball` is a sphere; only sticks can be swung",
    );
    refused(LEVER, "  - dwell: {in: lever, for_s: 1}", "`lever` is a stick; the fingertip can dwell in spheres only");
    refused(LEVER, "  - react: {among: [lever, lever], after_s: 1}", "`lever` is a stick; only buttons and spheres");
    refused(LEVER, &SWING.replace("30", "50"), "is 50; the stick swings from -45 to 45 degrees");
    refused(LEVER, &SWING.replace("within_deg: 4", "within_deg: 0"), "is 0; it must be more than 0, and less than 90");
    refused(LEVER, "  - swing", "`swing` stands alone; write `- swing: {stick: NAME, to_deg: 30, within_deg: 3}`");
    refused(
        &LEVER.replace("knob: 0.02", "knob: 0.1"),
        SWING,
        "the knob of `lever` is 0.1 m; it must be less than the `length`",
    );
    refused(
        &LEVER.replace("-30", "-50"),
        SWING,
        "the angle_deg of `lever` is -50; its `range_deg` goes from -45 to 45",
    );
    let turned = LEVER.replace("angle_deg", "range_deg: [20, -20], angle_deg");
    refused(&turned, SWING, "goes from 20 to -20; the smaller value must come first");
}

fn drawn_lever() -> myo_tasks::Task {
    task(&LEVER.replace("[0.4, 0, -0.2]", "[0.4, 0, [-0.25, -0.1]]"), SWING)
}

/// Reaches what lies higher than this (m).
struct Above(f64);

impl Reach for Above {
    fn nearest_in_reach(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        [x, y, z.max(self.0)]
    }
}

#[test]
fn a_knob_that_leaves_the_reach_is_told_with_a_place_for_its_hinge() {
    let task = task(LEVER, SWING);
    assert!(check(&task, &Anywhere).is_ok());
    assert!(check(&task, &Above(-0.14)).is_ok(), "the knob is 2 cm wide");
    let report = check(&task, &Above(-0.09));
    let [error @ TaskError::PathOutOfReach { worst, beyond_m, remedy, .. }] = &report.errors[..] else {
        panic!("{report:?}")
    };
    // Farther than 30 degrees nobody asks it to go.
    let low = -0.2 + 0.1 * 30_f64.to_radians().cos();
    assert!((worst[2] - low).abs() < 1e-9 && (beyond_m - (-0.09 - low - 0.02)).abs() < 1e-9, "{error}");
    assert_eq!(error.path(), "scene.lever.at");
    let moved = remedy.moved.as_ref().unwrap();
    assert!((0.02..0.04).contains(&moved.by[2]), "{moved:?}");
    assert!(error.to_string().contains("move its hinge "), "{error}");
    // Drawn places are warned of, where some are in reach.
    let drawn = check(&drawn_lever(), &Above(-0.09));
    assert!(drawn.errors.is_empty() && drawn.warnings.len() == 1, "{drawn:?}");
}

fn assert_near(a: [f64; 3], b: [f64; 3]) {
    assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-9), "{a:?}, {b:?}");
}
