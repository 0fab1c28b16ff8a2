//! A share of what movement costs: environments that let it count are those of a task with lower costs, and nothing else about them differs.

use crate::common::{arm, gpu, rollout, short, without_gpu};
use myo_env::gpu::GpuOptions;
use myo_env::{Autoreset, CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, VectorEnv};
use myo_tasks::Task;

/// Where movement costs something.
fn dear() -> Task {
    let mut task = short("pointing-uitb");
    (task.reward.effort_cost, task.reward.acceleration_cost) = (4.0, 2e-3);
    task.reward.control_change_cost = 0.01;
    task
}

/// Two layouts with this share of their costs.
fn layouts(share: f64) -> [Task; 2] {
    let mut tasks = [dear(), dear()];
    tasks[1].reward.effort_cost = 1.0;
    for task in &mut tasks {
        task.reward.effort_cost *= share;
        task.reward.acceleration_cost *= share;
        task.reward.control_change_cost *= share;
    }
    tasks
}

fn config() -> EnvConfig {
    EnvConfig { num_envs: 20, seed: 3, autoreset: Autoreset::SameStep, ..EnvConfig::default() }
}

/// A quarter of the costs is a quarter of the costs, also after other tasks and in saved states; all of them count again at 1.
fn check(make: &dyn Fn(&[Task]) -> Box<dyn VectorEnv>) {
    let (mut shared, mut cheap, mut whole) = (make(&layouts(1.0)), make(&layouts(0.25)), make(&layouts(1.0)));
    shared.set_cost_share(0.25).unwrap();
    shared.set_tasks(&layouts(1.0)).unwrap();
    let (mine, theirs, all) = (rollout(&mut *shared, 8), rollout(&mut *cheap, 8), rollout(&mut *whole, 8));
    for (step, (a, b)) in mine.iter().zip(&theirs).enumerate() {
        assert!(a.observation == b.observation, "step {step}");
        let differs = a.reward.iter().zip(&b.reward).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(differs < 1e-6, "step {step}: {differs}");
    }
    assert!(mine.iter().zip(&all).all(|(a, b)| a.observation == b.observation && a.reward != b.reward));

    // A state tells nothing of the share, which stays that of the environments that take it up.
    shared.load_state(&whole.save_state().unwrap()).unwrap();
    let pairs = rollout(&mut *shared, 4).into_iter().zip(rollout(&mut *whole, 4));
    assert!(pairs.into_iter().all(|(a, b)| a.observation == b.observation && a.reward != b.reward));
    shared.set_cost_share(1.0).unwrap();
    let pairs = rollout(&mut *shared, 4).into_iter().zip(rollout(&mut *whole, 4));
    assert!(pairs.into_iter().all(|(a, b)| a.reward == b.reward));

    for wrong in [-0.1, 1.01, f64::NAN] {
        let error = shared.set_cost_share(wrong).unwrap_err().to_string();
        assert_eq!(error, format!("the share of what movement costs is {wrong}; it must be from 0 to 1"));
    }
}

#[test]
fn a_share_of_the_costs_is_a_task_with_lower_costs() {
    let model = arm(&dear());
    check(&|tasks| Box::new(ReferenceEnv::with_layouts(&model, tasks, &config()).unwrap()));
    check(&|tasks| Box::new(CpuEnv::with_layouts(&model, tasks, &config()).unwrap()));
}

#[test]
fn on_a_card_as_well() {
    if without_gpu() {
        return;
    }
    let (gpu, model) = (gpu(), arm(&dear()));
    let options = GpuOptions { envs_per_shard: 16, ..GpuOptions::default() };
    check(&|tasks| Box::new(GpuEnv::with_layouts(&gpu, &model, tasks, &config(), &options).unwrap()));
}
