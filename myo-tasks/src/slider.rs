//! Sliders, as they stand in a file and as they are written out.

use garde::Validate;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::flat::Block;
use crate::notation::{Place, two_on_one_line};
use crate::quantity::Quantity;
use crate::range::Range;
use crate::scene::{Frame, is_zero};
use crate::target::{FORCE, LENGTH, TILT, TURN};

const VALUE: Quantity = Quantity::between(-1e6, 1e6, "");

/// A handle on a way: touched where it is, it follows the fingertip along the way until the fingertip lets go.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct SliderItem {
    /// The middle of the way, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// How far the handle can be moved, in m.
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub length: f64,

    /// Length of the handle along the way, in m. Default 0.02.
    #[serde(default = "fingerwide")]
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub handle: f64,

    /// How wide the way and its handle are, in m. Default 0.02.
    #[serde(default = "fingerwide")]
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub width: f64,

    /// How thick it is, in m. Default 0.005.
    #[serde(default = "thin")]
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub depth: f64,

    /// Which way the value rises. Default `right`.
    #[serde(default)]
    #[garde(skip)]
    pub rises: Direction,

    /// Values at both ends of the way, the smaller one first. Default `[0, 1]`.
    #[serde(default = "whole", serialize_with = "two_on_one_line")]
    #[garde(custom(VALUE.ends_rule()))]
    #[schemars(with = "[f64; 2]")]
    pub range: [f64; 2],

    /// Where the handle stands when an episode begins: a value, or `[min, max]`, drawn anew for every episode. Without it: at
    /// the smaller end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(inner(custom(VALUE.range_rule())))]
    #[schemars(transform = VALUE.schema())]
    pub value: Option<Range>,

    /// Where it looks, in degrees: 0 up, like a table; 90 towards the user, like a wall. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,

    /// Contact force that takes hold of the handle, in N. From 0.01 to 1000; 0.2, the default, is less than a touch that is felt.
    #[serde(default = "slight_touch")]
    #[garde(custom(FORCE.rule()))]
    #[schemars(transform = FORCE.schema())]
    pub min_force_n: f64,
}

/// Which way the value of a slider rises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Across the face, to the user's right.
    #[default]
    Right,
    /// Up the face.
    Up,
}

/// A slider written out.
#[derive(Clone, Debug, PartialEq)]
pub struct Slider {
    /// All that can be touched: the way, and half a handle beyond both of its ends.
    pub block: Block,
    /// Which way the value rises.
    pub rises: Direction,
    /// How far the handle can be moved (m).
    pub length: f64,
    /// Length of the handle (m).
    pub handle: f64,
    /// Values at both ends.
    pub range: [f64; 2],
    /// Where the handle stands when an episode begins, as a share of the way.
    pub start: Range,
}

impl Direction {
    /// The unit vector along own axes: x up the face, y across it to the left.
    pub(crate) fn own_axis(self) -> Vector3<f64> {
        match self {
            Self::Right => -Vector3::y(),
            Self::Up => Vector3::x(),
        }
    }
}

impl SliderItem {
    /// Written out in the frame that it stands in the middle of.
    ///
    /// # Errors
    /// The field that is wrong, and what is wrong with it.
    pub(crate) fn placed(&self, frame: Frame) -> Result<Slider, (&'static str, String)> {
        let (along, across) = (self.length + self.handle, self.width);
        let size = match self.rises {
            Direction::Right => [along, across, self.depth],
            Direction::Up => [across, along, self.depth],
        };
        let [least, most] = self.range;
        let value = self.value.unwrap_or(Range::fixed(least));
        if value.min < least || value.max > most {
            let wrong = if value.min < least { value.min } else { value.max };
            return Err(("value", format!("is {wrong}; its `range` goes from {least} to {most}")));
        }
        Ok(Slider {
            block: Block::in_frame(frame, size, self.min_force_n),
            rises: self.rises,
            length: frame.scale * self.length,
            handle: frame.scale * self.handle,
            range: self.range,
            start: Range::new((value.min - least) / (most - least), (value.max - least) / (most - least)),
        })
    }
}

impl Slider {
    /// Unit vector along the way, to where the value rises, in world axes.
    pub fn along(&self) -> [f64; 3] {
        (self.block.rotation * self.rises.own_axis()).into()
    }

    /// A value as a share of the way.
    pub fn share(&self, value: f64) -> f64 {
        let [least, most] = self.range;
        (value - least) / (most - least)
    }

    /// The value at a share of the way.
    pub fn value(&self, share: f64) -> f64 {
        let [least, most] = self.range;
        least + share * (most - least)
    }

    /// Middle of the handle (m from the shoulder centre) where it stands at this share of the way.
    pub fn handle_at(&self, share: f64) -> [f64; 3] {
        let (along, from_middle) = (self.along(), (share - 0.5) * self.length);
        [0, 1, 2].map(|k| self.block.centre[k] + along[k] * from_middle)
    }
}

fn fingerwide() -> f64 {
    0.02
}

fn thin() -> f64 {
    0.005
}

fn whole() -> [f64; 2] {
    [0.0, 1.0]
}

fn slight_touch() -> f64 {
    0.2
}
