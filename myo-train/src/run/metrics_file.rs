//! `metrics.csv`.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::RunError;
use crate::files::{IoError, write_atomically};

/// One row per update, one column per quantity, as comma-separated values.
///
/// Text, because a table of a thousand rows and thirty columns is 300 kB, which every tool reads without a library, and
/// because a row can be appended with a single write: a process killed in the middle leaves at most one line without its
/// end, which resuming cuts off. The first column is the step, so rows can be matched with checkpoints. Numbers are
/// written with as few digits as give the same number back; NaN is an empty cell.
#[derive(Debug)]
pub struct MetricsFile {
    path: PathBuf,
    file: File,
}

impl MetricsFile {
    /// Keeps the rows up to `env_steps` and goes on after them; begins the file where there is none.
    ///
    /// # Errors
    /// The file cannot be read or written, has other columns, or lines that this program does not write: nothing is cut off
    /// then.
    pub fn resume(path: &Path, columns: &[String], env_steps: u64) -> Result<Self, RunError> {
        let header = columns.join(",") + "\n";
        let text = match fs::read_to_string(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            Err(error) if error.kind() == ErrorKind::InvalidData => {
                return Err(RunError::BadMetrics { path: path.to_owned(), reason: "it is not text".into() });
            }
            text => text.map_err(|source| IoError::new("read", path, source))?,
        };
        let rows =
            rows(&text, columns, env_steps).map_err(|reason| RunError::BadMetrics { path: path.to_owned(), reason })?;
        let kept = header + &rows;
        if kept != text {
            write_atomically(path, kept.as_bytes())?;
        }
        let file = OpenOptions::new().append(true).open(path).map_err(|source| IoError::new("open", path, source))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Appends a row.
    pub fn append(&mut self, row: &[f64]) -> Result<(), IoError> {
        let cell = |x: &f64| if x.is_nan() { String::new() } else { x.to_string() };
        let line = row.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
        self.file.write_all(line.as_bytes()).map_err(|source| IoError::new("append to", &self.path, source))
    }

    /// Waits until the disk has all rows.
    pub fn sync(&self) -> Result<(), IoError> {
        self.file.sync_data().map_err(|source| IoError::new("write", &self.path, source))
    }
}

/// A column that tables of earlier programs lack.
const LATER: &str = "cost_share";

/// The rows of a table up to `env_steps`, without a last one that has no end. Those of a table of before there was the [later](LATER)
/// column have nothing there.
fn rows(text: &str, columns: &[String], env_steps: u64) -> Result<String, String> {
    let mut lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n')).enumerate();
    match lines.next() {
        None if text.is_empty() => return Ok(String::new()),
        Some((_, first)) if first.trim_end().split(',').eq(columns) => {}
        Some((_, first)) if first.trim_end().split(',').eq(columns.iter().filter(|&name| name != LATER)) => {
            return older_rows(text, columns, env_steps);
        }
        _ => return Err(format!("its first line does not name the columns of this run, {}", columns.join(","))),
    }
    let mut kept = String::new();
    for (index, line) in lines {
        let cells: Vec<_> = line.trim_end().split(',').collect();
        match cells[0].parse::<u64>() {
            Ok(step) if cells.len() == columns.len() && step <= env_steps => kept.push_str(line),
            Ok(_) if cells.len() == columns.len() => {}
            _ => {
                return Err(format!(
                    "line {} is not a row of {} numbers that begins with its step",
                    index + 1,
                    columns.len()
                ));
            }
        }
    }
    Ok(kept)
}

/// The rows of a table without the later column, with an empty one.
fn older_rows(text: &str, columns: &[String], env_steps: u64) -> Result<String, String> {
    let place = columns.iter().position(|name| name == LATER).unwrap_or(columns.len());
    let before: Vec<String> = columns.iter().filter(|&name| name != LATER).cloned().collect();
    let mut kept = String::new();
    for line in rows(text, &before, env_steps)?.lines() {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells.insert(place, "");
        kept.push_str(&(cells.join(",") + "\n"));
    }
    Ok(kept)
}
