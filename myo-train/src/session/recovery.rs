//! Going back after learning ran away.

use crate::{Checkpoint, TrainError, Trainer, UpdateMetrics};

/// Updates between two states that are kept to go back to.
const EVERY: u64 = 64;

/// By how much steps become shorter each time.
const FACTOR: f64 = 0.25;

/// By how much they may become longer again after as many updates that went well.
const LONGER: f64 = 2.0;

/// How often to go back to the same state before giving up.
pub const TRIES: u32 = 4;

/// The last good state of a training.
#[derive(Debug)]
pub struct Recovery {
    good: Checkpoint,
    tries: u32,
}

impl Recovery {
    /// This state is good.
    pub fn new(good: Checkpoint) -> Self {
        Self::after(good, 0)
    }

    /// This state is good, and the training went back to it so many times.
    pub fn after(good: Checkpoint, tries: u32) -> Self {
        Self { good, tries }
    }

    /// How often the training went back to its good state.
    pub fn tries(&self) -> u32 {
        self.tries
    }

    /// The good state, unless it is this one.
    pub fn good_unless(&self, state: &Checkpoint) -> Option<&Checkpoint> {
        let is_same = self.tries == 0 && self.good.updates() == state.updates();
        (!is_same).then_some(&self.good)
    }

    /// Hears of an update that went well. After so many that the state is good, steps may become longer again, as long as they were allowed to be at first:
    /// a long training runs away now and then, and would end with steps of no length.
    pub fn went_well(&mut self, trainer: &mut Trainer, learning_rate_max: f64) -> Result<(), TrainError> {
        if trainer.updates() >= self.good.updates() + EVERY {
            trainer.allow_longer_steps(LONGER, learning_rate_max);
            *self = Self::new(trainer.save()?);
        }
        Ok(())
    }

    /// What was wrong with an update, if learning ran away in it; other errors are nothing to recover from.
    pub fn what_ran_away(&self, updated: &Result<Option<UpdateMetrics>, TrainError>, kl_max: f64) -> Option<String> {
        match updated {
            Ok(Some(metrics)) if metrics.learn.kl > kl_max => {
                Some(format!("the policy moved by {:.1} nats, more than kl_max {kl_max}", metrics.learn.kl))
            }
            Err(TrainError::Diverged { what, .. }) => Some(format!("{what} was not finite")),
            Err(TrainError::NonFiniteEnv { what, .. }) => {
                Some(format!("the environment returned a NaN or infinite {what}"))
            }
            _ => None,
        }
    }

    /// Goes back to the last good state with shorter steps; false when that was tried often enough.
    pub fn go_back(&mut self, trainer: &mut Trainer) -> Result<bool, TrainError> {
        if self.tries >= TRIES {
            return Ok(false);
        }
        self.tries += 1;
        trainer.go_back(&self.good, FACTOR.powi(self.tries as i32))?;
        Ok(true)
    }
}
