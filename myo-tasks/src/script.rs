//! The script of a task as it stands in a file: what is to do with which objects, one after the other.

use schemars::JsonSchema;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_saphyr::FlowSeq;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use crate::notation::Name;
use crate::range::Range;

/// Something to do. Where it names a group, it means each object of it in turn.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Instruction {
    /// Stay in spheres: `dwell: {in: slot, for_s: 0.3}`.
    Dwell(Dwell),
    /// Bring another finger to the fingertip while what points is in spheres: `pinch: {in: item}`.
    Pinch(Pinch),
    /// Press buttons: `press: [1, 3, 3, 5]`. A button is done as soon as it is pressed hard enough; one that is pressed twice
    /// in a row must be let go in between.
    Press(Names),
    /// Press a button with each of these fingers, all at the same time: `press_with: {fingertip: c, thumb: e}`. It is done once all are down;
    /// each must be lifted before it can press again.
    PressWith(BTreeMap<String, Name>),
    /// Press buttons and let go of them: `press_and_release: [1, 3, 3, 5]`. A button is done when it is let go.
    PressAndRelease(Names),
    /// Drag the handle of a slider to a value and let go of it there: `drag: {slider: volume, to: 70, within: 2}`.
    Drag(Drag),
    /// Swing a stick to an angle and leave its knob there: `swing: {stick: lever, to_deg: 30, within_deg: 3}`.
    Swing(Swing),
    /// Drive a sphere with a stick into another sphere, and stop it there: `drive: {stick: lever, vehicle: car, into: garage}`.
    Drive(Drive),
    /// Stay with moving spheres for a time: `follow: {target: ball, for_s: 3}`.
    Follow(Follow),
    /// Keep to moving spheres as well as one can for a time: `track: {target: ball, for_s: 10}`.
    Track(Track),
    /// Go from sphere to sphere without leaving a way of some width, as through a menu or a tunnel: `steer: {through: [a, b, c],
    /// width: 0.03}`.
    Steer(Steer),
    /// Wait for one of several objects to light up, and press it or dwell in it: `react: {among: lamps, after_s: [0.5, 1.5]}`.
    React(React),
    /// Wait before the next step, in s, a number or `[min, max]`, drawn anew every time: `wait: 0.5`. What comes next can be seen,
    /// and does not count before the time is over.
    Wait(Range),
    /// Press the keys of a keyboard: `type: hello`, or `type: {text: hello, on: keyboard}`.
    Type(Typing),
    /// Steps in an order that each episode draws: `random_order: [{press: [1, 2, 3]}]`.
    RandomOrder(Vec<Instruction>),
    /// Steps in any order that the user takes: `any_order: [{press: [1, 2, 3]}]`. What is nearest to the pointer counts as
    /// the current step.
    AnyOrder(Vec<Instruction>),
    /// The same steps again: `repeat: {times: 3, steps: [...]}`.
    Repeat(Repeat),
}

/// Spheres to stay in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dwell {
    /// Names of the spheres, or of groups of them, in the order in which to stay in them.
    #[serde(rename = "in")]
    pub within: Names,
    /// How long in each without a break, in s, from 0 to 600; to the physics step, at least one.
    pub for_s: f64,
    /// The finger that must be inside, by the name that the body's model has for it. Without it: the fingertip, or what points in its place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub with: Option<String>,
    /// Spheres in which other fingers must be at the same time, by the names that the body's model has for them: `{thumb: left}`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub also: BTreeMap<String, Name>,
}

/// Spheres in which to pinch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pinch {
    /// Names of the spheres, or of groups of them, in the order in which to pinch in them. What points must be inside as fingers close: a ray
    /// pinches from afar.
    #[serde(rename = "in")]
    pub within: Names,
    /// The finger that comes to the fingertip, by the name that the body's model has for it. Default `thumb`.
    #[serde(default = "thumb")]
    pub with: String,
    /// How long both stay together in each, in s, from 0 to 600; to the physics step, at least one. Default 0.
    #[serde(default)]
    pub for_s: f64,
    /// How near tips are together, in m, from 0.001 to 0.2. Default 0.02.
    #[serde(default = "together")]
    pub closer_than: f64,
    /// How far they must have been apart before, in m, from `closer_than` to 0.4. Default 0.035.
    #[serde(default = "apart")]
    pub apart: f64,
}

/// A slider to be moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// Name of the slider whose handle is dragged.
    pub slider: Name,
    /// The value at which to let go of the handle, in the range of the slider.
    pub to: f64,
    /// How far off the value may be when the handle is let go, in the same unit.
    pub within: f64,
}

/// A stick to be swung.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Swing {
    /// Name of the stick whose knob is swung.
    pub stick: Name,
    /// The angle at which to leave the knob, in degrees, in the range of the stick.
    pub to_deg: f64,
    /// How far off the angle may be when the knob is left, in degrees.
    pub within_deg: f64,
}

/// Something to be driven with a stick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Name of the stick whose knob is held and moved.
    pub stick: Name,
    /// Name of the sphere that it drives, whose motion (`moves`) is `driven`.
    pub vehicle: Name,
    /// Name of the sphere in which the middle of the vehicle must come to a stop.
    pub into: Name,
    /// How slow it must be there, in m/s, from 0.001 to 10. Default 0.05.
    #[serde(default = "nearly_still")]
    pub slower_than: f64,
}

/// Moving spheres to stay with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Follow {
    /// Names of the spheres that move, or of groups of them, in the order in which to follow them.
    pub target: Names,
    /// How long inside each, in s, from 0 to 600: all the time inside is added up, to the physics step, at least one.
    pub for_s: f64,
}

/// Moving spheres to keep to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// Names of the spheres that move, or of groups of them, in the order in which to track them.
    pub target: Names,
    /// How long to keep to each, in s, from 0 to 600; to the physics step, at least one. It is done when the time is over, and every second inside brings
    /// `reward.subtask_bonus`; how much of it was inside (`on_target`) and how far off (`tracking_error`) tells how well.
    pub for_s: f64,
}

/// A way along spheres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Steer {
    /// The spheres, two or more: the way begins in the first, goes straight from each to the next, and ends in the last.
    pub through: Names,
    /// How wide it is, in m, from 0.002 to 4. Whoever leaves it must come back to where it was left; how often it was left is
    /// counted (`exits`), and costs what `reward.exit` says.
    pub width: f64,
}

/// Objects of which one lights up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct React {
    /// Names of the buttons, or of the spheres, of which one lights up; each as often as the others.
    pub among: Names,
    /// After what time one lights up, in s, a number or `[min, max]`, drawn anew every time.
    pub after_s: Range,
    /// Of spheres: how long to stay inside, in s. Buttons are pressed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub for_s: Option<f64>,
}

/// A text to be typed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Typing {
    /// The text: each letter is the name of a key, a blank is `space`. Capital letters are typed as small ones.
    pub text: String,
    /// On which keyboard or group. Without it: on the only keyboard there is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
}

/// Steps that are done several times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// How often the steps are done, 1 to 256.
    #[schemars(range(min = 1, max = 256))]
    pub times: u32,
    /// What is done every time, in this order.
    pub steps: Vec<Instruction>,
}

/// One or several names, in a file `slot`, `3` or `[1, 3, 3, 5]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names(pub Vec<Name>);

impl Dwell {
    /// To stay in spheres, whatever other fingers do.
    pub const fn new(within: Names, for_s: f64) -> Self {
        Self { within, for_s, with: None, also: BTreeMap::new() }
    }
}

fn thumb() -> String {
    "thumb".to_owned()
}

fn together() -> f64 {
    0.02
}

fn apart() -> f64 {
    0.035
}

fn nearly_still() -> f64 {
    0.05
}

impl Serialize for Names {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0[..] {
            [name] => name.serialize(serializer),
            names => FlowSeq(names).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Names {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NamesVisitor)
    }
}

struct NamesVisitor;

impl<'de> Visitor<'de> for NamesVisitor {
    type Value = Names;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name or a list of names")
    }

    fn visit_str<E>(self, name: &str) -> Result<Names, E> {
        Ok(Names(vec![Name(name.to_owned())]))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Names, E> {
        Ok(Names(vec![Name(number.to_string())]))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Names, E> {
        Ok(Names(vec![Name(number.to_string())]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Names, A::Error> {
        let mut names = vec![];
        while let Some(name) = list.next_element()? {
            names.push(name);
        }
        Ok(Names(names))
    }
}

impl JsonSchema for Names {
    fn schema_name() -> Cow<'static, str> {
        "Names".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let name = generator.subschema_for::<Name>();
        schemars::json_schema!({ "anyOf": [name, { "type": "array", "items": name }] })
    }
}

impl<'de> Deserialize<'de> for Typing {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TypingVisitor)
    }
}

struct TypingVisitor;

/// The long form.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Text")]
struct TextOn {
    /// Each letter is the name of a key, a blank is `space`. Capital letters are typed as small ones.
    text: String,
    /// On which keyboard or group. Without it: on the only keyboard there is.
    #[serde(default)]
    on: Option<String>,
}

impl JsonSchema for Typing {
    fn schema_name() -> Cow<'static, str> {
        "Typing".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let long = generator.subschema_for::<TextOn>();
        schemars::json_schema!({ "anyOf": [{ "type": "string" }, long] })
    }
}

impl<'de> Visitor<'de> for TypingVisitor {
    type Value = Typing;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a text, or `text` and `on`")
    }

    fn visit_str<E>(self, text: &str) -> Result<Typing, E> {
        Ok(Typing { text: text.to_owned(), on: None })
    }

    fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<Typing, A::Error> {
        let TextOn { text, on } = TextOn::deserialize(serde::de::value::MapAccessDeserializer::new(map))?;
        Ok(Typing { text, on })
    }
}
