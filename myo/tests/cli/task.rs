//! `myo task`.

use serde_json::Value;

use crate::{assert_refused, here, json, myo, stdout};

#[test]
fn preset_is_shown_with_its_comments() {
    let text = stdout(&here(&["task", "show", "ar"]));
    assert_eq!(Some(text.as_str()), myo::tasks::preset_text("ar"));
}

#[test]
fn lists_are_json_on_request() {
    let tasks = json(&here(&["task", "list", "--json"]));
    let names: Vec<_> = tasks.as_array().unwrap().iter().map(|task| task["name"].as_str().unwrap()).collect();
    assert_eq!(names, myo::tasks::preset_names());
    assert_eq!(json(&here(&["model", "list", "--json"]))[0]["muscles"], 26);
    assert_eq!(json(&here(&["model", "show", "mobl-arms", "--json"]))["muscles"].as_array().unwrap().len(), 26);
    assert!(json(&here(&["task", "schema"]))["properties"]["targets"].is_object());
}

#[test]
fn mistakes_in_a_task_are_told_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let text = myo::tasks::preset_text("ar").unwrap();
    let line = 1 + text.lines().position(|line| line.contains("0.42, 0.15, -0.29")).unwrap();
    let files = [
        (
            "far.yaml",
            text.replace("0.42, 0.15, -0.29", "0.92, 0.15, -0.29"),
            format!("far.yaml:{line}:9: lower_left is out of reach"),
        ),
        ("key.yaml", text.replacen("radius:", "radios:", 1), ":5: unknown key `radios`".into()),
        ("body.yaml", format!("model: mobl\n{text}"), "body.yaml:1:8: there is no built-in model `mobl`".into()),
        ("no.yaml", String::new(), "no.yaml:1:1: ".into()),
    ];
    for (name, text, expected) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
        assert_refused(&myo(folder.path(), &["task", "check", name]), &expected);
        assert_refused(&myo(folder.path(), &["train", name]), &expected);
        let output = myo(folder.path(), &["task", "check", name, "--json"]);
        assert_eq!(output.status.code(), Some(1));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&found["ok"], &found["errors"][0]["file"]), (&Value::Bool(false), &Value::from(name)));
        assert!(found["errors"][0]["line"].as_u64().unwrap() >= 1);
    }
    assert!(!folder.path().join("runs").exists(), "nothing was trained");
    assert_refused(&myo(folder.path(), &["task", "check", "absent.yaml"]), "cannot read absent.yaml");
}

#[test]
fn presets_pass_their_check() {
    for name in myo::tasks::preset_names() {
        assert!(json(&here(&["task", "check", name, "--json"]))["ok"].as_bool().unwrap(), "{name}");
    }
}
