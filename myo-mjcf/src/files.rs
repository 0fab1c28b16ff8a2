//! Where files come from: a folder that nothing may leave, or memory.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Files of a model, named by paths relative to its root folder, with `/` between names and no `.` or `..` in them.
pub trait Files {
    /// The text of a file, unless it has more than `most_bytes`.
    fn read(&self, path: &str, most_bytes: u64) -> Result<String, FileError>;
}

/// Why there is no text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// There is no such file.
    #[error("does not exist")]
    Missing,
    /// There is no folder to read from.
    #[error("is not read: the model is no file of a folder")]
    NoFolder,
    /// The path leaves the root folder.
    #[error("lies outside the folder of the model; give a larger root folder if it is meant")]
    Outside,
    /// The file is too large.
    #[error("has more than {limit} bytes")]
    TooLarge {
        /// The limit.
        limit: u64,
    },
    /// The file is no text in UTF-8.
    #[error("is not text in UTF-8")]
    NotUtf8,
    /// Something else.
    #[error("cannot be read: {message}")]
    Io {
        /// What the system said.
        message: String,
    },
}

/// Files below a folder. Symbolic links may not lead out of it.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
}

impl Folder {
    /// Files below `root`, which must exist.
    pub fn new(root: &Path) -> Result<Self, FileError> {
        Ok(Self { root: root.canonicalize().map_err(file_error)? })
    }

    /// A path of the system as the path below the root that [`Files`] takes.
    pub fn relative(&self, path: &Path) -> Result<String, FileError> {
        let path = path.canonicalize().map_err(file_error)?;
        let below = path.strip_prefix(&self.root).map_err(|_| FileError::Outside)?;
        let names: Option<Vec<_>> = below.iter().map(|name| name.to_str()).collect();
        names.map(|names| names.join("/")).ok_or(FileError::NotUtf8)
    }
}

impl Files for Folder {
    fn read(&self, path: &str, most_bytes: u64) -> Result<String, FileError> {
        String::from_utf8(self.bytes(path, most_bytes)?).map_err(|_| FileError::NotUtf8)
    }
}

impl Folder {
    /// The bytes of a file, unless it has more than `most_bytes`.
    pub(crate) fn bytes(&self, path: &str, most_bytes: u64) -> Result<Vec<u8>, FileError> {
        let full = self.root.join(join("", path).ok_or(FileError::Outside)?).canonicalize().map_err(file_error)?;
        if !full.starts_with(&self.root) {
            return Err(FileError::Outside);
        }
        // A device or a pipe may never end.
        if !fs::metadata(&full).map_err(file_error)?.is_file() {
            return Err(FileError::Io { message: "it is not a regular file".to_owned() });
        }
        let mut bytes = Vec::new();
        let file = File::open(&full).map_err(file_error)?;
        file.take(most_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(file_error)?;
        if bytes.len() as u64 > most_bytes {
            return Err(FileError::TooLarge { limit: most_bytes });
        }
        Ok(bytes)
    }
}

/// Files in memory, by path.
impl Files for BTreeMap<String, String> {
    fn read(&self, path: &str, most_bytes: u64) -> Result<String, FileError> {
        let text = self.get(path).ok_or(FileError::Missing)?;
        if text.len() as u64 > most_bytes {
            return Err(FileError::TooLarge { limit: most_bytes });
        }
        Ok(text.clone())
    }
}

fn file_error(error: io::Error) -> FileError {
    match error.kind() {
        io::ErrorKind::NotFound => FileError::Missing,
        _ => FileError::Io { message: error.to_string() },
    }
}

/// `path` seen from `folder`, without `.` and `..`; `None` if it is absolute or leaves the root.
pub(crate) fn join(folder: &str, path: &str) -> Option<String> {
    let path = path.replace('\\', "/");
    // A letter and a colon start an absolute path on Windows.
    if path.starts_with('/') || path.as_bytes().get(1) == Some(&b':') || path.contains('\0') {
        return None;
    }
    let mut names = Vec::new();
    for name in folder.split('/').chain(path.split('/')) {
        match name {
            "" | "." => {}
            ".." => drop(names.pop()?),
            name => names.push(name),
        }
    }
    Some(names.join("/"))
}

/// The folder that a file lies in; empty for the root.
pub(crate) fn folder_of(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_below_the_root() {
        assert_eq!(join("a/b", "../c/./d.xml").as_deref(), Some("a/c/d.xml"));
        assert_eq!(join("a", "..\\c.xml").as_deref(), Some("c.xml"));
        for path in ["../../c.xml", "/c.xml", "C:/c.xml", "\\c.xml"] {
            assert_eq!(join("a", path), None, "{path}");
        }
        assert_eq!((folder_of("a/b/c.xml"), folder_of("c.xml")), ("a/b", ""));
    }
}
