//! Properties of the equations of motion.

mod common;

use common::{arm, difference, draw, exact, greatest, random_state};
use myo_dynamics::spatial::{Motion, Vec3, Wrench};
use myo_dynamics::step::{self, force, inertia, kinematics::kinematics};
use myo_dynamics::{CouplingMode, Obstacles, Plan, PlanError, State, Workspace};
use myo_model::description::{Shape, Softness};
use myo_model::{Model, ModelDescription};

/// A skeleton with its springs alone: no muscles, dampers or limits.
fn conservative(mut plan: Plan<f64>) -> Plan<f64> {
    plan.muscles.clear();
    plan.limits.clear();
    plan.tendons.constant.clear();
    plan.tendons.pairs.clear();
    plan.dofs.iter_mut().for_each(|dof| dof.damping = 0.0);
    plan.curved_joints.iter_mut().for_each(|joint| joint.damping = 0.0);
    plan.implicit_damping = false;
    plan
}

/// A small body with slides and curved couplings.
fn gadget() -> Plan<f64> {
    let text = include_str!("../examples/gadget.yaml");
    let description = ModelDescription::from_yaml(text, "gadget.yaml").unwrap();
    Plan::exact(&Model::new(&description).unwrap(), CouplingMode::Reduced).unwrap()
}

/// Kinetic energy, and that of gravity and springs (J).
fn energy(plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>) -> f64 {
    let n = plan.ndof();
    step::forward(plan, &Obstacles::none(plan), state, ws);
    let entry = |i: usize, j: usize| ws.mass[i.max(j) * n + i.min(j)];
    let kinetic: f64 = (0..n * n).map(|k| 0.5 * entry(k / n, k % n) * state.qvel[k / n] * state.qvel[k % n]).sum();
    let gravity = Vec3::splat(plan.gravity);
    let place = |body: &myo_dynamics::plan::Body<f64>| ws.frame(body.link).place(Vec3::splat(body.com));
    let potential: f64 = plan.bodies.iter().map(|body| -body.mass * gravity.dot(place(body))).sum();
    let spring = |(dof, &q): (&myo_dynamics::plan::Dof<f64>, &f64)| (0.5 * dof.stiffness * q + dof.spring_torque) * q;
    let curved: f64 = plan
        .curved_joints
        .iter()
        .map(|joint| {
            let position = step::kinematics::joint_state(&joint.drive, &state.qpos, &state.qvel).position;
            0.5 * joint.stiffness * (position - joint.spring_ref).powi(2)
        })
        .sum();
    kinetic + potential + curved + plan.dofs.iter().zip(&state.qpos).map(spring).sum::<f64>()
}

/// Greatest change of energy (J) over a fifth of a second.
fn drift(plan: Plan<f64>, timestep: f64) -> f64 {
    let plan = Plan { timestep, ..conservative(plan) };
    let (mut state, mut ws) = (random_state(&plan, 3), Workspace::<f64>::new(&plan));
    let start = energy(&plan, &state, &mut ws);
    let mut worst: f64 = 0.0;
    for _ in 0..(0.2 / timestep) as usize {
        step::step(&plan, &Obstacles::none(&plan), &[], &mut state, &mut ws);
        worst = worst.max((energy(&plan, &state, &mut ws) - start).abs());
    }
    worst
}

#[test]
fn energy_is_conserved_to_first_order_in_the_time_step() {
    for plan in [exact(CouplingMode::Reduced), gadget()] {
        let (coarse, fine) = (drift(plan.clone(), 1e-4), drift(plan, 5e-5));
        assert!(fine < 0.05, "{fine} J");
        assert!((1.8..2.2).contains(&(coarse / fine)), "{coarse} J at twice the step, {fine} J");
    }
}

#[test]
fn mass_matrix_is_the_inverse_dynamics_of_unit_accelerations() {
    for coupling in [CouplingMode::Reduced, CouplingMode::Soft] {
        let plan = Plan { gravity: [0.0; 3], ..exact(coupling) };
        let (n, mut ws) = (plan.ndof(), Workspace::<f64>::new(&plan));
        let state = State { qvel: vec![0.0; n], ..random_state(&plan, 5) };
        step::forward(&plan, &Obstacles::none(&plan), &state, &mut ws);
        for dof in 0..n {
            for (link, acceleration) in plan.links.iter().zip(&mut ws.acceleration) {
                *acceleration = link.screw_of_dof[dof].map_or(Motion::zero(), |screw| ws.screw[screw]);
            }
            ws.wrench.fill(Wrench::zero());
            ws.joint_torque.fill(0.0);
            ws.torque.fill(0.0);
            inertia::resist(&plan, &mut ws);
            force::project(&plan, &mut ws);
            for k in 0..n {
                let armature = if k == dof { plan.dofs[k].armature } else { 0.0 };
                let entry = ws.mass[k.max(dof) * n + k.min(dof)];
                assert!((entry - armature + ws.torque[k]).abs() < 1e-12, "{coupling:?} ({k}, {dof})");
            }
        }
    }
}

#[test]
fn reduced_equations_are_the_full_ones_projected() {
    let (full, reduced) = (exact(CouplingMode::Soft), exact(CouplingMode::Reduced));
    let (mut f, mut r) = (Workspace::<f64>::new(&full), Workspace::<f64>::new(&reduced));
    let (n, m) = (reduced.ndof(), full.ndof());
    for number in 0..100 {
        let state = random_state(&reduced, number);
        let everything = State {
            qpos: reduced.joint_positions(&state.qpos),
            qvel: reduced.joint_rates(&state.qpos, &state.qvel),
            act: state.act.clone(),
        };
        step::forward(&reduced, &Obstacles::none(&reduced), &state, &mut r);
        step::forward(&full, &Obstacles::none(&full), &everything, &mut f);
        // Column k of G: the rates of all joints at unit speed of coordinate k. Linear couplings add no acceleration.
        let unit = |k: usize| (0..n).map(|j| f64::from(u8::from(j == k))).collect::<Vec<f64>>();
        let g: Vec<Vec<f64>> = (0..n).map(|k| reduced.joint_rates(&state.qpos, &unit(k))).collect();
        let torque: Vec<f64> = g.iter().map(|g| g.iter().zip(&f.torque).map(|(a, b)| a * b).sum()).collect();
        assert!(difference(&torque, &r.torque) < 1e-10 * greatest(&r.torque).max(1.0), "torque, state {number}");
        for i in 0..n {
            for j in 0..=i {
                let entry = |k: usize| g[i][k / m] * f.mass[(k / m).max(k % m) * m + (k / m).min(k % m)] * g[j][k % m];
                let projected: f64 = (0..m * m).map(entry).sum();
                assert!((projected - r.mass[i * n + j]).abs() < 1e-12, "({i}, {j}), state {number}");
            }
        }
    }
}

#[test]
fn limits_push_back() {
    let plan = conservative(exact(CouplingMode::Reduced));
    let limited = Plan { limits: exact(CouplingMode::Reduced).limits, ..plan.clone() };
    let (mut free, mut held) = (Workspace::<f64>::new(&plan), Workspace::<f64>::new(&limited));
    for (k, dof) in limited.dofs.iter().enumerate() {
        let [lo, hi] = dof.range.unwrap();
        for (beyond, sign) in [(lo - 0.05, 1.0), (hi + 0.05, -1.0)] {
            let mut state = State { qvel: vec![0.0; plan.ndof()], ..random_state(&plan, 8) };
            state.qpos[k] = beyond;
            step::forward(&plan, &Obstacles::none(&plan), &state, &mut free);
            step::forward(&limited, &Obstacles::none(&limited), &state, &mut held);
            assert!(sign * (held.qacc[k] - free.qacc[k]) > 0.0, "{} at {beyond}", dof.name);
        }
    }
}

/// The limit of a joint that follows another one by a curve acts on that joint's acceleration, which is more than the slope
/// times the coordinate's: the curve itself accelerates it.
#[test]
fn limits_of_curved_joints_feel_the_curvature() {
    const H: f64 = 1e-4;
    let text = include_str!("../examples/gadget.yaml");
    let model = Model::new(&ModelDescription::from_yaml(text, "gadget.yaml").unwrap()).unwrap();
    let [reduced, soft] = [CouplingMode::Reduced, CouplingMode::Soft].map(|c| Plan::exact(&model, c).unwrap());
    let (bend, row) = (model.joints.iter().position(|joint| joint.name == "bend").unwrap(), 2);
    let (mut r, mut f) = (Workspace::<f64>::new(&reduced), Workspace::<f64>::new(&soft));
    let (mut active, mut n) = (0, 0);
    for number in 0..400 {
        // Rail and swing within their limits.
        let state = State {
            qpos: vec![0.3 * draw(number, 0) - 0.15, 0.2 * draw(number, 1) - 1.0, draw(number, 2) - 0.5],
            qvel: (0..3).map(|k| 12.0 * draw(number, 3 + k) - 6.0).collect(),
            act: vec![draw(number, 6)],
        };
        step::forward(&reduced, &Obstacles::none(&reduced), &state, &mut r);
        // The same limit where the joint is a coordinate, and its row nothing but the joint.
        let everything = State {
            qpos: reduced.joint_positions(&state.qpos),
            qvel: reduced.joint_rates(&state.qpos, &state.qvel),
            act: state.act.clone(),
        };
        step::forward(&soft, &Obstacles::none(&soft), &everything, &mut f);
        let limit = &f.limit[row];
        assert_eq!(limit.exists, r.limit[row].exists);
        if !limit.exists {
            continue;
        }
        // The joint's acceleration, from its position along the way.
        let at = |t: f64| {
            let q = |k: usize| state.qpos[k] + state.qvel[k] * t + 0.5 * r.qacc[k] * t * t;
            reduced.joint_positions(&[q(0), q(1), q(2)])[bend]
        };
        let acceleration = limit.slope * (at(H) - 2.0 * at(0.0) + at(-H)) / (H * H);
        let push = limit.weight * (limit.reference - acceleration).max(0.0);
        let swing = reduced.limits[row].drive.dof.unwrap();
        let force: f64 =
            (0..3).map(|k| r.mass[swing.max(k) * 3 + swing.min(k)] * r.qacc[k]).sum::<f64>() - r.torque[swing];
        let wanted = r.limit[row].slope * push;
        assert!((force - wanted).abs() < 1e-3 * wanted.abs().max(1.0), "state {number}: {force} N m for {wanted} N m");
        active += u32::from(push > 0.0);
        n += 1;
    }
    assert!(n > 50 && active > 20, "the limit is passed in {n} states and pushes in {active}");
}

#[test]
fn limits_hold_under_full_activation() {
    let plan = exact(CouplingMode::Reduced);
    let (mut state, mut ws) = (random_state(&plan, 4), Workspace::<f64>::new(&plan));
    for number in 0..20 {
        let ctrl: Vec<f64> = (0..plan.nmuscle()).map(|k| draw(number, k).round()).collect();
        for _ in 0..100 {
            step::step(&plan, &Obstacles::none(&plan), &ctrl, &mut state, &mut ws);
        }
        assert!(state.act.iter().all(|a| (0.0..=1.0).contains(a)));
        for (dof, q) in plan.dofs.iter().zip(&state.qpos) {
            let [lo, hi] = dof.range.unwrap();
            assert!((lo - 0.3..hi + 0.3).contains(q), "{}: {q}", dof.name);
        }
    }
}

#[test]
fn automatic_muscle_force_equals_mujocos() {
    // `actuator_acc0` of MuJoCo 3.17.0.
    let acc0 = [(0, 0.5703720182790424), (7, 0.48458461438019523), (13, 1.522256259070472), (25, 0.06943510415051846)];
    let mut model = arm("mobl-arms");
    let given = Plan::exact(&model, CouplingMode::Reduced).unwrap();
    model.muscles.iter_mut().for_each(|muscle| muscle.parameters.gain.force = None);
    let automatic = Plan::exact(&model, CouplingMode::Reduced).unwrap();
    for (k, acc0) in acc0 {
        let parameters = &arm("mobl-arms").muscles[k].parameters;
        let [shortest, longest] = parameters.length_range;
        let middle = 0.5 * (shortest + longest);
        // What a full activation adds at the same length is proportional to the peak force.
        let active =
            |plan: &Plan<f64>| plan.muscles[k].force(middle, 0.0, 1.0) - plan.muscles[k].force(middle, 0.0, 0.0);
        let expected = parameters.gain.scale / acc0 / parameters.gain.force.unwrap();
        let ratio = active(&automatic) / active(&given);
        assert!((ratio / expected - 1.0).abs() < 1e-9, "muscle {k}: {ratio} for {expected}");
    }
}

#[test]
fn models_that_cannot_be_simulated_are_refused_by_name() {
    let mut model = arm("mobl-arms");
    model.geoms[0].shape = Shape::Box { half_size: [0.01; 3] };
    let refused = Plan::exact(&model, CouplingMode::Reduced).unwrap_err();
    assert_eq!(refused, PlanError::NotASphere { name: "fingertip".into() });
    assert!(refused.to_string().starts_with("geom 'fingertip' is a box"), "{refused}");

    let mut model = arm("mobl-arms");
    let second = myo_model::model::Geom { name: "thumb".into(), ..model.geoms[0].clone() };
    model.geoms.push(second);
    let refused = Plan::exact(&model, CouplingMode::Reduced).unwrap_err();
    assert!(refused.to_string().starts_with("geom 'thumb': one sphere of each finger touches the boxes"), "{refused}");
    // One that touches the first presses nothing, nor does that then.
    let contact = myo_model::model::Contact {
        geoms: [0, 1],
        margin: 0.0,
        friction: [1.0, 1.0, 0.0, 0.0, 0.0],
        softness: Softness::default(),
    };
    model.contacts.push(contact);
    let plan = Plan::exact(&model, CouplingMode::Reduced).unwrap();
    assert!(plan.contact_spheres.is_empty() && plan.pairs.len() == 1);
    for shape in [Shape::Plane, Shape::Cylinder { radius: 0.01, half_length: 0.01 }] {
        model.geoms.iter_mut().for_each(|geom| geom.shape = shape);
        let refused = Plan::exact(&model, CouplingMode::Reduced).unwrap_err();
        assert!(refused.to_string().starts_with("contact of geoms 'fingertip' and 'thumb': all shapes"), "{refused}");
    }

    let mut model = arm("mobl-arms");
    let last = model.joints.len() - 1;
    model.joints[last].armature = 0.0;
    for body in model.bodies.iter_mut().skip(model.joints[last].body) {
        (body.mass, body.inertia) = (0.0, nalgebra::Matrix3::zeros());
    }
    let refused = Plan::exact(&model, CouplingMode::Reduced).unwrap_err();
    assert!(refused.to_string().starts_with("joint 'pro_sup' moves no mass"), "{refused}");
}

#[test]
fn a_step_leaves_nothing_of_the_step_before() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let none = Obstacles::none(&plan);
    let (mut used, mut fresh) = (Workspace::<f64>::new(&plan), Workspace::<f64>::new(&plan));
    step::forward(&plan, &none, &random_state(&plan, 1), &mut used);
    let state = random_state(&plan, 2);
    step::forward(&plan, &none, &state, &mut used);
    step::forward(&plan, &none, &state, &mut fresh);
    assert_eq!(used.qacc, fresh.qacc);
    kinematics(&plan, &state.qpos, &state.qvel, &mut fresh);
    assert_eq!(step::fingertip(&plan, &used), step::fingertip(&plan, &fresh));
}

/// A joint that is where another one is has no coordinate of its own.
#[test]
fn a_joint_may_follow_another_one_exactly() {
    let mut arm = arm("mobl-arms");
    let follows = |coupling: &&mut myo_model::model::Coupling| coupling.independent.is_some();
    let first = arm.couplings.iter_mut().find(follows).unwrap();
    first.polycoef = [0.0, 1.0, 0.0, 0.0, 0.0];
    let (dependent, leader) = (first.dependent, first.independent.unwrap());
    let plan = Plan::exact(&arm, CouplingMode::Reduced).unwrap();
    assert_eq!(plan.ndof(), 5);
    let joints = plan.joint_positions(&random_state(&plan, 1).qpos);
    assert_eq!(joints[dependent], joints[leader]);
}
