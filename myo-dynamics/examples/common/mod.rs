//! What examples that are compared with MuJoCo share.

use myo_dynamics::spatial::Wrench;
use myo_dynamics::step::{cholesky, force, inertia, kinematics::kinematics};
use myo_dynamics::{Plan, State, Workspace};
use myo_scalar::{Counter, Scalar, Word, philox, seed_words, unit};
use nalgebra::{UnitQuaternion, Vector3};

/// A sequence of reproducible random numbers.
pub struct Draws {
    stream: u32,
    pub case: u32,
    next: u32,
}

impl Draws {
    pub fn new(stream: u32, case: u32) -> Self {
        Self { stream, case, next: 0 }
    }
    /// Uniform between two bounds.
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        let word = <f64 as Scalar>::Word::splat;
        let [env, episode, step, stream] = [self.case, self.stream, 0, self.next].map(word);
        self.next += 1;
        lo + (hi - lo) * unit::<f64>(philox::<f64>(Counter { seed: seed_words(2026), env, episode, step, stream })[0])
    }
    pub fn vector(&mut self, count: usize, lo: f64, hi: f64) -> Vec<f64> {
        (0..count).map(|_| self.between(lo, hi)).collect()
    }
    pub fn rotation(&mut self) -> UnitQuaternion<f64> {
        let axis = Vector3::from_vec(self.vector(3, -3.0, 3.0));
        UnitQuaternion::from_scaled_axis(axis)
    }
}

/// Springs and dampers.
pub fn passive_force(plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>) -> Vec<f64> {
    force::passive(plan, state, ws);
    ws.torque.clone()
}

/// Acceleration without constraints, after [`myo_dynamics::step::forward`].
pub fn smooth_acceleration(plan: &Plan<f64>, ws: &mut Workspace<f64>) -> Vec<f64> {
    let mut acceleration = ws.torque.clone();
    cholesky::copy(&plan.elimination, &ws.mass, &mut ws.matrix);
    cholesky::factor_and_solve(&plan.elimination, &mut ws.matrix, &mut ws.pivot, &mut acceleration);
    acceleration
}

/// Gravity, centrifugal and Coriolis forces, with the sign of a resistance.
pub fn bias_force(plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>) -> Vec<f64> {
    kinematics(plan, &state.qpos, &state.qvel, ws);
    ws.torque.fill(0.0);
    ws.joint_torque.fill(0.0);
    ws.wrench.fill(Wrench::zero());
    inertia::resist(plan, ws);
    force::project(plan, ws);
    ws.torque.iter().map(|t| -t).collect()
}
