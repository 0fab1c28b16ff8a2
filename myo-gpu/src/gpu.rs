//! An open device.

use std::ops::Deref;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use crate::adapter::{Adapter, Candidate, candidates};
use crate::adapter_choice::AdapterChoice;
use crate::cache;
use crate::error::GpuError;
use crate::groups::Groups;
use crate::health::{Fault, Health, guarded};
use crate::shelf::Shelf;
use crate::transfer::Staging;

/// An open device. Clones are handles on the same one.
///
/// A device stays open until the process ends, and opening its adapter again gives the same one: drivers hang or crash when
/// a device is closed while another thread ends. The memory of buffers is given back when they are dropped. The last handle
/// waits until the device has done what it was asked, since drivers crash also where the process ends before that.
#[derive(Clone, Debug)]
pub struct Gpu {
    open: Arc<Shared>,
    cache: Option<Arc<Path>>,
    shelf: Arc<Shelf>,
    pub(crate) groups: Option<Groups>,
}

#[derive(Debug)]
struct Open {
    number: usize,
    info: wgpu::AdapterInfo,
    adapter: Adapter,
    limits: wgpu::Limits,
    features: wgpu::Features,
    device: wgpu::Device,
    queue: wgpu::Queue,
    health: Health,
    staging: Mutex<Staging>,
}

/// What the handles of a device share; with the last of them it goes.
#[derive(Debug)]
struct Shared(&'static Open);

impl Deref for Shared {
    type Target = Open;

    fn deref(&self) -> &Open {
        self.0
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        // Nobody is left to be told of a loss.
        _ = guarded(&self.device, &self.health, || self.device.poll(wgpu::PollType::wait_indefinitely()));
    }
}

/// The devices of this process.
static DEVICES: Mutex<Vec<&'static Open>> = Mutex::new(Vec::new());

impl Gpu {
    /// Opens an adapter with all that it can do. Compiled kernels are kept in the folder that the environment variable
    /// `MYO_CACHE_DIR` names, nowhere if it is empty; without it, in `myo` in the user's cache folder.
    ///
    /// # Errors
    /// No adapter, none that is wanted, or the driver does not open it.
    pub fn open(choice: &AdapterChoice) -> Result<Self, GpuError> {
        Self::open_with_cache(choice, cache::default_folder().as_deref())
    }

    /// As [`open`](Self::open), with compiled kernels kept in this folder, or nowhere.
    ///
    /// # Errors
    /// As for [`open`](Self::open); a folder that cannot be written is none, see [`Kernel::cached`](crate::Kernel::cached).
    pub fn open_with_cache(choice: &AdapterChoice, folder: Option<&Path>) -> Result<Self, GpuError> {
        let mut candidates = candidates();
        let adapters: Vec<_> = candidates.iter().map(|candidate| &candidate.adapter).collect();
        let number = choice.choose(&adapters)?;
        let open = find_or_open(number, candidates.swap_remove(number))?;
        Ok(Self { open: Arc::new(Shared(open)), cache: folder.map(Arc::from), shelf: Arc::default(), groups: None })
    }

    /// The same device with other groups.
    pub(crate) fn with_groups(&self, groups: Option<Groups>) -> Self {
        Self { groups, ..self.clone() }
    }

    /// The same device with a shelf of its own, for what lies on this one: it would keep itself alive.
    pub(crate) fn with_own_shelf(&self) -> Self {
        Self { shelf: Arc::default(), ..self.clone() }
    }

    /// The adapter that was opened.
    pub fn adapter(&self) -> &Adapter {
        &self.open.adapter
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// [`GpuError::DeviceLost`].
    pub fn wait(&self) -> Result<(), GpuError> {
        self.wait_for(None)
    }

    /// Waits until this submission is done, or all of them.
    pub(crate) fn wait_for(&self, submission_index: Option<wgpu::SubmissionIndex>) -> Result<(), GpuError> {
        self.guarded(|| self.device().poll(wgpu::PollType::Wait { submission_index, timeout: None }))
            .and_then(|waited| waited.map(|_| ()).map_err(|e| Fault::Refused(e.to_string())))
            .map_err(|fault| fault.during("waiting"))
    }

    /// Refuses to go on once the device is lost.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        self.open.health.check()
    }

    /// Runs calls of wgpu and returns their errors.
    pub(crate) fn guarded<T>(&self, calls: impl FnOnce() -> T) -> Result<T, Fault> {
        guarded(&self.open.device, &self.open.health, calls)
    }

    pub(crate) fn info(&self) -> &wgpu::AdapterInfo {
        &self.open.info
    }

    pub(crate) fn limits(&self) -> &wgpu::Limits {
        &self.open.limits
    }

    pub(crate) fn features(&self) -> wgpu::Features {
        self.open.features
    }

    pub(crate) fn device(&self) -> &wgpu::Device {
        &self.open.device
    }

    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.open.queue
    }

    pub(crate) fn cache_folder(&self) -> Option<&Path> {
        self.cache.as_deref()
    }

    pub(crate) fn shelf(&self) -> &Shelf {
        &self.shelf
    }

    /// The buffer that reading goes through; whoever reads holds the lock.
    pub(crate) fn staging(&self) -> &Mutex<Staging> {
        &self.open.staging
    }
}

/// Used where there; nothing depends on one of them.
const FEATURES: wgpu::Features = wgpu::Features::SUBGROUP
    .union(wgpu::Features::PIPELINE_CACHE)
    .union(wgpu::Features::TIMESTAMP_QUERY)
    .union(wgpu::Features::IMMEDIATES);

/// What kernels with matrix units need.
pub(crate) const MATRIX_FEATURES: wgpu::Features = wgpu::Features::EXPERIMENTAL_COOPERATIVE_MATRIX
    .union(wgpu::Features::SHADER_F16)
    .union(wgpu::Features::SUBGROUP)
    .union(wgpu::Features::SUBGROUP_BARRIER);

/// The open device of an adapter, told from its twins by its number in the list; a new one after a loss.
fn find_or_open(number: usize, candidate: Candidate) -> Result<&'static Open, GpuError> {
    let info = candidate.raw.get_info();
    let mut devices = DEVICES.lock().unwrap_or_else(PoisonError::into_inner);
    let same = |open: &&&Open| open.number == number && open.info == info && open.health.check().is_ok();
    if let Some(open) = devices.iter().find(same) {
        return Ok(open);
    }
    let open = Box::leak(Box::new(Open { number, ..open(candidate)? }));
    devices.push(open);
    Ok(open)
}

fn open(candidate: Candidate) -> Result<Open, GpuError> {
    let Candidate { adapter, raw } = candidate;
    let limits = raw.limits();
    let mut features = raw.features().intersection(FEATURES);
    let mut experimental_features = wgpu::ExperimentalFeatures::disabled();
    if adapter.cooperative_matrix {
        features |= MATRIX_FEATURES;
        // SAFETY: what is experimental are the matrices alone, which only kernels use that are compiled as trusted.
        experimental_features = unsafe { wgpu::ExperimentalFeatures::enabled() };
    }
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("myo"),
        required_features: features,
        required_limits: limits.clone(),
        experimental_features,
        ..wgpu::DeviceDescriptor::default()
    };
    let (device, queue) = pollster::block_on(raw.request_device(&descriptor))
        .map_err(|e| GpuError::Open { adapter: adapter.name.clone(), reason: e.to_string() })?;
    let health = Health::watch(&device);
    let (number, info, staging) = (0, raw.get_info(), Mutex::default());
    Ok(Open { number, info, adapter, limits, features, device, queue, health, staging })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;
    use crate::{Access, Recipe, Source};

    const SHADER: &str = "@group(0) @binding(0) var<storage, read_write> x: array<f32>;
        @compute @workgroup_size(1) fn main(@builtin(workgroup_id) group: vec3<u32>) { x[group.x] = 1.0; }";

    fn recipe() -> Recipe {
        Recipe::new("k", SHADER, [Access::ReadWrite])
    }

    /// What every call says.
    fn calls(gpu: &Gpu) -> Vec<Result<(), GpuError>> {
        let compile = || gpu.compile("k", Source::Wgsl(SHADER), "main", &[Access::ReadWrite]);
        vec![
            gpu.wait(),
            gpu.buffer::<f32>("x", 1).map(drop),
            compile().map(drop),
            gpu.kernel(&recipe()).map(drop),
            gpu.batch().submit(),
            gpu.batch().submit_and_read(&mut []),
        ]
    }

    /// Opens the best adapter, with a device of its own.
    fn alone() -> Option<Gpu> {
        let Some(candidate) = candidates().into_iter().next() else {
            assert_eq!(std::env::var("MYO_NO_GPU").as_deref(), Ok("1"), "no GPU; to skip this, set MYO_NO_GPU=1");
            println!("skipped: MYO_NO_GPU=1, and there is no adapter");
            return None;
        };
        let open = Box::leak(Box::new(open(candidate).unwrap()));
        Some(Gpu { open: Arc::new(Shared(open)), cache: None, shelf: Arc::default(), groups: None })
    }

    fn kernel(gpu: &Gpu) -> crate::Kernel {
        gpu.compile("k", Source::Wgsl(SHADER), "main", &[Access::ReadWrite]).unwrap()
    }

    #[test]
    fn after_a_loss_every_call_says_so() {
        let Some(gpu) = alone() else { return };
        let (x, kernel) = (gpu.buffer::<f32>("x", 1).unwrap(), kernel(&gpu));
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
    }

    #[test]
    fn an_adapter_is_opened_once_and_again_after_a_loss() {
        if alone().is_none() {
            return;
        }
        let [first, second] = [(); 2].map(|()| Gpu::open_with_cache(&AdapterChoice::Any, None).unwrap());
        assert!(std::ptr::eq(first.open.0, second.open.0));
        first.device().destroy();
        assert!(second.wait().is_err());
        let third = Gpu::open_with_cache(&AdapterChoice::Any, None).unwrap();
        assert!(!std::ptr::eq(first.open.0, third.open.0));
        assert!(calls(&third).iter().all(Result::is_ok));
    }

    #[test]
    fn a_recipe_makes_one_kernel_which_goes_with_the_last_handle() {
        let Some(gpu) = alone() else { return };
        let shelf = Arc::downgrade(&gpu.shelf);
        let (clone, kernel) = (gpu.clone(), gpu.kernel(&recipe()).unwrap());
        let in_groups = gpu.in_groups(2).unwrap().kernel(&recipe()).unwrap();
        assert!(in_groups.0.in_groups && !kernel.0.in_groups && gpu.recipes() == 2);
        drop(gpu);
        assert!(Arc::ptr_eq(&kernel.0, &clone.kernel(&recipe()).unwrap().0));
        drop(clone);
        assert_eq!((shelf.strong_count(), Arc::strong_count(&kernel.0)), (0, 1));
    }

    #[test]
    fn the_last_handle_waits_for_what_was_asked() {
        let Some(gpu) = alone() else { return };
        let (x, kernel) = (gpu.buffer::<f32>("x", 1).unwrap(), kernel(&gpu));
        let bindings = kernel.bind(&[x.binding()]).unwrap();
        let mut batch = gpu.batch();
        batch.dispatch(&kernel, &bindings, 1);
        batch.submit().unwrap();
        let done = Arc::new(AtomicBool::new(false));
        gpu.queue().on_submitted_work_done({
            let done = Arc::clone(&done);
            move || done.store(true, Ordering::Relaxed)
        });
        drop((bindings, kernel, x, gpu));
        assert!(done.load(Ordering::Relaxed));
    }

    #[test]
    fn buffers_of_another_device_are_refused() {
        let (Some(gpu), Some(other)) = (alone(), alone()) else { return };
        let elsewhere = other.buffer::<f32>("elsewhere", 64).unwrap();
        let kernel = kernel(&gpu);
        assert!(matches!(kernel.bind(&[elsewhere.binding()]), Err(GpuError::Bind { .. })));
        assert!(matches!(gpu.write(&elsewhere, 0, &[1.0]), Err(GpuError::Refused { .. })));
        assert!(matches!(gpu.read(&elsewhere, 0, &mut [1.0]), Err(GpuError::Refused { .. })));
        gpu.wait().unwrap();
    }
}
