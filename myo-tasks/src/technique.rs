//! The technique: what of the body points, and how its pointer comes from it.

use std::fmt;

use garde::Validate;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::quantity::Quantity;
use crate::scene::is_zero;
use crate::tagged::TechniqueMap;
use crate::target::{COORDINATE, DISTANCE, TILT, TURN, on_one_line};

const GAIN: Quantity = Quantity::between(0.01, 100.0, "");
const RATE: Quantity = Quantity::between(0.01, 100.0, "1/s");
const GROWTH: Quantity = Quantity::between(0.0, 100.0, "1/m");

/// What points: every step of the script goes by one pointer, which the technique makes of the body's posture. Only
/// fingers can press and drag.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[schemars(transform = or_a_word)]
pub enum Technique {
    /// The fingertip itself.
    #[default]
    Fingertip,
    /// A ray from the forearm or the hand, like that of a laser pointer.
    Ray(Ray),
    /// A hand that reaches farther the farther the arm is stretched (Go-Go; Poupyrev et al. 1996, doi 10.1145/237091.237102).
    GoGo(GoGo),
    /// A cursor on a display, moved by the fingertip.
    Cursor(Cursor),
    /// A cursor on a display that moves as long as the fingertip is off its place of rest, like that of a joystick.
    RateCursor(RateCursor),
}

/// A ray. Its pointer is where it meets a display, or, without one, its point that is nearest to the current object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Ray {
    /// What it follows: `forearm`, from the elbow through the wrist, or `hand`, from the wrist through the fingertip.
    #[garde(skip)]
    pub from: RayFrom,

    /// Name of the object whose face it meets. Without it the ray goes through space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(skip)]
    pub onto: Option<String>,
}

/// What a ray follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RayFrom {
    /// From the elbow through the wrist, where it begins.
    Forearm,
    /// From the wrist through the fingertip, where it begins.
    Hand,
}

/// The pointer is on the line from the shoulder centre through the fingertip: where the fingertip is up to a distance, and
/// beyond it farther by `gain` times the square of what the distance exceeds it by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct GoGo {
    /// Distance in m of the fingertip from the shoulder centre up to which the pointer is the fingertip. Default 0.4: two thirds
    /// of an arm's length, as published.
    #[serde(default = "two_thirds")]
    #[garde(custom(DISTANCE.rule()))]
    #[schemars(transform = DISTANCE.schema())]
    pub beyond: f64,

    /// How fast it goes away beyond it, in 1/m. Default 16.7: the published 1/6 per cm.
    #[serde(default = "sixth_per_cm")]
    #[garde(custom(GROWTH.rule()))]
    #[schemars(transform = GROWTH.schema())]
    pub gain: f64,
}

/// The pointer is on the face of a display, off its middle by `gain` times what the fingertip is off a place of rest, along
/// the directions of a plane in which the hand works.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Cursor {
    /// Name of the object on whose face it moves.
    #[garde(skip)]
    pub onto: String,

    /// Where the fingertip is when the cursor is in the middle, `[x, y, z]` in m.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(COORDINATE.rule())))]
    #[schemars(transform = COORDINATE.schema())]
    pub at: [f64; 3],

    /// How many metres the cursor moves for a metre of the fingertip (control-display gain). From 0.01 to 100.
    #[garde(custom(GAIN.rule()))]
    #[schemars(transform = GAIN.schema())]
    pub gain: f64,

    /// How the plane of the hand is tilted, in degrees: 0, the default, lies like a table, on which forward is up on the display;
    /// 90 stands like a wall.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// The plane of the hand turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,
}

/// The pointer is on the face of a display, and moves over it as fast as the fingertip is far off a place of rest, along the
/// directions of a plane in which the hand works. It begins every episode in the middle and stays on the face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct RateCursor {
    /// Name of the object on whose face it moves.
    #[garde(skip)]
    pub onto: String,

    /// Where the fingertip rests, `[x, y, z]` in m.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(COORDINATE.rule())))]
    #[schemars(transform = COORDINATE.schema())]
    pub at: [f64; 3],

    /// How fast the cursor moves, in m/s for each metre that the fingertip is farther off its rest than `still`. From 0.01 to 100.
    #[garde(custom(RATE.rule()))]
    #[schemars(transform = RATE.schema())]
    pub gain: f64,

    /// How far off its rest, in m, the fingertip moves nothing. Default 0.01.
    #[serde(default = "fingerwidth")]
    #[garde(custom(DISTANCE.rule()))]
    #[schemars(transform = DISTANCE.schema())]
    pub still: f64,

    /// How the plane of the hand is tilted, in degrees, as of a cursor. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// The plane of the hand turned about the vertical, in degrees, as of a cursor. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,
}

impl Technique {
    /// Whether it is the fingertip itself.
    pub const fn is_fingertip(&self) -> bool {
        matches!(self, Self::Fingertip)
    }

    /// The word for it, with its article.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Fingertip => "the fingertip",
            Self::Ray(_) => "a ray",
            Self::GoGo(_) => "a Go-Go hand",
            Self::Cursor(_) => "a cursor",
            Self::RateCursor(_) => "a rate cursor",
        }
    }
}

/// By hand: the derived form would put the variant's index into the path, where the file has nothing.
impl Validate for Technique {
    type Context = ();

    fn validate_into(&self, ctx: &(), parent: &mut dyn FnMut() -> garde::Path, report: &mut garde::Report) {
        match self {
            Self::Fingertip => {}
            Self::Ray(ray) => ray.validate_into(ctx, parent, report),
            Self::GoGo(go_go) => go_go.validate_into(ctx, parent, report),
            Self::Cursor(cursor) => cursor.validate_into(ctx, parent, report),
            Self::RateCursor(cursor) => cursor.validate_into(ctx, parent, report),
        }
    }
}

/// `fingertip`, or keys and values, `kind` first.
impl<'de> Deserialize<'de> for Technique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TechniqueVisitor)
    }
}

struct TechniqueVisitor;

impl<'de> Visitor<'de> for TechniqueVisitor {
    type Value = Technique;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("`fingertip`, or keys and values, `kind` first")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Technique, E> {
        match word {
            "fingertip" => Ok(Technique::Fingertip),
            other => Err(E::unknown_variant(other, &["fingertip"])),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Technique, A::Error> {
        TechniqueMap::deserialize(MapAccessDeserializer::new(map)).map(Into::into)
    }
}

/// The fingertip has no numbers, so its name is enough.
fn or_a_word(schema: &mut schemars::Schema) {
    if let Some(forms) = schema.get_mut("oneOf").and_then(serde_json::Value::as_array_mut) {
        let word = serde_json::json!({ "const": "fingertip", "type": "string", "description": "The same in a word." });
        forms.insert(0, word);
    }
}

impl GoGo {
    /// With the published numbers.
    pub fn published() -> Self {
        Self { beyond: two_thirds(), gain: sixth_per_cm() }
    }
}

fn two_thirds() -> f64 {
    0.4
}

fn fingerwidth() -> f64 {
    0.01
}

fn sixth_per_cm() -> f64 {
    16.7
}
