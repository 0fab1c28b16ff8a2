//! Users who are trained at once, on one card.

use super::left::Left;
use super::scene::{Fault, Scene, TASK, software_card};

/// Three users of whom one or two are done after a first look at them, and the others after eight updates; how they end.
fn of_different_length(card: &str) -> (Scene, (Left, Vec<String>)) {
    let train = |seed: u64| {
        let seed = seed.to_string();
        let fixed = ["--until", "0.06", "--steps", "1024", "--seeds", "3", "--seed", &seed];
        let on_card = ["--backend", "gpu", "--device", card, "--set", "epochs=1", "--set", "minibatches=1"];
        let scene = Scene::of(TASK, [8, 16], &[fixed, on_card].concat());
        let undisturbed = scene.undisturbed();
        (scene, undisturbed)
    };
    let differ = |(_, (left, _)): &(Scene, (Left, Vec<String>))| {
        let updates = left.updates();
        updates.contains(&8) && updates.iter().any(|updates| *updates <= 2)
    };
    (4..40).step_by(3).map(train).find(differ).expect("users of different length")
}

#[test]
fn users_who_are_trained_at_once_and_stopped_at_any_file_operation_end_as_ones_left_alone() {
    let Some(card) = software_card() else {
        println!("skipped: there is no driver that computes a graphics card on the processor");
        return;
    };
    let (mut scene, undisturbed) = of_different_length(&card);
    scene.faults = vec![(Fault::Kill, 3)];
    let told = scene.check_against(&undisturbed);
    let done = |told: &String| told.lines().filter(|line| line.ends_with(" is done")).count();
    assert!(told.iter().any(|told| (1..3).contains(&done(told))), "one was done, and others were not: {told:?}");
    // No torn writes: the order of operations of several users does not repeat, so that it may be another than a write.
    scene.faults = vec![(Fault::Eio, 1), (Fault::Enospc, 1)];
    scene.check_against(&undisturbed);
}
