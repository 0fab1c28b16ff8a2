//! Whether a task can be done at all, found before any training starts.

use garde::Validate;
use nalgebra::Vector3;

use crate::description::Task;
use crate::flat::{Action, Block, FlatTask, Object, Pointer, Shape, Shift, Sphere, Step};
use crate::geometry::{distance, farthest, farthest_at_worst, spread};
use crate::motion::Path;
use crate::range::Range;
use crate::remedy::{Remedy, least_move, reached_part, shrink_and_move};
use crate::report::{Element, Report, TaskError, TaskWarning, subject};
use crate::rules::parts_rule;
use crate::slider::Slider;
use crate::stick::Stick;
use crate::target::Region;
use crate::weakness::weakness;

/// Boxes that touch may overlap by what rounding makes of it (m).
const ROUNDING: f64 = 1e-9;

/// Times may differ by what rounding makes of them (s).
const ROUNDING_S: f64 = 1e-6;

/// A warning is given when fewer than this share of drawn positions keeps the least distance.
pub const RARE_ACCEPTANCE: f64 = 0.05;

/// Pairs of positions tried when a share of them is estimated.
const SAMPLES: u32 = 2048;

/// Positions tried against the model's reach, which may be slow to tell.
const REACH_SAMPLES: u32 = 504;

/// Places tried of a button whose place is drawn, its corners aside; at each, all of its face.
const DRAWN_SAMPLES: u32 = 24;

/// Looks at smaller and smaller parts of a range before none counts as reached.
const CLOSER_LOOKS: u32 = 8;

/// How far (m) beyond where it moves nothing the fingertip must get that moves a cursor.
const RATE_REACH: f64 = 0.02;

/// What the check of a task asks the model.
pub trait Reach {
    /// The point in reach that is nearest to a point, both in m relative to the shoulder centre; that point itself when it
    /// is in reach.
    fn nearest_in_reach(&self, point_rel_shoulder: [f64; 3]) -> [f64; 3];

    /// How far (m) a point is from the nearest one in reach; 0 when it is in reach.
    fn distance_out_of_reach(&self, point_rel_shoulder: [f64; 3]) -> f64 {
        distance(point_rel_shoulder, self.nearest_in_reach(point_rel_shoulder))
    }

    /// How far (m) a point is from the nearest one that the fingertip reaches, whatever points. As what points, the default, where nothing
    /// else is known.
    fn fingertip_out_of_reach(&self, point_rel_shoulder: [f64; 3]) -> f64 {
        self.distance_out_of_reach(point_rel_shoulder)
    }

    /// What another finger reaches, by the name that the model has for it. `None`, the default, where that is not known: then it is not
    /// checked.
    fn of_finger(&self, name: &str) -> Option<&dyn Reach> {
        let _ = name;
        None
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
    let mut report = Report::default();
    let flat = match task.flat() {
        Ok(flat) => flat,
        Err(invalid) => {
            report.errors = invalid.errors;
            return report;
        }
    };
    report.errors.extend(reach.physics_dt_s().and_then(|dt| task.check_control_step(dt).err()));
    times(task, &flat, &mut report);
    rest_of_cursor(&flat, reach, &mut report);
    distances(&flat, &mut report);
    overlaps(&flat, &mut report);
    reachability(&flat, reach, None, &mut report);
    for (number, name) in flat.fingers.iter().enumerate() {
        if let Some(reach) = reach.of_finger(name) {
            reachability(&flat, reach, Some(number), &mut report);
        }
    }
    report.warnings.extend(runs(&flat, None).filter_map(|(element, object)| {
        let steps = flat.steps_of(element.first).filter(|step| step.lead.is_none() && step.needs_hold());
        let dwell_s = steps.filter_map(Step::dwell_s).reduce(f64::max)?;
        // What moves is not held still.
        let sphere = object.sphere().filter(|sphere| sphere.path.is_none())?;
        weakness(element, &Sphere { region: object.places(), ..sphere.clone() }, dwell_s, reach)
    }));
    report
}

/// The bounds of single values, in the order of the fields; then what the script asks for.
pub(crate) fn value_errors(task: &Task) -> Vec<TaskError> {
    let mut errors = single_value_errors(task);
    if errors.is_empty() {
        errors.extend(FlatTask::of(task).err().unwrap_or_default());
    }
    errors
}

/// The bounds of single values, in the order of the fields.
pub(crate) fn single_value_errors(task: &Task) -> Vec<TaskError> {
    let error = |(path, error): &(garde::Path, garde::Error)| {
        let path = path.to_string();
        TaskError::Value { subject: subject(task, &path), problem: error.message().to_owned(), path }
    };
    let parts = parts_rule(task).map(|(path, subject, problem)| TaskError::Value {
        path: path.into(),
        subject: subject.into(),
        problem,
    });
    let values = task.validate().err();
    parts.into_iter().chain(values.iter().flat_map(garde::Report::iter).map(error)).collect()
}

/// The time limit, which is in whole control steps, and dwells and waits against it.
fn times(task: &Task, flat: &FlatTask, report: &mut Report) {
    let (given_s, steps) = (task.time_limit_s, task.time_limit_steps());
    let used_s = f64::from(steps) * task.control_dt_s;
    if (used_s - given_s).abs() > ROUNDING_S {
        let (what, path) = ("the time limit".into(), "time_limit_s".into());
        report.warnings.push(TaskWarning::Rounded { what, path, given_s, used_s, steps });
    }
    if let (Some(given_s), Some(steps)) = (task.step_limit_s, task.step_limit_steps()) {
        let used_s = f64::from(steps) * task.control_dt_s;
        if (used_s - given_s).abs() > ROUNDING_S {
            let (what, path) = ("the limit of a step".into(), "step_limit_s".into());
            report.warnings.push(TaskWarning::Rounded { what, path, given_s, used_s, steps });
        }
    }
    let of_step_s = task.step_limit_steps().map(|steps| (f64::from(steps) * task.control_dt_s).min(used_s));
    let is_too_long = |seconds: f64| seconds > used_s + ROUNDING_S;
    let (mut dwells_s, mut waits_s) = (0.0, 0.0);
    let mut one_too_long = false;
    for (target, step) in step_runs(flat) {
        let times = (target.last - target.first + 1) as f64;
        if let Some(cue) = step.cue {
            // Waits are in whole control steps.
            waits_s += times * (cue.after_s.min / task.control_dt_s).round() * task.control_dt_s;
        }
        let Some(dwell_s) = step.dwell_s() else { continue };
        dwells_s += times * step.least_dwell_s(task.control_dt_s);
        if let Some(limit_s) = of_step_s.filter(|limit_s| dwell_s > limit_s + ROUNDING_S && !is_too_long(dwell_s)) {
            report.errors.push(TaskError::DwellBeyondStepLimit { target, dwell_s, limit_s });
        } else if is_too_long(dwell_s) {
            one_too_long = true;
            report.errors.push(TaskError::DwellBeyondLimit { target, dwell_s, time_limit_s: given_s });
        }
    }
    if !one_too_long && is_too_long(dwells_s + waits_s) {
        let (dwells_s, waits) = (dwells_s + waits_s, waits_s > 0.0);
        report.errors.push(TaskError::DwellsBeyondLimit { dwells_s, waits, time_limit_s: given_s });
    }
}

/// The least distance of each sphere from the object before it.
fn distances(flat: &FlatTask, report: &mut Report) {
    let mut seen: Vec<[&Object; 2]> = Vec::new();
    for (index, object) in flat.objects.iter().enumerate() {
        let Some((before, needed)) = object.sphere().and_then(|sphere| sphere.apart) else { continue };
        let previous = &flat.objects[before];
        // Ten equal spheres in a row have one thing to say, not nine.
        if seen.iter().any(|[a, b]| is_alike(a, previous) && is_alike(b, object)) {
            continue;
        }
        seen.push([previous, object]);
        let [previous, target] = [before, index].map(|k| Element::objects(flat, k, k));
        let [from, to] = places_apart(&flat.objects[before], object);
        distance_rule(previous, from, target, to, needed, report);
    }
}

/// Where two objects may lie as seen from each other: what moves as one keeps its distance.
pub fn places_apart(a: &Object, b: &Object) -> [Region; 2] {
    if a.shift == b.shift { [a.region(), b.region()] } else { [a.places(), b.places()] }
}

fn distance_rule(previous: Element, from: Region, target: Element, to: Region, needed: f64, report: &mut Report) {
    let possible = farthest(&from, &to);
    if possible < needed {
        report.errors.push(TaskError::DistanceImpossible { target, previous: Box::new(previous), needed, possible });
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

/// Boxes that stand in each other.
fn overlaps(flat: &FlatTask, report: &mut Report) {
    let solid = || flat.objects.iter().enumerate().filter(|(_, object)| object.block().is_some());
    let mut seen: Vec<[&str; 2]> = Vec::new();
    for (a, first) in solid() {
        for (b, second) in solid().filter(|(b, _)| *b > a) {
            let overlap_m = -first.least_gap(second);
            // Keys that are too large have one thing to say, not sixty.
            let paths = [a, b].map(|index| &*flat.objects[index].path);
            if overlap_m > ROUNDING && !seen.contains(&paths) {
                seen.push(paths);
                let [a, b] = [a, b].map(|index| Element::objects(flat, index, index));
                report.errors.push(TaskError::Overlap { a, b: Box::new(b), overlap_m });
            }
        }
    }
}

/// What the script asks of a finger, or of what points without one, against its reach.
fn reachability(flat: &FlatTask, reach: &dyn Reach, finger: Option<usize>, report: &mut Report) {
    for (mut target, object) in runs(flat, finger) {
        let found = look(flat, target.first, object, reach);
        if found.missed().next().is_none() {
            continue;
        }
        if let Some(finger) = finger {
            target.label = format!("{} (for the finger `{}`)", target.label, flat.fingers[finger]);
        }
        let (fraction, (worst, beyond_m)) = (found.fraction(), found.worst());
        let remedy = Box::new(remedy(object, &found, reach));
        let is_stick = matches!(object.shape, Shape::Stick(_));
        let goes = object.sphere().is_some_and(|sphere| sphere.path.is_some());
        if goes || is_stick && !(object.is_drawn() && fraction < 1.0) {
            report.errors.push(TaskError::PathOutOfReach { target, worst, beyond_m, remedy });
        } else if fraction == 1.0 {
            report.errors.push(TaskError::OutOfReach { target, worst, beyond_m, remedy });
        } else {
            let missed = found.missed_region();
            let is_drawn = object.sphere().is_some() || object.is_drawn();
            report.warnings.push(TaskWarning::PartlyOutOfReach {
                target,
                is_drawn,
                fraction,
                missed,
                worst,
                beyond_m,
                remedy,
            });
        }
    }
}

/// Where the fingertip rests that moves a cursor, and where it moves it from, must be in reach.
fn rest_of_cursor(flat: &FlatTask, reach: &dyn Reach, report: &mut Report) {
    let &Pointer::RateCursor { at, rotation, still_m, .. } = &flat.pointer else { return };
    let off = |axis: usize, by: f64| (Vector3::from(at) + rotation.matrix().column(axis) * by).into();
    let beyond = still_m + RATE_REACH;
    let places: [[f64; 3]; 5] = [at, off(0, beyond), off(0, -beyond), off(1, beyond), off(1, -beyond)];
    let missed = places.map(|place| (reach.fingertip_out_of_reach(place), place));
    let Some((beyond_m, [x, y, z])) =
        missed.into_iter().filter(|(by, _)| *by > 0.0).reduce(|a, b| if b.0 > a.0 { b } else { a })
    else {
        return;
    };
    let problem = format!(
        "asks for the fingertip at ({x:.2}, {y:.2}, {z:.2}) m, which is out of reach of the model by {:.1} cm; take a place from which \
         it gets {:.0} cm either way, forward and across",
        100.0 * beyond_m,
        100.0 * beyond
    );
    report.errors.push(TaskError::Value {
        path: "technique.at".into(),
        subject: "the rest of the cursor".into(),
        problem,
    });
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

fn look(flat: &FlatTask, index: usize, object: &Object, reach: &dyn Reach) -> Unreached {
    match &object.shape {
        Shape::Sphere(sphere) => look_at_sphere(sphere, object.shift, reach),
        Shape::Stick(stick) => look_at_knob(stick, swept(flat, index, stick), object.shift, reach),
        Shape::Button(block) | Shape::Obstacle(block) | Shape::Slider(Slider { block, .. }) => match object.shift {
            None if object.growth.is_none() => look_at_face(block, reach),
            shift => look_at_faces(object, shift, reach),
        },
    }
}

/// Angles (rad) that the knob goes through from where it stands at first to where steps want it.
fn swept(flat: &FlatTask, index: usize, stick: &Stick) -> Range {
    let wanted = flat.steps_of(index).filter_map(|step| match step.action {
        Action::Swing { to, .. } => Some(Range::fixed(to)),
        // Who drives may need all of it.
        Action::Drive { .. } => Some(stick.range),
        _ => None,
    });
    wanted.fold(stick.start, |Range { min, max }, to| Range::new(min.min(to.min), max.max(to.max)))
}

/// A sphere counts as reached when the fingertip gets inside it: its centre may be out of reach by less than the radius.
fn look_at_sphere(sphere: &Sphere, shift: Option<Shift>, reach: &dyn Reach) -> Unreached {
    // Evenly spread points never lie on the corners, where a target is farthest out or just within reach.
    let corners = Region::corner_shares().map(|share| (share, sphere.radius.max));
    let inside = (0..REACH_SAMPLES).map(|k| {
        let [a, b, c, r] = spread(k);
        ([a, b, c], sphere.radius.at(r))
    });
    let path = sphere.path.as_ref().map_or_else(|| vec![[0.0; 3]], Path::samples);
    let shifts = shift.map_or_else(|| vec![[0.0; 3]], |shift| Region::corner_shares().map(|at| shift.at(at)).to_vec());
    let off = |shift: &[f64; 3], way: &[f64; 3]| [0, 1, 2].map(|k| shift[k] + way[k]);
    let offsets: Vec<[f64; 3]> = shifts.iter().flat_map(|shift| path.iter().map(|way| off(shift, way))).collect();
    // Every corner with every place of the path, every place within with one of them.
    let at_corners = offsets.iter().flat_map(|offset| corners.map(|(share, radius)| (share, *offset, radius)));
    let within = inside.zip(offsets.iter().cycle()).map(|((share, radius), offset)| (share, *offset, radius));
    let mut last = ([f64::NAN; 3], f64::NAN);
    let tried = at_corners.chain(within).map(|(share, offset, radius)| {
        let place = sphere.region.at(share);
        let point = [0, 1, 2].map(|k| place[k] + offset[k]);
        // All places of a fixed sphere are one.
        if last.0 != point {
            last = (point, reach.distance_out_of_reach(point));
        }
        Tried { point, beyond_m: last.1 - sphere.radius.min, is_reached: last.1 < radius }
    });
    Unreached { tried: tried.collect() }
}

/// A stick counts as reached when the fingertip gets into its knob at all these angles (rad).
fn look_at_knob(stick: &Stick, angles: Range, shift: Option<Shift>, reach: &dyn Reach) -> Unreached {
    let shifts = shift.map_or_else(|| vec![[0.0; 3]], |shift| Region::corner_shares().map(|at| shift.at(at)).to_vec());
    let places =
        shifts.iter().flat_map(|by| stick.arc(angles).map(|arm| [0, 1, 2].map(|k| stick.hinge[k] + by[k] + arm[k])));
    let tried = places.map(|point| {
        let beyond_m = reach.distance_out_of_reach(point) - stick.knob;
        Tried { point, beyond_m, is_reached: beyond_m < 0.0 }
    });
    Unreached { tried: tried.collect() }
}

/// A button counts as reached when the fingertip gets to some point of its face.
fn look_at_face(block: &Block, reach: &dyn Reach) -> Unreached {
    let tried = face_points(block).map(|point| {
        let beyond_m = reach.distance_out_of_reach(point);
        Tried { point, beyond_m, is_reached: beyond_m <= 0.0 }
    });
    Unreached { tried: tried.collect() }
}

/// Of a button whose place or size is drawn, each counts: whether some point of its face is reached there, as small and as large as it may
/// be.
fn look_at_faces(object: &Object, shift: Option<Shift>, reach: &dyn Reach) -> Unreached {
    let sizes: Vec<Block> = match object.growth {
        None => object.block().cloned().into_iter().collect(),
        Some(_) => [object.smallest(), object.largest()].into_iter().flatten().collect(),
    };
    let places: Vec<[f64; 3]> = match shift {
        None => vec![[0.0; 3]],
        Some(shift) => {
            let inside = (0..DRAWN_SAMPLES).map(spread);
            Region::corner_shares().into_iter().chain(inside).map(|shares| shift.at(shares)).collect()
        }
    };
    let tried =
        sizes.iter().flat_map(|block| places.iter().map(move |offset| (block, offset))).map(|(block, offset)| {
            let moved = Block { centre: [0, 1, 2].map(|k| block.centre[k] + offset[k]), ..block.clone() };
            let beyond_m =
                face_points(&moved).map(|point| reach.distance_out_of_reach(point)).fold(f64::INFINITY, f64::min);
            Tried { point: moved.face_point(0.0, 0.0), beyond_m, is_reached: beyond_m <= 0.0 }
        });
    Unreached { tried: tried.collect() }
}

/// Points spread over a face, its edges included.
fn face_points(block: &Block) -> impl Iterator<Item = [f64; 3]> {
    const GRID: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
    GRID.into_iter().flat_map(|across| GRID.map(|up| block.face_point(across, up)))
}

/// What brings all of a target into reach.
fn remedy(object: &Object, found: &Unreached, reach: &dyn Reach) -> Remedy {
    let mut points: Vec<_> = found.tried.iter().map(|tried| tried.point).collect();
    points.dedup();
    let moved = least_move(object.places(), &points, reach);
    let sphere = object.sphere().filter(|_| object.shift.is_none());
    let Some(sphere) = sphere else { return Remedy { moved, narrowed: None } };
    let narrowed = if sphere.region.is_point() { None } else { narrowed(sphere, found, reach) };
    let can_shrink = moved.is_none() && narrowed.is_none();
    Remedy { moved: moved.or_else(|| can_shrink.then(|| shrink_and_move(&sphere.region, reach))?), narrowed }
}

/// A part of a sphere's range that can be reached, looked at as closely as the whole.
fn narrowed(sphere: &Sphere, found: &Unreached, reach: &dyn Reach) -> Option<Region> {
    let place = |tried: &Tried| (tried.point, tried.is_reached);
    let mut places: Vec<_> = found.tried.iter().map(place).collect();
    for _ in 0..CLOSER_LOOKS {
        let part = reached_part(&sphere.region, &places)?;
        let closer = look_at_sphere(&Sphere { region: part, ..sphere.clone() }, None, reach);
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

/// Objects that the script asks a finger for, or without one what points, and then what corrects, too; equal ones in a row taken together.
fn runs(flat: &FlatTask, finger: Option<usize>) -> impl Iterator<Item = (Element, &Object)> {
    let mut first = 0;
    flat.objects.chunk_by(is_alike).filter_map(move |run| {
        let (from, last) = (first, first + run.len() - 1);
        first += run.len();
        let is_wanted = (from..=last).any(|object| {
            let corrects = finger.is_none() && flat.correction == Some(object);
            corrects || flat.steps.iter().any(|step| step.asks_finger_for(finger, object))
        });
        is_wanted.then(|| (Element::objects(flat, from, last), &run[0]))
    })
}

/// Steps, those in a row that ask the same of equal objects taken together.
fn step_runs(flat: &FlatTask) -> impl Iterator<Item = (Element, &Step)> {
    let mut first = 0;
    let is_same = |a: &Step, b: &Step| {
        let is_same = (a.action, a.cue, a.lead, a.pinch) == (b.action, b.cue, b.lead, b.pinch) && a.also == b.also;
        is_same && is_alike(&flat.objects[a.object], &flat.objects[b.object])
    };
    flat.steps.chunk_by(is_same).map(move |run| {
        let last = first + run.len() - 1;
        let element = Element::steps(flat, first, last);
        first = last + 1;
        (element, &run[0])
    })
}

/// Whether two objects are one description's: spheres that are drawn from the same places and sizes.
fn is_alike(a: &Object, b: &Object) -> bool {
    let (Some(x), Some(y)) = (a.sphere(), b.sphere()) else { return false };
    let same_rule = match (x.apart, y.apart) {
        (Some((_, x)), Some((_, y))) => x == y,
        _ => true,
    };
    (x.region, x.radius, &x.path, a.shift) == (y.region, y.radius, &y.path, b.shift) && same_rule
}
