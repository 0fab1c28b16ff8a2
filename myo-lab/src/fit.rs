//! Whether a user who was trained on one layout can act on another.

use std::fmt;

use myo_env::{BuildError, ObservationPart, Tables};
use myo_model::{Model, ModelDescription};
use myo_tasks::{RayFrom, Task, Technique};

/// A body with what it is to do.
#[derive(Clone, Copy, Debug)]
pub struct Setting<'a> {
    /// What it does.
    pub task: &'a Task,
    /// The body.
    pub model: &'a Model,
    /// Its description, unless it comes with the program under the name in the task.
    pub own_model: Option<&'a ModelDescription>,
}

/// Something in which a layout differs from the one that a user was trained on, so that the user cannot act there.
#[derive(Clone, Debug, PartialEq)]
pub enum Misfit {
    /// The body: its name in the task that was trained, and in the other.
    Body(String, String),
    /// What points: in the task that was trained, and in the other.
    Technique(String, String),
    /// Seconds between two decisions: in the task that was trained, and in the other.
    ControlStep(f64, f64),
    /// The policy perceives this part, and the other task has it not; and whether that is for its `observation` to say.
    Lacks(ObservationPart, bool),
    /// The other task has this part, and the policy does not know it; and whether that is for its `observation` to say.
    Unknown(ObservationPart, bool),
}

impl fmt::Display for Misfit {
    /// Half a sentence about the other layout.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Body(trained, other) if trained == other => write!(f, "its body is another {other}"),
            Self::Body(trained, other) => write!(f, "its body is {other} instead of {trained}"),
            Self::Technique(trained, other) => write!(f, "its technique is {other} instead of {trained}"),
            Self::ControlStep(trained, other) => write!(f, "its control step is {other} s instead of {trained} s"),
            Self::Lacks(part, is_chosen) => {
                write!(f, "`{}` cannot be perceived there{}", part.name(), reason(*part, *is_chosen))
            }
            Self::Unknown(part, is_chosen) => {
                write!(f, "`{}` is perceived there, and was not in training{}", part.name(), reason(*part, *is_chosen))
            }
        }
    }
}

/// Where there is such a part.
fn reason(part: ObservationPart, is_chosen: bool) -> String {
    match part.only_where() {
        Some(only_where) if !is_chosen => format!(" (it is there only {only_where})"),
        _ => format!(" (`observation.{}` of the task)", part.name()),
    }
}

/// All that keeps a user who was trained in one setting from acting in another; empty if nothing does. Where objects are, how many
/// there are, how many steps the script has and of which kinds may all differ, as long as the same parts are perceived.
///
/// # Errors
/// One of the tasks cannot be simulated.
pub fn misfits(trained: Setting<'_>, other: Setting<'_>) -> Result<Vec<Misfit>, BuildError> {
    let (old, new) = (trained.task, other.task);
    if !same_body(trained, other) {
        return Ok(vec![Misfit::Body(old.model.clone(), new.model.clone())]);
    }
    let mut misfits = vec![];
    let [a, b] = [&old.technique, &new.technique].map(words);
    if a != b {
        misfits.push(Misfit::Technique(a, b));
    }
    if (old.control_dt_s - new.control_dt_s).abs() > 1e-9 {
        misfits.push(Misfit::ControlStep(old.control_dt_s, new.control_dt_s));
    }
    let [known, there] = [parts(trained)?, parts(other)?];
    let is_chosen = |part: ObservationPart| asks_for(old, part) != asks_for(new, part);
    let missing = known.iter().filter(|part| !there.contains(part));
    misfits.extend(missing.map(|&part| Misfit::Lacks(part, is_chosen(part))));
    let unknown = there.iter().filter(|part| !known.contains(part));
    misfits.extend(unknown.map(|&part| Misfit::Unknown(part, is_chosen(part))));
    Ok(misfits)
}

/// Another size or strength of the same muscles of the same arm is the same body: what its user does there is the question.
fn same_body(a: Setting<'_>, b: Setting<'_>) -> bool {
    let muscles =
        |setting: Setting<'_>| setting.model.muscles.iter().map(|muscle| muscle.name.clone()).collect::<Vec<_>>();
    if muscles(a) != muscles(b) || a.model.has_left_arm() != b.model.has_left_arm() {
        return false;
    }
    match (a.own_model, b.own_model) {
        (None, None) => a.task.model == b.task.model,
        (own, other) => own == other,
    }
}

/// What is perceived.
fn parts(setting: Setting<'_>) -> Result<Vec<ObservationPart>, BuildError> {
    Ok(Tables::<f64>::new(setting.model, setting.task)?.observation)
}

/// Whether a part is wanted in the task file.
fn asks_for(task: &Task, part: ObservationPart) -> bool {
    let wanted = serde_json::to_value(&task.observation).unwrap_or_default();
    wanted[part.name()].as_bool().unwrap_or_default()
}

/// A technique without its numbers, for people.
fn words(technique: &Technique) -> String {
    match technique {
        Technique::Ray(ray) => {
            let from = match ray.from {
                RayFrom::Forearm => "forearm",
                RayFrom::Hand => "hand",
            };
            let onto = if ray.onto.is_some() { "onto a display" } else { "through space" };
            format!("a ray from the {from} {onto}")
        }
        other => other.name().into(),
    }
}

#[cfg(test)]
mod tests {
    use myo_model::builtin;
    use myo_tasks::{User, preset};

    use super::*;

    fn among(trained: &Task, other: &Task) -> Vec<String> {
        let body = |task: &Task| task.embody(&builtin(&task.model).unwrap()).unwrap();
        let (a, b) = (body(trained), body(other));
        let own = Setting { task: trained, model: &a, own_model: None };
        let there = Setting { task: other, model: &b, own_model: None };
        misfits(own, there).unwrap().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_user_may_be_tried_with_another_size_but_not_with_other_muscles() {
        let human = Task { model: "myo-arm".into(), ..preset("pointing").unwrap().done_by(User::Human) };
        let small = human.clone().done_by(User::SmallWoman);
        assert_eq!(among(&human, &small), Vec::<String>::new());
        assert_eq!(among(&human, &human.clone().done_by(User::LeftHanded)), ["its body is another myo-arm"]);
        let transferred = human.clone().done_by(User::TendonTransfer);
        assert_eq!(among(&human, &transferred), ["its body is another myo-arm"]);
    }
}
