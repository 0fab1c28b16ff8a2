//! `myo train --together`: one user for several layouts.

use std::path::Path;

use serde_json::{Value, json as value};

use crate::{assert_refused, description, here, json, myo, newest_checkpoint, stderr, stdout};

const SMALL: [&str; 6] = ["--set", "rollout_s=0.8", "--set", "policy_hidden=[16]", "--set", "value_hidden=[16]"];

/// Three layouts of a sphere near the hand, the last of which has another time limit, and one of two spheres.
fn write_layouts(folder: &Path) {
    let text = stdout(&here(&["task", "show", "pointing-single"]));
    let write = |file: &str, changes: &[(&str, &str)]| {
        let text = changes.iter().fold(text.clone(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
        std::fs::write(folder.join(file), text).unwrap();
    };
    write("a.yaml", &[("name: pointing-single", "name: near"), ("x: 0.55", "x: 0.4")]);
    write("b.yaml", &[("name: pointing-single", "name: far")]);
    write("c.yaml", &[("name: pointing-single", "name: hasty"), ("time_limit_s: 4", "time_limit_s: 1")]);
    write("two.yaml", &[("- dwell:", "- dwell: {in: ball, for_s: 0.25}\n  - dwell:")]);
}

/// Arguments of a training of three layouts in updates of 512 control steps.
fn training<'a>(steps: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let layouts = ["train", "a.yaml", "b.yaml", "c.yaml", "--together"];
    [&layouts[..], &["--until", "off", "--envs", "32", "--steps", steps], &SMALL, more].concat()
}

fn shares(layouts: &Value, key: &str) -> Vec<f64> {
    layouts.as_array().unwrap().iter().map(|layout| layout[key].as_f64().unwrap()).collect()
}

#[test]
fn one_user_learns_several_layouts_and_each_is_told() {
    let folder = tempfile::tempdir().unwrap();
    write_layouts(folder.path());
    let trained = myo(folder.path(), &training("3k", &["--json"]));
    assert!(stderr(&trained).contains("training near, far and hasty in runs/a-b-c-1"), "{}", stderr(&trained));
    let result = json(&trained);
    assert_eq!((&result["run"], &result["layouts"]), (&"runs/a-b-c-1".into(), &value!(["near", "far", "hasty"])));
    let evaluation = &result["evaluation"];
    assert_eq!((&evaluation["episodes"], evaluation["layouts"].as_array().unwrap().len()), (&3000.into(), 3));
    for key in ["return", "episode_length_s", "success"] {
        let mean = shares(&evaluation["layouts"], key).iter().sum::<f64>() / 3.0;
        assert!((mean - evaluation[key].as_f64().unwrap()).abs() < 1e-9 * mean.abs().max(1.0), "{key}");
    }
    // The last has a quarter of the time.
    let lengths = shares(&evaluation["layouts"], "episode_length_s");
    assert!(lengths[2] <= 1.0 && lengths[1] > 1.0, "{lengths:?}");

    let run = folder.path().join("runs/a-b-c-1");
    let others = &description(&run)["other_layouts"];
    assert_eq!(others.as_array().unwrap().iter().map(|task| &task["name"]).collect::<Vec<_>>(), ["far", "hasty"]);
    let metrics = std::fs::read_to_string(run.join("metrics.csv")).unwrap();
    let columns = ["layout_1_success", "layout_2_success", "layout_3_success"].join(",");
    assert!(metrics.lines().next().unwrap().ends_with(&columns), "{metrics}");

    let evaluate = |more: &[&str]| myo(folder.path(), &[&["eval", "runs/a-b-c-1", "--episodes", "8"], more].concat());
    let told = json(&evaluate(&["--json"]));
    assert_eq!((&told["episodes"], &told["trained_here"]), (&24.into(), &true.into()));
    let names: Vec<_> = told["layouts"].as_array().unwrap().iter().map(|layout| &layout["task"]).collect();
    assert_eq!(names, ["near", "far", "hasty"]);
    let text = stdout(&evaluate(&[]));
    assert!(text.starts_with("3 layouts: "), "{text}");
    for row in ["  near   ", "  far    ", "  hasty  ", "  mean   "] {
        assert!(text.lines().any(|line| line.starts_with(row)), "{row}: {text}");
    }
    assert_eq!(json(&evaluate(&["--task", "b.yaml", "--json"]))["trained_here"], true);
    let elsewhere = stdout(&evaluate(&["--task", "two.yaml"]));
    let warning =
        "This user was not trained on pointing-single: it acts there with what it learned on near, far and hasty.";
    assert!(elsewhere.starts_with(warning), "{elsewhere}");

    let shown = myo(folder.path(), &["task", "show", "runs/a-b-c-1"]);
    assert!(
        stdout(&shown).contains("name: near") && stderr(&shown).contains("the first of 3 layouts: near, far, hasty")
    );
    let compared = json(&myo(folder.path(), &["compare", "runs/a-b-c-1", "runs/a-b-c-1", "--json"]));
    let caveats = compared["caveats"].to_string();
    assert!(
        caveats.contains("each user of a-b-c-1 (1) learned 3 layouts: its numbers are means over them"),
        "{caveats}"
    );
    let warm = ["train", "two.yaml", "--from", "runs/a-b-c-1", "--envs", "8", "--steps", "64", "--until", "off"];
    stdout(&myo(folder.path(), &warm));
}

#[test]
fn a_training_of_several_layouts_goes_on_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    write_layouts(folder.path());
    stdout(&myo(folder.path(), &training("2k", &["--out", "whole", "--threads", "2"])));
    stdout(&myo(folder.path(), &training("1k", &["--out", "parts", "--threads", "1"])));
    stdout(&myo(folder.path(), &["train", "--resume", "parts", "--steps", "2k"]));
    let [whole, parts] = ["whole", "parts"].map(|run| folder.path().join(run));
    assert!(newest_checkpoint(&whole) == newest_checkpoint(&parts));
    let evaluation = |run: &Path| std::fs::read(run.join("evaluation.json")).unwrap();
    assert!(evaluation(&whole) == evaluation(&parts));
    // One layout alone is another training.
    let config = std::fs::read_to_string(parts.join("config.json")).unwrap();
    let mut config: Value = serde_json::from_str(&config).unwrap();
    config["run"].as_object_mut().unwrap().remove("other_layouts").unwrap();
    std::fs::write(parts.join("config.json"), config.to_string()).unwrap();
    assert_refused(&myo(folder.path(), &["train", "--resume", "parts", "--steps", "3k"]), "does not fit");
}

#[test]
fn several_users_learn_several_layouts() {
    let folder = tempfile::tempdir().unwrap();
    write_layouts(folder.path());
    let result = json(&myo(folder.path(), &training("512", &["--seeds", "2", "--json", "--out", "users"])));
    for row in result["runs"].as_array().unwrap() {
        assert_eq!(row["evaluation"]["layouts"].as_array().unwrap().len(), 3, "{row}");
    }
    let again = json(&myo(folder.path(), &["train", "--resume", "users", "--steps", "1k", "--json"]));
    assert!(again["runs"].as_array().unwrap().iter().all(|row| row["env_steps"] == 1024), "{again}");
}

#[test]
fn what_cannot_be_learned_together_is_refused_with_the_file_that_differs() {
    let folder = tempfile::tempdir().unwrap();
    write_layouts(folder.path());
    let refused = |args: &[&str], sentence: &str| assert_refused(&myo(folder.path(), args), sentence);
    let two = "two.yaml cannot be learned together with a.yaml: it has 2 steps instead of 1. ";
    refused(&["train", "a.yaml", "b.yaml", "two.yaml", "--together"], two);
    let body = "ar cannot be learned together with a.yaml: its body is myo-arm instead of mobl-arms-uitb";
    refused(&["train", "a.yaml", "ar", "--together"], body);
    refused(&["train", "a.yaml", "b.yaml"], "2 tasks are named: with --together one user learns all of them");
    refused(&["train", "a.yaml", "--together"], "--together needs several tasks; there is only a.yaml");
    let few = ["train", "a.yaml", "b.yaml", "c.yaml", "--together", "--envs", "2"];
    refused(&few, "3 layouts need an environment each; there are 2");
    assert!(!folder.path().join("runs").exists(), "nothing is left of what was refused");
}
