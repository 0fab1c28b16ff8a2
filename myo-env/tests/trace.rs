//! Every physics step of a control step, as those see it who measure movements.

use crate::common::{arm, fast, short};
use myo_env::{CpuEnv, EnvConfig, StepStorage, TraceSample, VectorEnv};
use myo_tasks::Task;

const ENVS: usize = 19;

fn env(task: &Task) -> CpuEnv {
    CpuEnv::new(&arm(task), task, &EnvConfig { num_envs: ENVS, seed: 4, ..EnvConfig::default() }).unwrap()
}

/// Other actions at every step, for every environment.
fn actions(env: &CpuEnv, step: usize) -> Vec<f32> {
    let entries = ENVS * env.spec().action_size();
    (0..entries).map(|k| ((k * 37 + step * 101) % 200) as f32 / 100.0 - 1.0).collect()
}

#[test]
fn steps_are_the_same_whether_somebody_looks_or_not() {
    let task = short("pointing-uitb");
    let [mut seen, mut unseen] = [env(&task), env(&task)];
    let (mut a, mut b) = (StepStorage::new(seen.spec()), StepStorage::new(unseen.spec()));
    let mut trace = vec![0.0; ENVS * seen.trace_shape().len_per_env()];
    for step in 0..15 {
        let actions = actions(&seen, step);
        seen.step_traced(&actions, a.buffers(), &mut trace).unwrap();
        unseen.step(&actions, b.buffers()).unwrap();
        assert_eq!((&a.observation, &a.reward), (&b.observation, &b.reward), "step {step}");
        // What was not done has no time: numbers that are none are equal as bits alone.
        let bits = |out: &StepStorage| out.episode.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&a), bits(&b), "step {step}");
    }
    assert_eq!(seen.save_state().unwrap(), unseen.save_state().unwrap());
}

#[test]
fn a_trace_goes_on_where_the_last_one_ended() {
    let task = fast("pointing-uitb");
    let mut env = env(&task);
    let (shape, spec) = (env.trace_shape(), env.spec().clone());
    assert_eq!(
        (shape.samples, shape.columns, shape.rate_hz.round() as u32),
        (25, 4 + 2 * (shape.joints + spec.action_size()), 500)
    );
    let column = |name: &str| spec.observation_names.iter().position(|other| other.starts_with(name)).unwrap();
    let (fingertip, activation) = (column("fingertip_position."), column("activation."));
    let mut out = StepStorage::new(&spec);
    env.reset(Some(2), None, &mut out.observation).unwrap();
    let mut trace = vec![0.0; ENVS * shape.len_per_env()];
    let (mut before, mut moved) = (out.observation.clone(), 0);
    for step in 0..6 {
        let actions = actions(&env, step);
        env.step_traced(&actions, out.buffers(), &mut trace).unwrap();
        for number in 0..ENVS {
            let rows = trace[number * shape.len_per_env()..][..shape.len_per_env()].chunks_exact(shape.columns);
            let rows: Vec<TraceSample<'_>> = rows.map(|row| shape.sample(row).unwrap()).collect();
            let row = number * spec.observation_size();
            let was = before[row + fingertip..][..3].iter().map(|&x| f64::from(x)).collect::<Vec<_>>();
            assert!(rows[0].fingertip.iter().zip(&was).all(|(a, b)| (a - b).abs() < 1e-6), "{:?} {was:?}", rows[0]);
            let is = &out.observation[row + activation..][..spec.action_size()];
            let last = rows[24].activations;
            let body = &env.peek(number..number + 1).unwrap()[0].body;
            assert!(body.qpos.len() == shape.joints);
            assert!(body.qpos.iter().zip(rows[24].qpos).all(|(q, &seen)| (q - f64::from(seen)).abs() < 1e-6));
            assert!(is.iter().zip(last).all(|(seen, act)| (seen - (2.0 * act - 1.0)).abs() < 1e-6));
            assert!(rows.iter().all(|row| row.force == 0.0), "there is nothing to touch");
            // 2 ms at 50 m/s are 10 cm: nothing jumps.
            let step_m = |pair: &[TraceSample<'_>]| {
                pair[0].fingertip.iter().zip(pair[1].fingertip).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
            };
            assert!(rows.windows(2).all(|pair| step_m(pair) < 0.1));
            moved += usize::from(step_m(&[rows[0], rows[24]]) > 1e-3);
        }
        before.clone_from(&out.observation);
    }
    assert!(moved > 3 * ENVS, "{moved}");
}

#[test]
fn the_force_of_a_trace_is_what_the_fingertip_feels_on_faces_and_on_sides() {
    let scene = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: wall\nscene: {wall: {kind: button, at: [0.3, 0, -0.2], size: [2, 2, 0.1], min_force_n: 1000}}\n\
                 script: [{press: wall}]\n";
    let task = Task::from_yaml(scene, "wall").unwrap();
    let mut env = env(&task);
    let shape = env.trace_shape();
    let (mut out, mut trace) = (StepStorage::new(env.spec()), vec![0.0; ENVS * shape.len_per_env()]);
    let mut touched = 0;
    for step in 0..40 {
        let actions = actions(&env, step / 10);
        env.step_traced(&actions, out.buffers(), &mut trace).unwrap();
        for (number, seen) in env.peek(0..ENVS).unwrap().iter().enumerate() {
            let rows = trace[number * shape.len_per_env()..][..shape.len_per_env()].chunks_exact(shape.columns);
            let most = rows.map(|row| shape.sample(row).unwrap().force).fold(0.0, f64::max);
            let is_all = (most - seen.touch).abs() <= 1e-5 * most;
            assert!(is_all, "step {step}, environment {number}: {most} {}", seen.touch);
            touched += usize::from(most > 0.0);
        }
    }
    assert!(touched > 40, "{touched}");
}

#[test]
fn memory_of_another_size_is_refused() {
    let mut env = env(&fast("pointing-uitb"));
    let (mut out, actions) = (StepStorage::new(env.spec()), actions(&env, 0));
    let error = env.step_traced(&actions, out.buffers(), &mut [0.0; 3]).unwrap_err().to_string();
    assert!(error.contains("trace has 3 entries, expected"), "{error}");
}
