//! How much a model may ask for, so that no file can exhaust the machine.

use crate::error::MjcfError;
use crate::place::Spot;

/// What reading may cost at most. The defaults leave room for models some ten times larger than a whole human body.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Bytes of one file.
    pub file_bytes: u64,
    /// Bytes of all files together.
    pub total_bytes: u64,
    /// Files that are included, attached models counted.
    pub includes: usize,
    /// How deep files include each other.
    pub include_depth: usize,
    /// How deep elements stand in each other, includes and attached models counted. Reading takes a few kilobytes of stack
    /// for each level.
    pub depth: usize,
    /// Elements after includes, copies and attached models.
    pub elements: usize,
    /// Attributes of one element.
    pub attributes: usize,
    /// Copies that one `replicate` makes.
    pub copies: usize,
    /// Bytes of names and lists that elements hold after classes and copies.
    pub held_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 64 << 20,
            total_bytes: 64 << 20,
            includes: 1_000,
            include_depth: 16,
            depth: 200,
            elements: 200_000,
            attributes: 200,
            copies: 100_000,
            held_bytes: 256 << 20,
        }
    }
}

/// What reading has cost so far.
#[derive(Debug)]
pub(crate) struct Budget {
    pub limits: Limits,
    pub bytes: u64,
    pub includes: usize,
    elements: usize,
    held_bytes: u64,
    visits: usize,
}

/// How often elements of attached models are looked at, on average at most: each time a part of one is attached.
const VISITS_EACH: usize = 20;

impl Budget {
    pub fn new(limits: Limits) -> Self {
        Self { limits, bytes: 0, includes: 0, elements: 0, held_bytes: 0, visits: 0 }
    }

    /// Books `elements` with `bytes` of names and lists.
    pub fn book(&mut self, elements: usize, bytes: u64, at: impl FnOnce() -> Spot) -> Result<(), MjcfError> {
        self.elements = self.elements.saturating_add(elements);
        self.held_bytes = self.held_bytes.saturating_add(bytes);
        if self.elements > self.limits.elements {
            return Err(too_much(at(), "elements after includes and copies", self.limits.elements as u64));
        }
        if self.held_bytes > self.limits.held_bytes {
            return Err(too_much(at(), "bytes of names and lists", self.limits.held_bytes));
        }
        Ok(())
    }

    /// Books that `elements` of a model to attach are looked at.
    pub fn visit(&mut self, elements: usize, at: impl FnOnce() -> Spot) -> Result<(), MjcfError> {
        self.visits = self.visits.saturating_add(elements);
        let most = self.limits.elements.saturating_mul(VISITS_EACH);
        if self.visits > most { Err(too_much(at(), "visits of attached elements", most as u64)) } else { Ok(()) }
    }
}

pub(crate) fn too_much(at: Spot, what: &'static str, limit: u64) -> MjcfError {
    MjcfError::TooMuch { at: Box::new(at), what, limit }
}
