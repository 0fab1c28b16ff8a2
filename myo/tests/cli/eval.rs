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
fn a_user_can_be_tried_on_a_layout_that_it_was_not_trained_on() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("2k", &["--out", "run"])));
    let try_on = |more: &[&str]| {
        let args = [&["eval", "run", "--episodes", "16", "--seed", "3"], more].concat();
        myo(folder.path(), &args)
    };
    let evaluate = |more: &[&str]| json(&try_on(&[more, &["--json"]].concat()));
    let own = evaluate(&[]);
    assert_eq!(evaluate(&["--task", "pointing-single"]), own);
    assert_eq!(
        (&own["trained_here"], &own["trained_layouts"]),
        (&true.into(), &serde_json::json!(["pointing-single"]))
    );

    // More steps, and of other kinds; the same is perceived.
    let typing = stdout(&here(&["task", "show", "mobile-typing"])) + "model: mobl-arms-uitb\nuser: fastest\n";
    std::fs::write(folder.path().join("typing.yaml"), typing).unwrap();
    let other = evaluate(&["--task", "typing.yaml"]);
    assert_eq!((&other["task"], &other["trained_task"]), (&"mobile-typing".into(), &"pointing-single".into()));
    assert_eq!((other["targets"].as_array().unwrap().len(), &other["trained_here"]), (5, &false.into()));
    assert_ne!(other["return"], own["return"]);
    let told = stdout(&try_on(&["--task", "typing.yaml"]));
    let warning =
        "This user was not trained on mobile-typing: it acts there with what it learned on pointing-single.\n";
    assert!(told.starts_with(warning), "{told}");
    assert!(told.contains(" control steps on pointing-single, none on mobile-typing\n"), "{told}");
    assert!(!stdout(&try_on(&[])).contains("not trained"));
}

#[test]
fn a_user_is_not_tried_where_it_cannot_act_and_all_that_differs_is_named() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let text = stdout(&here(&["task", "show", "pointing-single"]));
    let refused = |task: &str, more: &[&str], sentences: &[&str]| {
        let output = myo(folder.path(), &[&["eval", "run", "--task", task][..], more].concat());
        sentences.iter().for_each(|sentence| assert_refused(&output, sentence));
        assert!(stderr(&output).contains(&format!("train {task} --from run")), "{}", stderr(&output));
    };
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    refused(
        "public-display",
        &[],
        &["cannot do public-display: its body is myo-arm instead of mobl-arms-uitb. To train"],
    );
    // A body of the same name and with the same muscles is another one all the same.
    let more_text = stdout(&here(&["model", "export", "mobl-arms-uitb", "--format", "yaml"]));
    write("arm.yaml", &more_text);
    write("mine.yaml", &text.replace("mobl-arms-uitb", "arm.yaml"));
    refused("mine.yaml", &[], &["its body is arm.yaml instead of mobl-arms-uitb"]);

    let seen = text.clone() + "observation: {joint_acceleration: true, phase: false}\ncontrol_dt_s: 0.1\n";
    write("seen.yaml", &seen);
    let settings = [
        "its control step is 0.1 s instead of 0.05 s",
        "`phase` cannot be perceived there (`observation.phase` of the task)",
        "`joint_acceleration` is perceived there, and was not in training (`observation.joint_acceleration` of the task)",
    ];
    refused("seen.yaml", &[], &settings);

    // Parts that are there only in some tasks.
    let uitb = |preset: &str| stdout(&here(&["task", "show", preset])) + "model: mobl-arms-uitb\n";
    for (preset, part, only_where) in [
        ("slider", "drag", "where there is a slider to drag or a stick to swing"),
        ("choice", "cue", "where a step must be waited for"),
        ("wall-ray", "pointer_position", "where the technique is not the fingertip"),
    ] {
        write("other.yaml", &uitb(preset));
        let sentence = format!("`{part}` is perceived there, and was not in training (it is there only {only_where})");
        refused("other.yaml", &[], &[&sentence]);
    }
    refused("other.yaml", &[], &["its technique is a ray from the forearm onto a display instead of the fingertip; "]);
    let moving = [
        ("x: 0.55", "x: 0.4"),
        ("y: [-0.2, 0.4]", "y: 0.1"),
        ("z: [-0.3, 0.3]", "z: -0.1"),
        ("    radius:", "    moves: {kind: circle, diameter: 0.1, period_s: 4}\n    radius:"),
    ];
    write("moving.yaml", &moving.iter().fold(text.clone(), |text, (from, to)| text.replace(from, to)));
    refused("moving.yaml", &[], &["`target_velocity` is perceived there", "(it is there only where something moves)"]);
    // And the other way round.
    let args = ["train", "moving.yaml", "--out", "moving", "--until", "off", "--envs", "8", "--steps", "64"];
    stdout(&myo(folder.path(), &args));
    let output = myo(folder.path(), &["eval", "moving", "--task", "pointing-single"]);
    let sentence = "`target_velocity` cannot be perceived there (it is there only where something moves)";
    assert_refused(&output, sentence);
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

#[test]
fn people_stand_beside_answers_about_movements_alone() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let ask = |more: &[&str]| myo(folder.path(), &[&["eval", "run", "--people", "ours.csv"][..], more].concat());
    assert_refused(&ask(&["--protocol", "S1"]), "--people stands beside the answers of F1 and K1 alone; leave it out");
    // Before anybody practises.
    assert_refused(&ask(&["--protocol", "F1"]), "ours.csv: cannot be read");
    std::fs::write(folder.path().join("ours.csv"), "trial,time_s\n1,0\n").unwrap();
    assert_refused(&ask(&["--protocol", "K1"]), "ours.csv: there is no column `x_m` and `y_m`");
    assert!(!folder.path().join("run/protocols").exists());
}
