//! Trainings that are stopped and gone on with.

use std::path::Path;
use std::process::{Command, Output};

use crate::{assert_refused, description, interrupt, myo, newest_checkpoint, short_training, stderr, stdout};

#[test]
fn resumed_and_threaded_trainings_end_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let train = |steps: &'static str, more: &[&str]| stdout(&myo(folder.path(), &short_training(steps, more)));
    train("2k", &["--out", "whole", "--threads", "2"]);
    train("1k", &["--out", "parts", "--threads", "1"]);
    let again = myo(folder.path(), &["train", "--resume", "parts"]);
    assert_refused(&again, "raise it with --steps");
    stdout(&myo(folder.path(), &["train", "--resume", "parts", "--steps", "2k"]));
    assert!(newest_checkpoint(&folder.path().join("whole")) == newest_checkpoint(&folder.path().join("parts")));
    let steps = |run: &str| {
        let metrics = std::fs::read_to_string(folder.path().join(run).join("metrics.csv")).unwrap();
        metrics.lines().filter_map(|line| Some(line.split_once(',')?.0.to_owned())).collect::<Vec<_>>()
    };
    assert_eq!(steps("whole"), steps("parts"));
}

#[cfg(unix)]
#[test]
fn a_new_goal_is_kept_when_a_run_is_stopped_again() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let before = description(&run);
    let refused = myo(folder.path(), &["train", "--resume", "run", "--until", "0.9"]);
    assert_refused(&refused, "its limit is 512; raise it with --steps");
    assert_eq!(description(&run), before, "what is refused changes nothing");

    interrupt(folder.path(), &["train", "--resume", "run", "--steps", "1G", "--until", "1"], "run");
    let mut expected = before;
    (expected["steps"], expected["until"]) = (1_000_000_000.into(), 1.0.into());
    assert_eq!(description(&run), expected);
    interrupt(folder.path(), &["train", "--resume", "run"], "run");
}

#[test]
fn a_warm_start_that_was_stopped_before_its_first_checkpoint_begins_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = |path: &str| folder.path().join(path);
    stdout(&myo(folder.path(), &short_training("1k", &["--out", "first"])));
    stdout(&myo(folder.path(), &short_training("512", &["--out", "warm", "--from", "first"])));
    let (whole, config) = (newest_checkpoint(&at("warm")), std::fs::read_to_string(at("warm/config.json")).unwrap());
    let resume = |from: &str| {
        std::fs::remove_dir_all(at("warm/checkpoints")).unwrap();
        let from = config.replace("\"run\": \"first\"", &format!("\"run\": \"{from}\""));
        std::fs::write(at("warm/config.json"), from).unwrap();
        myo(folder.path(), &["train", "--resume", "warm"])
    };
    let file = "first/checkpoints/step_000000001024.ckpt";
    for from in ["first", file] {
        stdout(&resume(from));
        assert!(newest_checkpoint(&at("warm")) == whole, "{from}");
    }
    std::fs::create_dir_all(at("warm/checkpoints")).unwrap();
    stdout(&myo(folder.path(), &["train", "--resume", "first", "--steps", "2k"]));
    assert_refused(&resume("first"), "to begin from first after 1024 control steps, and was stopped before it did");
}

#[cfg(unix)]
#[test]
fn interrupted_training_stops_with_a_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let output = interrupt(folder.path(), &short_training("1G", &["--out", "run"]), "run");
    assert!(String::from_utf8_lossy(&output.stdout).contains("train --resume run"));
    assert!(newest_checkpoint(&folder.path().join("run")).updates() >= 2);
}

/// Runs the command behind `next: ` in a shell, as a user who copies it.
#[cfg(unix)]
fn run_next(folder: &Path, told: &Output) -> Output {
    let told = String::from_utf8(told.stdout.clone()).unwrap();
    let next = told.lines().find_map(|line| line.strip_prefix("next: ")).expect("what to do next is told");
    Command::new("sh").args(["-c", next]).current_dir(folder).output().unwrap()
}

#[cfg(unix)]
#[test]
fn commands_that_are_told_can_be_copied() {
    for run in ["it's my $HOME; `reboot` *&|<>\\\"", "-x"] {
        let folder = tempfile::tempdir().unwrap();
        let out = format!("--out={run}");
        let trained = myo(folder.path(), &short_training("512", &[&out]));
        assert!(trained.status.success(), "{run}: {}", stderr(&trained));
        let evaluated = stdout(&run_next(folder.path(), &trained));
        assert!(evaluated.contains("of 10,000 fresh episodes"), "{run}: {evaluated}");
    }
    let folder = tempfile::tempdir().unwrap();
    let stopped = interrupt(folder.path(), &short_training("64k", &["--out", "my run"]), "my run");
    stdout(&run_next(folder.path(), &stopped));
    assert_eq!(newest_checkpoint(&folder.path().join("my run")).env_steps(), 64_000_u64.next_multiple_of(512));
}
