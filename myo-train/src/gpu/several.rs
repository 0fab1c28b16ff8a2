//! Trainings of several groups beside the same trainings with a card of their own.

use std::sync::Mutex;

use myo_env::{EnvConfig, GpuEnv};
use myo_gpu::Gpu;
use myo_tasks::Task;

use super::DeviceEvaluator;
use super::testing::gpu;
use super::tests::{config, env, envs, other_task, task};
use crate::{Checkpoint, Member, PpoConfig, TrainError, Trainer};

fn bytes(mut checkpoint: Checkpoint) -> Vec<u8> {
    checkpoint.forget_wall_time();
    checkpoint.to_bytes()
}

/// What becomes of each training in a thread of its own.
fn at_once<T: Send>(trainers: Vec<Trainer>, train: impl Fn(usize, Trainer) -> T + Sync) -> Vec<T> {
    let train = &train;
    std::thread::scope(|scope| {
        let start = |(member, trainer)| scope.spawn(move || train(member, trainer));
        let threads: Vec<_> = trainers.into_iter().enumerate().map(start).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

/// With the kernels of an environment without groups, compiled once for all that are alone.
fn alone(base: &GpuEnv, config: &PpoConfig, seed: u64) -> Trainer {
    Trainer::on_card(base.sibling(&envs(config.num_envs)).unwrap(), config.clone(), seed).unwrap()
}

fn several(gpu: &Gpu, envs: usize, members: &[Member<'_>]) -> Vec<Trainer> {
    Trainer::several_on_card(env(&gpu.in_groups(members.len()).unwrap(), envs), members).unwrap()
}

#[test]
fn several_trainings_come_to_the_bits_of_each_alone_however_long_they_last() {
    let Some(gpu) = gpu() else { return };
    // Idle columns, and several minibatches of which the last is smaller.
    let config = PpoConfig { epochs: 2, minibatches: 3, ..config(37) };
    let (seeds, updates) = ([4, 1 << 33, 5], [1, 4, 3]);
    let members = seeds.map(|seed| Member::New { config: &config, seed });
    let train = |member: usize, mut trainer: Trainer| {
        let metrics: Vec<_> = (0..updates[member]).map(|_| trainer.update().unwrap().learn).collect();
        (metrics, bytes(trainer.save().unwrap()), trainer.policy())
    };
    let got = at_once(several(&gpu, 37, &members), train);
    let base = env(&gpu, 37);
    for (member, (metrics, saved, policy)) in got.into_iter().enumerate() {
        let expected = train(member, alone(&base, &config, seeds[member]));
        assert_eq!(metrics, expected.0, "member {member}");
        assert!(saved == expected.1, "member {member}");
        assert_eq!(policy.parameters, expected.2.parameters, "member {member}");
    }
}

#[test]
fn one_of_several_resumes_and_goes_back_as_it_does_alone() {
    let Some(gpu) = gpu() else { return };
    let config = config(16);
    let base = env(&gpu, 16);
    let sibling = || base.sibling(&envs(16)).unwrap();
    let mut first = alone(&base, &config, 1);
    first.update().unwrap();
    let saved = first.save().unwrap();
    let train = |member: usize, mut trainer: Trainer| {
        trainer.update().unwrap();
        if member == 0 {
            // With other step sizes, and other episodes.
            trainer.go_back(&saved, 0.5).unwrap();
            trainer.go_back(&Checkpoint { env_state: Vec::new(), ..saved.clone() }, 0.5).unwrap();
        }
        trainer.update().unwrap();
        let halfway = trainer.save().unwrap();
        trainer.update().unwrap();
        (halfway, bytes(trainer.save().unwrap()))
    };
    let members = [Member::Resumed(&saved), Member::New { config: &config, seed: 7 }];
    let got = at_once(several(&gpu, 16, &members), train);
    let both = [Trainer::restore_on_card(sibling(), &saved).unwrap(), alone(&base, &config, 7)];
    for (member, ((halfway, end), trainer)) in got.iter().zip(both).enumerate() {
        let expected = train(member, trainer);
        assert!(bytes(halfway.clone()) == bytes(expected.0), "member {member} halfway");
        assert!(*end == expected.1, "member {member}");
        // Each goes on alone from its own checkpoint.
        let mut resumed = Trainer::restore_on_card(sibling(), halfway).unwrap();
        resumed.update().unwrap();
        assert!(*end == bytes(resumed.save().unwrap()), "member {member} resumed alone");
    }
}

#[test]
fn one_that_runs_away_leaves_the_others_alone_and_goes_on_from_an_earlier_state() {
    let Some(gpu) = gpu() else { return };
    let (config, base) = (config(8), env(&gpu, 8));
    let mut first = alone(&base, &config, 1);
    first.update().unwrap();
    let good = first.save().unwrap();
    let mut sick = good.clone();
    sick.parameters.fill(f32::NAN);
    let train = |member: usize, mut trainer: Trainer| {
        if member == 0 {
            trainer.go_back(&sick, 1.0).unwrap();
            let error = trainer.update().unwrap_err();
            assert!(matches!(error, TrainError::NonFiniteEnv { .. } | TrainError::Diverged { .. }), "{error}");
            trainer.go_back(&good, 1.0).unwrap();
        } else {
            trainer.update().unwrap();
        }
        trainer.update().unwrap();
        bytes(trainer.save().unwrap())
    };
    let members = [Member::Resumed(&good), Member::New { config: &config, seed: 7 }];
    let got = at_once(several(&gpu, 8, &members), train);
    first.update().unwrap();
    assert!(got[0] == bytes(first.save().unwrap()), "as if it had never run away");
    assert!(got[1] == train(1, alone(&base, &config, 7)), "the other");
}

#[test]
fn policies_of_several_are_evaluated_at_once_as_each_is_alone() {
    let Some(gpu) = gpu() else { return };
    let (config, seeds) = (config(8), [3, 4]);
    let base = env(&gpu, 8);
    let looked_at = EnvConfig { num_envs: 16, ..EnvConfig::default() };
    let look = |member: usize, mut trainer: Trainer, mut evaluator: DeviceEvaluator| {
        // Looks of different length, and an update of one while the other is still looking.
        let first = evaluator.evaluate(&trainer.policy(), 20 + 300 * member, 5, |_| true).unwrap();
        trainer.update().unwrap();
        let second = evaluator.evaluate(&trainer.policy(), 50, 6, |_| true).unwrap();
        (first, second, bytes(trainer.save().unwrap()))
    };
    let groups = env(&gpu.in_groups(2).unwrap(), 8);
    let looks = groups.sibling(&looked_at).unwrap();
    let trainers = Trainer::several_on_card(groups, &seeds.map(|seed| Member::New { config: &config, seed })).unwrap();
    let evaluators = DeviceEvaluator::several(looks, &trainers).unwrap();
    let evaluators: Vec<_> = evaluators.into_iter().map(|evaluator| Mutex::new(Some(evaluator))).collect();
    let got = at_once(trainers, |member, trainer| {
        let evaluator = evaluators[member].lock().unwrap().take().unwrap();
        look(member, trainer, evaluator)
    });
    for (member, got) in got.into_iter().enumerate() {
        let trainer = alone(&base, &config, seeds[member]);
        let evaluator = DeviceEvaluator::new(base.sibling(&looked_at).unwrap(), &trainer.policy()).unwrap();
        assert!(got == look(member, trainer, evaluator), "member {member}");
    }
}

#[test]
fn trainings_that_do_not_fit_each_other_are_refused() {
    let Some(gpu) = gpu() else { return };
    let (config, groups) = (config(8), gpu.in_groups(2).unwrap());
    let new = |config| Member::New { config, seed: 1 };
    let refused = |members: &[Member<'_>]| {
        let error = Trainer::several_on_card(env(&groups, 8), members).err().unwrap();
        let TrainError::Mismatch { what, .. } = error else { panic!("{error}") };
        what
    };
    assert_eq!(refused(&[new(&config)]), "the number of trainings");
    let other = PpoConfig { gae_lambda_per_s: 0.5, ..config.clone() };
    assert_eq!(refused(&[new(&config), new(&other)]), "the settings of trainings on one card");
    let error = Trainer::on_card(env(&groups, 8), config.clone(), 1).err().unwrap();
    assert!(matches!(error, TrainError::Mismatch { what: "the number of trainings", .. }), "{error}");
    // Another step size makes no other kernels.
    let slower = PpoConfig { learning_rate: 1e-5, learning_rate_max: 1e-4, ..config.clone() };
    assert_eq!(Trainer::several_on_card(env(&groups, 8), &[new(&config), new(&slower)]).unwrap().len(), 2);
}

#[test]
fn every_group_may_have_a_task_of_its_own() {
    let Some(gpu) = gpu() else { return };
    let config = config(24);
    let tasks = [task(), other_task()];
    let train = |mut trainer: Trainer, task: &Task| {
        trainer.set_task(task).unwrap();
        (0..3).for_each(|_| drop(trainer.update().unwrap()));
        bytes(trainer.save().unwrap())
    };
    let several = gpu.in_groups(2).unwrap();
    let members = [1, 2].map(|seed| Member::New { config: &config, seed });
    let trainers = Trainer::several_on_card(env(&several, 24), &members).unwrap();
    let got = at_once(trainers, |member, trainer| train(trainer, &tasks[member]));
    let base = env(&gpu, 24);
    for (member, (got, seed)) in got.into_iter().zip([1, 2]).enumerate() {
        assert!(got == train(alone(&base, &config, seed), &tasks[member]), "member {member}");
    }
}
