//! Whether a task can be done at all, found before any training starts.

use std::fmt;

use garde::Validate;

use crate::description::{Task, rounded_steps};
use crate::geometry::{distance, farthest, farthest_at_worst, gap, spread};
use crate::target::{Pointing, Pressing, Target};

/// Contact begins so far in m from a button's surface.
pub const CONTACT_MARGIN: f64 = 0.002;

/// A warning is given when fewer than this share of drawn positions keeps the least distance.
pub const RARE_ACCEPTANCE: f64 = 0.05;

/// Positions tried when a share is estimated.
const SAMPLES: u32 = 2048;

/// What the model can reach with its fingertip.
pub trait Reach {
    /// How far a point, in m relative to the shoulder centre, is from the nearest point in reach; 0 when it is in reach.
    fn distance_out_of_reach(&self, point_rel_shoulder: [f64; 3]) -> f64;
}

/// A reach without end, for callers that know no model.
#[derive(Clone, Copy, Debug, Default)]
pub struct Anywhere;

impl Reach for Anywhere {
    fn distance_out_of_reach(&self, _: [f64; 3]) -> f64 {
        0.0
    }
}

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

/// One target, or several equal ones in a row; `target 3 (pressing)` or `targets 1 to 10 (pointing)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    /// Index of the first target, from 0.
    pub first: usize,
    /// Index of the last target.
    pub last: usize,
    /// `pointing` or `pressing`.
    pub kind: &'static str,
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (first, last, kind) = (self.first + 1, self.last + 1, self.kind);
        if first == last {
            write!(f, "target {first} ({kind})")
        } else {
            write!(f, "targets {first} to {last} ({kind})")
        }
    }
}

/// Why a task cannot be trained; each is one sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// A value is out of bounds, NaN or infinite, a range is upside down, or there are too few or too many targets.
    #[error("{path} {problem}")]
    Value {
        /// Path of the value, such as `targets[1].radius`.
        path: String,
        /// The value and what would be right.
        problem: String,
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
    /// All dwells together are longer than the episode.
    #[error(
        "the dwells of all targets add up to {dwells_s:.2} s but the time limit is {time_limit_s} s; raise the limit or shorten the dwells"
    )]
    DwellsBeyondLimit {
        /// Sum of the dwells, in whole control steps.
        dwells_s: f64,
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
        previous: Element,
        /// The rule in m.
        needed: f64,
        /// Greatest distance in m that the two ranges allow.
        possible: f64,
    },
    /// Two buttons that a fingertip could touch at once, which is not simulated.
    #[error("{} and {} {}; buttons must lie at least {:.1} mm apart", a, b, gap_in_words(*gap_m), 2e3 * CONTACT_MARGIN)]
    ButtonsTooClose {
        /// The earlier button.
        a: Element,
        /// The later button.
        b: Element,
        /// Gap between them in m, negative when they overlap.
        gap_m: f64,
    },
    /// No part of the target can be reached.
    #[error(
        "{target} is out of reach of the model: at ({:.2}, {:.2}, {:.2}) m by {:.1} cm; move it nearer to the shoulder",
        worst[0], worst[1], worst[2], 100.0 * beyond_m
    )]
    OutOfReach {
        /// The target.
        target: Element,
        /// The corner of its range that is farthest out, in m relative to the shoulder centre.
        worst: [f64; 3],
        /// How far the fingertip ends from it, in m.
        beyond_m: f64,
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
        "{:.1} % of the range of {target} is out of reach of the model, most at ({:.2}, {:.2}, {:.2}) m by {:.1} cm",
        100.0 * fraction, worst[0], worst[1], worst[2], 100.0 * beyond_m
    )]
    PartlyOutOfReach {
        /// The target.
        target: Element,
        /// Share of positions and sizes that cannot be reached.
        fraction: f64,
        /// The corner that is farthest out, in m relative to the shoulder centre.
        worst: [f64; 3],
        /// How far the fingertip ends from it, in m.
        beyond_m: f64,
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

impl TaskError {
    /// Path of the value that it speaks of, such as `targets[1].radius`.
    pub fn path(&self) -> String {
        match self {
            Self::Value { path, .. } => path.clone(),
            Self::DwellBeyondLimit { target, .. } => target_path(target, "dwell_s"),
            Self::DwellsBeyondLimit { .. } => "time_limit_s".into(),
            Self::DistanceImpossible { target, .. } => target_path(target, "min_distance_from_previous"),
            Self::ButtonsTooClose { b, .. } => target_path(b, "position"),
            Self::OutOfReach { target, .. } => target_path(target, "position"),
        }
    }
}

impl TaskWarning {
    /// Path of the value that it speaks of, such as `targets[1].radius`.
    pub fn path(&self) -> String {
        match self {
            Self::DistanceRare { target, .. } | Self::DistanceDeadEnds { target, .. } => {
                target_path(target, "min_distance_from_previous")
            }
            Self::PartlyOutOfReach { target, .. } => target_path(target, "position"),
            Self::Rounded { path, .. } => path.clone(),
        }
    }
}

fn target_path(target: &Element, field: &str) -> String {
    format!("targets[{}].{field}", target.first)
}

fn gap_in_words(gap_m: f64) -> String {
    if gap_m < 0.0 { "overlap".into() } else { format!("are {:.1} mm apart", 1e3 * gap_m) }
}

/// Everything that is wrong with a task, or odd about it, for a model that reaches as far as `reach` says.
///
/// Values come first: when one is out of bounds the rest is not looked at, because it would speak of nonsense.
pub fn check(task: &Task, reach: &dyn Reach) -> Report {
    let mut report = Report { errors: value_errors(task), ..Report::default() };
    if report.is_ok() {
        let task = task.clone().expanded();
        times(&task, &mut report);
        distances(&task, &mut report);
        buttons(&task, &mut report);
        reachability(&task, reach, &mut report);
    }
    report
}

fn value_errors(task: &Task) -> Vec<TaskError> {
    let Err(report) = task.validate() else { return Vec::new() };
    let error = |(path, error): &(garde::Path, garde::Error)| TaskError::Value {
        path: path.to_string(),
        problem: error.message().to_owned(),
    };
    report.iter().map(error).collect()
}

/// Dwells against the time limit, and times that are not whole control steps.
fn times(task: &Task, report: &mut Report) {
    let time_limit_s = task.time_limit_s;
    warn_if_rounded(task, time_limit_s, "the time limit".into(), "time_limit_s".into(), report);
    let mut dwells = 0;
    let mut one_too_long = false;
    for (target, sphere) in runs(task).filter_map(|(element, target)| Some((element, as_sphere(target)?))) {
        warn_if_rounded(
            task,
            sphere.dwell_s,
            format!("the dwell of {target}"),
            target_path(&target, "dwell_s"),
            report,
        );
        let steps = task.dwell_steps(target.first);
        dwells += steps * (target.last - target.first + 1) as u32;
        if steps > task.time_limit_steps() {
            one_too_long = true;
            report.errors.push(TaskError::DwellBeyondLimit { target, dwell_s: sphere.dwell_s, time_limit_s });
        }
    }
    if !one_too_long && dwells > task.time_limit_steps() {
        let dwells_s = f64::from(dwells) * task.control_dt_s;
        report.errors.push(TaskError::DwellsBeyondLimit { dwells_s, time_limit_s });
    }
}

fn warn_if_rounded(task: &Task, given_s: f64, what: String, path: String, report: &mut Report) {
    let steps = rounded_steps(given_s, task.control_dt_s);
    let used_s = f64::from(steps) * task.control_dt_s;
    // A dwell of 0 says "at once", which one step is.
    if given_s > 0.0 && (used_s - given_s).abs() > 1e-6 {
        report.warnings.push(TaskWarning::Rounded { what, path, given_s, used_s, steps });
    }
}

/// The least distance of each sphere from the target before it.
fn distances(task: &Task, report: &mut Report) {
    let mut seen: Vec<[&Target; 2]> = Vec::new();
    for (i, pair) in task.targets.windows(2).enumerate() {
        let [previous, target] = pair else { continue };
        let Some(needed) = target.min_distance() else { continue };
        // Ten equal spheres in a row have one thing to say, not nine.
        if seen.contains(&[previous, target]) {
            continue;
        }
        seen.push([previous, target]);
        distance_rule(single(i, previous), previous, single(i + 1, target), target, needed, report);
    }
}

fn distance_rule(
    previous: Element,
    before: &Target,
    target: Element,
    sphere: &Target,
    needed: f64,
    report: &mut Report,
) {
    let (from, to) = (before.region(), sphere.region());
    let possible = farthest(&from, &to);
    if possible < needed {
        report.errors.push(TaskError::DistanceImpossible { target, previous, needed, possible });
        return;
    }
    let acceptance = share(|[a, b, c, d, e, f]| distance(from.at([a, b, c]), to.at([d, e, f])) >= needed);
    if acceptance < RARE_ACCEPTANCE {
        report.warnings.push(TaskWarning::DistanceRare { target, previous, needed, acceptance });
    } else if farthest_at_worst(&from, &to) < needed {
        let dead_ends = share(|t: [f64; 3]| {
            let p = from.at(t);
            to.corners().iter().all(|corner| distance(p, *corner) < needed)
        });
        report.warnings.push(TaskWarning::DistanceDeadEnds { target, previous, needed, dead_ends });
    }
}

/// Buttons that the fingertip could touch two at a time.
fn buttons(task: &Task, report: &mut Report) {
    let buttons: Vec<_> = task
        .targets
        .iter()
        .enumerate()
        .filter_map(|(i, target)| Some((single(i, target), as_button(target)?)))
        .collect();
    for (i, (a, first)) in buttons.iter().enumerate() {
        for (b, second) in &buttons[i + 1..] {
            let gap_m = gap(first, second);
            if gap_m < 2.0 * CONTACT_MARGIN {
                report.errors.push(TaskError::ButtonsTooClose { a: a.clone(), b: b.clone(), gap_m });
            }
        }
    }
}

/// Spheres and buttons against the model's reach.
fn reachability(task: &Task, reach: &dyn Reach, report: &mut Report) {
    for (target, description) in runs(task) {
        let Unreached { fraction, any, worst, beyond_m } = match description {
            Target::Pointing(sphere) => unreached_sphere(sphere, reach),
            Target::Pressing(button) => unreached_button(button, reach),
        };
        if !any {
            report.errors.push(TaskError::OutOfReach { target, worst, beyond_m });
        } else if fraction > 0.0 {
            report.warnings.push(TaskWarning::PartlyOutOfReach { target, fraction, worst, beyond_m });
        }
    }
}

/// How much of a target cannot be reached.
struct Unreached {
    /// Share of its positions.
    fraction: f64,
    /// Whether any position can be reached.
    any: bool,
    worst: [f64; 3],
    beyond_m: f64,
}

/// A sphere counts as reached when the fingertip gets inside it: its centre may be out of reach by less than the radius.
fn unreached_sphere(sphere: &Pointing, reach: &dyn Reach) -> Unreached {
    let region = sphere.position;
    let out = |p| reach.distance_out_of_reach(p);
    let corners = region.corners();
    let (worst, centre_out) = worst(&corners, reach);
    let fraction = share(|[a, b, c, r]| out(region.at([a, b, c])) >= sphere.radius.at(r));
    let any = fraction < 1.0 || corners.iter().any(|corner| out(*corner) < sphere.radius.max);
    Unreached { fraction, any, worst, beyond_m: (centre_out - sphere.radius.max).max(0.0) }
}

/// A button counts as reached when the fingertip gets to some point of its face.
fn unreached_button(button: &Pressing, reach: &dyn Reach) -> Unreached {
    const GRID: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let face: Vec<_> = GRID.iter().flat_map(|across| GRID.map(|up| button.face_point(*across, up))).collect();
    let out = face.iter().filter(|p| reach.distance_out_of_reach(**p) > 0.0).count();
    let (worst, beyond_m) = worst(&face, reach);
    Unreached { fraction: out as f64 / face.len() as f64, any: out < face.len(), worst, beyond_m }
}

fn worst(points: &[[f64; 3]], reach: &dyn Reach) -> ([f64; 3], f64) {
    let measured = points.iter().map(|p| (*p, reach.distance_out_of_reach(*p)));
    measured.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(([0.0; 3], 0.0))
}

/// Share of evenly spread points of the unit cube for which `test` holds.
fn share<const N: usize>(test: impl Fn([f64; N]) -> bool) -> f64 {
    (0..SAMPLES).filter(|k| test(spread(*k))).count() as f64 / f64::from(SAMPLES)
}

/// Equal targets in a row taken together.
fn runs(task: &Task) -> impl Iterator<Item = (Element, &Target)> {
    let mut first = 0;
    task.targets.chunk_by(|a, b| a == b).map(move |run| {
        let element = Element { first, last: first + run.len() - 1, kind: run[0].kind() };
        first += run.len();
        (element, &run[0])
    })
}

fn single(i: usize, target: &Target) -> Element {
    Element { first: i, last: i, kind: target.kind() }
}

fn as_sphere(target: &Target) -> Option<&Pointing> {
    match target {
        Target::Pointing(sphere) => Some(sphere),
        Target::Pressing(_) => None,
    }
}

fn as_button(target: &Target) -> Option<&Pressing> {
    match target {
        Target::Pressing(button) => Some(button),
        Target::Pointing(_) => None,
    }
}
