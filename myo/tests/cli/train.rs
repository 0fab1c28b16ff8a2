//! `myo train`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::{assert_refused, here, json, myo, short_training, stderr, stdout};

#[test]
fn training_leaves_a_run_that_can_be_evaluated() {
    let folder = tempfile::tempdir().unwrap();
    let result = json(&myo(folder.path(), &short_training("3k", &["--json", "--seed", "3"])));
    assert_eq!((&result["run"], &result["stopped_by"]), (&"runs/pointing-single-1".into(), &"steps".into()));
    assert_eq!((&result["env_steps"], &result["seed"]), (&3072.into(), &3.into()));
    assert_eq!(result["evaluation"]["episodes"], 1000);

    let run = folder.path().join("runs/pointing-single-1");
    for file in ["config.json", "metrics.csv", "evaluation.json", "tensorboard", "checkpoints"] {
        assert!(run.join(file).exists(), "{file}");
    }
    let metrics = std::fs::read_to_string(run.join("metrics.csv")).unwrap();
    assert_eq!(metrics.lines().count(), 1 + 6);
    let rows: Vec<Vec<&str>> = metrics.lines().map(|line| line.split(',').collect()).collect();
    // All environments that were not done before meet the time limit in the fifth update.
    let fifth = |name: &str| rows[5][rows[0].iter().position(|column| *column == name).expect(name)].parse::<f64>();
    assert!((1.0..1.5).contains(&fifth("solver_rounds").unwrap()), "{metrics}");
    assert_eq!(fifth("solver_unsolved"), Ok(0.0));
    let shown = stdout(&myo(folder.path(), &["task", "show", "runs/pointing-single-1"]));
    assert_eq!(myo::tasks::Task::from_yaml(&shown, "run").unwrap(), myo::tasks::preset("pointing-single").unwrap());

    let evaluate = |more: &[&str]| {
        let args = [&["eval", "runs/pointing-single-1", "--episodes", "20", "--json"], more].concat();
        json(&myo(folder.path(), &args))
    };
    let evaluation = evaluate(&[]);
    assert_eq!((&evaluation["episodes"], &evaluation["env_steps"]), (&20.into(), &3072.into()));
    let success = evaluation["success"].as_f64().unwrap();
    assert_eq!(evaluation["targets"][0]["success"].as_f64(), Some(success));
    for key in
        ["movement_time_s", "movement_time_s_sd", "movement_time_s_interval", "time_s", "time_s_sd", "time_s_interval"]
    {
        assert!(evaluation["targets"][0].as_object().unwrap().contains_key(key), "{key}");
    }
    for key in ["final_distance_m", "effort", "episode_length_s", "return"] {
        assert!(evaluation[key].is_f64(), "{key}");
    }
    assert_eq!(evaluation, evaluate(&[]), "same seed, same episodes");
    assert_ne!(evaluation["return"], evaluate(&["--seed", "5"])["return"]);
}

/// All files below a folder.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(contents(&path));
        } else {
            found.insert(path.clone(), std::fs::read(path).unwrap());
        }
    }
    found
}

#[test]
fn run_folders_are_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let train = |more: &[&str]| myo(folder.path(), &short_training("512", more));
    stdout(&train(&[]));
    stdout(&train(&[]));
    assert!(folder.path().join("runs/pointing-single-2").exists());
    let before = contents(&folder.path().join("runs/pointing-single-1"));
    assert!(before.len() >= 5, "{:?}", before.keys());
    assert_refused(&train(&["--out", "runs/pointing-single-1"]), "never overwritten");
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    std::fs::write(folder.path().join("mine/notes.txt"), "not a run").unwrap();
    assert_refused(&train(&["--out", "mine"]), "mine-2");
    assert!(contents(&folder.path().join("runs/pointing-single-1")) == before, "a file of the run has changed");
    let mine: Vec<_> = contents(&folder.path().join("mine")).into_iter().collect();
    assert_eq!(mine, [(folder.path().join("mine/notes.txt"), b"not a run".to_vec())]);
}

#[test]
fn runs_are_called_like_the_file_of_their_task() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("tasks")).unwrap();
    let text = stdout(&here(&["task", "show", "pointing-single"]));
    std::fs::write(folder.path().join("tasks/my.yaml"), text).unwrap();
    let args = ["train", "tasks/my.yaml", "--envs", "8", "--steps", "64", "--until", "off", "--json"];
    assert_eq!(json(&myo(folder.path(), &args))["run"], "runs/my-1");
    let several = json(&myo(folder.path(), &[&args[..], &["--seeds", "1"]].concat()));
    assert_eq!((&several["folder"], &several["runs"][0]["run"]), (&"runs/my-2".into(), &"runs/my-2/seed-1".into()));
    let hint = "runs/my-2 holds the runs of several seeds; name one of them, such as runs/my-2/seed-1";
    assert_refused(&myo(folder.path(), &["eval", "runs/my-2"]), hint);
    assert_refused(&myo(folder.path(), &["train", "ar", "--from", "runs/my-2"]), hint);
}

#[test]
fn a_run_may_begin_with_what_another_learned() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("2k", &["--out", "first"])));
    // Other targets, more of them, another body, and the networks of the first run without being told.
    let warm = ["train", "public-display", "--from", "first", "--out", "second", "--until", "off"];
    let short = ["--envs", "32", "--steps", "512"];
    let output = myo(folder.path(), &[&warm[..], &short].concat());
    stdout(&output);
    assert!(stderr(&output).contains("starting from first after 2,048 control steps"), "{}", stderr(&output));
    let config: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("second/config.json")).unwrap()).unwrap();
    assert_eq!(config["run"]["from"], serde_json::json!({"run": "first", "env_steps": 2048}));
    assert_eq!(config["ppo"]["policy_hidden"], serde_json::json!([16]));
    // Both checkpoints are there: what was inherited, and the end.
    let checkpoints = myo::train::RunFolder::open(&folder.path().join("second")).unwrap().checkpoints().unwrap();
    assert_eq!(checkpoints.len(), 2);

    let refused = |args: &[&str], sentence| assert_refused(&myo(folder.path(), args), sentence);
    refused(&["train", "ar", "--from", "nowhere"], "nowhere is not a run folder");
    refused(&["train", "ar", "--from", "first", "--set", "policy_hidden=[8]"], "width of the hidden layers");
    assert!(!folder.path().join("runs").exists(), "nothing is left of what was refused");
}

#[test]
fn a_goal_beyond_what_the_task_allows_is_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let far = "version: 1\nname: far\ntargets:\n- kind: pointing\n  position: {x: [0.5, 0.8], y: 0, z: 0}\n  radius: 0.02\n  dwell_s: 0.05\n";
    std::fs::write(folder.path().join("far.yaml"), far).unwrap();
    let train = |until| {
        let args = ["train", "far.yaml", "--envs", "8", "--steps", "64", "--until", until];
        stderr(&myo(folder.path(), &args))
    };
    assert!(
        train("0.95").contains("% of the episodes can succeed, since targets lie out of reach, and the goal is 95.0 %")
    );
    assert!(!train("off").contains("of the episodes can succeed"));
}

#[test]
fn a_run_keeps_its_body_when_the_file_changes() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &["model", "export", "mobl-arms", "--format", "yaml", "--out", "arm.yaml"]));
    let task = stdout(&here(&["task", "show", "pointing-single"])).replace("model: mobl-arms-uitb", "model: arm.yaml");
    std::fs::write(folder.path().join("mine.yaml"), task).unwrap();
    let args = ["train", "mine.yaml", "--out", "run", "--envs", "8", "--steps", "64", "--until", "off"];
    stdout(&myo(folder.path(), &args));
    let evaluate = || json(&myo(folder.path(), &["eval", "run", "--episodes", "8", "--json"]));
    let before = evaluate();
    std::fs::write(folder.path().join("arm.yaml"), "no body any more").unwrap();
    assert_eq!(evaluate(), before);
    stdout(&myo(folder.path(), &["train", "--resume", "run", "--steps", "128"]));
}
