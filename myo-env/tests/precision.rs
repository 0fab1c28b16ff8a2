//! How closely the graphics card follows the reference in double precision.

use crate::common::{
    actions, arm, assert_follows, assert_same_summary, chords, column, drifting, driven, dwell_for, entry, fast,
    fingers, following, gpu, limited, rollout, short, shuffled, sphere, steered, swung, without_gpu,
};
use myo_env::gpu::{GpuOptions, PhysicsBench};
use myo_env::{EnvConfig, GpuEnv, ReferenceEnv, Snapshot, StepStorage, Tables, VectorEnv};
use myo_scalar::symbolic::Form;
use myo_tasks::{Range, Region, Task};

fn both(task: &Task, config: EnvConfig) -> (GpuEnv, ReferenceEnv) {
    let model = arm(task);
    (GpuEnv::new(&gpu(), &model, task, &config).unwrap(), ReferenceEnv::new(&model, task, &config).unwrap())
}

/// Joint positions of every environment.
fn joint_positions(env: &dyn VectorEnv, reference: &ReferenceEnv) -> Vec<f64> {
    let saved = env.save_state().unwrap();
    let of = |env: usize| Snapshot::read(reference.tables(), &saved, env).unwrap().body.qpos;
    (0..env.spec().num_envs).flat_map(of).collect()
}

#[test]
fn joint_angles_agree_to_single_precision_after_a_second() {
    if without_gpu() {
        return;
    }
    for (name, model) in [("pointing-uitb", None), ("ar", None), ("pointing-uitb", Some("myo-arm"))] {
        let mut task = fast(name);
        task.time_limit_s = 2.0;
        task.model = model.map_or(task.model, Into::into);
        let (mut card, mut reference) = both(&task, EnvConfig { num_envs: 64, seed: 5, ..Default::default() });
        let second = (1.0 / task.control_dt_s).round() as usize;
        rollout(&mut card, second);
        rollout(&mut reference, second);
        let (got, want) = (joint_positions(&card, &reference), joint_positions(&reference, &reference));
        let square: f64 = got.iter().zip(&want).map(|(a, b)| (a - b) * (a - b)).sum();
        let rms = (square / got.len() as f64).sqrt();
        println!("{name}, {}: rms {rms:.2e} rad after a second", task.model);
        assert!(rms < 1e-5, "{name}, {}: {rms:.2e} rad", task.model);
    }
}

#[test]
fn episodes_have_the_same_targets_rewards_and_ends() {
    if without_gpu() {
        return;
    }
    let made = [following(), shuffled(), drifting(), steered(), swung(), driven(), limited(), fingers(), chords()];
    for task in ["pointing-uitb", "public-display", "slider", "wall-ray"].map(short).into_iter().chain(made) {
        let name = &task.name;
        let (mut card, mut reference) = both(&task, EnvConfig { num_envs: 20, exploring: 9, ..Default::default() });
        let runs = rollout(&mut card, 25).into_iter().zip(rollout(&mut reference, 25));
        for (step, (got, want)) in runs.enumerate() {
            assert_follows(&reference, &got, &want, &format!("{name} step {step}"));
        }
    }
}

/// Two hundred buttons stand side by side before the body, so that it touches some now and then.
fn crowded() -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: crowded\nscene:\n  wall: {kind: grid, at: [0.3, 0, -0.3], tilt_deg: 45, rows: 10, columns: 20, \
                pitch: 0.025, of: {kind: button, size: [0.02, 0.02, 0.01], min_force_n: 0.01}}\n  table: {kind: obstacle, at: [0.3, 0, -0.55], \
                size: [0.6, 0.6, 0.02]}\nscript:\n  - press: [10, 55, 130, 190, 64]\ntime_limit_s: 0.5\n";
    Task::from_yaml(text, "crowded").unwrap()
}

/// On a card the nearest boxes are listed; the reference goes through all.
#[test]
fn among_two_hundred_buttons_the_same_ones_are_touched() {
    if without_gpu() {
        return;
    }
    let task = crowded();
    let (mut card, mut reference) = both(&task, EnvConfig { num_envs: 20, ..Default::default() });
    let wrong = column(&reference, "wrong_presses");
    let mut presses = 0.0;
    let runs = rollout(&mut card, 140).into_iter().zip(rollout(&mut reference, 140));
    for (step, (got, want)) in runs.enumerate() {
        assert_follows(&reference, &got, &want, &format!("step {step}"));
        let size = reference.spec().episode_size();
        presses += (0..20).filter(|&env| want.truncated[env]).map(|env| want.episode[env * size + wrong]).sum::<f32>();
    }
    assert!(presses > 10.0, "{presses} buttons were pressed");
}

/// One large sphere in front of the body, so that chance does the task often.
fn easy() -> Task {
    let mut task = fast("pointing-single");
    let ball = sphere(&mut task, "ball");
    ball.at.0 = Region { x: Range::new(0.1, 0.4), y: Range::new(-0.2, 0.2), z: Range::new(-0.5, 0.0) };
    ball.radius = Range::new(0.2, 0.3);
    dwell_for(&mut task, 0.1);
    task
}

#[test]
fn ends_of_a_hundred_thousand_steps_agree_up_to_rounding_at_the_edge() {
    if without_gpu() {
        return;
    }
    let (num_envs, steps) = (500, 200);
    let (mut card, mut reference) = both(&easy(), EnvConfig { num_envs, ..Default::default() });
    let nobs = reference.spec().observation_size();
    let (vector, size) = (entry(&reference, "target_vector.x"), entry(&reference, "target_size"));
    let (mut got, mut want) = (StepStorage::new(card.spec()), StepStorage::new(card.spec()));
    let (mut ends, mut differences) = (0, 0);
    for step in 0..steps {
        // Both begin every step with the card's state, so that one difference is not counted again and again.
        reference.load_state(&card.save_state().unwrap()).unwrap();
        let actions = actions(&card, step);
        card.step(&actions, got.buffers()).unwrap();
        reference.step(&actions, want.buffers()).unwrap();
        assert_eq!(got.truncated.len(), num_envs);
        for env in 0..num_envs {
            ends += usize::from(want.terminated[env]);
            if (got.terminated[env], got.truncated[env]) == (want.terminated[env], want.truncated[env]) {
                let (x, y) = (got.reward[env], want.reward[env]);
                assert!((x - y).abs() <= 1e-4 * (1.0 + y.abs()), "step {step}, environment {env}: reward {x} for {y}");
                if want.terminated[env] || want.truncated[env] {
                    assert_same_summary(&reference, &got, &want, env, &format!("step {step}"));
                }
                continue;
            }
            differences += 1;
            let ended = if want.terminated[env] { &want } else { &got };
            let row = &ended.final_observation[env * nobs..(env + 1) * nobs];
            let distance = row[vector..vector + 3].iter().map(|x| x * x).sum::<f32>().sqrt();
            assert!(
                (distance - row[size]).abs() < 1e-5,
                "step {step}, environment {env}: {distance} m of {}",
                row[size]
            );
        }
    }
    println!("{ends} tasks done, {differences} differences in {} steps", num_envs * steps);
    assert!(ends > 500, "{ends} tasks were done, too few to compare");
    assert!(differences * 1000 <= num_envs * steps, "{differences} differences in {} steps", num_envs * steps);
}

/// Shards are independent of each other: more environments than one shard holds give the same episodes.
#[test]
fn the_batch_can_be_larger_than_one_buffer() {
    if without_gpu() {
        return;
    }
    let task = short("pointing-single");
    let (few, many) = (100, 300);
    let run = |num_envs: usize, per_shard: usize| {
        let config = EnvConfig { num_envs, ..Default::default() };
        let options = GpuOptions { envs_per_shard: per_shard, ..Default::default() };
        let mut env = GpuEnv::with_options(&gpu(), &arm(&task), &task, &config, &options).unwrap();
        assert_eq!(env.shards().len(), num_envs.div_ceil(per_shard));
        let nact = env.spec().action_size();
        let mut out = StepStorage::new(env.spec());
        (0..12)
            .map(|step| {
                let action = |k: usize| ((k % nact + step) % 5) as f32 / 2.5 - 0.8;
                let actions: Vec<f32> = (0..num_envs * nact).map(action).collect();
                env.step(&actions, out.buffers()).unwrap();
                let width = env.spec().observation_size();
                (out.observation[..few * width].to_vec(), out.reward[..few].to_vec(), out.truncated[..few].to_vec())
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(run(few, 1 << 20), run(many, 64));
}

/// A kernel that loops over its muscles is the same physics as one that writes each of them out.
#[test]
fn loops_over_tables_compute_what_straight_code_computes() {
    if without_gpu() {
        return;
    }
    let bent = Task { model: "myo-arm".into(), ..short("pointing-uitb") };
    for (task, form) in [(short("pointing-uitb"), Form::Straight), (bent, Form::Paths)] {
        let config = EnvConfig { num_envs: 30, seed: 2, ..Default::default() };
        let run = |form: Form| {
            let options = GpuOptions { form: Some(form), ..Default::default() };
            let mut env = GpuEnv::with_options(&gpu(), &arm(&task), &task, &config, &options).unwrap();
            assert_eq!(env.kernels().form(), form);
            rollout(&mut env, 12)
        };
        for (step, (a, b)) in run(form).iter().zip(&run(Form::Loops)).enumerate() {
            assert_eq!(a.truncated, b.truncated);
            for (x, y) in a.observation.iter().zip(&b.observation) {
                assert!((x - y).abs() <= 1e-3 * (1.0 + y.abs()), "{}, step {step}: {x} and {y}", task.model);
            }
        }
    }
}

/// The kernels run unchecked, so nothing that a caller may mix up may reach them.
#[test]
fn a_program_does_not_run_on_the_buffers_of_a_smaller_model_or_task() {
    if without_gpu() {
        return;
    }
    let small = GpuEnv::new(&gpu(), &arm(&easy()), &easy(), &EnvConfig::default()).unwrap();
    let large = fast("pointing-uitb");
    let tables = Tables::<f64>::new(&arm(&large), &large).unwrap();
    let refused = PhysicsBench::new(&small, &tables).err().expect("ten targets need more room than one").to_string();
    assert!(refused.starts_with("kernel physics cannot be bound: buffer numbers has "), "{refused}");
}

#[test]
fn a_model_that_no_driver_would_compile_is_refused_with_its_size() {
    if without_gpu() {
        return;
    }
    let task = short("pointing-uitb");
    let mut description = myo_model::builtin(&task.model).unwrap();
    let muscles = description.muscles.clone();
    for copy in 1..200 {
        description.muscles.extend(muscles.iter().cloned().map(|mut muscle| {
            muscle.name = format!("{}_{copy}", muscle.name);
            muscle
        }));
    }
    let model = myo_model::Model::new(&description).unwrap();
    let refused = GpuEnv::new(&gpu(), &model, &task, &EnvConfig::default()).err().expect("too large").to_string();
    assert!(refused.contains("operations in one kernel, more than the 40000"), "{refused}");
    assert!(refused.contains("take the cpu backend"), "{refused}");
}
