//! Model files: YAML in and out.

use crate::ModelDescription;
use crate::error::ModelError;
use myo_nearest::Nearest;
use serde_saphyr::path_map::PathKind;
use serde_saphyr::{Error, MessageFormatter, UserMessageFormatter, ValidationIssue};

impl ModelDescription {
    /// Reads a model file. `file_name` only appears in error messages, in front of line and column.
    ///
    /// Keys, types and the ranges of single numbers are checked here, where their place in the file is known;
    /// [`Model::new`](crate::Model::new) checks what elements say about each other.
    pub fn from_yaml(text: &str, file_name: &str) -> Result<Self, ModelError> {
        serde_saphyr::from_str_valid(text).map_err(|error| read_error(error.without_snippet(), text, file_name))
    }

    /// The description as a model file; [`from_yaml`](Self::from_yaml) reads the very same description back.
    pub fn to_yaml(&self) -> Result<String, ModelError> {
        serde_saphyr::to_string(self).map_err(|error| ModelError::Write { message: error.to_string() })
    }
}

fn read_error(error: &Error, text: &str, file_name: &str) -> ModelError {
    let (line, column) = error.location().map_or((1, 1), |place| (place.line(), place.column()));
    let message = message(error, word_at(text, line, column));
    ModelError::Read { file: file_name.to_owned(), line, column, message }
}

/// What stands at a place of the text, up to the next white space, comma or bracket.
fn word_at(text: &str, line: u64, column: u64) -> &str {
    let before = |count: u64| usize::try_from(count.saturating_sub(1)).unwrap_or(usize::MAX);
    let line = text.lines().nth(before(line)).unwrap_or_default();
    let start = line.char_indices().nth(before(column)).map_or(line.len(), |(start, _)| start);
    line[start..].split([' ', '\t', ',', '[', ']', '{', '}']).next().unwrap_or_default()
}

fn message(error: &Error, word: &str) -> String {
    match error {
        Error::AliasError { error, .. } => message(error, word),
        Error::InvalidScalar { ty: "floating point", .. } => format!("`{word}` is not a number"),
        Error::InvalidScalar { ty, .. } => format!("`{word}` is not a {ty}"),
        Error::SerdeUnknownField { field, expected, .. } => unknown("key", field, expected),
        Error::SerdeUnknownVariant { variant, expected, .. } => unknown("value", variant, expected),
        Error::ValidationError { issues, .. } => out_of_range(issues, word),
        Error::ValidationErrors { errors, .. } if !errors.is_empty() => message(&errors[0], word),
        _ => UserMessageFormatter.format_message(error).into_owned(),
    }
}

fn unknown(what: &str, name: &str, valid: &[&str]) -> String {
    format!("unknown {what} `{name}`; {}", Nearest::to(name, valid))
}

/// The first issue in words; the others are counted.
fn out_of_range(issues: &[ValidationIssue], word: &str) -> String {
    let Some(first) = issues.first() else { return format!("`{word}` is out of range") };
    let rule = first.message.as_deref().unwrap_or(&first.code);
    let others = match issues.len() - 1 {
        0 => String::new(),
        count => format!(" ({count} more like this)"),
    };
    // A value that an alias brought in does not stand where it is used.
    let value = if word.parse::<f64>().is_ok() { format!("{word}, ") } else { String::new() };
    format!("`{}` is {value}{rule}{others}", path(first))
}

/// The path of an issue as `bodies[1].mass`.
fn path(issue: &ValidationIssue) -> String {
    let mut path = String::new();
    for (kind, name) in issue.path.segments() {
        match kind {
            PathKind::Index => path.extend(["[", name, "]"]),
            _ if path.is_empty() => path.push_str(name),
            _ => path.extend([".", name]),
        }
    }
    path
}
