//! Kernels for graphics cards: recording a task's code, printing it for drivers and for people; on a card, getting it ready.

use std::cell::LazyCell;

use criterion::Criterion;
use myo_benches::{KernelKind, KernelScene, SCENES, card, harness};
use myo_env::gpu::record::{self, PHYSICS_BUFFERS, RESET_BUFFERS, STEP_BUFFERS};
use myo_env::{Autoreset, EnvConfig, GpuEnv, Tables, VectorEnv};
use myo_scalar::symbolic::Program;

/// Threads of a workgroup in the text; it changes nothing else.
const WORKGROUP: u32 = 32;

fn record(scene: &KernelScene, tables: &Tables<f64>) -> Program {
    match scene.kernel {
        KernelKind::Step => record::step(tables, Autoreset::default(), scene.form()),
        KernelKind::Physics => record::physics(tables, scene.form()),
        KernelKind::Reset => record::reset_program(tables, scene.form()),
    }
}

fn buffers(kernel: KernelKind) -> &'static [&'static str] {
    match kernel {
        KernelKind::Step => &STEP_BUFFERS,
        KernelKind::Physics => &PHYSICS_BUFFERS,
        KernelKind::Reset => &RESET_BUFFERS,
    }
}

fn kernels(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("kernels");
    for scene in &SCENES.kernels.record {
        let names = buffers(scene.kernel);
        let tables = LazyCell::new(|| {
            let (task, model) = scene.task_and_model();
            Tables::<f64>::new(&model, &task).expect("presets compile")
        });
        let program = LazyCell::new(|| record(scene, &tables));
        group.bench_function(format!("record/{}", scene.name), |bencher| {
            let tables = &*tables;
            bencher.iter(|| record(scene, tables));
            assert!(program.operations() > 100, "it has {} operations", program.operations());
        });
        group.bench_function(format!("print for drivers/{}", scene.name), |bencher| {
            let program = &*program;
            bencher.iter(|| program.to_kernel(names, WORKGROUP));
        });
        group.bench_function(format!("check and print as WGSL/{}", scene.name), |bencher| {
            let kernel = program.to_kernel(names, WORKGROUP);
            let mut text = String::new();
            bencher.iter(|| text = kernel.to_wgsl().expect("the kernel is valid"));
            assert!(text.contains("@compute"));
        });
    }
    group.finish();
}

/// From task and body to environments that can be stepped; the card is open, and compiled kernels may be on disk.
fn ready(criterion: &mut Criterion) {
    let Some(gpu) = card() else { return };
    let mut group = criterion.benchmark_group("kernels/ready on a card");
    for scene in &SCENES.kernels.card {
        let make = || {
            let (task, model) = scene.task_and_model();
            let config = EnvConfig { num_envs: scene.envs, seed: 1, ..EnvConfig::default() };
            let env = GpuEnv::new(gpu, &model, &task, &config).expect("presets make environments");
            gpu.wait().expect("the card answers");
            env
        };
        group.bench_function(&scene.name, |bencher| {
            bencher.iter_with_large_drop(make);
            assert_eq!(make().spec().num_envs, scene.envs);
        });
    }
    group.finish();
}

fn main() {
    harness(&[kernels, ready]);
}
