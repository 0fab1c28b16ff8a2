//! The YAML reader's errors in the words of tasks.

use serde_saphyr::{Error as YamlError, MessageFormatter, UserMessageFormatter};

use crate::layout::{Layout, Position, SourceLocation};
use crate::load_error::LoadError;

/// Costs per control step, which are read in old files and offered to nobody.
const OLD_COSTS: [&str; 3] = ["distance", "neural_effort", "acceleration_effort"];

/// Turns the reader's errors into ours; inside a target the reader knows the target's place only, the layout the key's.
pub(crate) struct Explain<'a> {
    pub(crate) name: &'a str,
    pub(crate) layout: Option<&'a Layout>,
}

impl Explain<'_> {
    pub(crate) fn error(&self, error: &YamlError) -> LoadError {
        let error = error.without_snippet();
        let at = error.location().map_or((1, 1), |location| (location.line(), location.column()));
        match error {
            YamlError::SerdeUnknownField { field, expected, .. } => {
                let (at, path) = self.layout.and_then(|l| l.key(field, at)).unwrap_or_else(|| (at, self.path(at)));
                let is_old = |key: &str| path == "reward" && OLD_COSTS.contains(&key);
                let valid = expected.iter().copied().filter(|key| !is_old(key)).collect();
                let place = SourceLocation::new(self.name, at);
                LoadError::UnknownKey { place, key: field.clone(), path, valid }
            }
            YamlError::SerdeUnknownVariant { variant, expected, .. } => {
                let found = self.layout.and_then(|l| l.scalar("kind", variant, at));
                let (at, path) = found.unwrap_or_else(|| (at, self.path(at)));
                LoadError::UnknownValue {
                    place: SourceLocation::new(self.name, at),
                    value: variant.clone(),
                    path,
                    valid: expected.clone(),
                }
            }
            YamlError::SerdeMissingField { field, .. } => {
                // The reader notices at the end of the map; people look for its beginning.
                let path = self.path(at);
                let begin = self.layout.map_or(at, |layout| layout.value(&path));
                LoadError::MissingKey { place: SourceLocation::new(self.name, begin), key: field, path }
            }
            YamlError::DuplicateMappingKey { key: Some(key), .. } => {
                self.syntax(at, format!("the key `{key}` stands here a second time"))
            }
            other => {
                let entry = expected_type(other).and_then(|expected| Some((expected, self.layout?.entry(at)?)));
                match entry {
                    Some((expected, (path, at, found))) => {
                        LoadError::WrongType { place: SourceLocation::new(self.name, at), path, found, expected }
                    }
                    None => self.syntax(at, UserMessageFormatter.format_message(other).into_owned()),
                }
            }
        }
    }

    fn syntax(&self, at: Position, message: String) -> LoadError {
        LoadError::Syntax { place: SourceLocation::new(self.name, at), message }
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
