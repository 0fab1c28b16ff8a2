//! A user who has learnt to be anybody, asked to move as a person does.

use myo_model::Model;
use myo_tasks::Task;
use myo_train::Checkpoint;
use myo_train::session::evaluation_seed;
use rayon::prelude::*;

use super::muscles::Recorded;
use super::search::compared;
use super::{Aim, Fitted, FittingError, MOST_TRAININGS, Nature, aims};
use crate::recordings::Participant;

/// Episodes of each pair of distance and width in a fit, of thirteen movements each.
const EPISODES: usize = 4;

/// The user who can be anybody, in one training or in several.
pub struct Anybody {
    checkpoints: Vec<Checkpoint>,
    model: Model,
    task: Task,
}

/// Why a fit came to no end.
enum End {
    Refused(Box<FittingError>),
    Stopped,
}

impl From<FittingError> for End {
    fn from(error: FittingError) -> Self {
        Self::Refused(Box::new(error))
    }
}

impl Anybody {
    /// Who learnt the layouts of [`practice`](super::practice()) of a task, up to these checkpoints of trainings that differ in their seeds alone, on this body.
    ///
    /// # Errors
    /// There is no checkpoint, or there are more than [`MOST_TRAININGS`].
    pub fn new(checkpoints: Vec<Checkpoint>, model: Model, task: Task) -> Result<Self, FittingError> {
        match checkpoints.len() {
            0 => Err(FittingError::NoUser),
            count if count > MOST_TRAININGS => Err(FittingError::TooMany { count }),
            _ => Ok(Self { checkpoints, model, task }),
        }
    }

    /// What it is like before it becomes somebody else.
    pub fn nature(&self) -> Nature {
        Nature::of(&self.task)
    }

    /// Muscles of its body.
    pub fn muscles(&self) -> Vec<String> {
        self.model.muscles.iter().map(|muscle| muscle.name.clone()).collect()
    }

    /// Movements of natures of the first training at targets of pairs of distance and width (m), in so many episodes of each, with seeds made of this one, and the activations of
    /// muscles of these numbers.
    ///
    /// # Errors
    /// The policy has not learnt to be anybody.
    pub fn aims(
        &self,
        natures: &[Nature],
        compared: (&[[f64; 2]], &[usize]),
        asked: (usize, u64),
    ) -> Result<Vec<Vec<Aim>>, FittingError> {
        let natures: Vec<_> = natures.iter().map(|&nature| (nature, 0)).collect();
        self.always(&natures, compared, asked)
    }

    /// What natures of these trainings do, whatever comes.
    fn always(
        &self,
        natures: &[(Nature, usize)],
        compared: (&[[f64; 2]], &[usize]),
        asked: (usize, u64),
    ) -> Result<Vec<Vec<Aim>>, FittingError> {
        match self.aims_while(natures, compared, asked, &|| true) {
            Ok(all) => Ok(all),
            Err(End::Refused(error)) => Err(*error),
            // Nobody says no.
            Err(End::Stopped) => Ok(vec![]),
        }
    }

    /// The user who comes nearest to a person, or nobody once `go_on` says no; it is asked before each nature.
    ///
    /// # Errors
    /// As [`Fitted::of`]; muscles were recorded that the body has not, or what was recorded cannot be measured.
    pub fn fitted(
        &self,
        person: &Participant,
        seed: u64,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Fitted>, FittingError> {
        let asked = (EPISODES, seed);
        let (Recorded { names, numbers }, movements) = compared(person, &self.model)?;
        let fitted = Fitted::of((&person.name, &movements), &names, self.beginning(), |natures, pairs| {
            self.aims_while(natures, (pairs, &numbers), asked, go_on)
        });
        match fitted {
            Ok(fitted) => Ok(Some(fitted)),
            Err(End::Refused(error)) => Err(*error),
            Err(End::Stopped) => Ok(None),
        }
    }

    /// The same by movements of theirs, which have the activations of muscles of these numbers.
    ///
    /// # Errors
    /// As [`Fitted::of`].
    pub fn nearest(&self, who: &str, movements: &[Aim], muscles: &[usize], seed: u64) -> Result<Fitted, FittingError> {
        let names: Vec<String> = muscles.iter().map(|&muscle| self.model.muscles[muscle].name.clone()).collect();
        Fitted::of((who, movements), &names, self.beginning(), |natures, pairs| {
            self.always(natures, (pairs, muscles), (EPISODES, seed))
        })
    }

    /// Who it is before, in how many trainings.
    fn beginning(&self) -> (Nature, usize) {
        (self.nature(), self.checkpoints.len())
    }

    fn aims_while(
        &self,
        natures: &[(Nature, usize)],
        compared: (&[[f64; 2]], &[usize]),
        (episodes, seed): (usize, u64),
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Vec<Vec<Aim>>, End> {
        let of_nature = |(number, (nature, training)): (usize, &(Nature, usize))| {
            if !go_on() {
                return Err(End::Stopped);
            }
            let asked = (episodes, evaluation_seed(seed, number as u64));
            Ok(aims(&mut self.checkpoints[*training].policy(), &self.model, (&self.task, *nature), compared, asked)?)
        };
        natures.par_iter().enumerate().map(of_nature).collect()
    }
}
