//! From version 1 to version 2: each description of targets becomes an object, or several alike, and a step that names it.

use std::mem;

use indexmap::IndexMap;

use crate::description::{FORMAT_VERSION, Task};
use crate::notation::{Name, Place};
use crate::range::Range;
use crate::scene::{ButtonItem, Item, Scene, SphereItem};
use crate::script::{Dwell, Instruction, Names};
use crate::target::{Pointing, Pressing, Target};
use crate::user::User;

/// The body and the user of texts of version 1 that name none: what the defaults were while it was the newest.
const MODEL_THEN: &str = "mobl-arms";
const USER_THEN: User = User::Fastest;

impl Task {
    /// Gives a task of version 1 the body and the user that its text meant when it was written, wherever `is_given` does not know them.
    pub(crate) fn as_meant_then(&mut self, is_given: impl Fn(&str) -> bool) {
        if self.version >= FORMAT_VERSION {
            return;
        }
        if !is_given("model") {
            self.model = MODEL_THEN.to_owned();
        }
        if !is_given("user") {
            self.user = USER_THEN;
        }
    }

    /// The same task in the newest version of the format; one that is in it already stays as it is.
    pub fn converted(self) -> Self {
        let mut task = self.collapsed();
        if task.version >= FORMAT_VERSION {
            return task;
        }
        task.version = FORMAT_VERSION;
        let targets = mem::take(&mut task.targets);
        let count = |kind: &str| targets.iter().filter(|target| target.kind() == kind).count();
        let counts = [count("pointing"), count("pressing")];
        let (mut scene, mut numbers) = (IndexMap::new(), [0, 0]);
        for target in &targets {
            let (which, word) = match target {
                Target::Pointing(_) => (0, "sphere"),
                Target::Pressing(_) => (1, "button"),
            };
            numbers[which] += 1;
            let name = if counts[which] == 1 { word.to_owned() } else { format!("{word}{}", numbers[which]) };
            task.script.push(instruction(target, &name));
            scene.insert(name, item(target));
        }
        task.scene = Scene(scene);
        task.script.dedup_by(|next, kept| match (next, kept) {
            (Instruction::Press(Names(next)), Instruction::Press(Names(kept))) => {
                kept.append(next);
                true
            }
            _ => false,
        });
        task
    }
}

fn item(target: &Target) -> Item {
    match target {
        Target::Pointing(Pointing { position, radius, min_distance_from_previous, repeat, .. }) => {
            Item::Sphere(SphereItem {
                at: Place(*position),
                radius: *radius,
                moves: None,
                copies: (*repeat > 1).then_some(*repeat),
                min_distance_from_previous: *min_distance_from_previous,
            })
        }
        &Target::Pressing(Pressing { position: at, size, tilt_deg, min_force_n }) => Item::Button(ButtonItem {
            at: at.into(),
            size: size.map(Range::fixed),
            tilt_deg,
            turn_deg: 0.0,
            min_force_n,
        }),
    }
}

fn instruction(target: &Target, name: &str) -> Instruction {
    let names = Names(vec![Name(name.to_owned())]);
    match target {
        Target::Pointing(sphere) => Instruction::Dwell(Dwell::new(names, sphere.dwell_s)),
        Target::Pressing(_) => Instruction::Press(names),
    }
}
