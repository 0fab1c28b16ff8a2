//! Two algorithms must agree: the exact plan, and the specialised one with its closed forms and fits.

mod common;

use common::{arm, difference, greatest, random_state};
use myo_dynamics::{Coupling, Obstacles, Plan, Workspace, step};

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
        let exact = Plan::exact(&arm(name), Coupling::Reduced).unwrap();
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
