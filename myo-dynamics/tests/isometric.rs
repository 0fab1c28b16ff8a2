//! What muscles do to a body at rest: against itself, and against figures from MuJoCo.

use myo_dynamics::{CouplingMode, Isometric, Plan};
use myo_model::{Model, builtin};

fn plan(name: &str) -> Plan<f64> {
    Plan::exact(&Model::new(&builtin(name).unwrap()).unwrap(), CouplingMode::Reduced).unwrap()
}

fn coordinate(plan: &Plan<f64>, name: &str) -> usize {
    plan.dofs.iter().position(|dof| dof.name == name).unwrap()
}

/// A pose with these joints at so many degrees, all others at zero.
fn pose(plan: &Plan<f64>, degrees: &[(&str, f64)]) -> Vec<f64> {
    let mut qpos = vec![0.0; plan.ndof()];
    degrees.iter().for_each(|&(name, value)| qpos[coordinate(plan, name)] = value.to_radians());
    qpos
}

fn moved(plan: &Plan<f64>, qpos: &[f64], k: usize, by: f64) -> Isometric {
    let mut qpos = qpos.to_vec();
    qpos[k] += by;
    Isometric::at(plan, &qpos)
}

#[test]
fn torques_are_moment_arms_times_forces_and_these_the_slopes_of_lengths() {
    for name in ["mobl-arms", "myo-arm"] {
        let plan = plan(name);
        for number in 1..=40 {
            let share = |k: usize| (f64::from(number) * (0.618 + 0.1 * k as f64)).fract();
            let at = |(k, range): (usize, [f64; 2])| range[0] + (range[1] - range[0]) * share(k);
            let qpos: Vec<f64> = plan.dofs.iter().map(|dof| dof.range.unwrap()).enumerate().map(at).collect();
            let found = Isometric::at(&plan, &qpos);
            let [before, after] =
                [-1e-5, 1e-5].map(|by| (0..plan.ndof()).map(|k| moved(&plan, &qpos, k, by)).collect::<Vec<_>>());
            for (muscle, pull) in found.muscles.iter().enumerate() {
                for (k, arm) in pull.moment_arms.iter().enumerate() {
                    let slope = (after[k].muscles[muscle].length - before[k].muscles[muscle].length) / 2e-5;
                    assert!((arm + slope).abs() < 1e-6, "{name}, muscle {muscle}, coordinate {k}: {arm}, {slope}");
                }
            }
            for (muscle, pull) in found.muscles.iter().enumerate() {
                assert!(pull.force >= 0.0, "{name}, muscle {muscle} pushes with {} N", pull.force);
                for (arm, torque) in pull.moment_arms.iter().zip(&pull.torque) {
                    let expected = arm * pull.force;
                    assert!((torque - expected).abs() < 1e-4, "{name}, muscle {muscle}: {torque}, {expected}");
                }
            }
        }
    }
}

#[test]
fn the_straight_arm_is_held_as_in_mujoco() {
    // Torque of gravity, and active strength against it (N m), in MuJoCo 4.0.0, couplings exact, arm straight and forward.
    let figures = [
        ("mobl-arms", [(60.0, 11.0, 66.7), (90.0, 12.2, 20.1), (120.0, 10.4, 17.0)]),
        ("myo-arm", [(60.0, 10.2, 82.4), (90.0, 11.4, 74.2), (120.0, 9.7, 52.1)]),
    ];
    for (name, rows) in figures {
        let plan = plan(name);
        let k = coordinate(&plan, "shoulder_elv");
        for (degrees, gravity, strength) in rows {
            let found = Isometric::at(&plan, &pose(&plan, &[("elv_angle", 90.0), ("shoulder_elv", degrees)]));
            let got = (-found.gravity[k], found.strength(k)[0]);
            assert!((got.0 - gravity).abs() < 0.06 && (got.1 - strength).abs() < 0.06, "{name} {degrees}: {got:?}");
            assert!((found.holding_share(k) - got.0 / got.1).abs() < 1e-12);
        }
    }
}

#[test]
fn the_wrist_is_as_strong_as_in_mujoco() {
    let plan = plan("myo-arm");
    let found = Isometric::at(&plan, &pose(&plan, &[("elbow_flexion", 90.0)]));
    let [flexion, extension] = found.strength(coordinate(&plan, "flexion"));
    assert!((flexion - 16.6).abs() < 0.06 && (extension + 8.2).abs() < 0.06, "{flexion} {extension}");
}

#[test]
fn the_brachialis_goes_on_flexing_where_it_bends_over_the_elbow() {
    let arm = |name: &str, degrees: f64| {
        let model = Model::new(&builtin(name).unwrap()).unwrap();
        let brachialis = model.muscles.iter().position(|muscle| muscle.name == "BRA").unwrap();
        let plan = plan(name);
        let found = Isometric::at(&plan, &pose(&plan, &[("elbow_flexion", degrees)]));
        found.muscles[brachialis].moment_arms[coordinate(&plan, "elbow_flexion")]
    };
    assert!(arm("mobl-arms", 90.0) > 0.0 && arm("mobl-arms", 105.0) < -0.01, "a straight path passes behind the joint");
    for degrees in [0.0, 30.0, 60.0, 90.0, 120.0] {
        let arm = arm("myo-arm", degrees);
        assert!((0.01..0.03).contains(&arm), "{arm} m at {degrees} degrees");
    }
}
