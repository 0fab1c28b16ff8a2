//! What tests of tasks share.

#![allow(dead_code, reason = "each test takes what it needs")]

pub mod run;

use myo_tasks::Task;

/// Presets as they were written in version 1 of the format: files of users still are.
pub const VERSION_1: [(&str, &str); 5] = [
    ("pointing", include_str!("../version-1/pointing.yaml")),
    ("pointing-single", include_str!("../version-1/pointing-single.yaml")),
    ("ar", include_str!("../version-1/ar.yaml")),
    ("public-display", include_str!("../version-1/public-display.yaml")),
    ("mobile-typing", include_str!("../version-1/mobile-typing.yaml")),
];

/// One of them.
pub fn version_1(name: &str) -> Task {
    let (_, text) = VERSION_1.iter().find(|(preset, _)| *preset == name).expect("one of the five");
    Task::from_yaml(text, name).unwrap()
}
