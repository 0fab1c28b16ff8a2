//! When the fingertip came to its target, against movements made by hand.

mod common;

use common::version_1;
use myo_tasks::logic::{CompiledTask, Contact, Goal, Landmarks, Point, Sensed, Stay, TaskState, advance};
use myo_tasks::{Pointing, Pressing, Range, Region, Target, Task};

/// Physics steps per control step.
const SUBSTEPS: usize = 25;
/// A point that is in no target and on no button.
const AWAY: Point<f64> = [0.0; 3];
const NO_CONTACT: Contact<f64> = Contact { exists: false, number: 0.0, force: 0.0 };

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
    Contact { exists: true, number: button as f64, force }
}

/// Moves through the targets; `body` says where the fingertip is and what it touches at a physics step since the reset.
/// Returns, per target, the control step at which it was done and the physics step at which it was reached.
fn run(targets: Vec<Target>, body: impl Fn(usize) -> (Point<f64>, Contact<f64>)) -> Vec<(f64, f64)> {
    let task = Task { targets, time_limit_s: 2.0, ..version_1("ar") };
    let compiled = CompiledTask::<f64>::new(&task).unwrap();
    let mut state = TaskState::new(&compiled);
    state.restart(true);
    for (index, sphere) in compiled.spheres.iter().enumerate() {
        (state.position[index], state.size[index]) = (sphere.lo, 0.05);
    }
    for step in 0..40 {
        let goal = Goal::of(&compiled, &state);
        let mut stay = Stay::new(&state, &goal);
        for now in step * SUBSTEPS..(step + 1) * SUBSTEPS {
            let (fingertip, contact) = body(now);
            stay.follow(&compiled, &goal, fingertip, 1.0 / SUBSTEPS as f64, std::iter::once(contact));
        }
        let end = (step + 1) * SUBSTEPS;
        let sensed = Sensed { body: Landmarks::unknown(), pointer: body(end).0, stay, now: end as f64 };
        if advance(&compiled, &goal, &sensed, &mut state).task_done {
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
    for entry in 1..=80_usize {
        // Three ends of control steps must be inside; the first is the one at or after the entry.
        let done = entry.div_ceil(SUBSTEPS) + 2;
        let reached = point(vec![sphere(0.4, 3)], visits(0.4, &[(entry, 1000)]));
        assert_eq!(reached, [(done as f64, entry as f64)]);
    }
}

#[test]
fn a_steady_movement_enters_where_it_crosses_the_surface() {
    // 1 mm a physics step towards a surface at 0.35 m: half a millimetre before it at 356, behind it at 357.
    let movement = |now: usize| [(now as f64 * 0.001 - 0.0065).min(0.4), 0.0, 0.0];
    assert_eq!(point(vec![sphere(0.4, 5)], movement), [(19.0, 357.0)]);
}

#[test]
fn an_entry_that_leaves_before_the_dwell_is_over_does_not_count() {
    // In at 30, out at 90: the ends at 50 and 75 are inside, that at 100 is not. In again at 112.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 90), (112, 1000)])), [(7.0, 112.0)]);
    // Out and in again before the first end inside: the last entry counts.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 35), (40, 1000)])), [(4.0, 40.0)]);
    // Between two ends inside the task sees no slip, so the dwell goes on, and the entry stays that of this dwell.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 55), (60, 1000)])), [(4.0, 30.0)]);
    // A passage between two ends is none.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 45)])), [(-1.0, -1.0)]);
    // Neither is a stay that is too short; it was reached, though.
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(30, 80)])), [(-1.0, 30.0)]);
}

#[test]
fn who_is_there_at_the_start_has_not_moved() {
    assert_eq!(point(vec![sphere(0.4, 3)], visits(0.4, &[(0, 1000)])), [(3.0, 0.0)]);
    // The second sphere overlaps the first. Inside both at the end of the first, at 125: the second is reached then.
    let both = vec![sphere(0.40, 3), sphere(0.44, 2)];
    assert_eq!(point(both, visits(0.42, &[(60, 1000)])), [(5.0, 60.0), (7.0, 125.0)]);
    // Within the second long before, but not at the end of the first: entered at 131.
    let apart = vec![sphere(0.4, 3), sphere(0.6, 2)];
    let there_and_back = |now: usize| match now {
        20..60 | 131..1000 => [0.6, 0.0, 0.0],
        60..126 => [0.4, 0.0, 0.0],
        _ => AWAY,
    };
    assert_eq!(point(apart, there_and_back), [(5.0, 60.0), (7.0, 131.0)]);
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
            30..33 => touch(1, 5.0),
            50..58 => touch(1, 1.0),
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
