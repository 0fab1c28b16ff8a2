//! Long work that Ctrl-C and other signals end early.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error::panicked;

/// Time between two checks for signals: short for someone waiting, negligible beside an update.
const BETWEEN_LOOKS: Duration = Duration::from_millis(20);

/// Runs Rust code in a pool, without the interpreter, while this thread lets Python handle signals. `work` is given a function
/// that tells whether to go on: false once a handler has raised an exception, as the one for Ctrl-C does.
///
/// Returns what `work` returned, and the exception, which the caller must raise or answer. A panic is an exception like others.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    pool: &ThreadPool,
    work: impl FnOnce(&(dyn Fn() -> bool + Sync)) -> T + Send,
) -> PyResult<(T, Option<PyErr>)> {
    let stop = AtomicBool::new(false);
    let (sender, mut receiver) = mpsc::sync_channel::<Result<T, Box<dyn Any + Send>>>(1);
    let mut raised = None;
    let done = pool.in_place_scope(|scope| {
        let stop = &stop;
        scope.spawn(move |_| {
            let go_on = || !stop.load(Ordering::Relaxed);
            // Nobody stops receiving before it is sent.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(|| work(&go_on))));
        });
        loop {
            let receiver = &mut receiver;
            match py.detach(move || receiver.recv_timeout(BETWEEN_LOOKS)) {
                Ok(done) => break done,
                Err(_) => {
                    if let Err(error) = py.check_signals() {
                        stop.store(true, Ordering::Relaxed);
                        raised.get_or_insert(error);
                    }
                }
            }
        }
    });
    Ok((done.map_err(|panic| panicked(&*panic))?, raised))
}
