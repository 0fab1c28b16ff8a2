//! The targets of tasks of version 1: object and step at once.

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use serde_saphyr::FlowSeq;

use crate::flat::Block;
use crate::quantity::Quantity;
use crate::range::Range;
use crate::scene::tilted_and_turned;

pub(crate) const COORDINATE: Quantity = Quantity::between(-2.0, 2.0, "m");
/// Nothing smaller than a millimetre can be hit.
pub(crate) const LENGTH: Quantity = Quantity::between(0.001, 2.0, "m");
pub(crate) const DISTANCE: Quantity = Quantity::between(0.0, 4.0, "m");
pub(crate) const DWELL: Quantity = Quantity::between(0.0, 600.0, "s");
pub(crate) const FORCE: Quantity = Quantity::between(0.01, 1000.0, "N");
pub(crate) const TILT: Quantity = Quantity::between(0.0, 180.0, "deg");
pub(crate) const TURN: Quantity = Quantity::between(-180.0, 180.0, "deg");

/// Most targets that one task may have, repetitions counted.
pub const TARGETS_MAX: usize = 10;

/// One step of a task: something to point at or something to press.
///
/// Coordinates are metres relative to the shoulder centre: x forward, y to the left, z up.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Target {
    /// Bring the fingertip into a sphere and stay there for a while.
    Pointing(Pointing),
    /// Press a box with the fingertip.
    Pressing(Pressing),
}

/// A sphere in the air. It has no surface to touch: the fingertip moves into it freely.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Pointing {
    /// Where the centre may lie; it is drawn anew for every episode.
    #[garde(dive)]
    pub position: Region,

    /// Radius in m, a number or `[min, max]`; drawn anew for every episode. From 0.001 to 2.
    #[garde(custom(LENGTH.range_rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub radius: Range,

    /// How long the fingertip must stay inside without a break, in s; to the physics step, at least one.
    #[garde(custom(DWELL.rule()))]
    #[schemars(transform = DWELL.schema())]
    pub dwell_s: f64,

    /// Least distance in m between this centre and the centre of the target before it; positions are redrawn until it holds.
    /// Without it: twice the greatest radius of this target. It has no effect on the first target; 0 switches the rule off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(inner(custom(DISTANCE.rule())))]
    #[schemars(transform = DISTANCE.schema())]
    pub min_distance_from_previous: Option<f64>,

    /// So many targets of this description in a row, 1 to 10; each is drawn for itself. Default 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    #[garde(custom(repeat_rule))]
    #[schemars(range(min = 1, max = 10))]
    pub repeat: u32,
}

/// An axis-parallel box of positions, in m relative to the shoulder centre. Each axis is a number or `[min, max]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Forward, away from the chest, in m.
    #[garde(custom(COORDINATE.range_rule()))]
    #[schemars(transform = COORDINATE.schema())]
    pub x: Range,
    /// To the user's left, in m; negative is right of the right shoulder.
    #[garde(custom(COORDINATE.range_rule()))]
    #[schemars(transform = COORDINATE.schema())]
    pub y: Range,
    /// Up, in m.
    #[garde(custom(COORDINATE.range_rule()))]
    #[schemars(transform = COORDINATE.schema())]
    pub z: Range,
}

/// A button: a box fixed in space that the fingertip collides with. Done as soon as it is pressed hard enough.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Pressing {
    /// Centre of the box, `[x, y, z]` in m relative to the shoulder centre.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(COORDINATE.rule())))]
    #[schemars(transform = COORDINATE.schema())]
    pub position: [f64; 3],

    /// Full sizes `[width, height, depth]` in m: of the upright face, width is the horizontal and height the vertical
    /// extent; depth is how thick the button is. Each from 0.001 to 2.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(LENGTH.rule())))]
    #[schemars(transform = LENGTH.schema())]
    pub size: [f64; 3],

    /// Where the face looks, in degrees: 0 up, like a key on a table; 90 towards the user, like a wall.
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Contact force that counts as pressed, in N. From 0.01 to 1000; 1 is a light touch.
    #[garde(custom(FORCE.rule()))]
    #[schemars(transform = FORCE.schema())]
    pub min_force_n: f64,
}

impl Target {
    /// The word of the file for this primitive: `pointing` or `pressing`.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Pointing(_) => "pointing",
            Self::Pressing(_) => "pressing",
        }
    }

    /// The name people read, counted from one: `target 3 (pressing)` for index 2.
    pub fn label(&self, index: usize) -> String {
        format!("target {} ({})", index + 1, self.kind())
    }

    /// Where the centre may lie; a single point for a button.
    pub fn region(&self) -> Region {
        match self {
            Self::Pointing(sphere) => sphere.position,
            Self::Pressing(button) => Region::point(button.position),
        }
    }

    /// How many targets it stands for.
    pub const fn repeat(&self) -> u32 {
        match self {
            Self::Pointing(sphere) => sphere.repeat,
            Self::Pressing(_) => 1,
        }
    }

    /// Least distance of the centre from the centre of the target before, in m. Buttons have none, they are fixed.
    pub fn min_distance(&self) -> Option<f64> {
        match self {
            Self::Pointing(sphere) => Some(sphere.min_distance()),
            Self::Pressing(_) => None,
        }
    }
}

impl Pointing {
    /// Least distance from the centre of the target before, in m, the default filled in.
    pub fn min_distance(&self) -> f64 {
        self.min_distance_from_previous.unwrap_or(2.0 * self.radius.max)
    }
}

impl Pressing {
    /// The box that it is.
    pub fn block(&self) -> Block {
        let rotation = tilted_and_turned(self.tilt_deg, 0.0);
        Block { centre: self.position, rotation, size: self.size, min_force_n: self.min_force_n }
    }
}

impl Region {
    /// A single point.
    pub const fn point([x, y, z]: [f64; 3]) -> Self {
        Self { x: Range::fixed(x), y: Range::fixed(y), z: Range::fixed(z) }
    }

    /// The point at shares `t` of the three intervals.
    pub fn at(&self, t: [f64; 3]) -> [f64; 3] {
        [self.x.at(t[0]), self.y.at(t[1]), self.z.at(t[2])]
    }

    /// The eight corners, some equal where an axis is fixed.
    pub fn corners(&self) -> [[f64; 3]; 8] {
        Self::corner_shares().map(|share| self.at(share))
    }

    /// The eight corners as shares of the intervals.
    pub(crate) fn corner_shares() -> [[f64; 3]; 8] {
        std::array::from_fn(|bits| [0, 1, 2].map(|axis| f64::from((bits >> axis) as u32 & 1)))
    }
}

/// By hand: the derived form would put the variant's index into the path, where the file has nothing.
impl Validate for Target {
    type Context = ();

    fn validate_into(&self, ctx: &(), parent: &mut dyn FnMut() -> garde::Path, report: &mut garde::Report) {
        match self {
            Self::Pointing(sphere) => sphere.validate_into(ctx, parent, report),
            Self::Pressing(button) => button.validate_into(ctx, parent, report),
        }
    }
}

fn one() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature serde asks for")]
fn is_one(repeat: &u32) -> bool {
    *repeat == 1
}

fn repeat_rule(repeat: &u32, (): &()) -> garde::Result {
    match *repeat {
        1..=10 => Ok(()),
        other => Err(garde::Error::new(format!("is {other}; it must be from 1 to {TARGETS_MAX}"))),
    }
}

pub(crate) fn on_one_line<T: Serialize, S: Serializer>(values: &[T; 3], serializer: S) -> Result<S::Ok, S::Error> {
    FlowSeq(values).serialize(serializer)
}
