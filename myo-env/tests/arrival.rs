//! Movement times against the same movements seen at every physics step.
//!
//! With a control step of one physics step, observations tell where the fingertip is and what it touches in between. Actions
//! are repeated, so that the body moves alike.

use crate::common::{actions, arm, column, dwell_for, entry, gpu, sphere, without_gpu};
use myo_env::{CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, StepStorage, VectorEnv};
use myo_model::StaticBox;
use myo_scalar::Level;
use myo_tasks::logic::CompiledTask;
use myo_tasks::{Item, Task};

const ENVS: usize = 64;
/// Physics steps of a control step, and how long one is (s).
const SUBSTEPS: usize = 25;
const TIMESTEP: f64 = 0.002;

/// A large sphere in the midst of where the arm goes.
fn pointing() -> Task {
    let text = "\
version: 2
user: fastest
name: pointing
model: mobl-arms-uitb
scene:
  ball: {kind: sphere, at: [0.35, -0.1, -0.2], radius: 0.2}
script:
  - dwell: {in: ball, for_s: 0.1}
time_limit_s: 1
";
    Task::from_yaml(text, "pointing").unwrap()
}

/// A button there that is so large that nobody comes to its sides.
fn pressing() -> Task {
    let text = "\
version: 2
user: fastest
name: pressing
model: mobl-arms-uitb
scene:
  button: {kind: button, at: [0.35, -0.1, -0.2], size: [2, 2, 0.02], tilt_deg: 45, min_force_n: 1}
script:
  - press: button
time_limit_s: 1
reset: {velocity_spread_rad_s: 2}
";
    Task::from_yaml(text, "pressing").unwrap()
}

/// Actions of a control step.
fn excite(env: &dyn VectorEnv, step: usize) -> Vec<f32> {
    actions(env, step / 4)
}

/// `time` and `movement_time` of the first episodes in which the target was done.
fn measure(env: &mut dyn VectorEnv) -> Vec<Option<[f64; 2]>> {
    let mut out = StepStorage::new(env.spec());
    let (width, time) = (env.spec().episode_size(), column(env, "target_1_time"));
    assert_eq!(column(env, "target_1_movement_time"), time + 1);
    let (mut times, mut ended) = (vec![None; ENVS], [false; ENVS]);
    for step in 0..env.spec().max_episode_steps {
        let actions = excite(env, step);
        env.step(&actions, out.buffers()).unwrap();
        for i in (0..ENVS).filter(|&i| out.terminated[i] && !ended[i]) {
            let row = &out.episode[i * width + time..][..2];
            times[i] = Some([f64::from(row[0]), f64::from(row[1])]);
        }
        (0..ENVS).for_each(|i| ended[i] |= out.terminated[i] || out.truncated[i]);
    }
    times
}

/// What the reference observes at every physics step, environments within steps: some entries of the observation from
/// `first` on.
fn watch(mut task: Task, first: &str, entries: usize) -> Vec<Vec<Vec<f64>>> {
    let steps = (task.time_limit_s / TIMESTEP).round() as usize;
    task.control_dt_s = TIMESTEP;
    task.time_limit_s *= 2.0;
    let limit_s = task.time_limit_s;
    dwell_for(&mut task, limit_s);
    if let Some(Item::Button(button)) = task.scene.0.get_mut("button") {
        button.min_force_n = WATCHED_FORCE;
    }
    let mut env = ReferenceEnv::new(&arm(&task), &task, &EnvConfig { num_envs: ENVS, ..EnvConfig::default() }).unwrap();
    let (nobs, at) = (env.spec().observation_size(), entry(&env, first));
    let mut out = StepStorage::new(env.spec());
    let seen = |observation: &[f32]| -> Vec<Vec<f64>> {
        observation.chunks(nobs).map(|row| row[at..at + entries].iter().copied().map(f64::from).collect()).collect()
    };
    env.reset(Some(0), None, &mut out.observation).unwrap();
    let mut all = vec![seen(&out.observation)];
    for step in 0..steps {
        let actions = excite(&env, step / SUBSTEPS);
        env.step(&actions, out.buffers()).unwrap();
        // What follows an end is another episode and of no interest.
        let (now, last) = (seen(&out.observation), seen(&out.final_observation));
        let ended = out.terminated.iter().zip(now.into_iter().zip(last));
        all.push(ended.map(|(&ended, (now, last))| if ended { last } else { now }).collect());
    }
    all
}

/// Force (N) that ends an episode only long after the press that is looked for.
const WATCHED_FORCE: f64 = 1e3;

/// Time and movement time of a dwell of so many physics steps in the sphere, in physics steps, for an environment: it is over with the first
/// so many in a row, and the episode with the control step in which that is.
fn dwell(inside: &[bool], long: usize) -> Option<[usize; 2]> {
    // Where the last step leads to is where none begins any more.
    let begins = &inside[..inside.len() - 1];
    let entry = begins.windows(long).position(|stay| stay.iter().all(|&x| x))?;
    Some([(entry + long).next_multiple_of(SUBSTEPS), entry])
}

/// Time and movement time of a press of 1 N, in physics steps; step `n` of the forces acted from `n` to `n + 1`.
fn press(force: &[f64]) -> Option<[usize; 2]> {
    let pressed = force.iter().position(|&f| f >= 1.0)?;
    let onset = (0..=pressed).rev().take_while(|&n| force[n] > 0.0).last()?;
    Some([(pressed / SUBSTEPS + 1) * SUBSTEPS, onset])
}

/// Environments of every backend measure what was seen, to one physics step; `least` of them do the task.
fn check(task: &Task, truth: &[Option<[usize; 2]>], least: usize) {
    let config = EnvConfig { num_envs: ENVS, ..EnvConfig::default() };
    let body = arm(task);
    let mut backends: Vec<(String, Box<dyn VectorEnv>)> =
        vec![("reference".into(), Box::new(ReferenceEnv::new(&body, task, &config).unwrap()))];
    for level in Level::available() {
        let config = EnvConfig { level: Some(level), ..config };
        backends.push((format!("{level:?}"), Box::new(CpuEnv::new(&body, task, &config).unwrap())));
    }
    if !without_gpu() {
        backends.push(("card".into(), Box::new(GpuEnv::new(&gpu(), &body, task, &config).unwrap())));
    }
    let done: Vec<[usize; 2]> = truth.iter().flatten().copied().collect();
    let between = done.iter().filter(|[_, movement]| movement % SUBSTEPS != 0).count();
    assert!(done.len() >= least && 2 * between > done.len(), "{done:?}");
    for (name, mut env) in backends {
        for (i, (got, want)) in measure(&mut *env).into_iter().zip(truth).enumerate() {
            let (Some(got), Some(want)) = (got, want) else {
                assert_eq!(got.is_some(), want.is_some(), "{name}, environment {i}: {got:?} for {want:?}");
                continue;
            };
            let [time, movement] = want.map(|steps| steps as f64 * TIMESTEP);
            assert!((got[0] - time).abs() < 1e-6, "{name}, environment {i}: time {} for {time}", got[0]);
            let slack = if name == "reference" { 1e-6 } else { 1.001 * TIMESTEP };
            assert!((got[1] - movement).abs() < slack, "{name}, environment {i}: movement {} for {movement}", got[1]);
        }
    }
}

#[test]
fn an_entry_is_where_the_fingertip_was_seen_to_enter() {
    let mut task = pointing();
    let ball = sphere(&mut task, "ball");
    let (centre, radius) = (ball.at.0.at([0.0; 3]), ball.radius.min);
    let seen = watch(task.clone(), "fingertip_position.x", 3);
    let inside = |i: usize| -> Vec<bool> {
        let distance = |row: &Vec<f64>| row.iter().zip(centre).map(|(x, c)| (x - c) * (x - c)).sum::<f64>().sqrt();
        seen.iter().map(|rows| distance(&rows[i]) < radius).collect()
    };
    let truth: Vec<_> = (0..ENVS).map(|i| dwell(&inside(i), 50)).collect();
    check(&task, &truth, 20);
}

#[test]
fn a_press_is_where_its_contact_was_seen_to_begin() {
    let task = pressing();
    let (seen, places) = (watch(task.clone(), "touch", 1), watch(task.clone(), "fingertip_position.x", 3));
    let StaticBox { centre, axes, .. } = CompiledTask::<f64>::new(&task).unwrap().boxes[0].shape;
    // Who comes from behind touches, and does not press.
    let is_before = |place: &[f64]| (0..3).map(|k| (place[k] - centre[k]) * axes[2][k]).sum::<f64>() > 0.0;
    // The observation after a step tells of the force in it.
    let force = |i: usize| -> Vec<f64> {
        let steps = seen[1..].iter().zip(&places);
        steps.map(|(rows, places)| if is_before(&places[i]) { rows[i][0] * WATCHED_FORCE } else { 0.0 }).collect()
    };
    let truth: Vec<_> = (0..ENVS).map(|i| press(&force(i))).collect();
    check(&task, &truth, 10);
}

/// Half a second in and about a sphere that hardly moves, against where the fingertip was at every physics step.
#[test]
fn how_well_a_sphere_is_tracked_is_what_was_seen() {
    let task = Task::from_yaml(TRACKING, "tracking").unwrap();
    let seen = watch(pointing(), "fingertip_position.x", 3);
    let off = |i: usize, step: usize| {
        let row = &seen[step][i];
        row.iter().zip([0.35, -0.1, -0.2]).map(|(x, c)| (x - c) * (x - c)).sum::<f64>().sqrt()
    };
    let config = EnvConfig { num_envs: ENVS, ..EnvConfig::default() };
    let body = arm(&task);
    let mut backends: Vec<Box<dyn VectorEnv>> = vec![
        Box::new(ReferenceEnv::new(&body, &task, &config).unwrap()),
        Box::new(CpuEnv::new(&body, &task, &config).unwrap()),
    ];
    if !without_gpu() {
        backends.push(Box::new(GpuEnv::new(&gpu(), &body, &task, &config).unwrap()));
    }
    for mut env in backends {
        let [on_target, error] = ["on_target", "tracking_error"].map(|name| column(&*env, name));
        let (width, mut out) = (env.spec().episode_size(), StepStorage::new(env.spec()));
        for step in 0..10 {
            let actions = excite(&*env, step);
            env.step(&actions, out.buffers()).unwrap();
        }
        assert!(out.terminated.iter().all(|&is_over| is_over), "half a second is over");
        let mut between = 0;
        for i in 0..ENVS {
            let distances: Vec<f64> = (0..10 * SUBSTEPS).map(|step| off(i, step)).collect();
            let n = distances.len() as f64;
            let inside = distances.iter().filter(|&&distance| distance < 0.2).count() as f64 / n;
            let rms = (distances.iter().map(|distance| distance * distance).sum::<f64>() / n).sqrt();
            let row = &out.episode[i * width..][..width];
            assert!((f64::from(row[on_target]) - inside).abs() < 0.0081, "{}, not {inside}", row[on_target]);
            assert!((f64::from(row[error]) - rms).abs() < 2e-4, "{}, not {rms}", row[error]);
            between += usize::from(inside > 0.0 && inside < 1.0);
        }
        assert!(between > ENVS / 8, "{between}");
    }
}

const TRACKING: &str = "\
version: 2
user: fastest
name: pointing
model: mobl-arms-uitb
scene:
  ball: {kind: sphere, at: [0.35, -0.1, -0.2], radius: 0.2, moves: {kind: line, by: [0, 0, 0.0001], period_s: 600}}
script:
  - track: {target: ball, for_s: 0.5}
time_limit_s: 1
";
