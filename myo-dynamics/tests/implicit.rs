//! Steps that take Coriolis and centrifugal forces along as they become with the new velocities: the forces' derivatives, and what bodies do with such steps.

mod common;

use common::{arm, difference, greatest, random_state};
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_model::Model;
use myo_model::description::{Integrator, Landmarks};
use myo_model::import::{ImportOptions, from_mjcf};
use std::collections::BTreeMap;

/// A free trunk with an arm and a lever, pinned and welded to each other, to a tool and to the world.
const LINKAGE: &str = include_str!("../examples/linkage.xml");
/// A free body with a ball joint.
const TUMBLER: &str = include_str!("../examples/tumbler.xml");
/// Free bodies that carry nothing, and others.
const JUGGLER: &str = include_str!("../examples/juggler.xml");

fn model_of(text: &str) -> Model {
    let files = BTreeMap::from([("body.xml".to_owned(), text.to_owned())]);
    let mjcf = myo_mjcf::read_from(&files, "body.xml", myo_mjcf::Limits::default()).unwrap();
    Model::new(&from_mjcf(&mjcf, &ImportOptions::new(Landmarks::new("tip", "arm"))).unwrap()).unwrap()
}

fn plan_of(mut model: Model, coupling: CouplingMode, integrator: Integrator) -> Plan<f64> {
    model.options.integrator = integrator;
    Plan::exact(&model, coupling).unwrap()
}

/// Levers on slides, beside and below each other, one of which follows another by a curved coupling, with an armature that does.
fn levers() -> Model {
    model_of(
        r#"<mujoco><compiler angle="radian"/><default><geom contype="0" conaffinity="0"/><joint armature="0.02" damping="0.1"/></default>
<worldbody><body name="arm" pos="0 0 1">
  <joint name="along" type="slide" axis="1 0 0.3" damping="0.1"/>
  <joint name="swing" axis="0 1 0" range="-1 1"/>
  <inertial pos="0.1 0.02 -0.2" mass="2" diaginertia="0.02 0.03 0.01"/><site name="chest" pos="0 0.1 0"/>
  <body name="one" pos="0.1 0 -0.4" quat="0.9 0.1 0.3 0">
    <joint name="first" axis="1 0 0" pos="0 0.03 0" range="-1 1"/><joint name="second" axis="0 1 0.2"/>
    <inertial pos="0.01 0.03 -0.1" mass="1" diaginertia="0.005 0.006 0.001"/><site name="tip" pos="0 0.1 -0.2"/></body>
  <body name="other" pos="-0.1 0.1 -0.3"><joint name="turn" axis="0 0 1"/><joint name="out" type="slide" axis="1 0 0"/>
    <inertial pos="0.2 0 0" mass="0.5" diaginertia="0.001 0.003 0.004"/></body>
</body></worldbody>
<equality><joint joint1="second" joint2="first" polycoef="0.1 0.5 0.7 -0.3 0.2"/><joint joint1="out" joint2="turn" polycoef="0 0.3 0 0 0"/></equality>
<tendon><spatial name="m"><site site="chest"/><site site="tip"/></spatial></tendon>
<actuator><muscle name="m" tendon="m" lengthrange="0.1 1" force="100"/></actuator></mujoco>"#,
    )
}

/// Bodies of every kind, exact and specialised.
fn plans(integrator: Integrator) -> Vec<(&'static str, Plan<f64>)> {
    let arms = ["mobl-arms", "myo-arm", "myo-hand"].map(|name| (name, arm(name)));
    let all = [
        ("linkage", model_of(LINKAGE)),
        ("tumbler", model_of(TUMBLER)),
        ("juggler", model_of(JUGGLER)),
        ("levers", levers()),
    ];
    let modes = [CouplingMode::Reduced, CouplingMode::Soft];
    let of_model = |(name, model): (&'static str, Model)| {
        let [reduced, soft] = modes.map(|mode| plan_of(model.clone(), mode, integrator));
        [(name, reduced.specialised()), (name, reduced), (name, soft)]
    };
    all.into_iter().chain(arms).flat_map(of_model).collect()
}

/// Forces without those of constraints.
fn torque(plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>) -> Vec<f64> {
    step::forward(plan, &Obstacles::none(plan), state, ws);
    ws.torque.clone()
}

/// The mass matrix times a vector.
fn product(plan: &Plan<f64>, mass: &[f64], x: &[f64]) -> Vec<f64> {
    let n = plan.ndof();
    let row = |k: usize| (0..n).map(|j| mass[k.max(j) * n + k.min(j)] * x[j]).sum();
    (0..n).map(row).collect()
}

/// Of `(M - h dF/dv) x = M a` with the acceleration `a` before the step, what is not so, as a share of the greatest force. Without
/// muscles that pull forces are squares of velocities, of which differences are exact.
fn residual(plan: &Plan<f64>, mut state: State<f64>) -> f64 {
    state.act.fill(0.0);
    let mut ws = Workspace::new(plan);
    let mut other = ws.clone();
    let nothing = Obstacles::none(plan);
    step::forward(plan, &nothing, &state, &mut ws);
    step::integrate(plan, &vec![0.0; plan.nmuscle()], &mut state.clone(), &mut ws);
    let x = &ws.step_qacc;
    let scale = 10.0 / greatest(x);
    let [more, less] = [scale, -scale].map(|scale| {
        let mut state = state.clone();
        state.qvel.iter_mut().zip(x).for_each(|(speed, x)| *speed += scale * x);
        torque(plan, &state, &mut other)
    });
    let (found, wanted) = (product(plan, &ws.mass, x), product(plan, &ws.mass, &ws.qacc));
    let change = more.iter().zip(&less).map(|(more, less)| plan.timestep * (more - less) / (2.0 * scale));
    let found: Vec<f64> = found.iter().zip(change).map(|(force, change)| force - change).collect();
    difference(&found, &wanted) / greatest(&wanted)
}

#[test]
fn a_step_takes_forces_as_they_become() {
    let mut explicit: f64 = 0.0;
    for ((name, plan), (_, fast)) in plans(Integrator::Implicit).into_iter().zip(plans(Integrator::ImplicitFast)) {
        for number in 0..50 {
            let state = random_state(&plan, number);
            let error = residual(&plan, state.clone());
            assert!(error < 1e-9, "{name} with {} coordinates: {error:e}", plan.ndof());
            explicit = explicit.max(residual(&fast, state));
        }
    }
    assert!(explicit > 1e-3, "what `implicitfast` leaves out is much more: {explicit:e}");
}

/// How much more energy a free body has after so many seconds in which nothing acts on it, as a share.
fn gained(plan: &Plan<f64>, seconds: f64) -> f64 {
    let (mut state, mut ws, nothing) = (State::new(plan), Workspace::new(plan), Obstacles::none(plan));
    state.qvel[3..6].copy_from_slice(&[0.3, 12.0, 0.2]);
    let energy = |state: &State<f64>, ws: &mut Workspace<f64>| -> f64 {
        step::forward(plan, &nothing, state, ws);
        product(plan, &ws.mass, &state.qvel).iter().zip(&state.qvel).map(|(p, v)| 0.5 * p * v).sum()
    };
    let before = energy(&state, &mut ws);
    for _ in 0..(seconds / plan.timestep) as usize {
        step::step(plan, &nothing, &vec![0.0; plan.nmuscle()], &mut state, &mut ws);
    }
    energy(&state, &mut ws) / before - 1.0
}

/// A body that spins about its middle axis tumbles on and on. Euler's method lets it gain energy with every turn.
#[test]
fn what_tumbles_gains_no_energy() {
    let text = r#"<mujoco><option timestep="0.002" gravity="0 0 0"/><default><geom contype="0" conaffinity="0"/></default>
<worldbody><site name="arm"/><body name="arm"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="0.01 0.02 0.03"/>
<site name="tip"/><site name="top" pos="0 0 1"/></body></worldbody>
<tendon><spatial name="m"><site site="tip"/><site site="top"/></spatial></tendon>
<actuator><muscle name="m" tendon="m" lengthrange="0.1 2" force="1"/></actuator></mujoco>"#;
    let [euler, implicit, fast] = [Integrator::Euler, Integrator::Implicit, Integrator::ImplicitFast]
        .map(|integrator| gained(&plan_of(model_of(text), CouplingMode::Reduced, integrator), 20.0));
    println!("Euler {euler:.3}, implicit {implicit:.3}");
    assert!(euler > 0.1 && (-0.4..0.0).contains(&implicit), "{euler}, {implicit}");
    // As a free body that carries nothing it is the same with `implicitfast`.
    assert_eq!(implicit, fast);
}

/// Of bodies whose mass matrix is diagonal as they are written MuJoCo's `implicitfast` knows nothing else.
#[test]
fn what_slides_along_its_axes_is_taken_apart() {
    let apart = |inertial: &str, joint: &str, integrator| {
        let text = format!(
            r#"<mujoco><default><geom contype="0" conaffinity="0"/></default><worldbody><site name="hook" pos="1 1 1"/>
<body name="arm"><joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/>{joint}
<inertial mass="1" diaginertia="0.01 0.02 0.025" {inertial}/><site name="tip"/></body></worldbody>
<tendon><spatial name="m"><site site="hook"/><site site="tip"/></spatial></tendon>
<actuator><muscle name="m" tendon="m" lengthrange="0.1 2" force="1"/></actuator></mujoco>"#
        );
        let plan = plan_of(model_of(&text), CouplingMode::Reduced, integrator);
        plan.implicit_muscles[0].pairs.iter().filter(|[a, b]| a != b).count()
    };
    let (centred, turn) = ("pos=\"0 0 0\"", "<joint name=\"turn\" axis=\"0 0 1\"/>");
    assert_eq!(apart(centred, "", Integrator::ImplicitFast), 0);
    assert_eq!(apart(centred, turn, Integrator::ImplicitFast), 0);
    assert_eq!(apart(centred, "", Integrator::Implicit), 1);
    assert_eq!(apart("pos=\"0 0 0.1\"", turn, Integrator::ImplicitFast), 3);
    assert_eq!(apart("pos=\"0 0 0\" quat=\"0 1 0 0\"", "", Integrator::ImplicitFast), 1);
}
