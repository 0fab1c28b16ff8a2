//! Parts of a body that touch each other: the same however they are computed, and none passes through another.

mod common;

use common::{Look, difference, draw, greatest, in_lanes, narrow_state, random_state, recorded};
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_model::description::{Contact, Geom, Shape, Softness};
use myo_model::{Model, builtin};
use myo_scalar::{Level, Scalar};

/// A multiple of any number of lanes.
const STATES: u32 = 1024;

/// An arm beside a trunk, with pads on its shoulder blade and its hand: of every pair of shapes one, both of whose bodies move.
fn model() -> Model {
    let mut arm = builtin("mobl-arms").unwrap();
    let along_y = [std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0];
    let mut geom = |name: &str, body: &str, pos: [f64; 3], shape: Shape| {
        let (margin, friction, softness) = (0.0, [1.0, 0.005, 0.0001], Softness::default());
        arm.geoms.push(Geom {
            name: name.into(),
            body: body.into(),
            shape,
            pos,
            quat: along_y,
            margin,
            friction,
            softness,
        });
    };
    geom("trunk", "thorax", [0.05, -0.25, 0.0], Shape::Ellipsoid { radii: [0.16, 0.25, 0.2] });
    geom("head", "thorax", [0.1, 0.15, 0.0], Shape::Sphere { radius: 0.18 });
    geom("upper arm", "humerus", [0.0, -0.145, 0.0], Shape::Capsule { radius: 0.04, half_length: 0.1 });
    geom("forearm", "radius", [0.0, -0.12, 0.0], Shape::Capsule { radius: 0.03, half_length: 0.09 });
    geom("blade", "scapula", [0.0, 0.0, 0.0], Shape::Sphere { radius: 0.19 });
    geom("pad", "hand", [0.0, -0.05, 0.0], Shape::Sphere { radius: 0.11 });
    let pairs = [
        ["upper arm", "trunk"],
        ["trunk", "forearm"],
        ["upper arm", "forearm"],
        ["head", "upper arm"],
        ["pad", "head"],
        ["blade", "forearm"],
        ["trunk", "pad"],
    ];
    arm.contacts = pairs
        .into_iter()
        .map(|pair| Contact {
            geoms: pair.map(String::from),
            margin: 0.002,
            // One slides.
            friction: if pair == ["trunk", "forearm"] { 0.0 } else { 0.8 },
            ..Contact::default()
        })
        .collect();
    Model::new(&arm).unwrap()
}

fn exact() -> Plan<f64> {
    Plan::exact(&model(), CouplingMode::Reduced).unwrap()
}

/// What a step finds: accelerations, then of each pair its distance and its force, zero apart.
#[derive(Clone, Copy)]
struct Forward;

impl Look for Forward {
    #[inline(always)]
    fn look<S: Scalar>(self, plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) -> Vec<S> {
        step::forward(plan, &Obstacles::none(plan), state, ws);
        let mut all = ws.qacc.clone();
        for contact in &ws.contacts[ws.box_slots..] {
            all.extend([contact.distance.only(contact.exists), contact.force.only(contact.exists)]);
        }
        all
    }
}

fn in_double_precision(plan: &Plan<f64>) -> Vec<Vec<f64>> {
    let (exact, mut ws) = (exact(), Workspace::new(plan));
    (0..STATES).map(|number| Forward.look(plan, &narrow_state(&exact, number), &mut ws)).collect()
}

/// Greatest error of accelerations relative to the greatest of them, and of distances (m).
fn errors(ndof: usize, wanted: &[f64], found: &[f64]) -> [f64; 2] {
    let (wanted, found) = (wanted.split_at(ndof), found.split_at(ndof));
    let distances = |of: &[f64]| of.iter().copied().step_by(2).collect::<Vec<f64>>();
    [difference(wanted.0, found.0) / greatest(wanted.0).max(1.0), difference(&distances(wanted.1), &distances(found.1))]
}

#[test]
fn every_pair_touches_in_some_states_and_presses_then() {
    let plan = exact();
    let pairs = plan.pairs.len();
    let mut touching = vec![0; pairs];
    for found in in_double_precision(&plan) {
        for (count, pair) in touching.iter_mut().zip(found[plan.ndof()..].chunks_exact(2)) {
            *count += u32::from(pair[0] != 0.0);
            assert!(pair[0] <= 0.002 && pair[1] >= 0.0, "{pair:?}");
        }
    }
    assert!(pairs == 7 && touching.iter().all(|&count| count > 5), "{touching:?}");
}

#[test]
fn the_specialised_plan_touches_as_the_exact_one_does() {
    let plan = exact();
    let fast = plan.specialised();
    assert!(fast.links.len() < plan.links.len());
    for (number, (wanted, found)) in in_double_precision(&plan).iter().zip(in_double_precision(&fast)).enumerate() {
        let [acceleration, distance] = errors(plan.ndof(), wanted, &found);
        assert!(acceleration < 1e-5 && distance < 1e-7, "state {number}: {acceleration:e}, {distance:e} m");
    }
}

#[test]
fn lanes_touch_as_the_reference_does() {
    let plan = exact();
    let wanted = in_double_precision(&plan);
    let states: Vec<State<f64>> = (0..STATES).map(|number| narrow_state(&plan, number)).collect();
    for level in Level::available() {
        let found = in_lanes(Forward, level, &plan.specialised().cast(), &states);
        let mut all: Vec<[f64; 2]> =
            wanted.iter().zip(&found).map(|(wanted, found)| errors(plan.ndof(), wanted, found)).collect();
        // Where surfaces meet within rounding, contact is there or not; its force is next to nothing.
        assert!(all.iter().all(|error| error[1] < 2e-3), "{}: {all:?}", level.name());
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [median, most] = [all[all.len() / 2], all[all.len() - 1]].map(|error| error[0]);
        assert!(median < 2e-6 && most < 1e-3, "{}: {median:e}, {most:e}", level.name());
        let distances = all.iter().filter(|error| error[1] > 1e-5).count();
        assert!(distances < 10, "{}: {distances} distances differ", level.name());
    }
}

#[test]
fn the_recorded_program_touches_as_the_reference_does() {
    let plan = exact();
    let states: Vec<State<f64>> = (0..300).map(|number| narrow_state(&plan, number)).collect();
    let found = recorded(Forward, &plan, &states);
    for (number, (wanted, found)) in in_double_precision(&plan).iter().zip(&found).enumerate() {
        // Its constants and its limits are those of single precision.
        let [acceleration, distance] = errors(plan.ndof(), wanted, found);
        assert!(acceleration < 1e-5 && distance < 1e-6, "state {number}: {acceleration:e}, {distance:e} m");
    }
}

/// From where nothing touches, whatever muscles do.
#[test]
fn nothing_passes_through() {
    let plan = exact();
    let apart = |state: &State<f64>, ws: &mut Workspace<f64>| {
        Forward.look(&plan, state, ws)[plan.ndof()..].iter().all(|x| *x == 0.0)
    };
    let (mut tried, mut touched, mut deepest) = (0, 0, 0.0_f64);
    for number in 0..200 {
        let mut ws = Workspace::<f64>::new(&plan);
        let mut state = State { qvel: vec![0.0; plan.ndof()], ..random_state(&plan, number) };
        if !apart(&state, &mut ws) {
            continue;
        }
        tried += 1;
        let ctrl: Vec<f64> = (0..plan.nmuscle()).map(|k| draw(7000 + number, k).round()).collect();
        let mut did_touch = false;
        for _ in 0..500 {
            step::step(&plan, &Obstacles::none(&plan), &ctrl, &mut state, &mut ws);
            for contact in ws.contacts[ws.box_slots..].iter().filter(|contact| contact.exists) {
                did_touch = true;
                deepest = deepest.min(contact.distance);
            }
        }
        touched += u32::from(did_touch);
    }
    // Half of all muscles at full force, at several metres a second.
    println!("{touched} of {tried} touched, the deepest by {deepest} m");
    assert!(tried > 50 && touched > 20 && deepest > -0.03, "{touched} of {tried}, {deepest} m");
}
