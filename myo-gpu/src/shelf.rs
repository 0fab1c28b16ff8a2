//! Kernels that are compiled once for all who ask for them.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::kernel::Kernel;
use crate::recipe::Recipe;

/// The place of a kernel, empty until it is compiled; whoever compiles it holds the lock.
type Place = Arc<Mutex<Option<Kernel>>>;

/// Kernels by their recipes and by whether they run for several groups. It lives as long as a handle of the device that it
/// belongs to.
#[derive(Debug, Default)]
pub(crate) struct Shelf(Mutex<HashMap<(Recipe, bool), Place>>);

impl Shelf {
    fn place(&self, recipe: &Recipe, in_groups: bool) -> Place {
        Arc::clone(lock(&self.0).entry((recipe.clone(), in_groups)).or_default())
    }
}

impl Gpu {
    /// The kernel of a recipe: compiled when this handle, or a clone of it, is asked for it first, and found from then on. One
    /// that another thread is compiling is waited for, so kernels can be asked for side by side before they are needed.
    ///
    /// # Errors
    /// As for [`compile`](Self::compile), for everyone who asks.
    pub fn kernel(&self, recipe: &Recipe) -> Result<Kernel, GpuError> {
        self.check()?;
        let place = self.shelf().place(recipe, self.groups() > 1);
        let mut kernel = lock(&place);
        match &*kernel {
            Some(kernel) => Ok(kernel.clone()),
            None => Ok(kernel.insert(recipe.compile(&self.with_own_shelf())?).clone()),
        }
    }

    /// How many recipes this handle and its clones were asked for the kernels of.
    pub fn recipes(&self) -> usize {
        lock(&self.shelf().0).len()
    }
}

/// A panic of another thread leaves a place as it was.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
