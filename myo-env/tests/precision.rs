//! How closely the graphics card follows the reference in double precision.

mod common;

use common::{actions, arm, entry, gpu, rollout, short, without_gpu};
use myo_env::gpu::GpuOptions;
use myo_env::{EnvConfig, GpuEnv, ReferenceEnv, StepStorage, VectorEnv};
use myo_scalar::symbolic::Form;
use myo_tasks::{Range, Region, Target, Task, preset};

fn both(task: &Task, config: EnvConfig) -> (GpuEnv, ReferenceEnv) {
    let model = arm(task);
    (GpuEnv::new(&gpu(), &model, task, &config).unwrap(), ReferenceEnv::new(&model, task, &config).unwrap())
}

/// Bytes of a saved state before the first environment: environments, numbers per environment, bytes per number.
const HEADER: usize = 24;
/// Bytes of the integers per environment.
const WORDS: usize = 20;

/// The first `count` numbers of every environment in a saved state.
fn numbers(saved: &[u8], count: usize) -> Vec<f64> {
    let stride = 8 * u64::from_le_bytes(saved[8..16].try_into().unwrap()) as usize + WORDS;
    let of = |env: &[u8]| -> Vec<f64> {
        env[..8 * count].chunks_exact(8).map(|x| f64::from_le_bytes(x.try_into().unwrap())).collect()
    };
    saved[HEADER..].chunks_exact(stride).flat_map(of).collect()
}

/// A state of the card as the reference saves it: numbers are saved in double precision by both.
fn as_reference(mut saved: Vec<u8>) -> Vec<u8> {
    saved[16..24].copy_from_slice(&8u64.to_le_bytes());
    saved
}

#[test]
fn joint_angles_agree_to_single_precision_after_a_second() {
    if without_gpu() {
        return;
    }
    for name in ["pointing", "ar"] {
        let mut task = preset(name).unwrap();
        task.time_limit_s = 2.0;
        let (mut card, mut reference) = both(&task, EnvConfig { num_envs: 64, seed: 5, ..Default::default() });
        let second = (1.0 / task.control_dt_s).round() as usize;
        rollout(&mut card, second);
        rollout(&mut reference, second);
        let ndof = reference.tables().plan.ndof();
        let [got, want] = [card.save_state(), reference.save_state()].map(|saved| numbers(&saved.unwrap(), ndof));
        let square: f64 = got.iter().zip(&want).map(|(a, b)| (a - b) * (a - b)).sum();
        let rms = (square / got.len() as f64).sqrt();
        println!("{name}: rms {rms:.2e} rad after a second");
        assert!(rms < 1e-5, "{name}: {rms:.2e} rad");
    }
}

#[test]
fn episodes_have_the_same_targets_and_ends() {
    if without_gpu() {
        return;
    }
    for name in ["pointing", "public-display"] {
        let task = short(name);
        let (mut card, mut reference) = both(&task, EnvConfig { num_envs: 20, ..Default::default() });
        let nobs = reference.spec().observation_size();
        let first = entry(&reference, "target_position.x");
        let runs = rollout(&mut card, 25).into_iter().zip(rollout(&mut reference, 25));
        for (step, (got, want)) in runs.enumerate() {
            assert_eq!(got.truncated, want.truncated, "{name} step {step}");
            assert_eq!(got.terminated, want.terminated, "{name} step {step}");
            let rows = got.observation.chunks_exact(nobs).zip(want.observation.chunks_exact(nobs));
            for (k, (a, b)) in rows.flat_map(|(a, b)| a[first..first + 3].iter().zip(&b[first..first + 3])).enumerate()
            {
                assert!((a - b).abs() <= 1e-6, "{name} step {step} target coordinate {k}: {a} for {b}");
            }
        }
    }
}

/// One large sphere in front of the body, so that chance does the task often.
fn easy() -> Task {
    let mut task = preset("pointing-single").unwrap();
    let Target::Pointing(sphere) = &mut task.targets[0] else { panic!("pointing-single has a sphere") };
    sphere.position =
        Region { x: Range { min: 0.1, max: 0.4 }, y: Range { min: -0.2, max: 0.2 }, z: Range { min: -0.5, max: 0.0 } };
    sphere.radius = Range { min: 0.2, max: 0.3 };
    sphere.dwell_s = 0.1;
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
        reference.load_state(&as_reference(card.save_state().unwrap())).unwrap();
        let actions = actions(&card, step);
        card.step(&actions, got.buffers()).unwrap();
        reference.step(&actions, want.buffers()).unwrap();
        assert_eq!(got.truncated.len(), num_envs);
        for env in 0..num_envs {
            ends += usize::from(want.terminated[env]);
            if (got.terminated[env], got.truncated[env]) == (want.terminated[env], want.truncated[env]) {
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
    let task = short("pointing");
    let config = EnvConfig { num_envs: 30, seed: 2, ..Default::default() };
    let run = |form: Form| {
        let options = GpuOptions { form: Some(form), ..Default::default() };
        let mut env = GpuEnv::with_options(&gpu(), &arm(&task), &task, &config, &options).unwrap();
        assert_eq!(env.kernels().form(), form);
        rollout(&mut env, 12)
    };
    for (step, (a, b)) in run(Form::Straight).iter().zip(&run(Form::Loops)).enumerate() {
        assert_eq!(a.truncated, b.truncated);
        for (x, y) in a.observation.iter().zip(&b.observation) {
            assert!((x - y).abs() <= 1e-3 * (1.0 + y.abs()), "step {step}: {x} and {y}");
        }
    }
}

#[test]
fn a_model_that_no_driver_would_compile_is_refused_with_its_size() {
    if without_gpu() {
        return;
    }
    let task = short("pointing");
    let mut description = myo_model::builtin(&task.model).unwrap();
    let muscles = description.muscles.clone();
    for copy in 1..60 {
        description.muscles.extend(muscles.iter().cloned().map(|mut muscle| {
            muscle.name = format!("{}_{copy}", muscle.name);
            muscle
        }));
    }
    let model = myo_model::Model::new(&description).unwrap();
    let refused = GpuEnv::new(&gpu(), &model, &task, &EnvConfig::default()).err().expect("too large").to_string();
    assert!(refused.contains("operations in one kernel, more than the 20000"), "{refused}");
    assert!(refused.contains("take the cpu backend"), "{refused}");
}
