//! Why a protocol gives no answer.

use myo_dynamics::PlanError;
use myo_env::{BuildError, EnvError};
use myo_measure::MeasureError;
use myo_tasks::LoadError;
use myo_train::TrainError;
use thiserror::Error;

use super::{SizesError, StrengthError};

/// Why there is no answer to what a user was asked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ProtocolError {
    /// The task of the user cannot be turned into one of the protocol.
    #[error("the user of this task cannot be asked: {0}")]
    Task(#[from] LoadError),
    /// It cannot be simulated.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A step was refused.
    #[error(transparent)]
    Env(#[from] EnvError),
    /// The policy does not fit.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// The body cannot be simulated.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The body lacks what is asked for.
    #[error(transparent)]
    Strength(#[from] StrengthError),
    /// The model cannot become a small or a large person's body.
    #[error(transparent)]
    Sizes(#[from] SizesError),
    /// The body lacks a joint.
    #[error("the protocol needs the joint {joint}, which the body `{model}` does not have")]
    NoJoint {
        /// Which.
        joint: &'static str,
        /// Name of the body.
        model: String,
    },
    /// The body lacks muscles, or does not say what they are for (`group` in a model file).
    #[error("the protocol needs {what}, which the body `{model}` does not name")]
    NoMuscle {
        /// Which.
        what: &'static str,
        /// Name of the body.
        model: String,
    },
    /// The arm is in postures in which no muscle holds it.
    #[error(
        "work at the height of the {height}: the arm was in postures in which no muscle holds the joint {joint} against gravity"
    )]
    Powerless {
        /// Which joint.
        joint: &'static str,
        /// Where the user worked.
        height: &'static str,
    },
    /// What was recorded has no such figure.
    #[error("{what}: {error}")]
    Measure {
        /// What was to be measured.
        what: String,
        /// Why it was not.
        error: MeasureError,
    },
    /// The user did too little.
    #[error(
        "{what}: the user did {found} of {asked}, and at least {least} are needed. It has not learnt this: train it longer (`--steps`), or ask \
         one who is slower or has less noise"
    )]
    TooFew {
        /// What was to be done.
        what: String,
        /// How often it was.
        found: usize,
        /// How often it was asked for.
        asked: usize,
        /// How often it must be.
        least: usize,
    },
}

impl ProtocolError {
    /// Names what was to be measured.
    pub(crate) fn measuring(what: impl Into<String>) -> impl FnOnce(MeasureError) -> Self {
        let what = what.into();
        move |error| Self::Measure { what, error }
    }
}
