//! A task written out: every object and every step on its own, in the world's axes. What comes after reading works on this.

use myo_model::OrientedBox;
use nalgebra::{Rotation3, Vector3};

use crate::check::single_value_errors;
use crate::description::{Stimulus, Task};
use crate::motion::Path;
use crate::range::Range;
use crate::report::InvalidTask;
use crate::scene::Frame;
use crate::slider::Slider;
use crate::stick::Stick;
use crate::target::{Region, Target};
use crate::technique::RayFrom;

/// The shortest dwell (s) that a hold is needed for.
const HOLD_S: f64 = 0.1;

/// All objects and all steps of a task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlatTask {
    /// What stands there, in the order of the file.
    pub objects: Vec<Object>,
    /// What is to do, one after the other; at least one, but in [scenery](Task::scenery).
    pub steps: Vec<Step>,
    /// What points.
    pub pointer: Pointer,
    /// Steps that change places with each other.
    pub orders: Vec<Order>,
    /// Index of the button that corrects a wrong press, where each must be corrected.
    pub correction: Option<usize>,
    /// What is shown.
    pub stimulus: Stimulus,
    /// Names of fingers, beside the one that points, that steps ask for.
    pub fingers: Vec<String>,
}

/// Steps in a row that are done in another order than they are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// Index of the first.
    pub first: usize,
    /// How many there are, at least two.
    pub count: usize,
    /// Whether the user takes any order; else each episode draws one.
    pub is_any: bool,
}

/// What points, written out.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Pointer {
    /// The fingertip.
    #[default]
    Fingertip,
    /// A ray, and the object whose face it meets.
    Ray {
        /// What it follows.
        from: RayFrom,
        /// Index of the object; none where it goes through space.
        onto: Option<usize>,
    },
    /// A hand that reaches farther than the arm.
    GoGo {
        /// Distance (m) from the shoulder centre up to which it is the fingertip.
        beyond_m: f64,
        /// How fast it goes away beyond it (1/m).
        gain: f64,
    },
    /// A cursor on the face of an object.
    Cursor {
        /// Index of the object.
        onto: usize,
        /// Where the fingertip is (m) when the cursor is in the middle.
        at: [f64; 3],
        /// From the axes of the plane in which the hand works to the world's.
        rotation: Rotation3<f64>,
        /// Metres of the cursor per metre of the fingertip.
        gain: f64,
    },
    /// A cursor on the face of an object that moves as long as the fingertip is off its rest.
    RateCursor {
        /// Index of the object.
        onto: usize,
        /// Where the fingertip rests (m).
        at: [f64; 3],
        /// From the axes of the plane in which the hand works to the world's.
        rotation: Rotation3<f64>,
        /// Metres per second of the cursor per metre of the fingertip.
        gain_per_s: f64,
        /// How far off its rest the fingertip moves nothing (m).
        still_m: f64,
    },
}

/// Something with a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// What people call it, such as `keyboard.h`, or `target 3 (pressing)` in tasks of version 1.
    pub name: String,
    /// Path of what describes it in the file, such as `scene.keyboard` or `targets[2]`.
    pub path: String,
    /// What it is.
    pub shape: Shape,
    /// How far each episode draws it off its place; none where it stands still.
    pub shift: Option<Shift>,
    /// How much more than the middle of its range each episode draws of half its sizes, along its own axes; none where they are fixed.
    pub growth: Option<Shift>,
}

/// What an episode draws of a place or of sizes: so much of each of three ways, from minus one half of it to one half. What has the same
/// number is drawn as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Which of the draws of an episode it is.
    pub number: usize,
    /// The ways (m): of a place in world axes.
    pub spans: [[f64; 3]; 3],
}

/// What an object is.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A sphere in the air.
    Sphere(Sphere),
    /// A box that can be pressed.
    Button(Block),
    /// A handle on a way.
    Slider(Slider),
    /// A knob at the end of a stick on a hinge.
    Stick(Stick),
    /// A box that only stands in the way.
    Obstacle(Block),
}

/// A sphere without a surface to touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// Where the centre may lie (m from the shoulder centre).
    pub region: Region,
    /// Its radius (m).
    pub radius: Range,
    /// Index of another object and the least distance (m) that the centres keep.
    pub apart: Option<(usize, f64)>,
    /// How it moves about that place.
    pub path: Option<Path>,
}

/// A box fixed in space. Own axes: x up its upright face, y across it to the left, z out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Its centre (m from the shoulder centre).
    pub centre: [f64; 3],
    /// From its own axes to the world's.
    pub rotation: Rotation3<f64>,
    /// Full width, height and depth (m): along y, x and z of its own; the middle of what is drawn.
    pub size: [f64; 3],
    /// Force that counts as pressed (N); infinite for an obstacle.
    pub min_force_n: f64,
}

/// Something to do with an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Index of the object; the first where it is one of several.
    pub object: usize,
    /// All objects of which one lights up; empty where there is no choice.
    pub among: Vec<usize>,
    /// What is to do with it.
    pub action: Action,
    /// Number among [`FlatTask::fingers`] of the one that points or presses; none where the fingertip does, or what the technique makes of it.
    pub lead: Option<usize>,
    /// Where other fingers must be, or what they must press, at the same time.
    pub also: Vec<Also>,
    /// How another finger must come to the fingertip.
    pub pinch: Option<Pinch>,
    /// What must be waited for.
    pub cue: Option<Cue>,
    /// Path of what asks for it in the file, such as `script[1].press[2]`.
    pub path: String,
}

/// Where another finger must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Also {
    /// Its number among [`FlatTask::fingers`].
    pub finger: usize,
    /// Index of its sphere, or of the button that it must press.
    pub object: usize,
}

/// How another finger must come to the fingertip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinch {
    /// Its number among [`FlatTask::fingers`].
    pub finger: usize,
    /// Nearer than this (m) they are together.
    pub closer_than: f64,
    /// Farther apart than this (m) they must have been before.
    pub apart: f64,
}

/// What is to do with an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// To stay in a sphere without a break, for so many seconds.
    Dwell(f64),
    /// To be in a sphere for so many seconds in all.
    Follow(f64),
    /// To keep to a sphere for so many seconds, inside or not.
    Track(f64),
    /// To take hold of a slider's handle, move it and let go of it.
    Drag {
        /// Where it must be let go, as a share of the way.
        to: f64,
        /// How far off that it may be, as a share of the way.
        within: f64,
    },
    /// To take hold of a stick's knob, swing it and leave it.
    Swing {
        /// At which angle it must be left (rad).
        to: f64,
        /// How far off that it may be (rad).
        within: f64,
    },
    /// To take hold of a stick's knob, and drive something with it to where it must stop.
    Drive {
        /// Index of the sphere that is driven.
        vehicle: usize,
        /// Index of the sphere in which its middle must stop.
        into: usize,
        /// How slow it must be there (m/s).
        slower_than: f64,
    },
    /// To go straight to a sphere from another without leaving a way.
    Steer {
        /// Index of the sphere where the way begins.
        from: usize,
        /// Its width (m).
        width: f64,
    },
    /// To press a button; done when it is pressed.
    Press,
    /// To press a button and let go of it; done when it is let go.
    PressAndRelease,
}

/// A time that passes before a step counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cue {
    /// How long it takes (s); drawn anew every time.
    pub after_s: Range,
    /// Whether nothing tells before which object it is.
    pub hidden: bool,
}

impl Task {
    /// Its objects and steps.
    ///
    /// # Errors
    /// What is wrong with its values, or with what the script asks for.
    pub fn flat(&self) -> Result<FlatTask, InvalidTask> {
        self.check_values()?;
        FlatTask::of(self).map_err(|errors| InvalidTask { errors })
    }

    /// Its objects alone, without steps, for whoever judges in place of its script: that is not read and may be empty.
    ///
    /// # Errors
    /// What is wrong with its values or its scene, or a technique other than the fingertip.
    pub fn scenery(&self) -> Result<FlatTask, InvalidTask> {
        let mut errors = single_value_errors(self);
        if errors.is_empty() {
            match FlatTask::scenery_of(self) {
                Ok(flat) => return Ok(flat),
                Err(found) => errors = found,
            }
        }
        Err(InvalidTask { errors })
    }
}

impl FlatTask {
    /// How people call what a step asks for, such as `press keyboard.h`, or `target 3 (pressing)`.
    pub fn label(&self, step: usize) -> String {
        let (Object { name, .. }, Step { among, .. }) = (self.object(step), &self.steps[step]);
        let name = match among.last() {
            None => name.clone(),
            Some(&last) => format!("one of {name} to {}", self.objects[last].name),
        };
        if self.object(step).is_target() { name } else { self.words(step, &name) }
    }

    /// What is to do in a step, with what has this name.
    pub(crate) fn words(&self, step: usize, name: &str) -> String {
        let Step { action, pinch, lead, also, .. } = &self.steps[step];
        match (*action, &self.object(step).shape) {
            _ if pinch.is_some() => format!("pinch {name}"),
            (action, _) if lead.is_some() || !also.is_empty() => {
                let with = |finger: usize| format!(" with {}", self.fingers[finger]);
                let others =
                    also.iter().map(|also| format!(" and {}{}", self.objects[also.object].name, with(also.finger)));
                format!("{}{}{}", action.with(name), lead.map(with).unwrap_or_default(), others.collect::<String>())
            }
            (Action::Drag { to, .. }, Shape::Slider(slider)) => format!("drag {name} to {}", rounded(slider.value(to))),
            (Action::Swing { to, .. }, _) => format!("swing {name} to {} degrees", rounded(to.to_degrees())),
            (Action::Drive { vehicle, into, .. }, _) => {
                format!("drive {} into {}", self.objects[vehicle].name, self.objects[into].name)
            }
            (action, _) => action.with(name),
        }
    }

    /// What a step asks for, such as `press keyboard.h`; none in tasks of version 1, whose targets have numbers and no names.
    pub fn asked(&self, step: usize) -> Option<String> {
        (!self.object(step).is_target()).then(|| self.label(step))
    }

    /// The object of a step.
    ///
    /// # Panics
    /// When there is no such step.
    pub fn object(&self, step: usize) -> &Object {
        &self.objects[self.steps[step].object]
    }

    /// What is drawn of places of groups and boxes and of sizes of boxes, in the order of their numbers.
    pub fn shifts(&self) -> Vec<Shift> {
        let mut shifts: Vec<Shift> = vec![];
        for shift in self.objects.iter().flat_map(|object| [object.shift, object.growth]).flatten() {
            if shift.number == shifts.len() {
                shifts.push(shift);
            }
        }
        shifts
    }

    /// Brings fingers into alphabetical order: scripts that ask for the same ones have one structure, whichever comes first.
    pub(crate) fn sort_fingers(&mut self) {
        let names = self.fingers.clone();
        self.fingers.sort_unstable();
        let now = |finger: &mut usize| {
            *finger = self.fingers.iter().position(|name| *name == names[*finger]).unwrap_or(*finger);
        };
        for Step { lead, also, pinch, .. } in &mut self.steps {
            let also = also.iter_mut().map(|also| &mut also.finger);
            lead.iter_mut().chain(also).chain(pinch.iter_mut().map(|pinch| &mut pinch.finger)).for_each(now);
        }
    }

    /// Numbers of the other fingers that are asked to press something.
    pub fn pressing_fingers(&self) -> impl Iterator<Item = usize> {
        let presses = self.steps.iter().filter(|step| step.dwell_s().is_none());
        presses.flat_map(|step| step.lead.into_iter().chain(step.also.iter().map(|also| also.finger)))
    }

    /// The steps that ask for an object.
    pub fn steps_of(&self, object: usize) -> impl Iterator<Item = &Step> {
        self.steps.iter().filter(move |step| step.asks_for(object))
    }
}

impl Action {
    /// What is to do, with what has this name.
    pub(crate) fn with(self, name: &str) -> String {
        match self {
            Self::Dwell(_) => format!("dwell in {name}"),
            Self::Follow(_) => format!("follow {name}"),
            Self::Track(_) => format!("track {name}"),
            Self::Drag { .. } => format!("drag {name}"),
            Self::Swing { .. } => format!("swing {name}"),
            Self::Drive { .. } => format!("drive with {name}"),
            Self::Steer { .. } => format!("steer to {name}"),
            Self::Press => format!("press {name}"),
            Self::PressAndRelease => format!("press and release {name}"),
        }
    }
}

impl Step {
    /// One that asks the same of one object, and nothing of other fingers.
    pub(crate) const fn new(object: usize, action: Action, cue: Option<Cue>, path: String) -> Self {
        Self { object, among: vec![], action, lead: None, also: vec![], pinch: None, cue, path }
    }

    /// All objects that it may ask for.
    pub fn objects(&self) -> impl Iterator<Item = usize> + '_ {
        let alone = self.among.is_empty().then_some(self.object);
        alone.into_iter().chain(self.among.iter().copied())
    }

    /// Whether it asks for an object, or may.
    pub fn asks_for(&self, object: usize) -> bool {
        self.objects().any(|own| own == object)
    }

    /// Whether it asks any finger for an object, or may.
    pub fn involves(&self, object: usize) -> bool {
        self.asks_for(object) || self.also.iter().any(|also| also.object == object)
    }

    /// Whether it asks for an object, or may, with a finger of this number; none is what points without one.
    pub fn asks_finger_for(&self, finger: Option<usize>, object: usize) -> bool {
        let also = || self.also.iter().any(|also| (Some(also.finger), also.object) == (finger, object));
        self.lead == finger && self.asks_for(object) || also()
    }

    /// Seconds to stay; none where it is no dwell.
    pub const fn dwell_s(&self) -> Option<f64> {
        match self.action {
            Action::Dwell(seconds) | Action::Follow(seconds) | Action::Track(seconds) => Some(seconds),
            // The end of a way is a sphere, and so is a knob, where nobody needs to stay.
            Action::Steer { .. } | Action::Swing { .. } | Action::Drive { .. } => Some(0.0),
            Action::Press | Action::PressAndRelease | Action::Drag { .. } => None,
        }
    }

    /// The least time (s) that the dwell takes, zero where it is none: what comes next begins with the next control step of
    /// `control_dt_s` seconds.
    pub fn least_dwell_s(&self, control_dt_s: f64) -> f64 {
        // A dwell of whole control steps is not made one longer by rounding.
        self.dwell_s().map_or(0.0, |dwell_s| (dwell_s / control_dt_s - 1e-6).ceil().max(0.0) * control_dt_s)
    }

    /// Whether muscles must hold the pointer in a sphere for it: in shorter dwells it may as well pass through.
    pub fn needs_hold(&self) -> bool {
        self.dwell_s().is_some_and(|seconds| seconds >= HOLD_S)
    }
}

impl Object {
    /// Where its centre may lie, but for its [shift](Self::shift); a single point for a box, and of a stick its hinge.
    pub fn region(&self) -> Region {
        match &self.shape {
            Shape::Sphere(sphere) => sphere.region,
            Shape::Button(block) | Shape::Obstacle(block) | Shape::Slider(Slider { block, .. }) => {
                Region::point(block.centre)
            }
            Shape::Stick(stick) => Region::point(stick.hinge),
        }
    }

    /// The box around all places where an episode may draw its centre.
    pub fn places(&self) -> Region {
        match self.shift {
            None => self.region(),
            Some(shift) => widened(self.region(), |axis| shift.farthest(axis)),
        }
    }

    /// The corners of all places where an episode may draw its centre.
    pub fn corners(&self) -> Vec<[f64; 3]> {
        let corners = self.region().corners();
        let Some(shift) = self.shift else { return corners.to_vec() };
        let offsets = Region::corner_shares().map(|at| shift.at(at));
        offsets.iter().flat_map(|by| corners.map(|corner| [0, 1, 2].map(|k| corner[k] + by[k]))).collect()
    }

    /// Where its centre, or that of its handle or knob, may ever be: its places, and all ways about them.
    pub fn extent(&self) -> Region {
        widened(self.places(), |axis| match &self.shape {
            Shape::Sphere(Sphere { path: Some(path), .. }) => path.farthest(axis),
            Shape::Slider(slider) => 0.5 * slider.length * slider.along()[axis].abs(),
            Shape::Stick(stick) => stick.upright[axis].hypot(stick.aside[axis]),
            _ => 0.0,
        })
    }

    /// The least gap (m) to another, wherever and however large an episode draws them; negative where they may overlap, infinite where one is no box.
    pub fn least_gap(&self, other: &Self) -> f64 {
        let [Some(a), Some(b)] = [self, other].map(Self::largest) else { return f64::INFINITY };
        let shifts = [self.shift, other.shift];
        // What is moved as one keeps its distance.
        let apart = shifts.into_iter().flatten().filter(|_| shifts[0] != shifts[1]);
        let ways: Vec<_> = apart.flat_map(|shift| shift.spans.map(Vector3::from)).collect();
        a.oriented().least_gap(&b.oriented(), &ways)
    }

    /// Whether each episode draws where it stands with others, or its sizes as a box.
    pub const fn is_drawn(&self) -> bool {
        self.shift.is_some() || self.growth.is_some()
    }

    /// The word for what it is: `sphere`, `button`, `slider`, `stick` or `obstacle`.
    pub const fn kind(&self) -> &'static str {
        match self.shape {
            Shape::Sphere(_) => "sphere",
            Shape::Button(_) => "button",
            Shape::Slider(_) => "slider",
            Shape::Stick(_) => "stick",
            Shape::Obstacle(_) => "obstacle",
        }
    }

    /// The sphere that it is.
    pub const fn sphere(&self) -> Option<&Sphere> {
        match &self.shape {
            Shape::Sphere(sphere) => Some(sphere),
            Shape::Button(_) | Shape::Obstacle(_) | Shape::Slider(_) | Shape::Stick(_) => None,
        }
    }

    /// Whether it is no box: a sphere, or a stick, of whose knob the place is where the hinge is.
    pub const fn is_round(&self) -> bool {
        matches!(self.shape, Shape::Sphere(_) | Shape::Stick(_))
    }

    /// The box that it is, as far as it can be touched; with the middle of sizes that are drawn.
    pub const fn block(&self) -> Option<&Block> {
        match &self.shape {
            Shape::Button(block) | Shape::Obstacle(block) | Shape::Slider(Slider { block, .. }) => Some(block),
            Shape::Sphere(_) | Shape::Stick(_) => None,
        }
    }

    /// The same as large as an episode may draw it.
    pub fn largest(&self) -> Option<Block> {
        self.grown(1.0)
    }

    /// The same as small as an episode may draw it.
    pub fn smallest(&self) -> Option<Block> {
        self.grown(-1.0)
    }

    /// The same, larger by so much of what may be drawn: from -1, the smallest, to 1.
    fn grown(&self, by: f64) -> Option<Block> {
        let (block, growth) = (self.block()?, self.growth);
        let [height, width, depth] =
            [0, 1, 2].map(|axis| growth.map_or(0.0, |growth| 2.0 * by * growth.farthest(axis)));
        let [w, h, d] = block.size;
        Some(Block { size: [w + width, h + height, d + depth], ..block.clone() })
    }

    /// Whether it comes from a task of version 1, where objects and steps are one.
    pub(crate) fn is_target(&self) -> bool {
        self.path.starts_with("targets[")
    }
}

impl Shift {
    /// How far (m) it may be along an axis, either way.
    pub fn farthest(&self, axis: usize) -> f64 {
        0.5 * self.spans.iter().map(|span| span[axis].abs()).sum::<f64>()
    }

    /// How far it is off (m) where these shares of the ways, from 0 to 1, are drawn.
    pub fn at(&self, shares: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.spans.iter().zip(shares).map(|(span, share)| span[axis] * (share - 0.5)).sum())
    }
}

/// A region that goes so many metres farther along each axis, either way.
fn widened(Region { x, y, z }: Region, by: impl Fn(usize) -> f64) -> Region {
    let wide = |range: Range, by: f64| Range::new(range.min - by, range.max + by);
    Region { x: wide(x, by(0)), y: wide(y, by(1)), z: wide(z, by(2)) }
}

impl Block {
    /// A box in the middle of a frame; `size` in the frame's own lengths.
    pub(crate) fn in_frame(frame: Frame, size: [f64; 3], min_force_n: f64) -> Self {
        let size = size.map(|length| frame.scale * length);
        Self { centre: frame.origin.into(), rotation: frame.rotation, size, min_force_n }
    }

    /// Half sizes (m) along its own axes.
    pub fn half_extents(&self) -> [f64; 3] {
        let [width, height, depth] = self.size;
        [0.5 * height, 0.5 * width, 0.5 * depth]
    }

    /// Gap (m) to another box; negative when they overlap.
    pub fn gap(&self, other: &Self) -> f64 {
        self.oriented().gap(&other.oriented())
    }

    fn oriented(&self) -> OrientedBox {
        OrientedBox {
            centre: self.centre.into(),
            axes: self.rotation.into_inner(),
            half_size: self.half_extents().into(),
        }
    }

    /// The face's outward unit normal in world axes.
    pub fn normal(&self) -> [f64; 3] {
        (self.rotation * Vector3::z()).into()
    }

    /// A point of the face in m from the shoulder centre; `across` and `up` run from -1 to 1.
    pub fn face_point(&self, across: f64, up: f64) -> [f64; 3] {
        let [h, w, d] = self.half_extents();
        (Vector3::from(self.centre) + self.rotation * Vector3::new(up * h, across * w, d)).into()
    }
}

/// A task of version 1, written out: each target is an object and a step.
pub(crate) fn of_targets(targets: &[Target]) -> FlatTask {
    let mut flat = FlatTask::default();
    for (origin, target) in targets.iter().enumerate() {
        for _ in 0..target.repeat() {
            let object = flat.objects.len();
            let path = format!("targets[{origin}]");
            let (shape, action) = match target {
                Target::Pointing(sphere) => {
                    let apart = object.checked_sub(1).map(|previous| (previous, sphere.min_distance()));
                    let shape = Sphere { region: sphere.position, radius: sphere.radius, apart, path: None };
                    (Shape::Sphere(shape), Action::Dwell(sphere.dwell_s))
                }
                Target::Pressing(button) => (Shape::Button(button.block()), Action::Press),
            };
            flat.objects.push(Object {
                name: target.label(object),
                path: path.clone(),
                shape,
                shift: None,
                growth: None,
            });
            flat.steps.push(Step::new(object, action, None, path));
        }
    }
    flat
}

/// Without what binary fractions leave at the end.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
