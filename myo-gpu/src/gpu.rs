//! An open device.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use crate::adapter::{Adapter, Candidate, candidates};
use crate::cache;
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
    cache: Option<PathBuf>,
    staging: Mutex<Staging>,
}

impl Gpu {
    /// Opens an adapter with all that it can do. Compiled kernels are kept in the folder that the environment variable
    /// `MYO_CACHE_DIR` names, nowhere if it is empty; without it, in `myo` in the user's cache folder.
    ///
    /// # Errors
    /// No adapter, none that is wanted, or the driver does not open it.
    pub fn open(want: &Want) -> Result<Self, GpuError> {
        Self::open_with_cache(want, cache::default_folder())
    }

    /// As [`open`](Self::open), with compiled kernels kept in this folder, or nowhere.
    ///
    /// # Errors
    /// As for [`open`](Self::open); a folder that cannot be written is none, see [`Kernel::cached`](crate::Kernel::cached).
    pub fn open_with_cache(want: &Want, folder: Option<PathBuf>) -> Result<Self, GpuError> {
        let mut candidates = candidates();
        let adapters: Vec<_> = candidates.iter().map(|candidate| &candidate.adapter).collect();
        let chosen = want.choose(&adapters)?;
        open(candidates.swap_remove(chosen), folder)
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

    pub(crate) fn cache_folder(&self) -> Option<&Path> {
        self.0.cache.as_deref()
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

fn open(candidate: Candidate, cache: Option<PathBuf>) -> Result<Gpu, GpuError> {
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
    Ok(Gpu(Arc::new(Inner { adapter, info, limits, features, device, queue, health, cache, staging })))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Access, Source};

    const SHADER: &str = "@group(0) @binding(0) var<storage, read_write> x: array<f32>;
        @compute @workgroup_size(1) fn main() { x[0] = 1.0; }";

    /// What every call says.
    fn calls(gpu: &Gpu) -> Vec<Result<(), GpuError>> {
        let compile = || gpu.compile("k", Source::Wgsl(SHADER), "main", &[Access::ReadWrite]);
        vec![
            gpu.wait(),
            gpu.buffer::<f32>("x", 1).map(drop),
            compile().map(drop),
            gpu.batch().submit(),
            gpu.batch().submit_and_read(&mut []),
        ]
    }

    #[test]
    fn after_a_loss_every_call_says_so() {
        let Ok(gpu) = Gpu::open_with_cache(&Want::Any, None) else {
            assert_eq!(std::env::var("MYO_NO_GPU").as_deref(), Ok("1"), "no GPU; to skip this, set MYO_NO_GPU=1");
            return;
        };
        let x = gpu.buffer::<f32>("x", 1).unwrap();
        let kernel = gpu.compile("k", Source::Wgsl(SHADER), "main", &[Access::ReadWrite]).unwrap();
        let bindings = kernel.bind(&[x.binding()]).unwrap();
        let mut begun = gpu.batch();
        begun.dispatch(&kernel, &bindings, 1);
        assert!(calls(&gpu).iter().all(Result::is_ok));

        gpu.device().destroy();
        let lost = |result: &Result<(), GpuError>| matches!(result, Err(GpuError::DeviceLost { .. }));
        assert!(calls(&gpu).iter().all(lost), "{:?}", calls(&gpu));
        begun.dispatch(&kernel, &bindings, 1);
        let more = [
            begun.submit(),
            gpu.write(&x, 0, &[1.0]),
            gpu.read(&x, 0, &mut [0.0]),
            kernel.bind(&[x.binding()]).map(drop),
            gpu.batch().timed().map(drop),
        ];
        assert!(more.iter().all(lost), "{more:?}");
        assert!(gpu.wait().unwrap_err().to_string().starts_with("the GPU was lost: "), "{:?}", gpu.wait());
        let again = Gpu::open_with_cache(&Want::Any, None).unwrap();
        assert!(calls(&again).iter().all(Result::is_ok));
    }
}
