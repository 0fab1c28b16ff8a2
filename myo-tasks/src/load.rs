//! Reading and writing task files.

use std::path::{Path, PathBuf};

use garde::Validate;
use serde_saphyr::options::NonFiniteFloatPolicy;
use serde_saphyr::{Error as YamlError, MessageFormatter, UserMessageFormatter};

use crate::check::{Reach, Report, check};
use crate::description::Task;
use crate::layout::{Layout, Place, Position};
use crate::presets::{preset_names, preset_text};
use crate::suggest::{hint, nearest};

/// First line of a task file: it lets an editor that knows the YAML language server complete and check the file.
pub const SCHEMA_HINT: &str = "# yaml-language-server: $schema=./myo-task.schema.json";

/// Why a task could not be read. Each message is one sentence (one per line for several values).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Neither a preset nor a file.
    #[error("there is no preset and no file called `{name}`; {}", hint(nearest, &preset_names()))]
    UnknownPreset {
        /// What was asked for.
        name: String,
        /// Presets with a similar name, the most similar first.
        nearest: Vec<String>,
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
    #[error("{place}: unknown key `{key}`{}; {}", in_part(path), hint(nearest, valid))]
    UnknownKey {
        /// Where the key stands.
        place: Place,
        /// The key.
        key: String,
        /// The part of the task it stands in, such as `targets[1]`; empty at the top.
        path: String,
        /// Valid keys with a similar name, the most similar first.
        nearest: Vec<String>,
        /// All keys that are valid there.
        valid: Vec<&'static str>,
    },
    /// A word that is not among those a key allows.
    #[error("{place}: unknown value `{value}`{}; {}", in_part(path), hint(nearest, valid))]
    UnknownValue {
        /// Where the value stands.
        place: Place,
        /// The value.
        value: String,
        /// The part of the task it stands in.
        path: String,
        /// Valid words that are similar.
        nearest: Vec<String>,
        /// All words that are valid there.
        valid: Vec<&'static str>,
    },
    /// A key that must be there is not.
    #[error("{place}: the key `{key}`{} is missing", in_part(path))]
    MissingKey {
        /// Where the part that lacks it begins.
        place: Place,
        /// The key.
        key: &'static str,
        /// The part of the task that lacks it.
        path: String,
    },
    /// Not YAML, or a value of the wrong type.
    #[error("{place}: {message}")]
    Syntax {
        /// Where reading stopped.
        place: Place,
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
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {path} {problem}")]
pub struct BadValue {
    /// Where it stands.
    pub place: Place,
    /// Its path, such as `targets[1].radius`.
    pub path: String,
    /// The value and what would be right, such as `is 0 m; it must be greater than 0 and at most 2 m`.
    pub problem: String,
}

/// A task together with the text it was read from.
#[derive(Clone, Debug)]
pub struct Source {
    /// File name, or the name of the preset.
    pub name: String,
    /// The text as it was written, comments included.
    pub text: String,
    /// What it says, repeated targets written out.
    pub task: Task,
    layout: Layout,
    /// For each target of `task`, its index in the text.
    origin: Vec<usize>,
}

/// Reads a preset or a file. A preset's name goes first; write `./ar` for a file called `ar`.
pub fn load(name_or_path: &str) -> Result<Source, LoadError> {
    if let Some(text) = preset_text(name_or_path) {
        return Source::parse(text, name_or_path);
    }
    let path = Path::new(name_or_path);
    let looks_like_path = path.components().count() > 1 || path.extension().is_some();
    if !looks_like_path && !path.exists() {
        let nearest = nearest(name_or_path, &preset_names());
        return Err(LoadError::UnknownPreset { name: name_or_path.to_owned(), nearest });
    }
    let text = std::fs::read_to_string(path).map_err(|cause| LoadError::Io { path: path.to_owned(), cause })?;
    Source::parse(&text, name_or_path)
}

impl Task {
    /// Reads a task file's text. `file_name` is used in messages only.
    pub fn from_yaml(text: &str, file_name: &str) -> Result<Self, LoadError> {
        Source::parse(text, file_name).map(|source| source.task)
    }

    /// The task as a file, without comments. The commented file of a preset is [`preset_text`].
    ///
    /// # Panics
    /// Never: all fields have a form in YAML.
    pub fn to_yaml(&self) -> String {
        let body = serde_saphyr::to_string(self).expect("every field of a task can be written");
        format!("{SCHEMA_HINT}\n{body}")
    }
}

impl Source {
    /// Reads a task file's text. `name` is used in messages only.
    pub fn parse(text: &str, name: &str) -> Result<Self, LoadError> {
        let layout = Layout::of(text);
        let task: Task = serde_saphyr::from_str_with_options(text, yaml_options())
            .map_err(|error| Explain { name, layout: layout.as_ref() }.error(&error))?;
        // A text that yields a task is YAML, so it has a layout.
        let layout = layout.ok_or_else(|| LoadError::Syntax {
            place: place(name, (1, 1)),
            message: "the file cannot be read a second time to find positions".into(),
        })?;
        check_values(&task, name, &layout)?;
        let origin =
            (0..task.targets.len()).flat_map(|i| std::iter::repeat_n(i, task.targets[i].repeat() as usize)).collect();
        Ok(Self { name: name.to_owned(), text: text.to_owned(), task: task.expanded(), layout, origin })
    }

    /// Everything that [`check`] finds.
    pub fn check(&self, reach: &dyn Reach) -> Report {
        check(&self.task, reach)
    }

    /// Where the value at `path` of [`Source::task`] stands in the text, as the paths of errors and warnings say it.
    pub fn place(&self, path: &str) -> Place {
        place(&self.name, self.layout.value(&self.path_in_text(path)))
    }

    /// All sentences of a report, errors first, each behind the place it speaks of.
    pub fn messages(&self, report: &Report) -> Vec<String> {
        let errors = report.errors.iter().map(|error| format!("{}: {error}", self.place(&error.path())));
        let warnings = report.warnings.iter().map(|w| format!("{}: warning: {w}", self.place(&w.path())));
        errors.chain(warnings).collect()
    }

    /// Repeated targets count once in the text.
    fn path_in_text(&self, path: &str) -> String {
        let renumbered = path.strip_prefix("targets[").and_then(|rest| {
            let (index, tail) = rest.split_once(']')?;
            let index = self.origin.get(index.parse::<usize>().ok()?)?;
            Some(format!("targets[{index}]{tail}"))
        });
        renumbered.unwrap_or_else(|| path.to_owned())
    }
}

fn check_values(task: &Task, name: &str, layout: &Layout) -> Result<(), LoadError> {
    let Err(report) = task.validate() else { return Ok(()) };
    let mut values: Vec<BadValue> = report
        .iter()
        .map(|(path, error)| {
            let path = path.to_string();
            BadValue { place: place(name, layout.value(&path)), path, problem: error.message().to_owned() }
        })
        .collect();
    values.sort_by_key(|value| (value.place.line, value.place.column));
    Err(LoadError::Values { values })
}

/// Options for every reading: numbers such as `.nan` come through, so that they are refused with a sentence of our own.
pub(crate) fn yaml_options() -> serde_saphyr::Options {
    serde_saphyr::options! {
        with_snippet: false,
        strict_booleans: true,
        non_finite_float_policy: NonFiniteFloatPolicy::PassThrough,
    }
}

/// Turns the reader's errors into ours; inside a target the reader knows the target's place only, the layout the key's.
struct Explain<'a> {
    name: &'a str,
    layout: Option<&'a Layout>,
}

impl Explain<'_> {
    fn error(&self, error: &YamlError) -> LoadError {
        let error = error.without_snippet();
        let at = error.location().map_or((1, 1), |location| (location.line(), location.column()));
        match error {
            YamlError::SerdeUnknownField { field, expected, .. } => {
                let (at, path) = self.layout.and_then(|l| l.key(field, at)).unwrap_or_else(|| (at, self.path(at)));
                LoadError::UnknownKey {
                    place: place(self.name, at),
                    key: field.clone(),
                    path,
                    nearest: nearest(field, expected),
                    valid: expected.clone(),
                }
            }
            YamlError::SerdeUnknownVariant { variant, expected, .. } => {
                let found = self.layout.and_then(|l| l.scalar("kind", variant, at));
                let (at, path) = found.unwrap_or_else(|| (at, self.path(at)));
                LoadError::UnknownValue {
                    place: place(self.name, at),
                    value: variant.clone(),
                    path,
                    nearest: nearest(variant, expected),
                    valid: expected.clone(),
                }
            }
            YamlError::SerdeMissingField { field, .. } => {
                LoadError::MissingKey { place: place(self.name, at), key: field, path: self.path(at) }
            }
            other => LoadError::Syntax {
                place: place(self.name, at),
                message: UserMessageFormatter.format_message(other).into_owned(),
            },
        }
    }

    fn path(&self, at: Position) -> String {
        self.layout.map(|layout| layout.path_at(at)).unwrap_or_default()
    }
}

fn place(file: &str, (line, column): Position) -> Place {
    Place { file: file.to_owned(), line, column }
}

fn in_part(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!(" in {path}") }
}

fn lines(values: &[BadValue]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}
