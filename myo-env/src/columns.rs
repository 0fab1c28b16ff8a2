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

/// Columns that every summary of an episode has.
pub(crate) const RETURN: Column = Column::new("return", "", "Sum of the rewards.");
pub(crate) const LENGTH: Column = Column::new("length", "control steps", "Control steps from reset to end.");
pub(crate) const EFFORT: Column =
    Column::new("effort", "", "Squared muscle control, mean over muscles and control steps.");
pub(crate) const FATIGUE: Column = Column::new(
    "fatigue",
    "",
    "Share of the strength of all muscles that fatigues in the episode, as of rested people (3CC-r): of what is active of each, weighted by its \
     greatest force; without what recovers.",
);
pub(crate) const SOLVER_ROUNDS: Column = Column::new(
    "solver_rounds",
    "",
    "Rounds of the constraint solver per physics step, mean; 1 without limits and contact.",
);
pub(crate) const SOLVER_UNSOLVED: Column =
    Column::new("solver_unsolved", "", "Physics steps that the solver gave up on: their forces are not to be trusted.");

impl Column {
    /// A column.
    pub const fn new(name: &'static str, unit: &'static str, meaning: &'static str) -> Self {
        Self { name, unit, meaning }
    }
}
