//! The built `myo` program, run as a user runs it.

mod bench;
mod compare;
mod damage;
mod eval;
mod export;
mod help;
mod measure;
mod model;
mod output;
mod protocol;
mod resume;
mod runs;
mod seeds;
mod shell;
mod task;
mod together;
mod train;

use std::path::Path;
use std::process::{Command, Output, Stdio};

use myo::train::Checkpoint;
use serde_json::Value;

fn myo(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
    command.args(args).current_dir(folder).output().expect("the program starts")
}

fn here(args: &[&str]) -> Output {
    myo(Path::new("."), args)
}

fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", stderr(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(output: &Output) -> Value {
    serde_json::from_str(&stdout(output)).unwrap()
}

/// Fails with a sentence and the status for failures, not that for wrong usage or a panic.
fn assert_refused(output: &Output, sentence: &str) {
    assert_eq!(output.status.code(), Some(1), "{}", stderr(output));
    assert!(stderr(output).contains(sentence), "{}", stderr(output));
}

/// Arguments of a training of `updates` updates of 512 control steps each.
fn short_training<'a>(steps: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let fixed = ["train", "pointing-single", "--until", "off", "--envs", "32", "--steps", steps];
    let small = ["--set", "rollout_s=0.8", "--set", "policy_hidden=[16]", "--set", "value_hidden=[16]"];
    [&fixed[..], &small, more].concat()
}

/// The caller's part of the `config.json` of a run.
fn description(run: &Path) -> Value {
    myo::train::RunFolder::open(run).unwrap().config().run.clone()
}

fn newest_checkpoint(run: &Path) -> Checkpoint {
    let folder = myo::train::RunFolder::open(run).unwrap();
    let mut checkpoint = folder.latest_checkpoint().unwrap().checkpoint.expect("a whole checkpoint");
    checkpoint.forget_wall_time();
    checkpoint
}

/// Starts a training or goes on with one, presses Ctrl-C when `run` has two more updates, and gives back what it wrote.
#[cfg(unix)]
fn interrupt(folder: &Path, args: &[&str], run: &str) -> Output {
    let metrics = folder.join(run).join("metrics.csv");
    let rows = || std::fs::read_to_string(&metrics).unwrap_or_default().lines().count();
    // One line is the heading.
    let before = rows().max(1);
    let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
    let training = command.args(args).current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = training.spawn().unwrap();
    while rows() < before + 2 {
        assert!(child.try_wait().unwrap().is_none(), "the training goes on");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    output
}
