//! `myo train --seeds`.

use serde_json::Value;

use crate::{assert_refused, description, interrupt, json, myo, newest_checkpoint, short_training, stderr, stdout};

#[test]
fn several_seeds_give_runs_of_their_own_and_a_mean() {
    let folder = tempfile::tempdir().unwrap();
    let train = |more: &[&str]| myo(folder.path(), &short_training("1k", more));
    let all = json(&train(&["--seeds", "2", "--seed", "4", "--out", "both", "--json"]));
    assert_eq!(all["reached"], 0);
    let runs = all["runs"].as_array().unwrap();
    assert_eq!(runs.iter().map(|run| run["seed"].as_u64().unwrap()).collect::<Vec<_>>(), [4, 5]);
    let success = |run: &Value| run["evaluation"]["success"].as_f64().unwrap();
    let mean = (success(&runs[0]) + success(&runs[1])) / 2.0;
    assert!((all["mean"]["success"].as_f64().unwrap() - mean).abs() < 1e-12);
    assert_eq!((&all["mean"]["env_steps"], &all["sd"]["env_steps"]), (&1024.0.into(), &0.0.into()));
    let kept: Value = serde_json::from_slice(&std::fs::read(folder.path().join("both/seeds.json")).unwrap()).unwrap();
    assert_eq!(kept, all);

    stdout(&train(&["--seed", "5", "--out", "alone"]));
    let parameters = |run: &str| newest_checkpoint(&folder.path().join(run)).to_bytes();
    assert!(parameters("both/seed-5") == parameters("alone"), "a seed does not depend on the ones before it");
    let table = stdout(&train(&["--seeds", "2", "--out", "again"]));
    assert!(["mean", "sd", "0 of 2 seeds"].iter().all(|word| table.contains(word)), "{table}");
    assert_refused(&train(&["--seeds", "2", "--out", "both"]), "choose another with --out");
}

#[cfg(unix)]
#[test]
fn an_interrupted_training_of_several_seeds_goes_on_with_the_same_result() {
    let folder = tempfile::tempdir().unwrap();
    let both = ["--seeds", "3", "--seed", "4", "--out"];
    let whole = json(&myo(folder.path(), &short_training("32k", &[&both[..], &["whole", "--json"]].concat())));
    let args = short_training("32k", &[&both[..], &["parts"]].concat());
    let stopped = interrupt(folder.path(), &args, "parts/seed-5");
    assert!(String::from_utf8_lossy(&stopped.stdout).contains("train --resume parts"));
    assert!(!folder.path().join("parts/seed-6").exists());
    // Somewhere else, as after an upload.
    std::fs::rename(folder.path().join("parts"), folder.path().join("moved")).unwrap();
    let output = myo(folder.path(), &["train", "--resume", "moved", "--json"]);
    assert!(stderr(&output).contains("seed 4 is done"), "{}", stderr(&output));
    let parts = json(&output);
    // All but the times and the folder.
    let results = |all: &Value| {
        let rows = all["runs"].as_array().unwrap().iter();
        let keys = ["seed", "env_steps", "updates", "stopped_by", "evaluation"];
        let rows: Vec<Value> = rows.map(|row| keys.iter().map(|key| row[*key].clone()).collect()).collect();
        (rows, all["mean"]["success"].clone(), all["sd"]["effort"].clone(), all["reached"].clone())
    };
    assert_eq!(results(&parts), results(&whole));
    assert_eq!(parts["runs"][0]["run"], "moved/seed-4");
    for seed in ["seed-4", "seed-5", "seed-6"] {
        let [whole, moved] = ["whole", "moved"].map(|run| newest_checkpoint(&folder.path().join(run).join(seed)));
        assert!(whole == moved, "{seed}");
    }
    // With nothing left to do it tells the same, with a higher limit all go on, and one may go on alone.
    assert_eq!(json(&myo(folder.path(), &["train", "--resume", "moved", "--json"])), parts);
    let further = json(&myo(folder.path(), &["train", "--resume", "moved", "--steps", "33k", "--json"]));
    assert_eq!(further["mean"]["env_steps"], 33_280.0);
    assert_eq!(json(&myo(folder.path(), &["train", "--resume", "moved", "--json"])), further, "the limit is kept");
    let alone = json(&myo(folder.path(), &["train", "--resume", "whole/seed-6", "--steps", "33k", "--json"]));
    assert_eq!(alone["evaluation"], further["runs"][2]["evaluation"]);
}

#[cfg(unix)]
#[test]
fn a_new_goal_reaches_every_seed_that_has_begun() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--seeds", "2", "--out", "both"])));
    interrupt(folder.path(), &["train", "--resume", "both", "--steps", "1G"], "both/seed-1");
    for seed in ["both/seed-1", "both/seed-2"] {
        assert_eq!(description(&folder.path().join(seed))["steps"], 1_000_000_000, "{seed}");
    }
    // One of them alone, which was not reached before.
    interrupt(folder.path(), &["train", "--resume", "both/seed-2"], "both/seed-2");
}

#[test]
fn a_warm_start_with_several_seeds_goes_on_without_the_other_run() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("1k", &["--out", "first"])));
    let warm = ["train", "pointing-single", "--from", "first", "--until", "off", "--envs", "32", "--steps", "512"];
    let all = json(&myo(folder.path(), &[&warm[..], &["--seeds", "2", "--out", "both", "--json"]].concat()));
    // As if it had been killed before the second began.
    std::fs::remove_dir_all(folder.path().join("both/seed-2")).unwrap();
    std::fs::remove_file(folder.path().join("both/seeds.json")).unwrap();
    std::fs::remove_dir_all(folder.path().join("first")).unwrap();
    let seeds: Value = serde_json::from_value(all.clone()).unwrap();
    let one = serde_json::json!({"runs": [seeds["runs"][0]]});
    std::fs::write(folder.path().join("both/seeds.json"), one.to_string()).unwrap();
    let again = json(&myo(folder.path(), &["train", "--resume", "both", "--json"]));
    assert_eq!(again["runs"][1]["evaluation"], all["runs"][1]["evaluation"]);
    assert_eq!(again["mean"]["success"], all["mean"]["success"]);
}

#[test]
fn seeds_beyond_the_greatest_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let greatest = u64::MAX.to_string();
    let refused = myo(folder.path(), &short_training("512", &["--seeds", "2", "--seed", &greatest]));
    assert_refused(&refused, "it can be at most 18446744073709551614");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
    let one = json(&myo(folder.path(), &short_training("512", &["--seeds", "1", "--seed", &greatest, "--json"])));
    assert_eq!(one["runs"][0]["seed"], u64::MAX);
}
