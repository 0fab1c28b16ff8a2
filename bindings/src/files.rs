//! Files that are whole or not there.

use std::path::PathBuf;

use myo::train;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

/// Writes a file so that whoever looks, whenever, finds the old contents or all of the new ones.
///
/// A link is followed, a file that must not be written is refused, and anything else than a regular file, such as a pipe, is
/// written to directly.
#[pyfunction]
pub fn write_whole(py: Python<'_>, path: PathBuf, contents: &[u8]) -> PyResult<()> {
    // Whoever reads a pipe may be a thread of the interpreter.
    py.detach(|| train::write_whole(&path, contents)).map_err(|refusal| {
        let text = refusal.to_string();
        match refusal.source.raw_os_error() {
            // Python chooses the exception by the number.
            Some(number) => PyOSError::new_err((number, text)),
            None => std::io::Error::new(refusal.source.kind(), text).into(),
        }
    })
}
