//! A body that moves freely, with a ball joint, among things it touches: the same however it is computed, and it moves as mechanics has it.

mod common;

use common::{Look, difference, draw, greatest, in_lanes, narrow_state, random_state, recorded};
use myo_dynamics::spatial::Wrench;
use myo_dynamics::{Batch, CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_model::Model;
use myo_model::description::Landmarks;
use myo_model::import::{ImportOptions, from_mjcf};
use myo_scalar::{Level, Scalar};
use std::collections::BTreeMap;

/// A multiple of any number of lanes.
const STATES: u32 = 1024;

/// A trunk that stands nowhere, with an arm on a ball joint and a forearm on a hinge, over a floor and beside a table.
const TUMBLER: &str = include_str!("../examples/tumbler.xml");

fn model_of(text: &str, locked: &[&str]) -> Model {
    let files = BTreeMap::from([("tumbler.xml".to_owned(), text.to_owned())]);
    let mjcf = myo_mjcf::read_from(&files, "tumbler.xml", myo_mjcf::Limits::default()).unwrap();
    let landmarks = Landmarks::new("tip", "arm");
    let locked = locked.iter().map(|&name| name.into()).collect();
    let options = ImportOptions { locked, ..ImportOptions::new(landmarks) };
    Model::new(&from_mjcf(&mjcf, &options).unwrap()).unwrap()
}

fn exact() -> Plan<f64> {
    Plan::exact(&model_of(TUMBLER, &[]), CouplingMode::Reduced).unwrap()
}

/// The same in the void: it touches nothing but itself, and has no weight.
fn floating(change: &dyn Fn(String) -> String) -> Plan<f64> {
    let around = TUMBLER.lines().filter(|line| !line.contains("\"floor\"") && !line.contains("\"table\""));
    let text = around.collect::<Vec<_>>().join("\n").replace("<default>", "<option gravity=\"0 0 0\"/><default>");
    Plan::exact(&model_of(&change(text), &[]), CouplingMode::Reduced).unwrap()
}

/// Accelerations, then of each contact its distance and its force, zero apart.
#[derive(Clone, Copy)]
struct Forward;

impl Look for Forward {
    #[inline(always)]
    fn look<S: Scalar>(self, plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) -> Vec<S> {
        step::forward(plan, &Obstacles::none(plan), state, ws);
        let mut all = ws.qacc.clone();
        for contact in &ws.contacts[ws.box_slots..] {
            all.extend([contact.distance.only(contact.exists), contact.force.only(contact.exists)]);
        }
        all
    }
}

/// The state after a step.
#[derive(Clone, Copy)]
struct Stepped;

impl Look for Stepped {
    #[inline(always)]
    fn look<S: Scalar>(self, plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) -> Vec<S> {
        let mut state = state.clone();
        step::step(plan, &Obstacles::none(plan), &[S::lit(0.5); 2], &mut state, ws);
        [state.qpos, state.qvel, state.act].concat()
    }
}

fn in_double_precision(look: impl Look, plan: &Plan<f64>) -> Vec<Vec<f64>> {
    let mut ws = Workspace::new(plan);
    (0..STATES).map(|number| look.look(plan, &narrow_state(plan, number), &mut ws)).collect()
}

/// Greatest error of accelerations relative to the greatest of them, and of distances (m).
fn errors(ndof: usize, wanted: &[f64], found: &[f64]) -> [f64; 2] {
    let (wanted, found) = (wanted.split_at(ndof), found.split_at(ndof));
    let distances = |of: &[f64]| of.iter().copied().step_by(2).collect::<Vec<f64>>();
    [difference(wanted.0, found.0) / greatest(wanted.0).max(1.0), difference(&distances(wanted.1), &distances(found.1))]
}

#[test]
fn positions_and_rates_are_counted_apart() {
    let plan = exact();
    assert_eq!((plan.nq(), plan.ndof(), plan.balls.len()), (12, 10, 2));
    let names: Vec<&str> = plan.dofs.iter().map(|dof| &*dof.name).collect();
    assert_eq!(&names[..4], ["root_tx", "root_ty", "root_tz", "root_rx"]);
    assert_eq!(&names[6..], ["shoulder_rx", "shoulder_ry", "shoulder_rz", "elbow"]);
    assert_eq!(plan.qpos0, [0.1, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(State::<f64>::new(&plan).qpos, plan.qpos0);
    assert_eq!(plan.joint_positions::<f64>(&plan.qpos0), plan.qpos0);
    let refused = plan.check_held().unwrap_err().to_string();
    assert!(refused.starts_with("joint 'root' moves in several ways at once"), "{refused}");
    let held = Plan::exact(&model_of(TUMBLER, &["root", "shoulder"]), CouplingMode::Reduced).unwrap();
    assert_eq!((held.nq(), held.ndof(), held.check_held()), (1, 1, Ok(())));
}

#[test]
fn every_pair_touches_in_some_states_and_presses_then() {
    let plan = exact();
    let mut touching = vec![0; (in_double_precision(Forward, &plan)[0].len() - plan.ndof()) / 2];
    for found in in_double_precision(Forward, &plan) {
        for (count, contact) in touching.iter_mut().zip(found[plan.ndof()..].chunks_exact(2)) {
            *count += u32::from(contact[0] != 0.0);
            assert!(contact[0] <= 0.002 && contact[1] >= 0.0, "{contact:?}");
        }
    }
    // Rods lie on floor and table with two ends.
    assert!(touching.len() == 12 && touching.iter().all(|&count| count > 2), "{touching:?}");
}

#[test]
fn the_specialised_plan_is_the_exact_one() {
    let plan = exact();
    let fast = in_double_precision(Forward, &plan.specialised());
    for (number, (wanted, found)) in in_double_precision(Forward, &plan).iter().zip(&fast).enumerate() {
        let [acceleration, distance] = errors(plan.ndof(), wanted, found);
        assert!(acceleration < 1e-7 && distance < 1e-12, "state {number}: {acceleration:e}, {distance:e} m");
    }
}

#[test]
fn lanes_are_as_the_reference() {
    let plan = exact();
    let wanted = in_double_precision(Forward, &plan);
    let states: Vec<State<f64>> = (0..STATES).map(|number| narrow_state(&plan, number)).collect();
    for level in Level::available() {
        let found = in_lanes(Forward, level, &plan.specialised().cast(), &states);
        let mut all: Vec<[f64; 2]> =
            wanted.iter().zip(&found).map(|(wanted, found)| errors(plan.ndof(), wanted, found)).collect();
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let [median, most] = [all[all.len() / 2], all[all.len() * 99 / 100]].map(|error| error[0]);
        assert!(median < 2e-6 && most < 1e-3, "{}: {median:e}, {most:e}", level.name());
        // Where surfaces meet within rounding, or ways out are as short, it may be another contact.
        let distances = all.iter().filter(|error| error[1] > 1e-5).count();
        assert!(distances < 10, "{}: {distances} distances differ", level.name());
    }
}

#[test]
fn the_recorded_program_is_as_the_reference() {
    let plan = exact();
    let states: Vec<State<f64>> = (0..200).map(|number| narrow_state(&plan, number)).collect();
    for (number, (wanted, found)) in
        in_double_precision(Forward, &plan).iter().zip(&recorded(Forward, &plan, &states)).enumerate()
    {
        let [acceleration, distance] = errors(plan.ndof(), wanted, found);
        assert!(acceleration < 1e-5 && distance < 1e-6, "state {number}: {acceleration:e}, {distance:e} m");
    }
    let floating = floating(&|text| text);
    for (wanted, found) in in_double_precision(Stepped, &floating).iter().zip(&recorded(Stepped, &floating, &states)) {
        assert!(difference(wanted, found) < 1e-6 * greatest(wanted), "{wanted:?} {found:?}");
    }
}

/// However far it has gone: everything is reckoned from where it is.
#[test]
fn a_body_that_went_far_is_as_exact() {
    let floating = floating(&|text| text);
    let far: Vec<State<f64>> = (0..STATES)
        .map(|number| {
            let mut state = narrow_state(&floating, number);
            (0..3).for_each(|k| state.qpos[k] = f64::from((400.0 * (draw(number, 500 + k) - 0.5)) as f32));
            state
        })
        .collect();
    let mut ws = Workspace::new(&floating);
    let wanted: Vec<Vec<f64>> = far.iter().map(|state| Forward.look(&floating, state, &mut ws)).collect();
    let fast = floating.specialised();
    assert_eq!((floating.carried, fast.carried), (None, Some(0)));
    let places: Vec<_> = (far.iter().take(20))
        .map(|state| {
            let (mut own, mut other) = (Workspace::<f64>::new(&floating), Workspace::<f64>::new(&fast));
            step::forward(&floating, &Obstacles::none(&floating), state, &mut own);
            step::forward(&fast, &Obstacles::none(&fast), state, &mut other);
            difference(&step::fingertip(&floating, &own), &step::fingertip(&fast, &other))
        })
        .collect();
    assert!(greatest(&places) < 1e-12, "{places:?}");
    for (wanted, found) in wanted.iter().zip(recorded(Forward, &fast, &far[..50])) {
        let [acceleration, _] = errors(floating.ndof(), wanted, &found);
        assert!(acceleration < 1e-5, "{acceleration:e}");
    }
    for level in Level::available() {
        let found = in_lanes(Forward, level, &fast.cast(), &far);
        let mut all: Vec<f64> =
            wanted.iter().zip(&found).map(|(wanted, found)| errors(floating.ndof(), wanted, found)[0]).collect();
        all.sort_by(f64::total_cmp);
        assert!(all[all.len() / 2] < 2e-5, "{}: {:e}", level.name(), all[all.len() / 2]);
    }
}

/// Momentum and angular momentum about O.
fn momentum(plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>) -> Wrench<f64> {
    step::forward(plan, &Obstacles::none(plan), state, ws);
    let mut sum = Wrench::zero();
    for body in &plan.bodies {
        sum += ws.inertia[body.link].apply(ws.velocity[body.link]);
    }
    sum
}

/// Whatever muscles and limits do, and parts that touch: a body that nothing else touches keeps its momentum. (But for armatures, which belong
/// to no body, and for what a step is long.)
#[test]
fn nobody_pulls_himself_out_of_a_swamp() {
    let mut plan = floating(&|text| text);
    plan.dofs.iter_mut().for_each(|dof| dof.armature = 0.0);
    plan.timestep = 1e-6;
    let mut moved = 0;
    for number in 0..100 {
        let (mut state, mut ws) = (random_state(&plan, number), Workspace::new(&plan));
        let before = momentum(&plan, &state, &mut ws);
        let rate = greatest(&ws.qacc);
        step::step(&plan, &Obstacles::none(&plan), &[1.0, 1.0], &mut state, &mut ws);
        let after = momentum(&plan, &state, &mut ws);
        let Wrench { ang, lin } = after - before;
        let change: Vec<f64> = [ang.array(), lin.array()].concat().iter().map(|x| x / plan.timestep).collect();
        moved += u32::from(rate > 50.0);
        // Forces are of a hundred newtons.
        assert!(greatest(&change) < 0.05, "{number}: {change:?} at {rate}");
    }
    assert!(moved > 50, "{moved}");
}

/// A spinning body without muscles keeps its energy as steps become shorter.
#[test]
fn a_spinning_body_keeps_its_energy() {
    let energy = |plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>| {
        step::forward(plan, &Obstacles::none(plan), state, ws);
        let of = |link: usize| 0.5 * ws.velocity[link].dot(ws.inertia[link].apply(ws.velocity[link]));
        plan.bodies.iter().map(|body| of(body.link)).sum::<f64>()
    };
    let drift = |timestep: f64| {
        let mut plan =
            floating(&|text| text.replace("force=\"150\"", "force=\"0\"").replace("force=\"80\"", "force=\"0\""));
        plan.timestep = timestep;
        plan.pairs.clear();
        plan.limits.clear();
        for dof in &mut plan.dofs {
            (dof.armature, dof.damping) = (0.0, 0.0);
        }
        let (mut state, mut ws) = (random_state(&plan, 3), Workspace::new(&plan));
        let before = energy(&plan, &state, &mut ws);
        for _ in 0..(0.2 / timestep) as usize {
            step::step(&plan, &Obstacles::none(&plan), &[0.0, 0.0], &mut state, &mut ws);
        }
        (energy(&plan, &state, &mut ws) / before - 1.0).abs()
    };
    let (coarse, fine) = (drift(1e-3), drift(1e-4));
    assert!(fine < 2e-3 && fine < 0.2 * coarse, "{coarse:e} {fine:e}");
}

/// Many of them fall on floor and table and come to rest, upright in numbers: a quaternion stays one.
#[test]
fn they_fall_and_come_to_rest() {
    let plan = exact();
    let mut batch = Batch::new(&plan.specialised(), 40, Level::current());
    assert_eq!(batch.qpos(39), plan.qpos0.iter().map(|&q| q as f32).collect::<Vec<_>>());
    let (still, slack) = (vec![0.0; plan.ndof()], vec![0.0; plan.nmuscle()]);
    for body in 0..40 {
        let mut qpos = random_state(&plan, body as u32).qpos;
        qpos[2] = 0.8 + 0.2 * draw(77, body);
        batch.set_state(body, &qpos, &still, &slack);
    }
    batch.step(3000);
    for body in 0..40 {
        let (qpos, qvel) = (batch.qpos(body), batch.qvel(body));
        for ball in &plan.balls {
            let length = qpos[ball.at..ball.at + 4].iter().map(|x| x * x).sum::<f32>().sqrt();
            assert!((length - 1.0).abs() < 1e-5, "{length}");
        }
        // It lies on the floor or on the table; its arm may still swing.
        let (sin, cos) = (2.0 * 0.1_f32.atan2(0.99)).sin_cos();
        let height = cos * (qpos[2] - 0.05) - sin * qpos[1];
        assert!((0.05..0.5).contains(&height) && qvel.iter().all(|v| v.abs() < 10.0), "{body}: {height} {qvel:?}");
    }
    let counts = batch.solver_counts().iter().copied().sum::<myo_dynamics::SolverCount>();
    assert_eq!(counts.unsolved, 0, "{counts:?}");
}
