//! What muscles of a moving body do, by two ways that must agree.

use myo_dynamics::{CouplingMode, Exerter, Plan, State};
use myo_model::{Model, builtin};

/// The power with which muscles pull along their paths is that of their torques on the joints.
#[test]
fn power_along_paths_is_power_of_torques() {
    for name in ["mobl-arms", "myo-arm"] {
        let model = Model::new(&builtin(name).unwrap()).unwrap();
        let plan = Plan::exact(&model, CouplingMode::Reduced).unwrap();
        let mut exerter = Exerter::new(&model, plan.clone());
        for number in 0..50 {
            let part = |k: usize, of: usize| ((number * 31 + k * 17 + of * 7) % 101) as f64 / 101.0;
            let mut state = State::new(&plan);
            for (k, dof) in plan.dofs.iter().enumerate() {
                let [low, high] = dof.range.unwrap();
                state.qpos[k] = low + (0.05 + 0.9 * part(k, 1)) * (high - low);
                state.qvel[k] = 6.0 * (part(k, 2) - 0.5);
            }
            state.act.iter_mut().enumerate().for_each(|(k, act)| *act = part(k, 3));
            let now = exerter.at(&state);
            let of_torques: f64 = now.torque.iter().zip(&state.qvel).map(|(torque, qvel)| torque * qvel).sum();
            let scale = 1.0 + now.torque.iter().zip(&state.qvel).map(|(t, v)| (t * v).abs()).sum::<f64>();
            assert!((now.mechanical - of_torques).abs() < 1e-9 * scale, "{name}: {} W, {of_torques} W", now.mechanical);
            assert!(now.metabolic > 0.0, "{name}");
        }
    }
}
