//! Control steps and resets of the whole environment: on lanes of one core, in double precision, and on a graphics card.

use std::cell::LazyCell;
use std::fmt::Debug;

use criterion::{Criterion, Throughput};
use myo_benches::{EnvScene, Numbers, SCENES, assert_finite, card, harness};
use myo_env::{CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, StepStorage, VectorEnv};
use myo_gpu::Gpu;
use myo_model::Model;
use myo_tasks::Task;

/// Steps handed to a graphics card at once; it is waited for after them.
const STEPS_AT_ONCE: usize = 16;

/// Steps with random actions, drawn once.
fn measure_steps<E: VectorEnv>(criterion: &mut Criterion, group: &str, scene: &EnvScene, make: impl FnOnce() -> E) {
    let mut made = LazyCell::new(|| {
        let env = make();
        let out = StepStorage::new(env.spec());
        let actions = Numbers::signed(1, scene.envs * env.spec().action_size());
        (env, out, actions)
    });
    let mut group = criterion.benchmark_group(format!("environment/{group}"));
    group.throughput(Throughput::Elements(scene.envs as u64));
    group.bench_function(&scene.name, |bencher| {
        let (env, out, actions) = &mut *made;
        bencher.iter(|| env.step(actions, out.buffers()).expect("random actions are actions"));
        let len = scene.envs * env.spec().observation_size();
        assert_finite("the observations", out.observation.iter().copied(), len);
        assert_finite("the rewards", out.reward.iter().copied(), scene.envs);
    });
    group.finish();
}

fn build<E, B: Debug>(scene: &EnvScene, new: impl FnOnce(&Model, &Task, &EnvConfig) -> Result<E, B>) -> E {
    let (task, model) = scene.task_and_model();
    let config = EnvConfig { num_envs: scene.envs, seed: 1, threads: Some(1), ..EnvConfig::default() };
    new(&model, &task, &config).expect("presets make environments")
}

fn steps(criterion: &mut Criterion) {
    for scene in &SCENES.environment.step {
        measure_steps(criterion, "step", scene, || build(scene, CpuEnv::new));
    }
    for scene in &SCENES.environment.reference {
        measure_steps(criterion, "reference", scene, || build(scene, ReferenceEnv::new));
    }
}

fn resets(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("environment/reset");
    for scene in &SCENES.environment.reset {
        let mut made = LazyCell::new(|| build(scene, CpuEnv::new));
        group.throughput(Throughput::Elements(scene.envs as u64));
        group.bench_function(&scene.name, |bencher| {
            let env = &mut *made;
            let mut observation = StepStorage::new(env.spec()).observation;
            bencher.iter(|| env.reset(None, None, &mut observation).expect("the buffer fits"));
            assert_finite("the observations", observation, scene.envs * env.spec().observation_size());
        });
    }
    group.finish();
}

/// Steps that stay on the card, and steps with actions from the host and observations back to it.
fn on_card(criterion: &mut Criterion) {
    let Some(gpu) = card() else { return };
    for scene in &SCENES.environment.card {
        let made = LazyCell::new(|| with_actions(gpu, scene));
        let mut group = criterion.benchmark_group("environment/card");
        group.throughput(Throughput::Elements((STEPS_AT_ONCE * scene.envs) as u64));
        group.bench_function(&scene.name, |bencher| {
            let env = &*made;
            bencher.iter(|| step_on_card(gpu, env, STEPS_AT_ONCE));
        });
        group.finish();
        let make = || build(scene, |model, task, config| GpuEnv::new(gpu, model, task, config));
        measure_steps(criterion, "card, through the host", scene, make);
    }
}

/// Environments on the card, with random actions for all steps to come.
fn with_actions(gpu: &Gpu, scene: &EnvScene) -> GpuEnv {
    let env = build(scene, |model, task, config| GpuEnv::new(gpu, model, task, config));
    for shard in env.shards() {
        let actions = Numbers::signed(1, env.spec().action_size() * shard.num_envs);
        gpu.write(&shard.actions, 0, &actions).expect("the card takes actions");
    }
    // Some drivers compile a kernel when it first runs.
    step_on_card(gpu, &env, 1);
    env
}

fn step_on_card(gpu: &Gpu, env: &GpuEnv, steps: usize) {
    let mut batch = gpu.batch();
    for _ in 0..steps {
        env.shards().iter().for_each(|shard| shard.step(&mut batch));
    }
    batch.submit().and_then(|()| gpu.wait()).expect("the card steps");
}

fn main() {
    harness(&[steps, resets, on_card]);
}
