//! `myo runs`.

use std::fs;

use serde_json::Value;

use crate::{assert_refused, json, myo, short_training, stdout};

#[test]
fn runs_are_listed_and_damaged_ones_hide_no_others() {
    let folder = tempfile::tempdir().unwrap();
    let here = |args: &[&str]| myo(folder.path(), args);
    assert_refused(&here(&["runs"]), "there is no folder runs; a first run is made by: ");
    fs::create_dir_all(folder.path().join("runs/notes")).unwrap();
    assert_eq!(stdout(&here(&["runs"])), "no run in runs\n");
    for (out, more) in [("runs/alone", &[][..]), ("runs/both", &["--seeds", "2", "--seed", "4"]), ("runs/torn", &[])] {
        stdout(&here(&short_training("1k", &[&["--out", out], more].concat())));
    }
    fs::write(folder.path().join("runs/torn/config.json"), "{").unwrap();
    fs::remove_file(folder.path().join("runs/alone/evaluation.json")).unwrap();

    let list = json(&here(&["runs", "--json"]));
    let runs = list["runs"].as_array().unwrap();
    let of = |key: &str| runs.iter().map(|run| run[key].clone()).collect::<Vec<Value>>();
    assert_eq!(of("run"), ["runs/alone", "runs/both/seed-4", "runs/both/seed-5", "runs/torn"]);
    assert_eq!(of("state")[..3], ["stopped", "evaluated", "evaluated"]);
    assert_eq!(
        (&of("seed")[1], &of("env_steps")[1], &of("tasks")[1][0]),
        (&4.into(), &1024.into(), &"pointing-single".into())
    );
    assert!(runs[0]["success"].is_null() && runs[1]["success"].is_f64() && runs[1]["damage"].is_null());
    assert!(runs[3]["damage"].as_str().unwrap().starts_with("cannot understand runs/torn/config.json: "));
    assert!(runs[1]["changed_s"].as_u64().unwrap() > 1_700_000_000);

    let text = stdout(&here(&["runs"]));
    let lines: Vec<&str> = text.lines().collect();
    // The latest first, users of one folder on one line.
    assert!(lines[0].starts_with("  run ") && lines[1].starts_with("  runs/both "), "{text}");
    let mean = runs[1..3].iter().map(|run| run["episode_length_s"].as_f64().unwrap()).sum::<f64>() / 2.0;
    assert!(lines[1].contains("  2  1.02 k  ") && lines[1].contains(&format!("{mean:.2} s")), "{text}");
    assert!(lines[2].contains("runs/alone") && lines[2].contains(" stopped "), "{text}");
    assert!(lines[3].starts_with("damaged: runs/torn: cannot understand runs/torn/config.json: "), "{text}");
    assert!(text.contains(" train --resume runs/alone\n"), "{text}");
    assert_eq!(stdout(&here(&["runs", "--all"])).matches("runs/both/seed-").count(), 2);
    assert_eq!(stdout(&here(&["runs", "runs/both"])).matches("runs/both/seed-").count(), 2);
    assert!(stdout(&here(&["runs", "runs/alone"])).contains("  runs/alone "), "a run itself");
    assert_eq!(stdout(&here(&["runs", "--find", "BOTH", "--all"])).lines().count(), 3);
    assert_eq!(stdout(&here(&["runs", "--find", "nothing"])), "no run of nothing in runs\n");
}

#[cfg(unix)]
#[test]
fn a_run_in_which_somebody_trains_is_told_and_looking_does_not_stop_it() {
    let folder = tempfile::tempdir().unwrap();
    let states = || {
        let list = json(&myo(folder.path(), &["runs", ".", "--json"]));
        list["runs"].as_array().unwrap().iter().map(|run| run["state"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    stdout(&myo(folder.path(), &short_training("1k", &["--out", "one"])));
    let claim = myo::train::RunClaim::take(&folder.path().join("one")).unwrap();
    assert_eq!(states(), ["training"]);
    drop(claim);
    assert_eq!(states(), ["evaluated"]);
    // Somebody looks at it all the time.
    std::thread::scope(|scope| {
        let looking = scope.spawn(|| (0..500).filter(|_| myo::run_summary(&folder.path().join("one")).is_ok()).count());
        for _ in 0..200 {
            drop(myo::train::RunClaim::take(&folder.path().join("one")).unwrap());
        }
        assert_eq!(looking.join().unwrap(), 500);
    });
}
