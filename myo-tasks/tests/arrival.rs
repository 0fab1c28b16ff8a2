//! When the fingertip came to its target, against movements made by hand.

use crate::common::version_1;
use myo_tasks::logic::{CompiledTask, Contact, Goal, Landmarks, Point, Sensed, Stay, TaskState, advance};
use myo_tasks::{Pointing, Pressing, Range, Region, Target, Task};

/// Physics steps per control step.
const SUBSTEPS: usize = 25;
/// A point that is in no target and on no button.
const AWAY: Point<f64> = [0.0; 3];
const NO_CONTACT: Contact<f64> = Contact { exists: false, finger: 0, number: 0.0, force: 0.0, facing: 1.0 };

/// A sphere of 5 cm around a point `x` m ahead; its dwell in control steps.
fn sphere(x: f64, dwell: u32) -> Target {
    let position = Region { x: Range::fixed(x), y: Range::fixed(0.0), z: Range::fixed(0.0) };
    let dwell_s = 0.05 * f64::from(dwell);
    Target::Pointing(Pointing {
        position,
        radius: Range::fixed(0.05),
        dwell_s,
        min_distance_from_previous: None,
        repeat: 1,
    })
}

/// A button that wants 2 N.
fn button() -> Target {
    Target::Pressing(Pressing { position: [0.4, 0.0, 0.0], size: [0.06, 0.04, 0.02], tilt_deg: 90.0, min_force_n: 2.0 })
}

/// A contact with a button.
fn touch(button: usize, force: f64) -> Contact<f64> {
    Contact { exists: true, finger: 0, number: button as f64, force, facing: 1.0 }
}

/// Moves through the targets; `body` says where the fingertip is and what it touches at a physics step since the reset.
/// Returns, per target, the control step at which it was done and the physics step at which it was reached.
fn run(targets: Vec<Target>, body: impl Fn(usize) -> (Point<f64>, Contact<f64>)) -> Vec<(f64, f64)> {
    run_at(SUBSTEPS, targets, body)
}

/// The same with so many physics steps of 2 ms per control step.
fn run_at(
    substeps: usize,
    targets: Vec<Target>,
    body: impl Fn(usize) -> (Point<f64>, Contact<f64>),
) -> Vec<(f64, f64)> {
    let (control_dt_s, share) = (0.002 * substeps as f64, 1.0 / substeps as f64);
    let task = Task { targets, control_dt_s, time_limit_s: 2.0, ..version_1("ar") };
    let compiled = CompiledTask::<f64>::new(&task).unwrap();
    let mut state = TaskState::new(&compiled);
    state.restart(true);
    for (index, sphere) in compiled.spheres.iter().enumerate() {
        (state.position[index], state.size[index]) = (sphere.lo, 0.05);
    }
    for step in 0..1000 / substeps {
        let goal = Goal::of(&compiled, &state);
        let mut stay = Stay::new(&state, &goal);
        for now in step * substeps..(step + 1) * substeps {
            let (fingertip, contact) = body(now);
            stay.follow(&compiled, &goal, &Landmarks::unknown(), fingertip, share, std::iter::once(contact));
        }
        let end = (step + 1) * substeps;
        let sensed = Sensed { body: Landmarks::unknown(), pointer: body(end).0, stay, now: end as f64 };
        if advance(&compiled, &goal, &sensed, &mut state, share).task_done {
            break;
        }
    }
    state.done_at.iter().copied().zip(state.reached_at.iter().copied()).collect()
}

/// Of a movement without contact.
fn point(targets: Vec<Target>, fingertip: impl Fn(usize) -> Point<f64>) -> Vec<(f64, f64)> {
    run(targets, |now| (fingertip(now), NO_CONTACT))
}

/// Inside a sphere ahead between these physics steps, the second of each pair excluded, else away.
fn visits(x: f64, stays: &[(usize, usize)]) -> impl Fn(usize) -> Point<f64> {
    move |now| if stays.iter().any(|(enter, leave)| (*enter..*leave).contains(&now)) { [x, 0.0, 0.0] } else { AWAY }
}

#[test]
fn an_entry_is_known_to_the_physics_step() {
    for entry in 0..=80_usize {
        // 75 physics steps must be inside; it is done at the end of the control step of the last.
        let done = (entry + 75).div_ceil(SUBSTEPS);
        let reached = point(vec![sphere(0.4, 3)], visits(0.4, &[(entry, 1000)]));
        assert_eq!(reached, [(done as f64, entry as f64)]);
    }
}

#[test]
fn a_steady_movement_enters_where_it_crosses_the_surface() {
    // 1 mm a physics step towards a surface at 0.35 m: half a millimetre before it at 356, behind it at 357.
    let movement = |now: usize| [(now as f64 * 0.001 - 0.0065).min(0.4), 0.0, 0.0];
    // 125 steps more are 482, within the 20th control step.
    assert_eq!(point(vec![sphere(0.4, 5)], movement), [(20.0, 357.0)]);
}

#[test]
fn an_entry_that_leaves_before_the_dwell_is_over_does_not_count() {
    // In at 30, out at 90: 60 steps of 75. In again at 112, over at 187.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 90), (112, 1000)])), [(8.0, 112.0)]);
    // Out and in again within a control step: the last entry counts, and it is over at 115.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 35), (40, 1000)])), [(5.0, 40.0)]);
    // A slip between two ends of control steps, both inside, is one: it is over at 135, not at 105.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 55), (60, 1000)])), [(6.0, 60.0)]);
    // So is one of a single physics step: it is over at 131.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 55), (56, 1000)])), [(6.0, 56.0)]);
    // A passage between two ends is none, and neither is a stay that is too short by one step.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 45)])), [(-1.0, -1.0)]);
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 104)])), [(-1.0, -1.0)]);
}

#[test]
fn a_dwell_that_is_over_stays_so() {
    // In for 75 steps, over at 105, and out until the control step ends at 125, or in again.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 105)])), [(5.0, 30.0)]);
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 105), (108, 1000)])), [(5.0, 30.0)]);
    // Out at the very end, where it is judged.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(50, 125)])), [(5.0, 50.0)]);
}

/// The sphere of a dwell of so many seconds.
fn sphere_for(dwell_s: f64) -> Target {
    let Target::Pointing(pointing) = sphere(0.4, 0) else { panic!("a sphere") };
    Target::Pointing(Pointing { dwell_s, ..pointing })
}

#[test]
fn a_movement_is_judged_the_same_at_any_control_step() {
    // In at 33, a slip of four physics steps from 133 on, in again at 137; 0.25 s are 125 steps. Between the two entries are 104.
    let movement = visits(0.4, &[(33, 133), (137, 1000)]);
    for substeps in [50_usize, 25, 10, 5] {
        let control_dt_s = 0.002 * substeps as f64;
        // Over at 262, 0.524 s: known at the end of this control step, never a whole one later.
        let done = 262_usize.div_ceil(substeps);
        let [(done_at, reached_at)] = run_at(substeps, vec![sphere_for(0.25)], |now| (movement(now), NO_CONTACT))[..]
        else {
            panic!("one target")
        };
        assert_eq!((done_at, reached_at), (done as f64, 137.0), "every {control_dt_s} s");
        // Where the movement ends decides it to the physics step.
        for (end, is_done) in [(261, false), (262, true)] {
            let stays = [(33, 133), (137, end)];
            let until = visits(0.4, &stays);
            let [(done_at, _)] = run_at(substeps, vec![sphere_for(0.25)], |now| (until(now), NO_CONTACT))[..] else {
                panic!("one target")
            };
            assert_eq!(done_at > 0.0, is_done, "every {control_dt_s} s, until {end}");
        }
    }
}

#[test]
fn a_dwell_is_as_long_as_it_says() {
    // 0.25 s at 50 Hz are twelve and a half control steps, 125 physics steps.
    let dwell = |substeps: usize, seconds: f64, stay: usize| {
        let stays = [(7, 7 + stay)];
        let until = visits(0.4, &stays);
        run_at(substeps, vec![sphere_for(seconds)], |now| (until(now), NO_CONTACT))[0]
    };
    assert_eq!(dwell(10, 0.25, 124), (-1.0, -1.0));
    // Over at 132.
    assert_eq!(dwell(10, 0.25, 125), (14.0, 7.0));
    // Less than a control step: 0.03 s at 20 Hz are 15 physics steps, over at 22.
    assert_eq!(dwell(25, 0.03, 14), (-1.0, -1.0));
    assert_eq!(dwell(25, 0.03, 15), (1.0, 7.0));
    // The physics step nearest to what lies between two: 0.0312 s are 15.6.
    assert_eq!(dwell(25, 0.0312, 15), (-1.0, -1.0));
    assert_eq!(dwell(25, 0.0312, 16), (1.0, 7.0));
    // At once: the first physics step inside.
    for (substeps, done) in [(50, 1.0), (25, 1.0), (10, 1.0), (5, 2.0)] {
        assert_eq!(dwell(substeps, 0.0, 1), (done, 7.0));
        assert_eq!(dwell(substeps, 0.0, 0), (-1.0, -1.0));
    }
}

/// Numbers of single precision, and dwells of any length, at every control step: as many physics steps as it says.
#[test]
fn no_rounding_adds_up() {
    for substeps in [1_u32, 5, 10, 25, 50] {
        let share = 1.0 / f64::from(substeps);
        for steps in [2_u32, 25, 49, 125, 3001, 30_000, 299_999] {
            let task = Task {
                targets: vec![sphere_for(0.002 * f64::from(steps))],
                control_dt_s: 0.002 * f64::from(substeps),
                time_limit_s: 600.0,
                ..version_1("ar")
            };
            let compiled = CompiledTask::<f32>::new(&task).unwrap();
            let mut state = TaskState::new(&compiled);
            state.size[0] = 0.05;
            // Two steps before the last.
            state.held = steps as f32 - 2.0;
            let goal = Goal::of(&compiled, &state);
            let mut stay = Stay::new(&state, &goal);
            let inside = |stay: &mut Stay<f32>| {
                stay.follow(&compiled, &goal, &Landmarks::unknown(), [0.0; 3], share, std::iter::empty());
                stay.pressed
            };
            assert_eq!(inside(&mut stay), 0.0, "{steps} steps, {substeps} a control step");
            assert_eq!(inside(&mut stay), steps as f32, "{steps} steps, {substeps} a control step");
        }
    }
}

#[test]
fn who_is_there_at_the_start_has_not_moved() {
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(0, 1000)])), [(3.0, 0.0)]);
    // The second sphere overlaps the first, which is over at 135. Inside both at the end of its control step, at 150: the second is
    // reached then, and over at 200.
    let both = vec![sphere(0.40, 3), sphere(0.44, 2)];
    assert_eq!(point(both, visits(0.42, &[(60, 1000)])), [(6.0, 60.0), (8.0, 150.0)]);
    // Within the second long before, but not at the end of the first, at 150: entered at 156, over at 206.
    let apart = vec![sphere(0.4, 3), sphere(0.6, 2)];
    let there_and_back = |now: usize| match now {
        20..60 | 156..1000 => [0.6, 0.0, 0.0],
        60..140 => [0.4, 0.0, 0.0],
        _ => AWAY,
    };
    assert_eq!(point(apart, there_and_back), [(6.0, 60.0), (9.0, 156.0)]);
}

#[test]
fn a_press_is_reached_with_the_onset_of_its_contact() {
    let press = |forces: Vec<(std::ops::Range<usize>, f64)>| {
        run(vec![button()], move |now| {
            let force = forces.iter().find(|(range, _)| range.contains(&now)).map(|(_, force)| *force);
            (AWAY, force.map_or(NO_CONTACT, |force| touch(0, force)))
        })
    };
    // A tap within a control step, judged at 50.
    assert_eq!(press(vec![(37..40, 3.0)]), [(2.0, 37.0)]);
    // Laid on at 12, pressed at 60: the contact began at 12.
    assert_eq!(press(vec![(12..60, 0.5), (60..70, 2.0)]), [(3.0, 12.0)]);
    // A touch that does not press, away, and a press.
    assert_eq!(press(vec![(12..60, 1.9), (61..70, 2.5)]), [(3.0, 61.0)]);
    // The first of two presses in a control step counts, however hard the second is.
    assert_eq!(press(vec![(51..55, 2.5), (60..70, 9.0)]), [(3.0, 51.0)]);
    // Contact without force is contact, but no press.
    assert_eq!(press(vec![(5..1000, 0.0)]), [(-1.0, -1.0)]);
    assert_eq!(press(vec![(0..20, 3.0)]), [(1.0, 0.0)]);
}

#[test]
fn each_target_is_reached_by_what_it_asks_for() {
    // Inside the sphere while the button is asked for, in contact with the other button while the sphere is.
    let targets = vec![button(), sphere(0.4, 2), button()];
    let reached = run(targets, |now| {
        let fingertip = if (10..300).contains(&now) { [0.4, 0.0, 0.0] } else { AWAY };
        let contact = match now {
            10..13 => touch(1, 5.0),
            30..38 => touch(1, 1.0),
            58..62 => touch(0, 2.0),
            80..200 => touch(1, 1.0),
            200..210 => touch(1, 4.0),
            _ => NO_CONTACT,
        };
        (fingertip, contact)
    });
    // The first is pressed from 58 on and done at 75, the start of the second, which is done at 125. In contact with the third
    // then, it is reached with its start.
    assert_eq!(reached, [(3.0, 58.0), (5.0, 75.0), (9.0, 125.0)]);
}
