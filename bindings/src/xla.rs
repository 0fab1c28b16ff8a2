//! Steps inside programs of XLA, without Python: a handler of its foreign function interface.
//!
//! XLA refuses a handler of a version that it does not know when it is registered, and `myoenv.jax` then calls back to
//! Python.

mod api;

use std::collections::BTreeMap;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use pyo3::prelude::*;

use crate::batch::{Batch, Live, Shown, Token};
use api::{CallFrame, Handler};

/// Environments by their numbers. A compiled program outlives them, so it has no pointer to them.
static ENVS: Mutex<BTreeMap<i64, Weak<Batch>>> = Mutex::new(BTreeMap::new());

/// The number of environments, the same each time.
pub fn id_of(batch: &Arc<Batch>) -> i64 {
    let mut envs = ENVS.lock().unwrap_or_else(PoisonError::into_inner);
    envs.retain(|_, batch| batch.strong_count() > 0);
    let known = envs.iter().find(|(_, other)| std::ptr::eq(other.as_ptr(), Arc::as_ptr(batch)));
    if let Some((&id, _)) = known {
        return id;
    }
    // Numbers are not used again: an old program must not step other environments.
    static NEXT: AtomicI64 = AtomicI64::new(1);
    let id = NEXT.fetch_add(1, Ordering::Relaxed);
    envs.insert(id, Arc::downgrade(batch));
    id
}

/// Address of the handler that steps environments, for `jax.ffi.pycapsule`.
#[pyfunction]
pub fn xla_step_handler() -> usize {
    let handler: Handler = step_handler;
    handler as usize
}

/// What XLA calls: before any program with all arguments empty, to hear of the version, then once per step.
unsafe extern "C" fn step_handler(frame: *mut CallFrame) -> *mut c_void {
    // SAFETY: XLA passes a frame that lives until the return.
    let frame = unsafe { &*frame };
    // SAFETY: as XLA made it.
    if unsafe { frame.tell_version() } {
        return null_mut();
    }
    // SAFETY: as XLA made it.
    let outcome = catch_unwind(AssertUnwindSafe(|| unsafe { execute(frame) }));
    match outcome.unwrap_or_else(|_| Err("internal error in a step, please report it".into())) {
        Ok(()) => null_mut(),
        // SAFETY: as XLA made it.
        Err(message) => unsafe { frame.error(&message) },
    }
}

/// The environments of a number.
fn environments(id: Option<i64>) -> Result<Arc<Batch>, String> {
    let id = id.ok_or("a step has one attribute, the number of its environments")?;
    let envs = ENVS.lock().unwrap_or_else(PoisonError::into_inner);
    envs.get(&id).and_then(Weak::upgrade).ok_or_else(|| "the environment is gone; make a new one".into())
}

/// `(token, action)` to `(token, observation, next observation, reward, terminated, truncated, summary)`; the summary is
/// `(episode_size, num_envs)`, zero where no episode ended.
///
/// # Safety
/// XLA made the frame.
unsafe fn execute(frame: &CallFrame) -> Result<(), String> {
    if !frame.is_execution() {
        return Ok(());
    }
    // SAFETY: as the caller says, and this is the execution.
    let (batch, ([token, action], results)) = unsafe { (environments(frame.only_number())?, frame.arrays::<2, 7>()?) };
    let spec = &batch.spec;
    let (n, width) = (spec.num_envs, spec.observation_size());
    let [next_token, observation, next_observation, reward, terminated, truncated, summary] = results;
    // SAFETY: arguments of an execution.
    let (token, action) = unsafe { (token.read::<i32>(2)?, action.read::<f32>(n * spec.action_size())?) };
    // SAFETY: results of an execution, each asked for once.
    let (next_token, shown, next_observation, summary) = unsafe {
        let shown = Shown {
            observation: observation.write(n * width)?,
            reward: reward.write(n)?,
            terminated: terminated.write(n)?,
            truncated: truncated.write(n)?,
        };
        (next_token.write(2)?, shown, next_observation.write(n * width)?, summary.write(spec.episode_size() * n)?)
    };
    let mut opened = batch.open().map_err(|error| error.to_string())?;
    let live = opened.live();
    next_token.copy_from_slice(&step(live, [token[0], token[1]], action, shown, next_observation, summary)?);
    Ok(())
}

fn step(
    live: &mut Live,
    token: Token,
    action: &[f32],
    shown: Shown<'_>,
    next_observation: &mut [f32],
    summary: &mut [f32],
) -> Result<Token, String> {
    live.check_token(token)?;
    let Shown { observation, reward, terminated, truncated } = shown;
    let again =
        Shown { observation: &mut *observation, reward, terminated: &mut *terminated, truncated: &mut *truncated };
    live.step(action, again).map_err(|error| error.to_string())?;
    next_observation.copy_from_slice(observation);
    let n = terminated.len();
    let (width, columns) = (observation.len() / n, summary.len() / n);
    for env in (0..n).filter(|&env| terminated[env] || truncated[env]) {
        next_observation[env * width..][..width].copy_from_slice(&live.final_observation[env * width..][..width]);
        for (column, x) in live.episode[env * columns..][..columns].iter().enumerate() {
            summary[column * n + env] = *x;
        }
    }
    Ok(live.token())
}
