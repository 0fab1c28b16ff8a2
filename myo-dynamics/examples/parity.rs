//! Writes what this crate computes of the built-in arm, to be compared with MuJoCo:
//! `cargo run -p myo-dynamics --example parity -- DIRECTORY`.
//!
//! `model.xml` and `press.xml` are the arm for MuJoCo, without and with a button; `states.json` holds every quantity of one
//! evaluation in 1,000 random states, `rollouts.json` joint positions over one second of random excitations, `press.json`
//! the force on the button; `keys.xml` and `keys.json` are a thick fingertip on several keys at once; `gadget.xml`, `gadget.json`, `balloon.xml` and
//! `balloon.json` are single steps of bodies with what the arm lacks;
//! `wraps.xml`, `wraps.json` and (by the rule of sides before MuJoCo 4.0) `wraps_mujoco3.json` are a body whose muscles run over spheres and cylinders, in random states and around those where
//! paths begin to bend. Positions are those of all joints; forces have MuJoCo's sign.

use myo_dynamics::step::{self, force, kinematics::kinematics};
use myo_dynamics::{Batch, CouplingMode, Obstacles, Plan, State, StaticBox, Surface, Workspace};
use myo_model::mjcf::{Button, MjcfOptions, to_mjcf};
use myo_model::{Model, ModelDescription, builtin, description};
use myo_scalar::Level;
use nalgebra::{UnitQuaternion, Vector3};
use serde_json::{Value, json};
use std::error::Error;
use std::path::PathBuf;

// Not all of it is used here.
#[allow(dead_code)]
mod common;
use common::{Draws, bias_force, passive_force};

const STATES: u32 = 1000;
const ROLLOUTS: u32 = 16;
const CONTROL_STEPS: usize = 20;
const PHYSICS_STEPS: usize = 25;
const PRESSES: u32 = 60;
const GADGETS: u32 = 300;
const WRAPS: u32 = 1000;
/// Poses from which every coordinate is swept in search of states where a path begins to bend, and steps of a sweep.
const SWEEPS: u32 = 12;
const SWEEP_STEPS: usize = 120;
/// How far from such a state (rad or m) states are compared.
const ASIDE: [f64; 4] = [1e-8, 1e-5, 1e-3, 1e-2];
/// How far joints may be beyond their limits (rad): four degrees.
const BEYOND: f64 = 0.07;
/// How far coupled joints may be from where their coupling holds them (rad).
const SLACK: f64 = 1e-3;
/// Half sizes of the button (m).
const BUTTON: [f64; 3] = [0.03, 0.02, 0.01];
const BUTTON_NAME: &str = "button";
/// Radius (m) of a fingertip that touches several keys at once.
const THICK: f64 = 0.012;
/// Two rows of three keys, 1 mm apart.
const KEYS: usize = 6;
const KEY: [f64; 3] = [0.0045, 0.0045, 0.003];
const PITCH: f64 = 0.01;

fn main() -> Result<(), Box<dyn Error>> {
    let directory = PathBuf::from(std::env::args().nth(1).ok_or("usage: parity DIRECTORY")?);
    std::fs::create_dir_all(&directory)?;
    let model = Model::new(&builtin("mobl-arms")?)?;
    let arm =
        Arm { soft: Plan::exact(&model, CouplingMode::Soft)?, reduced: Plan::exact(&model, CouplingMode::Reduced)? };
    let write = |name: &str, text: String| std::fs::write(directory.join(name), text);
    write("model.xml", to_mjcf(&model, &MjcfOptions::default()))?;
    write(
        "press.xml",
        to_mjcf(&model, &MjcfOptions { buttons: vec![button(BUTTON_NAME.into())], ..MjcfOptions::default() }),
    )?;
    write("states.json", Value::from_iter((0..STATES).map(|k| arm.state(Draws::new(1, k)))).to_string())?;
    write("rollouts.json", Value::from_iter((0..ROLLOUTS).map(|k| arm.rollout(Draws::new(2, k)))).to_string())?;
    write("press.json", Value::from_iter((0..PRESSES).map(|k| arm.press(Draws::new(3, k), k))).to_string())?;
    let mut thick = builtin("mobl-arms")?;
    thick.geoms[0].shape = description::Shape::Sphere { radius: THICK };
    let thick = Model::new(&thick)?;
    let keys: Vec<Button> = (0..KEYS).map(|k| Button { half_size: KEY, ..button(format!("key{k}")) }).collect();
    write("keys.xml", to_mjcf(&thick, &MjcfOptions { buttons: keys, ..MjcfOptions::default() }))?;
    let arm =
        Arm { soft: Plan::exact(&thick, CouplingMode::Soft)?, reduced: Plan::exact(&thick, CouplingMode::Reduced)? };
    write("keys.json", Value::from_iter((0..PRESSES).map(|k| arm.press_keys(Draws::new(5, k)))).to_string())?;
    for (name, text) in [("gadget", include_str!("gadget.yaml")), ("balloon", include_str!("balloon.yaml"))] {
        let gadget = Model::new(&ModelDescription::from_yaml(text, name)?)?;
        write(&format!("{name}.xml"), to_mjcf(&gadget, &MjcfOptions::default()))?;
        let plan = Plan::exact(&gadget, CouplingMode::Soft)?;
        let steps = (0..GADGETS).map(|k| single_step(&plan, Draws::new(4, k)));
        write(&format!("{name}.json"), Value::from_iter(steps).to_string())?;
    }
    let mut description = ModelDescription::from_yaml(include_str!("wraps.yaml"), "wraps.yaml")?;
    write("wraps.xml", to_mjcf(&Model::new(&description)?, &MjcfOptions::default()))?;
    for (name, rule) in [("wraps", description::SideRule::Mujoco4), ("wraps_mujoco3", description::SideRule::Mujoco3)] {
        description.options.side_rule = rule;
        let plan = Plan::exact(&Model::new(&description)?, CouplingMode::Soft)?;
        let random = (0..WRAPS).map(|k| paths(&plan, random_state(&plan, &mut Draws::new(6, k)), None));
        let onsets = (0..SWEEPS).flat_map(|k| onsets(&plan, Draws::new(7, k)));
        write(&format!("{name}.json"), Value::from_iter(random.chain(onsets)).to_string())?;
    }
    Ok(())
}

/// Every quantity of muscle paths in one state. `onset` names the stretch that begins to bend nearby.
fn paths(plan: &Plan<f64>, state: State<f64>, onset: Option<usize>) -> Value {
    let mut ws = Workspace::<f64>::new(plan);
    step::forward(plan, &Obstacles::none(plan), &state, &mut ws);
    let (qacc, muscle_force) = (ws.qacc.clone(), ws.muscle_force.clone());
    let moments: Vec<Vec<f64>> = (0..plan.nmuscle()).map(|muscle| force::moment_arms(plan, muscle, &mut ws)).collect();
    json!({
        "qpos": state.qpos, "qvel": state.qvel, "act": state.act, "ctrl": vec![0.0; plan.nmuscle()],
        "tendon_length": ws.tendon_length, "tendon_velocity": ws.tendon_velocity, "moments": moments,
        "muscle_force": muscle_force, "qacc": qacc, "bends": bends(&ws), "onset": onset,
    })
}

/// Of each stretch, whether it bends.
fn bends(ws: &Workspace<f64>) -> Vec<bool> {
    ws.wrap_bends.iter().map(|&bends| bends > 0.5).collect()
}

fn random_state(plan: &Plan<f64>, draws: &mut Draws) -> State<f64> {
    let n = plan.ndof();
    State {
        qpos: draws.vector(n, -1.2, 1.2),
        qvel: draws.vector(n, -3.0, 3.0),
        act: draws.vector(plan.nmuscle(), 0.0, 1.0),
    }
}

/// States around those where a stretch begins or ends to bend, on the way of one coordinate.
fn onsets(plan: &Plan<f64>, mut draws: Draws) -> Vec<Value> {
    let state = random_state(plan, &mut draws);
    let mut ws = Workspace::<f64>::new(plan);
    let mut at = |dof: usize, position: f64| {
        let mut state = state.clone();
        state.qpos[dof] = position;
        kinematics(plan, &state.qpos, &state.qvel, &mut ws);
        step::tendon::lengths(plan, &mut ws);
        (bends(&ws), state)
    };
    let place = |step: usize| -1.3 + 2.6 * step as f64 / SWEEP_STEPS as f64;
    let mut found = vec![];
    for dof in 1..plan.ndof() {
        for step in 0..SWEEP_STEPS {
            let (before, after) = (at(dof, place(step)).0, at(dof, place(step + 1)).0);
            let Some(stretch) = (0..before.len()).find(|&k| before[k] != after[k]) else { continue };
            let (mut low, mut high) = (place(step), place(step + 1));
            for _ in 0..48 {
                let middle = 0.5 * (low + high);
                *(if at(dof, middle).0[stretch] == before[stretch] { &mut low } else { &mut high }) = middle;
            }
            let aside = ASIDE.into_iter().flat_map(|by| [-by, by]);
            found.extend(aside.map(|by| paths(plan, at(dof, low + by).1, Some(stretch))));
        }
    }
    found
}

/// One step of a plan from a random state, some joints beyond their limits.
fn single_step(plan: &Plan<f64>, mut draws: Draws) -> Value {
    // Quaternions of any length: they are what their direction is.
    let mut state = State {
        qpos: draws.vector(plan.nq(), -1.2, 1.2),
        qvel: draws.vector(plan.ndof(), -3.0, 3.0),
        act: draws.vector(plan.nmuscle(), 0.0, 1.0),
    };
    let before = state.clone();
    let ctrl = draws.vector(plan.nmuscle(), 0.0, 1.0);
    let mut ws = Workspace::<f64>::new(plan);
    step::step(plan, &Obstacles::none(plan), &ctrl, &mut state, &mut ws);
    json!({
        "qpos": before.qpos, "qvel": before.qvel, "act": before.act, "ctrl": ctrl, "qacc": ws.qacc,
        "muscle_force": ws.muscle_force, "qpos_next": state.qpos, "qvel_next": state.qvel, "act_next": state.act,
    })
}

struct Arm {
    soft: Plan<f64>,
    reduced: Plan<f64>,
}

impl Arm {
    /// Coordinates within their limits, moved outwards by up to `beyond`.
    fn pose(&self, draws: &mut Draws, beyond: f64) -> Vec<f64> {
        let range = |range: Option<[f64; 2]>| range.expect("free joints of the arm are limited");
        self.reduced
            .dofs
            .iter()
            .map(|dof| range(dof.range))
            .map(|[lo, hi]| draws.between(lo - beyond, hi + beyond))
            .collect()
    }

    /// A state of all joints in which the couplings hold up to `slack`.
    fn full_state(&self, draws: &mut Draws, beyond: f64, slack: f64) -> State<f64> {
        let qpos = self.pose(draws, beyond);
        let qvel = draws.vector(qpos.len(), -5.0, 5.0);
        let mut shaken = |joints: Vec<f64>, by: f64| joints.iter().map(|x| x + draws.between(-by, by)).collect();
        State {
            qpos: shaken(self.reduced.joint_positions(&qpos), slack),
            qvel: shaken(self.reduced.joint_rates(&qpos, &qvel), 100.0 * slack),
            act: draws.vector(self.soft.nmuscle(), 0.0, 1.0),
        }
    }

    fn state(&self, mut draws: Draws) -> Value {
        let beyond = if draws.case.is_multiple_of(2) { BEYOND } else { -BEYOND };
        let state = self.full_state(&mut draws, beyond, SLACK);
        let plan = &self.soft;
        let mut ws = Workspace::<f64>::new(plan);
        step::forward(plan, &Obstacles::none(plan), &state, &mut ws);
        json!({
            "qpos": state.qpos, "qvel": state.qvel, "act": state.act,
            "ctrl": draws.vector(plan.nmuscle(), 0.0, 1.0),
            "tendon_length": ws.tendon_length,
            "tendon_velocity": ws.tendon_velocity,
            "muscle_force": ws.muscle_force,
            "qacc_soft": ws.qacc,
            "qfrc_passive": passive_force(plan, &state, &mut ws),
            "qfrc_bias": bias_force(plan, &state, &mut ws),
        })
    }

    /// One second of random excitations, held for one control step each, from rest with relaxed muscles, as tasks start.
    fn rollout(&self, mut draws: Draws) -> Value {
        let plan = &self.reduced;
        let fast = plan.specialised();
        let mut state = State { qpos: self.pose(&mut draws, -0.2), ..State::<f64>::new(plan) };
        let mut lanes = Batch::new(&fast, 1, Level::current());
        lanes.set_state(0, &state.qpos, &state.qvel, &state.act);
        let start = state.clone();
        let mut ws = Workspace::<f64>::new(plan);
        let obstacles = Obstacles::none(plan);
        let (mut ctrl, mut reduced, mut in_lanes) = (vec![], vec![], vec![]);
        for _ in 0..CONTROL_STEPS {
            let excitation = draws.vector(plan.nmuscle(), 0.0, 1.0);
            lanes.set_ctrl(0, &excitation.iter().map(|&u| u as f32).collect::<Vec<_>>());
            lanes.step(PHYSICS_STEPS);
            for _ in 0..PHYSICS_STEPS {
                step::step(plan, &obstacles, &excitation, &mut state, &mut ws);
            }
            let widened: Vec<f64> = lanes.qpos(0).into_iter().map(f64::from).collect();
            in_lanes.push(plan.joint_positions(&widened));
            reduced.push(plan.joint_positions(&state.qpos));
            ctrl.push(excitation);
        }
        json!({
            "qpos0": plan.joint_positions(&start.qpos), "qvel0": plan.joint_rates(&start.qpos, &start.qvel),
            "act0": start.act, "ctrl": ctrl, "qpos_reduced": reduced, "qpos_lanes": in_lanes,
        })
    }

    fn press(&self, mut draws: Draws, case: u32) -> Value {
        let plan = &self.soft;
        let state = self.full_state(&mut draws, -BEYOND, 0.0);
        let mut ws = Workspace::<f64>::new(plan);
        kinematics(plan, &state.qpos, &state.qvel, &mut ws);
        let turn = draws.rotation();
        let centre = Vector3::from(step::fingertip(plan, &ws)) - turn * point_at_button(&mut draws, case);
        let axes = turn.to_rotation_matrix();
        let obstacle =
            StaticBox::new(centre.into(), [0, 1, 2].map(|k| axes.matrix().column(k).into_owned().into()), BUTTON);
        step::forward(plan, &Obstacles::new(plan, &[obstacle], Surface::default()), &state, &mut ws);
        let in_world = centre + Vector3::from(plan.origin);
        json!({
            "qpos": state.qpos, "qvel": state.qvel, "act": state.act, "ctrl": draws.vector(plan.nmuscle(), 0.0, 1.0),
            "button": {"pos": in_world.as_slice(), "quat": [turn.w, turn.i, turn.j, turn.k]},
            "touch_force": ws.contacts[0].force,
        })
    }
}

impl Arm {
    /// A thick fingertip on keys that stand close together.
    fn press_keys(&self, mut draws: Draws) -> Value {
        let plan = &self.soft;
        let state = self.full_state(&mut draws, -BEYOND, 0.0);
        let places: Vec<Vector3<f64>> =
            (0..KEYS).map(|k| PITCH * Vector3::new((k % 2) as f64 - 0.5, (k / 2) as f64 - 1.0, 0.0)).collect();
        let mut ws = Workspace::<f64>::with_contacts(plan, KEYS);
        kinematics(plan, &state.qpos, &state.qvel, &mut ws);
        let turn = draws.rotation();
        let depth = draws.between(-0.002, 0.003);
        let over = Vector3::new(draws.between(-0.012, 0.012), draws.between(-0.018, 0.018), KEY[2] + THICK - depth);
        let middle = Vector3::from(step::fingertip(plan, &ws)) - turn * over;
        let axes = turn.to_rotation_matrix();
        let key = |place: &Vector3<f64>| {
            StaticBox::new(
                (middle + turn * place).into(),
                [0, 1, 2].map(|k| axes.matrix().column(k).into_owned().into()),
                KEY,
            )
        };
        let keys: Vec<StaticBox> = places.iter().map(key).collect();
        let obstacles = Obstacles::new(plan, &keys, Surface::default());
        assert_eq!(obstacles.most_at_once(plan), KEYS);
        step::forward(plan, &obstacles, &state, &mut ws);
        let mut forces = [0.0; KEYS];
        for contact in ws.contacts.iter().filter(|contact| contact.exists) {
            forces[contact.index as usize] = contact.force;
        }
        let in_world = |key: &StaticBox| (Vector3::from(key.centre) + Vector3::from(plan.origin)).as_slice().to_vec();
        json!({
            "qpos": state.qpos, "qvel": state.qvel, "act": state.act, "ctrl": draws.vector(plan.nmuscle(), 0.0, 1.0),
            "keys": keys.iter().map(in_world).collect::<Vec<_>>(), "quat": [turn.w, turn.i, turn.j, turn.k],
            "touch_forces": forces, "qacc_soft": ws.qacc,
        })
    }
}

/// Where the fingertip is, in the button's axes: over and in faces, at edges and corners, deep inside, out of touch.
fn point_at_button(draws: &mut Draws, case: u32) -> Vector3<f64> {
    let sign = |draws: &mut Draws| if draws.between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
    let mut inside = |share: f64| Vector3::from(BUTTON.map(|half| half * draws.between(-share, share)));
    let mut point = match case % 6 {
        5 => return inside(0.95),
        _ => inside(0.9),
    };
    if case == 4 {
        return point + Vector3::new(0.0, 0.0, 0.05);
    }
    // How many faces meet here: one is a face, two an edge, three a corner.
    let faces = [1, 1, 2, 3, 2][case as usize % 6];
    let first = draws.between(0.0, 2.999) as usize;
    for k in 0..faces {
        let axis = (first + k) % 3;
        let side = sign(draws);
        let height = if case % 6 == 1 { draws.between(-0.003, 0.0) } else { draws.between(0.0, 0.001) };
        point[axis] = side * (BUTTON[axis] + height);
    }
    point
}

fn button(name: String) -> Button {
    let surface = Surface::default();
    Button {
        name,
        pos: Vector3::new(1.0, 0.0, 1.0),
        quat: UnitQuaternion::identity(),
        half_size: BUTTON,
        margin: surface.margin,
        friction: [surface.friction, 0.005, 0.0001],
        softness: surface.softness,
    }
}
