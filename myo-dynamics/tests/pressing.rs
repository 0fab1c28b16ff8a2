//! The fingertip on a box.

mod common;

use common::exact;
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, StaticBox, Surface, Workspace, step};

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Boxes that begin `distance` metres ahead of the fingertip's surface, and whether and how hard it presses at rest.
fn press(plan: &Plan<f64>, distances: &[f64]) -> (bool, f64, f64) {
    let state = State { qpos: vec![0.6, 0.9, -0.5, 1.2, 0.3], ..State::<f64>::new(plan) };
    let mut ws = Workspace::<f64>::new(plan);
    step::kinematics::kinematics(plan, &state.qpos, &state.qvel, &mut ws);
    let [x, y, z] = step::fingertip(plan, &ws);
    let radius = plan.contact_sphere.as_ref().unwrap().radius;
    let boxed = |&ahead: &f64| StaticBox::new([x + radius + ahead + 0.01, y, z], AXES, [0.01, 0.05, 0.05]);
    let boxes: Vec<StaticBox> = distances.iter().map(boxed).collect();
    step::forward(plan, &Obstacles::new(plan, &boxes, Surface::default()), &state, &mut ws);
    (ws.contacts[0].exists, ws.contacts[0].force, ws.contacts[0].index)
}

#[test]
fn nothing_is_felt_outside_the_margins() {
    let plan = exact(CouplingMode::Reduced);
    let margin = 0.002;
    assert_eq!(press(&plan, &[margin + 1e-9]), (false, 0.0, 0.0));
    assert!(press(&plan, &[margin - 1e-9]).0);
}

#[test]
fn force_rises_with_depth() {
    let plan = exact(CouplingMode::Reduced);
    let forces: Vec<f64> = [0.0, -0.001, -0.002, -0.004, -0.008].iter().map(|&d| press(&plan, &[d]).1).collect();
    assert!(forces.windows(2).all(|pair| pair[0] < pair[1]), "{forces:?}");
}

#[test]
fn the_nearest_box_is_the_one_that_counts() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let (touches, force, index) = press(&plan, &[0.3, -0.001, 0.5]);
    assert!(touches && force == press(&plan, &[-0.001]).1);
    assert_eq!(index, 1.0);
}
