//! Bodies and what they reach, made once each: too slow for every change of a task.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use myo_lab::{ModelReach, describe_model};
use myo_model::Model;
use myo_tasks::Task;

use crate::protocol::Refusal;

/// What differs between bodies: the model, and in words what its user changes of it.
type Of = (String, String);

/// Bodies that were asked for.
#[derive(Default)]
pub struct Bodies {
    models: Mutex<HashMap<Of, Arc<Model>>>,
    /// By the body and what points, in words.
    reaches: Mutex<HashMap<(Of, String), Arc<ModelReach>>>,
}

impl Bodies {
    /// The body of a task's user.
    ///
    /// # Errors
    /// There is no such model, it cannot be simulated, or cannot become that body.
    pub fn of(&self, task: &Task) -> Result<Arc<Model>, Refusal> {
        let (name, body) = (&*task.model, &task.body);
        let made = || Ok(Arc::new(body.of(&describe_model(name)?)?));
        // The file of a model may change.
        if !myo_model::builtin_names().contains(&name) {
            return made();
        }
        kept(&self.models, (name.to_owned(), body.words()), made)
    }

    /// What the pointer of a task reaches.
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub fn reach(&self, task: &Task) -> Result<Arc<ModelReach>, Refusal> {
        let model = self.of(task)?;
        let made = || Ok(Arc::new(ModelReach::for_task(&model, task)?));
        let pointer = match task.flat() {
            Ok(flat) => format!("{:?}", flat.pointer),
            Err(_) => String::new(),
        };
        // Where a ray meets a display depends on the display.
        let on_a_face = !task.technique.is_fingertip();
        if on_a_face || !myo_model::builtin_names().contains(&&*task.model) {
            return made();
        }
        kept(&self.reaches, ((task.model.clone(), task.body.words()), pointer), made)
    }
}

/// What is kept under a key, or what is made for it now.
fn kept<K: Eq + std::hash::Hash, V>(
    shelf: &Mutex<HashMap<K, Arc<V>>>,
    key: K,
    make: impl FnOnce() -> Result<Arc<V>, Refusal>,
) -> Result<Arc<V>, Refusal> {
    let mut shelf = shelf.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(kept) = shelf.get(&key) {
        return Ok(Arc::clone(kept));
    }
    let made = make()?;
    shelf.insert(key, Arc::clone(&made));
    Ok(made)
}
