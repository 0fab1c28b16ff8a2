//! What [`check`](crate::check()) finds, one type per cause, one sentence each.

use std::fmt;

use crate::description::Task;
use crate::flat::FlatTask;
use crate::remedy::{Place, Remedy};
use crate::spoken::{component, spoken};
use crate::target::Region;

/// What is wrong with a task and what is odd about it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The task cannot be trained.
    pub errors: Vec<TaskError>,
    /// The task can be trained, but probably not as intended.
    pub warnings: Vec<TaskWarning>,
}

impl Report {
    /// Whether training may start.
    pub fn is_ok(&self) -> bool {
        self.errors.is_empty()
    }
}

/// One object or step, or several equal ones in a row; `target 3 (pressing)`, `targets 1 to 10 (pointing)`, `panel.ok`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    /// Index of the first object or step, from 0.
    pub first: usize,
    /// Index of the last.
    pub last: usize,
    /// What it is: `sphere`, `button` or `obstacle`.
    pub kind: &'static str,
    /// What people call it.
    pub label: String,
    /// Path in the file of what describes it.
    pub path: String,
}

impl Element {
    /// An object, or equal ones in a row.
    pub(crate) fn objects(flat: &FlatTask, first: usize, last: usize) -> Self {
        let object = &flat.objects[first];
        let label = match (first == last, object.is_target()) {
            (true, _) => object.name.clone(),
            (false, true) => {
                let kind = if object.kind() == "sphere" { "pointing" } else { "pressing" };
                format!("targets {} to {} ({kind})", first + 1, last + 1)
            }
            (false, false) => format!("{} to {}", object.name, flat.objects[last].name),
        };
        Self { first, last, kind: object.kind(), label, path: object.path.clone() }
    }

    /// Steps in a row that ask the same of equal objects.
    pub(crate) fn steps(flat: &FlatTask, first: usize, last: usize) -> Self {
        let (from, to) = (&flat.steps[first], &flat.steps[last]);
        let objects = Self::objects(flat, from.object, to.object.max(from.object));
        let label = if flat.object(first).is_target() {
            objects.label
        } else if first == last {
            format!("step {} ({})", first + 1, flat.label(first))
        } else {
            format!("steps {} to {} ({})", first + 1, last + 1, flat.words(first, &objects.label))
        };
        Self { first, last, label, path: from.path.clone(), ..objects }
    }

    /// Whether it is a button, of which the face counts.
    fn is_button(&self) -> bool {
        self.kind == "button"
    }

    /// Path of one of its fields: of its place (`at`), of its dwell (`for_s`), or another one.
    pub(crate) fn field(&self, field: &str) -> String {
        let is_target = self.path.starts_with("targets[");
        let field = match field {
            "at" if is_target => "position",
            "for_s" if is_target => "dwell_s",
            other => other,
        };
        format!("{}.{field}", self.path)
    }
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.label)
    }
}

/// A task that cannot be run; one sentence and line for each value that is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct InvalidTask {
    /// What is wrong, in the order of the fields.
    pub errors: Vec<TaskError>,
}

impl From<TaskError> for InvalidTask {
    fn from(error: TaskError) -> Self {
        Self { errors: vec![error] }
    }
}

/// Why a task cannot be trained; each is one sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// A value is out of bounds, NaN or infinite, a range is upside down, or there are too few or too many targets.
    #[error("{subject} {problem}")]
    Value {
        /// Path of the value, such as `targets[1].radius`.
        path: String,
        /// The value's name for people, such as `the radius of target 2 (pointing)`.
        subject: String,
        /// The value and what would be right.
        problem: String,
    },
    /// The control step is not a whole number of the model's physics steps.
    #[error(
        "`control_dt_s` is {control_dt_s} s, which is not a whole multiple of the model's physics step of {physics_dt_s} s; \
         take {}",
        nearest_steps(nearest)
    )]
    UnevenControlStep {
        /// The task's control step.
        control_dt_s: f64,
        /// The model's physics step.
        physics_dt_s: f64,
        /// The nearest shorter control step that fits, 0 if there is none, and the nearest longer one.
        nearest: [f64; 2],
    },
    /// One dwell alone is longer than the episode.
    #[error(
        "{target} needs a dwell of {dwell_s} s but the time limit is {time_limit_s} s; raise the limit or shorten the dwell"
    )]
    DwellBeyondLimit {
        /// The target.
        target: Element,
        /// Its dwell.
        dwell_s: f64,
        /// The task's limit.
        time_limit_s: f64,
    },
    /// A dwell is longer than its step may take.
    #[error(
        "{target} needs a dwell of {dwell_s} s but a step is given up after {limit_s} s (step_limit_s); raise the limit or shorten the dwell"
    )]
    DwellBeyondStepLimit {
        /// The target.
        target: Element,
        /// Its dwell.
        dwell_s: f64,
        /// How long a step may take (s).
        limit_s: f64,
    },
    /// All dwells together are longer than the episode.
    #[error(
        "the dwells{} of all targets add up to {dwells_s:.2} s but the time limit is {time_limit_s} s; raise the limit or shorten the dwells",
        if *waits { " and waits" } else { "" }
    )]
    DwellsBeyondLimit {
        /// Sum of the dwells and of the shortest waits.
        dwells_s: f64,
        /// Whether there are waits.
        waits: bool,
        /// The task's limit.
        time_limit_s: f64,
    },
    /// No position keeps the least distance from the target before.
    #[error(
        "{target} must lie at least {needed} m from {previous}, but their ranges allow no more than {possible:.3} m; \
         widen a range or lower `min_distance_from_previous`"
    )]
    DistanceImpossible {
        /// The target.
        target: Element,
        /// The one before it.
        previous: Box<Element>,
        /// The rule in m.
        needed: f64,
        /// Greatest distance in m that the two ranges allow.
        possible: f64,
    },
    /// Two solid boxes that stand in each other.
    #[error("{a} and {b} overlap by {:.1} mm; move one of them, or make it smaller", 1e3 * overlap_m)]
    Overlap {
        /// The earlier box.
        a: Element,
        /// The later box.
        b: Box<Element>,
        /// How far in m one of them must be moved at least.
        overlap_m: f64,
    },
    /// A sphere moves to where it cannot be reached.
    #[error(
        "the path of {target} leaves the reach of the model: at ({:.2}, {:.2}, {:.2}) m {} by {:.1} cm; {}",
        worst[0], worst[1], worst[2], hull(target), 100.0 * beyond_m, advice(target, remedy)
    )]
    PathOutOfReach {
        /// The target.
        target: Element,
        /// The place of its path that is farthest out, in m relative to the shoulder centre.
        worst: [f64; 3],
        /// How far out of reach the surface of the smallest sphere is there, in m.
        beyond_m: f64,
        /// What brings all of it into reach.
        remedy: Box<Remedy>,
    },
    /// No part of the target can be reached.
    #[error(
        "{target} {} out of reach of the model: at ({:.2}, {:.2}, {:.2}) m {} by {:.1} cm; {}",
        is_or_are(target), worst[0], worst[1], worst[2], hull(target), 100.0 * beyond_m, advice(target, remedy)
    )]
    OutOfReach {
        /// The target.
        target: Element,
        /// The place in its range that is farthest out, in m relative to the shoulder centre.
        worst: [f64; 3],
        /// How far out of reach the button's face, or the surface of the smallest sphere, is there, in m.
        beyond_m: f64,
        /// What brings all of it into reach.
        remedy: Box<Remedy>,
    },
}

/// What is odd about a task that can be trained; each is one sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TaskWarning {
    /// Few positions keep the least distance, so drawing one takes long or fails.
    #[error(
        "only {:.1} % of the positions of {target} lie at least {needed} m from {previous}; \
         widen a range or lower `min_distance_from_previous`", 100.0 * acceptance
    )]
    DistanceRare {
        /// The target.
        target: Element,
        /// The one before it.
        previous: Element,
        /// The rule in m.
        needed: f64,
        /// Share of independent draws that keep it.
        acceptance: f64,
    },
    /// Some positions of the target before leave no room for this one.
    #[error(
        "{:.1} % of the positions of {previous} leave no position for {target} at least {needed} m away; \
         widen a range or lower `min_distance_from_previous`", 100.0 * dead_ends
    )]
    DistanceDeadEnds {
        /// The target.
        target: Element,
        /// The one before it.
        previous: Element,
        /// The rule in m.
        needed: f64,
        /// Share of such positions.
        dead_ends: f64,
    },
    /// Part of a target's range cannot be reached.
    #[error(
        "{:.1} % of {}{target} is out of reach of the model, {}most at ({:.2}, {:.2}, {:.2}) m, {} by {:.1} cm; {}",
        100.0 * fraction, part_of(*is_drawn), within(missed), worst[0], worst[1], worst[2], hull(target), 100.0 * beyond_m,
        advice(target, remedy)
    )]
    PartlyOutOfReach {
        /// The target.
        target: Element,
        /// Whether it may lie in a range of places, as spheres may; else it is its face that is reached in part.
        is_drawn: bool,
        /// Share of positions and sizes, or of the face of a button that stands still, that cannot be reached.
        fraction: f64,
        /// A box around all positions that cannot be reached, in m relative to the shoulder centre.
        missed: Region,
        /// The place that is farthest out, in m relative to the shoulder centre.
        worst: [f64; 3],
        /// How far out of reach the button's face, or the surface of the smallest sphere, is there, in m.
        beyond_m: f64,
        /// What brings all of it into reach.
        remedy: Box<Remedy>,
    },
    /// Muscles cannot hold the fingertip still in part of a sphere's range, or all of it.
    #[error(
        "muscles cannot hold the fingertip still in {}{target}, such as at ({:.2}, {:.2}, {:.2}) m, so that it has to pass \
         through and needs {dwell_s} s inside; {}",
        share_of(*fraction), place[0], place[1], place[2],
        held.as_ref().map_or_else(|| "nor at any place tried up to 20 cm away".into(), ToString::to_string)
    )]
    CannotHold {
        /// The target.
        target: Element,
        /// Share of the places tried.
        fraction: f64,
        /// The first such place, in m relative to the shoulder centre.
        place: [f64; 3],
        /// The target's dwell.
        dwell_s: f64,
        /// Where they can.
        held: Option<HeldPlace>,
    },
    /// A time that is not a whole number of control steps.
    #[error("{what} of {given_s} s is not a whole number of control steps and counts as {used_s:.4} s ({steps} steps)")]
    Rounded {
        /// What it is the time of, such as `the dwell of target 1 (pointing)`.
        what: String,
        /// Its path.
        path: String,
        /// As written.
        given_s: f64,
        /// As simulated.
        used_s: f64,
        /// As simulated, in control steps.
        steps: u32,
    },
}

/// A place near a sphere in which muscles can hold the fingertip still.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldPlace {
    /// In m relative to the shoulder centre.
    pub point: [f64; 3],
    /// How far away (m).
    pub by_m: f64,
    /// Which way, in words.
    pub way: &'static str,
}

impl fmt::Display for HeldPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([x, y, z], centimetres) = (self.point, 100.0 * self.by_m);
        write!(f, "they can {centimetres:.0} cm {}, at ({x:.2}, {y:.2}, {z:.2}) m", self.way)
    }
}

impl TaskError {
    /// Path of the value that it speaks of, such as `targets[1].radius`.
    pub fn path(&self) -> String {
        match self {
            Self::Value { path, .. } => path.clone(),
            Self::UnevenControlStep { .. } => "control_dt_s".into(),
            Self::DwellBeyondLimit { target, .. } | Self::DwellBeyondStepLimit { target, .. } => target.field("for_s"),
            Self::DwellsBeyondLimit { .. } => "time_limit_s".into(),
            Self::DistanceImpossible { target, .. } => target.field("min_distance_from_previous"),
            Self::Overlap { b, .. } => b.field("at"),
            Self::OutOfReach { target, .. } | Self::PathOutOfReach { target, .. } => target.field("at"),
        }
    }
}

impl TaskWarning {
    /// Path of the value that it speaks of, such as `targets[1].radius`.
    pub fn path(&self) -> String {
        match self {
            Self::DistanceRare { target, .. } | Self::DistanceDeadEnds { target, .. } => {
                target.field("min_distance_from_previous")
            }
            Self::PartlyOutOfReach { target, .. } | Self::CannotHold { target, .. } => target.field("at"),
            Self::Rounded { path, .. } => path.clone(),
        }
    }
}

fn is_or_are(element: &Element) -> &'static str {
    if element.first == element.last { "is" } else { "are" }
}

/// What of it the distance out of reach is measured to.
fn hull(element: &Element) -> &'static str {
    if element.is_button() { "its face" } else { "its surface" }
}

fn advice(element: &Element, remedy: &Remedy) -> String {
    remedy.advice(match element.kind {
        "button" => "it",
        "stick" => "its hinge",
        _ => "its centre",
    })
}

fn part_of(is_drawn: bool) -> &'static str {
    if is_drawn { "the range of " } else { "the face of " }
}

/// Where the places lie that cannot be reached, unless they are one.
fn within(missed: &Region) -> String {
    if missed.is_point() { String::new() } else { format!("within {}, ", Place(missed)) }
}

fn share_of(fraction: f64) -> String {
    if fraction == 1.0 { String::new() } else { format!("{:.0} % of the range of ", 100.0 * fraction) }
}

fn nearest_steps([shorter, longer]: &[f64; 2]) -> String {
    if *shorter > 0.0 { format!("{shorter} or {longer} s") } else { format!("{longer} s") }
}

/// The name people read for the value at `path`: `the width of target 3 (pressing)` for `targets[2].size[0]`.
///
/// Targets are numbered as they are done, repetitions counted.
pub(crate) fn subject(task: &Task, path: &str) -> String {
    let Some((index, field)) = path.strip_prefix("targets[").and_then(|rest| rest.split_once(']')) else {
        return if path == "targets" { "the task".into() } else { spoken(path) };
    };
    let index: usize = index.parse().unwrap_or_default();
    let Some(target) = task.targets.get(index) else { return spoken(path) };
    let before: u32 = task.targets[..index].iter().map(|target| target.repeat().clamp(1, 10)).sum();
    let field = field.trim_start_matches('.');
    let name = match field {
        "position.x" => Some("x position"),
        "position.y" => Some("y position"),
        "position.z" => Some("z position"),
        "radius" => Some("radius"),
        other => other.strip_suffix(']').and_then(|entry| {
            let (list, index) = entry.split_once('[')?;
            component(list, index.parse().ok()?)
        }),
    };
    let name = name.map_or_else(|| format!("`{field}`"), ToOwned::to_owned);
    format!("the {name} of {}", target.label(before as usize))
}
