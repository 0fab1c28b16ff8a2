//! The fingertip on a box.

mod common;

use common::exact;
use myo_dynamics::{Batch, CouplingMode, Obstacles, Plan, State, StaticBox, Surface, Workspace, step};
use myo_scalar::Level;
use nalgebra::Vector3;

const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Boxes that begin `distance` metres ahead of the fingertip's surface, and whether and how hard it presses at rest.
fn press(plan: &Plan<f64>, distances: &[f64]) -> (bool, f64, f64) {
    let state = State { qpos: vec![0.6, 0.9, -0.5, 1.2, 0.3], ..State::<f64>::new(plan) };
    let mut ws = Workspace::<f64>::new(plan);
    step::kinematics::kinematics(plan, &state.qpos, &state.qvel, &mut ws);
    let [x, y, z] = step::fingertip(plan, &ws);
    let radius = plan.contact_spheres[0].radius;
    let boxed = |&ahead: &f64| StaticBox::new([x + radius + ahead + 0.01, y, z], AXES, [0.01, 0.05, 0.05]);
    let boxes: Vec<StaticBox> = distances.iter().map(boxed).collect();
    step::forward(plan, &Obstacles::new(plan, &boxes, Surface::default()), &state, &mut ws);
    (ws.contacts[0].exists, ws.contacts[0].force, ws.contacts[0].index)
}

#[test]
fn nothing_is_felt_outside_the_margins() {
    let plan = exact(CouplingMode::Reduced);
    let margin = 0.002;
    assert_eq!(press(&plan, &[margin + 1e-9]), (false, 0.0, 0.0));
    assert!(press(&plan, &[margin - 1e-9]).0);
}

#[test]
fn force_rises_with_depth() {
    let plan = exact(CouplingMode::Reduced);
    let forces: Vec<f64> = [0.0, -0.001, -0.002, -0.004, -0.008].iter().map(|&d| press(&plan, &[d]).1).collect();
    assert!(forces.windows(2).all(|pair| pair[0] < pair[1]), "{forces:?}");
}

#[test]
fn the_nearest_box_is_the_one_that_counts() {
    let plan = exact(CouplingMode::Reduced).specialised();
    let (touches, force, index) = press(&plan, &[0.3, -0.001, 0.5]);
    assert!(touches && force == press(&plan, &[-0.001]).1);
    assert_eq!(index, 1.0);
}

/// Twelve keys, 1 mm apart, in a plane before the fingertip.
fn keys(plan: &Plan<f64>, state: &State<f64>) -> Obstacles<f64> {
    let mut ws = Workspace::<f64>::new(plan);
    step::kinematics::kinematics(plan, &state.qpos, &state.qvel, &mut ws);
    let [x, y, z] = step::fingertip(plan, &ws);
    let key = |k: usize| {
        let (row, column) = ((k / 4) as f64 - 1.0, (k % 4) as f64 - 1.5);
        StaticBox::new([x + 0.018, y + 0.02 * column, z + 0.02 * row], AXES, [0.01, 0.0095, 0.0095])
    };
    Obstacles::new(plan, &(0..12).map(key).collect::<Vec<_>>(), Surface::default())
}

#[test]
fn what_is_not_looked_at_is_not_touched() {
    let plan = exact(CouplingMode::Reduced);
    let start = State { qpos: vec![0.6, 0.9, -0.5, 1.2, 0.3], ..State::<f64>::new(&plan) };
    let (mut state, obstacles) = (start.clone(), keys(&plan, &start));
    let most = obstacles.most_at_once(&plan);
    assert_eq!(most, 4);
    let mut ws = Workspace::<f64>::with_contacts(&plan, most);
    let (mut touched, mut several, mut skipped) = (0, 0, 0);
    for now in 0..6000_usize {
        if now.is_multiple_of(100) {
            // From the keys, with a push of another direction.
            let push = |k: usize| 2.0 * ((now / 100 * (k + 2)) as f64).sin();
            state = State { qvel: (0..plan.ndof()).map(push).collect(), ..start.clone() };
        }
        let mut fresh = Workspace::<f64>::with_contacts(&plan, most);
        let before = ws.clearance[0];
        step::forward(&plan, &obstacles, &state, &mut ws);
        step::forward(&plan, &obstacles, &state, &mut fresh);
        skipped += usize::from(before.free > 0.0 && before.from.array() == ws.clearance[0].from.array());
        let found = |ws: &Workspace<f64>| -> Vec<(f64, f64)> {
            ws.contacts.iter().filter(|c| c.exists).map(|c| (c.index, c.force)).collect()
        };
        assert_eq!(found(&ws), found(&fresh), "step {now}");
        assert_eq!(ws.qacc, fresh.qacc, "step {now}");
        touched += usize::from(!found(&ws).is_empty());
        several += usize::from(found(&ws).len() > 1);
        // Muscles by turns, so that the arm comes and goes.
        let muscle = |m: usize| if (m + now / 150).is_multiple_of(3) { 0.9 } else { 0.05 };
        let ctrl: Vec<f64> = (0..plan.nmuscle()).map(muscle).collect();
        step::integrate(&plan, &ctrl, &mut state, &mut ws);
    }
    assert!(touched > 50 && several > 5 && skipped > 1000, "{touched} {several} {skipped}");
}

#[test]
fn a_thick_fingertip_feels_every_box_that_it_touches() {
    let mut description = myo_model::builtin("mobl-arms").unwrap();
    description.geoms[0].shape = myo_model::description::Shape::Sphere { radius: 0.05 };
    let plan = Plan::exact(&myo_model::Model::new(&description).unwrap(), CouplingMode::Reduced).unwrap();
    let state = State { qpos: vec![0.6, 0.9, -0.5, 1.2, 0.3], ..State::<f64>::new(&plan) };
    let mut ws = Workspace::<f64>::with_contacts(&plan, 2);
    step::kinematics::kinematics(&plan, &state.qpos, &state.qvel, &mut ws);
    let [x, y, z] = step::fingertip(&plan, &ws);
    // Two buttons whose edges lie 2 mm aside of the middle, 1 mm within the sphere.
    let aside = |side: f64| StaticBox::new([x + 0.049 + 0.01, y + side * 0.022, z], AXES, [0.01, 0.02, 0.02]);
    let obstacles = Obstacles::new(&plan, &[aside(-1.0), aside(1.0)], Surface::default());
    assert_eq!(obstacles.most_at_once(&plan), 2);
    step::forward(&plan, &obstacles, &state, &mut ws);
    assert!(ws.contacts.iter().all(|contact| contact.exists && contact.force > 0.0), "{:?}", ws.contacts);
}

#[test]
fn lanes_feel_every_box_that_they_touch() {
    let plan = exact(CouplingMode::Reduced);
    let state = State { qpos: vec![0.6, 0.9, -0.5, 1.2, 0.3], ..State::<f64>::new(&plan) };
    let mut ws = Workspace::<f64>::with_contacts(&plan, 2);
    step::kinematics::kinematics(&plan, &state.qpos, &state.qvel, &mut ws);
    let [x, y, z] = step::fingertip(&plan, &ws);
    // Side by side, the fingertip half a millimetre within both where they meet.
    let aside = |side: f64| StaticBox::new([x - 0.0005 + 0.01, y + side * 0.02, z], AXES, [0.01, 0.02, 0.02]);
    let boxes = [aside(-1.0), aside(1.0)];
    let after = |contacts: usize| {
        let (mut state, obstacles) = (state.clone(), Obstacles::new(&plan, &boxes, Surface::default()));
        let mut ws = Workspace::<f64>::with_contacts(&plan, contacts);
        for _ in 0..5 {
            step::step(&plan, &obstacles, &vec![0.0; plan.nmuscle()], &mut state, &mut ws);
        }
        state.qpos
    };
    let (both, one) = (after(2), after(1));
    let mut batch = Batch::new(&plan, 1, Level::current()).touching(&boxes, Surface::default());
    batch.set_state(0, &state.qpos, &state.qvel, &state.act);
    batch.set_ctrl(0, &vec![0.0; plan.nmuscle()]);
    batch.step(5);
    let difference = |a: &[f64]| a.iter().zip(batch.qpos(0)).map(|(a, b)| (a - f64::from(b)).abs()).fold(0.0, f64::max);
    let (right, wrong) = (difference(&both), difference(&one));
    assert!(right < 1e-5 && wrong > 10.0 * right, "{right} {wrong}");
}

#[test]
fn no_arm_comes_through_a_plate() {
    let plan = Plan::exact(&common::arm("myo-arm"), CouplingMode::Reduced).unwrap();
    let radius = plan.contact_spheres[0].radius;
    let place = |state: &State<f64>| {
        let mut ws = Workspace::<f64>::new(&plan);
        step::kinematics::kinematics(&plan, &state.qpos, &state.qvel, &mut ws);
        Vector3::from(step::fingertip(&plan, &ws))
    };
    // Shoulder, elbow and wrist, each alone, at one metre per second.
    for dof in [1, 3, 6] {
        let mut state = State { qpos: vec![0.6, 0.9, -0.5, 1.2, 0.3, 0.0, 0.0], ..State::<f64>::new(&plan) };
        let from = place(&state);
        state.qpos[dof] += 1e-6;
        let way = (place(&state) - from) / 1e-6;
        state.qvel[dof] = 1.0 / way.norm();
        let out = -way.normalize();
        let up = out.cross(&Vector3::new(0.3, 0.5, 0.7)).normalize();
        let axes = [up, out.cross(&up), out].map(Into::into);
        let half = 0.005;
        let middle = from - (radius + 0.005 + half) * out;
        let obstacles =
            Obstacles::new(&plan, &[StaticBox::new(middle.into(), axes, [0.3, 0.3, half])], Surface::default());
        let mut ws = Workspace::<f64>::new(&plan);
        let mut most = 0.0_f64;
        for _ in 0..100 {
            step::step(&plan, &obstacles, &vec![0.0; plan.nmuscle()], &mut state, &mut ws);
            most = most.max(ws.contacts[0].force);
            let above = (place(&state) - middle).dot(&out);
            assert!(above > 0.0, "degree of freedom {dof}: {above} m above the middle of the plate");
        }
        assert!(most > 1.0, "degree of freedom {dof} touches with {most} N");
    }
}

/// A hand over a plate that all of its fingers may touch.
fn hand(fingers: &[&str]) -> Plan<f64> {
    let model = myo_model::Model::new(&myo_model::builtin("myo-hand").unwrap()).unwrap();
    let names: Vec<String> = fingers.iter().map(|&name| name.to_owned()).collect();
    Plan::exact(&model, CouplingMode::Reduced).unwrap().with_fingers(&model, &names).unwrap()
}

/// What a plan of a hand touches of a plate so far below the tip of its index finger (m), by finger, and how it accelerates.
fn on_plate(plan: &Plan<f64>, pose: usize, below: f64) -> (Vec<(usize, f64)>, Vec<f64>) {
    let bent = |k: usize| ((pose * (k + 3)) as f64).sin().abs();
    let at = |(k, dof): (usize, &myo_dynamics::plan::Dof<f64>)| {
        let [lo, hi] = dof.range.unwrap();
        lo + (hi - lo) * (0.3 + 0.4 * bent(k))
    };
    let state = State { qpos: plan.dofs.iter().enumerate().map(at).collect(), ..State::<f64>::new(plan) };
    let mut ws = Workspace::<f64>::new(plan);
    step::kinematics::kinematics(plan, &state.qpos, &state.qvel, &mut ws);
    let [x, y, z] = step::fingertip(plan, &ws);
    // A table, or a key that is too small for two.
    let [wide, thick] = if pose.is_multiple_of(2) { [0.2, 0.02] } else { [0.008, 0.002] };
    let plate = StaticBox::new([x, y, z - below - thick], AXES, [wide, wide, thick]);
    step::forward(plan, &Obstacles::new(plan, &[plate], Surface::default()), &state, &mut ws);
    let touches = plan.contact_spheres.iter().zip(ws.box_contacts());
    let touches = touches.filter(|(_, contacts)| contacts[0].exists);
    (touches.map(|(sphere, contacts)| (sphere.finger, contacts[0].force)).collect(), ws.qacc)
}

#[test]
fn a_plan_keeps_the_fingers_that_were_asked_for_in_their_order() {
    let of = |plan: &Plan<f64>| plan.contact_spheres.iter().map(|sphere| sphere.finger).collect::<Vec<_>>();
    let (all, some, none) = (hand(&["little", "middle", "ring", "thumb"]), hand(&["thumb", "middle"]), hand(&[]));
    assert_eq!((of(&all), of(&some), of(&none)), (vec![0, 1, 2, 3, 4], vec![0, 1, 2], vec![0]));
    assert_eq!((some.fingers.len(), none.fingers.len()), (2, 0));
    let (mut ws, rest) = (Workspace::<f64>::new(&some), State::<f64>::new(&some));
    step::kinematics::kinematics(&some, &rest.qpos, &rest.qvel, &mut ws);
    let tips: Vec<[f64; 3]> = step::fingers(&some, &ws).collect();
    // The ball of each is about its tip.
    for (sphere, tip) in some.contact_spheres[1..].iter().zip(&tips) {
        let ball = ws.place(&sphere.centre).array();
        assert!(ball.iter().zip(tip).all(|(a, b)| (a - b).abs() < 1e-12), "{ball:?} {tip:?}");
    }
    assert!(some.check_presses(0, "thumb").is_ok() && none.check_presses(0, "thumb").is_err());
}

#[test]
fn fingers_press_a_plate_together_and_one_that_is_in_the_air_changes_nothing() {
    let (all, one) = (hand(&["little", "middle", "ring", "thumb"]), hand(&[]));
    let fast = all.specialised();
    let (mut together, mut alone) = (0, 0);
    for pose in 0..200 {
        let (touches, qacc) = on_plate(&all, pose, 0.006);
        let (_, quick) = on_plate(&fast, pose, 0.006);
        let greatest = qacc.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        assert!(qacc.iter().zip(&quick).all(|(a, b)| (a - b).abs() < 1e-7 * greatest), "pose {pose}");
        assert!(touches.iter().any(|&(finger, _)| finger == 0), "pose {pose}: {touches:?}");
        if touches.len() > 1 {
            together += 1;
            continue;
        }
        alone += 1;
        let (same, qacc_of_one) = on_plate(&one, pose, 0.006);
        assert_eq!(touches.len(), same.len());
        assert!(qacc.iter().zip(&qacc_of_one).all(|(a, b)| (a - b).abs() < 1e-9 * greatest), "pose {pose}");
    }
    assert!(together > 20 && alone > 20, "{together} {alone}");
}
