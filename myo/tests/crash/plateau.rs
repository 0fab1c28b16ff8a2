//! Trainings that end because nothing improves any more.

use super::scene::Scene;

/// Done by staying where the arm hangs, by one physics step per decision: success and return of all episodes are the
/// same from the start, so that training ends as soon as a plateau can be told.
const SETTLED: &str = "\
version: 1
name: settled
targets:
  - kind: pointing
    position: {x: 0, y: 0, z: -0.6}
    radius: 0.5
    dwell_s: 0.02
control_dt_s: 0.002
time_limit_s: 0.04
reset: {pose: zero}
reward: {effort_cost: 0}
";

/// Operations of the last updates and of the end.
const LAST: usize = 60;

/// Control steps that a training may take, far more than to a plateau.
const STEPS: u64 = 100_000_000;

/// Environments, and steps of each per update.
const UPDATE: [usize; 2] = [512, 64];

/// A training that ends at a plateau, with updates that take no time.
fn settled() -> Scene {
    let small = ["--set", "epochs=1", "--set", "minibatches=1"];
    Scene::of(SETTLED, UPDATE, &[&["--until", "plateau", "--steps", &STEPS.to_string()], &small[..]].concat()).sample(3)
}

#[test]
fn a_training_that_is_stopped_at_any_file_operation_before_its_plateau_ends_as_one_left_alone() {
    let scene = settled().begun(|operations| operations - LAST);
    let undisturbed = scene.undisturbed();
    let steps = (undisturbed.0.updates()[0] * UPDATE[0] * UPDATE[1]) as u64;
    assert!(steps < STEPS / 10, "{steps} control steps: it did not end at a plateau");
    scene.check_against(&undisturbed);
}

#[test]
fn a_training_of_few_small_updates_may_be_stopped_at_any_file_operation_on_its_way_to_a_plateau() {
    Scene::of(SETTLED, [32, 64], &["--until", "plateau", "--steps", &STEPS.to_string()]).sample(3).check_all();
}

#[test]
fn going_on_from_a_plateau_may_be_stopped_at_any_file_operation() {
    settled().further(4 * (UPDATE[0] * UPDATE[1]) as u64).check_all();
}
