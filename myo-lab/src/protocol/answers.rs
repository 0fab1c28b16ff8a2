//! Answers that are kept in the folder of a run, beside the users who gave them.

use std::path::{Path, PathBuf};
use std::{fs, io};

/// Names of all answers, in the order in which they are told.
const NAMES: [&str; 18] =
    ["bands", "F1", "K1", "K2", "K3", "K4", "K5", "C1", "S1", "S2", "I1", "I2", "T1", "T3", "M1", "E1", "E2", "E3"];

/// What was answered last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptAnswer {
    /// Name of the protocol, or `bands`.
    pub name: &'static str,
    /// The answer as `myo eval` prints it.
    pub text: String,
    /// Its plot (SVG), if it has one.
    pub plot: Option<String>,
}

/// Where an answer to a protocol is kept in the folder of a run: `txt`, and `svg` and `png` of its plot.
pub fn answer_path(run: &Path, protocol: &str, ending: &str) -> PathBuf {
    run.join("protocols").join(format!("{protocol}.{ending}"))
}

/// What the user of a run, and others with other seeds, answered last; nothing before they are asked.
///
/// # Errors
/// A file is there and cannot be read.
pub fn kept_answers(run: &Path) -> io::Result<Vec<KeptAnswer>> {
    let read = |name, ending| match fs::read_to_string(answer_path(run, name, ending)) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    };
    let answer = |name| {
        let Some(text) = read(name, "txt")? else { return Ok(None) };
        Ok(Some(KeptAnswer { name, text, plot: read(name, "svg")? }))
    };
    NAMES.into_iter().filter_map(|name| answer(name).transpose()).collect()
}
