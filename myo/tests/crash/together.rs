//! Users who are trained at once, on one card, and killed.

use super::scene::{Fault, Scene, TASK, software_card};

/// Three users of whom one or two are done after a first look at them, and the others after eight updates.
fn of_different_length(card: &str) -> Scene {
    let train = |seed: u64| {
        let seed = seed.to_string();
        let fixed = ["--until", "0.06", "--steps", "4096", "--seeds", "3", "--seed", &seed];
        Scene::of(TASK, 8, &[&fixed[..], &["--backend", "gpu", "--device", card]].concat())
    };
    let differ = |scene: &Scene| {
        let (left, _) = scene.undisturbed();
        let mut updates = left.updates();
        updates.sort_unstable();
        updates[0] <= 2 && updates[2] == 8
    };
    (4..40).step_by(3).map(train).find(differ).expect("users of different length")
}

#[test]
fn users_who_are_trained_at_once_and_killed_end_as_ones_left_alone() {
    let Some(card) = software_card() else {
        println!("skipped: there is no driver that computes a graphics card on the processor");
        return;
    };
    let mut scene = of_different_length(&card);
    // Threads of several users: which of them an operation is of is not the same every time.
    scene.faults = vec![(Fault::Kill, 4)];
    let told = scene.check_all();
    let done = |told: &String| told.lines().filter(|line| line.ends_with(" is done")).count();
    assert!(told.iter().any(|told| (1..3).contains(&done(told))), "one was done, and others were not: {told:?}");
}
