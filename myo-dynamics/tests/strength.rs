//! What muscles can hold, against the physics step itself.

mod common;

use common::{arm, draw, exact, greatest};
use std::sync::Arc;

use myo_dynamics::{CouplingMode, Obstacles, Plan, ReachableSpace, State, Strength, Workspace, step};
use myo_model::Model;

/// A pose away from the limits by at least a tenth of the range.
fn inner_pose(plan: &Plan<f64>, number: u32) -> Vec<f64> {
    let range = |k: usize| plan.dofs[k].range.unwrap();
    (0..plan.ndof()).map(|k| range(k)[0] + (range(k)[1] - range(k)[0]) * (0.1 + 0.8 * draw(number, k))).collect()
}

#[test]
fn a_pose_that_is_held_stays_and_one_that_is_not_cannot_be_by_chance() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let space = Arc::new(ReachableSpace::new(&plan));
    let strength = Strength::new(space);
    let (obstacles, mut ws) = (Obstacles::none(&plan), Workspace::<f64>::new(&plan));
    let mut torque = |pose: &[f64], act: &[f64]| {
        let state = State { qpos: pose.to_vec(), act: act.to_vec(), ..State::new(&plan) };
        step::forward(&plan, &obstacles, &state, &mut ws);
        ws.torque.clone()
    };
    let mut held = 0;
    for number in 0..200 {
        let pose = inner_pose(&plan, number);
        let slack = greatest(&torque(&pose, &vec![0.0; plan.nmuscle()]));
        match strength.hold(&pose) {
            Some(act) => {
                held += 1;
                assert!(act.iter().all(|act| (0.0..=1.0).contains(act)), "{act:?}");
                let left = greatest(&torque(&pose, &act));
                assert!(left < 0.3, "pose {number}: {left} N m are left of {slack}");
            }
            None => {
                for chance in 0..300 {
                    let act: Vec<f64> = (0..plan.nmuscle()).map(|k| draw(1000 + chance, k).powi(2)).collect();
                    assert!(greatest(&torque(&pose, &act)) > 0.1, "pose {number} is held by chance");
                }
            }
        }
    }
    assert!((20..180).contains(&held), "{held}");
}

#[test]
fn a_held_arm_hardly_moves_in_a_tenth_of_a_second() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let space = Arc::new(ReachableSpace::new(&plan));
    let strength = Strength::new(space);
    let (obstacles, mut ws) = (Obstacles::none(&plan), Workspace::<f64>::new(&plan));
    let mut run = |pose: &[f64], act: &[f64]| {
        let mut state = State { qpos: pose.to_vec(), act: act.to_vec(), ..State::new(&plan) };
        let steps = (0.1 / plan.timestep) as usize;
        (0..steps).for_each(|_| step::step(&plan, &obstacles, act, &mut state, &mut ws));
        greatest(&state.qpos.iter().zip(pose).map(|(a, b)| a - b).collect::<Vec<_>>())
    };
    let held: Vec<_> = (0..100).map(|k| inner_pose(&plan, k)).filter_map(|q| Some((strength.hold(&q)?, q))).collect();
    for (act, pose) in held {
        let (moved, slack) = (run(&pose, &act), run(&pose, &vec![0.0; plan.nmuscle()]));
        assert!(moved < 0.1, "{moved} rad held, {slack} rad slack");
    }
}

#[test]
fn a_body_of_lead_holds_less_than_one_without_weight() {
    let held = |gravity: f64| {
        let mut plan = exact(CouplingMode::Reduced);
        plan.gravity = plan.gravity.map(|g| g * gravity);
        let space = Arc::new(ReachableSpace::new(&plan));
        let strength = Strength::new(space);
        (0..100).filter(|&k| strength.hold(&inner_pose(&plan, k)).is_some()).count()
    };
    let (none, normal, lead) = (held(0.0), held(1.0), held(20.0));
    assert!(none >= normal && normal > lead, "{none} {normal} {lead}");
}

#[test]
fn most_of_the_plane_of_pointing_can_be_held_and_nothing_out_of_reach() {
    let model: Model = arm("mobl-arms");
    let plan = Plan::exact(&model, CouplingMode::Reduced).unwrap().specialised();
    let space = Arc::new(ReachableSpace::new(&plan));
    let strength = Strength::new(space);
    // In front of the shoulder and low, where the hand rests on a table.
    assert!(strength.holds([0.4, 0.0, -0.25], 0.05));
    assert!(!strength.holds([2.0, 0.0, 0.0], 0.05));
}

#[test]
fn the_fastest_movement_is_faster_than_people_point_and_slower_than_a_whip() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let space = Arc::new(ReachableSpace::new(&plan));
    let fastest = Strength::new(space).fastest();
    assert!((3.0..40.0).contains(&fastest), "{fastest} m/s");
}
