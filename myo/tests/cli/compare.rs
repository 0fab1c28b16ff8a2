//! `myo compare`.

use crate::{assert_refused, here, json, myo, stdout};

const SHORT: [&str; 6] = ["--until", "off", "--steps", "1k", "--envs", "32"];

#[test]
fn two_tasks_are_compared_and_their_users_kept() {
    let folder = tempfile::tempdir().unwrap();
    let train = |more: &[&str]| {
        let set = ["--set", "rollout_s=0.8"];
        myo(folder.path(), &[&["compare", "pointing-single", "public-display"][..], &SHORT, &set, more].concat())
    };
    let result = json(&train(&["--seeds", "2", "--json"]));
    assert_eq!(result["names"], serde_json::json!(["pointing-single", "public-display"]));
    assert_eq!(result["users"], serde_json::json!([2, 2]));
    let folders =
        ["pointing-single", "public-display"].map(|name| format!("runs/pointing-single-public-display-1/{name}"));
    assert_eq!(result["folders"], serde_json::json!(folders));
    let quantities: Vec<_> = result["differences"].as_array().unwrap().iter().map(|row| &row["quantity"]).collect();
    assert_eq!(quantities, ["success", "episode_length_s", "effort", "fatigue"]);
    let caveats = result["caveats"].to_string();
    for caveat in ["the tasks ask for different things", "2 of 2 users of pointing-single had not finished learning"] {
        assert!(caveats.contains(caveat), "{caveats}");
    }

    // The same users again, from their folders, as a table.
    let text = stdout(&myo(folder.path(), &["compare", &folders[0], &folders[1]]));
    for row in result["sentences"].as_array().unwrap() {
        assert!(text.contains(row.as_str().unwrap()), "{text}");
    }
    assert!(text.contains("time per episode") && text.contains("note: "), "{text}");
    // One user of each says nothing about chance.
    let alone = stdout(&myo(folder.path(), &["compare", &format!("{}/seed-1", folders[0]), &folders[1]]));
    assert!(alone.contains("with a single user of a layout nobody can tell whether that is chance"), "{alone}");
    // A run that was stopped before its evaluation is not compared, and the command that evaluates it is told.
    let stopped = format!("{}/seed-1", folders[0]);
    std::fs::remove_file(folder.path().join(&stopped).join("evaluation.json")).unwrap();
    let refused = myo(folder.path(), &["compare", &stopped, &folders[1]]);
    assert_refused(&refused, &format!("{stopped} is not evaluated yet; go on with: "));
    assert_refused(&refused, &format!("train --resume {stopped}"));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let refused = myo(folder.path(), &["compare", "empty", "empty"]);
    assert_refused(&refused, "empty is not a run folder");
    assert_refused(&here(&["compare", "ar", "no-such-task"]), "no-such-task");
}
