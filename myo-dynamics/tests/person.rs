//! The other arm moves as the one does, mirrored.

use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_model::{Model, ModelDescription, builtin};

/// Fingertip and coordinates after every 50 steps of a fixed pattern of controls.
fn movement(description: &ModelDescription) -> Vec<([f64; 3], Vec<f64>)> {
    let plan = Plan::exact(&Model::new(description).unwrap(), CouplingMode::Reduced).unwrap();
    let (mut state, mut ws) = (State::<f64>::new(&plan), Workspace::<f64>::new(&plan));
    let mut seen = vec![];
    for k in 0..20 {
        let ctrl: Vec<f64> =
            (0..plan.nmuscle()).map(|muscle| 0.5 + 0.5 * ((3 * muscle + 2 * k) as f64).sin()).collect();
        for _ in 0..50 {
            step::step(&plan, &Obstacles::none(&plan), &ctrl, &mut state, &mut ws);
        }
        seen.push((step::fingertip(&plan, &ws), state.qpos.clone()));
    }
    seen
}

#[test]
fn the_left_arm_moves_as_the_right_one_mirrored() {
    for name in ["myo-arm", "mobl-arms"] {
        let right = builtin(name).unwrap();
        let (right, left) = (movement(&right), movement(&right.mirrored()));
        let mut farthest = 0.0_f64;
        for (([x, y, z], qpos), ([left_x, left_y, left_z], left_qpos)) in right.iter().zip(&left) {
            let apart = [x - left_x, y + left_y, z - left_z];
            assert!(apart.iter().all(|d| d.abs() < 1e-6), "{name}: {apart:?}");
            assert!(qpos.iter().zip(left_qpos).all(|(a, b)| (a - b).abs() < 1e-6), "{name}");
            farthest = farthest.max(y.abs());
        }
        assert!(farthest > 0.1, "{name} moves sideways by {farthest} m");
    }
}
