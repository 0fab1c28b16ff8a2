//! Rules for what is no number: texts, lists and groups.

use crate::description::{FORMAT_VERSION, Observation, Stimulus, Task};
use crate::target::{TARGETS_MAX, Target};

pub(crate) fn version_rule(version: &u32, (): &()) -> garde::Result {
    match *version {
        1..=FORMAT_VERSION => Ok(()),
        other => Err(garde::Error::new(format!("is {other}; versions 1 to {FORMAT_VERSION} are known"))),
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

/// What a task of this version has, and what it must not have: path, subject and problem of the first thing wrong.
pub(crate) fn parts_rule(task: &Task) -> Option<(&'static str, &'static str, String)> {
    if task.version == 1 {
        let later = [
            ("scene", !task.scene.is_empty()),
            ("script", !task.script.is_empty()),
            ("technique", !task.technique.is_fingertip()),
            ("stimulus", task.stimulus != Stimulus::All),
            ("correction", task.correction.is_some()),
        ];
        if let Some((part, _)) = later.into_iter().find(|(_, is_there)| *is_there) {
            return Some((part, "a task of version 1", format!("has no {part}; write `version: 2`, or targets alone")));
        }
        return count_rule(&task.targets).map(|problem| ("targets", "the task", problem));
    }
    if task.version > FORMAT_VERSION {
        return None;
    }
    let problem =
        "has no targets; write what stands there as its `scene` and what is to do as its `script`, or `version: 1`";
    (!task.targets.is_empty()).then(|| ("targets", "a task of version 2", problem.into()))
}

fn count_rule(targets: &[Target]) -> Option<String> {
    match targets.iter().map(|target| target.repeat() as usize).sum() {
        1..=TARGETS_MAX => None,
        0 => Some(format!("has no target; a task has from 1 to {TARGETS_MAX}")),
        n => Some(format!("has {n} targets, repetitions counted; a task has from 1 to {TARGETS_MAX}")),
    }
}
