//! Bodies that are held together, that resist more than sliding, whose friction is in cones and whose steps are implicit: the same however they are
//! computed, and as mechanics has it.

mod common;

use common::{Look, difference, greatest, in_lanes, narrow_state, recorded};
use myo_dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo_model::description::{Connection, Integrator, Landmarks, Softness, Weld};
use myo_model::import::{ImportOptions, from_mjcf};
use myo_model::{Model, builtin};
use myo_scalar::{Level, Scalar};
use std::collections::BTreeMap;

/// A multiple of any number of lanes.
const STATES: u32 = 512;

/// A free trunk with an arm and a lever, pinned and welded to each other, to a tool and to the world.
const LINKAGE: &str = include_str!("../examples/linkage.xml");
/// A free body that falls on floor and table.
const TUMBLER: &str = include_str!("../examples/tumbler.xml");
/// Free bodies that carry nothing, which `implicitfast` takes as `implicit` takes all.
const JUGGLER: &str = include_str!("../examples/juggler.xml");

fn model_of(text: &str) -> Model {
    let files = BTreeMap::from([("body.xml".to_owned(), text.to_owned())]);
    let mjcf = myo_mjcf::read_from(&files, "body.xml", myo_mjcf::Limits::default()).unwrap();
    Model::new(&from_mjcf(&mjcf, &ImportOptions::new(Landmarks::new("tip", "arm"))).unwrap()).unwrap()
}

fn plan_of(text: &str) -> Plan<f64> {
    Plan::exact(&model_of(text), CouplingMode::Reduced).unwrap()
}

/// An arm of our own that steps implicitly, muscles along its girdle included.
fn implicit(name: &str, integrator: Integrator) -> Plan<f64> {
    let mut arm = builtin(name).unwrap();
    arm.options.integrator = integrator;
    Plan::exact(&Model::new(&arm).unwrap(), CouplingMode::Reduced).unwrap()
}

/// The linkage; the falling body where it twists and rolls against what it touches, harder than it presses, with pyramids and with cones; and arms; with steps of every kind.
fn plans() -> Vec<(&'static str, Plan<f64>)> {
    let rough = |options: &str| {
        let text = TUMBLER
            .replacen("condim=\"3\"", "condim=\"4\" friction=\"0.9 0.6 0.03\"", 1)
            .replace("condim=\"3\"/>", "condim=\"6\" friction=\"0.9 0.7 0.03 0.01 0.02\"/>")
            .replace("<default>", &format!("<option impratio=\"3\" {options}/><default>"));
        plan_of(&text)
    };
    let pyramids = rough("");
    assert_eq!(pyramids.pairs.iter().map(|pair| pair.condim).collect::<Vec<_>>(), [4, 3, 1, 3, 3, 1, 6, 6, 6]);
    let cones = rough("cone=\"elliptic\" integrator=\"implicitfast\"");
    assert_eq!(cones.pairs.iter().filter(|pair| pair.is_cone).count(), 7);
    let held = LINKAGE.replacen("<default>", "<option integrator=\"implicit\"/><default>", 1);
    let mut all = vec![("linkage", plan_of(LINKAGE)), ("pyramids", pyramids), ("cones", cones)];
    all.extend([("implicit linkage", plan_of(&held)), ("implicit pyramids", rough("integrator=\"implicit\""))]);
    let thrown = JUGGLER.replacen("<option ", "<option integrator=\"implicitfast\" ", 1);
    all.push(("juggler", plan_of(&thrown)));
    all.extend(["mobl-arms", "myo-arm"].map(|name| (name, implicit(name, Integrator::ImplicitFast))));
    let full = [("implicit mobl-arms", "mobl-arms"), ("implicit myo-arm", "myo-arm")];
    all.extend(full.map(|(name, arm)| (name, implicit(arm, Integrator::Implicit))));
    assert_eq!(all.iter().filter(|(_, plan)| plan.unsymmetric.is_some()).count(), 5);
    all
}

/// Accelerations, and those of a step.
#[derive(Clone, Copy)]
struct Forward;

impl Look for Forward {
    #[inline(always)]
    fn look<S: Scalar>(self, plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) -> Vec<S> {
        step::forward(plan, &Obstacles::none(plan), state, ws);
        step::integrate(plan, &vec![S::lit(0.5); plan.nmuscle()], &mut state.clone(), ws);
        [ws.qacc.clone(), ws.step_qacc.clone()].concat()
    }
}

/// How far `found` is from what the exact plan computes in double precision, by state, relative to the greatest acceleration.
fn errors(plan: &Plan<f64>, found: &[Vec<f64>]) -> Vec<f64> {
    let mut ws = Workspace::new(plan);
    let error = |(number, found): (usize, &Vec<f64>)| {
        let wanted = Forward.look(plan, &narrow_state(plan, number as u32), &mut ws);
        difference(&wanted, found) / greatest(&wanted).max(1.0)
    };
    let mut errors: Vec<f64> = found.iter().enumerate().map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

fn states(plan: &Plan<f64>, count: u32) -> Vec<State<f64>> {
    (0..count).map(|number| narrow_state(plan, number)).collect()
}

#[test]
fn the_specialised_plan_is_the_exact_one() {
    for (name, plan) in plans() {
        let (fast, mut ws) = (plan.specialised(), Workspace::new(&plan.specialised()));
        let found: Vec<_> = states(&plan, STATES).iter().map(|state| Forward.look(&fast, state, &mut ws)).collect();
        let errors = errors(&plan, &found);
        // Profiles of a girdle are as good as single precision.
        let most = if name.ends_with("arm") || name.ends_with("arms") { 1e-5 } else { 1e-7 };
        let worst = errors[errors.len() - 1];
        assert!(worst < most, "{name}: {worst:e}");
    }
}

#[test]
fn lanes_are_as_the_reference() {
    for (name, plan) in plans() {
        for level in Level::available() {
            let found = in_lanes(Forward, level, &plan.specialised().cast(), &states(&plan, STATES));
            let errors = errors(&plan, &found);
            let [median, most] = [errors[errors.len() / 2], errors[errors.len() * 99 / 100]];
            assert!(median < 5e-5 && most < 2e-3, "{name} {}: {median:e}, {most:e}", level.name());
        }
    }
}

#[test]
fn the_recorded_program_is_as_the_reference() {
    for (name, plan) in plans() {
        let errors = errors(&plan, &recorded(Forward, &plan, &states(&plan, 60)));
        let worst = errors[errors.len() - 1];
        assert!(worst < 1e-4, "{name}: {worst:e}");
    }
}

/// What happens to a body in some seconds, alone.
fn after(plan: &Plan<f64>, state: &mut State<f64>, seconds: f64) {
    let (mut ws, nothing) = (Workspace::new(plan), Obstacles::none(plan));
    for _ in 0..(seconds / plan.timestep).round() as usize {
        step::step(plan, &nothing, &vec![0.0; plan.nmuscle()], state, &mut ws);
    }
}

/// Two arms of a pendulum that are pinned to each other's tips, so that a triangle stands which no joint holds up.
#[test]
fn a_pinned_frame_stands() {
    let text = |equality: &str| {
        format!(
            r#"<mujoco><compiler angle="radian"/><default><geom contype="0" conaffinity="0"/></default><worldbody>
  <site name="hook" pos="0 0 1"/>
  <body name="arm" pos="-0.3 0 0"><joint name="left" axis="0 1 0" pos="0 0 0"/>
    <inertial pos="0.15 0 0.2" mass="1" diaginertia="0.01 0.01 0.01"/><site name="tip" pos="0.3 0 0.4"/></body>
  <body name="other" pos="0.3 0 0"><joint name="right" axis="0 1 0" pos="0 0 0"/>
    <inertial pos="-0.15 0 0.2" mass="1" diaginertia="0.01 0.01 0.01"/><site name="top" pos="-0.3 0 0.4"/></body>
</worldbody><equality>{equality}</equality>
<tendon><spatial name="m"><site site="hook"/><site site="tip"/></spatial></tendon>
<actuator><muscle tendon="m" lengthrange="0.2 2" force="0.001"/></actuator></mujoco>"#
        )
    };
    let lean = |equality: &str| {
        let plan = plan_of(&text(equality));
        let mut state = State::<f64>::new(&plan);
        // A breath of wind.
        state.qvel[0] = 0.01;
        after(&plan, &mut state, 0.6);
        greatest(&state.qpos)
    };
    assert!(lean("") > 1.0, "two poles fall");
    for held in
        ["<connect site1=\"tip\" site2=\"top\"/>", "<connect body1=\"arm\" body2=\"other\" anchor=\"0.3 0 0.4\"/>"]
    {
        assert!(lean(held) < 0.01, "{held}: {}", lean(held));
    }
    assert!(lean("<weld body1=\"arm\" body2=\"other\"/>") < 0.01);
    assert!(lean("<weld body1=\"arm\"/>") < lean("<connect body1=\"arm\" anchor=\"0 0 0\"/>"));
}

/// How hard a thing that slides along x and y and does not roll is braked, as a share of what presses it down.
fn braked(options: &str, [x, y]: [f64; 2]) -> f64 {
    let plan = plan_of(&format!(
        r#"<mujoco><option timestep="0.001" {options}/><compiler angle="radian"/><worldbody>
  <geom name="floor" type="plane" size="1 1 1" friction="0.3"/><site name="hook" pos="0 0 1"/>
  <body name="arm" pos="0 0 2"><joint axis="0 1 0"/><inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
    <site name="tip" pos="0.1 0 0"/></body>
  <body name="thing" pos="0 0 0.099"><freejoint/><inertial pos="0 0 0" mass="2" diaginertia="900 900 900"/>
    <geom name="thing" size="0.1" friction="0.3"/></body>
</worldbody>
<tendon><spatial name="m"><site site="hook"/><site site="tip"/></spatial></tendon>
<actuator><muscle tendon="m" lengthrange="0.2 2" force="0.001"/></actuator></mujoco>"#
    ));
    let mut state = State::<f64>::new(&plan);
    (state.qvel[1], state.qvel[2]) = (x, y);
    let mut ws = Workspace::new(&plan);
    step::forward(&plan, &Obstacles::none(&plan), &state, &mut ws);
    assert!(ws.qacc[3] > -9.0, "it is pressed to the floor");
    ws.qacc[1].hypot(ws.qacc[2]) / (ws.qacc[3] + 9.81)
}

#[test]
fn a_cone_brakes_in_all_directions_alike() {
    for way in [[2.0, 0.0], [0.0, -2.0], [1.4, 1.4], [0.5, -1.9]] {
        let cone = braked("cone=\"elliptic\"", way);
        assert!((cone - 0.3).abs() < 1e-9, "{way:?}: {cone}");
    }
    // A pyramid is narrower between its edges.
    let [along, between] = [[2.0, 0.0], [1.4, 1.4]].map(|way| braked("", way));
    assert!((along - 0.3).abs() < 1e-9 && (between - 0.3 * 0.5_f64.sqrt()).abs() < 0.01, "{along} {between}");
}

/// However little friction there is, a heavy thing is held up as hard as without any.
#[test]
fn next_to_no_friction_is_as_hard_as_none() {
    let upwards = |options: &str, geom: &str| {
        let hard = "solimp=\"0.9999 0.9999 0.001\"";
        let plan = plan_of(&format!(
            r#"<mujoco><option {options}/><compiler angle="radian"/><worldbody>
  <geom name="floor" type="plane" size="1 1 1" friction="0" {hard} {geom}/><site name="hook" pos="0 0 1"/>
  <body name="arm" pos="0 0 2"><joint axis="0 1 0"/><inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
    <site name="tip" pos="0.1 0 0"/></body>
  <body name="thing" pos="0 0 0.099"><freejoint/><inertial pos="0 0 0" mass="100" diaginertia="9 9 9"/>
    <geom name="thing" size="0.1" friction="0" {hard} {geom}/></body>
</worldbody>
<tendon><spatial name="m"><site site="hook"/><site site="tip"/></spatial></tendon>
<actuator><muscle tendon="m" lengthrange="0.2 2" force="0.001"/></actuator></mujoco>"#
        ));
        let mut ws = Workspace::new(&plan);
        step::forward(&plan, &Obstacles::none(&plan), &State::<f64>::new(&plan), &mut ws);
        ws.qacc[3]
    };
    let none = upwards("", "condim=\"1\"");
    for options in ["", "impratio=\"10\"", "cone=\"elliptic\"", "cone=\"elliptic\" impratio=\"10\""] {
        let some = upwards(options, "condim=\"3\"");
        assert!((some - none).abs() < 1e-3 * none, "{options}: {some} for {none} m/s^2");
    }
}

/// A ball of 2 kg and 10 cm on a floor, thrown.
fn ball(condim: u32, [x, spin]: [f64; 2], seconds: f64) -> [f64; 2] {
    let plan = plan_of(&format!(
        r#"<mujoco><option timestep="0.001"/><compiler angle="radian"/><worldbody>
  <geom name="floor" type="plane" size="1 1 1" condim="{condim}" friction="1 0.02 0.01"/><site name="hook" pos="0 0 1"/>
  <body name="arm" pos="0 0 2"><joint axis="0 1 0"/><inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.01"/>
    <site name="tip" pos="0.1 0 0"/></body>
  <body name="ball" pos="0 0 0.1"><freejoint/><inertial pos="0 0 0" mass="2" diaginertia="0.008 0.008 0.008"/>
    <geom name="ball" size="0.1"/></body>
</worldbody>
<tendon><spatial name="m"><site site="hook"/><site site="tip"/></spatial></tendon>
<actuator><muscle tendon="m" lengthrange="0.2 2" force="0.001"/></actuator></mujoco>"#
    ));
    let mut state = State::<f64>::new(&plan);
    // It rolls along x, and spins about the vertical.
    (state.qvel[1], state.qvel[5], state.qvel[6]) = (x, x / 0.1, spin);
    after(&plan, &mut state, seconds);
    [state.qvel[1], state.qvel[6]]
}

#[test]
fn what_resists_twisting_stops_a_spin_and_what_resists_rolling_a_ball() {
    let [rolls, spins] = ball(3, [0.5, 10.0], 0.2);
    assert!((rolls - 0.5).abs() < 0.01 && (spins - 10.0).abs() < 0.01, "nothing stops it: {rolls} m/s, {spins} rad/s");
    // 2 cm times its weight against the inertia: 49 rad/s^2.
    let [_, spins] = ball(4, [0.0, 10.0], 0.1);
    assert!((spins - (10.0 - 0.1 * 0.02 * 2.0 * 9.81 / 0.008)).abs() < 0.3, "{spins} rad/s");
    let [_, spins] = ball(4, [0.0, 10.0], 0.5);
    assert!(spins.abs() < 0.01, "it stands: {spins} rad/s");
    // 1 cm times its weight against what it has about the point where it touches, 0.028 kg m^2: 0.7 m/s^2.
    let [rolls, _] = ball(6, [0.5, 0.0], 0.3);
    assert!((rolls - (0.5 - 0.3 * 0.01 * 2.0 * 9.81 / 0.028 * 0.1)).abs() < 0.03, "{rolls} m/s");
    let [rolls, _] = ball(6, [0.5, 0.0], 2.0);
    assert!(rolls.abs() < 0.01, "it stands: {rolls} m/s");
}

/// A left arm on a strap moves as a right one does.
#[test]
fn a_mirrored_arm_is_held_alike() {
    let mut arm = builtin("mobl-arms").unwrap();
    let hold = |body: &str, weld: Option<Weld>| Connection {
        bodies: [body, "thorax"].map(String::from),
        anchors: [[0.02, 0.01, 0.03], [0.3, -0.2, 0.2]],
        weld,
        softness: Softness { solref: [0.1, 1.0], ..Softness::default() },
    };
    arm.connections.push(hold("radius", None));
    arm.connections.push(hold("hand", Some(Weld { quat: [0.5, 0.5, 0.1, 0.7], torque_scale: 0.3 })));
    let free = Plan::exact(&Model::new(&builtin("mobl-arms").unwrap()).unwrap(), CouplingMode::Reduced).unwrap();
    let [right, left] = [arm.clone(), arm.mirrored()]
        .map(|arm| Plan::exact(&Model::new(&arm).unwrap(), CouplingMode::Reduced).unwrap());
    for state in states(&right, 50) {
        let [right, left, free] =
            [&right, &left, &free].map(|plan| Forward.look(plan, &state, &mut Workspace::new(plan)));
        assert!(difference(&right, &left) < 1e-9 * greatest(&right), "{right:?} {left:?}");
        assert!(difference(&right, &free) > 0.1, "it is held");
    }
}
