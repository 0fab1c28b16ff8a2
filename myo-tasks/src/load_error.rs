//! Why a task could not be read.

use std::path::PathBuf;

use myo_model::Nearest;

use crate::layout::SourceLocation;
use crate::presets::preset_names;
use crate::report::TaskError;
use crate::spoken::spoken;

/// Why a task could not be read. Each message is one sentence (one per line for several values).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Neither a preset nor a file.
    #[error("there is no preset and no file called `{name}`; {}", Nearest::to(name, &preset_names()))]
    UnknownPreset {
        /// What was asked for.
        name: String,
    },
    /// The file could not be read.
    #[error("cannot read {}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        #[source]
        cause: std::io::Error,
    },
    /// A key that this part of a task does not have.
    #[error("{place}: unknown key `{key}`{}; {}", in_part(path), Nearest::to(key, valid))]
    UnknownKey {
        /// Where the key stands.
        place: SourceLocation,
        /// The key.
        key: String,
        /// The part of the task it stands in, such as `targets[1]`; empty at the top.
        path: String,
        /// All keys that are valid there.
        valid: Vec<&'static str>,
    },
    /// A word that is not among those a key allows.
    #[error("{place}: unknown value `{value}`{}; {}", in_part(path), Nearest::to(value, valid))]
    UnknownValue {
        /// Where the value stands.
        place: SourceLocation,
        /// The value.
        value: String,
        /// The part of the task it stands in.
        path: String,
        /// All words that are valid there.
        valid: Vec<&'static str>,
    },
    /// A key that must be there is not.
    #[error("{place}: the key `{key}`{} is missing", in_part(path))]
    MissingKey {
        /// Where the part that lacks it begins.
        place: SourceLocation,
        /// The key.
        key: &'static str,
        /// The part of the task that lacks it.
        path: String,
    },
    /// A value of the wrong type.
    #[error("{place}: {} is {found}; it must be {expected}", spoken(path))]
    WrongType {
        /// Where the value stands.
        place: SourceLocation,
        /// Its path, such as `targets[1].radius`.
        path: String,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// Not YAML.
    #[error("{place}: {message}")]
    Syntax {
        /// Where reading stopped.
        place: SourceLocation,
        /// What was found and what was expected.
        message: String,
    },
    /// Values that are out of bounds.
    #[error("{}", lines(values))]
    Values {
        /// All of them, in the order of the file.
        values: Vec<BadValue>,
    },
}

/// A value that is out of bounds.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {error}")]
pub struct BadValue {
    /// Where it stands.
    pub place: SourceLocation,
    /// What is wrong with it, such as `the radius of target 1 (pointing) is 0 m; it must be ...`.
    pub error: TaskError,
}

fn in_part(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!(" in {}", spoken(path)) }
}

fn lines(values: &[BadValue]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}
