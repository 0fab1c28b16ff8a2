//! `myo export`.

use crate::{assert_refused, json, myo, short_training, stdout};

#[test]
fn what_a_user_does_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let told = stdout(&myo(folder.path(), &["export", "run", "--episodes", "3"]));
    let text = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    assert_eq!(told, format!("{} rows are in run.csv\n", rows.len() - 1));
    assert_eq!(rows[0][..5], ["participant", "episode", "time_s", "step", "object"]);
    assert_eq!(rows[1][0], "run");
    let ends = rows.iter().filter(|row| row.contains(&"success") || row.contains(&"time_out")).count();
    assert_eq!(ends, 3);
    // The same episodes as those of an evaluation.
    let evaluation = json(&myo(folder.path(), &["eval", "run", "--episodes", "3", "--json"]));
    let seconds = (rows.len() - 1) as f64 * 0.002 / 3.0;
    assert!((evaluation["episode_length_s"].as_f64().unwrap() - seconds).abs() < 1e-4, "{seconds} {evaluation}");

    assert_refused(
        &myo(folder.path(), &["export", "run"]),
        "run.csv is there already; name another with --out, or add --force",
    );
    let again = ["export", "run", "--episodes", "3", "--out", "-"];
    assert_eq!(stdout(&myo(folder.path(), &again)), text);
    assert_refused(&myo(folder.path(), &["export", "run", "--out", "no/where.csv"]), "cannot write no/where.csv.part");
    assert_refused(&myo(folder.path(), &["export", "nothing"]), "nothing is not a run folder");
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().ends_with(".part")), "{left:?}");
}
