//! Whether a task can be done at all, found before any training starts.

use garde::Validate;

use crate::description::{Task, rounded_steps};
use crate::geometry::{distance, farthest, farthest_at_worst, gap, spread};
use crate::range::Range;
use crate::remedy::{Remedy, least_move, reached_part, shrink_and_move};
use crate::report::{Element, Report, TaskError, TaskWarning, subject};
use crate::target::{Pointing, Pressing, Region, Target};
use crate::weakness::weakness;

/// Contact begins so far in m from a button's surface.
pub const CONTACT_MARGIN: f64 = 0.002;

/// A warning is given when fewer than this share of drawn positions keeps the least distance.
pub const RARE_ACCEPTANCE: f64 = 0.05;

/// Pairs of positions tried when a share of them is estimated.
const SAMPLES: u32 = 2048;

/// Positions tried against the model's reach, which may be slow to tell.
const REACH_SAMPLES: u32 = 504;

/// Looks at smaller and smaller parts of a range before none counts as reached.
const CLOSER_LOOKS: u32 = 8;

/// What the check of a task asks the model.
pub trait Reach {
    /// The point in reach that is nearest to a point, both in m relative to the shoulder centre; that point itself when it
    /// is in reach.
    fn nearest_in_reach(&self, point_rel_shoulder: [f64; 3]) -> [f64; 3];

    /// How far (m) a point is from the nearest one in reach; 0 when it is in reach.
    fn distance_out_of_reach(&self, point_rel_shoulder: [f64; 3]) -> f64 {
        distance(point_rel_shoulder, self.nearest_in_reach(point_rel_shoulder))
    }

    /// Whether muscles can hold the fingertip still in some pose that was tried, in a sphere of this radius (m). `true`, the
    /// default, where nothing is known of muscles.
    fn can_hold(&self, centre_rel_shoulder: [f64; 3], radius: f64) -> bool {
        let _ = (centre_rel_shoulder, radius);
        true
    }

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
    fn nearest_in_reach(&self, point: [f64; 3]) -> [f64; 3] {
        point
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
        report
            .warnings
            .extend(runs(&task).filter_map(|(target, sphere)| weakness(&task, target, as_sphere(sphere)?, reach)));
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
        let found = look(description, reach);
        if found.missed().next().is_none() {
            continue;
        }
        let (fraction, (worst, beyond_m)) = (found.fraction(), found.worst());
        let remedy = Box::new(remedy(description, &found, reach));
        if fraction == 1.0 {
            report.errors.push(TaskError::OutOfReach { target, worst, beyond_m, remedy });
        } else {
            let missed = found.missed_region();
            report.warnings.push(TaskWarning::PartlyOutOfReach { target, fraction, missed, worst, beyond_m, remedy });
        }
    }
}

/// What came of trying places of a target.
struct Unreached {
    tried: Vec<Tried>,
}

/// A place of a target.
struct Tried {
    /// Centre of the sphere, or point of the button's face.
    point: [f64; 3],
    /// How far (m) the face, or the surface of the smallest sphere, is out of reach; negative within the sphere.
    beyond_m: f64,
    is_reached: bool,
}

impl Unreached {
    fn missed(&self) -> impl Iterator<Item = &Tried> {
        self.tried.iter().filter(|tried| !tried.is_reached)
    }

    fn fraction(&self) -> f64 {
        self.missed().count() as f64 / self.tried.len() as f64
    }

    /// The point that is farthest out, and how far (m).
    fn worst(&self) -> ([f64; 3], f64) {
        let farthest =
            self.tried.iter().reduce(|worst, tried| if tried.beyond_m > worst.beyond_m { tried } else { worst });
        farthest.map_or(([0.0; 3], 0.0), |tried| (tried.point, tried.beyond_m))
    }

    /// The box around all that was missed.
    fn missed_region(&self) -> Region {
        let [x, y, z] = [0, 1, 2].map(|k| {
            let least = self.missed().map(|tried| tried.point[k]).fold(f64::INFINITY, f64::min);
            Range::new(least, self.missed().map(|tried| tried.point[k]).fold(least, f64::max))
        });
        Region { x, y, z }
    }
}

fn look(target: &Target, reach: &dyn Reach) -> Unreached {
    match target {
        Target::Pointing(sphere) => look_at_sphere(sphere, reach),
        Target::Pressing(button) => look_at_button(button, reach),
    }
}

/// A sphere counts as reached when the fingertip gets inside it: its centre may be out of reach by less than the radius.
fn look_at_sphere(sphere: &Pointing, reach: &dyn Reach) -> Unreached {
    // Evenly spread points never lie on the corners, where a target is farthest out or just within reach.
    let corners = Region::corner_shares().map(|share| (share, sphere.radius.max));
    let inside = (0..REACH_SAMPLES).map(|k| {
        let [a, b, c, r] = spread(k);
        ([a, b, c], sphere.radius.at(r))
    });
    let mut last = ([f64::NAN; 3], f64::NAN);
    let tried = corners.into_iter().chain(inside).map(|(share, radius)| {
        let point = sphere.position.at(share);
        // All places of a fixed sphere are one.
        if last.0 != point {
            last = (point, reach.distance_out_of_reach(point));
        }
        Tried { point, beyond_m: last.1 - sphere.radius.min, is_reached: last.1 < radius }
    });
    Unreached { tried: tried.collect() }
}

/// A button counts as reached when the fingertip gets to some point of its face.
fn look_at_button(button: &Pressing, reach: &dyn Reach) -> Unreached {
    const GRID: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let tried = GRID.iter().flat_map(|across| GRID.map(|up| button.face_point(*across, up))).map(|point| {
        let beyond_m = reach.distance_out_of_reach(point);
        Tried { point, beyond_m, is_reached: beyond_m <= 0.0 }
    });
    Unreached { tried: tried.collect() }
}

/// What brings all of a target into reach.
fn remedy(target: &Target, found: &Unreached, reach: &dyn Reach) -> Remedy {
    let mut points: Vec<_> = found.tried.iter().map(|tried| tried.point).collect();
    points.dedup();
    let moved = least_move(target.region(), &points, reach);
    let Target::Pointing(sphere) = target else { return Remedy { moved, narrowed: None } };
    let narrowed = if sphere.position.is_point() { None } else { narrowed(sphere, found, reach) };
    let can_shrink = moved.is_none() && narrowed.is_none();
    Remedy { moved: moved.or_else(|| can_shrink.then(|| shrink_and_move(&sphere.position, reach))?), narrowed }
}

/// A part of a sphere's range that can be reached, looked at as closely as the whole.
fn narrowed(sphere: &Pointing, found: &Unreached, reach: &dyn Reach) -> Option<Region> {
    let place = |tried: &Tried| (tried.point, tried.is_reached);
    let mut places: Vec<_> = found.tried.iter().map(place).collect();
    for _ in 0..CLOSER_LOOKS {
        let part = reached_part(&sphere.position, &places)?;
        let closer = look_at_sphere(&Pointing { position: part, ..sphere.clone() }, reach);
        if closer.missed().next().is_none() {
            return Some(part);
        }
        places.extend(closer.tried.iter().map(place));
    }
    None
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
