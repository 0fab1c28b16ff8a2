//! Who listens. A listener that is slow or gone holds nobody up: it loses what it cannot take.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use crate::protocol::{Event, Message, MotionHeader};

/// Messages that a listener may be behind.
const BEHIND: usize = 256;

/// Tells all listeners.
#[derive(Default)]
pub struct Hub {
    listeners: Mutex<Vec<Listener>>,
}

struct Listener {
    to: SyncSender<Arc<Message>>,
    wake: Box<dyn Fn() + Send>,
    has_lost: Arc<AtomicBool>,
}

/// The ear of a listener.
pub struct Ear {
    from: Receiver<Arc<Message>>,
    has_lost: Arc<AtomicBool>,
}

impl Ear {
    /// What there is to hear now, first to last.
    pub fn hear(&self) -> Option<Arc<Message>> {
        self.from.try_recv().ok()
    }

    /// Whether something was lost since this was asked last: the whole state must be told again.
    pub fn has_lost(&self) -> bool {
        self.has_lost.swap(false, Ordering::Relaxed)
    }
}

impl Hub {
    /// One more listener. `wake` is called when there is something to hear: it must not wait for anybody.
    pub fn listen(&self, wake: impl Fn() + Send + 'static) -> Ear {
        let (to, from) = sync_channel(BEHIND);
        let has_lost = Arc::new(AtomicBool::new(false));
        self.listeners().push(Listener { to, wake: Box::new(wake), has_lost: Arc::clone(&has_lost) });
        Ear { from, has_lost }
    }

    fn listeners(&self) -> std::sync::MutexGuard<'_, Vec<Listener>> {
        self.listeners.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether anybody listens.
    pub fn has_listeners(&self) -> bool {
        !self.listeners().is_empty()
    }

    /// Tells an event.
    pub fn tell(&self, event: &Event) {
        if let Ok(text) = serde_json::to_string(event) {
            self.send(Message::Text(text));
        }
    }

    /// Shows a motion.
    pub fn show(&self, header: MotionHeader, numbers: Vec<f32>) {
        self.send(Message::Motion(header, numbers));
    }

    fn send(&self, message: Message) {
        let message = Arc::new(message);
        self.listeners().retain(|listener| match listener.to.try_send(Arc::clone(&message)) {
            Ok(()) => {
                (listener.wake)();
                true
            }
            Err(TrySendError::Full(_)) => {
                listener.has_lost.store(true, Ordering::Relaxed);
                true
            }
            Err(TrySendError::Disconnected(_)) => false,
        });
    }
}
