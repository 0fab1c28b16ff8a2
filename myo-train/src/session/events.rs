//! What a session reports: how it goes, what is worth a word, why it ended or failed.

use std::fmt;
use std::path::PathBuf;

use thiserror::Error;

use super::means::{Bottleneck, EpisodeMeans};
use super::recovery;
use super::trend::Trend;
use crate::{Evaluation, RunError, TrainError, UpdateMetrics};

/// Why a training ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// The deterministic policy succeeds often enough.
    Until,
    /// Nothing improves any more that is worth further training.
    Plateau,
    /// The steps are used up.
    Steps,
    /// The caller asked for it: Ctrl-C, or `go_on` said no.
    Interrupted,
    /// The graphics card was lost, and with it what came after the newest checkpoint.
    DeviceLost {
        /// What the driver says.
        reason: String,
    },
}

impl End {
    /// Name in tables and JSON.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Until => "until",
            Self::Plateau => "plateau",
            Self::Steps => "steps",
            Self::Interrupted => "interrupt",
            Self::DeviceLost { .. } => "device_lost",
        }
    }
}

/// Something that is worth a word.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// Learning ran away and goes on from an earlier state with shorter steps.
    WentBack {
        /// What was wrong.
        reason: String,
        /// Control steps at which it was noticed.
        env_steps: u64,
        /// Control steps of the state that it goes on from.
        to_env_steps: u64,
        /// Step size from there on.
        learning_rate: f64,
    },
    /// Nothing improves; told once.
    Flat {
        /// For how many control steps.
        env_steps: u64,
        /// In which layout, counted from 0, where there are several: the one with the least success.
        layout: Option<usize>,
        /// What the episodes are like.
        recent: EpisodeMeans,
    },
}

impl fmt::Display for News {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let million = |steps: &u64| *steps as f64 / 1e6;
        match self {
            Self::WentBack { reason, env_steps, to_env_steps, learning_rate } => write!(
                f,
                "training ran away after {:.2} M control steps: {reason}; it goes on from {:.2} M with steps of {learning_rate:.1e}",
                million(env_steps),
                million(to_env_steps)
            ),
            Self::Flat { env_steps, layout, recent } => {
                layout.map_or(Ok(()), |layout| write!(f, "layout {}: ", layout + 1))?;
                write!(
                    f,
                    "nothing has improved for {:.1} M control steps, success stays at {:.0} %",
                    million(env_steps),
                    100.0 * recent.success
                )
            }
        }
    }
}

/// The layout that a training of several does worst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastLayout {
    /// Its number, from 0.
    pub layout: usize,
    /// Mean success of its recent training episodes.
    pub success: f64,
}

/// What one [`Session::advance`] brought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Of the update; none when there was none: the training was interrupted in it, went back, made up for a look that had
    /// been cut off, was over already, or lost its card.
    pub metrics: Option<UpdateMetrics>,
    /// Mean success of recent training episodes, whose actions are noisy; none before the first ended.
    pub success: Option<f64>,
    /// The layout in which fewest of them succeed, where there are several; none before one has ended in each.
    pub least: Option<LeastLayout>,
    /// The target that recent training episodes, of that layout, fail at most; none before the first ended.
    pub bottleneck: Option<Bottleneck>,
    /// Control steps that training may still take until the goal, judged by the learning curve.
    pub steps_left: Option<u64>,
    /// Looks that were taken at the deterministic policy.
    pub looks: Vec<Evaluation>,
    /// What is worth a word.
    pub news: Vec<News>,
    /// Set when the training is over.
    pub end: Option<End>,
}

/// How a training went.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Why it ended.
    pub end: End,
    /// Of the last policy on fresh episodes; none after an interrupt or a loss.
    pub evaluation: Option<Evaluation>,
    /// What the last doubling of the training brought and more would, if that can be told: a user may still have been improving.
    pub trend: Option<Trend>,
    /// Control steps of all environments.
    pub env_steps: u64,
    /// Updates of the policy.
    pub updates: u64,
    /// Seconds of training and of the looks at the goal.
    pub wall_s: f64,
    /// The run folder, if the training was recorded.
    pub run: Option<PathBuf>,
    /// The newest checkpoint, if the training was recorded.
    pub checkpoint: Option<PathBuf>,
}

/// Why a training cannot go on.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SessionError {
    /// It failed.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// Learning ran away from the same state again and again, with ever shorter steps.
    #[error(
        "training diverged {} times from the same state: {reason}. Start again with a lower learning_rate or kl_target",
        recovery::TRIES + 1
    )]
    RanAway {
        /// What was wrong the last time.
        reason: String,
    },
    /// It could not be recorded.
    #[error(transparent)]
    Run(#[from] RunError),
}
