//! Hinged sticks, as they stand in a file and as they are written out.

use garde::Validate;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::flat::Sphere;
use crate::logic::arm;
use crate::notation::{Place, two_on_one_line};
use crate::quantity::Quantity;
use crate::range::Range;
use crate::scene::{Frame, is_zero};
use crate::slider::Direction;
use crate::target::{LENGTH, Region, TILT, TURN};

const SPRING: Quantity = Quantity::between(0.01, 10.0, "s");
pub(crate) const ANGLE: Quantity = Quantity::between(-180.0, 180.0, "deg");

/// A stick on a hinge, such as a lever or a switch: its knob is taken hold of by pointing into it, follows the pointer on its circle,
/// and stays where the pointer leaves it. It has no surface to touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct StickItem {
    /// Where its hinge is, `[x, y, z]` in m, each a number or `[min, max]`; drawn anew for every episode.
    #[serde(default)]
    #[garde(dive)]
    pub at: Place,

    /// From the hinge to the middle of the knob, in m.
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub length: f64,

    /// Radius of the knob, in m; less than the length. Default 0.02.
    #[serde(default = "fistwide")]
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub knob: f64,

    /// Which way its angle rises. Default `right`.
    #[serde(default)]
    #[garde(skip)]
    pub swings: Direction,

    /// How far it swings, in degrees, the smaller angle first: at 0 it stands straight out of what it stands on. Default
    /// `[-45, 45]`.
    #[serde(default = "half_a_right_angle", serialize_with = "two_on_one_line")]
    #[garde(custom(ANGLE.ends_rule()))]
    #[schemars(with = "[f64; 2]")]
    pub range_deg: [f64; 2],

    /// How it stands when an episode begins, in degrees: a number, or `[min, max]`, drawn anew for every episode. Without it: at
    /// the smaller end, or at 0 where it springs back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(inner(custom(ANGLE.range_rule())))]
    #[schemars(transform = ANGLE.schema())]
    pub angle_deg: Option<Range>,

    /// Of a stick that goes back to 0 by a spring when it is left: how long it takes for two thirds of the way, in s. Without it, it stays where it is left.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(inner(custom(SPRING.rule())))]
    #[schemars(transform = SPRING.schema())]
    pub springs_back_s: Option<f64>,

    /// Where what it stands on looks, in degrees: 0 up, like a table; 90 towards the user, like a wall. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,
}

/// A stick written out. Angles in rad, lengths in m from the shoulder centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Stick {
    /// Its hinge.
    pub hinge: [f64; 3],
    /// From the hinge to the middle of the knob at an angle of 0.
    pub upright: [f64; 3],
    /// The same at a right angle.
    pub aside: [f64; 3],
    /// Radius of the knob.
    pub knob: f64,
    /// How far it swings.
    pub range: Range,
    /// How it stands when an episode begins.
    pub start: Range,
    /// How long it takes (s) until it is back at 0 but for a share of 1/e; none where it stays where it is left.
    pub springs_back_s: Option<f64>,
}

impl StickItem {
    /// Written out in the frame that its hinge is in.
    ///
    /// # Errors
    /// The field that is wrong, and what is wrong with it.
    pub(crate) fn placed(&self, frame: Frame) -> Result<Stick, (&'static str, String)> {
        let [least, most] = self.range_deg;
        if self.springs_back_s.is_some() && (least > 0.0 || most < 0.0) {
            return Err((
                "range_deg",
                format!("goes from {least} to {most}; a stick springs back to 0, which must be within"),
            ));
        }
        let angle = self.angle_deg.unwrap_or(Range::fixed(if self.springs_back_s.is_some() { 0.0 } else { least }));
        if angle.min < least || angle.max > most {
            let wrong = if angle.min < least { angle.min } else { angle.max };
            return Err(("angle_deg", format!("is {wrong}; its `range_deg` goes from {least} to {most}")));
        }
        if self.knob >= self.length {
            let Self { knob, length, .. } = self;
            return Err(("knob", format!("is {knob} m; it must be less than the `length`, {length} m")));
        }
        let arm = |way: Vector3<f64>| (frame.rotation * way * (frame.scale * self.length)).into();
        let radians = |range: Range| Range::new(range.min.to_radians(), range.max.to_radians());
        Ok(Stick {
            hinge: frame.origin.into(),
            upright: arm(Vector3::z()),
            aside: arm(self.swings.own_axis()),
            knob: frame.scale * self.knob,
            range: radians(Range::new(least, most)),
            start: radians(angle),
            springs_back_s: self.springs_back_s,
        })
    }
}

impl Stick {
    /// From the hinge to the middle of the knob (m).
    pub fn length(&self) -> f64 {
        Vector3::from(self.upright).norm()
    }

    /// From the hinge to the middle of the knob (m) at an angle (rad).
    pub fn arm(&self, angle: f64) -> [f64; 3] {
        arm(self.upright, self.aside, angle)[0]
    }

    /// Places that the knob goes through between two angles (rad), as seen from the hinge (m).
    pub(crate) fn arc(&self, angles: Range) -> impl Iterator<Item = [f64; 3]> + Clone + '_ {
        const PLACES: u32 = 24;
        (0..=PLACES).map(move |k| self.arm(angles.at(f64::from(k) / f64::from(PLACES))))
    }

    /// A sphere as large as the knob in the place of the hinge.
    pub(crate) fn ball(&self) -> Sphere {
        Sphere { region: Region::point(self.hinge), radius: Range::fixed(self.knob), apart: None, path: None }
    }
}

fn fistwide() -> f64 {
    0.02
}

fn half_a_right_angle() -> [f64; 2] {
    [-45.0, 45.0]
}
