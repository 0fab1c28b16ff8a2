//! Objects that move, handles that are dragged, steps that must be waited for, and techniques.

use crate::common::run::{OFF, Run, SUBSTEPS, refusal, task, text};
use myo_tasks::logic::{CompiledTask, Goal, Landmarks, Pointer, centre_ahead, remember};
use myo_tasks::{Action, Task, check};

const SLIDER: &str = "  s: {kind: slider, at: [0.4, 0, 0], length: 0.1, range: [0, 100], value: 20}";
const LAMPS: &str = "  lamps: {kind: grid, at: [0.4, 0, 0], rows: 1, columns: 3, pitch: 0.05, of: {kind: button, size: [0.03, 0.03, 0.01]}}";
const BALL: &str =
    "  ball: {kind: sphere, at: [0.4, 0, 0], radius: 0.05, moves: {kind: circle, diameter: 0.2, period_s: 2}}";
const SINES: &str =
    "  ball: {kind: sphere, at: [0.4, 0, 0], radius: 0.05, moves: {kind: sines, by: [0.01, 0.1, 0.2], up_to_hz: 0.5}}";
const WALL: &str = "  wall: {kind: obstacle, at: [2, 0, 0], tilt_deg: 90, size: [2, 2, 0.02]}\n  spot: {kind: sphere, at: [1.99, 0.2, 0.3], radius: 0.1}";

/// On the slider at a value, pressing.
fn on_slider(value: f64) -> ([f64; 3], Option<(usize, f64)>) {
    ([0.4, -(value - 50.0) * 1e-3, 0.0], Some((0, 0.5)))
}

#[test]
fn a_handle_follows_the_fingertip_from_where_it_was_taken_to_where_it_is_let_go() {
    let task = task(SLIDER, "  - drag: {slider: s, to: 70, within: 5}");
    let flat = task.flat().unwrap();
    assert!(
        matches!(flat.steps[0].action, Action::Drag { to, within } if (to - 0.7).abs() < 1e-12 && (within - 0.05).abs() < 1e-12)
    );
    assert_eq!(flat.label(0), "drag s to 70");
    // Taken at 20, moved a millimetre every two physics steps, let go at 72.
    let drag = |end: f64| {
        move |_: &Goal<f64>, now: usize| {
            let value = 20.0 + 0.5 * now as f64;
            if value < end { on_slider(value) } else { OFF }
        }
    };
    let mut run = Run::new(&task);
    assert!(run.run(10, drag(72.0)));
    assert!((run.state.values[0] - 0.715).abs() < 1e-9, "{:?}", run.state.values);
    // Let go too early: it stays there, and the task goes on from there.
    let mut run = Run::new(&task);
    assert!(!run.run(10, drag(60.0)));
    assert!((run.state.values[0] - 0.595).abs() < 1e-9);
    let goal = run.goal();
    assert!((goal.centre[1] - -(59.5 - 50.0) * 1e-3).abs() < 1e-9, "the handle is what is aimed at: {:?}", goal.centre);
    assert!((goal.drag().unwrap().left(run.state.values[0]) - 0.0105).abs() < 1e-9);
    assert_near(centre_ahead(&run.task, &run.state, 1), goal.centre);
    assert!(run.run(2, |_, now| if now < 255 {
        on_slider(59.5)
    } else if now < 280 {
        on_slider(69.0)
    } else {
        OFF
    }));
}

#[test]
fn a_touch_beside_the_handle_takes_nothing_along() {
    let task = task(SLIDER, "  - drag: {slider: s, to: 70, within: 5}");
    let mut run = Run::new(&task);
    // The handle is 20 mm long and stands at 20.
    assert!(!run.run(10, |_, now| on_slider(35.0 + 0.1 * now as f64)));
    assert_eq!(run.state.values[0], 0.2);
    // Too light a touch takes nothing either.
    let mut run = Run::new(&task);
    assert!(!run.run(10, |_, now| (on_slider(20.0 + 0.1 * now as f64).0, Some((0, 0.1)))));
    assert_eq!(run.state.values[0], 0.2);
}

#[test]
fn sliders_rise_to_the_right_or_up_wherever_they_look() {
    for (rises, tilt, along) in
        [("right", 0, [0.0, -1.0, 0.0]), ("up", 0, [1.0, 0.0, 0.0]), ("up", 90, [0.0, 0.0, 1.0])]
    {
        let scene = SLIDER.replace("value: 20", &format!("value: 20, rises: {rises}, tilt_deg: {tilt}"));
        let flat = task(&scene, "  - drag: {slider: s, to: 70, within: 5}").flat().unwrap();
        let myo_tasks::Shape::Slider(slider) = &flat.objects[0].shape else { panic!("a slider") };
        assert!((0..3).all(|k| (slider.along()[k] - along[k]).abs() < 1e-12), "{rises}, {tilt}: {:?}", slider.along());
        assert_eq!(
            slider.block.size.map(|x| (1e3 * x).round()),
            if rises == "up" { [20.0, 120.0, 5.0] } else { [120.0, 20.0, 5.0] }
        );
    }
}

#[test]
fn what_lights_up_is_drawn_and_what_was_touched_before_does_not_count() {
    let task = task(LAMPS, "  - repeat: {times: 250, steps: [{react: {among: lamps, after_s: [0.2, 0.4]}}]}");
    let mut run = Run::new(&task);
    let (mut objects, mut waits) = ([0; 3], [0; 9]);
    let mut wrong = 0;
    for round in 0..250 {
        let (begin, cue) = (run.state.step, run.state.cue.clone().unwrap());
        waits[(cue.lit_at - begin) as usize] += 1;
        objects[cue.object as usize] += 1;
        let middle = run.goal().centre;
        assert!((middle[1]).abs() < 1e-12, "nothing tells which one it is: {middle:?}");
        let lit_at = cue.lit_at as usize * SUBSTEPS;
        let object = cue.object as usize;
        // A tap before the light and one after it. Who still presses from the step before, this button or another, presses nothing anew.
        let lifts = round % 3 > 0;
        wrong += usize::from(lifts || round == 0);
        let (from, to) = (begin as usize * SUBSTEPS, begin as usize * SUBSTEPS + 20);
        let tap = move |_: &Goal<f64>, now: usize| match now {
            now if lifts && now < from + 15 => OFF,
            now if now < to => ([0.4, 0.0, 0.0], Some((object, 2.0))),
            now if now >= lit_at + 3 => ([0.4, 0.0, 0.0], Some((object, 2.0))),
            _ => OFF,
        };
        let before = run.state.phase;
        while run.state.phase == before {
            run.run(1, tap);
        }
        let index = before as usize;
        assert_eq!(run.state.cue.as_ref().unwrap().shown_at[index], cue.lit_at);
        assert_eq!(run.state.reached_at[index], (lit_at + 3) as f64);
    }
    assert_eq!(waits[..4], [0; 4]);
    assert!(waits[4..].iter().all(|&count| count > 30), "{waits:?}");
    assert!(objects.iter().all(|&count| count > 60), "{objects:?}");
    assert_eq!(run.wrong_presses, wrong as f64);
}

#[test]
fn who_rests_on_a_button_until_it_lights_up_must_let_go_first() {
    let task = task(LAMPS, "  - react: {among: lamps, after_s: 0.2}");
    let mut run = Run::new(&task);
    let object = run.state.cue.as_ref().unwrap().object as usize;
    let rest = move |_: &Goal<f64>, _: usize| ([0.4, 0.0, 0.0], Some((object, 2.0)));
    assert!(!run.run(10, rest));
    assert_eq!(run.wrong_presses, 1.0);
    let again = move |_: &Goal<f64>, now: usize| if now < 270 { OFF } else { ([0.4, 0.0, 0.0], Some((object, 2.0))) };
    assert!(run.run(1, again));
}

#[test]
fn a_wait_shows_what_comes_and_does_not_count_it() {
    let scene =
        "  a: {kind: sphere, at: [0.4, 0.1, 0], radius: 0.05}\n  b: {kind: sphere, at: [0.4, -0.1, 0], radius: 0.05}";
    let task = task(scene, "  - dwell: {in: a, for_s: 0.1}\n  - wait: 0.3\n  - dwell: {in: b, for_s: 0.1}");
    let mut run = Run::new(&task);
    assert!(!run.run(2, |_, _| ([0.4, 0.1, 0.0], None)));
    assert_eq!(run.state.done_at, [2.0, -1.0]);
    assert_eq!(run.goal().centre, [0.4, -0.1, 0.0], "it can be seen");
    // Inside all the time: six control steps of waiting, two of dwelling.
    assert!(run.run(10, |_, _| ([0.4, -0.1, 0.0], None)));
    assert_eq!((run.state.done_at[1], run.state.reached_at[1]), (10.0, 200.0));
}

#[test]
fn following_adds_up_the_time_inside_and_dwelling_does_not() {
    let inside = |goal: &Goal<f64>, now: usize| {
        let at = goal.centre_after((now % SUBSTEPS) as f64 / SUBSTEPS as f64);
        // Out of it for one control step of every four.
        if now / SUBSTEPS % 4 == 3 { ([0.0; 3], None) } else { (at, None) }
    };
    // Three in, one out: ten control steps inside take thirteen.
    let mut run = Run::new(&task(BALL, "  - follow: {target: ball, for_s: 0.5}"));
    assert!(run.run(20, inside));
    assert_eq!((&run.state.done_at[..], &run.state.reached_at[..]), (&[13.0][..], &[0.0][..]));
    // In for one physics step of every four, from 3 on: 30 physics steps of them come to 0.06 s at 119, and it was entered at 3.
    let flickering = |goal: &Goal<f64>, now: usize| if now % 4 == 3 { inside(goal, now % SUBSTEPS) } else { OFF };
    let mut run = Run::new(&task(BALL, "  - follow: {target: ball, for_s: 0.06}"));
    assert!(!run.run(4, flickering));
    // A quarter of 100 physics steps, of which 25 are a control step.
    assert_eq!((run.state.dwell, &run.state.reached_at[..]), (1.0, &[3.0][..]));
    assert!(run.run(20, flickering));
    assert_eq!((&run.state.done_at[..], &run.state.reached_at[..]), (&[5.0][..], &[3.0][..]));
    // Of no seconds: the first entry, at 75 of those from 75 to 99.
    let mut run = Run::new(&task(BALL, "  - follow: {target: ball, for_s: 0}"));
    assert!(!run.run(3, |_, _| OFF));
    assert!(run.run(1, flickering));
    assert_eq!(run.state.reached_at, [75.0]);
    let mut run = Run::new(&task(BALL, "  - dwell: {in: ball, for_s: 0.5}"));
    assert!(!run.run(40, inside));
}

#[test]
fn tracking_is_over_when_its_time_is_and_tells_how_well_it_went() {
    // On the centre for half of the control steps, and 8 cm beside it for the others.
    let beside = |goal: &Goal<f64>, now: usize| {
        let [x, y, z] = goal.centre_after((now % SUBSTEPS) as f64 / SUBSTEPS as f64);
        ([x + if (now / SUBSTEPS).is_multiple_of(2) { 0.0 } else { 0.08 }, y, z], None)
    };
    let mut run = Run::new(&task(BALL, "  - track: {target: ball, for_s: 0.5}"));
    assert!(!run.run(9, beside));
    assert_eq!(run.state.dwell, 9.0, "control steps that have passed, inside or not");
    assert!(run.run(1, beside));
    let tracking = run.state.tracking.unwrap();
    assert_eq!((tracking.steps, tracking.on_target()), (250.0, 0.5));
    assert!((tracking.error() - 0.08 * 0.5_f64.sqrt()).abs() < 1e-12);
    // A quarter of a second inside what is tracked brings a quarter of a target's bonus, little by little, and to have come to the end of it nothing.
    assert!((run.bonuses - 0.25).abs() < 1e-12, "{}", run.bonuses);
    // What comes before or after it, and waiting, does not count.
    let script = "  - follow: {target: ball, for_s: 0}\n  - wait: 0.2\n  - track: {target: ball, for_s: 0.1}\n  - dwell: {in: ball, for_s: 0}";
    let mut run = Run::new(&task(BALL, script));
    assert!(run.run(20, |goal, now| beside(goal, now % SUBSTEPS)));
    let tracking = run.state.tracking.unwrap();
    assert_eq!((tracking.steps, tracking.on_target(), run.state.done_at[1]), (50.0, 1.0, 7.0));
    assert!((run.bonuses - 2.1).abs() < 1e-12, "two targets and a tenth of a second: {}", run.bonuses);
    // Nobody is on it.
    let mut run = Run::new(&task(BALL, "  - track: {target: ball, for_s: 0}"));
    assert!(run.run(1, |_, _| OFF), "of no seconds: a physics step");
    assert_eq!(run.state.tracking.unwrap().on_target(), 0.0);
    assert!(Run::new(&task(BALL, "  - track: {target: ball, for_s: 1}")).state.tracking.unwrap().on_target().is_nan());
    assert!(Run::new(&task(BALL, "  - follow: {target: ball, for_s: 1}")).state.tracking.is_none());
}

/// Weights, frequencies and phases of many episodes against what they are drawn from, and the path against its bounds.
#[test]
fn sines_are_drawn_anew_for_every_episode_and_stay_within_what_they_were_given() {
    let of_sines = task(SINES, "  - track: {target: ball, for_s: 10}");
    let (mut rates, mut shares, mut most) = (vec![], vec![], [0.0_f64; 3]);
    for episode in 0..300 {
        let mut run = Run::episode(&of_sines, episode);
        for axis in run.state.sines[0].chunks(5) {
            assert!((axis.iter().map(|wave| wave[0]).sum::<f64>() - 1.0).abs() < 1e-12);
            rates.extend(axis.iter().map(|wave| wave[1] / 0.05));
            shares.extend(axis.iter().map(|wave| wave[0]));
            assert!(axis.iter().all(|wave| (0.0..1.0).contains(&wave[2])));
        }
        for step in 0..40 {
            run.state.step = 5.0 * f64::from(step);
            let [x, y, z] = run.goal().centre;
            let off = [x - 0.4, y, z];
            most = [0, 1, 2].map(|axis| most[axis].max(off[axis].abs()));
        }
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    assert!(rates.iter().all(|rate| (0.0..0.5).contains(rate)) && (mean(&rates) - 0.25).abs() < 0.01);
    // Five weights from 1 to 5: one has at most 5 of 9 and at least 1 of 21 of all.
    assert!(shares.iter().all(|share| (1.0 / 21.0..5.0 / 9.0).contains(share)));
    let given = [0.01, 0.1, 0.2];
    assert!((0..3).all(|k| most[k] <= given[k] && most[k] > 0.7 * given[k]), "{most:?}");
    // It goes on where it was to be.
    let mut run = Run::new(&of_sines);
    for _ in 0..20 {
        let next = run.goal().centre_after(1.0);
        run.run(1, |_, _| OFF);
        assert_near(run.goal().centre, next);
    }
}

#[test]
fn a_sphere_on_a_circle_keeps_its_distance_and_its_speed() {
    let mut run = Run::new(&task(BALL, "  - follow: {target: ball, for_s: 60}"));
    for _ in 0..40 {
        let goal = run.goal();
        let [x, y, z] = goal.centre;
        assert!((x - 0.4).abs() < 1e-12, "it stands before the user: {x}");
        assert!((y.hypot(z) - 0.1).abs() < 1e-12);
        let next = goal.centre_after(1.0);
        run.run(1, |_, _| OFF);
        let now = run.goal().centre;
        assert!((0..3).all(|k| (now[k] - next[k]).abs() < 1e-12), "where it was to be: {next:?}, {now:?}");
        let chord = goal.moves.unwrap().iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((chord - 0.2 * (std::f64::consts::PI / 40.0).sin()).abs() < 1e-12, "{chord}");
    }
}

#[test]
fn random_ways_stay_within_what_they_were_given() {
    let scene = "  ball: {kind: sphere, at: [0.4, 0, 0], radius: 0.05, moves: {kind: random, by: [0.02, 0.1, 0.1], period_s: 1}}";
    let flat = task(scene, "  - follow: {target: ball, for_s: 1}").flat().unwrap();
    let path = flat.objects[0].sphere().unwrap().path.clone().unwrap();
    let mut most = [0.0_f64; 3];
    for k in 0..20_000 {
        let offset = path.offset(0.05 * f64::from(k), &[0.1, 2.0, 4.0, 5.0]);
        most = [0, 1, 2].map(|axis| most[axis].max(offset[axis].abs()));
    }
    let given = [0.02, 0.1, 0.1];
    assert!((0..3).all(|k| most[k] <= given[k] + 1e-12 && most[k] > 0.8 * given[k]), "{most:?}");
}

/// What an environment shows before the light must not depend on which one it will be.
#[test]
fn what_will_light_up_cannot_be_told_from_what_is_seen() {
    let scene = "  a: {kind: sphere, at: [0.4, 0.1, 0], radius: 0.02}\n  b: {kind: sphere, at: [0.4, -0.1, 0], radius: 0.06, moves: {kind: line, by: [0, 0, 0.1], period_s: 1}}";
    let run = Run::new(&task(scene, "  - react: {among: [a, b], after_s: 1, for_s: 0.1}"));
    for object in [0.0, 1.0] {
        let mut state = run.state.clone();
        state.cue.as_mut().unwrap().object = object;
        let goal = Goal::of(&run.task, &state);
        assert_eq!((goal.centre, goal.moves), ([0.4, 0.0, 0.0], Some([0.0; 3])));
        assert!((goal.size - 0.04).abs() < 1e-12, "{}", goal.size);
    }
}

#[test]
fn the_farthest_places_of_a_random_way_are_looked_at() {
    /// Reaches no higher than this.
    struct Low(f64);
    impl myo_tasks::Reach for Low {
        fn nearest_in_reach(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
            [x, y, z.min(self.0)]
        }
    }
    let scene =
        "  ball: {kind: sphere, at: [0.4, 0, 0], radius: 0.01, moves: {kind: random, by: [0, 0, 0.1], period_s: 1}}";
    let task = task(scene, "  - follow: {target: ball, for_s: 1}");
    assert!(!check(&task, &Low(0.085)).is_ok());
    assert!(check(&task, &Low(0.095)).is_ok());
}

/// A body with these places.
fn body(elbow: [f64; 3], wrist: [f64; 3], fingertip: [f64; 3]) -> Landmarks<f64> {
    Landmarks { fingertip, elbow, wrist, ..Landmarks::unknown() }
}

fn pointer(technique: &str) -> Pointer<f64> {
    let text = format!("{}technique: {technique}\n", text(WALL, "  - dwell: {in: spot, for_s: 0.2}"));
    CompiledTask::new(&Task::from_yaml(&text, "t.yaml").unwrap()).unwrap().pointer
}

fn assert_near(a: [f64; 3], b: [f64; 3]) {
    assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-9), "{a:?} instead of {b:?}");
}

#[test]
fn a_ray_meets_the_face_or_goes_past_the_goal() {
    let goal = [1.99, 0.2, 0.3];
    let forearm = pointer("{kind: ray, from: forearm, onto: wall}");
    // From (0, 0, 0) through (0.1, 0.01, 0.02): 1.99 m ahead.
    let arm = body([0.0; 3], [0.1, 0.01, 0.02], [0.2, 0.3, 0.4]);
    assert_near(forearm.place(&arm, goal), [1.99, 0.199, 0.398]);
    let hand = pointer("{kind: ray, from: hand, onto: wall}");
    assert_near(hand.place(&body([0.0; 3], [0.1, 0.0, 0.0], [0.2, 0.0, -0.01]), goal), [1.99, 0.0, -0.189]);
    // Away from the wall there is no place on it, but a place all the same.
    let away = forearm.place(&body([0.1, 0.0, 0.0], [0.0; 3], [0.0; 3]), goal);
    assert!(away[0] < -1.0 && away.iter().all(|x| x.is_finite()), "{away:?}");
    // Without a face: the point of the ray that is nearest to the goal.
    let space = pointer("{kind: ray, from: forearm}");
    assert_near(space.place(&body([0.0; 3], [0.1, 0.0, 0.0], [0.0; 3]), goal), [1.99, 0.0, 0.0]);
    assert_near(space.place(&body([0.1, 0.0, 0.0], [0.0; 3], [0.0; 3]), goal), [0.0; 3]);
}

#[test]
fn go_go_reaches_farther_and_a_cursor_as_far_as_its_gain() {
    let at = |fingertip| body([0.0; 3], [0.0; 3], fingertip);
    let go_go = pointer("{kind: go_go, beyond: 0.4, gain: 10}");
    assert_near(go_go.place(&at([0.0, 0.3, 0.0]), [0.0; 3]), [0.0, 0.3, 0.0]);
    // 0.2 m beyond: 10 * 0.2^2 = 0.4 m more.
    assert_near(go_go.place(&at([0.36, 0.48, 0.0]), [0.0; 3]), [0.6, 0.8, 0.0]);
    let cursor = pointer("{kind: cursor, onto: wall, at: [0.3, -0.1, -0.2], gain: 5}");
    assert_near(cursor.place(&at([0.3, -0.1, -0.2]), [0.0; 3]), [1.99, 0.0, 0.0]);
    // Forward on the table is up on the wall, and depth does nothing.
    assert_near(cursor.place(&at([0.35, -0.08, 0.1]), [0.0; 3]), [1.99, 0.1, 0.25]);
    assert_eq!(pointer("fingertip"), Pointer::Fingertip);
    assert_eq!(pointer("{kind: fingertip}"), Pointer::Fingertip);
}

#[test]
fn a_rate_cursor_goes_on_as_long_as_the_fingertip_is_off_its_rest() {
    let cursor = pointer("{kind: rate_cursor, onto: wall, at: [0.3, 0, -0.2], gain: 4, still: 0.02}");
    let mut body = body([0.0; 3], [0.0; 3], [0.3, -0.07, -0.2]);
    // 5 cm beyond rest to the right: 20 cm/s, a hundredth of a metre per control step of 50 ms.
    for step in 1..=30 {
        for _ in 0..25 {
            body.cursor = cursor.moved(&body, 1.0 / 25.0);
        }
        assert_near(cursor.place(&body, [0.0; 3]), [1.99, -0.01 * f64::from(step), 0.0]);
    }
    body.fingertip = [0.31, 0.01, -0.1];
    assert_eq!(cursor.moved(&body, 1.0), body.cursor, "near its rest nothing moves, and depth does nothing");
    body.fingertip = [0.8, 0.0, -0.2];
    for _ in 0..100 {
        body.cursor = cursor.moved(&body, 1.0);
    }
    assert_near(cursor.place(&body, [0.0; 3]), [1.99, -0.3, 1.0]);
    assert_near(cursor.place_in_time(&body, [1.9, 0.2, -3.0]), [1.99, 0.2, -1.0]);
    let still = pointer("{kind: cursor, onto: wall, at: [0.3, 0, -0.2], gain: 4}");
    assert_eq!(still.moved(&body, 1.0), body.cursor);
}

/// An object that moves is seen where it is until the pointer has gone a centimetre, and where it was from then on.
#[test]
fn what_is_seen_before_the_movement_alone_is_remembered_as_it_was() {
    let text = format!(
        "{}stimulus: before_movement\n",
        text(BALL, "  - follow: {target: ball, for_s: 1}\n  - dwell: {in: ball, for_s: 0.1}")
    );
    let mut run = Run::new(&Task::from_yaml(&text, "t.yaml").unwrap());
    let rest = [0.1, 0.0, 0.0];
    let known = |run: &mut Run, pointer: [f64; 3], begins: bool| {
        let goal = run.goal();
        let known = remember(&goal, pointer, begins, &mut run.state).unwrap();
        run.state.step += 1.0;
        (known, goal)
    };
    for step in 0..10 {
        let (seen, goal) = known(&mut run, rest, step == 0);
        assert_eq!((seen.centre, seen.moves), (goal.centre, goal.moves));
        assert!(seen.is_seen());
    }
    let (last, _) = known(&mut run, [0.109, 0.0, 0.0], false);
    for k in 0..10 {
        // Once begun, a movement stays so, wherever it goes.
        let pointer = if k < 5 { [0.1 + 0.02 * f64::from(k + 1), 0.0, 0.0] } else { rest };
        let (remembered, goal) = known(&mut run, pointer, false);
        assert_eq!((remembered.centre, remembered.size), (last.centre, last.size));
        assert!(remembered.centre != goal.centre && !remembered.is_seen());
        assert_eq!(remembered.moves, Some([0.0; 3]));
    }
    let (seen, goal) = known(&mut run, [0.4, 0.0, 0.0], true);
    assert_eq!(seen.centre, goal.centre, "the next step shows its object again");
    let all = Run::new(&task(BALL, "  - follow: {target: ball, for_s: 1}"));
    assert!(remember(&all.goal(), rest, true, &mut all.state.clone()).is_none());
}

#[test]
fn what_cannot_be_is_refused_by_name_and_place() {
    let with = |technique: &str, scene: &str, script: &str| format!("{}technique: {technique}\n", text(scene, script));
    let ray = "{kind: ray, from: hand, onto: wall}";
    let spots = "  - dwell: {in: spot, for_s: 0.2}";
    let mut wrong = vec![];
    for (text, expected) in [
        (
            text(SLIDER, "  - drag: {slider: s, to: 170, within: 5}"),
            "t.yaml:6:27: `drag.to` of entry 1 of the script is 170; the values of the slider go from 0 to 100",
        ),
        (
            text(SLIDER, "  - drag: {slider: s, to: 70, within: 0}"),
            "t.yaml:6:39: `drag.within` of entry 1 of the script is 0; it must be more than 0, and less than 100",
        ),
        (
            text(LAMPS, "  - drag: {slider: lamps.1, to: 0, within: 1}"),
            "t.yaml:6:20: `lamps.1` is a button; only sliders can be dragged",
        ),
        (text(SLIDER, "  - press: s"), "t.yaml:6:12: `s` is a slider; only buttons can be pressed"),
        (
            text(&SLIDER.replace("value: 20", "value: [20, 120]"), "  - drag: {slider: s, to: 70, within: 5}"),
            "t.yaml:4:75: the value of `s` is 120; its `range` goes from 0 to 100",
        ),
        (
            text(&SLIDER.replace("[0, 100]", "[100, 0]"), "  - drag: {slider: s, to: 70, within: 5}"),
            "goes from 100 to 0; the smaller value must come first",
        ),
        (
            text(
                &BALL.replace(", moves: {kind: circle, diameter: 0.2, period_s: 2}", ""),
                "  - follow: {target: ball, for_s: 1}",
            ),
            "t.yaml:6:22: `ball` does not move (`moves`); `dwell` in it",
        ),
        (
            text(LAMPS, "  - follow: {target: lamps.2, for_s: 1}"),
            "t.yaml:6:22: `lamps.2` is a button; only spheres that move can be followed or tracked",
        ),
        (
            text(LAMPS, "  - track: {target: lamps.2, for_s: 1}"),
            "t.yaml:6:21: `lamps.2` is a button; only spheres that move can be followed or tracked",
        ),
        (
            text(BALL, "  - track: {target: ball, for_s: 700}"),
            "t.yaml:6:34: the time is 700 s; it must be from 0 to 600 s",
        ),
        (text(BALL, "  - track: ball"), "`track`"),
        (
            text(&SINES.replace("up_to_hz: 0.5", "up_to_hz: 50"), "  - track: {target: ball, for_s: 1}"),
            "is 50 Hz; it must be from 0.001 to 5 Hz",
        ),
        (
            text(&SINES.replace("0.1, 0.2", "0, 0").replace("[0.01", "[0"), "  - track: {target: ball, for_s: 1}"),
            "the way of `ball` has no length; write how far it goes, or leave `moves` out",
        ),
        (
            text(
                "  b: {kind: sphere, radius: 0.05, moves: {kind: line, by: [0, 0, 0], period_s: 1}}",
                "  - follow: {target: b, for_s: 1}",
            ),
            "the way of `b` has no length; write how far it goes, or leave `moves` out",
        ),
        (
            text(&BALL.replace("period_s: 2", "period_s: 0.01"), "  - follow: {target: ball, for_s: 1}"),
            "is 0.01 s; it must be from 0.2 to 600 s",
        ),
        (
            text(LAMPS, "  - react: {among: lamps.1, after_s: 1}"),
            "t.yaml:6:20: `react.among` of entry 1 of the script is one object, so there is no choice; write `wait`, and what to do with `lamps.1`",
        ),
        (
            text(&format!("{LAMPS}\n{BALL}"), "  - react: {among: [lamps, ball], after_s: 1}"),
            "`ball` is a sphere, and `lamps.1` is a button; take objects of one kind",
        ),
        (
            text(LAMPS, "  - react: {among: lamps, after_s: 1, for_s: 0.2}"),
            "`react.for_s` of entry 1 of the script is for spheres; buttons are done when they are pressed",
        ),
        (
            text(LAMPS, "  - react: {among: lamps, after_s: [2, 1]}"),
            "the time to wait goes from 2 s to 1 s; the smaller end must come first",
        ),
        (
            text(LAMPS, "  - wait: -1\n  - press: lamps.1"),
            "t.yaml:6:11: the time to wait is -1 s; it must be from 0 to 600 s",
        ),
        (
            text(LAMPS, "  - press: lamps.1\n  - wait: 1"),
            "t.yaml:6:3: the script ends with a wait; write what is to do after it, or leave it out",
        ),
        (
            text(LAMPS, "  - wait: 20\n  - press: lamps.1"),
            "the dwells and waits of all targets add up to 20.00 s but the time limit is 12 s; raise the limit or shorten the dwells",
        ),
        (with(ray, WALL, "  - press: wall"), "`wall` is an obstacle; only buttons can be pressed"),
        (
            with(ray, &format!("{WALL}\n{LAMPS}"), "  - press: lamps.1"),
            "t.yaml:8:12: a ray cannot press, only fingers can; take spheres to dwell in, or `technique: fingertip`",
        ),
        (
            with(ray, &format!("{WALL}\n{SLIDER}"), "  - drag: {slider: s, to: 70, within: 5}"),
            "a ray cannot drag, only fingers can",
        ),
        (
            with("{kind: ray, from: hand, onto: wal}", WALL, spots),
            "t.yaml:10:42: `wal` is no object of the scene; did you mean `wall`?",
        ),
        (
            with("{kind: ray, from: hand, onto: spot}", WALL, spots),
            "`spot` is a sphere; a pointer needs a face, such as that of an obstacle",
        ),
        (
            with(ray, &WALL.replace("1.99", "1.8"), spots),
            "t.yaml:5:9: `spot` is up to 19.0 cm off the face of `wall`, on which a ray points, and no wider; put it there",
        ),
        (with("laser", WALL, spots), "unknown value `laser`"),
        (
            with("{kind: rate_cursor, onto: spot, at: [0.3, 0, 0], gain: 1}", WALL, spots),
            "`spot` is a sphere; a pointer needs a face, such as that of an obstacle",
        ),
        (
            with("{kind: rate_cursor, onto: wall, at: [0.3, 0, 0], gain: 1}", &WALL.replace("1.99", "1.8"), spots),
            "off the face of `wall`, on which a rate cursor points, and no wider; put it there",
        ),
        (
            with("{kind: cursor, onto: wall, at: [0.3, 0, 0], gain: 0}", WALL, spots),
            "is 0; it must be from 0.01 to 100",
        ),
    ] {
        let said = refusal(&text);
        if !said.contains(expected) {
            wrong.push(format!("{text}\nsays: {said}\ninstead of: {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_path_that_leaves_the_reach_is_refused() {
    struct Near;
    impl myo_tasks::Reach for Near {
        fn nearest_in_reach(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
            [x, y.clamp(-0.04, 0.2), z]
        }
    }
    let refused = check(&task(BALL, "  - follow: {target: ball, for_s: 1}"), &Near);
    let said = refused.errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    assert!(said.starts_with("the path of ball leaves the reach of the model: "), "{said}");
    assert!(said.contains("at (0.40, -0.10, "), "{said}");
    let small = BALL.replace("diameter: 0.2", "diameter: 0.1");
    assert!(check(&task(&small, "  - follow: {target: ball, for_s: 1}"), &Near).is_ok());
}
