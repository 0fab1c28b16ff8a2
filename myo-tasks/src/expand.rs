//! From the scene and the script of a file to every object and every step.

use std::collections::HashMap;
use std::f64::consts::TAU;

use myo_model::Nearest;

use crate::description::Task;
use crate::range::Range;
use crate::report::TaskError;
use crate::scene::{Circle, Frame, Grid, Group, Item, Keyboard, Scene, SphereItem};
use crate::script::{Dwell, Instruction, Repeat, Typing};
use crate::stage::{Action, Block, Object, Shape, Sphere, Stage, Step, of_targets};
use crate::target::{DWELL, Region};

/// Most objects of a scene.
pub const OBJECTS_MAX: usize = 256;
/// Most steps of a script.
pub const STEPS_MAX: usize = 256;
/// Groups within groups.
const DEPTH_MAX: usize = 16;

impl Stage {
    /// All objects and steps of a task whose single values are right.
    pub(crate) fn of(task: &Task) -> Result<Self, Vec<TaskError>> {
        if task.version == 1 {
            return Ok(of_targets(&task.targets));
        }
        let mut builder = Builder::default();
        builder.scene(&task.scene, "", "scene", Frame::world(), 0);
        if builder.errors.is_empty() {
            builder.script(&task.script, "script");
        }
        if builder.errors.is_empty() && builder.stage.steps.is_empty() {
            builder.refuse(
                "script",
                "the script",
                "has no step; write what is to do, such as `- press: [1, 2]`".into(),
            );
        }
        if builder.errors.is_empty() { Ok(builder.stage) } else { Err(builder.errors) }
    }
}

/// A stage in the making.
#[derive(Default)]
struct Builder {
    stage: Stage,
    /// Objects that each name stands for, groups included.
    named: HashMap<String, Vec<usize>>,
    /// Names of keyboards.
    keyboards: Vec<String>,
    errors: Vec<TaskError>,
}

impl Builder {
    fn refuse(&mut self, path: &str, subject: &str, problem: String) {
        self.errors.push(TaskError::Value { path: path.to_owned(), subject: subject.to_owned(), problem });
    }

    fn scene(&mut self, scene: &Scene, group: &str, path: &str, frame: Frame, depth: usize) {
        for (name, item) in &scene.0 {
            let path = format!("{path}.{name}");
            if let Some(problem) = bad_name(name) {
                self.refuse(&path, &format!("the name {name:?}"), problem);
                continue;
            }
            self.item(item, &join(group, name), &path, frame, depth);
        }
    }

    /// Adds an item, and notes what its name stands for.
    fn item(&mut self, item: &Item, name: &str, path: &str, frame: Frame, depth: usize) {
        let first = self.stage.objects.len();
        match item {
            Item::Sphere(sphere) => self.spheres(sphere, name, path, frame),
            Item::Button(button) => {
                let frame = frame.child(button.at, button.tilt_deg, button.turn_deg, 1.0);
                self.push(name, path, Shape::Button(block(frame, button.size, button.min_force_n)));
            }
            Item::Obstacle(obstacle) => {
                let frame = frame.child(obstacle.at, obstacle.tilt_deg, obstacle.turn_deg, 1.0);
                self.push(name, path, Shape::Obstacle(block(frame, obstacle.size, f64::INFINITY)));
            }
            Item::Group(group) => self.group(group, name, path, frame, depth),
            Item::Grid(grid) => self.grid(grid, name, path, frame, depth),
            Item::Circle(circle) => self.circle(circle, name, path, frame, depth),
            Item::Keyboard(keyboard) => self.keyboard(keyboard, name, path, frame),
        }
        let objects: Vec<usize> = (first..self.stage.objects.len()).collect();
        if self.named.insert(name.to_owned(), objects).is_some() {
            self.refuse(path, &format!("the name `{name}`"), "is that of another object; names must differ".into());
        }
    }

    fn push(&mut self, name: &str, path: &str, shape: Shape) {
        if self.stage.objects.len() == OBJECTS_MAX {
            // Said once: what comes after is too much as well.
            if !self.errors.iter().any(|error| error.path() == "scene") {
                let problem = format!("has more than {OBJECTS_MAX} objects, what generators write included");
                self.refuse("scene", "the scene", problem);
            }
            return;
        }
        self.stage.objects.push(Object { name: name.to_owned(), path: path.to_owned(), shape });
    }

    fn spheres(&mut self, item: &SphereItem, name: &str, path: &str, frame: Frame) {
        let Some(region) = moved(item.at.0, frame) else {
            let problem = "is a range of places in a group that is tilted or turned; give single numbers, or put the sphere \
                           outside of the group";
            return self.refuse(&format!("{path}.at"), &format!("the place of `{name}`"), problem.into());
        };
        let radius = Range::new(frame.scale * item.radius.min, frame.scale * item.radius.max);
        let least = item.min_distance_from_previous.map_or(2.0 * radius.max, |least| frame.scale * least);
        for copy in 1..=item.copies.unwrap_or(1) {
            let is_solid = |object: &Object| !matches!(object.shape, Shape::Obstacle(_));
            let apart = self.stage.objects.iter().rposition(is_solid).map(|previous| (previous, least));
            let shape = Shape::Sphere(Sphere { region, radius, apart });
            match item.copies {
                None => self.push(name, path, shape),
                Some(_) => self.child(&copy.to_string(), name, path, |builder, name| builder.push(name, path, shape)),
            }
        }
    }

    /// Adds one object of several that have a name together.
    fn child(&mut self, own: &str, group: &str, path: &str, add: impl FnOnce(&mut Self, &str)) {
        let name = join(group, own);
        let first = self.stage.objects.len();
        add(self, &name);
        let objects: Vec<usize> = (first..self.stage.objects.len()).collect();
        if self.named.insert(name.clone(), objects).is_some() {
            self.refuse(path, &format!("the name `{name}`"), "stands for two objects; names must differ".into());
        }
    }

    fn group(&mut self, group: &Group, name: &str, path: &str, frame: Frame, depth: usize) {
        let frame = frame.child(group.at, group.tilt_deg, group.turn_deg, group.scale);
        if group.objects.is_empty() {
            self.refuse(path, &format!("the group `{name}`"), "has no objects".into());
        } else if depth == DEPTH_MAX {
            let problem = format!("is the {DEPTH_MAX}th within another; write fewer groups within groups");
            self.refuse(path, &format!("the group `{name}`"), problem);
        } else {
            self.scene(&group.objects, name, &format!("{path}.objects"), frame, depth + 1);
        }
    }

    fn grid(&mut self, grid: &Grid, name: &str, path: &str, frame: Frame, depth: usize) {
        let count = (grid.rows * grid.columns) as usize;
        if !grid.names.is_empty() && grid.names.len() != count {
            let problem = format!("are {} for {count} places", grid.names.len());
            return self.refuse(&format!("{path}.names"), &format!("the names of `{name}`"), problem);
        }
        let own = |k: usize| grid.names.get(k).map_or_else(|| (k + 1).to_string(), |name| name.0.clone());
        let frame = frame.child(grid.at, grid.tilt_deg, grid.turn_deg, 1.0);
        let [across, down] = grid.pitch.pair();
        let middle = |count: u32| 0.5 * f64::from(count - 1);
        let places = (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column)));
        let places = places.map(|(row, column)| {
            [down * (middle(grid.rows) - f64::from(row)), across * (middle(grid.columns) - f64::from(column)), 0.0]
        });
        self.each_at(places, own, &grid.of, name, path, frame, depth);
    }

    fn circle(&mut self, circle: &Circle, name: &str, path: &str, frame: Frame, depth: usize) {
        let frame = frame.child(circle.at, circle.tilt_deg, circle.turn_deg, 1.0);
        // Each is as nearly opposite of the one before as an odd number allows.
        let across = circle.count.div_ceil(2);
        let places = (0..circle.count).map(|k| {
            let angle = TAU * f64::from(k * across % circle.count) / f64::from(circle.count);
            [0.5 * circle.diameter * angle.cos(), -0.5 * circle.diameter * angle.sin(), 0.0]
        });
        self.each_at(places, |k| (k + 1).to_string(), &circle.of, name, path, frame, depth);
    }

    /// The same item at several places.
    #[expect(clippy::too_many_arguments, reason = "what it is, where, and what it is called")]
    fn each_at(
        &mut self,
        places: impl Iterator<Item = [f64; 3]>,
        own: impl Fn(usize) -> String,
        item: &Item,
        name: &str,
        path: &str,
        frame: Frame,
        depth: usize,
    ) {
        if depth == DEPTH_MAX {
            let problem = format!("is the {DEPTH_MAX}th within another; write fewer groups within groups");
            return self.refuse(path, &format!("`{name}`"), problem);
        }
        let path = format!("{path}.of");
        for (k, place) in places.enumerate() {
            let own = own(k);
            if let Some(problem) = bad_name(&own) {
                return self.refuse(&path, &format!("the name {own:?}"), problem);
            }
            self.item(item, &join(name, &own), &path, frame.child(place, 0.0, 0.0, 1.0), depth + 1);
            if !self.errors.is_empty() {
                // Said of one, it is said of all.
                return;
            }
        }
    }

    fn keyboard(&mut self, keyboard: &Keyboard, name: &str, path: &str, frame: Frame) {
        let frame = frame.child(keyboard.at, keyboard.tilt_deg, keyboard.turn_deg, 1.0);
        self.keyboards.push(name.to_owned());
        let rows = keyboard.layout.rows();
        let key = |place: [f64; 3], width: f64| {
            let size = [width, keyboard.key, keyboard.depth];
            Shape::Button(block(frame.child(place, 0.0, 0.0, 1.0), size, keyboard.min_force_n))
        };
        // The space bar is one more row.
        let up = |row: usize| keyboard.pitch * (0.5 * rows.len() as f64 - row as f64);
        let left = |column: f64| keyboard.pitch * (0.5 * (keyboard.layout.columns() - 1.0) - column);
        for (row, (letters, indent)) in rows.into_iter().enumerate() {
            for (column, letter) in letters.chars().enumerate() {
                let shape = key([up(row), left(indent + column as f64), 0.0], keyboard.key);
                self.child(&letter.to_string(), name, path, |builder, name| builder.push(name, path, shape));
            }
        }
        let space = key([up(rows.len()), 0.0, 0.0], 4.0 * keyboard.pitch + keyboard.key);
        self.child("space", name, path, |builder, name| builder.push(name, path, space));
    }

    fn script(&mut self, script: &[Instruction], path: &str) {
        for (k, instruction) in script.iter().enumerate() {
            let path = format!("{path}[{k}]");
            match instruction {
                Instruction::Dwell(dwell) => self.dwell(dwell, &format!("{path}.dwell")),
                Instruction::Press(names) => self.press(&names.0, Action::Press, &format!("{path}.press")),
                Instruction::PressAndRelease(names) => {
                    self.press(&names.0, Action::PressAndRelease, &format!("{path}.press_and_release"));
                }
                Instruction::Type(typing) => self.type_text(typing, &format!("{path}.type")),
                Instruction::Repeat(repeat) => self.repeat(repeat, &format!("{path}.repeat")),
            }
            if self.errors.iter().any(|error| error.path() == "script") {
                return;
            }
        }
    }

    fn step(&mut self, object: usize, action: Action, path: &str) {
        if self.stage.steps.len() == STEPS_MAX {
            if !self.errors.iter().any(|error| error.path() == "script") {
                let problem = format!("has more than {STEPS_MAX} steps, repetitions counted");
                self.refuse("script", "the script", problem);
            }
            return;
        }
        self.stage.steps.push(Step { object, action, path: path.to_owned() });
    }

    fn dwell(&mut self, dwell: &Dwell, path: &str) {
        if let Err(problem) = DWELL.check(dwell.for_s) {
            self.refuse(&format!("{path}.for_s"), "the dwell", problem.message().to_owned());
        }
        for name in &dwell.within.0 {
            let path_in = format!("{path}.in");
            for object in self.find(&name.0, &path_in) {
                if self.stage.objects[object].sphere().is_some() {
                    self.step(object, Action::Dwell(dwell.for_s), path);
                } else {
                    let kind = self.stage.objects[object].kind();
                    let problem = format!("is {}; the fingertip can dwell in spheres only", with_article(kind));
                    self.refuse(&path_in, &format!("`{}`", self.stage.objects[object].name.clone()), problem);
                }
            }
        }
    }

    fn press(&mut self, names: &[crate::scene::Name], action: Action, path: &str) {
        for (k, name) in names.iter().enumerate() {
            let path = if names.len() == 1 { path.to_owned() } else { format!("{path}[{k}]") };
            for object in self.find(&name.0, &path) {
                self.press_one(object, action, &path);
            }
        }
    }

    fn press_one(&mut self, object: usize, action: Action, path: &str) {
        if matches!(self.stage.objects[object].shape, Shape::Button(_)) {
            self.step(object, action, path);
        } else {
            let Object { name, .. } = &self.stage.objects[object];
            let (name, kind) = (name.clone(), self.stage.objects[object].kind());
            self.refuse(path, &format!("`{name}`"), format!("is {}; only buttons can be pressed", with_article(kind)));
        }
    }

    fn type_text(&mut self, typing: &Typing, path: &str) {
        let keyboard = match (&typing.on, &self.keyboards[..]) {
            (Some(name), _) => name.clone(),
            (None, [only]) => only.clone(),
            (None, []) => {
                let problem =
                    "needs a keyboard in the scene, such as `keyboard: {kind: keyboard, pitch: 0.01, key: 0.009}`";
                return self.refuse(path, "typing", problem.into());
            }
            (None, several) => {
                let names: Vec<_> = several.iter().map(|name| format!("`{name}`")).collect();
                let problem = format!("must say on which keyboard (`on`): {}", names.join(" or "));
                return self.refuse(path, "typing", problem);
            }
        };
        let Some(full) = self.resolve(&keyboard).map(|(name, _)| name) else {
            self.find(&keyboard, &format!("{path}.on"));
            return;
        };
        if typing.text.is_empty() {
            return self.refuse(path, "the text", "is empty".into());
        }
        for letter in typing.text.chars() {
            let key = if letter == ' ' { "space".into() } else { letter.to_lowercase().to_string() };
            match self.named.get(&join(&full, &key)).map(|objects| objects[..].to_vec()) {
                Some(objects) => objects.into_iter().for_each(|object| self.press_one(object, Action::Press, path)),
                None => {
                    let problem = format!("has no key for {letter:?} of the text {:?}", typing.text);
                    return self.refuse(path, &format!("`{full}`"), problem);
                }
            }
        }
    }

    fn repeat(&mut self, repeat: &Repeat, path: &str) {
        if !(1..=STEPS_MAX as u32).contains(&repeat.times) {
            let problem = format!("is {}; it must be from 1 to {STEPS_MAX}", repeat.times);
            return self.refuse(&format!("{path}.times"), &format!("`{path}.times`"), problem);
        }
        if repeat.steps.is_empty() {
            return self.refuse(&format!("{path}.steps"), &format!("`{path}.steps`"), "has no step".into());
        }
        for _ in 0..repeat.times {
            self.script(&repeat.steps, &format!("{path}.steps"));
            if !self.errors.is_empty() {
                return;
            }
        }
    }

    /// Full name and objects that a name in the script stands for: the full name, or the end of only one.
    fn resolve(&self, name: &str) -> Option<(String, Vec<usize>)> {
        if let Some(objects) = self.named.get(name) {
            return Some((name.to_owned(), objects.clone()));
        }
        let end = format!(".{name}");
        let mut found = self.named.iter().filter(|(full, _)| full.ends_with(&end));
        match (found.next(), found.next()) {
            (Some((full, objects)), None) => Some((full.clone(), objects.clone())),
            _ => None,
        }
    }

    /// Objects that a name stands for; none, and an error, where it is not clear which.
    fn find(&mut self, name: &str, path: &str) -> Vec<usize> {
        if let Some((_, objects)) = self.resolve(name) {
            return objects;
        }
        let end = format!(".{name}");
        let mut several: Vec<&str> =
            self.named.keys().map(String::as_str).filter(|full| full.ends_with(&end)).collect();
        several.sort_unstable();
        let problem = if several.is_empty() {
            let mut names: Vec<&str> = self.named.keys().map(String::as_str).collect();
            names.sort_unstable();
            format!("is no object of the scene; {}", Nearest::to(name, &names))
        } else {
            let names: Vec<String> = several.iter().map(|name| format!("`{name}`")).collect();
            format!("may stand for {}; write which", names.join(" or "))
        };
        self.refuse(path, &format!("`{name}`"), problem);
        vec![]
    }
}

/// A box in a frame.
fn block(frame: Frame, size: [f64; 3], min_force_n: f64) -> Block {
    let size = size.map(|length| frame.scale * length);
    Block { centre: frame.origin.into(), rotation: frame.rotation, size, min_force_n }
}

/// A region of a frame in the world; none where a range of it would be turned.
fn moved(region: Region, frame: Frame) -> Option<Region> {
    let axes = [region.x, region.y, region.z];
    if region.is_point() {
        return Some(Region::point(frame.point(axes.map(|axis| axis.min)).into()));
    }
    let is_straight = (frame.rotation.matrix() - nalgebra::Matrix3::identity()).abs().max() < 1e-12;
    is_straight.then(|| {
        let along = |k: usize| {
            Range::new(frame.origin[k] + frame.scale * axes[k].min, frame.origin[k] + frame.scale * axes[k].max)
        };
        Region { x: along(0), y: along(1), z: along(2) }
    })
}

fn join(group: &str, name: &str) -> String {
    if group.is_empty() { name.to_owned() } else { format!("{group}.{name}") }
}

fn with_article(kind: &str) -> String {
    let article = if kind.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {kind}")
}

/// What is wrong with a name.
fn bad_name(name: &str) -> Option<String> {
    if name.is_empty() || name.chars().count() > 64 {
        return Some("must have from 1 to 64 characters".into());
    }
    let bad = name.chars().find(|c| c.is_control() || ".[]".contains(*c))?;
    Some(format!("has the character {bad:?}; leave it out"))
}
