//! Two algorithms must agree: the exact plan, and the specialised one with its closed forms and fits.

mod common;

use common::{arm, difference, draw, greatest, random_state};
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};

/// Fits are made to 3e-9 (SI units) each, and a path has up to two fitted segments.
const LENGTH: f64 = 1e-8;
/// The slope of a fit of degree n errs up to n^2 times the fit, a tenth of that in practice; speeds reach 5 rad/s.
const VELOCITY: f64 = 5e-7;
/// Muscles are steep: 1e5 N/m along their force-length curve, 1e3 N s/m along their force-velocity curve.
const FORCE: f64 = 1e5 * LENGTH;
/// Inertias are of the order of 1 kg m^2.
const MASS: f64 = 1e-8;
/// Moment arms of 0.05 m, and forces of some muscles that add up.
const TORQUE: f64 = 0.05 * FORCE;
/// Relative to the greatest acceleration of the state: the torques' error through the inverse inertia.
const ACCELERATION: f64 = 5e-6;

#[test]
fn specialised_plan_equals_exact_plan() {
    for name in ["mobl-arms", "mobl-arms-uitb"] {
        let exact = Plan::exact(&arm(name), CouplingMode::Reduced).unwrap();
        let fast = exact.specialised();
        assert!(fast.links.len() < exact.links.len(), "the shoulder girdle should fold");
        assert!(!fast.tendons.hinge.is_empty() && !fast.tendons.double_hinge.is_empty());
        let (mut a, mut b) = (Workspace::<f64>::new(&exact), Workspace::<f64>::new(&fast));
        for number in 0..1000 {
            let state = random_state(&exact, number);
            step::forward(&exact, &Obstacles::none(&exact), &state, &mut a);
            step::forward(&fast, &Obstacles::none(&fast), &state, &mut b);
            let tips = [step::fingertip(&fast, &b), step::fingertip(&exact, &a)];
            let check = |what: &str, error: f64, tolerance: f64| {
                assert!(error <= tolerance, "{name}, state {number}: {what} differs by {error:e}");
            };
            check("tendon length", difference(&a.tendon_length, &b.tendon_length), LENGTH);
            check("tendon velocity", difference(&a.tendon_velocity, &b.tendon_velocity), VELOCITY);
            check("muscle force", difference(&a.muscle_force, &b.muscle_force), FORCE);
            check("fingertip", difference(&tips[0], &tips[1]), LENGTH);
            check("mass matrix", difference(&a.mass, &b.mass), MASS);
            check("torque", difference(&a.torque, &b.torque), TORQUE);
            check("acceleration", difference(&a.qacc, &b.qacc), ACCELERATION * greatest(&a.qacc));
        }
    }
}

/// A state with every coordinate past one of its limits by up to `most` (rad).
fn beyond_limits(plan: &Plan<f64>, number: u32, most: f64) -> State<f64> {
    let mut state = random_state(plan, number);
    for (k, dof) in plan.dofs.iter().enumerate() {
        let [lo, hi] = dof.range.unwrap();
        let by = most * draw(number, 400 + k);
        state.qpos[k] = if draw(number, 500 + k) < 0.5 { lo - by } else { hi + by };
    }
    state
}

/// The forces of limits are the same in both plans, and by far the greatest; they would hide the others.
fn without_limits(plan: &Plan<f64>) -> Plan<f64> {
    Plan { limits: vec![], ..plan.clone() }
}

#[test]
fn specialised_plan_equals_exact_plan_far_beyond_limits() {
    for name in ["mobl-arms", "mobl-arms-uitb"] {
        let exact = without_limits(&Plan::exact(&arm(name), CouplingMode::Reduced).unwrap());
        let fast = exact.specialised();
        let (mut a, mut b) = (Workspace::<f64>::new(&exact), Workspace::<f64>::new(&fast));
        let mut worst = [0.0_f64; 7];
        for number in 0..1000 {
            let state = beyond_limits(&exact, number, 0.45);
            step::forward(&exact, &Obstacles::none(&exact), &state, &mut a);
            step::forward(&fast, &Obstacles::none(&fast), &state, &mut b);
            let errors = [
                difference(&a.tendon_length, &b.tendon_length),
                difference(&a.tendon_velocity, &b.tendon_velocity),
                difference(&a.muscle_force, &b.muscle_force),
                difference(&step::fingertip(&exact, &a), &step::fingertip(&fast, &b)),
                difference(&a.mass, &b.mass),
                difference(&a.torque, &b.torque),
                difference(&a.qacc, &b.qacc) / greatest(&a.qacc),
            ];
            worst.iter_mut().zip(errors).for_each(|(worst, error)| *worst = worst.max(error));
        }
        // Lengths (m), velocities (m/s), forces (N), metres, inertias (kg m^2), torques (N m), relative.
        let bounds = [1e-6, 1e-4, 0.1, 1e-6, 1e-6, 1e-2, 1e-4];
        for (what, (error, bound)) in worst.iter().zip(bounds).enumerate() {
            assert!(*error < bound, "{name}: quantity {what} differs by {error:e}");
        }
    }
}

/// Past the limits, at them and in between, where the fits end, and beyond any sense.
fn everywhere(plan: &Plan<f64>, number: u32) -> State<f64> {
    let most = [0.05, 0.12, 0.45, 0.8, 3.0][number as usize % 5];
    beyond_limits(plan, number, most)
}

/// The state a little later or earlier, at constant velocity.
fn moved(state: &State<f64>, time: f64) -> State<f64> {
    let qpos = state.qpos.iter().zip(&state.qvel).map(|(q, v)| q + v * time).collect();
    State { qpos, ..state.clone() }
}

#[test]
fn rates_are_the_derivatives_of_positions_everywhere() {
    const H: f64 = 1e-6;
    let fast = Plan::exact(&arm("mobl-arms"), CouplingMode::Reduced).unwrap().specialised();
    assert!(!fast.profiled.is_empty());
    let none = Obstacles::none(&fast);
    let mut ws = [0, 1, 2].map(|_| Workspace::<f64>::new(&fast));
    let mut held = 0;
    for number in 0..1000 {
        let state = everywhere(&fast, number);
        for (ws, time) in ws.iter_mut().zip([-H, H, 0.0]) {
            step::forward(&fast, &none, &moved(&state, time), ws);
        }
        let [before, after, now] = &ws;
        let free = |ws: &Workspace<f64>| ws.profiled.iter().all(|at| at.is_free);
        if free(before) != free(after) {
            continue; // the one place where rates jump
        }
        held += u32::from(!free(now));
        let rate = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (b - a) / (2.0 * H)).collect::<Vec<f64>>();
        let error = difference(&rate(&before.tendon_length, &after.tendon_length), &now.tendon_velocity);
        assert!(error < 2e-5, "state {number}: tendon velocities are off by {error:e} m/s");
        for link in 1..fast.links.len() {
            let speed = rate(&before.position[link].array(), &after.position[link].array());
            let wanted = now.velocity[link].at(now.position[link]).array();
            let error = difference(&speed, &wanted);
            assert!(error < 1e-4, "state {number}: link {link} is off by {error:e} m/s");
        }
    }
    assert!(held > 100, "{held} states are farther out than the fits are followed");
}

#[test]
fn energy_stays_the_same_everywhere() {
    const H: f64 = 1e-6;
    // Nothing but inertia.
    let mut plan = without_limits(&Plan::exact(&arm("mobl-arms"), CouplingMode::Reduced).unwrap());
    plan.gravity = [0.0; 3];
    plan.muscles.clear();
    plan.tendons.constant.clear();
    plan.tendons.pairs.clear();
    for dof in &mut plan.dofs {
        (dof.stiffness, dof.spring_torque, dof.damping) = (0.0, 0.0, 0.0);
    }
    let (fast, n) = (plan.specialised(), plan.ndof());
    let none = Obstacles::none(&fast);
    let mut ws = Workspace::<f64>::new(&fast);
    for number in 0..500 {
        let state = everywhere(&fast, number);
        step::forward(&fast, &none, &state, &mut ws);
        let (qacc, free) = (ws.qacc.clone(), ws.profiled.iter().all(|at| at.is_free));
        let mut energy = |time: f64| {
            let mut state = moved(&state, time);
            state.qvel.iter_mut().zip(&qacc).for_each(|(v, a)| *v += a * time);
            step::forward(&fast, &none, &state, &mut ws);
            let entry = |k: usize| ws.mass[(k / n).max(k % n) * n + (k / n).min(k % n)];
            let kinetic = (0..n * n).map(|k| 0.5 * entry(k) * state.qvel[k / n] * state.qvel[k % n]).sum::<f64>();
            (kinetic, ws.profiled.iter().all(|at| at.is_free))
        };
        let (before, after) = (energy(-H), energy(H));
        if before.1 != free || after.1 != free {
            continue;
        }
        let power = (after.0 - before.0) / (2.0 * H);
        assert!(power.abs() < 1e-3 * before.0.max(1.0), "state {number}: {power} W of {} J", before.0);
    }
}
