//! A task as it is seen and changed.

use myo_tasks::Body;
use serde::{Deserialize, Serialize};

/// What stands in the text of a task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Look {
    /// What is wrong or odd, reach aside.
    pub findings: Vec<Finding>,
    /// What stands there; none where the text cannot be read.
    pub view: Option<TaskView>,
}

/// Something wrong or odd.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Finding {
    /// Whether it can be trained all the same.
    pub severity: Severity,
    /// One sentence, that of the command line.
    pub message: String,
    /// Path of the value that it is about, such as `scene.ball.radius`; none for the text as a whole.
    pub path: Option<String>,
    /// Line in the text, from 1.
    pub line: Option<u64>,
    /// Column in the text, from 1.
    pub column: Option<u64>,
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// The task cannot be trained.
    Error,
    /// It can, but probably not as intended.
    Warning,
}

/// A task, written out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct TaskView {
    /// Its name.
    pub name: String,
    /// What it says of itself.
    pub description: String,
    /// Name or file of the model.
    pub model: String,
    /// What its user changes of it.
    #[cfg_attr(test, ts(type = "unknown"))]
    pub body: Body,
    /// What points.
    pub technique: String,
    /// Longest episode (s).
    pub time_limit_s: f64,
    /// Everything that stands there.
    pub objects: Vec<ObjectView>,
    /// Everything that is to do.
    pub steps: Vec<StepView>,
    /// What the scene is written as: objects, groups and generators, each before what is in it.
    pub items: Vec<ItemView>,
}

/// What an object is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum ObjectKind {
    /// A sphere in the air.
    Sphere,
    /// A box that can be pressed.
    Button,
    /// A handle on a way.
    Slider,
    /// A knob at the end of a stick.
    Stick,
    /// A box that only stands in the way.
    Obstacle,
}

/// Something with a place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ObjectView {
    /// What people call it.
    pub name: String,
    /// Path of what describes it.
    pub path: String,
    /// What it is.
    pub kind: ObjectKind,
    /// Its centre; the middle of where it may be (m).
    pub at: [f64; 3],
    /// Its own axes: x up its upright face, y across it to the left, z out of it; quaternion, `x y z w`.
    pub rotation: [f64; 4],
    /// Half its sizes along them; the middle of what is drawn (m). Of a sphere three times the radius.
    pub half_size: [f64; 3],
    /// Three ways (m, world axes) along which its place is drawn, from minus one half of each to one half; zeros where it stands still.
    pub drawn: [[f64; 3]; 3],
    /// Where the hinge of a stick is (m).
    pub hinge: Option<[f64; 3]>,
    /// The handle of a slider: where it stands at first, half its sizes (m).
    pub handle: Option<[[f64; 3]; 2]>,
    /// Numbers of the steps that ask for it, from 0.
    pub steps: Vec<usize>,
}

/// Something that is to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct StepView {
    /// For people, such as `press panel.ok`.
    pub label: String,
    /// Path of what asks for it, such as `script[1].press[2]`.
    pub path: String,
    /// Indices of the objects that it may ask for.
    pub objects: Vec<usize>,
}

/// What a part of the scene is written as.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ItemView {
    /// What scripts call it, such as `panel.ok`.
    pub name: String,
    /// Path in the text, such as `scene.panel.objects.ok`.
    pub path: String,
    /// `sphere`, `button`, `group`, `grid` and so on.
    pub kind: String,
    /// Origin of the axes along which its place is written (m).
    pub parent_at: [f64; 3],
    /// These axes: quaternion, `x y z w`.
    pub parent_rotation: [f64; 4],
    /// Factor for the lengths written in it.
    pub parent_scale: f64,
    /// Where it is (m), in world axes; the middle of where it may be.
    pub at: [f64; 3],
    /// Its own axes: quaternion, `x y z w`.
    pub rotation: [f64; 4],
    /// Indices of its objects.
    pub objects: Vec<usize>,
}

/// A task that comes with the engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct PresetCard {
    /// Its name.
    pub name: String,
    /// What it says of itself.
    pub description: String,
    /// Its text, comments included.
    pub text: String,
    /// Number of its steps.
    pub steps: usize,
    /// A picture (SVG).
    pub picture: String,
}

/// A task file that was kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct TaskFile {
    /// Its name: that of the file without its ending.
    pub name: String,
    /// When it was last written (s since 1970).
    pub changed_s: f64,
}

/// The text of a task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct TaskText {
    /// Name of the file.
    pub name: String,
    /// What stands in it.
    pub text: String,
}

/// A surface of triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Surface {
    /// Corners (m).
    pub points: Vec<[f32; 3]>,
    /// Indices of the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}
