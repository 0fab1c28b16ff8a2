//! What it costs to change what is asked of muscles, and that users perceive what they last asked for.

use crate::common::{arm, gpu, short, without_gpu};
use myo_env::gpu::GpuOptions;
use myo_env::{Autoreset, CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, StepStorage, VectorEnv};
use myo_tasks::Task;

const ENVS: usize = 20;
const COST: f64 = 0.02;

/// With motor noise, which costs nothing and is not perceived, and muscles that rest at first.
fn task(cost: f64) -> Task {
    let mut task = short("pointing-uitb");
    task.reward.control_change_cost = cost;
    // What movements cost has a bound that grows with it.
    task.reward.completion_bonus = 100.0;
    task.noise.signal_dependent = 0.1;
    task.reset.activation_max = 0.0;
    task
}

fn config() -> EnvConfig {
    EnvConfig { num_envs: ENVS, seed: 5, autoreset: Autoreset::SameStep, ..EnvConfig::default() }
}

fn check(make: &dyn Fn(&Task) -> Box<dyn VectorEnv>) {
    let [mut dear, mut free] = [COST, 0.0].map(|cost| make(&task(cost)));
    let (spec, muscles) = (dear.spec().clone(), dear.spec().action_size());
    let control = spec.observation_names.iter().position(|name| name.starts_with("control.")).unwrap();
    assert!(!free.spec().observation_names.iter().any(|name| name.starts_with("control.")));
    let (mut a, mut b) = (StepStorage::new(&spec), StepStorage::new(&free.spec().clone()));
    dear.reset(Some(1), None, &mut a.observation).unwrap();
    free.reset(Some(1), None, &mut b.observation).unwrap();
    let mut before = 0.0;
    // An action of -1 asks for nothing, 1 for all; what is beyond is cut off.
    for (action, asked) in [(-1.0, 0.0), (0.0, 0.5), (0.0, 0.5), (3.0, 1.0)] {
        let actions = vec![action; ENVS * muscles];
        dear.step(&actions, a.buffers()).unwrap();
        free.step(&actions, b.buffers()).unwrap();
        let change: f64 = asked - before;
        // Per second, of a rate squared: over 0.05 s, of the square of the change, twenty times as much.
        let paid = COST * muscles as f64 * change * change / 0.05;
        for env in 0..ENVS {
            let differs = f64::from(b.reward[env] - a.reward[env]);
            assert!((differs - paid).abs() < 1e-4 * (1.0 + paid), "{differs} instead of {paid}");
            let perceived = &a.observation[env * spec.observation_size() + control..][..muscles];
            assert!(perceived.iter().all(|&x| (f64::from(x) - (2.0 * asked - 1.0)).abs() < 1e-6), "{perceived:?}");
        }
        before = asked;
    }
}

#[test]
fn changes_of_controls_cost_what_the_task_says() {
    check(&|task| Box::new(ReferenceEnv::new(&arm(task), task, &config()).unwrap()));
    check(&|task| Box::new(CpuEnv::new(&arm(task), task, &config()).unwrap()));
}

#[test]
fn so_they_do_on_a_card() {
    if without_gpu() {
        return;
    }
    let (gpu, options) = (gpu(), GpuOptions { envs_per_shard: 16, ..GpuOptions::default() });
    check(&|task| Box::new(GpuEnv::with_options(&gpu, &arm(task), task, &config(), &options).unwrap()));
}
