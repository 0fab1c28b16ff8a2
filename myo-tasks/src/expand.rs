//! From the scene of a file to every object.

use std::collections::HashMap;
use std::f64::consts::TAU;

use crate::description::Task;
use crate::flat::{Block, Cue, FlatTask, Object, Shape, Shift, Sphere, of_targets};
use crate::motion::Motion;
use crate::notation::{Name, Place};
use crate::range::Range;
use crate::report::TaskError;
use crate::scene::{Arc, Circle, Frame, Grid, Group, Item, Keyboard, Placement, Scene, SphereItem};
use crate::target::Region;

/// Most objects of a scene.
pub const OBJECTS_MAX: usize = 256;
/// Most steps of a script.
pub const STEPS_MAX: usize = 256;
/// Most places and sizes of groups and boxes, and places of spheres along slanted axes, that are drawn: each is told from every other in one line of code.
const SHIFTS_MAX: usize = 16;
/// Groups within groups.
const DEPTH_MAX: usize = 16;

impl FlatTask {
    /// The objects of a task whose single values are right, and no steps.
    pub(crate) fn scenery_of(task: &Task) -> Result<Self, Vec<TaskError>> {
        if task.version == 1 {
            return Ok(Self { steps: vec![], ..of_targets(&task.targets) });
        }
        let mut builder = Builder::default();
        builder.scene(&task.scene, "", "scene", Frame::world(), 0);
        if !task.technique.is_fingertip() {
            let problem = format!("is {}, by which only steps of a script go; leave it out", task.technique.name());
            builder.refuse("technique", "the technique", problem);
        }
        if builder.errors.is_empty() { Ok(builder.flat) } else { Err(builder.errors) }
    }

    /// All objects and steps of a task whose single values are right.
    pub(crate) fn of(task: &Task) -> Result<Self, Vec<TaskError>> {
        if task.version == 1 {
            return Ok(of_targets(&task.targets));
        }
        let mut builder = Builder::default();
        builder.flat.stimulus = task.stimulus;
        builder.scene(&task.scene, "", "scene", Frame::world(), 0);
        if builder.errors.is_empty() {
            builder.whole_script(&task.script, &task.technique);
            builder.correction(task.correction.as_ref(), &task.technique);
        }
        if builder.errors.is_empty() {
            builder.technique(&task.technique);
        }
        if builder.errors.is_empty() { Ok(builder.flat) } else { Err(builder.errors) }
    }
}

/// A [`FlatTask`] in the making.
#[derive(Default)]
pub(crate) struct Builder {
    pub(crate) flat: FlatTask,
    /// Objects that each name stands for, groups included.
    pub(crate) named: HashMap<String, Vec<usize>>,
    /// Names of keyboards.
    pub(crate) keyboards: Vec<String>,
    /// What must be waited for before the next step.
    pub(crate) cue: Option<Cue>,
    /// Whether the steps that come change places with each other.
    pub(crate) is_ordered: bool,
    /// Places of groups and boxes, and sizes of boxes, that are drawn.
    shifts: usize,
    pub(crate) errors: Vec<TaskError>,
}

impl Builder {
    pub(crate) fn refuse(&mut self, path: &str, subject: &str, problem: String) {
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
        let first = self.flat.objects.len();
        if let Some(frame) = self.placed(item, name, path, frame) {
            self.in_its_frame(item, name, path, frame, depth);
        }
        let objects: Vec<usize> = (first..self.flat.objects.len()).collect();
        if self.named.insert(name.to_owned(), objects).is_some() {
            self.refuse(path, &format!("the name `{name}`"), "is that of another object; names must differ".into());
        }
    }

    /// The frame of an item; none, and an error, where it is drawn within what is drawn.
    fn placed(&mut self, item: &Item, name: &str, path: &str, around: Frame) -> Option<Frame> {
        let Placement { at: Place(region), tilt_deg, turn_deg, scale } = item.placement();
        let mut frame = around.child([region.x, region.y, region.z].map(Range::centre), tilt_deg, turn_deg, scale);
        if region.is_point() {
            return Some(frame);
        }
        let (path, subject) = (format!("{path}.at"), format!("the place of `{name}`"));
        if around.shift.is_some() {
            let problem = "is a range of places in a group whose place is drawn already; give single numbers";
            self.refuse(&path, &subject, problem.into());
            return None;
        }
        frame.shift = Some(around.shifted(region, self.draw(&path, &subject)?));
        Some(frame)
    }

    /// What is drawn of sizes; none where they are fixed.
    fn growth(&mut self, size: [Range; 3], name: &str, path: &str, field: &str, frame: Frame) -> Option<Shift> {
        let [width, height, depth] = size.map(|range| 0.5 * frame.scale * range.width());
        if width + height + depth == 0.0 {
            return None;
        }
        let number = self.draw(&format!("{path}.{field}"), &format!("the {field} of `{name}`"))?;
        Some(Shift { number, spans: [[height, 0.0, 0.0], [0.0, width, 0.0], [0.0, 0.0, depth]] })
    }

    /// Number of one more draw; none, and an error, where there are too many.
    fn draw(&mut self, path: &str, subject: &str) -> Option<usize> {
        if self.shifts == SHIFTS_MAX {
            let problem = format!(
                "is the {}th range of places of groups, of boxes and of spheres in tilted groups, and of sizes of boxes; at most {SHIFTS_MAX} are drawn",
                SHIFTS_MAX + 1
            );
            self.refuse(path, subject, problem);
            return None;
        }
        self.shifts += 1;
        Some(self.shifts - 1)
    }

    /// Adds an item that stands in the middle of a frame.
    fn in_its_frame(&mut self, item: &Item, name: &str, path: &str, frame: Frame, depth: usize) {
        match item {
            Item::Sphere(sphere) => self.spheres(sphere, name, path, frame),
            Item::Button(button) => {
                let block = Block::in_frame(frame, button.size.map(Range::centre), button.min_force_n);
                let growth = self.growth(button.size, name, path, "size", frame);
                self.push_sized(name, path, frame, Shape::Button(block), growth);
            }
            Item::Slider(slider) => self.push_if(slider.placed(frame).map(Shape::Slider), name, path, frame),
            Item::Stick(stick) => self.push_if(stick.placed(frame).map(Shape::Stick), name, path, frame),
            Item::Obstacle(obstacle) => {
                let block = Block::in_frame(frame, obstacle.size.map(Range::centre), f64::INFINITY);
                let growth = self.growth(obstacle.size, name, path, "size", frame);
                self.push_sized(name, path, frame, Shape::Obstacle(block), growth);
            }
            Item::Group(group) => self.group(group, name, path, frame, depth),
            Item::Grid(grid) => self.grid(grid, name, path, frame, depth),
            Item::Arc(arc) => self.arc(arc, name, path, frame, depth),
            Item::Circle(circle) => self.circle(circle, name, path, frame, depth),
            Item::Keyboard(keyboard) => self.keyboard(keyboard, name, path, frame),
        }
    }

    fn push(&mut self, name: &str, path: &str, frame: Frame, shape: Shape) {
        self.push_sized(name, path, frame, shape, None);
    }

    /// Adds an object whose sizes may be drawn.
    fn push_sized(&mut self, name: &str, path: &str, frame: Frame, shape: Shape, growth: Option<Shift>) {
        if self.flat.objects.len() == OBJECTS_MAX {
            // Said once: what comes after is too much as well.
            if !self.errors.iter().any(|error| error.path() == "scene") {
                let problem = format!("has more than {OBJECTS_MAX} objects, what generators write included");
                self.refuse("scene", "the scene", problem);
            }
            return;
        }
        let (name, path) = (name.to_owned(), path.to_owned());
        self.flat.objects.push(Object { name, path, shape, shift: frame.shift, growth });
    }

    /// Adds an object whose fields go together; else says which one does not, and why.
    fn push_if(&mut self, shape: Result<Shape, (&'static str, String)>, name: &str, path: &str, frame: Frame) {
        match shape {
            Ok(shape) => self.push(name, path, frame, shape),
            Err((field, problem)) => {
                self.refuse(&format!("{path}.{field}"), &format!("the {field} of `{name}`"), problem);
            }
        }
    }

    fn spheres(&mut self, item: &SphereItem, name: &str, path: &str, frame: Frame) {
        let straight = moved(item.at.0, frame);
        if straight.is_none() && (frame.shift.is_some() || item.min_distance_from_previous != Some(0.0)) {
            let problem = if frame.shift.is_some() {
                "is a range of places in a group that is tilted or turned and whose place is drawn; give single numbers"
            } else {
                "is a range of places in a group that is tilted or turned, in which no distance from the one before can be kept; \
                 write `min_distance_from_previous: 0`, or give single numbers"
            };
            return self.refuse(&format!("{path}.at"), &format!("the place of `{name}`"), problem.into());
        }
        let path_of = |motion: &Motion| motion.path(frame.rotation, frame.scale);
        let moves = item.moves.as_ref().and_then(path_of);
        if item.moves.is_some() && moves.is_none() {
            let problem = "has no length; write how far it goes, or leave `moves` out";
            return self.refuse(&format!("{path}.moves"), &format!("the way of `{name}`"), problem.into());
        }
        let radius = Range::new(frame.scale * item.radius.min, frame.scale * item.radius.max);
        let least = item.min_distance_from_previous.map_or(2.0 * radius.max, |least| frame.scale * least);
        for copy in 1..=item.copies.unwrap_or(1) {
            let is_solid = |object: &Object| !matches!(object.shape, Shape::Obstacle(_));
            let apart = self.flat.objects.iter().rposition(is_solid).map(|previous| (previous, least));
            let (region, frame) = match straight {
                Some(region) => (region, frame),
                None => match self.draw(&format!("{path}.at"), &format!("the place of `{name}`")) {
                    Some(number) => slanted(item.at.0, frame, number),
                    None => return,
                },
            };
            let shape = Shape::Sphere(Sphere { region, radius, apart, path: moves.clone() });
            match item.copies {
                None => self.push(name, path, frame, shape),
                Some(_) => self.child(&copy.to_string(), name, path, frame, shape, None),
            }
        }
    }

    /// Adds one object of several that have a name together.
    fn child(&mut self, own: &str, group: &str, path: &str, frame: Frame, shape: Shape, growth: Option<Shift>) {
        let name = join(group, own);
        let first = self.flat.objects.len();
        self.push_sized(&name, path, frame, shape, growth);
        let objects: Vec<usize> = (first..self.flat.objects.len()).collect();
        if self.named.insert(name.clone(), objects).is_some() {
            self.refuse(path, &format!("the name `{name}`"), "stands for two objects; names must differ".into());
        }
    }

    fn group(&mut self, group: &Group, name: &str, path: &str, frame: Frame, depth: usize) {
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
        let Some(own) = self.own_names(&grid.names, (grid.rows * grid.columns) as usize, name, path) else { return };
        let [across, down] = grid.pitch.pair();
        let middle = |count: u32| 0.5 * f64::from(count - 1);
        let places = (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |column| (row, column)));
        let places = places.map(|(row, column)| {
            [down * (middle(grid.rows) - f64::from(row)), across * (middle(grid.columns) - f64::from(column)), 0.0]
        });
        self.each_at(places, own, &grid.of, name, path, frame, depth);
    }

    fn arc(&mut self, arc: &Arc, name: &str, path: &str, frame: Frame, depth: usize) {
        let Some(own) = self.own_names(&arc.names, arc.count as usize, name, path) else { return };
        let steps = f64::from(arc.count.max(2) - 1);
        let places = (0..arc.count).map(|k| {
            let angle = (arc.from_deg + (arc.to_deg - arc.from_deg) * f64::from(k) / steps).to_radians();
            [arc.radius * angle.cos(), -arc.radius * angle.sin(), 0.0]
        });
        self.each_at(places, own, &arc.of, name, path, frame, depth);
    }

    /// What each of several objects is called: their names in the file, else their numbers from one on.
    fn own_names<'a>(
        &mut self,
        names: &'a [Name],
        count: usize,
        name: &str,
        path: &str,
    ) -> Option<impl Fn(usize) -> String + use<'a>> {
        if !names.is_empty() && names.len() != count {
            let problem = format!("are {} for {count} places", names.len());
            self.refuse(&format!("{path}.names"), &format!("the names of `{name}`"), problem);
            return None;
        }
        Some(|k: usize| names.get(k).map_or_else(|| (k + 1).to_string(), |name| name.0.clone()))
    }

    fn circle(&mut self, circle: &Circle, name: &str, path: &str, frame: Frame, depth: usize) {
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
        self.keyboards.push(name.to_owned());
        let rows = keyboard.layout.rows();
        let own = keyboard.key.centre();
        // All keys are drawn as one, as wide as high.
        let side = 0.5 * frame.scale * keyboard.key.width();
        let growth = if side == 0.0 {
            None
        } else {
            let draw = self.draw(&format!("{path}.key"), &format!("the key of `{name}`"));
            draw.map(|number| Shift { number, spans: [[side, side, 0.0], [0.0; 3], [0.0; 3]] })
        };
        let key = |place: [f64; 3], width: f64| {
            let size = [width, own, keyboard.depth];
            Shape::Button(Block::in_frame(frame.child(place, 0.0, 0.0, 1.0), size, keyboard.min_force_n))
        };
        // The space bar is one more row.
        let up = |row: usize| keyboard.pitch * (0.5 * rows.len() as f64 - row as f64);
        let left = |column: f64| keyboard.pitch * (0.5 * (keyboard.layout.columns() - 1.0) - column);
        for (row, (letters, indent)) in rows.into_iter().enumerate() {
            for (column, letter) in letters.chars().enumerate() {
                let shape = key([up(row), left(indent + column as f64), 0.0], own);
                self.child(&letter.to_string(), name, path, frame, shape, growth);
            }
        }
        let space = key([up(rows.len()), 0.0, 0.0], 4.0 * keyboard.pitch + own);
        self.child("space", name, path, frame, space, growth);
    }
}

/// A region of a turned frame in the world: the middle of it, and the frame that is drawn about it.
fn slanted(region: Region, frame: Frame, number: usize) -> (Region, Frame) {
    let middle = frame.point([region.x, region.y, region.z].map(Range::centre));
    (Region::point(middle.into()), Frame { shift: Some(frame.shifted(region, number)), ..frame })
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

pub(crate) fn join(group: &str, name: &str) -> String {
    if group.is_empty() { name.to_owned() } else { format!("{group}.{name}") }
}

pub(crate) fn with_article(kind: &str) -> String {
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
