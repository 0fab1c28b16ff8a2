//! Files and run folders that are damaged, or something else.

use std::path::Path;

use serde_json::Value;

use crate::{assert_refused, myo, short_training, stderr, stdout};

/// What a user may pass by mistake where a file is expected; the names tell what is wrong.
fn bad_files(folder: &Path) -> Vec<String> {
    let files: [(&str, Vec<u8>); 6] = [
        ("empty.yaml", Vec::new()),
        ("picture.yaml", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec()),
        ("latin1.yaml", b"name: caf\xe9\n".to_vec()),
        ("list.yaml", b"- 1\n- 2\n".to_vec()),
        ("huge.yaml", vec![b'['; 4 << 20]),
        ("long.yaml", [b"name: ".to_vec(), vec![b'x'; 4 << 20]].concat()),
    ];
    for (name, bytes) in &files {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    std::fs::create_dir(folder.join("folder.yaml")).unwrap();
    files.iter().map(|(name, _)| (*name).to_owned()).chain(["folder.yaml".into(), "absent.yaml".into()]).collect()
}

#[test]
fn files_that_are_no_task_or_model_are_refused_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let commands: [&[&str]; 7] = [
        &["train"],
        &["task", "check"],
        &["eval", "run", "--task"],
        &["bench", "env", "--task"],
        &["bench", "train"],
        &["model", "show"],
        &["model", "export", "--out", "made"],
    ];
    for file in bad_files(folder.path()) {
        for command in commands {
            let output = myo(folder.path(), &[command, &[&file]].concat());
            assert_refused(&output, &file);
            let told = stderr(&output);
            assert!(told.len() < 2000, "{command:?} {file}: {} bytes are told", told.len());
        }
    }
    assert!(!folder.path().join("made").exists() && !folder.path().join("runs").exists(), "nothing is left");
}

#[test]
fn damaged_runs_are_refused_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let whole = std::fs::read_to_string(folder.path().join("run/config.json")).unwrap();
    let mut odd: Value = serde_json::from_str(&whole).unwrap();
    odd["run"]["task"]["targets"] = "none".into();
    let commands: [&[&str]; 4] = [&["eval"], &["train", "--resume"], &["train", "ar", "--from"], &["task", "show"]];
    let damages = [("", "EOF"), ("{", "EOF"), ("[]", "config.json"), ("\0\u{1}", "line 1"), (&whole[..200], "EOF")];
    for (text, sentence) in damages {
        std::fs::write(folder.path().join("run/config.json"), text).unwrap();
        for command in commands {
            let refused = myo(folder.path(), &[command, &["run"]].concat());
            assert_refused(&refused, sentence);
            assert!(stderr(&refused).contains("cannot understand run/config.json: "), "{}", stderr(&refused));
        }
    }
    std::fs::write(folder.path().join("run/config.json"), odd.to_string()).unwrap();
    for command in [&["eval", "run"][..], &["train", "--resume", "run"], &["task", "show", "run"]] {
        assert_refused(&myo(folder.path(), command), "cannot understand run/config.json: ");
    }
    // What is no run at all.
    std::fs::write(folder.path().join("file"), "").unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    for (name, command) in
        ["file", "empty", "absent"].iter().flat_map(|name| commands[..3].iter().map(move |c| (name, c)))
    {
        let refused = myo(folder.path(), &[command, &[*name][..]].concat());
        assert_refused(&refused, name);
    }
}
