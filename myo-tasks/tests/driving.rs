//! Vehicles that a stick drives along a line.

use crate::common::run::{Deed, OFF, Run, SUBSTEPS, refusal, task, text};
use myo_tasks::logic::{Goal, Kinds, sphere};
use myo_tasks::{Action, Anywhere, check};

/// Ten centimetres long, on a table before the user; it swings to the right, and back to the middle when it is left.
const LEVER: &str =
    "  lever: {kind: stick, at: [0.4, 0, -0.2], length: 0.1, knob: 0.02, range_deg: [-20, 30], springs_back_s: 0.1}";
const CAR: &str = "  car: {kind: sphere, at: [2, 0.5, 0], radius: 0.1, moves: {kind: driven, by: [0, -3, 0], acceleration: 3, drag_per_s: 1.5}}";
const GARAGE: &str = "  garage: {kind: sphere, at: [2, -1, 0.05], radius: 0.3}";
const DRIVE: &str = "  - drive: {stick: lever, vehicle: car, into: garage}";
/// Seconds of a physics step.
const DT: f64 = 0.05 / SUBSTEPS as f64;

fn scene() -> String {
    [LEVER, CAR, GARAGE].join("\n")
}

/// On the knob's circle, at an angle in degrees.
fn at(degrees: f64) -> Deed {
    let (sin, cos) = degrees.to_radians().sin_cos();
    ([0.4, -0.1 * sin, -0.2 + 0.1 * cos], None)
}

/// The stick is taken in the middle and brought there within half a second.
fn brought_to(degrees: f64) -> impl Fn(usize) -> Deed {
    move |now| at(degrees * (now as f64 / 250.0).min(1.0))
}

/// Angle of the stick (degrees), place of the car on its line (m), and its speed (m/s).
fn now(run: &Run) -> [f64; 3] {
    let vehicles = run.state.vehicles.as_ref().unwrap();
    [run.state.sticks.as_ref().unwrap().angles[0].to_degrees(), vehicles.along[1], vehicles.speed]
}

#[test]
fn a_vehicle_is_as_fast_as_its_stick_and_its_drag_allow() {
    let task = task(&scene(), DRIVE);
    let flat = task.flat().unwrap();
    assert_eq!(flat.label(0), "drive car into garage");
    assert_eq!(flat.steps[0].action, Action::Drive { vehicle: 1, into: 2, slower_than: 0.05 });
    assert!(check(&task, &Anywhere).errors.is_empty());
    let mut run = Run::new(&task);
    let Kinds { swing, drive, motion, .. } = run.task.kinds;
    assert!(swing && drive && !motion);
    assert_eq!(now(&run), [0.0; 3], "it springs back to 0, so it begins there");
    // Half of its greatest angle, which is the greater of the two: by 3 / 2 m/s^2, for a second and a half after half a second.
    let pushed = brought_to(15.0);
    assert!(!run.run(40, |_, now| pushed(now)));
    let [angle, along, speed] = now(&run);
    assert!((angle - 15.0).abs() < 1e-3, "{angle}");
    // v' = a(t) - 1.5 v, a(t) rising to 1.5 m/s^2 within half a second.
    let (mut v, mut x, fine) = (0.0, 0.0, DT / 100.0);
    for k in 0..(2.0 / fine) as usize {
        let a = 1.5 * (k as f64 * fine / 0.5).min(1.0);
        v += fine * (a - 1.5 * v);
        x += fine * v;
    }
    assert!((speed - v).abs() < 5e-3 && (along - x).abs() < 5e-3, "{speed} {v}, {along} {x}");
    assert!((v - 0.9).abs() < 0.1, "near its greatest speed, 1 m/s: {v}");
    // Where the stick is to the right, the car goes to the right; it is seen where it is.
    let (centre, ..) = sphere(&run.task, &run.state, 1.0);
    assert!((centre[1] - (0.5 - along)).abs() < 1e-12 && centre[0] == 2.0 && centre[2] == 0.0);
    let drive = run.goal().drive.unwrap();
    let way = drive.way_left(drive.ride.along);
    assert!((way[1] - (-1.5 + along)).abs() < 1e-12 && (way[2] - 0.05).abs() < 1e-12, "{way:?}");
}

#[test]
fn who_lets_go_finds_the_stick_in_the_middle_and_the_vehicle_coasting() {
    let mut run = Run::new(&task(&scene(), DRIVE));
    let pushed = brought_to(-20.0);
    assert!(!run.run(20, |_, now| pushed(now)));
    let [_, before, speed] = now(&run);
    assert!(speed < -0.5, "{speed}");
    // A tenth of a second later.
    assert!(!run.run(2, |_, _| OFF));
    let [angle, ..] = now(&run);
    assert!((angle / -20.0 - (-1.0_f64).exp()).abs() < 0.01, "{angle}");
    assert!(!run.run(100, |_, _| OFF));
    let [angle, along, speed] = now(&run);
    assert!(angle.abs() < 1e-9 && speed.abs() < 1e-3 && along < before, "{angle} {speed} {along}");
    // At the end of its line it stops, however hard it is driven.
    assert!(!run.run(200, |_, now| brought_to(-20.0)(now - 122 * SUBSTEPS)));
    assert_eq!(now(&run)[1..], [-3.0, 0.0]);
    let (centre, ..) = sphere(&run.task, &run.state, 1.0);
    assert!((centre[1] - 3.5).abs() < 1e-9);
}

/// Full speed up to where braking begins, then against it until it stands.
fn driver(brake: f64) -> impl Fn(&Goal<f64>, usize) -> Deed {
    move |goal, _| {
        let drive = goal.drive.unwrap();
        let (left, speed) = (drive.way_left(drive.ride.along)[1].abs(), drive.ride.speed);
        let wanted = if left > brake { 0.8 } else { -2.0 * speed };
        // The knob is followed closely: nobody loses it.
        let held = goal.swing.unwrap().angle.to_degrees();
        at((held + (30.0 * wanted.clamp(-0.6, 1.0) - held).clamp(-6.0, 6.0)).clamp(-20.0, 30.0))
    }
}

#[test]
fn it_is_done_when_the_vehicle_stops_inside_and_not_when_it_passes() {
    let task = task(&scene(), DRIVE);
    let mut run = Run::new(&task);
    assert!(!run.run(60, |goal, now| driver(-1.0)(goal, now)), "it went through");
    assert!(now(&run)[1] > 1.8);
    let mut run = Run::new(&task);
    assert!(run.run(120, |goal, now| driver(0.4)(goal, now)), "{:?}", now(&run));
    let [_, along, speed] = now(&run);
    let off = f64::hypot(1.5 - along, 0.05);
    assert!(off < 0.3 && speed == 0.0, "{off} {speed}");
    // It came to a stop in the last control step.
    let [reached, done] = [run.state.reached_at[0], SUBSTEPS as f64 * run.state.done_at[0]];
    assert!(done - SUBSTEPS as f64 <= reached && reached <= done, "{reached} {done}");
}

#[test]
fn vehicles_stand_where_they_were_left_while_others_are_driven() {
    let both = format!(
        "{}\n{}\n{}",
        scene(),
        CAR.replace("car", "van"),
        GARAGE.replace("garage", "yard").replace("-1, 0.05", "2, 0")
    );
    let second = DRIVE.replace("car", "van").replace("garage", "yard");
    let task = task(&both, &format!("{DRIVE}\n{second}\n{}", DRIVE.replace("garage", "yard")));
    let mut run = Run::new(&task);
    assert!(!run.run(120, |goal, now| if goal.drive.unwrap().step.vehicle == 1.0 {
        driver(0.4)(goal, now)
    } else {
        OFF
    }));
    let left = run.state.vehicles.clone().unwrap();
    // The stick was held aslant when the turn came to the van, and went back.
    assert!((left.along[1] - 1.5).abs() < 0.3 && left.along[3].abs() < 0.05 && left.speed.abs() < 1e-3, "{left:?}");
    assert_eq!(run.state.phase, 1.0);
}

#[test]
fn a_vehicle_that_stands_there_already_waits_for_its_turn() {
    let there = format!("{LEVER}\n{CAR}\n{}", GARAGE.replace("-1, 0.05", "0.5, 0"));
    let mut run = Run::new(&task(&there, &format!("  - wait: 0.5\n{DRIVE}")));
    assert!(!run.run(10, |_, _| OFF), "nothing counts before the time is over");
    assert!(run.run(1, |_, _| OFF), "{:?}", now(&run));
}

#[test]
fn what_cannot_be_driven_is_refused() {
    let told = |scene: &str, script: &str, sentence: &str| {
        let said = refusal(&text(scene, script));
        assert!(said.contains(sentence), "{said}");
    };
    let scene = scene();
    told(&scene, &DRIVE.replace("lever", "car"), "`car` is a sphere; only sticks drive something");
    told(
        &scene,
        &DRIVE.replace("vehicle: car", "vehicle: garage"),
        "`garage` cannot be driven; take a sphere with `moves: {kind: driven",
    );
    told(
        &scene,
        &DRIVE.replace("into: garage", "into: car"),
        "`car` is no place to stop in; take a sphere that stands still",
    );
    told(&scene, &DRIVE.replace("into: garage", "into: lever"), "`lever` is no place to stop in");
    told(
        &scene.replace("-1, 0.05", "-1, 0.4"),
        DRIVE,
        "`garage` may be 0.400 m beside the way of `car`, more than its radius, 0.300 m",
    );
    told(
        &scene.replace("[0, -3, 0]", "[0, -2, 0]").replace("[2, -1,", "[2, [-2, 1],"),
        DRIVE,
        "`garage` may be 0.502 m beside the way",
    );
    told(&scene, &DRIVE.replace("garage}", "garage, slower_than: 0}"), "must be from 0.001 to 10 m/s");
    told(&scene, "  - track: {target: car, for_s: 3}", "`car` moves only while it is driven; `drive` it");
    told(
        &scene,
        "  - swing: {stick: lever, to_deg: 20, within_deg: 5}",
        "`lever` springs back to 0 degrees when it is left",
    );
    told(
        &scene.replace("[-20, 30]", "[10, 30], angle_deg: 10"),
        DRIVE,
        "a stick springs back to 0, which must be within",
    );
    // The state has the speed of one vehicle: none may take the place of another on its way.
    told(
        &scene,
        "  - any_order: [{drive: {stick: lever, vehicle: car, into: garage}}, {drive: {stick: lever, vehicle: car, into: garage}}]",
        "which nothing but its order tells from others",
    );
    told(&scene.replace("[0, -3, 0]", "[0, 0, 0]"), DRIVE, "has no length; write how far it goes");
    told(&scene.replace("acceleration: 3", "acceleration: 0"), DRIVE, "must be from 0.01 to 1000 m/s^2");
}

#[test]
fn the_way_that_the_vehicle_must_go_costs_as_the_way_to_the_knob_does() {
    use myo_tasks::logic::distance_to_goal;
    let run = Run::new(&task(&scene(), DRIVE));
    let far = run.sensed_at([0.4, 0.2, -0.1]);
    let to_garage = f64::hypot(1.5, 0.05) - 0.3;
    let distance = distance_to_goal(&run.task, &far, &run.goal());
    assert!((distance - (0.2 - 0.02) - to_garage).abs() < 1e-9, "{distance}");
}
