//! Values of a scene that can be written in several ways: places, pitches and names.

use garde::Validate;
use schemars::JsonSchema;
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_saphyr::FlowSeq;
use std::borrow::Cow;
use std::fmt;

use crate::range::Range;
use crate::target::{COORDINATE, LENGTH, Region};

/// From one middle to the next (m): across and down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema, Validate)]
#[serde(untagged)]
pub enum Pitch {
    /// Both alike.
    Both(
        #[garde(custom(LENGTH.rule()))]
        #[schemars(transform = LENGTH.schema())]
        f64,
    ),
    /// Across, down.
    Each(
        #[serde(serialize_with = "two_on_one_line")]
        #[garde(inner(custom(LENGTH.rule())))]
        #[schemars(transform = LENGTH.schema())]
        [f64; 2],
    ),
}

/// A name; numbers are names, too.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Name(pub String);

/// Where a centre may lie; in a file `[x, y, z]`, or `x`, `y` and `z`, each a number or `[min, max]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place(pub Region);

impl Pitch {
    /// Across, down.
    pub fn pair(self) -> [f64; 2] {
        match self {
            Self::Both(pitch) => [pitch; 2],
            Self::Each(pair) => pair,
        }
    }
}

impl From<[f64; 3]> for Place {
    fn from(point: [f64; 3]) -> Self {
        Self(Region::point(point))
    }
}

impl Default for Place {
    fn default() -> Self {
        Self(Region::point([0.0; 3]))
    }
}

/// By hand, so that paths are those of a list, as which places are written.
impl Validate for Place {
    type Context = ();

    fn validate_into(&self, (): &(), mut parent: &mut dyn FnMut() -> garde::Path, report: &mut garde::Report) {
        for (axis, range) in [self.0.x, self.0.y, self.0.z].iter().enumerate() {
            if let Err(problem) = COORDINATE.range_rule()(range, &()) {
                let mut path = garde::util::nested_path!(parent, axis);
                report.append(path(), problem);
            }
        }
    }
}

impl Serialize for Place {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        FlowSeq([self.0.x, self.0.y, self.0.z]).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Place {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PlaceVisitor)
    }
}

struct PlaceVisitor;

impl<'de> Visitor<'de> for PlaceVisitor {
    type Value = Place;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list [x, y, z], each a number or [min, max]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Place, A::Error> {
        let mut axes = Vec::with_capacity(3);
        while let Some(axis) = list.next_element::<Range>()? {
            axes.push(axis);
        }
        match axes[..] {
            [x, y, z] => Ok(Place(Region { x, y, z })),
            _ => Err(A::Error::invalid_length(axes.len(), &self)),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Place, A::Error> {
        Region::deserialize(serde::de::value::MapAccessDeserializer::new(map)).map(Place)
    }
}

impl JsonSchema for Place {
    fn schema_name() -> Cow<'static, str> {
        "Place".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let axis = generator.subschema_for::<Range>();
        let mut axis = axis;
        (COORDINATE.schema())(&mut axis);
        let region = generator.subschema_for::<Region>();
        schemars::json_schema!({ "anyOf": [{ "type": "array", "items": axis, "minItems": 3, "maxItems": 3 }, region] })
    }
}

impl<'de> Deserialize<'de> for Pitch {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let range = Range::deserialize(deserializer)?;
        // Equal numbers in a list are both alike, too.
        Ok(if range.min == range.max { Self::Both(range.min) } else { Self::Each([range.min, range.max]) })
    }
}

impl<'de> Deserialize<'de> for Name {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NameVisitor)
    }
}

struct NameVisitor;

impl Visitor<'_> for NameVisitor {
    type Value = Name;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Name, E> {
        Ok(Name(name.to_owned()))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Name, E> {
        Ok(Name(number.to_string()))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Name, E> {
        Ok(Name(number.to_string()))
    }
}

impl JsonSchema for Name {
    fn schema_name() -> Cow<'static, str> {
        "Name".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "anyOf": [{ "type": "string" }, { "type": "integer" }] })
    }
}

pub(crate) fn two_on_one_line<S: serde::Serializer>(values: &[f64; 2], serializer: S) -> Result<S::Ok, S::Error> {
    FlowSeq(values).serialize(serializer)
}
