//! Bodies by the names that tasks and people give them.

use std::io;
use std::path::{Path, PathBuf};

use myo_model::{ModelDescription, ModelError, builtin, builtin_names};
use thiserror::Error;

/// Why there is no model of a name.
#[derive(Debug, Error)]
pub enum ModelFileError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// MJCF does not say what tasks need to know of a body.
    #[error(
        "{path} is a model of MuJoCo; `myo model import {path} --fingertip SITE --shoulder BODY --out {stem}.yaml` makes a model file of it",
        path = path.display(), stem = path.with_extension("").display()
    )]
    Mjcf {
        /// The file.
        path: PathBuf,
    },
    /// What it says is no model, or no model comes with the program under this name.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// A model that comes with the program, or that of a file.
///
/// # Errors
/// There is neither, or the file is no model.
pub fn describe_model(name_or_file: &str) -> Result<ModelDescription, ModelFileError> {
    let path = Path::new(name_or_file);
    let looks_like_path = path.components().count() > 1 || path.extension().is_some();
    if builtin_names().contains(&name_or_file) || !(looks_like_path || path.exists()) {
        return Ok(builtin(name_or_file)?);
    }
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("xml")) && path.exists() {
        return Err(ModelFileError::Mjcf { path: path.to_owned() });
    }
    let text =
        std::fs::read_to_string(path).map_err(|source| ModelFileError::Read { path: path.to_owned(), source })?;
    Ok(ModelDescription::from_yaml(&text, name_or_file)?)
}

/// The description of a model that does not come with the program: its file may change, so runs keep it.
///
/// # Errors
/// As for [`describe_model`].
pub fn own_model(name_or_file: &str) -> Result<Option<ModelDescription>, ModelFileError> {
    if builtin_names().contains(&name_or_file) { Ok(None) } else { describe_model(name_or_file).map(Some) }
}
