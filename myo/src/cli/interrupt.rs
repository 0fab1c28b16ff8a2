//! Ctrl-C: the first stops cleanly, the second at once. Signals that this process was started to ignore stay ignored: `nohup`
//! asks that for a closed terminal, and shells for Ctrl-C in background jobs.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::failure::{Failure, Result, complain};

/// Whether the user, or the system, wants this process to stop.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Listens from now on.
    pub fn listen() -> Result<Self> {
        let interrupt = Self::default();
        let ignored = Ignored::now();
        let wanted = interrupt.0.clone();
        let heard = ctrlc::set_handler(move || {
            if wanted.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
            complain("\nstopping after this step; press Ctrl-C again to stop at once");
        });
        heard.map_err(|error| Failure::sentence(format!("cannot listen to Ctrl-C: {error}")))?;
        ignored.go_on();
        Ok(interrupt)
    }

    /// Whether to stop.
    pub fn wanted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Signals that stop a process, but not this one.
#[cfg(unix)]
struct Ignored(Vec<libc::c_int>);

#[cfg(unix)]
impl Ignored {
    /// Those that are ignored now, of those that would stop a training.
    fn now() -> Self {
        let is_ignored = |signal: &libc::c_int| {
            // SAFETY: all zeros is an action, and without a new one the system only writes the present one there.
            unsafe {
                let mut action: libc::sigaction = std::mem::zeroed();
                libc::sigaction(*signal, std::ptr::null(), &raw mut action) == 0 && action.sa_sigaction == libc::SIG_IGN
            }
        };
        Self([libc::SIGHUP, libc::SIGINT, libc::SIGTERM].into_iter().filter(is_ignored).collect())
    }

    /// Ignores them again.
    fn go_on(&self) {
        for signal in &self.0 {
            // SAFETY: no handler of ours is called any more, and that of `ctrlc` need not be called.
            unsafe { libc::signal(*signal, libc::SIG_IGN) };
        }
    }
}

/// Other systems have no ignored signals.
#[cfg(not(unix))]
struct Ignored;

#[cfg(not(unix))]
impl Ignored {
    fn now() -> Self {
        Self
    }

    fn go_on(&self) {}
}
