//! From the text of a task to what stands there and what is wrong with it.

use myo_tasks::{
    Axes, BadValue, Direction, FlatTask, InvalidTask, LoadError, Object, PlacedItem, Range, Report, Shape, Shift,
    Slider, Source, SourceLocation, Task,
};
use nalgebra::{Rotation3, UnitQuaternion};

use crate::protocol::{Finding, ItemView, Look, ObjectKind, ObjectView, Refusal, Severity, StepView, TaskView};

/// How messages call the text; places in it come beside them.
const TEXT: &str = "task";

/// What stands in a text. The scene is shown while the script is not right yet, or not there.
pub fn look(text: &str) -> Look {
    let (source, values) = match Source::draft(text, TEXT) {
        Ok(draft) => draft,
        Err(error) => return Look { findings: refusal(&error).findings, view: None },
    };
    let flat = if values.is_empty() { source.task.flat() } else { scenery(&source.task) };
    let view = flat.ok().map(|flat| view(&source.task, &flat));
    Look { findings: values.iter().map(of_value).collect(), view }
}

fn scenery(task: &Task) -> Result<FlatTask, InvalidTask> {
    Task { technique: Default::default(), ..task.clone() }.scenery()
}

/// Reads a text.
///
/// # Errors
/// What is wrong with it, each with its place.
pub fn read(text: &str) -> Result<Source, Refusal> {
    Source::parse(text, TEXT).map_err(|error| refusal(&error))
}

/// Everything that the checks of a task found.
pub fn of_report(source: &Source, report: &Report) -> Vec<Finding> {
    let errors = report.errors.iter().map(|error| at(source, Severity::Error, &error.path(), error.to_string()));
    let warnings = report.warnings.iter().map(|odd| at(source, Severity::Warning, &odd.path(), odd.to_string()));
    errors.chain(warnings).collect()
}

fn of_value(bad: &BadValue) -> Finding {
    finding(&bad.place, Some(bad.error.path()), &bad.error.to_string())
}

/// An error at a place, which the message may begin with.
fn finding(place: &SourceLocation, path: Option<String>, message: &str) -> Finding {
    Finding {
        severity: Severity::Error,
        message: message.strip_prefix(&format!("{place}: ")).unwrap_or(message).to_owned(),
        path,
        line: Some(place.line),
        column: Some(place.column),
    }
}

fn at(source: &Source, severity: Severity, path: &str, message: String) -> Finding {
    let place = source.place(path);
    Finding { severity, message, path: Some(path.to_owned()), line: Some(place.line), column: Some(place.column) }
}

fn refusal(error: &LoadError) -> Refusal {
    let text = error.to_string();
    let findings = match error {
        LoadError::UnknownKey { place, path, .. }
        | LoadError::UnknownValue { place, path, .. }
        | LoadError::MissingKey { place, path, .. }
        | LoadError::WrongType { place, path, .. } => vec![finding(place, Some(path.clone()), &text)],
        LoadError::Syntax { place, .. } => vec![finding(place, None, &text)],
        LoadError::Values { values } => values.iter().map(of_value).collect(),
        _ => vec![Finding { severity: Severity::Error, message: text, path: None, line: None, column: None }],
    };
    let message = findings.iter().map(|finding| &*finding.message).collect::<Vec<_>>().join("\n");
    Refusal { message, findings }
}

/// A task written out.
fn view(task: &Task, flat: &FlatTask) -> TaskView {
    TaskView {
        name: task.name.clone(),
        description: task.description.clone(),
        model: task.model.clone(),
        body: task.body.clone(),
        technique: task.technique.name().to_owned(),
        time_limit_s: task.time_limit_s,
        objects: (0..flat.objects.len()).map(|index| object(flat, index)).collect(),
        steps: (0..flat.steps.len()).map(|index| step(flat, index)).collect(),
        items: task.placed_items().iter().map(|placed| item(placed, flat)).collect(),
    }
}

fn step(flat: &FlatTask, index: usize) -> StepView {
    let asked = &flat.steps[index];
    StepView { label: flat.label(index), path: asked.path.clone(), objects: asked.objects().collect() }
}

fn item(placed: &PlacedItem<'_>, flat: &FlatTask) -> ItemView {
    let Axes { origin, rotation, scale } = placed.around;
    let within = format!("{}.", placed.path);
    let is_own = |object: &Object| object.path == placed.path || object.path.starts_with(&within);
    ItemView {
        name: placed.name.clone(),
        path: placed.path.clone(),
        kind: placed.item.kind().to_owned(),
        parent_at: origin,
        parent_rotation: quaternion(&rotation),
        parent_scale: scale,
        at: placed.own.origin,
        rotation: quaternion(&placed.own.rotation),
        objects: (0..flat.objects.len()).filter(|&index| is_own(&flat.objects[index])).collect(),
    }
}

/// Where something is and how large, whatever it is.
struct Form {
    kind: ObjectKind,
    at: [f64; 3],
    rotation: Rotation3<f64>,
    half_size: [f64; 3],
    drawn: [[f64; 3]; 3],
    hinge: Option<[f64; 3]>,
    handle: Option<[[f64; 3]; 2]>,
}

fn object(flat: &FlatTask, index: usize) -> ObjectView {
    let object = &flat.objects[index];
    let Form { kind, at, rotation, half_size, drawn, hinge, handle } = form(object);
    let asks = |step: &usize| flat.steps[*step].involves(index);
    ObjectView {
        name: object.name.clone(),
        path: object.path.clone(),
        kind,
        at,
        rotation: quaternion(&rotation),
        half_size,
        drawn: object.shift.map_or(drawn, |shift: Shift| shift.spans),
        hinge,
        handle,
        steps: (0..flat.steps.len()).filter(asks).collect(),
    }
}

fn form(object: &Object) -> Form {
    let still = Form {
        kind: ObjectKind::Obstacle,
        at: [0.0; 3],
        rotation: Rotation3::identity(),
        half_size: [0.0; 3],
        drawn: [[0.0; 3]; 3],
        hinge: None,
        handle: None,
    };
    match &object.shape {
        Shape::Sphere(sphere) => {
            let [x, y, z] = [sphere.region.x, sphere.region.y, sphere.region.z];
            Form {
                kind: ObjectKind::Sphere,
                at: [x, y, z].map(Range::centre),
                half_size: [sphere.radius.centre(); 3],
                drawn: [[x.width(), 0.0, 0.0], [0.0, y.width(), 0.0], [0.0, 0.0, z.width()]],
                ..still
            }
        }
        Shape::Stick(stick) => {
            let arm = stick.arm(stick.start.centre());
            let knob = [0, 1, 2].map(|k| stick.hinge[k] + arm[k]);
            Form { kind: ObjectKind::Stick, at: knob, half_size: [stick.knob; 3], hinge: Some(stick.hinge), ..still }
        }
        Shape::Button(block) | Shape::Obstacle(block) | Shape::Slider(Slider { block, .. }) => {
            let kind = match &object.shape {
                Shape::Button(_) => ObjectKind::Button,
                Shape::Slider(_) => ObjectKind::Slider,
                _ => ObjectKind::Obstacle,
            };
            let handle = if let Shape::Slider(slider) = &object.shape { Some(handle(slider)) } else { None };
            Form { kind, at: block.centre, rotation: block.rotation, half_size: block.half_extents(), handle, ..still }
        }
    }
}

/// Where the handle of a slider stands at first, and half its sizes.
fn handle(slider: &Slider) -> [[f64; 3]; 2] {
    let [mut height, mut width, depth] = slider.block.half_extents();
    match slider.rises {
        Direction::Right => width = 0.5 * slider.handle,
        Direction::Up => height = 0.5 * slider.handle,
    }
    [slider.handle_at(slider.start.centre()), [height, width, depth]]
}

/// `x y z w`.
pub fn quaternion(rotation: &Rotation3<f64>) -> [f64; 4] {
    UnitQuaternion::from_rotation_matrix(rotation).coords.into()
}
