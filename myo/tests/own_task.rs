//! The example of a task of one's own: three evaluators agree on it, and users learn it on processor and graphics card.

#[path = "../../myo-env/tests/common/mod.rs"]
mod common;
#[allow(dead_code)]
#[path = "../examples/own_task.rs"]
mod own_task;

use common::{arm, assert_follows, gpu, rollout, without_gpu};
use myo::env::{CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, VectorEnv};
use myo::tasks::Task;
use myo::train::PpoConfig;
use myo::train::session::{Goal, Until};
use myo::{Device, Envs, Start};
use own_task::{Swing, task};

/// Little enough to turn and to tire now and then without any skill.
const RULES: Swing = Swing { reach: 0.02, turns: 2.0 };

#[test]
fn lanes_and_card_do_what_the_reference_does() {
    let task = Task { model: "mobl-arms".into(), ..task() };
    let config = EnvConfig { num_envs: 40, seed: 3, ..EnvConfig::default() };
    let model = arm(&task);
    let mut reference = ReferenceEnv::with_rules(&model, &task, &RULES, &config).unwrap();
    let mut others: Vec<(&str, Box<dyn VectorEnv>)> =
        vec![("lanes", Box::new(CpuEnv::with_rules(&model, &task, &RULES, &config).unwrap()))];
    if !without_gpu() {
        others.push(("card", Box::new(GpuEnv::with_rules(&gpu(), &model, &task, &RULES, &config).unwrap())));
    }
    let want = rollout(&mut reference, 25);
    let ends: usize = want.iter().map(|out| out.terminated.iter().filter(|&&ended| ended).count()).sum();
    assert!(ends > 10, "{ends} episodes ended, too few to compare");
    for (name, env) in &mut others {
        for (step, (got, want)) in rollout(env.as_mut(), 25).iter().zip(&want).enumerate() {
            assert_follows(&reference, got, want, &format!("{name} step {step}"));
        }
    }
}

/// Few environments and small networks: it takes seconds, also where a graphics card is a program.
fn small() -> PpoConfig {
    PpoConfig {
        num_envs: 128,
        rollout_s: 0.4,
        minibatches: 4,
        policy_hidden: vec![32],
        value_hidden: vec![32],
        exploring_starts: 0.0,
        ..PpoConfig::default()
    }
}

fn envs(device: &Device) -> Envs {
    let task = Task { time_limit_s: 1.0, ..task() };
    Envs::with_rules(device, &arm(&task), &task, &RULES, &small().envs(1)).unwrap()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn check_that_it_is_learned(device: &Device) {
    let mut trainer = envs(device).train(small(), 1).unwrap();
    let updates = (0..120).map(|_| trainer.update().unwrap());
    let returns: Vec<f64> = updates.filter_map(|update| update.episodes.mean("return")).collect();
    assert!(returns.len() > 80, "{} updates saw the end of an episode", returns.len());
    let (first, last) = (mean(&returns[..20]), mean(&returns[returns.len() - 20..]));
    println!("mean return {first:.3} at first, {last:.3} at last");
    assert!(last > first + 0.3, "the mean return went from {first} to {last}");
}

/// A session looks at fresh environments under the same rules.
fn check_that_it_is_evaluated(device: &Device) {
    let (config, envs) = (small(), envs(device));
    let (looks, goal) = (envs.for_looks(1).unwrap(), Goal { until: Until::Off, steps: 4096 });
    let mut session = envs.session(looks, Start::New { config: &config, seed: 1, from: None }, goal).unwrap();
    let end = std::iter::repeat_with(|| session.advance(&|| true).unwrap().end).flatten().next().unwrap();
    let evaluation = session.conclude(end, &|| true).unwrap().evaluation.unwrap();
    assert_eq!(evaluation.episodes, 1000);
    assert!(evaluation.targets.is_empty());
    assert!((0.0..=1.0).contains(&evaluation.success.unwrap()) && evaluation.effort.unwrap() > 0.0, "{evaluation:?}");
}

#[test]
fn it_is_learned_on_the_processor() {
    check_that_it_is_learned(&Device::Cpu);
    check_that_it_is_evaluated(&Device::Cpu);
}

#[test]
fn it_is_learned_on_a_graphics_card() {
    if without_gpu() {
        return;
    }
    let device = Device::Gpu(gpu());
    check_that_it_is_learned(&device);
    check_that_it_is_evaluated(&device);
}

#[test]
fn the_example_is_a_page_long() {
    let lines = include_str!("../examples/own_task.rs").lines().count();
    assert!(lines <= 60, "{lines} lines");
}
