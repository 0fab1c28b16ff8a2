//! Trainings of several groups beside the same trainings with a card of their own.

use myo_gpu::Gpu;

use super::testing::gpu;
use super::tests::{config, env};
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
    for (member, (metrics, saved, policy)) in got.into_iter().enumerate() {
        let alone = Trainer::on_card(env(&gpu, 37), config.clone(), seeds[member]).unwrap();
        let expected = train(member, alone);
        assert_eq!(metrics, expected.0, "member {member}");
        assert!(saved == expected.1, "member {member}");
        assert_eq!(policy.parameters, expected.2.parameters, "member {member}");
    }
}

#[test]
fn one_of_several_resumes_and_goes_back_as_it_does_alone() {
    let Some(gpu) = gpu() else { return };
    let config = config(16);
    let mut first = Trainer::on_card(env(&gpu, 16), config.clone(), 1).unwrap();
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
    let alone = [
        Trainer::restore_on_card(env(&gpu, 16), &saved).unwrap(),
        Trainer::on_card(env(&gpu, 16), config.clone(), 7).unwrap(),
    ];
    for (member, ((halfway, end), trainer)) in got.iter().zip(alone).enumerate() {
        let expected = train(member, trainer);
        assert!(bytes(halfway.clone()) == bytes(expected.0), "member {member} halfway");
        assert!(*end == expected.1, "member {member}");
        // Each goes on alone from its own checkpoint.
        let mut resumed = Trainer::restore_on_card(env(&gpu, 16), halfway).unwrap();
        resumed.update().unwrap();
        assert!(*end == bytes(resumed.save().unwrap()), "member {member} resumed alone");
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
    let other = PpoConfig { gae_lambda: 0.5, ..config.clone() };
    assert_eq!(refused(&[new(&config), new(&other)]), "the settings of trainings on one card");
    let error = Trainer::on_card(env(&groups, 8), config.clone(), 1).err().unwrap();
    assert!(matches!(error, TrainError::Mismatch { what: "the number of trainings", .. }), "{error}");
    // Another step size makes no other kernels.
    let slower = PpoConfig { learning_rate: 1e-5, learning_rate_max: 1e-4, ..config.clone() };
    assert_eq!(Trainer::several_on_card(env(&groups, 8), &[new(&config), new(&slower)]).unwrap().len(), 2);
}
