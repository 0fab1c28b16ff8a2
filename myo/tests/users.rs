//! Users of several layouts, trained at once on a card.

use myo::gpu::{AdapterChoice, Gpu};
use myo::model::{Model, builtin};
use myo::tasks::{Item, Task, preset};
use myo::train::PpoConfig;
use myo::train::session::{Goal, Outcome, Until};
use myo::{Device, Envs, MOST_AT_ONCE, Start, User, batches, train_at_once};

/// A short `public-display` with its buttons elsewhere.
fn layout(up_m: f64) -> Task {
    let mut task = Task { time_limit_s: 0.6, ..preset("public-display").unwrap() };
    for item in task.scene.0.values_mut() {
        match item {
            Item::Button(button) => button.at.0 = button.at.0.moved([0.0, 0.0, up_m]),
            Item::Obstacle(wall) => wall.at.0 = wall.at.0.moved([0.0, 0.0, up_m]),
            other => panic!("{other:?} stays as it is"),
        }
    }
    task
}

fn body() -> Model {
    Model::new(&builtin("mobl-arms").unwrap()).unwrap()
}

/// Any card. Without one the test fails, unless `MYO_NO_GPU` says that this is meant.
fn card() -> Option<Device> {
    match Gpu::open_with_cache(&AdapterChoice::Any, None) {
        Ok(gpu) => Some(Device::Gpu(gpu)),
        Err(error) if std::env::var("MYO_NO_GPU").as_deref() == Ok("1") => {
            println!("skipped: MYO_NO_GPU=1, and {error}");
            None
        }
        Err(error) => panic!("{error}. To skip these tests, set MYO_NO_GPU=1."),
    }
}

#[test]
fn tasks_of_one_structure_make_one_batch() {
    let (display, lower) = (preset("public-display").unwrap(), layout(-0.05));
    let longer = Task { time_limit_s: 0.7, ..lower.clone() };
    let tasks = [&display, &lower, &longer, &preset("ar").unwrap(), &layout(0.02), &preset("ticket").unwrap()];
    let users = tasks.map(|task| User { task, seed: 1 });
    assert_eq!(batches(&body(), &users).unwrap(), [vec![0], vec![1, 4], vec![2], vec![3], vec![5]]);
    let many = vec![users[0]; MOST_AT_ONCE + 3];
    let sizes: Vec<usize> = batches(&body(), &many).unwrap().iter().map(Vec::len).collect();
    assert_eq!(sizes, [MOST_AT_ONCE, 3]);
}

#[test]
fn users_of_several_layouts_learn_at_once_each_as_alone() {
    let Some(device) = card() else { return };
    let config = PpoConfig {
        num_envs: 24,
        rollout_s: 0.4,
        minibatches: 2,
        policy_hidden: vec![16],
        value_hidden: vec![16],
        ..PpoConfig::default()
    };
    let (goal, model) = (Goal { until: Until::Off, steps: 24 * 8 * 4 }, body());
    let tasks = [layout(0.0), layout(-0.05)];
    let users = [(0, 3), (1, 3), (1, 4)].map(|(task, seed)| User { task: &tasks[task], seed });
    let at_once = train_at_once(&device, &model, &users, &config, goal, &|| true).unwrap();
    let alone = |user: &User<'_>| -> Outcome {
        let envs = Envs::new(&device, &model, user.task, &config.envs(user.seed)).unwrap();
        let looks = envs.for_looks(user.seed).unwrap();
        let start = Start::New { config: &config, seed: user.seed, from: None };
        let mut session = envs.session(looks, start, goal).unwrap();
        loop {
            if let Some(end) = session.advance(&|| true).unwrap().end {
                return session.conclude(end, &|| true).unwrap();
            }
        }
    };
    for (user, outcome) in users.iter().zip(at_once) {
        let (got, want) = (outcome.unwrap(), alone(user));
        assert_eq!((got.env_steps, got.end), (want.env_steps, want.end));
        assert_eq!(got.evaluation, want.evaluation, "seed {}", user.seed);
        assert!(got.evaluation.unwrap().episodes == 1000);
    }
}

#[test]
fn who_is_stopped_ends_and_processors_train_one_after_the_other() {
    let (task, goal) = (layout(0.0), Goal { until: Until::Off, steps: 1_000_000_000 });
    let users = [User { task: &task, seed: 1 }; 2];
    let refused = train_at_once(&Device::Cpu, &body(), &users, &PpoConfig::default(), goal, &|| true).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "users are trained at once on a graphics card only; train them one after the other"
    );
    assert!(train_at_once(&Device::Cpu, &body(), &[], &PpoConfig::default(), goal, &|| true).unwrap().is_empty());
    let Some(device) = card() else { return };
    let config = PpoConfig { num_envs: 16, ..PpoConfig::default() };
    for outcome in train_at_once(&device, &body(), &users, &config, goal, &|| false).unwrap() {
        let outcome = outcome.unwrap();
        assert_eq!((outcome.end.name(), outcome.env_steps), ("interrupt", 0));
    }
}
