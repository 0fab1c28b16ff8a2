//! Writes what this crate computes of an MJCF model in random states, to be compared with MuJoCo:
//! `cargo run -p myo-dynamics --example states -- FILE SITE BODY COUNT RULE ROOT`, with the names of a fingertip and of a shoulder, the rule of
//! sides of this version of MuJoCo, `mujoco4` or `mujoco3`, and a folder above all meshes.
//!
//! Coordinates are those of all joints, from within their limits to a little beyond; couplings hold more or less.

use myo_dynamics::plan::DofKind;
use myo_dynamics::step::{self, force};
use myo_dynamics::{CouplingMode, Obstacles, Plan, Sensors, State, Workspace};
use myo_mjcf::Folder;
use myo_model::Model;
use myo_model::description::Landmarks;
use myo_model::import::{ImportOptions, from_mjcf_in};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::{Value, json};
use std::error::Error;
use std::path::Path;

// Not all of it is used here.
#[allow(dead_code)]
mod common;
use common::{Draws, bias_force, passive_force, smooth_acceleration};

/// How far joints may be beyond their limits (rad or m), and coupled ones from where their coupling holds them.
const BEYOND: f64 = 0.02;
const SLACK: f64 = 1e-3;
/// How far a free body is from its place (m), and how far it is turned (rad) in states in which it stands.
const ASIDE: f64 = 0.1;
const TILT: f64 = 0.2;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, fingertip, shoulder, count, side_rule, root] = &arguments[..] else {
        return Err("usage: states FILE SITE BODY COUNT RULE ROOT".into());
    };
    let mjcf = myo_mjcf::read(Path::new(file))?;
    let landmarks = Landmarks::new(fingertip, shoulder);
    let options = ImportOptions { side_rule: side_rule.parse()?, ..ImportOptions::new(landmarks) };
    let list = |all: Vec<_>| all.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    let model = Model::new(&from_mjcf_in(&mjcf, &options, &Folder::new(Path::new(root))?).map_err(list)?)?;
    let (soft, reduced) = (Plan::exact(&model, CouplingMode::Soft)?, Plan::exact(&model, CouplingMode::Reduced)?);
    let sensors = Sensors::new(&model, &soft);
    let names: Vec<&str> = model.sensors.iter().map(|sensor| sensor.name.as_str()).collect();
    let states = (0..count.parse()?).map(|case| {
        let (state, mut ws, mut values) = state(&soft, &reduced, Draws::new(8, case));
        let read = sensors.read(&soft, &state, &mut ws);
        values["sensors"] = names.iter().zip(read).map(|(name, read)| ((*name).to_owned(), json!(read))).collect();
        values
    });
    println!("{}", Value::from_iter(states));
    Ok(())
}

/// Joints around their ranges, a free body about where it stands and turned any way, or a little in every other state.
fn positions(plan: &Plan<f64>, beyond: f64, draws: &mut Draws) -> Vec<f64> {
    let mut qpos = plan.qpos0.clone();
    for dof in &plan.dofs {
        let [low, high] = match dof.kind {
            DofKind::Joint => dof.range.unwrap_or([-1.0, 1.0]),
            DofKind::Place => [qpos[dof.at] - ASIDE, qpos[dof.at] + ASIDE],
            DofKind::Turn => continue,
        };
        qpos[dof.at] = draws.between(low - beyond, high + beyond);
    }
    for ball in &plan.balls {
        let turn = draws.vector(3, -1.0, 1.0);
        let turn = Vector3::from_vec(turn) * if draws.case.is_multiple_of(2) { 3.0 } else { TILT };
        let quat = &mut qpos[ball.at..ball.at + 4];
        let turned = UnitQuaternion::from_scaled_axis(turn)
            * UnitQuaternion::from_quaternion(Quaternion::new(quat[0], quat[1], quat[2], quat[3]));
        quat.copy_from_slice(&[turned.w, turned.i, turned.j, turned.k]);
    }
    qpos
}

/// A state, its evaluation, and every quantity of that.
fn state(plan: &Plan<f64>, reduced: &Plan<f64>, mut draws: Draws) -> (State<f64>, Workspace<f64>, Value) {
    let beyond = if draws.case.is_multiple_of(2) { BEYOND } else { 0.0 };
    let free = positions(reduced, beyond, &mut draws);
    let rates = draws.vector(reduced.ndof(), -3.0, 3.0);
    let mut shaken = |all: Vec<f64>, by: f64| all.iter().map(|x| x + draws.between(-by, by)).collect();
    let (qpos, qvel) =
        (shaken(reduced.joint_positions(&free), SLACK), shaken(reduced.joint_rates(&free, &rates), 100.0 * SLACK));
    let state = State { qpos, qvel, act: draws.vector(plan.nmuscle(), 0.0, 1.0) };
    let mut ws = Workspace::<f64>::new(plan);
    step::forward(plan, &Obstacles::none(plan), &state, &mut ws);
    let forward = ws.clone();
    let touching =
        plan.pair_points().map(|number| &ws.contacts[ws.box_slots + number]).filter(|contact| contact.exists);
    let distances: Vec<f64> = touching.map(|contact| contact.distance).collect();
    let (qacc, muscle_force) = (ws.qacc.clone(), ws.muscle_force[..plan.nmuscle()].to_vec());
    let mut after = state.clone();
    step::integrate(plan, &vec![0.0; plan.nmuscle()], &mut after, &mut ws);
    let smooth = smooth_acceleration(plan, &mut ws);
    let [lengths, velocities] = [&ws.tendon_length, &ws.tendon_velocity].map(|all| all[..plan.nmuscle()].to_vec());
    let moments: Vec<Vec<f64>> = (0..plan.nmuscle()).map(|muscle| force::moment_arms(plan, muscle, &mut ws)).collect();
    let values = json!({
        "qpos": state.qpos, "qvel": state.qvel, "act": state.act, "ctrl": vec![0.0; plan.nmuscle()],
        "tendon_length": lengths, "tendon_velocity": velocities, "moments": moments, "muscle_force": muscle_force,
        "qvel_after": after.qvel, "act_after": after.act,
        "qacc_soft": qacc, "qacc_smooth": smooth, "qfrc_passive": passive_force(plan, &state, &mut ws),
        "distances": distances, "qfrc_bias": bias_force(plan, &state, &mut ws),
    });
    (state, forward, values)
}
