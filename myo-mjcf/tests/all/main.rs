//! Tests of what the crate promises, one module each.

mod copies;
mod files;
mod fuzzed;
mod limits;
mod messages;
mod mutations;
mod rules;
mod saved;

use myo_mjcf::{Limits, Mjcf, MjcfError, read_from};
use std::collections::BTreeMap;

/// Reads the first of these files.
fn read_files(files: &[(&str, &str)]) -> Result<Mjcf, MjcfError> {
    let map: BTreeMap<_, _> = files.iter().map(|(path, text)| (path.to_string(), text.to_string())).collect();
    read_from(&map, files[0].0, Limits::default())
}

/// Reads what stands within `<mujoco>`.
fn try_read(inside: &str) -> Result<Mjcf, MjcfError> {
    read_files(&[("m.xml", &format!("<mujoco>{inside}</mujoco>"))])
}

fn read(inside: &str) -> Mjcf {
    try_read(inside).unwrap_or_else(|error| panic!("{error}"))
}

/// Reads what stands within the world.
fn world(inside: &str) -> Mjcf {
    read(&format!("<worldbody>{inside}</worldbody>"))
}

fn message(inside: &str) -> String {
    match try_read(inside) {
        Ok(_) => panic!("no error in {inside}"),
        Err(error) => error.to_string(),
    }
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64]) {
    let close = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(close, "{found:?}, expected {expected:?}");
}
