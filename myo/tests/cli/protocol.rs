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
    for practice in ["keys", "tapping"] {
        assert!(run.join("protocols").join(practice).is_dir(), "{practice}");
    }
}

/// The studio and reports show what is kept there.
#[test]
fn an_answer_is_kept_in_the_folder_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let told = stdout(&myo(folder.path(), &["eval", "run", "--protocol", "M1"]));
    let kept = myo::protocol::kept_answers(&folder.path().join("run")).unwrap();
    assert_eq!(kept.iter().map(|answer| (answer.name, answer.plot.is_some())).collect::<Vec<_>>(), [("M1", false)]);
    assert_eq!(kept[0].text, told);
}
