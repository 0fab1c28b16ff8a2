//! An open device.

use std::sync::{Arc, Mutex};

use crate::adapter::{Adapter, Candidate, candidates};
use crate::error::GpuError;
use crate::health::{Fault, Health, guarded};
use crate::transfer::Staging;
use crate::want::Want;

/// An open device. Clones are handles on the same one; it closes with the last of them.
#[derive(Clone, Debug)]
pub struct Gpu(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    adapter: Adapter,
    info: wgpu::AdapterInfo,
    limits: wgpu::Limits,
    features: wgpu::Features,
    device: wgpu::Device,
    queue: wgpu::Queue,
    health: Health,
    staging: Mutex<Staging>,
}

impl Gpu {
    /// Opens an adapter with all that it can do.
    ///
    /// # Errors
    /// No adapter, none that is wanted, or the driver does not open it.
    pub fn open(want: &Want) -> Result<Self, GpuError> {
        let mut candidates = candidates();
        let adapters: Vec<_> = candidates.iter().map(|candidate| &candidate.adapter).collect();
        let chosen = want.choose(&adapters)?;
        open(candidates.swap_remove(chosen))
    }

    /// The adapter that was opened.
    pub fn adapter(&self) -> &Adapter {
        &self.0.adapter
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// [`GpuError::DeviceLost`].
    pub fn wait(&self) -> Result<(), GpuError> {
        self.guarded(|| self.device().poll(wgpu::PollType::wait_indefinitely()))
            .and_then(|waited| waited.map(|_| ()).map_err(|e| Fault::Refused(e.to_string())))
            .map_err(|fault| fault.during("waiting"))
    }

    /// Runs calls of wgpu and returns their errors.
    pub(crate) fn guarded<T>(&self, calls: impl FnOnce() -> T) -> Result<T, Fault> {
        guarded(&self.0.device, &self.0.health, calls)
    }

    pub(crate) fn info(&self) -> &wgpu::AdapterInfo {
        &self.0.info
    }

    pub(crate) fn limits(&self) -> &wgpu::Limits {
        &self.0.limits
    }

    pub(crate) fn features(&self) -> wgpu::Features {
        self.0.features
    }

    pub(crate) fn device(&self) -> &wgpu::Device {
        &self.0.device
    }

    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.0.queue
    }

    /// The buffer that reading goes through; whoever reads holds the lock.
    pub(crate) fn staging(&self) -> &Mutex<Staging> {
        &self.0.staging
    }
}

/// Used where there; nothing depends on one of them.
const FEATURES: wgpu::Features = wgpu::Features::SUBGROUP
    .union(wgpu::Features::PIPELINE_CACHE)
    .union(wgpu::Features::TIMESTAMP_QUERY)
    .union(wgpu::Features::IMMEDIATES);

fn open(candidate: Candidate) -> Result<Gpu, GpuError> {
    let Candidate { adapter, raw } = candidate;
    let (limits, features) = (raw.limits(), raw.features().intersection(FEATURES));
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("myo"),
        required_features: features,
        required_limits: limits.clone(),
        ..wgpu::DeviceDescriptor::default()
    };
    let (device, queue) = pollster::block_on(raw.request_device(&descriptor))
        .map_err(|e| GpuError::Open { adapter: adapter.name.clone(), reason: e.to_string() })?;
    let health = Health::watch(&device);
    let (info, staging) = (raw.get_info(), Mutex::default());
    Ok(Gpu(Arc::new(Inner { adapter, info, limits, features, device, queue, health, staging })))
}
