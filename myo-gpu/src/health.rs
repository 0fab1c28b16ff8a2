//! Whether the device still works, and errors as values.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, OnceLock};

use crate::error::GpuError;

/// Remembers why a device stopped; every call asks it first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Health(Arc<OnceLock<String>>);

impl Health {
    /// Listens to what the driver says outside of any call.
    pub fn watch(device: &wgpu::Device) -> Self {
        let health = Self::default();
        let (lost, uncaptured) = (health.clone(), health.clone());
        device.set_device_lost_callback(move |cause, message| _ = lost.lose(format!("{cause:?}, {message}")));
        // Every call catches its own errors; one that comes in between leaves the device in a state nobody knows.
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| _ = uncaptured.lose(error.to_string())));
        health
    }

    /// Refuses to go on once the device is lost.
    pub fn check(&self) -> Result<(), GpuError> {
        match self.0.get() {
            Some(reason) => Err(GpuError::DeviceLost { reason: reason.clone() }),
            None => Ok(()),
        }
    }

    /// Remembers the first reason, and says it.
    pub fn lose(&self, reason: String) -> GpuError {
        let reason = self.0.get_or_init(|| reason.trim_end_matches(['.', ' ', '\n', ',']).to_owned());
        GpuError::DeviceLost { reason: reason.clone() }
    }
}

/// Why a guarded call failed.
pub(crate) enum Fault {
    /// No memory left.
    OutOfMemory,
    /// The call is wrong; the message says how.
    Refused(String),
    /// The device is gone.
    Lost(GpuError),
}

impl Fault {
    /// Names the call that failed.
    pub fn during(self, what: &str) -> GpuError {
        match self {
            Self::OutOfMemory => GpuError::OutOfMemory { what: what.to_owned() },
            Self::Refused(reason) => GpuError::Refused { what: what.to_owned(), reason },
            Self::Lost(error) => error,
        }
    }
}

/// Runs calls of wgpu and returns what they report otherwise through handlers or, on a lost device, a panic.
pub(crate) fn guarded<T>(device: &wgpu::Device, health: &Health, calls: impl FnOnce() -> T) -> Result<T, Fault> {
    use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
    health.check().map_err(Fault::Lost)?;
    let scopes = [OutOfMemory, Internal, Validation].map(|filter| device.push_error_scope(filter));
    let outcome = catch_unwind(AssertUnwindSafe(calls));
    let [memory, internal, validation] = scopes;
    let errors = [validation, internal, memory].map(|scope| pollster::block_on(scope.pop()));
    health.check().map_err(Fault::Lost)?;
    if let Some(error) = errors.into_iter().flatten().next() {
        return Err(fault(error));
    }
    outcome.map_err(|panic| Fault::Lost(health.lose(message(&*panic))))
}

/// What a panic says.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("the driver failed").to_owned()
}

fn fault(error: wgpu::Error) -> Fault {
    match error {
        wgpu::Error::OutOfMemory { .. } => Fault::OutOfMemory,
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            Fault::Refused(description.trim().to_owned())
        }
    }
}
