//! How far the accelerations of the fast plan are from those of the exact one in double precision, within joint limits. To
//! see the figures:
//!
//! ```text
//! cargo test -p myo-dynamics --test accuracy -- --nocapture
//! ```

mod common;

use common::{arm, difference, greatest, random_state};
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_scalar::{LaneTask, Level, Scalar, dispatch};

/// A multiple of any number of lanes.
const STATES: u32 = 16_384;

/// The error of a state is the greatest one of its accelerations, relative to the greatest of them, or to this (rad/s^2)
/// where they are smaller.
const SCALE: f64 = 1.0;

/// Accelerations of many states, in lanes.
struct Accelerations<'a> {
    plan: &'a Plan<f32>,
    states: &'a [State<f64>],
}

impl LaneTask for Accelerations<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) -> Self::Output {
        let (obstacles, mut ws) = (Obstacles::none(self.plan), Workspace::<S>::new(self.plan));
        let mut state = State::<S>::new(self.plan);
        let mut found = Vec::new();
        for states in self.states.chunks_exact(S::LANES) {
            let load = |into: &mut [S], of: fn(&State<f64>) -> &[f64]| {
                for (entry, x) in into.iter_mut().enumerate() {
                    *x = S::load(&states.iter().map(|state| of(state)[entry] as f32).collect::<Vec<_>>());
                }
            };
            load(&mut state.qpos, |state| &state.qpos);
            load(&mut state.qvel, |state| &state.qvel);
            load(&mut state.act, |state| &state.act);
            step::forward(self.plan, &obstacles, &state, &mut ws);
            let (mut lanes, first) = (vec![0.0; S::LANES], found.len());
            found.resize(first + S::LANES, Vec::new());
            for x in &ws.qacc {
                x.store(&mut lanes);
                found[first..].iter_mut().zip(&lanes).for_each(|(state, x)| state.push(f64::from(*x)));
            }
        }
        found
    }
}

/// Accelerations of every state, in double precision.
fn accelerations(plan: &Plan<f64>, states: &[State<f64>]) -> Vec<Vec<f64>> {
    let (obstacles, mut ws) = (Obstacles::none(plan), Workspace::new(plan));
    let of = |state| {
        step::forward(plan, &obstacles, state, &mut ws);
        ws.qacc.clone()
    };
    states.iter().map(of).collect()
}

/// A random state within limits whose numbers lanes can hold, so that what differs is computed.
fn state(plan: &Plan<f64>, number: u32) -> State<f64> {
    let mut state = random_state(plan, number);
    for x in [&mut state.qpos, &mut state.qvel, &mut state.act].into_iter().flatten() {
        *x = f64::from(*x as f32);
    }
    state
}

/// Median and greatest error.
fn errors(exact: &[Vec<f64>], found: &[Vec<f64>]) -> [f64; 2] {
    assert_eq!(exact.len(), found.len());
    let error = |(exact, found): (&Vec<f64>, &Vec<f64>)| difference(exact, found) / greatest(exact).max(SCALE);
    let mut errors: Vec<f64> = exact.iter().zip(found).map(error).collect();
    errors.sort_by(f64::total_cmp);
    [errors[errors.len() / 2], errors[errors.len() - 1]]
}

#[test]
fn accelerations_of_the_fast_plan_are_those_of_the_exact_one() {
    for name in ["mobl-arms", "mobl-arms-uitb"] {
        let exact = Plan::exact(&arm(name), CouplingMode::Reduced).unwrap();
        let fast = exact.specialised();
        let states: Vec<_> = (0..STATES).map(|number| state(&exact, number)).collect();
        let expected = accelerations(&exact, &states);
        let check = |how: &str, found: &[Vec<f64>], bounds: [f64; 2]| {
            let [median, most] = errors(&expected, found);
            println!(
                "{name}, fast plan, {how}: relative error of acceleration {median:.1e} median, {most:.1e} greatest"
            );
            assert!(median < bounds[0] && most < bounds[1], "{name}, {how}: {median:e}, {most:e}");
        };
        check("double precision", &accelerations(&fast, &states), [1e-7, 5e-6]);
        for level in Level::available() {
            let found = dispatch(level, Accelerations { plan: &fast.cast(), states: &states });
            check(&format!("{} lanes", level.name()), &found, [1e-6, 5e-5]);
        }
    }
}
