//! The learner on one core: passes of its networks, advantages, whole updates. And updates on a graphics card.

use std::cell::LazyCell;
use std::time::Duration;

use criterion::{Criterion, Throughput};
use myo_benches::{Idle, Numbers, SCENES, assert_finite, card, harness, one_core};
use myo_env::GpuEnv;
use myo_train::{Mlp, TrainError, Trainer, UpdateMetrics, advantages};

/// Rows that the learner passes through a network at once.
const ROWS: usize = 128;

/// Forward alone, and forward with backward, of both networks.
fn networks(criterion: &mut Criterion) {
    for scene in &SCENES.learner.networks {
        let nets = [
            ("policy", Mlp::new(Idle::OBSERVATIONS, &scene.policy, Idle::ACTIONS)),
            ("value", Mlp::new(Idle::OBSERVATIONS, &scene.value, 1)),
        ];
        for (role, net) in &nets {
            passes(criterion, &format!("{}, {role}", scene.name), net, scene.samples);
        }
    }
}

fn passes(criterion: &mut Criterion, name: &str, net: &Mlp, samples: usize) {
    let x = Numbers::signed(1, samples * net.inputs());
    let mut parameters = vec![0.0; net.len()];
    net.initialize(1, 0, 1.0, &mut parameters);
    let (mut work, mut gradient) = (net.work(ROWS), vec![0.0; net.len()]);

    let mut group = criterion.benchmark_group("learner");
    group.throughput(Throughput::Elements(samples as u64));
    group.bench_function(format!("forward/{name}"), |bencher| {
        let mut outputs = vec![0.0; samples * net.outputs()];
        bencher.iter(|| {
            let chunks = x.chunks(ROWS * net.inputs()).zip(outputs.chunks_mut(ROWS * net.outputs()));
            chunks.for_each(|(x, out)| out.copy_from_slice(net.forward(&parameters, x, &mut work)));
        });
        assert!(outputs.iter().any(|&y| y != 0.0));
        assert_finite("the outputs", outputs, samples * net.outputs());
    });
    group.bench_function(format!("forward and backward/{name}"), |bencher| {
        bencher.iter(|| {
            for (i, x) in x.chunks(ROWS * net.inputs()).enumerate() {
                // The outputs serve as their own derivatives: those of half the sum of their squares.
                net.forward_for_gradient(&parameters, x, &mut work);
                net.backward(&parameters, x, &mut work, &mut gradient, i > 0);
            }
        });
        assert!(gradient.iter().any(|&g| g != 0.0));
        assert_finite("the gradient", gradient.iter().copied(), net.len());
    });
    group.finish();
}

fn estimates(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("learner/advantages");
    for scene in &SCENES.learner.advantages {
        let len = scene.envs * scene.steps;
        let [reward, value, next_value] = [1, 2, 3].map(|seed| Numbers::signed(seed, len));
        let mut numbers = Numbers(4);
        let ended: Vec<bool> = (0..len).map(|_| numbers.unit() < 0.02).collect();
        group.throughput(Throughput::Elements(len as u64));
        group.bench_function(&scene.name, |bencher| {
            let mut out = vec![0.0; len];
            bencher.iter(|| advantages(scene.envs, (0.98, 0.95), &reward, &value, &next_value, &ended, &mut out));
            assert!(out.iter().any(|&a| a != 0.0));
            assert_finite("the advantages", out, len);
        });
    }
    group.finish();
}

/// Seconds of a part of an update, which its metrics tell.
type Seconds = fn(&UpdateMetrics) -> f64;

const PARTS: [(&str, Seconds); 2] = [("acting", |metrics| metrics.collect_s), ("learning", |metrics| metrics.learn_s)];

/// Acting and learning of whole updates, with an environment that costs nothing.
fn updates(criterion: &mut Criterion) {
    for scene in &SCENES.learner.updates {
        measure_updates(criterion, "update", &scene.name, || {
            Trainer::new(Box::new(Idle::new(&scene.settings)), scene.settings.clone(), 1)
        });
    }
}

/// The same on a card, with an environment of a task.
fn updates_on_card(criterion: &mut Criterion) {
    let Some(gpu) = card() else { return };
    for scene in &SCENES.learner.card {
        measure_updates(criterion, "update on a card", &scene.name, || {
            let (task, model) = scene.task_and_model();
            let env = GpuEnv::new(gpu, &model, &task, &scene.settings.envs(1)).expect("presets make environments");
            Trainer::on_card(env, scene.settings.clone(), 1)
        });
    }
}

fn measure_updates(
    criterion: &mut Criterion,
    kind: &str,
    name: &str,
    make: impl FnOnce() -> Result<Trainer, TrainError>,
) {
    let mut trainer = LazyCell::new(|| make().expect("the settings fit"));
    let mut group = criterion.benchmark_group(format!("learner/{kind}"));
    for (part, seconds) in PARTS {
        group.bench_function(format!("{part}/{name}"), |bencher| {
            let trainer = &mut *trainer;
            let mut update = || one_core().install(|| trainer.update()).expect("an update on finite numbers");
            bencher.iter_custom(|updates| Duration::from_secs_f64((0..updates).map(|_| seconds(&update())).sum()));
            let learn = update().learn;
            let numbers = [learn.policy_loss, learn.value_loss, learn.kl, learn.gradient_norm];
            assert_finite("the losses", numbers.map(|x| x as f32), 4);
        });
    }
    group.finish();
}

fn main() {
    harness(&[networks, estimates, updates, updates_on_card]);
}
