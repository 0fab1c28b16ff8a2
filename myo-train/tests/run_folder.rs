//! What a run leaves behind, and what damage does to it.

mod common;

use std::fs;
use std::path::Path;

use common::Points;
use myo_env::VectorEnv;
use myo_train::{Checkpoint, Evaluation, PpoConfig, RunFolder, RunWriter, Trainer, evaluate};

fn config() -> PpoConfig {
    PpoConfig {
        num_envs: 32,
        policy_hidden: vec![16],
        value_hidden: vec![16],
        action_offset: 0.0,
        action_scale: 1.0,
        ..PpoConfig::default()
    }
}

fn points() -> Box<dyn VectorEnv> {
    Box::new(Points::new(32))
}

fn start(path: &Path) -> (Trainer, RunWriter) {
    let trainer = Trainer::new(points(), config(), 7).unwrap();
    let run =
        RunWriter::create(path, serde_json::json!({"task": "points"}), &config(), 7, &trainer.spec().episode_names);
    (trainer, run.unwrap())
}

fn train(trainer: &mut Trainer, run: &mut RunWriter, updates: usize, checkpoint_every: u64) {
    for _ in 0..updates {
        run.record(&trainer.update().unwrap()).unwrap();
        if trainer.updates().is_multiple_of(checkpoint_every) {
            run.write_checkpoint(&trainer.save()).unwrap();
        }
    }
}

fn resume(path: &Path) -> (Trainer, RunWriter) {
    let latest = RunFolder::open(path).unwrap().latest_checkpoint();
    let checkpoint = latest.checkpoint.expect("there is a whole checkpoint");
    let trainer = Trainer::restore(points(), &checkpoint).unwrap();
    let run = RunWriter::resume(path, checkpoint.env_steps(), &trainer.spec().episode_names).unwrap();
    (trainer, run)
}

/// The metrics without the columns that hold times.
fn metrics(path: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path.join("metrics.csv")).unwrap();
    let rows: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(String::from).collect()).collect();
    let keep: Vec<bool> = rows[0].iter().map(|name| !name.ends_with("_s")).collect();
    rows.iter().map(|row| row.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(x, _)| x.clone()).collect()).collect()
}

#[test]
fn a_killed_and_resumed_run_ends_with_the_same_metrics_and_weights() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    let (mut trainer, mut run) = start(&whole);
    train(&mut trainer, &mut run, 7, 2);
    let mut expected = trainer.save();

    let (mut trainer, mut run) = start(&broken);
    train(&mut trainer, &mut run, 5, 2);
    drop((trainer, run));
    // As a process killed while it writes would leave it.
    let mut text = fs::read_to_string(broken.join("metrics.csv")).unwrap();
    text.push_str("2560,6,0.3");
    fs::write(broken.join("metrics.csv"), text).unwrap();
    fs::write(broken.join("checkpoints/step_000000003072.ckpt.part"), "half").unwrap();

    let (mut trainer, mut run) = resume(&broken);
    assert_eq!(trainer.updates(), 4);
    train(&mut trainer, &mut run, 3, 2);
    let mut got = trainer.save();
    expected.forget_wall_time();
    got.forget_wall_time();
    assert!(expected.to_bytes() == got.to_bytes());
    assert_eq!(metrics(&whole), metrics(&broken));
    assert_eq!(metrics(&whole).len(), 8);
}

#[test]
fn a_folder_that_exists_is_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    drop(start(&path));
    fs::create_dir(folder.path().join("run-2")).unwrap();
    let error = RunWriter::create(&path, serde_json::Value::Null, &config(), 1, &[]).unwrap_err().to_string();
    assert!(error.contains("run exists already"), "{error}");
    assert!(error.ends_with("run-3"), "{error}");
    let error = RunFolder::open(folder.path()).unwrap_err().to_string();
    assert!(error.ends_with("is not a run folder: it has no config.json"), "{error}");
}

#[test]
fn two_trainings_in_one_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (_trainer, _run) = start(&path);
    let error = RunWriter::resume(&path, 0, &[]).unwrap_err().to_string();
    assert!(error.starts_with("another process is training in"), "{error}");
}

#[test]
fn a_damaged_checkpoint_is_refused_and_the_previous_one_used() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 5, 1);
    drop((trainer, run));
    let run = RunFolder::open(&path).unwrap();
    let files = run.checkpoints();
    assert_eq!(files.len(), 3, "the last three are kept");
    let mut bytes = fs::read(&files[0]).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&files[0], &bytes).unwrap();
    fs::write(&files[1], &fs::read(&files[1]).unwrap()[..500]).unwrap();

    let latest = run.latest_checkpoint();
    assert_eq!(latest.checkpoint.unwrap().updates(), 3);
    let reasons: Vec<String> = latest.refused.iter().map(|(_, error)| error.to_string()).collect();
    assert!(reasons[0].starts_with("the checkpoint is damaged: its checksum is"), "{}", reasons[0]);
    assert!(reasons[1].starts_with("the checkpoint is 500 bytes long, but should be"), "{}", reasons[1]);

    let (mut trainer, mut run) = resume(&path);
    train(&mut trainer, &mut run, 1, 1);
    assert_eq!(metrics(&path).len(), 5);
    assert_eq!(run.folder().latest_checkpoint().checkpoint.unwrap().updates(), 4);
}

#[test]
fn no_damage_to_a_checkpoint_goes_unnoticed_or_panics() {
    let mut trainer = Trainer::new(points(), config(), 7).unwrap();
    trainer.update().unwrap();
    let bytes = trainer.save().to_bytes();
    assert_eq!(Checkpoint::from_bytes(&bytes).unwrap(), trainer.save());
    for i in (0..bytes.len()).step_by(97).chain(0..24) {
        let mut bytes = bytes.clone();
        bytes[i] ^= 0x10;
        assert!(Checkpoint::from_bytes(&bytes).is_err(), "byte {i}");
        assert!(Checkpoint::from_bytes(&bytes[..i]).is_err(), "cut at {i}");
    }
    let mut version = bytes.clone();
    version[8] = 9;
    let error = Checkpoint::from_bytes(&version).unwrap_err().to_string();
    assert_eq!(error, "the checkpoint has format 9; this program reads format 1");
}

#[test]
fn evaluation_counts_equally_many_episodes_of_every_environment() {
    let trainer = Trainer::new(points(), config(), 7).unwrap();
    let run = |episodes| {
        let mut calls = 0;
        let evaluation = evaluate(&mut trainer.policy(), points().as_mut(), episodes, 5, |_| {
            calls += 1;
            true
        });
        assert!(calls > 0);
        evaluation.unwrap()
    };
    let evaluation = run(80);
    assert_eq!(evaluation.episodes, 80);
    assert_eq!(evaluation, run(80), "the same seed gives the same evaluation");
    let [low, high] = evaluation.success_interval.unwrap();
    assert!(low <= evaluation.success.unwrap() && evaluation.success.unwrap() <= high);
    assert_eq!(evaluation.targets.len(), 2);
    assert!(evaluation.targets[0].success >= evaluation.targets[1].success);

    let json: serde_json::Value = serde_json::to_value(&evaluation).unwrap();
    let mut keys: Vec<_> = json.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    let expected = [
        "effort",
        "episode_length_s",
        "episodes",
        "final_distance_m",
        "return",
        "success",
        "success_interval",
        "targets",
    ];
    assert_eq!(keys, expected);
    let mut keys: Vec<_> = json["targets"][0].as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    assert_eq!(keys, ["movement_time_s", "movement_time_s_sd", "success"]);

    let folder = tempfile::tempdir().unwrap();
    let (_, run) = start(&folder.path().join("run"));
    run.folder().write_evaluation(&evaluation).unwrap();
    let text = fs::read(folder.path().join("run/evaluation.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Evaluation>(&text).unwrap(), evaluation);
}
