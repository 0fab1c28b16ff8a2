//! What sensors read: the same of both ways to couple joints, and what other algorithms find.

use myo_dynamics::step::{self, force};
use myo_dynamics::{CouplingMode, Obstacles, Plan, Sensors, State, Workspace};
use myo_model::description::{
    Frame, FrameQuantity, JointQuantity, Measure, MuscleQuantity, Sensor, Shape, SubtreeQuantity,
};
use myo_model::{Model, ModelDescription, builtin};

mod common;
use common::random_state;

fn with(mut description: ModelDescription, measures: Vec<Measure<String>>) -> ModelDescription {
    let sensor = |(number, measures)| Sensor { name: format!("sensor{number}"), measures, cutoff: 0.0 };
    description.sensors = measures.into_iter().enumerate().map(sensor).collect();
    description
}

/// A model, and its exact plans with soft and reduced couplings.
fn compiled(description: &ModelDescription) -> (Model, [Plan<f64>; 2]) {
    let model = Model::new(description).unwrap();
    let plans = [CouplingMode::Soft, CouplingMode::Reduced].map(|mode| Plan::exact(&model, mode).unwrap());
    (model, plans)
}

/// What the sensors of a model read in a state, after all that a step computes.
fn read(model: &Model, plan: &Plan<f64>, state: &State<f64>) -> (Vec<Vec<f64>>, Workspace<f64>) {
    let sensors = Sensors::new(model, plan);
    let mut ws = Workspace::<f64>::new(plan);
    step::forward(plan, &Obstacles::none(plan), state, &mut ws);
    let read = sensors.read(plan, state, &mut ws);
    let sizes: Vec<usize> = read.iter().map(Vec::len).collect();
    assert_eq!(sensors.sizes().collect::<Vec<_>>(), sizes);
    (read, ws)
}

const FRAME: [FrameQuantity; 7] = [
    FrameQuantity::Position,
    FrameQuantity::Orientation,
    FrameQuantity::XAxis,
    FrameQuantity::YAxis,
    FrameQuantity::ZAxis,
    FrameQuantity::Velocity,
    FrameQuantity::AngularVelocity,
];

/// Everything about where an arm is and how it moves, some of it seen from its hand.
fn places(arm: &ModelDescription) -> Vec<Measure<String>> {
    let hand = Frame::Site(arm.landmarks.fingertip.clone());
    let mut all = vec![];
    for body in &arm.bodies {
        for (number, quantity) in FRAME.into_iter().enumerate() {
            let seen_from = (number % 2 == 0).then(|| hand.clone());
            all.push(Measure::Frame { of: Frame::Centre(body.name.clone()), quantity, seen_from });
            all.push(Measure::Frame { of: Frame::Body(body.name.clone()), quantity, seen_from: None });
        }
        for quantity in [SubtreeQuantity::Centre, SubtreeQuantity::Velocity] {
            all.push(Measure::Subtree { of: body.name.clone(), quantity });
        }
    }
    for joint in &arm.joints {
        for quantity in [JointQuantity::Position, JointQuantity::Velocity] {
            all.push(Measure::Joint { of: joint.name.clone(), quantity });
        }
    }
    for muscle in &arm.muscles {
        for quantity in [MuscleQuantity::Length, MuscleQuantity::Velocity, MuscleQuantity::Force] {
            all.push(Measure::Muscle { of: muscle.name.clone(), quantity });
        }
    }
    all
}

/// A state of the reduced plan, and the same of all joints.
fn states(reduced: &Plan<f64>, case: u32) -> [State<f64>; 2] {
    let free = random_state(reduced, case);
    let (qpos, qvel) = (reduced.joint_positions(&free.qpos), reduced.joint_rates(&free.qpos, &free.qvel));
    [State { qpos, qvel, act: free.act.clone() }, free]
}

#[test]
fn places_and_motions_are_the_same_however_joints_are_coupled() {
    let description = builtin("mobl-arms").unwrap();
    let measures = places(&description);
    let (model, [soft, reduced]) = compiled(&with(description, measures));
    for case in 0..20 {
        let [all, free] = states(&reduced, case);
        let ((one, _), (other, _)) = (read(&model, &soft, &all), read(&model, &reduced, &free));
        for ((sensor, one), other) in model.sensors.iter().zip(one).zip(other) {
            let size = one.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            let close = one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-10 * size);
            assert!(close, "{:?}: {one:?} {other:?}", sensor.measures);
        }
    }
}

#[test]
fn what_muscles_do_to_a_joint_is_what_their_wrenches_do_to_its_coordinate() {
    let description = builtin("mobl-arms").unwrap();
    let torque = |joint: &myo_model::description::Joint| Measure::Joint {
        of: joint.name.clone(),
        quantity: JointQuantity::MuscleForce,
    };
    let measures = description.joints.iter().map(torque).collect();
    let (model, [soft, reduced]) = compiled(&with(description, measures));
    for case in 0..20 {
        let [all, free] = states(&reduced, case);
        let (found, mut ws) = read(&model, &soft, &all);
        let wanted = force::muscle_torques(&soft, &mut ws);
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!((found[0] - wanted).abs() < 1e-9, "{found:?} {wanted}");
        }
        // A joint that follows another feels its own share alone.
        let (of_reduced, _) = read(&model, &reduced, &free);
        for (joint, (found, wanted)) in of_reduced.iter().zip(&wanted).enumerate() {
            let moves = reduced.joints[joint].drive().is_some_and(|drive| drive.dof.is_some());
            let wanted = if moves { *wanted } else { 0.0 };
            assert!((found[0] - wanted).abs() < 1e-9, "{}: {found:?} {wanted}", model.joints[joint].name);
        }
    }
}

#[test]
fn a_ball_at_rest_feels_its_weight_where_it_touches() {
    let text = r#"{version: 1, name: ball, source: "", landmarks: {fingertip: top, shoulder: ball},
  options: {timestep: 0.002, gravity: [0, 0, -9.81], implicit_joint_damping: true},
  bodies: [{name: ball, parent: world, pos: [0, 0, 0.1], mass: 2, inertia: [0.01, 0.01, 0.01]}],
  joints: [{name: up, body: ball, kind: slide, axis: [0, 0, 1], damping: 200}],
  sites: [
    {name: hook, body: world, pos: [0, 0, 1]},
    {name: top, body: ball, pos: [0, 0, 0.09], shape: {sphere: {radius: 0.02}}},
    {name: bottom, body: ball, pos: [0, 0, -0.09], shape: {sphere: {radius: 0.02}}},
    {name: below, body: ball, pos: [0, 0, -0.5], shape: {box: {half_size: [0.1, 0.1, 0.1]}}}],
  geoms: [
    {name: floor, body: world, shape: plane, friction: [1, 0, 0]},
    {name: ball, body: ball, shape: {sphere: {radius: 0.1}}, friction: [1, 0, 0]}],
  contacts: [{geoms: [floor, ball], friction: 1}],
  muscles: [{name: lift, path: [hook, top], length_range: [0.5, 1.5], tau_act: 0.01, tau_deact: 0.04, ctrl_range: [0, 1],
    gain: {range: [0.75, 1.05], force: 1, scale: 1, lmin: 0.5, lmax: 1.6, vmax: 1.5, fpmax: 0, fvmax: 1.2},
    bias: {range: [0.75, 1.05], force: 0, scale: 1, lmin: 0.5, lmax: 1.6, vmax: 1.5, fpmax: 0, fvmax: 1.2}}]}"#;
    let description = ModelDescription::from_yaml(text, "ball.yaml").unwrap();
    let touch = ["top", "bottom", "below"].map(|site| Measure::Touch(site.to_owned()));
    let mut description = with(description, touch.to_vec());
    description.sensors[2].cutoff = 5.0;
    let (model, [plan, _]) = compiled(&description);
    let mut state = State::<f64>::new(&plan);
    let mut ws = Workspace::<f64>::new(&plan);
    for _ in 0..3000 {
        step::step(&plan, &Obstacles::none(&plan), &[0.0], &mut state, &mut ws);
    }
    let (felt, _) = read(&model, &plan, &state);
    let weight = 2.0 * 9.81;
    assert!(felt[0] == [0.0] && (felt[1][0] - weight).abs() < 1e-3 * weight && felt[2] == [5.0], "{felt:?}");
    // Ahead of the contact is what is below it, not what is above.
    description.sites[3].shape = Some(Shape::Sphere { radius: 0.001 });
    description.sites[3].pos[2] = 0.05;
    let (felt, _) = read(&Model::new(&description).unwrap(), &plan, &state);
    assert_eq!(felt[2], [0.0]);
}
