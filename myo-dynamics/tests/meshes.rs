//! Convex meshes that touch each other and all other shapes: the same in lanes, and nothing passes through.

mod common;

use common::parts::{Forward, STATES, errors, in_double_precision};
use common::{Look, in_lanes, narrow_state, random_state};
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_model::Model;
use myo_model::description::Landmarks;
use myo_model::import::{ImportOptions, from_mjcf};
use myo_scalar::Level;
use std::collections::BTreeMap;

/// A body that stands nowhere, with an arm, both with a rock of eight corners that no two coordinates of are the same; over a floor, beside one of every shape.
const ROCKS: &str = r#"<mujoco model="rocks">
  <compiler angle="radian"/>
  <default><geom contype="1" conaffinity="1" margin="0.001"/></default>
  <asset>
    <mesh name="rock" vertex="-.11 -.052 -.051 .1 -.061 -.055 .112 .063 -.047 -.093 .058 -.062 -.102 -.049 .053 .107 -.066 .064 .097 .055 .059 -.105 .071 .048" face="0 1 2 2 3 4 5 6 7"/>
    <mesh name="wedge" vertex="-.05 -.04 -.03 .06 -.05 -.02 .01 .07 -.035 .02 .01 .09" face="0 1 2 1 2 3"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <geom name="post" type="cylinder" size="0.08 0.2" pos="0.35 0 0.2" quat="1 0.2 0.1 0"/>
    <geom name="rail" type="capsule" size="0.03 0.3" pos="-0.2 0.2 0.3" quat="1 1 0.2 0"/>
    <geom name="ball" type="ellipsoid" size="0.1 0.15 0.08" pos="0 -0.3 0.3"/>
    <body name="trunk" pos="0.1 0 0.4">
      <freejoint name="root"/>
      <inertial pos="0 0 0" mass="3" diaginertia="0.02 0.03 0.025"/>
      <geom name="stone" type="mesh" mesh="rock"/>
      <site name="origin" pos="0.1 0 0"/>
      <body name="arm" pos="0.13 0 0">
        <joint name="elbow" axis="0 1 0" range="-2 2" limited="true" damping="0.1"/>
        <inertial pos="0.08 0 0" mass="1" diaginertia="0.002 0.003 0.0025"/>
        <geom name="tooth" type="mesh" mesh="wedge" pos="0.1 0 0" quat="1 0.3 0 0.2"/>
        <site name="tip" pos="0.15 0 0"/>
        <body name="hand" pos="0.08 0 0">
          <joint name="wrist" axis="0 1 0.2" range="-2.6 2.6" limited="true" damping="0.1"/>
          <inertial pos="0.05 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
          <geom name="claw" type="mesh" mesh="wedge" pos="0.05 0 0" quat="1 0 0.8 0"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon><spatial name="pull"><site site="origin"/><site site="tip"/></spatial></tendon>
  <actuator><muscle name="muscle" tendon="pull" force="20" lengthrange="0.05 0.3"/></actuator>
</mujoco>"#;

fn exact() -> Plan<f64> {
    let files = BTreeMap::from([("rocks.xml".to_owned(), ROCKS.to_owned())]);
    let mjcf = myo_mjcf::read_from(&files, "rocks.xml", myo_mjcf::Limits::default()).unwrap();
    let options = ImportOptions::new(Landmarks::new("tip", "trunk"));
    Plan::exact(&Model::new(&from_mjcf(&mjcf, &options).unwrap()).unwrap(), CouplingMode::Reduced).unwrap()
}

#[test]
fn every_pair_touches_in_some_states() {
    let plan = exact();
    // Stone, tooth and claw with four things each, and the two that do not hang on each other.
    assert_eq!((plan.pairs.len(), plan.hulls.len()), (13, 2));
    let mut touching = vec![0; plan.pairs.len()];
    for found in in_double_precision(&plan) {
        for (count, pair) in touching.iter_mut().zip(&plan.pairs) {
            let distances = &found[plan.ndof() + pair.slot..][..pair.points];
            *count += u32::from(distances[0] != 0.0);
            // Slots are filled from the first.
            assert!(distances.windows(2).all(|two| two[0] != 0.0 || two[1] == 0.0), "{distances:?}");
        }
    }
    assert!(touching.iter().all(|&count| count > 5), "{touching:?}");
}

#[test]
fn the_specialised_plan_is_the_exact_one() {
    let plan = exact();
    let mut ws = Workspace::new(&plan);
    let fast = plan.specialised();
    let mut fast_ws = Workspace::new(&fast);
    for number in 0..300 {
        let state = narrow_state(&plan, number);
        let (wanted, found) = (Forward.look(&plan, &state, &mut ws), Forward.look(&fast, &state, &mut fast_ws));
        let [acceleration, distance] = errors(plan.ndof(), &wanted, &found);
        assert!(acceleration < 1e-4 && distance < 1e-9, "state {number}: {acceleration:e}, {distance:e} m");
    }
}

#[test]
fn lanes_touch_as_the_reference_does() {
    let plan = exact();
    let wanted = in_double_precision(&plan);
    let states: Vec<State<f64>> = (0..STATES).map(|number| narrow_state(&plan, number)).collect();
    for level in Level::available() {
        let found = in_lanes(Forward, level, &plan.specialised().cast(), &states);
        let error = |(wanted, found): (&Vec<f64>, &Vec<f64>)| errors(plan.ndof(), wanted, found);
        let mut all: Vec<[f64; 2]> = wanted.iter().zip(&found).map(error).collect();
        // Rounding decides now and then which of two ways out is the least, or whether a face lies on another.
        let others = all.iter().filter(|error| error[1] > 1e-5).count();
        assert!(others < 20, "{}: contacts of {others} of {STATES} states are others", level.name());
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [median, most] = [all[all.len() / 2][0], all[all.len() - 20][0]];
        assert!(median < 1e-5 && most < 1e-2, "{}: {median:e}, {most:e}", level.name());
    }
}

#[test]
fn nothing_passes_through() {
    let plan = exact();
    let (mut deepest, mut touched) = (0.0_f64, 0);
    for number in 0..60 {
        let mut ws = Workspace::<f64>::new(&plan);
        let mut state = State { qvel: vec![0.0; plan.ndof()], ..random_state(&plan, number) };
        let distances = Forward.look(&plan, &state, &mut ws).split_off(plan.ndof());
        if distances.iter().any(|&distance| distance != 0.0) {
            continue;
        }
        let mut did_touch = false;
        for _ in 0..600 {
            step::step(&plan, &Obstacles::none(&plan), &[0.3], &mut state, &mut ws);
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
