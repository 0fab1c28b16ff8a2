//! Numbers of a task are data: they change without anything being compiled, and what runs afterwards is the other task.

mod common;

use common::{arm, entry, gpu, rollout, short, without_gpu};
use myo_env::gpu::record;
use myo_env::{Autoreset, CpuEnv, EnvConfig, EnvError, GpuEnv, ReferenceEnv, Tables, VectorEnv};
use myo_scalar::symbolic::Form;
use myo_tasks::{Range, Target, Task};

/// A short task with motor noise.
fn noisy(name: &str) -> Task {
    let mut task = short(name);
    task.noise.constant = 0.05;
    task
}

/// A task with everything that may differ within a structure.
fn other(task: &Task) -> Task {
    let mut other = task.clone();
    for target in &mut other.targets {
        match target {
            Target::Pointing(sphere) => {
                sphere.position.y = Range::new(sphere.position.y.min + 0.03, sphere.position.y.max + 0.05);
                sphere.radius = Range::new(0.5 * sphere.radius.min, 0.7 * sphere.radius.max);
                sphere.dwell_s = 0.1;
            }
            Target::Pressing(button) => {
                button.position[2] += 0.03;
                button.tilt_deg += 10.0;
                button.size[0] *= 0.7;
                button.min_force_n *= 1.5;
            }
        }
    }
    other.time_limit_s = 0.4;
    other.noise.constant = 0.1;
    other.reset.activation_max = 0.3;
    other.reward.distance *= 2.0;
    other.reward.subtask_bonus += 1.0;
    other.reward.time_cost = 0.4;
    other
}

fn config(num_envs: usize) -> EnvConfig {
    EnvConfig { num_envs, seed: 5, exploring: num_envs / 2, autoreset: Autoreset::SameStep, ..EnvConfig::default() }
}

/// Environments that did another task before do this one as those that were made for it, bit for bit.
fn check_that_nothing_is_left(exchanged: &mut dyn VectorEnv, made: &mut dyn VectorEnv, task: &Task) {
    rollout(exchanged, 3);
    exchanged.set_task(task).unwrap();
    assert_eq!(exchanged.spec(), made.spec());
    let mut first = [(); 2].map(|()| vec![0.0; made.spec().num_envs * made.spec().observation_size()]);
    exchanged.reset(Some(8), None, &mut first[0]).unwrap();
    made.reset(Some(8), None, &mut first[1]).unwrap();
    assert!(first[0] == first[1], "first observations");
    for (step, (a, b)) in rollout(exchanged, 14).iter().zip(&rollout(made, 14)).enumerate() {
        assert!(a.observation == b.observation && a.reward == b.reward, "step {step}");
        assert!(a.terminated == b.terminated && a.truncated == b.truncated, "step {step}");
    }
    assert!(exchanged.save_state().unwrap() == made.save_state().unwrap(), "states");
}

#[test]
fn a_task_in_the_place_of_another_is_as_if_it_had_been_there_from_the_start() {
    for name in ["pointing", "ar", "public-display"] {
        let (before, task) = (noisy(name), other(&noisy(name)));
        let model = arm(&task);
        let reference = |task| ReferenceEnv::new(&model, task, &config(6)).unwrap();
        check_that_nothing_is_left(&mut reference(&before), &mut reference(&task), &task);
        let lanes = |task| CpuEnv::new(&model, task, &config(21)).unwrap();
        check_that_nothing_is_left(&mut lanes(&before), &mut lanes(&task), &task);
    }
}

#[test]
fn on_a_card_a_task_takes_the_place_of_another() {
    if without_gpu() {
        return;
    }
    let (gpu, before, task) = (gpu(), noisy("ar"), other(&noisy("ar")));
    let model = arm(&task);
    let env = |task| GpuEnv::new(&gpu, &model, task, &config(21)).unwrap();
    check_that_nothing_is_left(&mut env(&before), &mut env(&task), &task);
}

#[test]
fn kernels_know_the_structure_of_a_task_and_none_of_its_numbers() {
    for name in ["pointing", "ar", "public-display", "mobile-typing"] {
        let (before, task) = (noisy(name), other(&noisy(name)));
        let texts = [&before, &task].map(|task| {
            let tables = Tables::<f64>::new(&arm(task), task).unwrap();
            let step = record::step(&tables, Autoreset::SameStep, Form::Straight);
            let reset = record::reset_program(&tables, Form::Straight);
            [step.to_kernel(&record::STEP_BUFFERS, 64), reset.to_kernel(&record::RESET_BUFFERS, 64)]
                .map(|kernel| kernel.to_wgsl().unwrap())
        });
        assert!(texts[0] == texts[1], "{name}");
    }
}

#[test]
fn where_buttons_are_counts_at_once() {
    let (before, task) = (noisy("public-display"), other(&noisy("public-display")));
    let model = arm(&task);
    let mut env = CpuEnv::new(&model, &before, &config(5)).unwrap();
    rollout(&mut env, 2);
    let height = entry(&env, "target_position.z");
    let width = env.spec().observation_size();
    let mut seen = vec![0.0; 5 * width];
    env.set_task(&task).unwrap();
    env.reset(None, Some(&[false; 5]), &mut seen).unwrap();
    let centres: Vec<f32> = task
        .targets
        .iter()
        .map(|target| match target {
            Target::Pressing(button) => button.position[2] as f32,
            Target::Pointing(_) => f32::NAN,
        })
        .collect();
    for row in seen.chunks(width) {
        assert!(centres.contains(&row[height]), "{} of {centres:?}", row[height]);
    }
}

#[test]
fn a_task_of_another_structure_is_refused_and_changes_nothing() {
    let task = noisy("ar");
    let model = arm(&task);
    let mut env = CpuEnv::new(&model, &task, &config(3)).unwrap();
    let before = env.save_state().unwrap();
    let mut refuse = |task: &Task, expected: &str| {
        let error = env.set_task(task).unwrap_err();
        assert!(matches!(error, EnvError::OtherTask { .. }), "{error}");
        let sentence = error.to_string();
        assert!(sentence.ends_with(expected), "{sentence}");
        assert!(env.save_state().unwrap() == before);
    };
    let with = |change: fn(&mut Task)| {
        let mut other = task.clone();
        change(&mut other);
        other
    };
    refuse(&noisy("pointing"), "it has 10 steps instead of 8");
    refuse(&with(|task| task.targets.swap(0, 1)), "its spheres and boxes stand in another order");
    refuse(&with(|task| task.observation.touch = false), "it is observed in another way");
    refuse(&with(|task| task.control_dt_s = 0.1), "its control step is 0.1 s instead of 0.05 s");
    let inside = "it measures the distance in another way (reward.inside_is_zero, reward.remaining_path)";
    refuse(&with(|task| task.reward.inside_is_zero = !task.reward.inside_is_zero), inside);
    let error = env.set_task(&with(|task| task.time_limit_s = -1.0)).unwrap_err().to_string();
    assert!(error.contains("time_limit_s"), "{error}");
}

#[test]
fn noise_of_no_size_takes_the_place_of_noise_but_not_the_other_way_round() {
    let loud = noisy("pointing-single");
    let mut quiet = loud.clone();
    (quiet.noise.signal_dependent, quiet.noise.constant) = (0.0, 0.0);
    let model = arm(&loud);
    let mut env = CpuEnv::new(&model, &loud, &config(4)).unwrap();
    env.set_task(&quiet).unwrap();
    let mut made = CpuEnv::new(&model, &quiet, &config(4)).unwrap();
    let error = made.set_task(&loud).unwrap_err().to_string();
    assert!(error.ends_with("it has motor noise where there was none"), "{error}");
    let mut first = vec![0.0; 4 * env.spec().observation_size()];
    env.reset(Some(1), None, &mut first).unwrap();
    made.reset(Some(1), None, &mut first).unwrap();
    for (a, b) in rollout(&mut env, 5).iter().zip(&rollout(&mut made, 5)) {
        assert!(a.observation == b.observation && a.reward == b.reward);
    }
}
