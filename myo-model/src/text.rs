//! Model files: YAML in and out.

use crate::ModelDescription;
use crate::error::ModelError;
use serde_saphyr::Error;

impl ModelDescription {
    /// Reads a model file. `file_name` only appears in error messages, in front of line and column.
    ///
    /// Keys, types and the ranges of single numbers are checked here, where their place in the file is known;
    /// [`Model::new`](crate::Model::new) checks what elements say about each other.
    pub fn from_yaml(text: &str, file_name: &str) -> Result<Self, ModelError> {
        serde_saphyr::from_str_valid(text).map_err(|error| read_error(&error, file_name))
    }

    /// The description as a model file; [`from_yaml`](Self::from_yaml) reads the very same description back.
    pub fn to_yaml(&self) -> Result<String, ModelError> {
        serde_saphyr::to_string(self).map_err(|error| ModelError::Write { message: error.to_string() })
    }
}

fn read_error(error: &Error, file_name: &str) -> ModelError {
    let (line, column) = error.location().map_or((1, 1), |place| (place.line(), place.column()));
    ModelError::Read { file: file_name.to_owned(), line, column, message: error.without_snippet().to_string() }
}
