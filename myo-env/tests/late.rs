//! Senses that are late perceive what was there before, and nothing else changes.

use crate::common::{arm, gpu, short, without_gpu};
use myo_env::gpu::GpuOptions;
use myo_env::{Autoreset, CpuEnv, EnvConfig, GpuEnv, StepStorage, VectorEnv};
use myo_tasks::{Perception, Task};

const ENVS: usize = 9;
/// Control steps that parts are late, of tasks at 20 Hz.
const LATE: [(&str, usize); 4] = [("target_vector.", 3), ("inside", 3), ("joint_velocity.", 1), ("time_left", 0)];

fn tasks() -> [Task; 2] {
    // Episodes of half a second end often.
    let perception =
        Perception { vision_delay_ms: 150.0, body_delay_ms: 50.0, touch_delay_ms: 20.0, ..Perception::default() };
    let task = short("pointing-uitb");
    [Task { perception, ..task.clone() }, task]
}

fn config(autoreset: Autoreset) -> EnvConfig {
    EnvConfig { num_envs: ENVS, seed: 5, autoreset, ..EnvConfig::default() }
}

fn actions(env: &dyn VectorEnv, step: usize) -> Vec<f32> {
    (0..ENVS * env.spec().action_size()).map(|k| ((k * 31 + step * 77) % 200) as f32 / 100.0 - 1.0).collect()
}

/// Environments with late senses, and the same without, step for step.
fn compare(mut late: Box<dyn VectorEnv>, mut prompt: Box<dyn VectorEnv>, tolerance: f32, context: &str) {
    let spec = late.spec().clone();
    let (width, mut ended) = (spec.observation_size(), 0);
    let (mut a, mut b) = (StepStorage::new(&spec), StepStorage::new(&spec));
    late.reset(Some(1), None, &mut a.observation).unwrap();
    prompt.reset(Some(1), None, &mut b.observation).unwrap();
    // What there was to perceive since each episode began.
    let row = |observation: &[f32], env: usize| observation[env * width..][..width].to_vec();
    let mut seen: Vec<Vec<Vec<f32>>> = (0..ENVS).map(|env| vec![row(&b.observation, env)]).collect();
    for step in 0..35 {
        let actions = actions(late.as_ref(), step);
        late.step(&actions, a.buffers()).unwrap();
        prompt.step(&actions, b.buffers()).unwrap();
        assert_eq!((&a.terminated, &a.truncated), (&b.terminated, &b.truncated), "{context}, step {step}");
        for (env, seen) in seen.iter_mut().enumerate() {
            if b.terminated[env] || b.truncated[env] {
                ended += 1;
                // The last observation is late, too; the next episode begins with what is there.
                seen.push(row(&b.final_observation, env));
                check(&spec.observation_names, &row(&a.final_observation, env), seen, tolerance, context);
                seen.clear();
            }
            seen.push(row(&b.observation, env));
            check(&spec.observation_names, &row(&a.observation, env), seen, tolerance, context);
        }
        // Looking at a state changes nothing.
        let saved = late.save_state().unwrap();
        late.load_state(&saved).unwrap();
    }
    assert!(ended > 2 * ENVS, "{context}: {ended}");
}

fn check(names: &[String], late: &[f32], seen: &[Vec<f32>], tolerance: f32, context: &str) {
    for (entry, name) in names.iter().enumerate() {
        let Some((_, delay)) = LATE.iter().find(|(part, _)| name.starts_with(part)) else { continue };
        let then = seen[(seen.len() - 1).saturating_sub(*delay)][entry];
        assert!((late[entry] - then).abs() <= tolerance, "{context}, {name}: {} instead of {then}", late[entry]);
    }
}

#[test]
fn late_senses_perceive_what_was_there_before() {
    let cpu = |task: &Task| {
        Box::new(CpuEnv::new(&arm(task), task, &config(Autoreset::SameStep)).unwrap()) as Box<dyn VectorEnv>
    };
    let [late, prompt] = tasks();
    compare(cpu(&late), cpu(&prompt), 0.0, "processor");
}

#[test]
fn so_they_do_on_a_card() {
    if without_gpu() {
        return;
    }
    let gpu = gpu();
    let card = |task: &Task| {
        let (model, options) = (arm(task), GpuOptions { envs_per_shard: 4, ..GpuOptions::default() });
        Box::new(GpuEnv::with_options(&gpu, &model, task, &config(Autoreset::SameStep), &options).unwrap())
            as Box<dyn VectorEnv>
    };
    let [late, prompt] = tasks();
    compare(card(&late), card(&prompt), 1e-6, "card");
}

#[test]
fn what_is_late_is_of_the_structure_of_a_task() {
    let [late, prompt] = tasks();
    let mut env = CpuEnv::new(&arm(&late), &late, &config(Autoreset::SameStep)).unwrap();
    env.set_tasks(std::slice::from_ref(&late)).unwrap();
    let error = env.set_tasks(&[prompt]).unwrap_err().to_string();
    assert!(error.contains("perceived with another delay"), "{error}");
}
