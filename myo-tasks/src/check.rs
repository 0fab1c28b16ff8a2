//! Whether a task can be done at all, found before any training starts.

use garde::Validate;

use crate::description::{Task, rounded_steps};
use crate::geometry::{distance, farthest, farthest_at_worst, gap, spread};
use crate::report::{Element, Report, TaskError, TaskWarning, subject};
use crate::target::{Pointing, Pressing, Target};

/// Contact begins so far in m from a button's surface.
pub const CONTACT_MARGIN: f64 = 0.002;

/// A warning is given when fewer than this share of drawn positions keeps the least distance.
pub const RARE_ACCEPTANCE: f64 = 0.05;

/// Pairs of positions tried when a share of them is estimated.
const SAMPLES: u32 = 2048;

/// Positions tried against the model's reach, which may be slow to tell.
const REACH_SAMPLES: u32 = 504;

/// What the check of a task asks the model.
pub trait Reach {
    /// How far a point, in m relative to the shoulder centre, is from the nearest point in reach; 0 when it is in reach.
    fn distance_out_of_reach(&self, point_rel_shoulder: [f64; 3]) -> f64;

    /// Seconds of one physics step, which control steps must be whole multiples of. `None`, the default, where no model is
    /// known: then control steps are not checked.
    fn physics_dt_s(&self) -> Option<f64> {
        None
    }
}

/// A reach without end, for callers that know no model; what depends on one is not checked.
#[derive(Clone, Copy, Debug, Default)]
pub struct Anywhere;

impl Reach for Anywhere {
    fn distance_out_of_reach(&self, _: [f64; 3]) -> f64 {
        0.0
    }
}

/// Everything that is wrong with a task, or odd about it, for a model that reaches as far as `reach` says.
///
/// Values come first: when one is out of bounds the rest is not looked at, because it would speak of nonsense.
pub fn check(task: &Task, reach: &dyn Reach) -> Report {
    let mut report = Report { errors: value_errors(task), ..Report::default() };
    if report.is_ok() {
        let task = task.clone().expanded();
        report.errors.extend(reach.physics_dt_s().and_then(|dt| task.check_control_step(dt).err()));
        times(&task, &mut report);
        distances(&task, &mut report);
        buttons(&task, &mut report);
        reachability(&task, reach, &mut report);
    }
    report
}

/// The bounds of single values, in the order of the fields.
pub(crate) fn value_errors(task: &Task) -> Vec<TaskError> {
    let Err(report) = task.validate() else { return Vec::new() };
    let error = |(path, error): &(garde::Path, garde::Error)| {
        let path = path.to_string();
        TaskError::Value { subject: subject(task, &path), problem: error.message().to_owned(), path }
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
        warn_if_rounded(task, sphere.dwell_s, format!("the dwell of {target}"), target.path("dwell_s"), report);
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
        let found = match description {
            Target::Pointing(sphere) => unreached_sphere(sphere, reach),
            Target::Pressing(button) => unreached_button(button, reach),
        };
        let (fraction, worst, beyond_m) = (found.fraction(), found.worst, found.beyond_m);
        if found.missed == found.tried {
            report.errors.push(TaskError::OutOfReach { target, worst, beyond_m });
        } else if found.missed > 0 {
            report.warnings.push(TaskWarning::PartlyOutOfReach { target, fraction, worst, beyond_m });
        }
    }
}

/// How much of a target cannot be reached.
#[derive(Default)]
struct Unreached {
    tried: u32,
    missed: u32,
    worst: [f64; 3],
    beyond_m: f64,
}

impl Unreached {
    /// Counts a point that is so far out of reach; `hit` says whether that is near enough.
    fn count(&mut self, point: [f64; 3], beyond_m: f64, hit: bool) {
        self.tried += 1;
        self.missed += u32::from(!hit);
        if beyond_m > self.beyond_m {
            (self.worst, self.beyond_m) = (point, beyond_m);
        }
    }

    fn fraction(&self) -> f64 {
        f64::from(self.missed) / f64::from(self.tried)
    }
}

/// A sphere counts as reached when the fingertip gets inside it: its centre may be out of reach by less than the radius.
fn unreached_sphere(sphere: &Pointing, reach: &dyn Reach) -> Unreached {
    let mut found = Unreached::default();
    // Evenly spread points never lie on the corners, where a target is farthest out or just within reach.
    let corners = sphere.position.corners().map(|p| (p, sphere.radius.max));
    let inside = (0..REACH_SAMPLES).map(|k| {
        let [a, b, c, r] = spread(k);
        (sphere.position.at([a, b, c]), sphere.radius.at(r))
    });
    for (centre, radius) in corners.into_iter().chain(inside) {
        let out = reach.distance_out_of_reach(centre);
        found.count(centre, out - sphere.radius.min, out < radius);
    }
    found
}

/// A button counts as reached when the fingertip gets to some point of its face.
fn unreached_button(button: &Pressing, reach: &dyn Reach) -> Unreached {
    const GRID: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let mut found = Unreached::default();
    for point in GRID.iter().flat_map(|across| GRID.map(|up| button.face_point(*across, up))) {
        let out = reach.distance_out_of_reach(point);
        found.count(point, out, out <= 0.0);
    }
    found
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
