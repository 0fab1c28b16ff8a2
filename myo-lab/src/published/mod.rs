//! The experiments of the published system, done with users of ours: two tables of training times and three figures of movements.
//!
//! [`Published`] is what was found, as data: it is kept as JSON, and its [page](Published::page) and [plots](Published::plots) are made of it. What others
//! published stands in [`TRAININGS`].

mod aiming;
mod facts;
mod page;

use myo_measure::MeasureError;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use aiming::{Aiming, AimingCondition, AimingWidth, at_widths};
pub use facts::{FIGURE_STEPS, PUBLISHED_R2, PublishedTraining, TRAININGS};

use crate::protocol::Plot;
use crate::recordings::RecordingError;

/// Why an experiment has no result.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PublishedError {
    /// Only spheres of a range of sizes have a smallest and a largest one.
    #[error("{task:?} asks for other targets than resting spheres of one range of sizes, as `pointing` has them")]
    NotSpheres {
        /// The task.
        task: String,
    },
    /// Too few movements.
    #[error("{who} made {found} movements at targets; at least {least} are needed")]
    TooFew {
        /// Who.
        who: String,
        /// So many.
        found: usize,
        /// So many are needed.
        least: usize,
    },
    /// Users cannot be recorded, or recordings not be measured.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// There is no law through the movements.
    #[error("Fitts' law: {0}")]
    Measure(#[from] MeasureError),
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Trainings of users.
    pub trainings: Vec<TrainedTo>,
    /// How users aim.
    pub aiming: Vec<Aiming>,
    /// Where and how trainings and figures were made.
    pub made: Vec<Made>,
}

/// A training of one user to its goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainedTo {
    /// The preset.
    pub task: String,
    /// The body.
    pub body: String,
    /// The user.
    pub user: String,
    /// Its seed.
    pub seed: u64,
    /// Share of successful episodes that was its goal.
    pub goal: f64,
    /// Whether it came to it.
    pub reached: bool,
    /// Control steps.
    pub env_steps: u64,
    /// Seconds from getting ready to the end of the last evaluation.
    pub wall_s: f64,
    /// Share of 1,000 fresh episodes in which it succeeded in the end.
    pub success: Option<f64>,
}

/// Where and how something was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Made {
    /// What: `tables` or `figures`.
    pub what: String,
    /// The command.
    pub command: String,
    /// The machine.
    pub machine: String,
    /// Threads, or the card.
    pub device: String,
    /// Day, `YYYY-MM-DD`, UTC.
    pub date: String,
    /// Version of the program.
    pub version: String,
    /// How long it took (s).
    pub wall_s: f64,
}

impl Published {
    /// The figures, each with the stem of its file's name.
    pub fn plots(&self) -> Vec<(String, Plot)> {
        if self.aiming.is_empty() {
            return vec![];
        }
        let mut plots = vec![("fitts".into(), self.fitts())];
        for (number, aiming) in (1..).zip(&self.aiming) {
            plots.push((format!("positions-{number}"), aiming.positions()));
            plots.push((format!("velocities-{number}"), aiming.velocities()));
        }
        plots
    }

    fn fitts(&self) -> Plot {
        Plot {
            title: "Fitts' law".into(),
            axes: ["index of difficulty, bit".into(), "movement time, s".into()],
            series: self.aiming.iter().flat_map(Aiming::series).collect(),
        }
    }
}
