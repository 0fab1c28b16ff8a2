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
fn the_nearest_point_is_one_that_its_pose_reaches() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let space = ReachableSpace::new(&plan);
    let (still, mut ws) = (vec![0.0; plan.ndof()], Workspace::<f64>::new(&plan));
    for point in (0..200).map(anywhere) {
        let nearest = space.nearest(point);
        step::kinematics::kinematics(&plan, &nearest.pose, &still, &mut ws);
        assert_eq!(step::fingertip(&plan, &ws), nearest.point, "{point:?}");
        let within = |(q, range): (&f64, [f64; 2])| (range[0]..=range[1]).contains(q);
        assert!(nearest.pose.iter().zip(plan.dofs.iter().map(|dof| dof.range.unwrap())).all(within), "{point:?}");
        assert_eq!(space.distance_out_of_reach(nearest.point), 0.0, "{point:?}");
        let left = distance(point, nearest.point);
        assert!(if left < 1e-3 { nearest.distance_m == 0.0 } else { (left - nearest.distance_m).abs() < 1e-12 });
    }
}

#[test]
fn poses_at_a_point_differ_and_are_there() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let space = ReachableSpace::new(&plan);
    let (still, mut ws) = (vec![0.0; plan.ndof()], Workspace::<f64>::new(&plan));
    let (point, radius) = ([0.45, 0.0, -0.1], 0.02);
    let poses = space.poses_at(point, radius, 48);
    assert_eq!(poses.len(), 48);
    for pose in &poses {
        step::kinematics::kinematics(&plan, pose, &still, &mut ws);
        assert!(distance(step::fingertip(&plan, &ws), point) <= radius);
    }
    // The elbow can be high or low with the fingertip in one place.
    let spread = |k: usize| poses.iter().map(|q| q[k]).fold((f64::MAX, f64::MIN), |(a, b), q| (a.min(q), b.max(q)));
    assert!((0..plan.ndof()).any(|k| spread(k).1 - spread(k).0 > 0.5), "{:?}", (0..5).map(spread).collect::<Vec<_>>());
    assert_eq!(space.poses_at([2.0, 0.0, 0.0], 0.1, 48), Vec::<Vec<f64>>::new());
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
