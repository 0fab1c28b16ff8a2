//! Boxes among everything that they touch: the same however it is computed, and nothing passes through.

mod common;

use common::parts::{Forward, STATES, errors, in_double_precision};
use common::{Look, difference, greatest, in_lanes, narrow_state, random_state, recorded};
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_model::Model;
use myo_model::description::Landmarks;
use myo_model::import::{ImportOptions, from_mjcf};
use myo_scalar::Level;
use std::collections::BTreeMap;

/// A trunk that is a box with a can around it and stands nowhere, and an arm of capsules with a fist that is a box, over a floor and a table.
const BLOCKS: &str = include_str!("../examples/blocks.xml");

/// Without what boxes touch one body at a time.
fn simple() -> String {
    let is_simple = |line: &&str| {
        let two_boxes =
            line.contains("\"fist\"") && !line.contains("\"floor\"") || line.contains("\"table\" geom2=\"trunk\"");
        !line.contains("<pair") || !two_boxes && !line.contains("\"pad\"")
    };
    BLOCKS.lines().filter(is_simple).collect::<Vec<_>>().join("\n")
}

fn exact(text: &str) -> Plan<f64> {
    let files = BTreeMap::from([("blocks.xml".to_owned(), text.to_owned())]);
    let mjcf = myo_mjcf::read_from(&files, "blocks.xml", myo_mjcf::Limits::default()).unwrap();
    let options = ImportOptions::new(Landmarks::new("tip", "arm"));
    Plan::exact(&Model::new(&from_mjcf(&mjcf, &options).unwrap()).unwrap(), CouplingMode::Reduced).unwrap()
}

#[test]
fn every_pair_touches_in_some_states() {
    let plan = exact(BLOCKS);
    // A box beside an ellipsoid is a mesh; the others are boxes.
    assert_eq!((plan.pairs.len(), plan.hulls.len(), plan.touches_one_by_one()), (11, 1, true));
    let mut touching = vec![0; plan.pairs.len()];
    let mut most = vec![0; plan.pairs.len()];
    for found in in_double_precision(&plan) {
        for (number, pair) in plan.pairs.iter().enumerate() {
            let distances = &found[plan.ndof() + pair.slot..][..pair.points];
            let count = distances.iter().filter(|&&distance| distance != 0.0).count();
            touching[number] += u32::from(count > 0);
            most[number] = most[number].max(count);
        }
    }
    assert!(touching.iter().all(|&count| count > 5), "{touching:?}");
    let points: Vec<usize> = plan.pairs.iter().map(|pair| pair.points).collect();
    assert_eq!(points, [4, 4, 8, 2, 2, 1, 1, 8, 8, 2, 4]);
    assert!(most.iter().zip(&points).all(|(most, points)| most <= points), "{most:?}");
}

#[test]
fn the_specialised_plan_is_the_exact_one() {
    let plan = exact(BLOCKS);
    let fast = in_double_precision(&plan.specialised());
    for (number, (wanted, found)) in in_double_precision(&plan).iter().zip(&fast).enumerate() {
        let [acceleration, distance] = errors(plan.ndof(), wanted, found);
        assert!(acceleration < 1e-4 && distance < 1e-9, "state {number}: {acceleration:e}, {distance:e} m");
    }
}

#[test]
fn lanes_touch_as_the_reference_does() {
    let plan = exact(BLOCKS);
    let wanted = in_double_precision(&plan);
    let states: Vec<State<f64>> = (0..STATES).map(|number| narrow_state(&plan, number)).collect();
    for level in Level::available() {
        let found = in_lanes(Forward, level, &plan.specialised().cast(), &states);
        let error = |(wanted, found): (&Vec<f64>, &Vec<f64>)| errors(plan.ndof(), wanted, found);
        let mut all: Vec<[f64; 2]> = wanted.iter().zip(&found).map(error).collect();
        // Rounding decides now and then which of two ways out is the least.
        let others = all.iter().filter(|error| error[1] > 1e-5).count();
        assert!(others < 10, "{}: contacts of {others} of {STATES} states are others", level.name());
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [median, most] = [all[all.len() / 2][0], all[all.len() - 20][0]];
        assert!(median < 1e-5 && most < 1e-2, "{}: {median:e}, {most:e}", level.name());
    }
}

#[test]
fn the_recorded_program_is_as_the_reference() {
    let plan = exact(&simple());
    assert_eq!((plan.pairs.len(), plan.touches_one_by_one()), (7, false));
    let states: Vec<State<f64>> = (0..200).map(|number| narrow_state(&plan, number)).collect();
    let found = recorded(Forward, &plan, &states);
    let mut touching = 0;
    for (number, (wanted, found)) in in_double_precision(&plan).iter().zip(&found).enumerate() {
        touching += u32::from(wanted[plan.ndof()..].iter().any(|&distance| distance != 0.0));
        let [acceleration, distance] = errors(plan.ndof(), wanted, found);
        assert!(acceleration < 1e-5 && distance < 1e-6, "state {number}: {acceleration:e}, {distance:e} m");
    }
    assert!(touching > 100, "{touching}");
}

#[test]
fn nothing_passes_through() {
    let plan = exact(BLOCKS);
    let (mut deepest, mut touched) = (0.0_f64, 0);
    for number in 0..60 {
        let mut ws = Workspace::<f64>::new(&plan);
        let mut state = State { qvel: vec![0.0; plan.ndof()], ..random_state(&plan, number) };
        // From above the table.
        state.qpos[2] += 0.6;
        let distances = Forward.look(&plan, &state, &mut ws).split_off(plan.ndof());
        if distances.iter().any(|&distance| distance != 0.0) {
            continue;
        }
        let mut did_touch = false;
        for _ in 0..600 {
            step::step(&plan, &Obstacles::none(&plan), &[0.3; 2], &mut state, &mut ws);
            for contact in ws.contacts[ws.box_slots..].iter().filter(|contact| contact.exists) {
                did_touch = true;
                deepest = deepest.min(contact.distance);
            }
        }
        assert!(state.qpos.iter().all(|x| x.is_finite()));
        touched += u32::from(did_touch);
    }
    println!("{touched} touched, the deepest by {deepest} m");
    assert!(touched > 10 && deepest > -0.03, "{touched}, {deepest} m");
}

/// Three boxes on each other on a table that is level, and a can beside them.
#[test]
fn what_is_put_on_a_table_stays_there() {
    let free = |name: &str, place: &str, geom: &str| {
        format!(
            r#"<body name="{name}" pos="{place}"><freejoint/><inertial pos="0 0 0" mass="0.5" diaginertia="0.0004 0.0004 0.0004"/>
                 <geom name="{name}" condim="4" friction="0.8 0.02" {geom}/></body>"#
        )
    };
    let boxes = [0.024, 0.073, 0.122].iter().enumerate().map(|(number, height)| {
        free(&format!("box{number}"), &format!("0 0.003 {height}"), r#"type="box" size="0.05 0.04 0.025""#)
    });
    let can = free("can", "0.3 0 0.059", r#"type="cylinder" size="0.03 0.06""#);
    let around = boxes.chain([can]).collect::<String>();
    let text = format!(
        r#"<mujoco><worldbody><geom name="table" type="box" size="0.2 0.2 0.05" pos="0 0 -0.05"/><geom name="floor" type="plane" size="1 1 1"/>{around}
             <body name="arm" pos="0 0 2"><joint name="elbow"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><site name="tip" pos="0 1 0"/></body><site name="post" pos="0.1 0 3"/></worldbody>
             <tendon><spatial name="pull"><site site="post"/><site site="tip"/></spatial></tendon>
             <actuator><muscle name="muscle" tendon="pull" force="1" lengthrange="0.5 3"/></actuator></mujoco>"#
    );
    let plan = exact(&text);
    let mut ws = Workspace::<f64>::new(&plan);
    let mut state = State::<f64>::new(&plan);
    let before = state.qpos.clone();
    for _ in 0..1500 {
        step::step(&plan, &Obstacles::none(&plan), &[0.0], &mut state, &mut ws);
    }
    let touching = plan.pair_points().filter(|number| ws.contacts[ws.box_slots + number].exists).count();
    // Four corners each, and three points of the can and one on its rim.
    assert!(touching >= 15, "{touching} points touch");
    assert!(greatest(&state.qvel[..24]) < 1e-3, "{:?}", state.qvel);
    assert!(difference(&state.qpos[..28], &before[..28]) < 0.005, "{:?}", state.qpos);
}

/// Cans that stand upright, whose axes are those of their bodies in several ways: rounding must not tell them which way they lean.
#[test]
fn cans_stand_in_lanes_and_on_cards() {
    let cans = ["0 0 -.06 0 0 .06", "0 -.06 0 0 .06 0", "-.06 0 0 .06 0 0"].iter().zip([
        "1 0 0 0",
        "0.7071068 0.7071068 0 0",
        "0.7071068 0 0.7071068 0",
    ]);
    let bodies: String = (cans.enumerate())
        .map(|(number, (ends, turn))| {
            format!(
                r#"<body name="can{number}" pos="{number} 0 0.0599" quat="{turn}"><freejoint/><inertial pos="0 0 0" mass="0.5" diaginertia="0.0004 0.0004 0.0004"/>
                     <geom name="can{number}" type="cylinder" conaffinity="0" size="0.03" fromto="{ends}"/></body>"#
            )
        })
        .collect();
    let plan = exact(&format!(
        r#"<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>{bodies}
             <body name="arm" pos="0 0 2"><joint name="elbow"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><site name="tip" pos="0 1 0"/></body><site name="post" pos="0.1 0 3"/></worldbody>
             <tendon><spatial name="pull"><site site="post"/><site site="tip"/></spatial></tendon>
             <actuator><muscle name="muscle" tendon="pull" force="1" lengthrange="0.5 3"/></actuator></mujoco>"#
    ));
    let states = vec![State::<f64>::new(&plan); 16];
    let wanted = Forward.look(&plan, &states[0], &mut Workspace::new(&plan));
    let check = |found: &[f64], of: &str| {
        // Three points of each end, as deep as they stand.
        for (number, pair) in plan.pairs.iter().enumerate().filter(|(_, pair)| pair.points == 4) {
            let distances = &found[plan.ndof() + pair.slot..][..4];
            let deep = distances.iter().filter(|&&distance| (distance + 1e-4).abs() < 1e-6).count();
            assert_eq!(deep, 3, "{of}, pair {number}: {distances:?}");
        }
        let error = difference(&wanted[..plan.ndof()], &found[..plan.ndof()]);
        assert!(error < 0.01 * greatest(&wanted[..plan.ndof()]), "{of}: {error}");
    };
    check(&wanted, "reference");
    for level in Level::available() {
        in_lanes(Forward, level, &plan.specialised().cast(), &states)
            .iter()
            .for_each(|found| check(found, level.name()));
    }
    recorded(Forward, &plan, &states[..1]).iter().for_each(|found| check(found, "recorded"));
}
