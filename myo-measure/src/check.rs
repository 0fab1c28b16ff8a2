//! Checks of what callers hand in, before anything is computed.

use crate::{MeasureError, Point, Result};

pub(crate) fn at_least(what: &'static str, found: usize, least: usize) -> Result<()> {
    if found < least { Err(MeasureError::TooFew { what, found, least }) } else { Ok(()) }
}

pub(crate) fn same_length(what: &'static str, found: usize, expected: usize) -> Result<()> {
    if found == expected { Ok(()) } else { Err(MeasureError::UnequalLengths { what, found, expected }) }
}

/// No measurement is larger in any unit; squares and quotients of smaller numbers stay finite.
const LARGEST: f64 = 1e60;

pub(crate) fn finite(what: &'static str, values: &[f64]) -> Result<()> {
    values.iter().enumerate().try_for_each(|(index, &value)| measurable(what, index, value))
}

fn measurable(what: &'static str, index: usize, value: f64) -> Result<()> {
    if !value.is_finite() {
        Err(MeasureError::NotFinite { what, index, value })
    } else if value.abs() > LARGEST {
        Err(MeasureError::OutOfRange { what, index: Some(index), value, right: "at most 1e60 in size" })
    } else {
        Ok(())
    }
}

pub(crate) fn points(what: &'static str, points: &[Point]) -> Result<()> {
    points.iter().enumerate().try_for_each(|(index, &point)| finite_point(what, index, point))
}

pub(crate) fn finite_point(what: &'static str, index: usize, point: Point) -> Result<()> {
    point.into_iter().try_for_each(|value| measurable(what, index, value))
}

pub(crate) fn within(
    what: &'static str,
    values: &[f64],
    right: &'static str,
    is_right: impl Fn(f64) -> bool,
) -> Result<()> {
    finite(what, values)?;
    let wrong = values.iter().enumerate().find(|&(_, &value)| !is_right(value));
    wrong.map_or(Ok(()), |(index, &value)| Err(MeasureError::OutOfRange { what, index: Some(index), value, right }))
}

pub(crate) fn setting(what: &'static str, value: f64, right: &'static str, is_right: bool) -> Result<()> {
    if value.is_finite() && is_right {
        Ok(())
    } else {
        Err(MeasureError::OutOfRange { what, index: None, value, right })
    }
}

pub(crate) fn rate(rate_hz: f64) -> Result<()> {
    setting("rate in Hz", rate_hz, "greater than 0 and at most 1e60", rate_hz > 0.0 && rate_hz <= LARGEST)
}

pub(crate) fn spread(what: &'static str, values: &[f64], right: &'static str) -> Result<()> {
    let Some(&value) = values.first() else { return Ok(()) };
    if values.iter().all(|&other| other == value) {
        return Err(MeasureError::NoSpread { what, value, right });
    }
    Ok(())
}
