//! Properties of whole training runs on toy environments.

mod common;

use common::{Constant, Points};
use myo_env::{EnvError, EnvSpec, StepBuffers, VectorEnv};
use myo_train::{Checkpoint, PpoConfig, TrainError, Trainer, evaluate};

/// Settings for [`Points`] that need a second or two.
fn config() -> PpoConfig {
    PpoConfig {
        num_envs: 256,
        rollout_s: 0.8,
        policy_hidden: vec![32, 32],
        value_hidden: vec![32, 32],
        exploring_starts: 0.0,
        action_offset: 0.0,
        action_scale: 1.0,
        ..PpoConfig::default()
    }
}

fn trainer(seed: u64) -> Trainer {
    Trainer::new(Box::new(Points::new(256)), config(), seed).unwrap()
}

fn with_threads<T: Send>(threads: usize, body: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(body)
}

/// The bytes of a checkpoint without the wall time, which no two runs share.
fn bits(trainer: &Trainer) -> Vec<u8> {
    let mut checkpoint = trainer.save().unwrap();
    checkpoint.forget_wall_time();
    checkpoint.to_bytes()
}

#[test]
fn ppo_learns_to_reach_two_targets() {
    let mut trainer = trainer(1);
    let first = trainer.update().unwrap();
    assert!(first.learn.kl.abs() < 0.1);
    let mut success = 0.0;
    for _ in 0..150 {
        let metrics = trainer.update().unwrap();
        success = metrics.episodes.mean("success").unwrap_or(success);
        if success > 0.97 && metrics.explained_variance > 0.5 {
            return;
        }
    }
    panic!("success is only {success} after {} steps", trainer.env_steps());
}

/// Settings for [`Constant`].
fn small(num_envs: usize, steps: usize) -> PpoConfig {
    let hidden = PpoConfig { policy_hidden: vec![4], value_hidden: vec![4], minibatches: 1, ..PpoConfig::default() };
    PpoConfig { num_envs, rollout_s: steps as f64 * 0.05, exploring_starts: 0.0, ..hidden }
}

#[test]
fn episodes_that_begin_in_the_middle_of_the_task_are_counted_nowhere() {
    let env = Constant::staircase(4).exploring(2);
    let metrics =
        Trainer::new(Box::new(env), PpoConfig { exploring_starts: 0.5, ..small(4, 12) }, 1).unwrap().update().unwrap();
    // Twelve that return one, and six that return two; not four of three and three of four.
    assert_eq!(metrics.episodes.count, 18);
    assert_eq!(metrics.episodes.mean("return"), Some(24.0 / 18.0));
}

#[test]
fn episodes_of_each_layout_are_told_apart() {
    let env = Constant::staircase(4).in_layouts(2);
    let metrics = Trainer::new(Box::new(env), small(4, 12), 1).unwrap().update().unwrap();
    let [first, second] = &metrics.layouts[..] else { panic!("{:?}", metrics.layouts) };
    // In twelve steps twelve episodes of one and four of three; six of two and three of four.
    assert_eq!((first.count, first.mean("return")), (16, Some(24.0 / 16.0)));
    assert_eq!((second.count, second.mean("return")), (9, Some(24.0 / 9.0)));
    assert_eq!(metrics.episodes.count, 25);
    let alone = Trainer::new(Box::new(Constant::staircase(4)), small(4, 12), 1).unwrap().update().unwrap();
    assert_eq!((alone.layouts.len(), alone.episodes.count), (0, 25), "one layout is not told apart");
}

#[test]
fn an_evaluation_counts_as_many_episodes_of_each_layout() {
    let mut trainer = Trainer::new(Box::new(Constant::staircase(5)), small(5, 12), 1).unwrap();
    trainer.update().unwrap();
    // Three environments for the first layout, with episodes of one, three and five steps; two for the second.
    let mut env = Constant::staircase(5).in_layouts(2);
    let evaluation = evaluate(&mut trainer.policy(), &mut env, 6, 1, |_| true).unwrap();
    let counts: Vec<u64> = evaluation.layouts.iter().map(|layout| layout.episodes).collect();
    assert_eq!((evaluation.episodes, &counts[..]), (12, &[6, 6][..]));
    let returns: Vec<_> = evaluation.layouts.iter().map(|layout| layout.episode_return).collect();
    assert_eq!((returns, evaluation.episode_return), (vec![Some(3.0), Some(3.0)], Some(3.0)));
}

/// Otherwise all of them would end in one update of six, and again in each sixth after it.
#[test]
fn episodes_that_last_to_the_time_limit_end_at_different_times() {
    let env = Constant::with_lengths(vec![24; 12], vec![0; 12], false);
    let mut trainer = Trainer::new(Box::new(env), small(12, 4), 1).unwrap();
    let episodes: Vec<u64> = (0..18).map(|_| trainer.update().unwrap().episodes.count).collect();
    assert_eq!(episodes[..5], [0; 5]);
    assert_eq!(episodes[5..], [2; 13]);
}

#[test]
fn training_gives_the_same_bits_at_any_thread_count() {
    let run = || {
        let mut trainer = trainer(3);
        (0..4).for_each(|_| drop(trainer.update().unwrap()));
        bits(&trainer)
    };
    let one = with_threads(1, run);
    assert!(one == with_threads(2, run), "2 threads differ from 1");
    assert!(one == with_threads(5, run), "5 threads differ from 1");
}

#[test]
fn a_resumed_run_gives_the_same_bits_as_one_left_alone() {
    let mut whole = trainer(4);
    (0..3).for_each(|_| drop(whole.update().unwrap()));
    let saved = whole.save().unwrap().to_bytes();
    (0..3).for_each(|_| drop(whole.update().unwrap()));

    let checkpoint = Checkpoint::from_bytes(&saved).unwrap();
    let mut resumed = Trainer::restore(Box::new(Points::new(256)), &checkpoint).unwrap();
    assert_eq!(resumed.updates(), 3);
    (0..3).for_each(|_| drop(resumed.update().unwrap()));
    assert!(bits(&whole) == bits(&resumed), "the resumed run differs");
}

#[test]
fn another_seed_gives_another_run() {
    let run = |seed| {
        let mut trainer = trainer(seed);
        trainer.update().unwrap();
        trainer.policy()
    };
    let act = |mut policy: myo_train::Policy| {
        let mut action = [0.0; 2];
        policy.act_deterministic(&[0.1, 0.2, 0.3, 0.4, 0.0, 0.3], &mut action);
        action
    };
    assert_ne!(act(run(1)), act(run(2)));
}

/// Trains only the value network on reward 1 per step and returns the value of the one observation there is.
fn learned_value(terminates: bool, gamma: f64) -> f64 {
    let config = PpoConfig {
        num_envs: 64,
        exploring_starts: 0.0,
        rollout_s: 0.8,
        value_hidden: vec![16],
        policy_hidden: vec![4],
        discount_per_s: gamma.powf(1.0 / 0.05),
        learning_rate: 3e-3,
        kl_target: 0.0,
        gradient_norm_max: 100.0,
        ..PpoConfig::default()
    };
    let mut trainer = Trainer::new(Box::new(Constant::new(64, 5, terminates)), config, 1).unwrap();
    (0..400).for_each(|_| drop(trainer.update().unwrap()));
    let mut value = [0.0];
    trainer.values(&[1.0, 0.0], &mut value);
    value[0].into()
}

#[test]
fn the_time_limit_does_not_end_the_future() {
    let value = learned_value(false, 0.9);
    assert!((value - 10.0).abs() < 0.2, "the value of 1 per step for ever is 1 / (1 - 0.9) = 10, not {value}");
}

#[test]
fn the_end_of_the_task_ends_the_future() {
    let value = learned_value(true, 0.9);
    // Steps 1 to 5 of an episode look the same: the mean of (1 - 0.9^n) / 0.1 over n = 1..5.
    let expected = (1..=5).map(|n| (1.0 - 0.9_f64.powi(n)) / 0.1).sum::<f64>() / 5.0;
    assert!((value - expected).abs() < 0.4, "{value}, not {expected}");
}

#[test]
fn numbers_that_are_not_finite_stop_the_training_with_a_reason() {
    let config = PpoConfig { num_envs: 8, exploring_starts: 0.0, ..PpoConfig::default() };
    let mut env = Constant::new(8, 5, false);
    env.reward = f32::NAN;
    let mut trainer = Trainer::new(Box::new(env), config.clone(), 1).unwrap();
    let error = trainer.update().unwrap_err();
    assert_eq!(error.to_string(), "the environment returned a NaN or infinite reward in update 0");

    let mut env = Constant::new(8, 5, false);
    env.reward = 3e38;
    let mut trainer = Trainer::new(Box::new(env), config, 1).unwrap();
    let error = (0..3).find_map(|_| trainer.update().err()).expect("the sum of such rewards overflows");
    assert!(matches!(error, TrainError::Diverged { .. }), "{error}");
    assert!(error.to_string().contains("lower learning_rate"), "{error}");
}

/// One last observation of an episode is not a number, once.
struct BadLast(Constant, bool);

impl VectorEnv for BadLast {
    fn spec(&self) -> &EnvSpec {
        self.0.spec()
    }
    fn reset(&mut self, seed: Option<u64>, mask: Option<&[bool]>, out: &mut [f32]) -> Result<(), EnvError> {
        self.0.reset(seed, mask, out)
    }
    fn step(&mut self, actions: &[f32], out: StepBuffers<'_>) -> Result<(), EnvError> {
        let StepBuffers { observation, reward, terminated, truncated, final_observation, episode } = out;
        let (truncated, last) = (&mut *truncated, &mut *final_observation);
        let inner = StepBuffers {
            observation,
            reward,
            terminated,
            truncated: &mut *truncated,
            final_observation: &mut *last,
            episode,
        };
        self.0.step(actions, inner)?;
        if let Some(env) = truncated.iter().position(|&over| over).filter(|_| !self.1) {
            last[2 * env + 1] = f32::NAN;
            self.1 = true;
        }
        Ok(())
    }
    fn save_state(&self) -> Result<Vec<u8>, EnvError> {
        self.0.save_state()
    }
    fn load_state(&mut self, state: &[u8]) -> Result<(), EnvError> {
        self.0.load_state(state)
    }
}

#[test]
fn a_bad_last_observation_is_forgotten_when_the_training_goes_back() {
    let config = PpoConfig { num_envs: 8, exploring_starts: 0.0, ..PpoConfig::default() };
    let mut trainer = Trainer::new(Box::new(BadLast(Constant::new(8, 5, false), false)), config, 1).unwrap();
    let start = trainer.save().unwrap();
    let error = trainer.update().unwrap_err().to_string();
    assert!(error.contains("observation \"last\""), "{error}");
    trainer.go_back(&start, 1.0).unwrap();
    assert_eq!(trainer.update().unwrap().updates, 1);
}

#[test]
fn a_warm_start_acts_as_its_source_whatever_the_mapping_of_actions() {
    let other = PpoConfig { action_offset: 0.3, action_scale: 0.4, ..config() };
    let mut first = Trainer::new(Box::new(Points::new(256)), other, 1).unwrap();
    (0..5).for_each(|_| drop(first.update().unwrap()));
    let mut second = Trainer::new(Box::new(Points::new(256)), config(), 2).unwrap();
    second.warm_start(&first.save().unwrap()).unwrap();
    let observation: Vec<f32> = (0..60).map(|i| (i as f32 * 0.7).sin()).collect();
    let act = |trainer: &Trainer| {
        let mut actions = [0.0; 20];
        trainer.policy().act_deterministic(&observation, &mut actions);
        actions
    };
    let (expected, got) = (act(&first), act(&second));
    assert!(expected.iter().any(|a| (0.05..0.95).contains(&a.abs())), "not all at their limits: {expected:?}");
    for (expected, got) in expected.iter().zip(&got) {
        assert!((expected - got).abs() < 1e-4, "{got} in place of {expected}");
    }
}

#[test]
fn more_memory_than_there_can_be_is_refused_with_its_amount() {
    // 40,000 layers of 8192 x 8192 weights: more than any address space holds.
    let config = PpoConfig { policy_hidden: vec![8192; 40_000], ..config() };
    let error = Trainer::new(Box::new(Points::new(256)), config, 1).err().unwrap().to_string();
    assert!(error.contains("GB of memory, which cannot be had; lower num_envs"), "{error}");
}

#[test]
fn an_environment_that_does_not_fit_is_refused() {
    let error = |env: Points| Trainer::new(Box::new(env), config(), 1).err().unwrap().to_string();
    assert_eq!(error(Points::new(8)), "the environment does not fit: the number of environments is 8, expected 256");
    let checkpoint = trainer(1).save().unwrap();
    let error = Trainer::restore(Box::new(Constant::new(256, 5, true)), &checkpoint).err().unwrap().to_string();
    assert!(error.contains("list of observations is 2 long with \"one\" at place 0"), "{error}");
}
