//! What the columns of tables are called and mean.

/// A column of a table that the library writes: of episode summaries, or of a training's metrics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty for shares and counts.
    pub unit: &'static str,
    /// What it is, one sentence.
    pub meaning: &'static str,
}

impl Column {
    /// A column.
    pub const fn new(name: &'static str, unit: &'static str, meaning: &'static str) -> Self {
        Self { name, unit, meaning }
    }
}
