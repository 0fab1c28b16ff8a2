//! What is written to terminals and pipes.

use std::io::{BufRead, BufReader};
use std::process::{Command, Output, Stdio};

use crate::{here, myo, short_training, stderr, stdout};

#[test]
fn output_that_nobody_reads_is_no_failure() {
    for args in [&["task", "show", "ar"][..], &["task", "schema"], &["model", "export", "mobl-arms"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
        let mut child = command.args(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let complaint = BufReader::new(child.stderr.take().unwrap()).lines().next();
        assert!(complaint.is_none(), "{complaint:?}");
        assert!(child.wait().unwrap().success());
    }
}

/// Bytes that would command a terminal.
fn commands_terminal(output: &Output) -> bool {
    let all = [&output.stdout[..], &output.stderr].concat();
    String::from_utf8(all).unwrap().chars().any(|c| c.is_control() && c != '\n')
}

#[test]
fn text_from_files_does_not_command_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let evil = "run\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}31m\n  fake line";
    let shown = r"run\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}31m";
    let trained = myo(folder.path(), &short_training("2k", &["--out", evil]));
    let told = stdout(&trained) + &stderr(&trained);
    assert!(!commands_terminal(&trained), "{told:?}");
    assert!(told.contains(shown), "{told}");
    let evaluated = myo(folder.path(), &["eval", evil, "--episodes", "4"]);
    assert!(evaluated.status.success() && !commands_terminal(&evaluated), "{}", stderr(&evaluated));

    // A task with such a name is none.
    let text = stdout(&here(&["task", "show", "pointing-single"]));
    let named = text.replace("name: pointing-single", r#"name: "a\e[2J""#);
    assert_ne!(named, text);
    std::fs::write(folder.path().join("named.yaml"), named).unwrap();
    let refused = myo(folder.path(), &["train", "named.yaml"]);
    assert!(stderr(&refused).contains("`name` has the control character U+001B") && !commands_terminal(&refused));

    // In messages about the file, and in its name.
    for text in
        ["\"a\\e[2J\": 1\n", "version: 1\nname: x\nmodel: \"a\\e[2J\"\ntargets: []\n", "a\u{1b}[2J: 1\n", "\u{9b}"]
    {
        std::fs::write(folder.path().join("bad.yaml"), text).unwrap();
        let refused = myo(folder.path(), &["task", "check", "bad.yaml"]);
        assert_eq!(refused.status.code(), Some(1));
        assert!(!commands_terminal(&refused), "{:?}", stderr(&refused));
    }
    let unknown = myo(folder.path(), &["eval", "a\u{1b}[2J"]);
    assert!(!commands_terminal(&unknown) && stderr(&unknown).contains(r"a\u{1b}[2J is not a run folder"));

    // What is shown to another program is the file itself.
    let raw = "name: \u{202e}x\n";
    std::fs::write(folder.path().join("raw.yaml"), text.replace("name: pointing-single\n", raw)).unwrap();
    assert!(stdout(&myo(folder.path(), &["task", "show", "raw.yaml"])).contains(raw));
}
