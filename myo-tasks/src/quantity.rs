//! One place for the allowed values of a number: the check of a task and its JSON Schema both read it.

use schemars::Schema;
use serde_json::{Value, json};

use crate::range::Range;

/// The values a field may take, and their unit.
#[derive(Clone, Copy)]
pub(crate) struct Quantity {
    unit: &'static str,
    min: f64,
    max: f64,
}

impl Quantity {
    /// From `min` to `max`, both allowed.
    pub(crate) const fn between(min: f64, max: f64, unit: &'static str) -> Self {
        Self { unit, min, max }
    }

    /// The smallest value.
    pub(crate) const fn least(self) -> f64 {
        self.min
    }

    /// The greatest value.
    pub(crate) const fn most(self) -> f64 {
        self.max
    }

    /// The garde rule of a plain number. NaN and infinities fail it.
    pub(crate) fn rule(self) -> impl Fn(&f64, &()) -> garde::Result {
        move |value, ()| self.check(*value)
    }

    /// The garde rule of an interval: in order, and both ends allowed.
    pub(crate) fn range_rule(self) -> impl Fn(&Range, &()) -> garde::Result {
        move |range, ()| {
            self.check(range.min)?;
            self.check(range.max)?;
            if range.min > range.max {
                return Err(garde::Error::new(format!(
                    "goes from {} to {}; the smaller end must come first",
                    self.with_unit(range.min),
                    self.with_unit(range.max)
                )));
            }
            Ok(())
        }
    }

    /// The garde rule of both ends of a range that has a width.
    pub(crate) fn ends_rule(self) -> impl Fn(&[f64; 2], &()) -> garde::Result {
        move |&[least, most], ()| {
            self.check(least)?;
            self.check(most)?;
            if least < most {
                return Ok(());
            }
            Err(garde::Error::new(format!("goes from {least} to {most}; the smaller value must come first")))
        }
    }

    pub(crate) fn check(self, value: f64) -> garde::Result {
        // NaN compares false with everything and so ends in the error.
        if value >= self.min && value <= self.max {
            return Ok(());
        }
        Err(garde::Error::new(format!("is {}; it must be {}", self.with_unit(value), self.bounds())))
    }

    fn bounds(self) -> String {
        format!("from {} to {}", self.min, self.with_unit(self.max))
    }

    fn with_unit(self, value: f64) -> String {
        let digits = match value.abs() {
            1e-6..1e16 | 0.0 => format!("{value}"),
            // Not hundreds of zeros.
            _ => format!("{value:e}"),
        };
        match self.unit {
            unit if !unit.is_empty() && value.is_finite() => format!("{digits} {unit}"),
            _ => digits,
        }
    }

    /// Adds the bounds, and the unit as `x-unit`, to every number inside a field's schema.
    pub(crate) fn schema(self) -> impl FnMut(&mut Schema) {
        move |schema| {
            if let Some(object) = schema.as_object_mut() {
                self.mark(object);
            }
        }
    }

    fn mark(self, object: &mut serde_json::Map<String, Value>) {
        if is_number(object.get("type")) {
            object.insert("minimum".into(), json!(self.min));
            object.insert("maximum".into(), json!(self.max));
            if !self.unit.is_empty() {
                object.insert("x-unit".into(), json!(self.unit));
            }
        }
        for key in ["anyOf", "items", "additionalProperties"] {
            match object.get_mut(key) {
                Some(Value::Object(child)) => self.mark(child),
                Some(Value::Array(list)) => {
                    list.iter_mut().filter_map(Value::as_object_mut).for_each(|child| self.mark(child));
                }
                _ => {}
            }
        }
    }
}

fn is_number(kind: Option<&Value>) -> bool {
    match kind {
        Some(Value::String(name)) => name == "number",
        Some(Value::Array(names)) => names.iter().any(|name| name == "number"),
        _ => false,
    }
}
