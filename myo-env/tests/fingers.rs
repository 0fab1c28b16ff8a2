//! Fingers beside the one that points: what is observed of them, and that they do what scripts ask for.

use crate::common::*;
use myo_env::{CpuEnv, EnvConfig, VectorEnv};
use myo_model::{Model, builtin};
use myo_tasks::Task;

const ENVS: usize = 64;

fn env(task: &Task) -> CpuEnv {
    CpuEnv::new(&arm(task), task, &EnvConfig { num_envs: ENVS, seed: 3, ..EnvConfig::default() }).unwrap()
}

/// How many episodes came to each step, of 64 hands that are thrown about.
fn came_to(task: &Task) -> Vec<usize> {
    let mut env = env(task);
    let (size, done) = (env.spec().episode_size(), column(&env, "targets_done"));
    let mut counts = vec![0; task.flat().unwrap().steps.len() + 1];
    for out in rollout(&mut env, 200) {
        for number in (0..ENVS).filter(|&number| out.terminated[number] || out.truncated[number]) {
            counts[out.episode[number * size + done] as usize] += 1;
        }
    }
    counts
}

#[test]
fn steps_of_the_tasks_that_backends_are_compared_in_are_done_by_somebody() {
    // An arm that is thrown about seldom presses with one finger after a chord.
    for (task, steps) in [(fingers(), 4), (chords(), 2)] {
        let counts = came_to(&task);
        assert!(counts[..=steps].iter().all(|&count| count > 0), "{}: {counts:?}", task.name);
    }
}

#[test]
fn where_fingers_must_go_is_observed() {
    let task = fingers();
    let mut env = env(&task);
    let nobs = env.spec().observation_size();
    let mut observation = vec![0.0; ENVS * nobs];
    env.reset(Some(1), None, &mut observation).unwrap();
    let entries = |name: &str| ["x", "y", "z"].map(|axis| entry(&env, &format!("{name}.{axis}")));
    let (thumb, middle, target) = (entries("fingers.thumb"), entries("fingers.middle"), entries("target_vector"));
    let of = |finger: &str, what: &str| entry(&env, &format!("fingers.{finger}.{what}"));
    for row in observation.chunks(nobs) {
        // The thumb leads, so that the way to the target is its own.
        assert_eq!(thumb.map(|k| row[k]), target.map(|k| row[k]));
        assert_eq!(["thumb", "middle"].map(|finger| row[of(finger, "asked")]), [1.0, 1.0]);
        assert_eq!((row[of("thumb", "size")], row[of("thumb", "ready")]), (0.5, 0.0));
        let near = row[of("middle", "size")];
        assert!((0.4..=0.5).contains(&near), "{near}");
        // Both from where the fingers are, one before the wrist and one behind.
        let apart = |k: usize| row[thumb[k]] - row[middle[k]];
        let distance = (0..3).map(|k| apart(k) * apart(k)).sum::<f32>().sqrt();
        assert!(distance < 0.35, "{distance}");
    }
}

#[test]
fn a_body_without_the_finger_is_refused_with_those_that_it_has() {
    let on = |model: &str| {
        let model = Model::new(&builtin(model).unwrap()).unwrap();
        CpuEnv::new(&model, &fingers(), &EnvConfig::default()).err().map(|error| error.to_string())
    };
    assert_eq!(on("myo-hand"), None);
    let refused = on("mobl-arms").unwrap();
    assert!(refused.starts_with("the model has no finger `middle`; "), "{refused}");
    assert!(refused.ends_with("fingers are named in its landmarks (`fingers: {middle: SITE}`)"), "{refused}");
    // What presses must have something to press with.
    let mut description = builtin("myo-arm").unwrap();
    let tips = [("middle", "PL-P3"), ("thumb", "ECRL-P3")];
    description.landmarks.fingers = tips.map(|(name, tip)| (name.to_owned(), tip.to_owned())).into();
    let model = Model::new(&description).unwrap();
    let refused = CpuEnv::new(&model, &chords(), &EnvConfig::default()).err().unwrap().to_string();
    assert!(refused.starts_with("the finger `thumb` has no ball at its tip that presses"), "{refused}");
}
