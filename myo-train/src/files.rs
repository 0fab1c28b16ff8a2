//! Files that are whole or not there.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use thiserror::Error;

/// A file operation that failed.
#[derive(Debug, Error)]
#[error("cannot {action} {}: {source}", path.display())]
pub struct IoError {
    /// What was tried.
    pub action: &'static str,
    /// On which file.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

impl IoError {
    pub(crate) fn new(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self { action, path: path.to_owned(), source }
    }
}

/// Writes `contents` beside `path`, waits until the disk has them, then renames: whoever reads `path` finds the old
/// contents or the new ones, also after a power cut.
pub fn write_atomically(path: &Path, contents: &[u8]) -> Result<(), IoError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let written = (|| {
        let mut file = File::create(&part)?;
        file.write_all(contents)?;
        file.sync_all()?;
        fs::rename(&part, path)?;
        sync_folder(path.parent())
    })();
    written.map_err(|source| {
        // On a full disk, what was begun only takes room. That it cannot be removed, either, is not what went wrong.
        let _ = fs::remove_file(&part);
        IoError::new("write", path, source)
    })
}

/// Writes a value as indented JSON, as [`write_atomically`] does.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), IoError> {
    let mut text =
        serde_json::to_vec_pretty(value).map_err(|error| IoError::new("write", path, io::Error::other(error)))?;
    text.push(b'\n');
    write_atomically(path, &text)
}

/// Removes a file; that it is not there is no error.
pub fn remove_if_there(path: &Path) -> Result<(), IoError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(IoError::new("remove", path, source)),
        _ => Ok(()),
    }
}

/// Waits until the disk knows the names in a folder, where the system allows that.
pub fn sync_folder(folder: Option<&Path>) -> io::Result<()> {
    match folder.filter(|folder| cfg!(unix) && !folder.as_os_str().is_empty()) {
        Some(folder) => File::open(folder)?.sync_all(),
        None => Ok(()),
    }
}
