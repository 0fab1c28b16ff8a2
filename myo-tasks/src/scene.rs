//! The scene of a task as it stands in a file: named objects, alone or in groups, and generators that write many of them.

use garde::Validate;
use indexmap::IndexMap;
use nalgebra::{Rotation3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::flat::Shift;
use crate::motion::Motion;
use crate::notation::{Name, Pitch, Place};
use crate::quantity::Quantity;
use crate::range::Range;
use crate::slider::SliderItem;
use crate::stick::StickItem;
use crate::target::{DISTANCE, FORCE, LENGTH, Region, TILT, TURN, on_one_line};

const SCALE: Quantity = Quantity::between(0.01, 100.0, "");
/// Most rows, columns or copies that a generator may be asked for; what they make is bounded once more.
const MANY: u32 = 256;

/// Named objects in the order of the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Scene(pub IndexMap<String, Item>);

/// One or several objects. Places are in m from the shoulder centre (x forward, y to the left, z up), or, in a group, along
/// the group's own axes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Item {
    /// A sphere in the air, or several alike.
    Sphere(SphereItem),
    /// A box that can be pressed.
    Button(ButtonItem),
    /// A handle that is dragged along a way.
    Slider(SliderItem),
    /// A stick on a hinge, whose knob is swung.
    Stick(StickItem),
    /// A box that only stands in the way: a table, the edge of a display.
    Obstacle(ObstacleItem),
    /// Objects that are moved, turned and scaled as one.
    Group(Group),
    /// Rows and columns of one object.
    Grid(Grid),
    /// One object again and again on a part of a circle.
    Arc(Arc),
    /// One object again and again on a circle, numbered across it (ISO 9241-9).
    Circle(Circle),
    /// The keys of a keyboard.
    Keyboard(Keyboard),
}

/// A sphere in the air. It has no surface to touch: the fingertip moves into it freely.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct SphereItem {
    /// Where the centre may lie, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// Radius in m, a number or `[min, max]`; drawn anew for every episode. From 0.001 to 2.
    #[garde(custom(LENGTH.range_rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub radius: Range,

    /// So many spheres like this, each drawn for itself: with `copies: 3`, `ball` becomes `ball.1`, `ball.2` and `ball.3`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(inner(custom(many)))]
    #[schemars(range(min = 1, max = 256))]
    pub copies: Option<u32>,

    /// How it moves about its place. Without it: not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(dive)]
    pub moves: Option<Motion>,

    /// Least distance in m between this centre and that of the object before it in the scene, obstacles aside; positions are
    /// redrawn until it holds; that of a stick is its hinge. Without it: twice the greatest radius. 0 switches the rule off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(inner(custom(DISTANCE.rule())))]
    #[schemars(transform = DISTANCE.schema())]
    pub min_distance_from_previous: Option<f64>,
}

/// A box that can be pressed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct ButtonItem {
    /// Centre of the box, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// Full sizes `[width, height, depth]` in m: of the upright face, width is the horizontal and height the vertical
    /// extent; depth is how thick the button is. Each a number or `[min, max]`, drawn anew for every episode, from 0.001 to 2.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(LENGTH.range_rule())))]
    #[schemars(transform = LENGTH.schema())]
    pub size: [Range; 3],

    /// Where the face looks, in degrees: 0 up, like a key on a table; 90 towards the user, like a wall. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,

    /// Contact force that counts as pressed, in N. From 0.01 to 1000; 1, the default, is a light touch.
    #[serde(default = "light_touch")]
    #[garde(custom(FORCE.rule()))]
    #[schemars(transform = FORCE.schema())]
    pub min_force_n: f64,
}

/// A box that only stands in the way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct ObstacleItem {
    /// Centre of the box, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// Full sizes `[width, height, depth]` in m, each a number or `[min, max]`, as of a button.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(LENGTH.range_rule())))]
    #[schemars(transform = LENGTH.schema())]
    pub size: [Range; 3],

    /// Where its face looks, as of a button. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, as of a button. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,
}

/// Objects that are moved, turned and scaled as one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Group {
    /// Where its origin lies, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode, and all that
    /// belongs to it moves along. Default: at the origin of what is around it.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// How it is tilted, in degrees: at 0 its own axes are those around it; at 90 its x points up, and its z to the user.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,

    /// Factor for all lengths in it. Default 1.
    #[serde(default = "unit", skip_serializing_if = "is_unit")]
    #[garde(custom(SCALE.rule()))]
    #[schemars(transform = SCALE.schema())]
    pub scale: f64,

    /// What belongs to it.
    #[garde(dive)]
    pub objects: Scene,
}

/// Rows and columns of one object: named from the upper left, row by row. Rows run along own x, downwards; columns along
/// own y, to the right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// Its middle, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// How it is tilted, in degrees: 0 lies like a table, 90 stands like a wall before the user.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,

    /// How many rows.
    #[garde(custom(how_many))]
    #[schemars(range(min = 1, max = 256))]
    pub rows: u32,

    /// How many columns.
    #[garde(custom(how_many))]
    #[schemars(range(min = 1, max = 256))]
    pub columns: u32,

    /// Distance from one middle to the next, in m; of rows and columns alike, or `[across, down]`.
    #[garde(dive)]
    pub pitch: Pitch,

    /// What each is called, row by row. Without it: 1, 2, 3 and so on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[garde(skip)]
    pub names: Vec<Name>,

    /// What stands at each place; its own `at` is added.
    #[garde(dive)]
    pub of: Box<Item>,
}

/// One object again and again on a part of a circle, from left to right: what a thumb or a forearm sweeps over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Arc {
    /// Middle of the circle, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// How it is tilted, in degrees: 0 lies like a table, 90 stands like a wall before the user.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,

    /// How many objects.
    #[garde(custom(how_many))]
    #[schemars(range(min = 1, max = 256))]
    pub count: u32,

    /// From the middle of the circle to theirs, in m.
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub radius: f64,

    /// Where the first stands, in degrees: 0 up the face (of a table: straight ahead), 90 to the right. Default -45.
    #[serde(default = "left")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub from_deg: f64,

    /// Where the last stands, in degrees. Default 45.
    #[serde(default = "right")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub to_deg: f64,

    /// What each is called, from the first to the last. Without it: 1, 2, 3 and so on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[garde(skip)]
    pub names: Vec<Name>,

    /// What stands at each place; its own `at` is added.
    #[garde(dive)]
    pub of: Box<Item>,
}

/// One object again and again on a circle, numbered so that each is across the circle from the one before (ISO 9241-9).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Its middle, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// How it is tilted, in degrees: 0 lies like a table, 90 stands like a wall before the user.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,

    /// How many objects; an odd number, so that every way is as long as the others.
    #[garde(custom(odd))]
    #[schemars(range(min = 3, max = 255))]
    pub count: u32,

    /// Diameter of the circle through their middles, in m.
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub diameter: f64,

    /// What stands at each place; its own `at` is added.
    #[garde(dive)]
    pub of: Box<Item>,
}

/// The keys of a keyboard: buttons named by their letters, and `space`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Keyboard {
    /// Its middle, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// How it is tilted, in degrees: 0 lies like a table, 90 stands like a wall before the user.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,

    /// Which letters stand where. Default `qwerty`.
    #[serde(default)]
    #[garde(skip)]
    pub layout: Letters,

    /// Distance from the middle of one key to that of the next, in m.
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub pitch: f64,

    /// Width and height of a key, in m, a number or `[min, max]`, drawn for all keys anew for every episode; the space bar is four
    /// pitches and a key wide.
    #[garde(custom(LENGTH.range_rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub key: Range,

    /// How thick keys are, in m. Default 0.005.
    #[serde(default = "key_depth")]
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub depth: f64,

    /// Contact force that counts as pressed, in N. From 0.01 to 1000; 1, the default, is a light touch.
    #[serde(default = "light_touch")]
    #[garde(custom(FORCE.rule()))]
    #[schemars(transform = FORCE.schema())]
    pub min_force_n: f64,
}

/// Which letters stand where on a keyboard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Letters {
    /// The letters of English, the space bar below.
    #[default]
    Qwerty,
}

/// Where the frame of an item stands in the one around it.
pub(crate) struct Placement {
    pub(crate) at: Place,
    pub(crate) tilt_deg: f64,
    pub(crate) turn_deg: f64,
    pub(crate) scale: f64,
}

/// A place and directions that objects are given in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) origin: Vector3<f64>,
    pub(crate) rotation: Rotation3<f64>,
    pub(crate) scale: f64,
    /// How far each episode draws it off this place.
    pub(crate) shift: Option<Shift>,
}

impl Letters {
    /// Keys row by row, each row with how far it is moved to the right, in keys.
    pub(crate) const fn rows(self) -> [(&'static str, f64); 3] {
        match self {
            Self::Qwerty => [("qwertyuiop", 0.0), ("asdfghjkl", 0.5), ("zxcvbnm", 1.5)],
        }
    }

    /// Keys of the longest row.
    pub(crate) const fn columns(self) -> f64 {
        match self {
            Self::Qwerty => 10.0,
        }
    }
}

impl Frame {
    /// The world's.
    pub(crate) fn world() -> Self {
        Self { origin: Vector3::zeros(), rotation: Rotation3::identity(), scale: 1.0, shift: None }
    }

    /// What is placed, tilted and turned in this frame.
    pub(crate) fn child(&self, at: [f64; 3], tilt_deg: f64, turn_deg: f64, scale: f64) -> Self {
        Self {
            origin: self.point(at),
            rotation: self.rotation * tilted_and_turned(tilt_deg, turn_deg),
            scale: self.scale * scale,
            shift: self.shift,
        }
    }

    /// What is drawn of a range of places in this frame, as draw `number` of an episode.
    pub(crate) fn shifted(&self, region: Region, number: usize) -> Shift {
        let widths = [region.x, region.y, region.z].map(Range::width);
        let span = |axis: usize| {
            let mut way = [0.0; 3];
            way[axis] = widths[axis];
            (self.rotation * (self.scale * Vector3::from(way))).into()
        };
        Shift { number, spans: [0, 1, 2].map(span) }
    }

    /// A point in the world.
    pub(crate) fn point(&self, at: [f64; 3]) -> Vector3<f64> {
        self.origin + self.rotation * (self.scale * Vector3::from(at))
    }
}

impl Item {
    /// Where its frame stands. A sphere has no directions and stays in the one around it.
    pub(crate) fn placement(&self) -> Placement {
        let (at, tilt_deg, turn_deg, scale) = match self {
            Self::Sphere(_) => (Place::default(), 0.0, 0.0, 1.0),
            Self::Button(item) => (item.at, item.tilt_deg, item.turn_deg, 1.0),
            Self::Slider(item) => (item.at, item.tilt_deg, item.turn_deg, 1.0),
            Self::Stick(item) => (item.at, item.tilt_deg, item.turn_deg, 1.0),
            Self::Obstacle(item) => (item.at, item.tilt_deg, item.turn_deg, 1.0),
            Self::Group(item) => (item.at, item.tilt_deg, item.turn_deg, item.scale),
            Self::Grid(item) => (item.at, item.tilt_deg, item.turn_deg, 1.0),
            Self::Arc(item) => (item.at, item.tilt_deg, item.turn_deg, 1.0),
            Self::Circle(item) => (item.at, item.tilt_deg, item.turn_deg, 1.0),
            Self::Keyboard(item) => (item.at, item.tilt_deg, item.turn_deg, 1.0),
        };
        Placement { at, tilt_deg, turn_deg, scale }
    }
}

/// From the axes of what is tilted and turned to those around it: `Rz(turn) Ry(-tilt)`, so that own z, the normal of a face, is
/// up at 0 degrees of tilt and points to the user, `-x`, at 90.
pub(crate) fn tilted_and_turned(tilt_deg: f64, turn_deg: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), turn_deg.to_radians())
        * Rotation3::from_axis_angle(&Vector3::y_axis(), -tilt_deg.to_radians())
}

impl Scene {
    /// Whether nothing stands there.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// By hand, so that paths are those of the file.
impl Validate for Scene {
    type Context = ();

    fn validate_into(&self, ctx: &(), mut parent: &mut dyn FnMut() -> garde::Path, report: &mut garde::Report) {
        for (name, item) in &self.0 {
            let mut path = garde::util::nested_path!(parent, name);
            item.validate_into(ctx, &mut path, report);
        }
    }
}

/// By hand: the derived form would put the variant's index into the path, where the file has nothing.
impl Validate for Item {
    type Context = ();

    fn validate_into(&self, ctx: &(), parent: &mut dyn FnMut() -> garde::Path, report: &mut garde::Report) {
        match self {
            Self::Sphere(item) => item.validate_into(ctx, parent, report),
            Self::Button(item) => item.validate_into(ctx, parent, report),
            Self::Slider(item) => item.validate_into(ctx, parent, report),
            Self::Stick(item) => item.validate_into(ctx, parent, report),
            Self::Obstacle(item) => item.validate_into(ctx, parent, report),
            Self::Group(item) => item.validate_into(ctx, parent, report),
            Self::Grid(item) => item.validate_into(ctx, parent, report),
            Self::Arc(item) => item.validate_into(ctx, parent, report),
            Self::Circle(item) => item.validate_into(ctx, parent, report),
            Self::Keyboard(item) => item.validate_into(ctx, parent, report),
        }
    }
}

fn how_many(count: &u32, (): &()) -> garde::Result {
    match *count {
        1..=MANY => Ok(()),
        other => Err(garde::Error::new(format!("is {other}; it must be from 1 to {MANY}"))),
    }
}

fn many(copies: &u32, (): &()) -> garde::Result {
    how_many(copies, &())
}

fn odd(number: &u32, (): &()) -> garde::Result {
    match *number {
        3..=255 if number % 2 == 1 => Ok(()),
        other => Err(garde::Error::new(format!(
            "is {other}; it must be an odd number from 3 to 255, so that every way across the circle is as long as the others"
        ))),
    }
}

fn light_touch() -> f64 {
    1.0
}

fn key_depth() -> f64 {
    0.005
}

fn left() -> f64 {
    -45.0
}

fn right() -> f64 {
    45.0
}

fn unit() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature serde asks for")]
fn is_unit(scale: &f64) -> bool {
    *scale == 1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature serde asks for")]
pub(crate) fn is_zero(value: &f64) -> bool {
    *value == 0.0
}
