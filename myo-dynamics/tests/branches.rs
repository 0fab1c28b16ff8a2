//! Tendons that divide and tendons that are limited: the same however they are computed, and a divided tendon is what it is said to be.

mod common;

use common::{Look, difference, draw, greatest, in_lanes, narrow_state, random_state, recorded};
use myo_dynamics::step::force::moment_arms;
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_model::description::{Landmarks, PathElement, Pulley, Softness, TendonLimit};
use myo_model::import::{ImportOptions, from_mjcf};
use myo_model::{Model, ModelDescription, builtin};
use myo_scalar::{Level, Scalar};

/// A multiple of any number of lanes.
const STATES: u32 = 1024;

/// The arm, whose biceps divides into branches of two thirds and one third, the second the way of another muscle; and limits that some of its muscles come to.
fn description() -> ModelDescription {
    let mut arm = builtin("mobl-arms").unwrap();
    let [long, short] =
        ["BIClong", "BRA"].map(|name| arm.muscles.iter().position(|muscle| muscle.name == name).unwrap());
    let other = arm.muscles[short].path.clone();
    let path = &mut arm.muscles[long].path;
    path.insert(0, PathElement::Pulley(Pulley { pulley: 1.5 }));
    path.push(PathElement::Pulley(Pulley { pulley: 3.0 }));
    path.extend(other);
    for name in ["BIClong", "TRIlong", "DELT1", "PT"] {
        let muscle = arm.muscles.iter_mut().find(|muscle| muscle.name == name).unwrap();
        muscle.limit = Some(TendonLimit { range: [-1.0, 1.0], margin: 0.002, softness: Softness::default() });
    }
    // Each limit cuts off some of what the joints allow.
    let plan = Plan::exact(&Model::new(&arm).unwrap(), CouplingMode::Reduced).unwrap();
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; plan.nmuscle()];
    for number in 0..STATES {
        let mut ws = Workspace::new(&plan);
        step::forward(&plan, &Obstacles::none(&plan), &random_state(&plan, number), &mut ws);
        for (range, &length) in ranges.iter_mut().zip(&ws.tendon_length) {
            *range = [range[0].min(length), range[1].max(length)];
        }
    }
    for (muscle, [low, high]) in arm.muscles.iter_mut().zip(ranges) {
        if let Some(limit) = &mut muscle.limit {
            limit.range = [0.3, 0.7].map(|share| low + share * (high - low));
        }
    }
    arm
}

fn exact() -> Plan<f64> {
    Plan::exact(&Model::new(&description()).unwrap(), CouplingMode::Reduced).unwrap()
}

/// Accelerations, then lengths and rates of tendons.
#[derive(Clone, Copy)]
struct Forward;

impl Look for Forward {
    #[inline(always)]
    fn look<S: Scalar>(self, plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) -> Vec<S> {
        step::forward(plan, &Obstacles::none(plan), state, ws);
        let nmuscle = plan.nmuscle();
        [&ws.qacc[..], &ws.tendon_length[..nmuscle], &ws.tendon_velocity[..nmuscle]].concat()
    }
}

fn in_double_precision(plan: &Plan<f64>) -> Vec<Vec<f64>> {
    let (exact, mut ws) = (exact(), Workspace::new(plan));
    (0..STATES).map(|number| Forward.look(plan, &narrow_state(&exact, number), &mut ws)).collect()
}

/// Greatest error of accelerations relative to the greatest of them, and of lengths and rates.
fn errors(ndof: usize, wanted: &[f64], found: &[f64]) -> [f64; 2] {
    let (wanted, found) = (wanted.split_at(ndof), found.split_at(ndof));
    [difference(wanted.0, found.0) / greatest(wanted.0).max(1.0), difference(wanted.1, found.1)]
}

#[test]
fn every_limit_is_come_to_at_both_ends() {
    let plan = exact();
    let mut ws = Workspace::new(&plan);
    let mut ends = vec![[0, 0]; plan.tendon_limits.len()];
    for number in 0..STATES {
        step::forward(&plan, &Obstacles::none(&plan), &narrow_state(&plan, number), &mut ws);
        for ((count, row), limit) in ends.iter_mut().zip(&ws.tendon_limit).zip(&plan.tendon_limits) {
            let middle = 0.5 * (limit.range[0] + limit.range[1]);
            count[usize::from(ws.tendon_length[limit.muscle] > middle)] += u32::from(row.exists);
        }
    }
    assert!(ends.len() == 4 && ends.iter().flatten().all(|&count| count > 10), "{ends:?}");
}

#[test]
fn a_divided_tendon_is_the_sum_of_its_branches() {
    let divided = exact();
    let undivided = Plan::exact(&Model::new(&builtin("mobl-arms").unwrap()).unwrap(), CouplingMode::Reduced).unwrap();
    let number = |name: &str| {
        let all = Model::new(&description()).unwrap();
        all.muscles.iter().position(|muscle| muscle.name == name).unwrap()
    };
    let [long, short] = ["BIClong", "BRA"].map(number);
    for case in 0..20 {
        let [mut own, mut other] = [Workspace::new(&divided), Workspace::new(&undivided)];
        let state = narrow_state(&divided, case);
        Forward.look(&divided, &state, &mut own);
        Forward.look(&undivided, &state, &mut other);
        let sum = |of: &[f64]| of[long] / 1.5 + of[short] / 3.0;
        assert!((own.tendon_length[long] - sum(&other.tendon_length)).abs() < 1e-14);
        assert!((own.tendon_velocity[long] - sum(&other.tendon_velocity)).abs() < 1e-13);
        let [long_arms, short_arms] = [long, short].map(|muscle| moment_arms(&undivided, muscle, &mut other));
        let arms = moment_arms(&divided, long, &mut own);
        for ((arm, long), short) in arms.iter().zip(long_arms).zip(short_arms) {
            assert!((arm - long / 1.5 - short / 3.0).abs() < 1e-14);
        }
    }
}

#[test]
fn a_limit_that_nothing_comes_to_in_the_zero_pose_is_refused() {
    // Through the axis of its only joint.
    let text = r#"<mujoco model="arm"><worldbody><site name="above" pos="0 0 1.2"/><body name="arm" pos="0 0 1">
        <joint name="elbow" axis="0 1 0"/><inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
        <site name="below" pos="0 0 -0.05"/></body></worldbody>
        <tendon><spatial name="BIC" range="0.1 0.2"><site site="above"/><site site="below"/></spatial></tendon>
        <actuator><muscle name="BIC" tendon="BIC" lengthrange="0.1 0.3" force="300"/></actuator></mujoco>"#;
    let plan = |text: &str| {
        let files = std::collections::BTreeMap::from([("arm.xml".to_owned(), text.to_owned())]);
        let mjcf = myo_mjcf::read_from(&files, "arm.xml", myo_mjcf::Limits::default()).unwrap();
        let landmarks = Landmarks::new("below", "arm");
        let options = ImportOptions::new(landmarks);
        Plan::exact(&Model::new(&from_mjcf(&mjcf, &options).unwrap()).unwrap(), CouplingMode::Reduced)
    };
    let refused = plan(text).unwrap_err().to_string();
    assert!(refused.starts_with("muscle 'BIC': no joint changes the length of its tendon"), "{refused}");
    assert!(plan(&text.replace("pos=\"0 0 -0.05\"", "pos=\"0.02 0 -0.05\"")).is_ok());
    assert!(plan(&text.replace(" range=\"0.1 0.2\"", "")).is_ok());
}

/// From within its limits, whatever muscles do.
#[test]
fn a_limited_tendon_gives_way_a_little() {
    let plan = exact();
    let beyond = |ws: &Workspace<f64>| {
        let of = |limit: &myo_dynamics::plan::TendonLimit<f64>| {
            let length = ws.tendon_length[limit.muscle];
            (limit.range[0] - length).max(length - limit.range[1])
        };
        plan.tendon_limits.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    };
    let (mut tried, mut held, mut farthest) = (0, 0, 0.0_f64);
    for number in 0..400 {
        let mut ws = Workspace::<f64>::new(&plan);
        let mut state = State { qvel: vec![0.0; plan.ndof()], ..random_state(&plan, number) };
        Forward.look(&plan, &state, &mut ws);
        if beyond(&ws) > 0.0 {
            continue;
        }
        tried += 1;
        let ctrl: Vec<f64> = (0..plan.nmuscle()).map(|k| draw(7000 + number, k).round()).collect();
        let mut was_held = false;
        for _ in 0..300 {
            step::step(&plan, &Obstacles::none(&plan), &ctrl, &mut state, &mut ws);
            was_held |= ws.tendon_limit.iter().any(|row| row.exists);
            farthest = farthest.max(beyond(&ws));
        }
        held += u32::from(was_held);
    }
    println!("{held} of {tried} were held, the farthest {farthest} m beyond its limit");
    assert!(tried > 5 && held > 3 && farthest < 0.02, "{held} of {tried}, {farthest} m");
}

#[test]
fn the_specialised_plan_is_held_as_the_exact_one_is() {
    let plan = exact();
    let fast = plan.specialised();
    assert!(fast.links.len() < plan.links.len());
    for (number, (wanted, found)) in in_double_precision(&plan).iter().zip(in_double_precision(&fast)).enumerate() {
        let [acceleration, length] = errors(plan.ndof(), wanted, &found);
        assert!(acceleration < 1e-5 && length < 1e-6, "state {number}: {acceleration:e}, {length:e}");
    }
}

#[test]
fn lanes_are_held_as_the_reference_is() {
    let plan = exact();
    let wanted = in_double_precision(&plan);
    let states: Vec<State<f64>> = (0..STATES).map(|number| narrow_state(&plan, number)).collect();
    for level in Level::available() {
        let found = in_lanes(Forward, level, &plan.specialised().cast(), &states);
        let mut all: Vec<[f64; 2]> =
            wanted.iter().zip(&found).map(|(wanted, found)| errors(plan.ndof(), wanted, found)).collect();
        assert!(all.iter().all(|error| error[1] < 1e-5), "{}: {all:?}", level.name());
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [median, most] = [all[all.len() / 2], all[all.len() - 1]].map(|error| error[0]);
        assert!(median < 2e-6 && most < 1e-3, "{}: {median:e}, {most:e}", level.name());
    }
}

#[test]
fn the_recorded_program_is_held_as_the_reference_is() {
    let plan = exact().specialised();
    let states: Vec<State<f64>> = (0..300).map(|number| narrow_state(&plan, number)).collect();
    let found = recorded(Forward, &plan, &states);
    for (number, (wanted, found)) in in_double_precision(&plan).iter().zip(&found).enumerate() {
        // Its constants and its limits are those of single precision.
        let [acceleration, length] = errors(plan.ndof(), wanted, found);
        assert!(acceleration < 1e-5 && length < 1e-6, "state {number}: {acceleration:e}, {length:e}");
    }
}
