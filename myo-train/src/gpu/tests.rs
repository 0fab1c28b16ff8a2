//! Roll-outs on the card beside roll-outs whose policy runs on the processor.

use myo_env::gpu::GpuOptions;
use myo_env::{EnvConfig, GpuEnv, VectorEnv};
use myo_gpu::Gpu;
use myo_model::{Model, builtin};
use myo_tasks::{Instruction, Item, Range, SphereItem, Task};

use super::testing::{assert_close, gpu};
use super::{DeviceEvaluator, DeviceRollout};
use crate::networks::{Lender, Networks};
use crate::normalizer::{Moments, Normalizer};
use crate::rollout::{Actor, Rollout};
use crate::{PpoConfig, TrainError, Trainer, evaluate};

pub const STEPS: usize = 7;
pub const SEED: u64 = 0x0123_4567_89ab_cdef;
/// Its sum with the steps of a roll-out overflows the lower half.
pub const FIRST_STEP: u64 = u32::MAX as u64 - 2;

/// Episodes of at most 3 control steps, of which some end earlier.
pub fn task() -> Task {
    let mut task = myo_tasks::preset("pointing-single").unwrap();
    ball(&mut task).radius = Range { min: 0.2, max: 0.7 };
    dwell_for(&mut task, 0.05);
    task.time_limit_s = 0.15;
    // In so few steps, coming nearer is all there is to learn.
    task.reward.distance_cost = 20.0;
    task
}

fn ball(task: &mut Task) -> &mut SphereItem {
    let Item::Sphere(ball) = &mut task.scene.0["ball"] else { panic!("the task has changed") };
    ball
}

fn dwell_for(task: &mut Task, seconds: f64) {
    let Instruction::Dwell(dwell) = &mut task.script[0] else { panic!("the task has changed") };
    dwell.for_s = seconds;
}

/// Environments, of which some explore.
pub fn envs(num_envs: usize) -> EnvConfig {
    config(num_envs).envs(3)
}

pub fn env(gpu: &Gpu, num_envs: usize) -> GpuEnv {
    let task = task();
    let model = task.embody(&builtin(&task.model).unwrap()).unwrap();
    GpuEnv::new(gpu, &model, &task, &envs(num_envs)).unwrap()
}

pub fn config(num_envs: usize) -> PpoConfig {
    PpoConfig {
        num_envs,
        rollout_s: STEPS as f64 * 0.05,
        // Noise of three draws.
        exploration_s: 0.15,
        exploring_starts: 0.25,
        policy_hidden: vec![33, 20],
        value_hidden: vec![17],
        observation_clip: 1.5,
        reward_scale: 0.5,
        action_offset: -0.3,
        action_scale: 0.8,
        ..PpoConfig::default()
    }
}

/// Parameters and scaling that are not those of the beginning.
pub struct Brain {
    pub networks: Networks,
    pub parameters: Vec<f32>,
    pub normalizer: Normalizer,
    pub lender: Lender<crate::networks::ChunkWork>,
    pub config: PpoConfig,
}

impl Brain {
    pub fn new(env: &GpuEnv, config: PpoConfig, rows: &[f32]) -> Self {
        let networks = Networks::new(env.spec(), &config);
        let mut parameters = networks.initialize(SEED, &config, 0.05);
        networks.policy.initialize(SEED, 7, 1.0, &mut parameters[networks.policy_range()]);
        for (i, log_std) in parameters[networks.log_std_range()].iter_mut().enumerate() {
            *log_std = -1.0 + 0.05 * i as f32;
        }
        let mut normalizer = Normalizer::new(env.spec().observation_size(), config.observation_clip, 0.05);
        let mut moments = Moments::new(env.spec().observation_size());
        normalizer.measure(rows, &mut moments);
        normalizer.merge(&moments);
        Self { networks, parameters, normalizer, lender: Lender::new(), config }
    }

    pub fn actor(&self) -> Actor<'_> {
        Actor {
            networks: &self.networks,
            parameters: &self.parameters,
            normalizer: &self.normalizer,
            lender: &self.lender,
            config: &self.config,
            seed: SEED,
        }
    }
}

pub fn start(gpu: &Gpu, num_envs: usize) -> (GpuEnv, Brain, Vec<f32>) {
    let mut env = env(gpu, num_envs);
    let mut observation = vec![0.0; num_envs * env.spec().observation_size()];
    env.reset(None, None, &mut observation).unwrap();
    let brain = Brain::new(&env, config(num_envs), &observation);
    (env, brain, observation)
}

/// A roll-out with the policy on the processor, or on the card; and the observations after it.
fn roll_out(gpu: &Gpu, num_envs: usize, on_card: bool) -> (Rollout, Vec<f32>) {
    let (mut env, brain, mut observation) = start(gpu, num_envs);
    let mut rollout = Rollout::new(env.spec(), &brain.config);
    if on_card {
        let mut card = DeviceRollout::new(env, &brain.config).unwrap();
        card.collect(&brain.actor(), FIRST_STEP, &mut rollout, &mut observation).unwrap();
    } else {
        assert!(rollout.collect(&mut env, &brain.actor(), FIRST_STEP, &mut observation, &|| true).unwrap());
        rollout.evaluate(&brain.actor());
    }
    (rollout, observation)
}

#[test]
fn a_roll_out_on_the_card_is_that_of_the_processor() {
    let Some(gpu) = gpu() else { return };
    // A number of environments that is no multiple of four.
    let envs = 37;
    let (card, card_last) = roll_out(&gpu, envs, true);
    let (host, host_last) = roll_out(&gpu, envs, false);

    assert_eq!(card.ended, host.ended);
    assert!(card.ended[..envs].iter().any(|&ended| ended), "nothing ended early");
    assert!(card.ended[2 * envs..3 * envs].iter().all(|&ended| ended) || card.episodes.count > envs as u64);
    // The first actions are those of the same observations, noise included; later ones of observations that went through
    // the muscles.
    let first = |x: &[f32]| x[..x.len() / STEPS].to_vec();
    assert_close("first action", &first(&card.action), &first(&host.action), 1e-5);
    assert_close("log_prob", &card.log_prob, &host.log_prob, 1e-5);
    assert_close("observation", &card.observation, &host.observation, 1e-3);
    assert_close("action", &card.action, &host.action, 1e-3);
    assert_close("reward", &card.reward, &host.reward, 1e-4);
    assert_close("value", &card.value, &host.value, 1e-3);
    assert_close("next_value", &card.next_value, &host.next_value, 1e-3);
    assert_close("last observation", &card_last, &host_last, 1e-3);

    assert_eq!(card.episodes.count, host.episodes.count);
    for (a, b) in card.episodes.means().zip(host.episodes.means()) {
        assert!((a - b).abs() < 1e-4 * b.abs().max(1.0) || a.is_nan() && b.is_nan(), "episodes: {a}, {b}");
    }
}

#[test]
fn the_first_environments_act_without_noise_and_count_by_themselves() {
    let Some(gpu) = gpu() else { return };
    // Not a multiple of 64, and 32 of them explore.
    let envs = 131;
    let [card, host] = [true, false].map(|on_card| {
        let (mut rollout, _) = roll_out(&gpu, envs, on_card);
        rollout.estimate(&config(envs));
        rollout
    });
    let noise_free = config(envs).noise_free_envs();
    assert_eq!(noise_free, 2);
    for rollout in [&card, &host] {
        let peak = rollout.log_prob.iter().copied().reduce(f32::max).unwrap();
        for step in rollout.log_prob.chunks(envs) {
            assert!(step[..noise_free].iter().all(|log_prob| *log_prob == peak), "{step:?}");
            assert!(step[noise_free..].iter().all(|log_prob| *log_prob < peak), "{step:?}");
        }
        for step in rollout.advantage.chunks(envs) {
            assert_eq!(step.iter().filter(|advantage| **advantage == 0.0).count(), noise_free, "{step:?}");
        }
        let ended = |of: std::ops::Range<usize>| {
            let flags = rollout.ended.chunks(envs).flat_map(|step| &step[of.clone()]);
            flags.filter(|ended| **ended).count() as u64
        };
        let counts = (rollout.noise_free.count, rollout.episodes.count);
        assert_eq!(counts, (ended(0..noise_free), ended(noise_free..envs - 32)));
        assert!(counts.0 > 0);
    }
    assert_close("log_prob", &card.log_prob, &host.log_prob, 1e-5);
    for (a, b) in card.noise_free.means().zip(host.noise_free.means()) {
        assert!((a - b).abs() < 1e-4 * b.abs().max(1.0) || a.is_nan() && b.is_nan(), "episodes: {a}, {b}");
    }
}

#[test]
fn values_after_the_time_limit_are_those_of_the_last_observations() {
    let Some(gpu) = gpu() else { return };
    let envs = 37;
    let [rollout, host] = [true, false].map(|on_card| roll_out(&gpu, envs, on_card).0);
    assert_close("next value", &rollout.next_value, &host.next_value, 1e-3);
    let bootstrapped = (0..rollout.reward.len() - envs)
        .filter(|&i| rollout.ended[i] && rollout.next_value[i] != 0.0)
        .inspect(|&i| assert_ne!(rollout.next_value[i], rollout.value[i + envs], "that of the next episode"))
        .count();
    let finished = (0..rollout.reward.len()).filter(|&i| rollout.ended[i] && rollout.next_value[i] == 0.0).count();
    assert!(bootstrapped > 3 && finished > 3, "{bootstrapped} cut off, {finished} finished");
}

#[test]
fn moments_are_those_of_the_observations() {
    let Some(gpu) = gpu() else { return };
    let (envs, mut scalings) = (300, vec![]);
    for on_card in [true, false] {
        let (rollout, _) = roll_out(&gpu, envs, on_card);
        let (.., brain, _) = start(&gpu, envs);
        let mut normalizer = brain.normalizer.clone();
        normalizer.merge(&rollout.moments);
        scalings.push(normalizer);
    }
    let (card, host) = (scalings[0].scaling(), scalings[1].scaling());
    assert_close("mean", card.0, host.0, 1e-5);
    assert_close("inverse standard deviation", card.1, host.1, 1e-4);
}

#[test]
fn the_same_roll_out_gives_the_same_bits() {
    let Some(gpu) = gpu() else { return };
    let bits = || {
        let (rollout, last) = roll_out(&gpu, 37, true);
        let all = [rollout.observation, rollout.action, rollout.log_prob, rollout.value, rollout.reward, last];
        all.concat().iter().map(|x| x.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(bits(), bits());
}

#[test]
fn training_on_the_card_resumes_with_the_same_bits() {
    let Some(gpu) = gpu() else { return };
    let envs = 64;
    let mut trainer = Trainer::on_card(env(&gpu, envs), config(envs), 1).unwrap();
    let first = trainer.update().unwrap();
    assert!(first.learn.kl.abs() < 0.1 && first.episodes.count > 0, "{first:?}");
    let saved = trainer.save().unwrap();
    trainer.update().unwrap();
    let mut resumed = Trainer::restore_on_card(env(&gpu, envs), &saved).unwrap();
    resumed.update().unwrap();
    let bytes = |trainer: &Trainer| {
        let mut checkpoint = trainer.save().unwrap();
        checkpoint.forget_wall_time();
        checkpoint.to_bytes()
    };
    let whole = bytes(&trainer);
    assert!(whole == bytes(&resumed), "resumed");
    trainer.update().unwrap();
    trainer.go_back(&saved, 1.0).unwrap();
    trainer.update().unwrap();
    assert!(whole == bytes(&trainer), "gone back");
    let mut heir = Trainer::on_card(env(&gpu, envs), config(envs), 2).unwrap();
    heir.warm_start(&saved).unwrap();
    assert_eq!(heir.save().unwrap().parameters, saved.parameters);
}

/// A task whose reward counts time more, and whose spheres lie lower.
pub fn other_task() -> Task {
    let mut task = task();
    ball(&mut task).at.0.z = Range { min: -0.4, max: -0.3 };
    dwell_for(&mut task, 0.1);
    task.reward.time_cost = 20.0;
    task
}

#[test]
fn a_training_goes_on_with_other_numbers_between_two_updates() {
    let Some(gpu) = gpu() else { return };
    let envs = 64;
    let mut card = Trainer::on_card(env(&gpu, envs), config(envs), 1).unwrap();
    let mut host = Trainer::new(Box::new(env(&gpu, envs)), config(envs), 1).unwrap();
    let before = [card.update().unwrap(), host.update().unwrap()];
    for (trainer, before) in [&mut card, &mut host].into_iter().zip(before) {
        let mut dear = task();
        dear.reward.time_cost = 20.0;
        trainer.set_task(&dear).unwrap();
        let after = trainer.update().unwrap();
        // A control step of 50 ms costs 20 / s instead of 0.6.
        let costs = before.reward_per_step - after.reward_per_step;
        assert!((0.6..1.4).contains(&costs), "{costs}");
        assert_eq!(after.updates, 2);
        let saved = trainer.save().unwrap();
        trainer.go_back(&saved, 1.0).unwrap();
    }
    assert_close("weights", &card.save().unwrap().parameters, &host.save().unwrap().parameters, 1e-3);
    // Where environments explore, one control step is left of short episodes, two of those of a second.
    for seconds in [1.0, 0.15] {
        card.set_task(&Task { time_limit_s: seconds, ..task() }).unwrap();
    }
}

#[test]
fn a_time_limit_too_short_for_the_memory_of_a_training_is_refused() {
    let Some(gpu) = gpu() else { return };
    let long = Task { time_limit_s: 1.0, ..task() };
    let model = Model::new(&builtin(&long.model).unwrap()).unwrap();
    let env = GpuEnv::new(&gpu, &model, &long, &envs(8)).unwrap();
    let mut trainer = Trainer::on_card(env, config(8), 1).unwrap();
    let error = trainer.set_task(&task()).unwrap_err().to_string();
    assert!(error.contains("the time limit in control steps is 3, expected"), "{error}");
    trainer.update().unwrap();
}

#[test]
fn a_roll_out_that_does_not_fit_is_refused() {
    let Some(gpu) = gpu() else { return };
    let error = DeviceRollout::new(env(&gpu, 8), &config(9)).err().unwrap();
    assert!(matches!(error, TrainError::Mismatch { .. }), "{error}");
    let error = DeviceRollout::new(env(&gpu, 8), &PpoConfig { clip: 0.0, ..config(8) }).err().unwrap();
    assert!(matches!(error, TrainError::Config(_)), "{error}");
}

#[test]
fn training_on_the_card_goes_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    // Few enough samples that both sides have the same minibatches.
    let envs = 64;
    let config = PpoConfig { epochs: 2, minibatches: 8, ..config(envs) };
    assert_eq!(config.noise_free_envs(), 1);
    let mut card = Trainer::on_card(env(&gpu, envs), config.clone(), 1).unwrap();
    let mut host = Trainer::new(Box::new(env(&gpu, envs)), config, 1).unwrap();
    for _ in 0..3 {
        let (a, b) = (card.update().unwrap(), host.update().unwrap());
        let close = |what: &str, a: f64, b: f64| assert!((a - b).abs() < 2e-3 * b.abs().max(0.1), "{what}: {a}, {b}");
        close("kl", a.learn.kl, b.learn.kl);
        close("policy loss", a.learn.policy_loss, b.learn.policy_loss);
        close("value loss", a.learn.value_loss, b.learn.value_loss);
        close("gradient norm", a.learn.gradient_norm, b.learn.gradient_norm);
        close("reward", a.reward_per_step, b.reward_per_step);
        close("explained variance", a.explained_variance, b.explained_variance);
        close("spread", a.action_std, b.action_std);
        assert_eq!((a.env_steps, a.learning_rate), (b.env_steps, b.learning_rate));
        assert_eq!((a.episodes.count, a.noise_free.count), (b.episodes.count, b.noise_free.count));
    }
    assert_close("weights", &card.save().unwrap().parameters, &host.save().unwrap().parameters, 1e-3);
}

/// As [`training_on_the_card_goes_as_on_the_processor`], of three layouts, some of which are cut more often than others.
#[test]
fn layouts_are_learned_together_on_the_card_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    // Not a multiple of the layouts, and few enough that both sides have the same minibatches.
    let envs = 64;
    let layouts = [1.0, 0.1, 0.15].map(|time_limit_s| Task { time_limit_s, ..task() });
    let model = Model::new(&builtin(&layouts[0].model).unwrap()).unwrap();
    let base = GpuEnv::with_layouts(&gpu, &model, &layouts, &self::envs(envs), &GpuOptions::default()).unwrap();
    let again = || base.sibling(&self::envs(envs)).unwrap();
    let config = PpoConfig { epochs: 2, minibatches: 8, ..config(envs) };
    let mut card = Trainer::on_card(again(), config.clone(), 1).unwrap();
    let mut host = Trainer::new(Box::new(again()), config, 1).unwrap();
    let (a, b) = (card.update().unwrap(), host.update().unwrap());
    assert!((a.learn.value_loss - b.learn.value_loss).abs() < 2e-3 * b.learn.value_loss.max(0.1));
    assert_eq!((a.layouts.len(), b.layouts.len()), (3, 3));
    for (a, b) in a.layouts.iter().zip(&b.layouts) {
        assert!(a.count == b.count && a.count > 0, "{a:?} {b:?}");
        for ((name, a), (_, b)) in a.means.iter().zip(&b.means) {
            assert!((a - b).abs() < 1e-3 * b.abs().max(1.0) || a.is_nan() && b.is_nan(), "{name}: {a}, {b}");
        }
    }
    assert_eq!(a.episodes.count, a.layouts.iter().map(|layout| layout.count).sum::<u64>());
    assert_close("weights", &card.save().unwrap().parameters, &host.save().unwrap().parameters, 1e-3);

    let whole = EnvConfig { num_envs: 37, seed: 5, ..EnvConfig::default() };
    let mut evaluator = DeviceEvaluator::new(base.sibling(&whole).unwrap(), &card.policy()).unwrap();
    let evaluation = evaluator.evaluate(&card.policy(), 50, 1, |_| true).unwrap();
    let host = evaluate(&mut card.policy(), &mut base.sibling(&whole).unwrap(), 50, 1, |_| true).unwrap();
    assert_eq!(evaluation.layouts.iter().map(|layout| layout.episodes).collect::<Vec<_>>(), [50, 50, 50]);
    for (a, b) in evaluation.layouts.iter().zip(&host.layouts) {
        let lengths = a.episode_length_s.zip(b.episode_length_s);
        assert!(lengths.is_some_and(|(a, b)| (a - b).abs() < 0.02 * b), "{lengths:?}");
    }
}

/// As [`training_on_the_card_goes_as_on_the_processor`], where episodes last several updates.
#[test]
fn episodes_that_last_to_the_time_limit_end_at_different_times_on_the_card_too() {
    let Some(gpu) = gpu() else { return };
    let mut task = task();
    ball(&mut task).radius = 1e-3.into();
    dwell_for(&mut task, 1.0);
    task.time_limit_s = 1.2;
    let model = task.embody(&builtin(&task.model).unwrap()).unwrap();
    let envs = EnvConfig { num_envs: 12, ..EnvConfig::default() };
    let config = PpoConfig { rollout_s: 0.2, exploring_starts: 0.0, ..config(12) };
    let mut trainer = Trainer::on_card(GpuEnv::new(&gpu, &model, &task, &envs).unwrap(), config, 1).unwrap();
    let episodes: Vec<u64> = (0..18).map(|_| trainer.update().unwrap().episodes.count).collect();
    assert_eq!(episodes[..5], [0; 5]);
    assert_eq!(episodes[5..], [2; 13]);
}

#[test]
fn training_on_the_card_improves() {
    let Some(gpu) = gpu() else { return };
    let envs = 256;
    let config = PpoConfig {
        num_envs: envs,
        exploring_starts: 0.0,
        rollout_s: 0.8,
        policy_hidden: vec![32, 32],
        value_hidden: vec![32],
        ..PpoConfig::default()
    };
    // All from the first target on, lest the reward tell of where episodes begin.
    let whole = EnvConfig { num_envs: envs, ..EnvConfig::default() };
    let mut trainer = Trainer::on_card(env(&gpu, 1).sibling(&whole).unwrap(), config, 2).unwrap();
    let rewards: Vec<f64> = (0..16).map(|_| trainer.update().unwrap().reward_per_step).collect();
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    assert!(mean(&rewards[12..]) > mean(&rewards[..4]) + 0.05, "{rewards:?}");
}

#[test]
fn evaluation_on_the_card_is_that_of_the_processor() {
    let Some(gpu) = gpu() else { return };
    let mut trainer = Trainer::on_card(env(&gpu, 64), config(64), 1).unwrap();
    let whole = EnvConfig { num_envs: 37, seed: 5, ..EnvConfig::default() };
    let base = env(&gpu, 64);
    let mut host_env = base.sibling(&whole).unwrap();
    let mut evaluator = DeviceEvaluator::new(base.sibling(&whole).unwrap(), &trainer.policy()).unwrap();
    for seed in [1, 2] {
        trainer.update().unwrap();
        let card = evaluator.evaluate(&trainer.policy(), 100, seed, |_| true).unwrap();
        let host = evaluate(&mut trainer.policy(), &mut host_env, 100, seed, |_| true).unwrap();
        assert!(card.success.is_some_and(|success| success > 0.0 && success < 1.0), "{card:?}");
        // Rounding may decide about an episode at the edge.
        for (what, a, b) in [
            ("success", card.success, host.success),
            ("effort", card.effort, host.effort),
            ("fatigue", card.fatigue, host.fatigue),
            ("length", card.episode_length_s, host.episode_length_s),
            ("return", card.episode_return, host.episode_return),
        ] {
            assert!(a.zip(b).is_some_and(|(a, b)| (a - b).abs() <= 0.011 * b.abs().max(1.0)), "{what}: {a:?}, {b:?}");
        }
        assert_eq!((card.episodes, card.targets.len()), (100, host.targets.len()));
    }
    let other = PpoConfig { policy_hidden: vec![8], ..config(64) };
    let other = Trainer::on_card(env(&gpu, 64), other, 1).unwrap().policy();
    let error = DeviceEvaluator::new(env(&gpu, 64), &trainer.policy()).err().unwrap().to_string();
    assert!(error.contains("the number of environments that explore"), "{error}");
    let error = evaluator.evaluate(&other, 1, 1, |_| true).unwrap_err();
    assert!(matches!(error, TrainError::Mismatch { what: "the kind of the policy", .. }), "{error}");
}
