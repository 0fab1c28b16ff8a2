//! Two algorithms must agree: the exact plan, and the specialised one with its closed forms and fits.

use myo_dynamics::{Coupling, Obstacles, Plan, State, Workspace, step};
use myo_model::{Model, builtin};
use myo_scalar::{Counter, Scalar, Word, philox, unit};

/// A reproducible random state within the joint limits.
fn random_state(plan: &Plan<f64>, number: u32) -> State<f64> {
    let word = <f64 as Scalar>::Word::splat;
    let draw = |stream: u32| -> f64 {
        let counter = Counter { seed: 1, env: word(number), episode: word(0), step: word(0), stream: word(stream) };
        unit(philox(counter)[0])
    };
    let mut state = State::<f64>::new(plan);
    for (k, dof) in plan.dofs.iter().enumerate() {
        let [lo, hi] = dof.range.unwrap_or([-1.0, 1.0]);
        state.qpos[k] = lo + (hi - lo) * draw(k as u32);
        state.qvel[k] = 10.0 * (draw(100 + k as u32) - 0.5);
    }
    for k in 0..plan.nmuscle() {
        state.act[k] = draw(200 + k as u32);
    }
    state
}

fn assert_close(what: &str, a: &[f64], b: &[f64], tolerance: f64) {
    let scale = b.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for (k, (x, y)) in a.iter().zip(b).enumerate() {
        assert!((x - y).abs() <= tolerance * scale, "{what}[{k}]: {x} for {y}");
    }
}

#[test]
fn specialised_plan_equals_exact_plan() {
    for name in ["mobl-arms", "mobl-arms-uitb"] {
        let model = Model::new(&builtin(name).unwrap()).unwrap();
        let exact = Plan::exact(&model, Coupling::Reduced).unwrap();
        let fast = exact.specialised();
        assert!(fast.links.len() < exact.links.len(), "the shoulder girdle should fold");
        assert!(!fast.tendons.hinge.is_empty() && !fast.tendons.double_hinge.is_empty());
        let (mut a, mut b) = (Workspace::<f64>::new(&exact), Workspace::<f64>::new(&fast));
        for number in 0..200 {
            let state = random_state(&exact, number);
            step::forward(&exact, &Obstacles::none(&exact), &state, &mut a);
            step::forward(&fast, &Obstacles::none(&fast), &state, &mut b);
            assert_close("tendon length", &b.tendon_length, &a.tendon_length, 1e-8);
            assert_close("tendon velocity", &b.tendon_velocity, &a.tendon_velocity, 1e-6);
            assert_close("mass matrix", &b.mass, &a.mass, 1e-7);
            assert_close("qacc", &b.qacc, &a.qacc, 2e-6);
            assert_close("fingertip", &step::fingertip(&fast, &b), &step::fingertip(&exact, &a), 1e-8);
        }
    }
}
