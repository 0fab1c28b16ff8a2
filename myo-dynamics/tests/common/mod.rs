//! What the tests of this crate share.
#![allow(dead_code)] // every test file uses a part of it

use myo_dynamics::{CouplingMode, Plan, State};
use myo_model::{Model, builtin};
use myo_scalar::{Counter, Scalar, Word, philox, seed_words, unit};

/// A built-in arm.
pub fn arm(name: &str) -> Model {
    Model::new(&builtin(name).unwrap()).unwrap()
}

/// The default arm's reference plan.
pub fn exact(coupling: CouplingMode) -> Plan<f64> {
    Plan::exact(&arm("mobl-arms"), coupling).unwrap()
}

/// Uniform in [0, 1): entry `entry` of stream `stream`.
pub fn draw(stream: u32, entry: usize) -> f64 {
    let word = <f64 as Scalar>::Word::splat;
    let (episode, step) = (word(0), word(0));
    unit(
        philox::<f64>(Counter { seed: seed_words(1), env: word(stream), episode, step, stream: word(entry as u32) })[0],
    )
}

/// A reproducible random state within the joint limits.
pub fn random_state(plan: &Plan<f64>, number: u32) -> State<f64> {
    let mut state = State::<f64>::new(plan);
    for (k, dof) in plan.dofs.iter().enumerate() {
        let [lo, hi] = dof.range.unwrap_or([-1.0, 1.0]);
        state.qpos[k] = lo + (hi - lo) * draw(number, k);
        state.qvel[k] = 10.0 * (draw(number, 100 + k) - 0.5);
    }
    for k in 0..plan.nmuscle() {
        state.act[k] = draw(number, 200 + k);
    }
    state
}

/// Greatest difference of two slices.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Greatest absolute value of a slice.
pub fn greatest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}
