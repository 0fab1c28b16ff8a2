//! Which simulated user moves as a person does: the traits with which it comes nearest to recordings.
//!
//! One user learns to be anybody: it practises in layouts whose users differ in their [`TRAITS`], and observes which of them it is ([`practice`]). So
//! another [`Nature`] needs no other training, and a [fit](Fitted) is only simulation: natures do the targets of the recordings, each [figure](FIGURES) of
//! their movements becomes a smooth function of the traits, and the nature is looked for whose figures are nearest to the person's. That is done again with natures nearer
//! and nearer to it. How late users see and how tall they are is built into their simulation: [`Candidate`]s who differ in it learn each for itself, and
//! [`FittedAmong`] them is who comes nearest.
//!
//! What it does not know: other senses, and where a person sat, are as told; targets lie on a circle before the
//! shoulder wherever they were for the person; whoever differs from people in a way that no trait changes is not found to do so, and
//! [what is left](Fitted::distance_after) of the distance tells how much that is.

mod anybody;
mod candidates;
mod figures;
mod muscles;
mod nature;
mod practice;
mod search;
mod surface;

use myo_model::Nearest;
use thiserror::Error;

pub use anybody::Anybody;
pub use candidates::{Candidate, FittedAmong, Ranked};
pub use figures::{Aim, FIGURES};
pub use nature::{Nature, TRAITS, Trait, natures, others};
use practice::{DISTANCES, WIDTHS};
pub use practice::{aims, practice};
pub use search::{Fitted, FittedFigure, FittedTrait, MOST_TRAININGS, comparable};

use crate::protocol::ProtocolError;
use crate::recordings::RecordingError;

/// Why nobody can be found.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FittingError {
    /// Recordings cannot be measured, or a user not be recorded.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A simulated user cannot be asked.
    #[error(transparent)]
    Asked(#[from] ProtocolError),
    /// A muscle was recorded that the body has not.
    #[error(
        "`{body}` has no muscle `{name}`; {nearest} A column that is not to be compared is passed over where its name begins with `note_`"
    )]
    UnknownMuscle {
        /// The muscle.
        name: String,
        /// The body.
        body: String,
        /// Muscles that it has.
        nearest: Nearest,
    },
    /// A task cannot be made.
    #[error("the user of this task cannot be fitted: {0}")]
    Task(#[from] myo_tasks::LoadError),
    /// Too little that can be compared.
    #[error(
        "{who}: {found} movements in {pairs} pairs of distance and width can be compared; a fit needs {least_pairs} pairs with {least} movements each, from {} to \
         {} cm at targets from {} to {} mm wide",
        100.0 * DISTANCES[0], 100.0 * DISTANCES[1], 1e3 * WIDTHS[0], 1e3 * WIDTHS[1]
    )]
    TooFew {
        /// Who.
        who: String,
        /// Movements that count.
        found: usize,
        /// In so many pairs.
        pairs: usize,
        /// Fewest movements of a pair.
        least: usize,
        /// Fewest pairs.
        least_pairs: usize,
    },
    /// More trainings than a fit can tell apart.
    #[error("{count} trainings: a fit can take {MOST_TRAININGS} at most, each of which does a part of the users")]
    TooMany {
        /// So many.
        count: usize,
    },
    /// Nobody can become somebody.
    #[error("there is no user who could be anybody")]
    NoUser,
    /// Users who see equally late.
    #[error(
        "{a} and {b} ms are the same number of control steps of {step_ms} ms, so that both users would be one; leave one out"
    )]
    SameDelay {
        /// A delay (ms).
        a: f64,
        /// Another.
        b: f64,
        /// What a decision lasts (ms).
        step_ms: f64,
    },
    /// Users who are equally tall.
    #[error("{height_m} m stands there twice, so that both users would be one; leave one out")]
    SameHeight {
        /// Their stature (m).
        height_m: f64,
    },
    /// Movements that tell nothing.
    #[error(
        "{who}: nothing can be compared: movement times of a pair of distance and width are all the same, all pairs are equally difficult, or no movement sets \
         off towards its target"
    )]
    Alike {
        /// Whose.
        who: String,
    },
    /// The simulated user does not do what is asked.
    #[error(
        "of {natures} natures only {able} could do what {who} did, and at least {least} are needed: the user who can be anybody has not learnt it, train it longer (`--steps`)"
    )]
    Unlearnt {
        /// Whose recordings.
        who: String,
        /// Natures that were tried.
        natures: usize,
        /// Who could.
        able: usize,
        /// Fewest.
        least: usize,
    },
}
