//! What stands in the way of a figure.

/// Why a measure could not be taken: what is wrong, where, which value, and what would be right.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// Fewer than the measure needs.
    #[error("{what}: {found} given, at least {least} are needed")]
    TooFew {
        /// Of what there are too few.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        least: usize,
    },
    /// A number that is infinite or none at all.
    #[error("{what}: {} at index {index}; every number must be finite", short(*.value))]
    NotFinite {
        /// What the number stands for.
        what: &'static str,
        /// Index of the sample, trial or condition.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A number that cannot be.
    #[error("{what}: {}{}; it must be {right}", short(*.value), at(.index))]
    OutOfRange {
        /// What the number stands for.
        what: &'static str,
        /// Index of the sample, trial or condition; none for a setting.
        index: Option<usize>,
        /// The number, in units of what would be right.
        value: f64,
        /// What would be right.
        right: &'static str,
    },
    /// Two series that belong together do not have the same length.
    #[error("{what}: {found} entries, but {expected} are needed to go with the rest")]
    UnequalLengths {
        /// Which series.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Length of what it belongs to.
        expected: usize,
    },
    /// Samples that are not equally far apart in time.
    #[error(
        "times: {step_s} s between samples {index} and {next}, but {usual_s} s elsewhere; resample them to a fixed rate first",
        next = index + 1
    )]
    UnevenTimes {
        /// Index of the sample before the odd step.
        index: usize,
        /// Length of that step.
        step_s: f64,
        /// Length of the middle one of all steps.
        usual_s: f64,
    },
    /// The recording does not hold the end of a movement that was asked for.
    #[error("{what}: the speed at index {index} is {share:.3} of the peak and never below {threshold}; {right}")]
    NoEdge {
        /// Onset or end of the movement.
        what: &'static str,
        /// First or last sample that was looked at.
        index: usize,
        /// Speed there over peak speed.
        share: f64,
        /// Share of the peak that bounds a movement.
        threshold: f64,
        /// What would help.
        right: &'static str,
    },
    /// All values are the same, so that their spread, direction or proportion does not exist.
    #[error("{what}: all are {}; {right}", short(*.value))]
    NoSpread {
        /// What does not vary.
        what: &'static str,
        /// The value that all have.
        value: f64,
        /// What would be right.
        right: &'static str,
    },
    /// The same in one of several users or conditions.
    #[error("{what} {index}: {source}")]
    Within {
        /// User or condition.
        what: &'static str,
        /// Which one, counted from zero.
        index: usize,
        /// What is wrong there.
        source: Box<MeasureError>,
    },
}

impl MeasureError {
    pub(crate) fn within(self, what: &'static str, index: usize) -> Self {
        Self::Within { what, index, source: Box::new(self) }
    }
}

/// The number without hundreds of digits.
fn short(value: f64) -> String {
    let usual = value == 0.0 || (1e-6..1e9).contains(&value.abs());
    if usual || !value.is_finite() { value.to_string() } else { format!("{value:e}") }
}

fn at(index: &Option<usize>) -> String {
    index.map_or_else(String::new, |index| format!(" at index {index}"))
}

/// What measures return.
pub type Result<T> = std::result::Result<T, MeasureError>;
