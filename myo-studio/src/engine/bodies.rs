//! Bodies and what they reach, made once each: too slow for every change of a task.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use myo_lab::{ModelReach, describe_model};
use myo_model::Model;
use myo_tasks::Task;

use crate::protocol::Refusal;

/// Bodies that were asked for.
#[derive(Default)]
pub struct Bodies {
    models: Mutex<HashMap<String, Arc<Model>>>,
    /// By the model and what points, in words.
    reaches: Mutex<HashMap<(String, String), Arc<ModelReach>>>,
}

impl Bodies {
    /// A model by its name or file.
    ///
    /// # Errors
    /// There is none, or it cannot be simulated.
    pub fn model(&self, name: &str) -> Result<Arc<Model>, Refusal> {
        let made = || Ok(Arc::new(Model::new(&describe_model(name)?)?));
        // The file of a model may change.
        if !myo_model::builtin_names().contains(&name) {
            return made();
        }
        kept(&self.models, name.to_owned(), made)
    }

    /// What the pointer of a task reaches.
    ///
    /// # Errors
    /// As for [`model`](Self::model).
    pub fn reach(&self, task: &Task) -> Result<Arc<ModelReach>, Refusal> {
        let model = self.model(&task.model)?;
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
        kept(&self.reaches, (task.model.clone(), pointer), made)
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
