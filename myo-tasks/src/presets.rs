//! The tasks that come with the library.

use crate::description::Task;
use crate::load::Source;

macro_rules! presets {
    ($($name:literal),*) => {
        /// Name and text of each preset, in the order in which they are shown.
        const PRESETS: &[(&str, &str)] = &[$(($name, include_str!(concat!("../presets/", $name, ".yaml")))),*];
    };
}

presets!(
    "pointing",
    "pointing-single",
    "ar",
    "public-display",
    "mobile-typing",
    "ticket",
    "hello",
    "slider",
    "choice",
    "wall-ray",
    "pinch",
    "ar-pinch",
    "ar-menu",
    "chord",
    "hand-pointing",
    "hand-press",
    "pointing-uitb",
    "pointing-replication",
    "tracking-uitb",
    "choice-uitb",
    "driving-uitb"
);

/// Names of the presets.
pub fn preset_names() -> Vec<&'static str> {
    PRESETS.iter().map(|(name, _)| *name).collect()
}

/// The commented file of a preset, to be shown or edited.
pub fn preset_text(name: &str) -> Option<&'static str> {
    PRESETS.iter().find(|(preset, _)| *preset == name).map(|(_, text)| *text)
}

/// The task of a preset.
///
/// # Panics
/// Never: every preset is parsed by a test.
pub fn preset(name: &str) -> Option<Task> {
    let text = preset_text(name)?;
    Some(Source::parse(text, name).expect("the presets are valid").task)
}
