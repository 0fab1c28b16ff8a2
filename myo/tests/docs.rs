//! The commands in README.md and docs, run as a reader would type them.

use std::path::Path;
use std::process::Command;

mod documented;

use documented::{Documented, commands, documents, repository};

/// Options that keep a command short, each added where the document does not set it: command, option, value.
const SHORT: &[(&str, &str, &str)] = &[
    ("train", "--until", "off"),
    ("train", "--envs", "32"),
    ("train", "--steps", "1k"),
    ("compare", "--until", "off"),
    ("compare", "--envs", "32"),
    ("compare", "--steps", "1k"),
    ("compare", "--seeds", "2"),
    ("eval", "--episodes", "20"),
    ("export", "--episodes", "2"),
];

/// Needs a card, or minutes, or goes on until it is stopped; the command line's own tests parse it.
fn is_only_parsed(words: &[String]) -> bool {
    ["bench", "studio"].contains(&&*words[0]) || words.windows(2).any(|pair| pair == ["--backend", "gpu"])
}

fn shortened(words: &[String]) -> Vec<String> {
    let has = |wanted: &str| words.iter().any(|word| word == wanted);
    // A protocol says itself how much is asked.
    let missing = SHORT.iter().filter(|(command, option, _)| {
        words[0] == *command && !has(option) && !(has("--protocol") && *option == "--episodes")
    });
    let mut words = words.to_vec();
    // Several users show what one does not, and two are several.
    if let Some(at) = words.iter().position(|word| word == "--seeds") {
        words[at + 1] = "2".into();
    }
    words.extend(missing.flat_map(|(_, option, value)| [option.to_string(), value.to_string()]));
    words
}

fn run(folder: &Path, documented: &Documented, words: &[String]) {
    let output = Command::new(env!("CARGO_BIN_EXE_myo")).args(words).current_dir(folder).output().unwrap();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {:?} failed: {complaint}", documented.place, documented.words);
    if let Some(file) = documented.output() {
        std::fs::write(folder.join(file), output.stdout).unwrap();
    }
}

#[test]
fn every_block_runs_as_printed() {
    let (mut ran, mut parsed) = (0, 0);
    // What one document has trained from an empty folder, another that begins in the same way need not train again.
    let mut first_runs: Vec<(Vec<String>, tempfile::TempDir)> = vec![];
    for (file, text) in documents() {
        // A reader stays in one folder from the first line to the last.
        let folder = tempfile::tempdir().unwrap();
        let mut is_empty = true;
        for documented in commands(&file, &text).iter().filter(|documented| documented.in_block) {
            match documented.myo() {
                Some(words) if is_only_parsed(words) => parsed += 1,
                Some(words) => {
                    let words = shortened(words);
                    let known = first_runs.iter().find(|(other, _)| is_empty && *other == words);
                    match known {
                        Some((_, known)) => copy(known.path(), folder.path()),
                        None => run(folder.path(), documented, &words),
                    }
                    if is_empty && words[0] == "train" && known.is_none() {
                        let kept = tempfile::tempdir().unwrap();
                        copy(folder.path(), kept.path());
                        first_runs.push((words, kept));
                    }
                    is_empty = false;
                    ran += 1;
                }
                None if documented.words[0] == "sed" => run_sed(folder.path(), documented),
                None => check_other_program(documented),
            }
        }
    }
    assert!(ran >= 5 && parsed >= 1, "{ran} ran, {parsed} were only parsed");
}

/// Copies all that is in a folder.
fn copy(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let place = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            std::fs::create_dir_all(&place).unwrap();
            copy(&entry.path(), &place);
        } else {
            std::fs::copy(entry.path(), place).unwrap();
        }
    }
}

/// Makes one file of another, as the reader's shell does.
fn run_sed(folder: &Path, documented: &Documented) {
    let place = &documented.place;
    let (file, end) = (documented.output().expect(place), documented.words.len() - 2);
    let output = Command::new("sed").args(&documented.words[1..end]).current_dir(folder).output().expect(place);
    assert!(output.status.success() && !output.stdout.is_empty(), "{place}: {output:?}");
    assert!(
        output.stdout != std::fs::read(folder.join(&documented.words[end - 1])).unwrap(),
        "{place}: nothing changes"
    );
    std::fs::write(folder.join(file), output.stdout).unwrap();
}

#[test]
fn a_document_installs_the_program_before_it_uses_it() {
    for (file, text) in documents() {
        let found = commands(&file, &text);
        let installed = found.iter().position(Documented::installs).unwrap_or(found.len());
        if let Some(early) = found[..installed].iter().find(|documented| documented.needs_installed()) {
            panic!("{}: {:?} needs `cargo install --path myo` before", early.place, early.words);
        }
    }
}

/// Commands of other programs that the documents may show: that what they name is there.
fn check_other_program(documented: &Documented) {
    let words: Vec<&str> = documented.words.iter().map(String::as_str).collect();
    let place = &documented.place;
    match words[..] {
        // An option that the script does not know would be noticed by nobody.
        [script, ref options @ ..] if script.starts_with("./") => {
            let text = std::fs::read_to_string(repository().join(script)).expect(place);
            assert!(options.iter().all(|option| text.contains(option)), "{place}: {words:?}");
        }
        ["cargo", "install", ref options @ ..] => {
            let path = options.windows(2).find(|pair| pair[0] == "--path").expect(place)[1];
            assert!(repository().join(path).join("Cargo.toml").exists(), "{place}: {path}");
        }
        ["pip", "install", package, ..] => {
            let local = package.starts_with('.').then(|| package.split('[').next().unwrap());
            let text = std::fs::read_to_string(repository().join("pyproject.toml")).unwrap();
            assert!(local.is_some() || text.contains("name = \"myoenv\"") && package.starts_with("myoenv"), "{place}");
            let extra = package.split_once('[').map(|(_, extra)| format!("\n{} = [", extra.trim_end_matches(']')));
            assert!(extra.is_none_or(|extra| text.contains(&extra)), "{place}: {package}");
        }
        // Run by the tests of the Python package.
        ["python" | "python3", "-c", code] => assert!(code.contains("import myoenv"), "{place}"),
        ["python" | "python3", script, ..] => assert!(repository().join(script).exists(), "{place}: {script}"),
        ["cargo", "test" | "bench" | "nextest" | "build" | "doc", ..] | ["git" | "cd" | "mdbook", ..] => {}
        _ => panic!("{place}: this test does not know how to check {words:?}"),
    }
}

#[test]
fn what_a_document_shows_is_found() {
    let text = "\
Say `myo task list`, or `other`, or `myo train TASK [--seeds N]`.
```sh
myo task show ar > my.yaml    # a comment with `ticks`
cargo run --release -- train 'my task.yaml'

./test
```
```rust
let x = \"myo train\";
```
";
    let found = commands("a.md", text);
    let words: Vec<String> = found.iter().map(|documented| documented.words.join("|")).collect();
    let expected = ["myo|task|list", "myo|train|TASK|[--seeds|N]", "myo|task|show|ar|>|my.yaml"];
    assert_eq!(words[..3], expected);
    assert_eq!(words[3..], ["cargo|run|--release|--|train|my task.yaml", "./test"]);
    assert_eq!((found[2].output(), found[2].myo().unwrap().len(), found[3].output()), (Some("my.yaml"), 3, None));
    assert_eq!(found[2].place, "a.md:3");
    assert_eq!(documented::filled_in(found[1].myo().unwrap()), ["train", "ar", "--seeds", "3"]);
    assert!(found[4].myo().is_none() && found[2].needs_installed() && !found[3].needs_installed());
}
