//! Users of many layouts, trained at once on one card.

use std::sync::mpsc;

use myo_env::{BuildError, Tables};
use myo_gpu::GpuError;
use myo_model::Model;
use myo_tasks::Task;
use myo_train::session::{Goal, Outcome, SessionError};
use myo_train::{PpoConfig, Session, TrainError};

use crate::backend::{Device, Envs};

/// Users that are trained at once, at most.
pub const MOST_AT_ONCE: usize = 64;

/// A user to be trained.
#[derive(Clone, Copy, Debug)]
pub struct User<'a> {
    /// What it does.
    pub task: &'a Task,
    /// Seed of everything random.
    pub seed: u64,
}

/// Why users could not be trained at once.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum UsersError {
    /// The card.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The environments.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The trainings.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// The device is the processor, which trains one user after the other.
    #[error("users are trained at once on a graphics card only; train them one after the other")]
    Processor,
}

/// Which users can be trained at once: those whose tasks have one structure and one time limit, at most [`MOST_AT_ONCE`] together.
/// The first of each batch is the one that code is compiled for.
///
/// # Errors
/// A task that cannot be simulated.
pub fn batches(model: &Model, users: &[User<'_>]) -> Result<Vec<Vec<usize>>, BuildError> {
    let mut kinds: Vec<(Tables<f64>, u32, Vec<usize>)> = vec![];
    for (index, user) in users.iter().enumerate() {
        let limit = user.task.time_limit_steps();
        let fits = |(tables, other, _): &(Tables<f64>, u32, Vec<usize>)| {
            *other == limit && tables.clone().set_tasks(std::slice::from_ref(user.task)).is_ok()
        };
        match kinds.iter().position(fits) {
            Some(kind) => kinds[kind].2.push(index),
            None => kinds.push((Tables::new(model, user.task)?, limit, vec![index])),
        }
    }
    Ok(kinds.iter().flat_map(|(.., members)| members.chunks(MOST_AT_ONCE).map(<[usize]>::to_vec)).collect())
}

/// Trains users of one [batch](batches) on a card, each as it would be trained alone, bit for bit. `go_on` is asked now and then by
/// every training; once it says no, all end. The outcomes in the order of the users.
///
/// # Errors
/// The card refuses the batch. What happens to a single training is its outcome.
pub fn train_at_once(
    device: &Device,
    model: &Model,
    users: &[User<'_>],
    config: &PpoConfig,
    goal: Goal,
    go_on: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<Result<Outcome, SessionError>>, UsersError> {
    let Some(first) = users.first() else { return Ok(vec![]) };
    let device = device.for_several(users.len())?.ok_or(UsersError::Processor)?;
    let env = Envs::for_training(&device, model, std::slice::from_ref(first.task), (config, first.seed))?;
    let looks = env.for_looks(first.seed)?;
    let sessions = env.sessions_of(looks, users, config, goal)?;
    let (tell, told) = mpsc::channel();
    std::thread::scope(|scope| {
        for (index, session) in sessions.into_iter().enumerate() {
            let tell = tell.clone();
            // Nobody stops listening before all have told.
            scope.spawn(move || tell.send((index, run(session, go_on))).is_ok());
        }
    });
    drop(tell);
    let mut outcomes: Vec<_> = told.into_iter().collect();
    outcomes.sort_by_key(|(index, _)| *index);
    Ok(outcomes.into_iter().map(|(_, outcome)| outcome).collect())
}

/// A training to its end.
fn run(mut session: Session, go_on: &(dyn Fn() -> bool + Sync)) -> Result<Outcome, SessionError> {
    loop {
        if let Some(end) = session.advance(&|| go_on())?.end {
            return session.conclude(end, &|| go_on());
        }
    }
}
