//! Files that are whole or not there.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use tempfile::NamedTempFile;
use thiserror::Error;

/// Links in a row that are followed, as many as Linux follows.
const MOST_LINKS: usize = 40;

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
    /// A file operation that failed: `action` is what was tried, as in "cannot read".
    pub fn new(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self { action, path: path.to_owned(), source }
    }
}

/// Writes a file of a folder that no other process writes into: whoever reads `path` finds the old contents or the new
/// ones, also after a power cut; after a return, the new ones. What a killed process left unfinished is overwritten by the
/// next.
pub(crate) fn write_atomically(path: &Path, contents: &[u8]) -> Result<(), IoError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let part = path.with_file_name(name);
    let written = File::create(&part).and_then(|file| replace(path, (file, &part), None, contents));
    written.and_then(|()| sync_folder(path.parent())).map_err(|source| IoError::new("write", path, source))
}

/// Writes a file anywhere: whoever reads `path` finds the old contents or the new ones, also after a power cut. A link
/// stays, and the file that it leads to is written; a device or a pipe is written into; permissions are kept.
///
/// # Errors
/// The file is read-only, or it cannot be written; the old contents are still there then.
pub fn write_whole(path: &Path, contents: &[u8]) -> Result<(), IoError> {
    write_anywhere(path, contents).map_err(|source| IoError::new("write", path, source))
}

fn write_anywhere(path: &Path, contents: &[u8]) -> io::Result<()> {
    let path = behind_links(path)?;
    let before = match fs::metadata(&path) {
        Ok(before) => Some(before),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    if before.as_ref().is_some_and(|before| !before.is_file()) {
        return OpenOptions::new().write(true).open(&path)?.write_all(contents);
    }
    let permissions = before.map(|before| before.permissions());
    if permissions.as_ref().is_some_and(Permissions::readonly) {
        return Err(io::Error::new(ErrorKind::PermissionDenied, "the file is read-only"));
    }
    let (file, part) = new_file_in(path.parent().unwrap_or(Path::new("")))?.keep()?;
    replace(&path, (file, &part), permissions, contents)
}

/// A file of a name that is not taken, which others may read as far as this user's files are for them.
fn new_file_in(folder: &Path) -> io::Result<NamedTempFile> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut new = tempfile::Builder::new();
    new.suffix(".part");
    #[cfg(unix)]
    new.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    new.tempfile_in(folder)
}

/// Fills a new file beside `path`, waits until the disk has it, then renames it. Nothing is left of it where that fails: on
/// a full disk it would only take room.
fn replace(
    path: &Path,
    (mut file, part): (File, &Path),
    permissions: Option<Permissions>,
    contents: &[u8],
) -> io::Result<()> {
    let written = (|| {
        permissions.map_or(Ok(()), |permissions| file.set_permissions(permissions))?;
        file.write_all(contents)?;
        file.sync_all()?;
        fs::rename(part, path)
    })();
    // That it cannot be removed, either, is not what went wrong.
    written.inspect_err(|_| drop(fs::remove_file(part)))
}

/// What a path leads to, which need not be there.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        if !fs::symlink_metadata(&path).is_ok_and(|found| found.is_symlink()) {
            return Ok(path);
        }
        let to = fs::read_link(&path)?;
        path = path.parent().unwrap_or(Path::new("")).join(to);
    }
    Err(io::Error::other("links lead round in circles"))
}

/// Writes a value as indented JSON, as [`write_atomically`] does.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), IoError> {
    let mut text =
        serde_json::to_vec_pretty(value).map_err(|error| IoError::new("write", path, io::Error::other(error)))?;
    text.push(b'\n');
    write_atomically(path, &text)
}

/// Removes a file; that it is not there is no error.
pub fn remove_if_there(path: &Path) -> Result<(), IoError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != ErrorKind::NotFound => Err(IoError::new("remove", path, source)),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_as_a_whole_and_alone_in_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        for write in [write_atomically, write_whole] {
            write(&path, b"first").unwrap();
            let mut reader = File::open(&path).unwrap();
            write(&path, b"second").unwrap();
            assert_eq!(
                io::read_to_string(&mut reader).unwrap(),
                "first",
                "who had it open reads the old one to its end"
            );
            assert_eq!(fs::read(&path).unwrap(), b"second");
            assert_eq!(names(folder.path()), ["file"]);
        }
    }

    #[test]
    fn what_cannot_be_written_is_told_with_its_path_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("taken")).unwrap();
        for path in ["taken", "no/such/folder"] {
            let path = folder.path().join(path);
            for write in [write_atomically, write_whole] {
                let error = write(&path, b"contents").unwrap_err();
                assert!(error.to_string().starts_with(&format!("cannot write {}: ", path.display())), "{error}");
                assert_eq!(names(folder.path()), ["taken"]);
            }
        }
    }

    #[cfg(unix)]
    #[test]
    fn only_files_are_replaced() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
        fs::write(at("usual"), "").unwrap();
        write_whole(&at("new"), b"1").unwrap();
        assert_eq!(mode("new"), mode("usual"), "as open to others as files are here");

        fs::set_permissions(at("new"), Permissions::from_mode(0o640)).unwrap();
        for (link, target) in [("link", "new"), ("dangling", "later")] {
            symlink(target, at(link)).unwrap();
            write_whole(&at(link), b"2").unwrap();
            assert!(at(link).is_symlink());
            assert_eq!(fs::read_to_string(at(target)).unwrap(), "2");
        }
        assert_eq!(mode("new"), 0o640);
        symlink("round", at("about")).unwrap();
        symlink("about", at("round")).unwrap();
        assert!(write_whole(&at("about"), b"").unwrap_err().to_string().contains("links lead round in circles"));

        fs::set_permissions(at("new"), Permissions::from_mode(0o444)).unwrap();
        let error = write_whole(&at("new"), b"3").unwrap_err().to_string();
        assert!(error.ends_with("new: the file is read-only"), "{error}");
        assert_eq!(fs::read_to_string(at("new")).unwrap(), "2");
        write_whole(Path::new("/dev/null"), b"4").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
