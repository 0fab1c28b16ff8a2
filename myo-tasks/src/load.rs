//! Reading and writing task files.

use std::path::{Path, PathBuf};

use myo_model::builtin_names;
use serde_saphyr::options::NonFiniteFloatPolicy;
use serde_saphyr::{Error as YamlError, MessageFormatter, UserMessageFormatter};

use crate::check::{Reach, check, value_errors};
use crate::description::Task;
use crate::layout::{Layout, Position, SourceLocation};
use crate::presets::{preset_names, preset_text};
use crate::report::{Report, TaskError};
use crate::suggest::hint;

/// First line of a task file: it lets an editor that knows the YAML language server complete and check the file.
pub const SCHEMA_HINT: &str = "# yaml-language-server: $schema=./myo-task.schema.json";

/// Why a task could not be read. Each message is one sentence (one per line for several values).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// Neither a preset nor a file.
    #[error("there is no preset and no file called `{name}`; {}", hint(name, &preset_names()))]
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
    #[error("{place}: unknown key `{key}`{}; {}", in_part(path), hint(key, valid))]
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
    #[error("{place}: unknown value `{value}`{}; {}", in_part(path), hint(value, valid))]
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

/// Reads a preset or a file. A preset's name goes first; write `./ar` for a file called `ar`. A model file that the task
/// names is looked for in the folder of the task.
pub fn load(name_or_path: &str) -> Result<Source, LoadError> {
    if let Some(text) = preset_text(name_or_path) {
        return Source::parse(text, name_or_path);
    }
    let path = Path::new(name_or_path);
    let looks_like_path = path.components().count() > 1 || path.extension().is_some();
    if !looks_like_path && !path.exists() {
        return Err(LoadError::UnknownPreset { name: name_or_path.to_owned() });
    }
    let text = std::fs::read_to_string(path).map_err(|cause| LoadError::Io { path: path.to_owned(), cause })?;
    let mut source = Source::parse(&text, name_or_path)?;
    source.task.model = model_from(&source.task.model, path);
    Ok(source)
}

/// The model of a task file as seen from the working directory: paths in a file start at its folder.
fn model_from(model: &str, task_file: &Path) -> String {
    let looks_like_path = Path::new(model).components().count() > 1 || Path::new(model).extension().is_some();
    let beside = task_file.parent().unwrap_or(Path::new("")).join(model);
    let is_file = !builtin_names().contains(&model) && (looks_like_path || beside.is_file());
    if is_file { beside.to_string_lossy().into_owned() } else { model.to_owned() }
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
        // YAML 1.2, else the key `y` is quoted for readers that take it for "yes".
        let options = serde_saphyr::ser_options! { yaml_12: true, no_lang_directive: true };
        let body = serde_saphyr::to_string_with_options(&self.clone().collapsed(), options)
            .expect("every field of a task can be written");
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
    pub fn place(&self, path: &str) -> SourceLocation {
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
    let located = |error: TaskError| BadValue { place: place(name, layout.value(&error.path())), error };
    let mut values: Vec<BadValue> = value_errors(task).into_iter().map(located).collect();
    values.sort_by_key(|value| (value.place.line, value.place.column));
    if values.is_empty() { Ok(()) } else { Err(LoadError::Values { values }) }
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
                LoadError::UnknownKey { place: place(self.name, at), key: field.clone(), path, valid: expected.clone() }
            }
            YamlError::SerdeUnknownVariant { variant, expected, .. } => {
                let found = self.layout.and_then(|l| l.scalar("kind", variant, at));
                let (at, path) = found.unwrap_or_else(|| (at, self.path(at)));
                LoadError::UnknownValue {
                    place: place(self.name, at),
                    value: variant.clone(),
                    path,
                    valid: expected.clone(),
                }
            }
            YamlError::SerdeMissingField { field, .. } => {
                // The reader notices at the end of the map; people look for its beginning.
                let path = self.path(at);
                let begin = self.layout.map_or(at, |layout| layout.value(&path));
                LoadError::MissingKey { place: place(self.name, begin), key: field, path }
            }
            YamlError::DuplicateMappingKey { key: Some(key), .. } => {
                self.syntax(at, format!("the key `{key}` stands here a second time"))
            }
            other => {
                let entry = expected_type(other).and_then(|expected| Some((expected, self.layout?.entry(at)?)));
                match entry {
                    Some((expected, (path, at, found))) => {
                        LoadError::WrongType { place: place(self.name, at), path, found, expected }
                    }
                    None => self.syntax(at, UserMessageFormatter.format_message(other).into_owned()),
                }
            }
        }
    }

    fn syntax(&self, at: Position, message: String) -> LoadError {
        LoadError::Syntax { place: place(self.name, at), message }
    }

    fn path(&self, at: Position) -> String {
        self.layout.map(|layout| layout.path_at(at)).unwrap_or_default()
    }
}

/// What the reader wanted, in words; `None` when the mistake is not one of types.
fn expected_type(error: &YamlError) -> Option<String> {
    let expected = match error {
        YamlError::SerdeInvalidType { expected, .. }
        | YamlError::SerdeInvalidValue { expected, .. }
        | YamlError::SerdeInvalidLength { expected, .. } => expected,
        YamlError::InvalidScalar { ty, .. } => *ty,
        YamlError::Unexpected { expected, .. } => *expected,
        YamlError::InvalidBooleanStrict { .. } => "a boolean",
        YamlError::NullIntoString { .. } => "string scalar",
        _ => return None,
    };
    Some(match expected {
        "f64" | "floating point" => "a number".into(),
        "u32" | "integer" | "unsigned integer" => "a whole number, not negative".into(),
        "a boolean" => "true or false".into(),
        "string scalar" | "a string" => "text".into(),
        "sequence start" => "a list".into(),
        "mapping start" => "a group of keys".into(),
        other => other.replace("an array of length", "a list of length"),
    })
}

fn place(file: &str, (line, column): Position) -> SourceLocation {
    SourceLocation { file: file.to_owned(), line, column }
}

fn in_part(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!(" in {}", spoken(path)) }
}

/// `targets[1].position.x` as `` `position.x` of target 2 ``: people count from one.
fn spoken(path: &str) -> String {
    let target = path.strip_prefix("targets[").and_then(|rest| rest.split_once(']'));
    match target.and_then(|(index, field)| Some((index.parse::<usize>().ok()? + 1, field))) {
        Some((number, "")) => format!("target {number}"),
        Some((number, field)) => format!("`{}` of target {number}", field.trim_start_matches('.')),
        None => format!("`{path}`"),
    }
}

fn lines(values: &[BadValue]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}
