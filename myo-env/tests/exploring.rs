//! Exploring starts: what they change, and what they leave alone.

use crate::common::{arm, column, entry, fast, rollout, short};
use myo_env::{CpuEnv, EnvConfig, EnvSpec, VectorEnv};
use myo_tasks::{Pose, Task};

/// Environments, and how many of them explore.
const ENVS: usize = 600;
const EXPLORING: usize = 500;

fn env(task: &Task, exploring: usize) -> CpuEnv {
    let config = EnvConfig { num_envs: ENVS, seed: 4, exploring, ..EnvConfig::default() };
    CpuEnv::new(&arm(task), task, &config).unwrap()
}

/// Observations after a reset.
fn observed(env: &mut CpuEnv) -> Vec<f32> {
    let mut observation = vec![0.0; ENVS * env.spec().observation_size()];
    env.reset(None, None, &mut observation).unwrap();
    observation
}

/// An entry of the observations of the environments that explore, or of the others.
fn values(env: &CpuEnv, observation: &[f32], name: &str, exploring: bool) -> Vec<f64> {
    let at = entry(env, name);
    let rows = observation.chunks_exact(env.spec().observation_size()).enumerate();
    let wanted = rows.filter(|(env, _)| (*env >= ENVS - EXPLORING) == exploring);
    wanted.map(|(_, row)| f64::from(row[at])).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn whole_episodes_are_those_of_environments_none_of_which_explores() {
    let task = short("public-display");
    let (mut some, mut none) = (env(&task, EXPLORING), env(&task, 0));
    assert_eq!(some.spec().whole_episodes(), ENVS - EXPLORING);
    assert_eq!(EnvSpec { exploring: 0, ..some.spec().clone() }, *none.spec());
    for (a, b) in rollout(&mut some, 25).iter().zip(&rollout(&mut none, 25)) {
        let whole = some.spec().whole_episodes();
        assert_eq!(a.reward[..whole], b.reward[..whole]);
        assert_eq!(a.truncated[..whole], b.truncated[..whole]);
        let entries = whole * some.spec().observation_size();
        assert_eq!(a.observation[..entries], b.observation[..entries]);
        assert_ne!(a.observation[entries..], b.observation[entries..]);
    }
}

#[test]
fn episodes_begin_with_any_target_in_the_later_half_of_the_time() {
    let task = fast("pointing-uitb");
    let mut env = env(&task, EXPLORING);
    let observation = observed(&mut env);
    let targets = 10;
    let mut counts = vec![0; targets];
    for phase in values(&env, &observation, "phase", true) {
        counts[(phase * targets as f64).round() as usize] += 1;
    }
    // Fifty of each, give or take four standard deviations.
    assert!(counts.iter().all(|&count| (23..=77).contains(&count)), "{counts:?}");
    let left = values(&env, &observation, "time_left", true);
    assert!(left.iter().all(|&left| (0.09..=0.5).contains(&left)), "{left:?}");
    assert!((mean(&left) - 0.3).abs() < 0.03, "{}", mean(&left));
    assert!(values(&env, &observation, "phase", false).iter().all(|&phase| phase == 0.0));
    assert!(values(&env, &observation, "time_left", false).iter().all(|&left| left == 1.0));
    // As long as they say: the first of them end after a tenth of the limit, all after a half.
    let limit = env.spec().max_episode_steps;
    let mut ended = vec![false; ENVS];
    assert_eq!(
        (env.spec().steps_between_cuts(), EnvSpec { exploring: 0, ..env.spec().clone() }.steps_between_cuts()),
        (limit / 10, limit)
    );
    for step in rollout(&mut env, limit / 2) {
        let now = step.truncated.iter().zip(&step.terminated).map(|(a, b)| a | b);
        ended.iter_mut().zip(now).for_each(|(ended, now)| *ended |= now);
    }
    let (whole, exploring) = ended.split_at(ENVS - EXPLORING);
    assert!(!whole.contains(&true) && !exploring.contains(&false));
}

/// How many episodes of exploring environments ended, and how many of the next began with the target that was not done.
fn practised(task: &Task) -> (usize, usize) {
    let mut env = env(task, EXPLORING);
    let limit = env.spec().max_episode_steps;
    let steps = rollout(&mut env, limit);
    let spec = env.spec();
    let (targets, columns) = (task.flat().unwrap().steps.len() as f32, spec.episode_names.len());
    let (phase, done) = (entry(&env, "phase"), column(&env, "targets_done"));
    let (mut ended, mut again) = (0, 0);
    for step in steps {
        for k in (spec.whole_episodes()..ENVS).filter(|&k| step.truncated[k] || step.terminated[k]) {
            let begins_with = step.observation[k * spec.observation_size() + phase] * targets;
            ended += 1;
            again += usize::from(begins_with.round() == step.episode[k * columns + done]);
        }
    }
    (ended, again)
}

#[test]
fn what_failed_is_practised_again() {
    let mut task = fast("pointing-uitb");
    task.time_limit_s = 1.0;
    let (ended, again) = practised(&task);
    let share = again as f64 / ended as f64;
    // Three of four, and a tenth of the others by chance; five standard deviations.
    assert!(ended > 1000, "{ended}");
    assert!((share - 0.775).abs() < 5.0 * (0.775 * 0.225 / ended as f64).sqrt(), "{again} of {ended}");
}

#[test]
fn after_a_success_every_other_episode_is_whole_and_any_target_may_come() {
    // A sphere around everything.
    let sphere =
        "{kind: pointing, position: {x: 0, y: 0, z: 0}, radius: 1, dwell_s: 0.05, min_distance_from_previous: 0}";
    let text = format!("{{version: 1, name: everywhere, time_limit_s: 1, targets: [{sphere}, {sphere}]}}");
    let task = Task::from_yaml(&text, "everywhere").unwrap();
    let mut env = env(&task, EXPLORING);
    let steps = rollout(&mut env, 12);
    let (spec, phase, left) = (env.spec(), entry(&env, "phase"), entry(&env, "time_left"));
    let rows = steps.iter().flat_map(|step| {
        let rows = step.observation.chunks_exact(spec.observation_size()).enumerate();
        rows.filter(|&(k, _)| k >= spec.whole_episodes() && step.terminated[k]).map(|(_, row)| (row[phase], row[left]))
    });
    let (whole, middle): (Vec<_>, Vec<_>) = rows.partition(|&(_, left)| left == 1.0);
    let (whole_share, ended) = (whole.len() as f64 / (whole.len() + middle.len()) as f64, whole.len() + middle.len());
    assert!(ended > 1000 && (whole_share - 0.5).abs() < 0.06, "{whole_share} of {ended}");
    assert!(whole.iter().all(|&(phase, _)| phase == 0.0));
    let second = middle.iter().filter(|&&(phase, _)| phase == 0.5).count() as f64 / middle.len() as f64;
    assert!((second - 0.5).abs() < 0.08, "{second}");
}

#[test]
fn the_fingertip_begins_near_the_target_whatever_the_pose_of_the_task() {
    for pose in [Pose::RangeUniform, Pose::Zero] {
        let mut task = fast("pointing-uitb");
        task.reset.pose = pose;
        let mut env = env(&task, EXPLORING);
        let observation = observed(&mut env);
        let distance = |exploring| {
            let [x, y, z] =
                ["x", "y", "z"].map(|axis| values(&env, &observation, &format!("target_vector.{axis}"), exploring));
            let distances: Vec<f64> = (0..x.len()).map(|k| x[k].hypot(y[k]).hypot(z[k])).collect();
            mean(&distances)
        };
        // The nearest of eight in a volume is half as far as one.
        assert!(distance(true) < 0.45 * distance(false), "{pose:?}: {} {}", distance(true), distance(false));
        let elbow = values(&env, &observation, "joint_position.elbow_flexion", true);
        let middle = mean(&elbow);
        let spread = mean(&elbow.iter().map(|x| (x - middle).powi(2)).collect::<Vec<_>>()).sqrt();
        assert!(spread > 0.15, "{pose:?}: {spread}");
    }
}

#[test]
fn the_fingertip_begins_in_front_of_buttons_not_behind_them() {
    // Keys that face up.
    let task = fast("hello");
    let mut env = env(&task, EXPLORING);
    let observation = observed(&mut env);
    let behind = values(&env, &observation, "target_vector.z", true).iter().filter(|&&z| z > 0.0).count();
    // Nearest to the keys themselves it is every other.
    assert!(behind < EXPLORING / 4, "{behind} of {EXPLORING} begin below the keys");
}

#[test]
fn fingers_were_open_in_half_of_what_begins_in_the_middle() {
    let task = fast("pinch");
    let mut env = env(&task, EXPLORING);
    let observation = observed(&mut env);
    let open = |exploring: bool| values(&env, &observation, "fingers.thumb.ready", exploring);
    // Half of five hundred, give or take four standard deviations.
    assert!((mean(&open(true)) - 0.5).abs() < 0.09, "{}", mean(&open(true)));
    assert!(open(true).iter().all(|&open| open == 0.0 || open == 1.0));
    assert!(open(false).iter().all(|&open| open == 0.0));
}
