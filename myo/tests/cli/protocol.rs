//! `myo eval --protocol`.

use super::{assert_refused, myo, short_training, stdout};

/// T1 asks for two practices, one after the other. Who has hardly learnt anything gets no figures, and is told why.
#[test]
fn a_protocol_asks_for_all_its_practices_and_beginners_have_no_figures() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let run = folder.path().join("run");
    std::fs::create_dir(run.join("protocols")).unwrap();
    std::fs::write(run.join("protocols/T1.txt"), "what another user answered").unwrap();
    let ask = ["eval", "run", "--protocol", "T1", "--seeds", "1", "--steps", "512"];
    assert_refused(&myo(folder.path(), &ask), "It has not learnt this");
    assert_eq!(myo::protocol::kept_answers(&run).unwrap(), [], "no answer of this user");
    let ask = ["eval", "run", "--protocol", "S1", "--seeds", "1", "--steps", "512"];
    assert_refused(&myo(folder.path(), &ask), "passes of the straight way of 20 mm that did not leave it");
    for practice in ["keys", "tapping", "steering"] {
        assert!(run.join("protocols").join(practice).is_dir(), "{practice}");
    }
}

/// The studio and reports show what is kept there.
#[test]
fn an_answer_is_kept_in_the_folder_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    // The first answer of all has a plot.
    let endurance = stdout(&myo(folder.path(), &["eval", "run", "--protocol", "E1"]));
    let told = stdout(&myo(folder.path(), &["eval", "run", "--protocol", "M1"]));
    let kept = myo::protocol::kept_answers(&folder.path().join("run")).unwrap();
    let all: Vec<_> = kept.iter().map(|answer| (answer.name, answer.plot.is_some())).collect();
    assert_eq!(all, [("M1", false), ("E1", true)]);
    assert_eq!(kept[0].text, told);
    assert!(endurance.starts_with(&kept[1].text) && endurance.contains("shoulder"), "{endurance}");
}

#[test]
fn how_long_muscles_hold_loads_and_recover_is_told_as_json() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let ask = |protocol: &str| -> serde_json::Value {
        let told = stdout(&myo(folder.path(), &["eval", "run", "--protocol", protocol, "--json"]));
        serde_json::from_str(&told).unwrap()
    };
    let [endurance, recovery] = ["E1", "E3"].map(ask);
    let rows = endurance["rows"].as_array().unwrap();
    assert!(rows.iter().any(|row| row["joint"] == "shoulder" && row["load"] == 0.5 && row["people_s"].is_number()));
    assert_eq!(endurance["plots"].as_array().unwrap().len(), 2);
    let rows = recovery["rows"].as_array().unwrap();
    assert!(rows.iter().all(|row| row["after_rest"].as_f64() < row["after_work"].as_f64()), "{rows:?}");
}
