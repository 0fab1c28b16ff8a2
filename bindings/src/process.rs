//! Threads and forks: what was started in one process is gone in its children.

use std::mem::ManuallyDrop;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error::ForkedError;

/// The process in which something was made.
#[derive(Clone, Copy, Debug)]
pub struct Birthplace(u32);

impl Birthplace {
    /// This process.
    pub fn here() -> Self {
        Self(std::process::id())
    }

    /// Refuses another process.
    pub fn check(self, what: &str) -> PyResult<()> {
        if self.is_here() {
            return Ok(());
        }
        Err(ForkedError::new_err(format!(
            "{what} was made before this process was forked, and its threads did not follow; make it in the process that uses it"
        )))
    }

    /// Whether this is the process.
    pub fn is_here(self) -> bool {
        self.0 == std::process::id()
    }
}

/// A pool and the process that its threads live in. Never dropped: in a forked child there are no threads to stop.
static POOL: Mutex<Option<(u32, ManuallyDrop<Arc<ThreadPool>>)>> = Mutex::new(None);

/// The threads of this process, one per processor; a forked child gets new ones.
pub fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match &*pool {
        Some((process, threads)) if *process == std::process::id() => Ok(Arc::clone(threads)),
        _ => {
            let threads = own_pool(None)?;
            *pool = Some((std::process::id(), ManuallyDrop::new(Arc::clone(&threads))));
            Ok(threads)
        }
    }
}

/// A pool of this many new threads; without a number, one per processor.
pub fn own_pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let built = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    built.map(Arc::new).map_err(|error| PyRuntimeError::new_err(format!("threads could not be started: {error}")))
}

/// Refuses graphics cards in a child of a process that opened one: drivers do not survive a fork.
pub fn check_gpu_process() -> PyResult<()> {
    static FIRST: OnceLock<Birthplace> = OnceLock::new();
    FIRST.get_or_init(Birthplace::here).check("the graphics card")
}
