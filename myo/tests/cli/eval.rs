//! `myo eval`.

use serde_json::Value;

use crate::{assert_refused, here, json, myo, short_training, stderr, stdout};

#[test]
fn damaged_checkpoint_is_told_and_the_one_before_used() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let whole = folder.path().join("run/checkpoints/step_000000000512.ckpt");
    let mut bytes = std::fs::read(&whole).unwrap();
    bytes[300] ^= 1;
    std::fs::write(folder.path().join("run/checkpoints/step_000000001024.ckpt"), &bytes).unwrap();
    let output = myo(folder.path(), &["eval", "run", "--episodes", "4"]);
    assert!(output.status.success());
    assert!(stderr(&output).contains("step_000000001024.ckpt cannot be used: the checkpoint is damaged"));
    assert!(stderr(&output).contains("512 control steps is used instead"), "{}", stderr(&output));
    std::fs::write(&whole, &bytes).unwrap();
    assert_refused(&myo(folder.path(), &["eval", "run", "--episodes", "4"]), "no checkpoint that can be used");
    assert_refused(&myo(folder.path(), &["eval", "elsewhere"]), "elsewhere is not a run folder");
}

#[test]
fn a_policy_can_be_tried_on_another_task() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("2k", &["--out", "run"])));
    let evaluate = |more: &[&str]| {
        let args = [&["eval", "run", "--episodes", "16", "--seed", "3", "--json"], more].concat();
        let output = myo(folder.path(), &args);
        (json(&output), stderr(&output))
    };
    let (own, _) = evaluate(&[]);
    let (same, told) = evaluate(&["--task", "pointing-single"]);
    assert_eq!((same, told.as_str()), (own.clone(), ""), "nothing is told where nothing differs");

    let (other, told) = evaluate(&["--task", "mobile-typing"]);
    assert_eq!((&other["task"], &other["trained_task"]), (&"mobile-typing".into(), &"pointing-single".into()));
    assert_eq!(other["targets"].as_array().unwrap().len(), 5);
    assert_ne!(other["return"], own["return"]);
    assert_eq!(told, "", "it observes the same");

    let text = stdout(&here(&["task", "show", "pointing-single"]));
    let seen = text.clone() + "observation: {joint_acceleration: true, phase: false, touch: false}\n";
    std::fs::write(folder.path().join("seen.yaml"), seen).unwrap();
    let (_, told) = evaluate(&["--task", "seen.yaml"]);
    let new = "5 observations that the policy does not know and does not use: joint_acceleration.elv_angle, ";
    let gone = "2 observations that the policy knows and does not get: phase, touch";
    assert!(told.contains(new) && told.contains(gone), "{told}");

    let more_text = stdout(&here(&["model", "export", "mobl-arms-uitb", "--format", "yaml"]));
    let renamed = more_text.replace("DELT1", "OTHER1");
    assert_ne!(renamed, more_text);
    std::fs::write(folder.path().join("arm.yaml"), renamed).unwrap();
    std::fs::write(folder.path().join("mine.yaml"), text.replace("mobl-arms-uitb", "arm.yaml")).unwrap();
    let refused = myo(folder.path(), &["eval", "run", "--task", "mine.yaml"]);
    assert_refused(&refused, "OTHER1");
    assert!(stderr(&refused).contains("which the policy does not know"), "{}", stderr(&refused));
}

#[test]
fn a_checkpoint_can_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("1k", &["--out", "run"])));
    let keep = folder.path().join("early.ckpt");
    std::fs::copy(folder.path().join("run/checkpoints/step_000000001024.ckpt"), keep).unwrap();
    stdout(&myo(folder.path(), &["train", "--resume", "run", "--steps", "2k"]));
    let evaluate = |checkpoint: &[&str]| {
        let args = [&["eval", "run", "--episodes", "16", "--seed", "3", "--json"], checkpoint].concat();
        json(&myo(folder.path(), &args))
    };
    let steps = |result: &Value| result["env_steps"].as_u64().unwrap();
    let (newest, early) = (evaluate(&[]), evaluate(&["--checkpoint", "early.ckpt"]));
    assert_eq!((steps(&newest), steps(&early)), (2048, 1024));
    assert_ne!(newest["return"], early["return"]);
    assert_eq!(evaluate(&["--checkpoint", "1024"]), early);
    assert_eq!(evaluate(&["--checkpoint", "2_048"]), newest);
    let refused =
        |which, sentence| assert_refused(&myo(folder.path(), &["eval", "run", "--checkpoint", which]), sentence);
    refused("3k", "run has no checkpoint of 3000 control steps; it has those of 1024, 2048");
    refused("nowhere.ckpt", "cannot use the checkpoint nowhere.ckpt");
    refused("run/config.json", "this is not a checkpoint");
    refused("run", "cannot use the checkpoint run: ");
    let mut bytes = std::fs::read(folder.path().join("early.ckpt")).unwrap();
    bytes[300] ^= 1;
    std::fs::write(folder.path().join("early.ckpt"), bytes).unwrap();
    refused("early.ckpt", "the checkpoint is damaged");
    // That of a task with other observations, without being told that the task is another one.
    let task = stdout(&here(&["task", "show", "pointing-single"])) + "observation: {phase: false}\n";
    std::fs::write(folder.path().join("mine.yaml"), task).unwrap();
    let other = ["train", "mine.yaml", "--out", "other", "--until", "off", "--envs", "8", "--steps", "64"];
    stdout(&myo(folder.path(), &other));
    refused("other/checkpoints/step_000000000064.ckpt", "does not fit");
}
