//! `myo completions` and `myo man`.

use std::process::Command;

use crate::{assert_refused, here, myo, stdout};

#[cfg(unix)]
#[test]
fn bash_completes_commands_options_and_values() {
    let script = stdout(&here(&["completions", "bash"]));
    let complete = |line: &str| {
        let words: Vec<String> = line.split(' ').map(|word| format!("'{word}'")).collect();
        let ask = format!(
            "{script}\nCOMP_WORDS=({}); COMP_CWORD={}; COMPREPLY=(); _myo myo '{}' '{}'; echo \"${{COMPREPLY[@]}}\"",
            words.join(" "),
            words.len() - 1,
            line.split(' ').next_back().unwrap(),
            line.rsplit(' ').nth(1).unwrap(),
        );
        stdout(&Command::new("bash").args(["--norc", "-c", &ask]).output().expect("bash is there"))
    };
    assert_eq!(complete("myo tra").trim(), "train");
    assert_eq!(complete("myo train --see").trim(), "--seed --seeds");
    assert_eq!(complete("myo train --backend g").trim(), "gpu");
    assert_eq!(complete("myo task che").trim(), "check");
}

#[test]
fn manual_pages_are_written_for_every_command() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(stdout(&myo(folder.path(), &["man", "--out", "."])), "");
    for (page, words) in [("myo.1", &["man"][..]), ("myo-task-check.1", &["man", "task", "check"])] {
        let text = std::fs::read_to_string(folder.path().join(page)).unwrap();
        assert_eq!(text, stdout(&here(words)), "{page}");
        assert!(text.contains(".TH") && text.contains(".SH NOTES"), "{text}");
    }
    assert_refused(
        &here(&["man", "task", "fly"]),
        "`myo task` has no command `fly`; there are list, show, convert, check, users, schema",
    );
    assert_refused(&myo(folder.path(), &["man", "--out", "nowhere"]), "cannot write nowhere");
}
