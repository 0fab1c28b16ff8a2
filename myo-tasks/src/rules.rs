//! Rules for what is no number: texts, lists and groups.

use crate::description::{FORMAT_VERSION, Observation};
use crate::target::{TARGETS_MAX, Target};

pub(crate) fn version_rule(version: &u32, (): &()) -> garde::Result {
    match *version {
        FORMAT_VERSION => Ok(()),
        other => Err(garde::Error::new(format!("is {other}; only version {FORMAT_VERSION} is known"))),
    }
}

pub(crate) fn name_rule(name: &str, (): &()) -> garde::Result {
    text_rule(name, 1, 64, "")
}

pub(crate) fn model_rule(model: &str, (): &()) -> garde::Result {
    text_rule(model, 1, 4096, "")
}

pub(crate) fn description_rule(description: &str, (): &()) -> garde::Result {
    text_rule(description, 0, 10_000, "\n\t")
}

/// A text of so many characters that does nothing but stand there when it is printed.
fn text_rule(text: &str, least: usize, most: usize, allowed: &str) -> garde::Result {
    let n = text.chars().count();
    if n < least || n > most {
        return Err(garde::Error::new(format!("has {n} characters; it must have from {least} to {most}")));
    }
    match text.chars().find(|c| c.is_control() && !allowed.contains(*c)) {
        Some(c) => Err(garde::Error::new(format!(
            "has the control character U+{:04X}, which a terminal would obey; leave it out",
            u32::from(c)
        ))),
        None => Ok(()),
    }
}

pub(crate) fn observation_rule(observation: &Observation, (): &()) -> garde::Result {
    match observation.parts().iter().any(|(_, wanted)| *wanted) {
        true => Ok(()),
        false => Err(garde::Error::new("has no part; at least one must be true")),
    }
}

pub(crate) fn count_rule(targets: &[Target], (): &()) -> garde::Result {
    match targets.iter().map(|target| target.repeat() as usize).sum() {
        1..=TARGETS_MAX => Ok(()),
        0 => Err(garde::Error::new(format!("has no target; a task has from 1 to {TARGETS_MAX}"))),
        n => {
            Err(garde::Error::new(format!("has {n} targets, repetitions counted; a task has from 1 to {TARGETS_MAX}")))
        }
    }
}
