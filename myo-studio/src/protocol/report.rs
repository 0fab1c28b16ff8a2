//! What a report holds: everything that its page asks an engine for, answered in advance.

use serde::{Deserialize, Serialize};

use super::{BodyShape, LayoutTable, MotionHeader, RunDetail, TaskView};

/// Runs as they were when the report was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Recorded {
    /// Version of Myo.
    pub version: String,
    /// When it was made (s since 1970).
    pub made_s: f64,
    /// Each run, in the order in which they were named.
    pub runs: Vec<RecordedRun>,
    /// All of them by layout.
    pub table: LayoutTable,
}

/// A run in a report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RecordedRun {
    /// All that is known of it.
    pub detail: RunDetail,
    /// Its task, written out.
    pub view: TaskView,
    /// Its body.
    pub body: BodyShape,
    /// Mean squared control of each step; empty for a run without a checkpoint.
    pub efforts: Vec<Option<f64>>,
    /// An episode; none for a run without a checkpoint.
    pub motion: Option<RecordedMotion>,
}

/// A motion in text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct RecordedMotion {
    /// How its numbers lie.
    pub header: MotionHeader,
    /// The numbers in single precision, little end first, in base 64.
    pub numbers: String,
}
