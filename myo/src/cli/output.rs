//! Output: text, tables, JSON, files.

use std::fs::Permissions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::failure::{Failure, Result};

/// Links in a row that are followed, as many as Linux follows.
const MOST_LINKS: usize = 40;

/// Writes text to standard output as it is.
pub fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(Failure::OutputClosed),
        Err(error) => Err(Failure::sentence(format!("cannot write the output: {error}"))),
        Ok(()) => Ok(()),
    }
}

/// Writes a value as JSON that people can read, too.
pub fn print_json(value: &impl Serialize) -> Result<()> {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}

/// Writes a file that is whole or not there. A link stays and the file that it leads to is written; a device or pipe is
/// written into; a file that is read-only is refused.
pub fn write_file(path: &Path, text: &str) -> Result<()> {
    write_to(path, text).map_err(|error| Failure::sentence(format!("cannot write {}: {error}", path.display())))
}

fn write_to(path: &Path, text: &str) -> std::io::Result<()> {
    let path = behind_links(path)?;
    let before = match std::fs::metadata(&path) {
        Ok(before) => Some(before),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    if before.as_ref().is_some_and(|before| !before.is_file()) {
        return std::fs::OpenOptions::new().write(true).open(&path)?.write_all(text.as_bytes());
    }
    let permissions = before.map(|before| before.permissions());
    if permissions.as_ref().is_some_and(Permissions::readonly) {
        return Err(std::io::Error::new(ErrorKind::PermissionDenied, "the file is read-only"));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = new_file_in(folder)?;
    file.write_all(text.as_bytes())?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    file.persist(path)?;
    Ok(())
}

/// A file under another name for now, that others may read as far as this user's files are for them.
fn new_file_in(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        tempfile::Builder::new().permissions(Permissions::from_mode(0o666)).tempfile_in(folder)
    }
    #[cfg(not(unix))]
    tempfile::NamedTempFile::new_in(folder)
}

/// What a path leads to, which need not be there.
fn behind_links(path: &Path) -> std::io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        if !std::fs::symlink_metadata(&path).is_ok_and(|found| found.is_symlink()) {
            return Ok(path);
        }
        let to = std::fs::read_link(&path)?;
        path = path.parent().unwrap_or(Path::new("")).join(to);
    }
    Err(std::io::Error::other("links lead round in circles"))
}

/// Columns as wide as their widest cell, two spaces apart; the first row is the heading. Cells that begin with a digit
/// or a sign stand to the right.
pub fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| Some(row.get(column)?.chars().count())).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let numeric: Vec<bool> = (0..columns).map(|column| is_numeric(rows, column)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).zip(&numeric).map(|((cell, &width), &numeric)| match numeric {
            true => format!("{cell:>width$}"),
            false => format!("{cell:<width$}"),
        });
        format!("  {}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

fn is_numeric(rows: &[Vec<String>], column: usize) -> bool {
    let number = |cell: &String| cell.is_empty() || cell.starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c));
    rows.iter().skip(1).filter_map(|row| row.get(column)).all(number)
}

/// A row of a [`table`].
pub fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(String::from).to_vec()
}

/// A count with a comma every three digits.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().filter_map(|g| std::str::from_utf8(g).ok()).collect();
    groups.join(",")
}

/// A count or rate with three significant digits: `12.3 k`, `4.56 M`.
pub fn rounded(x: f64) -> String {
    let (x, unit) = match x.abs() {
        size if size >= 999.5e6 => (x / 1e9, " G"),
        size if size >= 999.5e3 => (x / 1e6, " M"),
        size if size >= 999.5 => (x / 1e3, " k"),
        _ => (x, ""),
    };
    let digits = if x.abs() >= 99.95 { 0 } else { 2 - usize::from(x.abs() >= 9.995) };
    format!("{x:.digits$}{unit}")
}

/// A duration for people: `4.2 s`, `3 min 05 s`, `2 h 10 min`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

/// A share as a percentage.
pub fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!((grouped(0), grouped(999), grouped(1_234_567)), ("0".into(), "999".into(), "1,234,567".into()));
        assert_eq!([12.0, 1234.0, 99_960.0, 4.56e6].map(rounded), ["12.0", "1.23 k", "100 k", "4.56 M"]);
        assert_eq!([4.21, 185.0, 7805.0].map(duration), ["4.2 s", "3 min 05 s", "2 h 10 min"]);
    }

    #[test]
    fn tables_align_words_left_and_numbers_right() {
        let rows = [row(["name", "n"]), row(["a", "10"]), row(["long", "9"])];
        assert_eq!(table(&rows), "  name   n\n  a     10\n  long   9\n");
    }
}
