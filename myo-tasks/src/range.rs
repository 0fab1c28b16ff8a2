//! A closed interval that a value is drawn from.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_saphyr::FlowSeq;

/// A closed interval. In a file either `[min, max]`, drawn from uniformly, or one number, which is then fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub min: f64,
    /// Upper end, not below `min`.
    pub max: f64,
}

impl Range {
    /// The interval from `min` to `max`.
    pub const fn new(min: f64, max: f64) -> Self {
        Self { min, max }
    }

    /// One value only.
    pub const fn fixed(value: f64) -> Self {
        Self { min: value, max: value }
    }

    /// The value a share `t` of the way from `min` (0) to `max` (1).
    pub fn at(self, t: f64) -> f64 {
        self.min + t * (self.max - self.min)
    }

    /// The middle.
    pub fn centre(self) -> f64 {
        self.at(0.5)
    }

    /// Length of the interval.
    pub fn width(self) -> f64 {
        self.max - self.min
    }
}

impl From<f64> for Range {
    fn from(value: f64) -> Self {
        Self::fixed(value)
    }
}

impl From<[f64; 2]> for Range {
    fn from([min, max]: [f64; 2]) -> Self {
        Self { min, max }
    }
}

impl Serialize for Range {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.min == self.max {
            self.min.serialize(serializer)
        } else {
            FlowSeq([self.min, self.max]).serialize(serializer)
        }
    }
}

impl<'de> Deserialize<'de> for Range {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RangeVisitor)
    }
}

struct RangeVisitor;

impl<'de> Visitor<'de> for RangeVisitor {
    type Value = Range;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or [min, max]")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Range, E> {
        Ok(Range::fixed(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Range, E> {
        Ok(Range::fixed(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Range, E> {
        Ok(Range::fixed(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Range, A::Error> {
        let mut ends = Vec::with_capacity(2);
        while let Some(end) = list.next_element::<f64>()? {
            ends.push(end);
        }
        match ends[..] {
            [min, max] => Ok(Range { min, max }),
            _ => Err(A::Error::invalid_length(ends.len(), &self)),
        }
    }
}

impl JsonSchema for Range {
    fn schema_name() -> Cow<'static, str> {
        "Range".into()
    }

    /// Inline, so that each field adds its own bounds.
    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [
                { "type": "number" },
                { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 }
            ]
        })
    }
}
