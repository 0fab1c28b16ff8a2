//! A task written out: every object and every step on its own, in the world's axes. What comes after reading works on this.

use myo_model::OrientedBox;
use nalgebra::{Rotation3, Vector3};

use crate::description::{Task, rounded_steps};
use crate::range::Range;
use crate::report::InvalidTask;
use crate::target::{Region, Target};

/// All objects and all steps of a task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    /// What stands there, in the order of the file.
    pub objects: Vec<Object>,
    /// What is to do, one after the other; at least one.
    pub steps: Vec<Step>,
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
}

/// What an object is.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A sphere in the air.
    Sphere(Sphere),
    /// A box that can be pressed.
    Button(Block),
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
}

/// A box fixed in space. Own axes: x up its upright face, y across it to the left, z out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Its centre (m from the shoulder centre).
    pub centre: [f64; 3],
    /// From its own axes to the world's.
    pub rotation: Rotation3<f64>,
    /// Full width, height and depth (m): along y, x and z of its own.
    pub size: [f64; 3],
    /// Force that counts as pressed (N); infinite for an obstacle.
    pub min_force_n: f64,
}

/// Something to do with an object.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Index of the object.
    pub object: usize,
    /// What is to do with it.
    pub action: Action,
    /// Path of what asks for it in the file, such as `script[1].press[2]`.
    pub path: String,
}

/// What is to do with an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// To stay in a sphere without a break, for so many seconds.
    Dwell(f64),
    /// To press a button; done when it is pressed.
    Press,
    /// To press a button and let go of it; done when it is let go.
    PressAndRelease,
}

impl Task {
    /// Its objects and steps.
    ///
    /// # Errors
    /// What is wrong with its values, or with what the script asks for.
    pub fn stage(&self) -> Result<Stage, InvalidTask> {
        self.check_values()?;
        Stage::of(self).map_err(|errors| InvalidTask { errors })
    }
}

impl Stage {
    /// How people call what a step asks for, such as `press keyboard.h`, or `target 3 (pressing)`.
    pub fn label(&self, step: usize) -> String {
        let Object { name, .. } = self.object(step);
        match self.steps[step].action {
            _ if self.object(step).is_target() => name.clone(),
            Action::Dwell(_) => format!("dwell in {name}"),
            Action::Press => format!("press {name}"),
            Action::PressAndRelease => format!("press and release {name}"),
        }
    }

    /// The number of a step from one on, and what it asks for where that is more than an object's number.
    pub fn number(&self, step: usize) -> String {
        let number = step + 1;
        if self.object(step).is_target() { number.to_string() } else { format!("{number} {}", self.label(step)) }
    }

    /// The object of a step.
    ///
    /// # Panics
    /// When there is no such step.
    pub fn object(&self, step: usize) -> &Object {
        &self.objects[self.steps[step].object]
    }

    /// The steps that ask for an object.
    pub fn steps_of(&self, object: usize) -> impl Iterator<Item = &Step> {
        self.steps.iter().filter(move |step| step.object == object)
    }
}

impl Step {
    /// Seconds to stay; none where it is no dwell.
    pub const fn dwell_s(&self) -> Option<f64> {
        match self.action {
            Action::Dwell(seconds) => Some(seconds),
            Action::Press | Action::PressAndRelease => None,
        }
    }

    /// Control steps of `control_dt_s` seconds to stay; 1 where it is no dwell.
    pub fn dwell_steps(&self, control_dt_s: f64) -> u32 {
        self.dwell_s().map_or(1, |seconds| rounded_steps(seconds, control_dt_s))
    }
}

impl Object {
    /// Where its centre may lie; a single point for a box.
    pub fn region(&self) -> Region {
        match &self.shape {
            Shape::Sphere(sphere) => sphere.region,
            Shape::Button(block) | Shape::Obstacle(block) => Region::point(block.centre),
        }
    }

    /// The word for what it is: `sphere`, `button` or `obstacle`.
    pub const fn kind(&self) -> &'static str {
        match self.shape {
            Shape::Sphere(_) => "sphere",
            Shape::Button(_) => "button",
            Shape::Obstacle(_) => "obstacle",
        }
    }

    /// The sphere that it is.
    pub const fn sphere(&self) -> Option<&Sphere> {
        match &self.shape {
            Shape::Sphere(sphere) => Some(sphere),
            Shape::Button(_) | Shape::Obstacle(_) => None,
        }
    }

    /// The box that it is.
    pub const fn block(&self) -> Option<&Block> {
        match &self.shape {
            Shape::Button(block) | Shape::Obstacle(block) => Some(block),
            Shape::Sphere(_) => None,
        }
    }

    /// Whether it comes from a task of version 1, where objects and steps are one.
    pub(crate) fn is_target(&self) -> bool {
        self.path.starts_with("targets[")
    }
}

impl Block {
    /// Half sizes (m) along its own axes.
    pub fn half_extents(&self) -> [f64; 3] {
        let [width, height, depth] = self.size;
        [0.5 * height, 0.5 * width, 0.5 * depth]
    }

    /// Gap (m) to another box; negative when they overlap.
    pub fn gap(&self, other: &Self) -> f64 {
        let [a, b] = [self, other].map(|block| OrientedBox {
            centre: block.centre.into(),
            axes: block.rotation.into_inner(),
            half_size: block.half_extents().into(),
        });
        a.gap(&b)
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

/// The stage of a task of version 1: each target is an object and a step.
pub(crate) fn of_targets(targets: &[Target]) -> Stage {
    let mut stage = Stage::default();
    for (origin, target) in targets.iter().enumerate() {
        for _ in 0..target.repeat() {
            let object = stage.objects.len();
            let path = format!("targets[{origin}]");
            let (shape, action) = match target {
                Target::Pointing(sphere) => {
                    let apart = object.checked_sub(1).map(|previous| (previous, sphere.min_distance()));
                    let shape = Sphere { region: sphere.position, radius: sphere.radius, apart };
                    (Shape::Sphere(shape), Action::Dwell(sphere.dwell_s))
                }
                Target::Pressing(button) => (Shape::Button(button.block()), Action::Press),
            };
            stage.objects.push(Object { name: target.label(object), path: path.clone(), shape });
            stage.steps.push(Step { object, action, path });
        }
    }
    stage
}
