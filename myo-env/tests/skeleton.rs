//! Poses of states: they are those of the physics.

use crate::common::{arm, entry, rollout, short, shuffled};
use myo_dynamics::spatial::Vec3;
use myo_dynamics::{Obstacles, Workspace, step};
use myo_env::{EnvConfig, EnvError, ReferenceEnv, Role, Skeleton, SkeletonPose, Snapshot, StepStorage, VectorEnv};
use myo_model::Model;
use myo_model::description::{Over, PathElement, Wrap, WrapShape};
use myo_tasks::{Pose, Task, preset_names};

fn env(task: &Task, num_envs: usize) -> ReferenceEnv {
    let config = EnvConfig { num_envs, seed: 4, ..Default::default() };
    ReferenceEnv::new(&arm(task), task, &config).unwrap()
}

fn roles(pose: &SkeletonPose) -> Vec<Role> {
    pose.objects.iter().map(|object| object.role).collect()
}

#[test]
fn the_fingertip_is_the_one_that_is_observed() {
    for name in preset_names() {
        let task = short(name);
        let (mut env, skeleton) = (env(&task, 3), Skeleton::new(&arm(&task), &task).unwrap());
        let seen = rollout(&mut env, 4).pop().unwrap().observation;
        let (at, width) = (entry(&env, "fingertip_position.x"), env.spec().observation_size());
        for (moment, row) in env.peek(0..3).unwrap().iter().zip(seen.chunks(width)) {
            let pose = skeleton.pose(moment).unwrap();
            assert_eq!(pose.fingertip.map(|x| x as f32), row[at..at + 3], "{name}");
        }
    }
}

#[test]
fn paths_of_muscles_are_as_long_as_in_the_physics_and_lie_on_bodies() {
    let task = short("pointing-uitb");
    let (mut env, skeleton) = (env(&task, 5), Skeleton::new(&arm(&task), &task).unwrap());
    rollout(&mut env, 6);
    let plan = &env.tables().plan;
    let (mut ws, model) = (Workspace::<f64>::new(plan), skeleton.model());
    for moment in env.peek(0..5).unwrap() {
        let pose = skeleton.pose(&moment).unwrap();
        step::forward(plan, &Obstacles::none(plan), &moment.body, &mut ws);
        for (index, muscle) in pose.muscles.iter().enumerate() {
            let name = &model.muscles[index].name;
            let part = |ends: &[[f64; 3]]| (0..3).map(|k| (ends[1][k] - ends[0][k]).powi(2)).sum::<f64>().sqrt();
            let length: f64 = muscle.points.windows(2).map(part).sum();
            assert!((length - ws.tendon_length[index]).abs() < 1e-12, "{name}: {length}");
            assert_eq!(muscle.activation, moment.body.act[index]);
            for (&site, point) in model.muscles[index].path.iter().zip(&muscle.points) {
                let site = &model.sites[site];
                let on_body = pose.bodies[site.body].place(Vec3::new(site.pos.x, site.pos.y, site.pos.z)).array();
                let off = (0..3).map(|k| (on_body[k] - point[k]).abs()).fold(0.0, f64::max);
                assert!(off < 1e-12, "{name} on {}: {off:e}", model.bodies[site.body].name);
            }
        }
    }
    let names: Vec<&str> = skeleton.limb().iter().map(|&body| &*model.bodies[body].name).collect();
    assert_eq!(names, ["humerus", "ulna", "radius", "hand"]);
}

#[test]
fn bent_paths_have_points_on_the_arc() {
    let task = short("pointing-uitb");
    let mut description = myo_model::builtin(&task.model).unwrap();
    let (muscle, sites) = (&mut description.muscles[3], 2);
    assert_eq!((&*muscle.name, muscle.path.len()), ("SUPSP", sites + 1));
    muscle.path.insert(1, PathElement::Over(Over { over: "head".into(), side: None }));
    let shape = WrapShape::Sphere { radius: 0.02 };
    let (name, body) = ("head".to_owned(), "humerus".to_owned());
    description.wraps.push(Wrap { name, body, shape, pos: [0.0; 3], quat: [1.0, 0.0, 0.0, 0.0] });
    let model = Model::new(&description).unwrap();
    let config = EnvConfig { num_envs: 20, seed: 4, ..Default::default() };
    let mut env = ReferenceEnv::new(&model, &task, &config).unwrap();
    let skeleton = Skeleton::new(&model, &task).unwrap();
    rollout(&mut env, 3);
    let plan = &env.tables().plan;
    let mut ws = Workspace::<f64>::new(plan);
    let humerus = model.bodies.iter().position(|body| body.name == "humerus").unwrap();
    let on = skeleton.path_bodies(3);
    assert_eq!(on.iter().filter(|&&body| body == humerus).count(), 8);
    let mut bent = 0;
    for moment in env.peek(0..20).unwrap() {
        let pose = skeleton.pose(&moment).unwrap();
        step::forward(plan, &Obstacles::none(plan), &moment.body, &mut ws);
        let points = &pose.muscles[3].points;
        assert_eq!(points.len(), on.len());
        let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt();
        let length: f64 = points.windows(2).map(|ends| distance(ends[0], ends[1])).sum();
        // Chords of a sixth of the arc.
        assert!((length - ws.tendon_length[3]).abs() < 1e-3, "{length} for {}", ws.tendon_length[3]);
        let centre = pose.bodies[humerus].position.array();
        let is_bent = points[1..8].iter().all(|&point| (distance(point, centre) - 0.02).abs() < 1e-9);
        bent += u32::from(is_bent);
    }
    assert!(bent > 0);
}

/// A sphere somewhere, an obstacle, a button that is pressed twice, in this order.
fn mixed() -> Task {
    let text = "
version: 2
user: fastest
model: mobl-arms
name: mixed
time_limit_s: 2
scene:
  slot: {kind: sphere, at: {x: 0.4, y: [-0.1, 0.1], z: -0.2}, radius: [0.03, 0.05]}
  wall: {kind: obstacle, at: [0.5, 0.2, -0.3], size: [0.1, 0.2, 0.02]}
  key: {kind: button, at: [0.45, -0.1, -0.3], tilt_deg: 60, size: [0.03, 0.05, 0.01]}
script: [{press: key}, {dwell: {in: slot, for_s: 0.2}}, {press: key}]
";
    Task::from_yaml(text, "mixed").unwrap()
}

#[test]
fn objects_are_where_they_are_in_this_episode() {
    let task = mixed();
    let (env, skeleton) = (env(&task, 2), Skeleton::new(&arm(&task), &task).unwrap());
    let moments = env.peek(0..2).unwrap();
    assert_ne!(moments[0].task.position, moments[1].task.position);
    for moment in &moments {
        let pose = skeleton.pose(moment).unwrap();
        assert_eq!(pose.objects[0].frame.position.array(), moment.task.position[0]);
        assert_eq!(pose.objects[0].half_size, [moment.task.size[0]; 3]);
        for index in [1, 2] {
            let (block, object) = (skeleton.task().objects[index].block().unwrap(), &pose.objects[index]);
            let [h, w, d] = object.half_size;
            for (across, up) in [(0.0, 0.0), (1.0, 1.0), (-1.0, 0.5)] {
                let (face, point) =
                    (block.face_point(across, up), object.frame.place(Vec3::new(up * h, across * w, d)).array());
                assert!((0..3).all(|k| (face[k] - point[k]).abs() < 1e-12), "{face:?} {point:?}");
            }
        }
    }
}

#[test]
fn objects_have_their_part_in_the_task() {
    let task = mixed();
    let skeleton = Skeleton::new(&arm(&task), &task).unwrap();
    let moment = env(&task, 1).peek(0..1).unwrap().remove(0);
    let at = |phase: f64| {
        let mut later = moment.clone();
        later.task.phase = phase;
        let pose = skeleton.pose(&later).unwrap();
        (pose.step, roles(&pose))
    };
    assert_eq!(at(0.0), (Some(0), vec![Role::Later, Role::Bystander, Role::Current]));
    assert_eq!(at(1.0), (Some(1), vec![Role::Current, Role::Bystander, Role::Later]));
    assert_eq!(at(2.0), (Some(2), vec![Role::Done, Role::Bystander, Role::Current]));
    assert_eq!(at(3.0), (None, vec![Role::Done, Role::Bystander, Role::Done]));
}

#[test]
fn the_current_object_goes_by_the_order_of_the_episode_and_by_what_is_to_be_corrected() {
    let task = shuffled();
    let skeleton = Skeleton::new(&arm(&task), &task).unwrap();
    let mut env = env(&task, 20);
    let mut moment = env.peek(0..1).unwrap().remove(0);
    (moment.task.order, moment.task.phase) = (vec![2.0, 0.0, 1.0, 3.0, 5.0, 4.0, 6.0, 7.0, 8.0], 1.0);
    let pose = skeleton.pose(&moment).unwrap();
    assert_eq!((pose.step, pose.current), (Some(0), Some(0)));
    assert_eq!([0, 1, 2].map(|object| pose.objects[object].role), [Role::Current, Role::Later, Role::Done]);
    moment.task.errors = Some(1.0);
    let pose = skeleton.pose(&moment).unwrap();
    let current = &skeleton.task().objects[pose.current.unwrap()];
    assert_eq!((pose.step, &*current.name), (Some(0), "back"));
    // Arms that flail press wrongly, and dwell in any order.
    let (mut corrects, mut exchanged) = (false, false);
    for _ in 0..20 {
        rollout(&mut env, 1);
        for moment in env.peek(0..20).unwrap() {
            corrects |= moment.task.corrects() == Some(true);
            exchanged |= moment.task.order[3..7] != [3.0, 4.0, 5.0, 6.0];
        }
    }
    assert!(corrects && exchanged, "{corrects}, {exchanged}");
}

#[test]
fn moments_of_other_tasks_and_bodies_are_refused() {
    let task = short("pointing-uitb");
    let skeleton = Skeleton::new(&arm(&task), &task).unwrap();
    let other = env(&short("ticket"), 1).peek(0..1).unwrap().remove(0);
    let refused = skeleton.pose(&other).err().unwrap().to_string();
    assert_eq!(refused, "task.position of the snapshot has 0 entries, expected 10");
    let own = env(&task, 1).peek(0..1).unwrap().remove(0);
    let without = |change: fn(&mut Snapshot) -> Option<f64>| {
        let mut changed = own.clone();
        change(&mut changed);
        skeleton.pose(&changed).err()
    };
    let wrong = |what, got, expected| Some(EnvError::WrongLength { what, got, expected });
    assert_eq!(without(|moment| moment.body.qpos.pop()), wrong("qpos of the snapshot", 4, 5));
    assert_eq!(without(|moment| moment.body.act.pop()), wrong("act of the snapshot", 25, 26));
    assert_eq!(without(|moment| moment.task.size.pop()), wrong("task.size of the snapshot", 9, 10));
    let bad = Task { time_limit_s: -1.0, ..task.clone() };
    assert!(Skeleton::new(&arm(&task), &bad).err().unwrap().to_string().contains("time_limit_s"));
}

/// The arm as it hangs, relaxed, and after `steps` control steps in which these muscles are excited in full.
fn moved(model: &Model, excited: &[&str], steps: usize) -> [Moved; 2] {
    let task = myo_tasks::preset("pointing-single").unwrap();
    let human = Task { model: "myo-arm".into(), control_dt_s: 0.04, ..task };
    let mut task = Task { reset: myo_tasks::preset("pointing").unwrap().reset, ..human };
    task.reset.pose = Pose::Zero;
    let mut env = ReferenceEnv::new(model, &task, &EnvConfig::default()).unwrap();
    let skeleton = Skeleton::new(model, &task).unwrap();
    let excitation = model.muscles.iter().map(|muscle| if excited.contains(&&*muscle.name) { 1.0 } else { -1.0 });
    let actions: Vec<f32> = excitation.collect();
    let look = |env: &mut ReferenceEnv| {
        let moment = env.peek(0..1).unwrap().remove(0);
        let pose = skeleton.pose(&moment).unwrap();
        let [ulna, shoulder] = ["ulna", "humphant"].map(|name| {
            let body = model.bodies.iter().position(|body| body.name == name).unwrap();
            pose.bodies[body].place(Vec3::new(0.0, 0.0, 0.0)).array()
        });
        Moved { elbow: [0, 1, 2].map(|axis| ulna[axis] - shoulder[axis]), qpos: moment.body.qpos }
    };
    let mut out = StepStorage::new(env.spec());
    let before = look(&mut env);
    for _ in 0..steps {
        env.step(&actions, out.buffers()).unwrap();
    }
    [before, look(&mut env)]
}

/// How an arm is held: its elbow from the shoulder (m), and its free joints (rad).
struct Moved {
    elbow: [f64; 3],
    qpos: Vec<f64>,
}

/// How far an arm that hangs, relaxed, draws its elbow back in half a second (m), with the muscles that draw it back excited in full.
fn drawn_back(model: &Model) -> f64 {
    let [before, after] = moved(model, &["DELT3", "TMAJ", "LAT1"], 12);
    before.elbow[0] - after.elbow[0]
}

/// By how many degrees the upper arm of a relaxed arm is raised forward once it has come to rest, and its wrist bent, the more of its
/// two ways.
fn hangs(model: &Model) -> [f64; 2] {
    let [_, Moved { elbow: [forward, _, up], qpos }] = moved(model, &[], 90);
    let [.., deviation, flexion] = qpos[..] else { panic!("no wrist") };
    [forward.atan2(-up).to_degrees(), deviation.abs().max(flexion.abs()).to_degrees()]
}

#[test]
fn a_relaxed_arm_hangs() {
    let mut description = myo_model::builtin("myo-arm").unwrap();
    let [forward, wrist] = hangs(&Model::new(&description).unwrap());
    // As MyoArm has it: the front of the deltoid is so stiff that it holds the arm up, and nothing holds the wrist.
    let front = description.muscles.iter_mut().find(|muscle| muscle.name == "DELT1").unwrap();
    front.parameters.bias.fpmax = 0.518315;
    for joint in description.joints.iter_mut().filter(|joint| ["deviation", "flexion"].contains(&&*joint.name)) {
        joint.stiffness = 0.0;
    }
    let [held, fallen] = hangs(&Model::new(&description).unwrap());
    assert!((0.0..10.0).contains(&forward) && held > 13.0, "{forward} degrees, it was {held}");
    assert!(wrist < 10.0 && fallen > 20.0, "a wrist of {wrist} degrees, it was {fallen}");
}

#[test]
fn a_hanging_arm_can_be_drawn_back() {
    let mut description = myo_model::builtin("myo-arm").unwrap();
    let back = drawn_back(&Model::new(&description).unwrap());
    // As MyoArm has it: straight down no muscle turns the plane in which the arm is raised, and the turn is damped twice, and more
    // than people's.
    for joint in &mut description.joints {
        match &*joint.name {
            "shoulder_elv" => joint.range = Some([0.0, std::f64::consts::PI]),
            "elv_angle" | "shoulder1_r2" => joint.damping = 1.05,
            _ => {}
        }
    }
    let before = drawn_back(&Model::new(&description).unwrap());
    assert!(back > 0.15 && back > 3.0 * before, "{back} m, it was {before} m");
}

#[test]
fn fingers_that_move_are_told_with_their_tips() {
    let task = myo_tasks::preset("pinch").unwrap();
    let model = Model::new(&myo_model::builtin("myo-hand").unwrap()).unwrap();
    let skeleton = Skeleton::new(&model, &task).unwrap();
    let mut env = ReferenceEnv::new(&model, &task, &EnvConfig { num_envs: 1, seed: 4, ..Default::default() }).unwrap();
    rollout(&mut env, 4);
    let pose = skeleton.pose(&env.peek(0..1).unwrap()[0]).unwrap();
    let names = |bodies: &[usize]| bodies.iter().map(|&body| model.bodies[body].name.clone()).collect::<Vec<_>>();
    let mut found: Vec<(Vec<String>, [f64; 3])> = skeleton
        .digits()
        .iter()
        .map(|digit| {
            let last = digit.bodies.last().unwrap();
            let [x, y, z] = digit.tip;
            (names(&digit.bodies), pose.bodies[*last].place(Vec3::new(x, y, z)).array())
        })
        .collect();
    assert_eq!(found.len(), 5);
    assert_eq!(found[0].0, ["firstmc_r", "proximal_thumb_r", "distal_thumb_r"]);
    assert_eq!(found[1].0, ["2proxph_r", "midph2_r", "distph2_r"]);
    let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
    let index = found.remove(1).1;
    assert!(near(index, pose.fingertip));
    let mut tips: Vec<[f64; 3]> = found.into_iter().map(|(_, tip)| tip).collect();
    let mut fingers = pose.fingers;
    tips.sort_by(|a, b| a[0].total_cmp(&b[0]));
    fingers.sort_by(|a, b| a[0].total_cmp(&b[0]));
    assert_eq!(tips.len(), fingers.len());
    assert!(tips.iter().zip(&fingers).all(|(&tip, &finger)| near(tip, finger)), "{tips:?} and {fingers:?}");
    assert!(skeleton.moves_hand_only());

    let task = short("pointing");
    let skeleton = Skeleton::new(&arm(&task), &task).unwrap();
    assert!(skeleton.digits().is_empty() && !skeleton.moves_hand_only(), "fingers of an arm are held");
}

#[test]
fn a_body_that_is_no_persons_arm_is_its_bones() {
    let task = short("pointing");
    assert!(Skeleton::new(&arm(&task), &task).unwrap().is_person());
    let mut description = myo_model::builtin("mobl-arms").unwrap();
    (description.anthropometry, description.landmarks.wrist) = (None, None);
    let model = Model::new(&description).unwrap();
    let skeleton = Skeleton::new(&model, &task).unwrap();
    assert!(!skeleton.is_person());
    let bones = skeleton.bones();
    let name = |body: usize| &*model.bodies[body].name;
    let found: Vec<[&str; 2]> = bones.iter().map(|bone| bone.bodies.map(name)).collect();
    assert!(found.contains(&["humerus", "ulna"]) && found.contains(&["ulna", "radius"]), "{found:?}");
    let is_bone = |[a, b]: [usize; 2]| a != 0 && (a == b || model.bodies[b].parent == a);
    assert!(bones.iter().all(|bone| is_bone(bone.bodies)));
    // The last one ends at the fingertip.
    let tip = &model.sites[model.fingertip_site];
    assert!(bones.iter().any(|bone| bone.bodies == [tip.body; 2] && bone.ends[1] == <[f64; 3]>::from(tip.pos)));
}
