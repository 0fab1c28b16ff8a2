//! Bodies in lanes: equal to the reference, and to themselves wherever they are computed.

mod common;

use common::{difference, draw, exact, random_state};
use myo_dynamics::{Batch, CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_scalar::Level;

const STEPS: usize = 25;
const CONTROLS: u32 = 8;

/// A state at rest, and excitations that change with every control step.
fn start(plan: &Plan<f64>, body: u32) -> State<f64> {
    State { qvel: vec![0.0; plan.ndof()], ..random_state(plan, body) }
}
fn ctrl(plan: &Plan<f64>, body: u32, control: u32) -> Vec<f32> {
    (0..plan.nmuscle()).map(|k| draw(1000 * (control + 1) + body, k) as f32).collect()
}

/// Positions of some bodies, numbered as given, after the same time.
fn run(plan: &Plan<f64>, bodies: &[u32], level: Level, threads: usize) -> Vec<Vec<f32>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut batch = Batch::new(plan, bodies.len(), level);
    for (place, &body) in bodies.iter().enumerate() {
        let state = start(plan, body);
        batch.set_state(place, &state.qpos, &state.qvel, &state.act);
    }
    for control in 0..CONTROLS {
        for (place, &body) in bodies.iter().enumerate() {
            batch.set_ctrl(place, &ctrl(plan, body, control));
        }
        pool.install(|| batch.step(STEPS));
    }
    (0..bodies.len()).map(|place| batch.qpos(place)).collect()
}

#[test]
fn lanes_equal_the_reference_at_every_level() {
    let plan = exact(CouplingMode::Reduced);
    let fast = plan.specialised();
    let bodies: Vec<u32> = (0..32).collect();
    for level in Level::available() {
        for (body, found) in run(&fast, &bodies, level, 1).into_iter().enumerate() {
            let (mut state, mut ws) = (start(&plan, body as u32), Workspace::<f64>::new(&plan));
            for control in 0..CONTROLS {
                let ctrl: Vec<f64> = ctrl(&plan, body as u32, control).into_iter().map(f64::from).collect();
                for _ in 0..STEPS {
                    step::step(&plan, &Obstacles::none(&plan), &ctrl, &mut state, &mut ws);
                }
            }
            let found: Vec<f64> = found.into_iter().map(f64::from).collect();
            let error = difference(&found, &state.qpos);
            assert!(error < 2e-5, "{}: body {body} is off by {error} rad", level.name());
        }
    }
}

#[test]
fn results_depend_neither_on_place_nor_on_company_nor_on_threads() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let bodies: Vec<u32> = (0..100).collect();
    let backwards: Vec<u32> = (0..100).rev().collect();
    for level in Level::available() {
        let all = run(&plan, &bodies, level, 1);
        assert_eq!(all, run(&plan, &bodies, level, 3), "{}: threads", level.name());
        let turned: Vec<_> = run(&plan, &backwards, level, 2).into_iter().rev().collect();
        assert_eq!(all, turned, "{}: place", level.name());
        assert_eq!(all[41], run(&plan, &[41], level, 1)[0], "{}: company", level.name());
    }
}
