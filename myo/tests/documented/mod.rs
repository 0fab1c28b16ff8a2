//! The commands that the documents show: lines of `sh` blocks, and code in the running text that begins with `myo ` or
//! `cargo install `.

use std::path::{Path, PathBuf};

/// A command in a document.
#[derive(Clone, Debug, PartialEq)]
pub struct Documented {
    /// File and line, as editors understand them.
    pub place: String,
    /// As a shell splits it, with `>` as a word of its own.
    pub words: Vec<String>,
    /// Of a block, to be typed as it stands; else it is mentioned in a sentence, maybe with `PLACEHOLDERS`.
    pub in_block: bool,
}

impl Documented {
    /// The words behind `myo`, without those that send the output elsewhere; none if it is another program's command.
    pub fn myo(&self) -> Option<&[String]> {
        let words: Vec<&str> = self.words.iter().map(String::as_str).collect();
        let skip = match words[..] {
            ["myo", ..] => 1,
            ["cargo", "run", "--release", "--", ..] => 4,
            _ => return None,
        };
        let end = words.iter().position(|word| *word == ">").unwrap_or(words.len());
        Some(&self.words[skip..end])
    }

    /// The file that the output goes to, if any.
    pub fn output(&self) -> Option<&str> {
        let at = self.words.iter().position(|word| word == ">")?;
        self.words.get(at + 1).map(String::as_str)
    }

    /// Whether the program `myo` must be installed for it.
    pub fn needs_installed(&self) -> bool {
        self.in_block && self.words[0] == "myo"
    }

    /// Whether it installs the program `myo`.
    pub fn installs(&self) -> bool {
        self.words.starts_with(&["cargo".into(), "install".into()])
    }
}

/// The repository.
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Every document of the repository with its text, README first.
pub fn documents() -> Vec<(String, String)> {
    let mut files = vec![repository().join("README.md"), repository().join("CONTRIBUTING.md")];
    collect(&repository().join("docs"), &mut files);
    let name = |file: &Path| file.strip_prefix(repository()).unwrap().display().to_string();
    files.iter().filter_map(|file| Some((name(file), std::fs::read_to_string(file).ok()?))).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|ending| ending == "md") {
            files.push(path);
        }
    }
}

/// The commands of a document, in order.
pub fn commands(file: &str, text: &str) -> Vec<Documented> {
    let (mut found, mut block) = (Vec::new(), None);
    for (index, line) in text.lines().enumerate() {
        let place = format!("{file}:{}", index + 1);
        let of = |text: &str, in_block| {
            // What a shell would refuse, such as an open quotation mark, must not be skipped.
            let words = shlex::split(text).unwrap_or_else(|| panic!("{place}: a shell cannot read `{text}`"));
            (!words.is_empty()).then(|| Documented { place: place.clone(), words, in_block })
        };
        match (line.trim_start().strip_prefix("```"), block) {
            (Some(language), None) => block = Some(matches!(language.trim(), "sh" | "bash" | "console")),
            (Some(_), Some(_)) => block = None,
            (None, Some(true)) => found.extend(of(line.trim_start_matches("$ "), true)),
            (None, Some(false)) => {}
            // Between backticks: every second piece.
            (None, None) => {
                let mentioned = line
                    .split('`')
                    .skip(1)
                    .step_by(2)
                    .filter(|code| code.starts_with("myo ") || code.starts_with("cargo install "));
                found.extend(mentioned.filter_map(|code| of(code, false)));
            }
        }
    }
    found
}

/// A mentioned command with what its author left open filled in, so that it can be parsed.
pub fn filled_in(words: &[String]) -> Vec<String> {
    let known = words.iter().map(|word| word.trim_matches(['[', ']'])).filter(|word| *word != "...");
    let fill = |word: &str| match word {
        "TASK" => "ar".into(),
        "N" => "3".into(),
        "RUN" => "runs/ar-1".into(),
        "SHELL" => "bash".into(),
        "COMMAND" => "train".into(),
        other => other.to_owned(),
    };
    known.map(fill).collect()
}
