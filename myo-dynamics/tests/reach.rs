//! Where the fingertip can get, against poses drawn at random.

mod common;

use common::{draw, exact};
use myo_dynamics::{CouplingMode, Plan, ReachableSpace, Workspace, step};

/// Fingertips of random poses within the limits.
fn tips(plan: &Plan<f64>, count: u32) -> Vec<[f64; 3]> {
    let (still, mut ws) = (vec![0.0; plan.ndof()], Workspace::<f64>::new(plan));
    let mut tip = |number: u32| {
        let range = |k: usize| plan.dofs[k].range.unwrap();
        let pose: Vec<f64> =
            (0..plan.ndof()).map(|k| range(k)[0] + (range(k)[1] - range(k)[0]) * draw(number, k)).collect();
        step::kinematics::kinematics(plan, &pose, &still, &mut ws);
        step::fingertip(plan, &ws)
    };
    (0..count).map(&mut tip).collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// A point of a box around the arm's space.
fn anywhere(number: u32) -> [f64; 3] {
    [0, 1, 2].map(|k| 2.0 * draw(number, 500 + k) - 1.0)
}

#[test]
fn where_the_fingertip_has_been_is_in_reach() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let space = ReachableSpace::new(&plan);
    // Draws that the space has not seen.
    for tip in tips(&plan, 12_000).into_iter().skip(10_000) {
        assert_eq!(space.distance_out_of_reach(tip), 0.0, "{tip:?}");
    }
}

#[test]
fn no_random_pose_comes_closer_than_the_distance() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let space = ReachableSpace::new(&plan);
    let tips = tips(&plan, 200_000);
    let mut loosest: f64 = 0.0;
    for point in (0..200).map(anywhere) {
        let found = space.distance_out_of_reach(point);
        let sampled = tips.iter().map(|&tip| distance(tip, point)).fold(f64::INFINITY, f64::min);
        assert!(found <= sampled + 1e-4, "{point:?}: {found} from the search, {sampled} from samples");
        loosest = loosest.max(sampled - found);
    }
    // The samples leave gaps of some centimetres, at the rim of the space above all.
    assert!(loosest < 0.1, "{loosest}");
}

#[test]
fn the_arm_reaches_as_far_as_it_is_long() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let farthest = tips(&plan, 20_000).into_iter().map(|tip| distance(tip, [0.0; 3])).fold(0.0, f64::max);
    assert!((0.74..0.80).contains(&farthest), "{farthest}");
    let space = ReachableSpace::new(&plan);
    let ahead = |x: f64| space.distance_out_of_reach([x, 0.0, 0.0]);
    assert_eq!(ahead(0.55), 0.0);
    let beyond = ahead(1.0);
    assert!(beyond > 1.0 - farthest, "1 m ahead is {beyond} m out of reach of an arm of {farthest} m");
    // Far away, a metre more is a metre more.
    assert!((ahead(30.0) - ahead(29.0) - 1.0).abs() < 1e-4);
    // The exact plan reaches as far.
    let reference = ReachableSpace::new(&exact(CouplingMode::Reduced));
    assert!((reference.distance_out_of_reach([1.0, 0.0, 0.0]) - beyond).abs() < 1e-4);
}
