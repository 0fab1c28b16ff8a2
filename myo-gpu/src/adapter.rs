//! The graphics cards of this machine, each listed once.

use std::sync::LazyLock;

use serde::Serialize;

use crate::gpu::MATRIX_FEATURES;

/// What kind of device does the work. The order is the order of preference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[cfg_attr(test, derive(Default))]
#[serde(rename_all = "lowercase")]
pub enum AdapterKind {
    /// A card with memory of its own.
    #[cfg_attr(test, default)]
    Discrete,
    /// Part of the processor, sharing its memory.
    Integrated,
    /// Seen through a virtual machine, or the driver does not say what it is.
    Virtual,
    /// The processor itself, imitating a card.
    Software,
}

/// One device that can run kernels.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(Default))]
#[non_exhaustive]
pub struct Adapter {
    /// As the driver calls it.
    pub name: String,
    /// Name and version of the driver.
    pub driver: String,
    /// The interface it is reached through: `vulkan`, `metal` or `dx12`.
    pub backend: String,
    /// What it is.
    pub kind: AdapterKind,
    /// Memory of its own, in bytes, all programs together; none where the interface does not tell, which Vulkan does. How
    /// much of it is free shows only when it is used up.
    pub memory_bytes: Option<u64>,
    /// Greatest buffer, in bytes.
    pub max_buffer_bytes: u64,
    /// Greatest part of a buffer that a kernel can use, in bytes.
    pub max_binding_bytes: u64,
    /// Greatest number of threads in a workgroup.
    pub max_workgroup_threads: u32,
    /// Memory that a workgroup can share, in bytes.
    pub max_workgroup_bytes: u32,
    /// Threads can exchange values within a subgroup.
    pub subgroups: bool,
    /// Threads that run as one, at least.
    pub min_subgroup_threads: u32,
    /// Kernels can calculate in 16-bit floats.
    pub f16: bool,
    /// Subgroups of 32 threads can multiply matrices of 16 x 16 numbers of 16 bits and sum them up in 32 bits.
    pub cooperative_matrix: bool,
    /// Compiled kernels can be kept on disk.
    pub pipeline_cache: bool,
    /// Kernels can be timed on the device.
    pub timestamps: bool,
}

/// All adapters of this machine, best first: cards, then integrated, virtual and software devices. Empty without a driver.
///
/// A card that several interfaces reach is listed once, through Vulkan if possible, then Metal, then Direct3D 12.
pub fn adapters() -> Vec<Adapter> {
    candidates().into_iter().map(|candidate| candidate.adapter).collect()
}

/// An adapter with what is needed to open it.
pub(crate) struct Candidate {
    pub adapter: Adapter,
    pub raw: wgpu::Adapter,
}

/// What [`adapters`] lists, ready to be opened.
pub(crate) fn candidates() -> Vec<Candidate> {
    let raw = pollster::block_on(INSTANCE.enumerate_adapters(BACKENDS));
    let infos: Vec<_> = raw.iter().map(wgpu::Adapter::get_info).collect();
    let mut candidates: Vec<_> = raw
        .into_iter()
        .enumerate()
        .filter(|(i, raw)| runs_kernels(raw) && !is_duplicate(*i, &infos))
        .map(|(i, raw)| Candidate { adapter: describe(&infos[i], &raw), raw })
        .collect();
    candidates.sort_by_key(|candidate| candidate.adapter.kind);
    candidates
}

const BACKENDS: wgpu::Backends = wgpu::Backends::VULKAN.union(wgpu::Backends::METAL).union(wgpu::Backends::DX12);

/// The same for all devices: only then are buffers of another device told apart.
///
/// Without validation layers of the system unless `WGPU_VALIDATION=1` asks for them: wgpu checks every call itself.
static INSTANCE: LazyLock<wgpu::Instance> = LazyLock::new(|| {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: BACKENDS,
        flags: wgpu::InstanceFlags::empty().with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
});

fn runs_kernels(raw: &wgpu::Adapter) -> bool {
    raw.get_downlevel_capabilities().flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
}

/// Whether a better interface, or the same one before, lists the same card.
fn is_duplicate(i: usize, infos: &[wgpu::AdapterInfo]) -> bool {
    infos.iter().enumerate().any(|(k, other)| {
        let (this, k_first) = (&infos[i], k < i);
        match rank(other.backend).cmp(&rank(this.backend)) {
            // Every driver of an interface lists all cards of a model, so the model is enough, also for twins.
            std::cmp::Ordering::Less => (other.vendor, other.device) == (this.vendor, this.device),
            // Two drivers of one interface for one card.
            std::cmp::Ordering::Equal => {
                k_first && !this.device_pci_bus_id.is_empty() && other.device_pci_bus_id == this.device_pci_bus_id
            }
            std::cmp::Ordering::Greater => false,
        }
    })
}

/// Order of preference of the interfaces. Direct3D comes last: its own compiler is slow on large kernels.
fn rank(backend: wgpu::Backend) -> u8 {
    match backend {
        wgpu::Backend::Vulkan => 0,
        wgpu::Backend::Metal => 1,
        _ => 2,
    }
}

fn describe(info: &wgpu::AdapterInfo, raw: &wgpu::Adapter) -> Adapter {
    let (limits, features) = (raw.limits(), raw.features());
    Adapter {
        name: info.name.clone(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        backend: info.backend.to_str().to_owned(),
        kind: kind(info.device_type),
        memory_bytes: memory_bytes(raw),
        max_buffer_bytes: limits.max_buffer_size,
        max_binding_bytes: limits.max_storage_buffer_binding_size,
        max_workgroup_threads: limits.max_compute_invocations_per_workgroup,
        max_workgroup_bytes: limits.max_compute_workgroup_storage_size,
        subgroups: features.contains(wgpu::Features::SUBGROUP),
        min_subgroup_threads: info.subgroup_min_size,
        f16: features.contains(wgpu::Features::SHADER_F16),
        cooperative_matrix: multiplies_matrices(info, raw),
        pipeline_cache: features.contains(wgpu::Features::PIPELINE_CACHE),
        timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
    }
}

/// The heaps that are local to the device, where its buffers lie.
#[cfg(any(windows, target_os = "linux", target_os = "android", target_os = "freebsd"))]
fn memory_bytes(raw: &wgpu::Adapter) -> Option<u64> {
    /// `VK_MEMORY_HEAP_DEVICE_LOCAL_BIT`.
    const DEVICE_LOCAL: u32 = 1;
    // SAFETY: what it gives is only asked, and dropped before the adapter.
    let vulkan = unsafe { raw.as_hal::<wgpu::hal::api::Vulkan>() }?;
    let (instance, device) = (vulkan.shared_instance().raw_instance(), vulkan.raw_physical_device());
    // SAFETY: this instance listed the device.
    let properties = unsafe { instance.get_physical_device_memory_properties(device) };
    let heaps = &properties.memory_heaps[..properties.memory_heap_count as usize];
    Some(heaps.iter().filter(|heap| heap.flags.as_raw() & DEVICE_LOCAL != 0).map(|heap| heap.size).sum())
}

/// Metal does not tell.
#[cfg(not(any(windows, target_os = "linux", target_os = "android", target_os = "freebsd")))]
fn memory_bytes(_: &wgpu::Adapter) -> Option<u64> {
    None
}

/// See [`Adapter::cooperative_matrix`].
fn multiplies_matrices(info: &wgpu::AdapterInfo, raw: &wgpu::Adapter) -> bool {
    use wgpu::CooperativeScalarType::{F16, F32};
    let offered = raw.cooperative_matrix_properties();
    raw.features().contains(MATRIX_FEATURES)
        && (info.subgroup_min_size, info.subgroup_max_size) == (32, 32)
        && offered.iter().any(|m| (m.m_size, m.n_size, m.k_size, m.ab_type, m.cr_type) == (16, 16, 16, F16, F32))
}

fn kind(device_type: wgpu::DeviceType) -> AdapterKind {
    match device_type {
        wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
        wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
        wgpu::DeviceType::Cpu => AdapterKind::Software,
        wgpu::DeviceType::VirtualGpu | wgpu::DeviceType::Other => AdapterKind::Virtual,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::{AdapterInfo, Backend, DeviceType};

    fn info(backend: Backend, device: u32, bus: &str) -> AdapterInfo {
        AdapterInfo { vendor: 1, device, device_pci_bus_id: bus.into(), ..AdapterInfo::new(DeviceType::Cpu, backend) }
    }

    fn kept(infos: &[AdapterInfo]) -> Vec<usize> {
        (0..infos.len()).filter(|i| !is_duplicate(*i, infos)).collect()
    }

    #[test]
    fn a_card_is_listed_once_through_its_best_interface() {
        let [dx, vulkan, other] =
            [info(Backend::Dx12, 5, ""), info(Backend::Vulkan, 5, "0:1"), info(Backend::Dx12, 6, "")];
        assert_eq!(kept(&[dx, vulkan, other]), [1, 2]);
    }

    #[test]
    fn twins_are_both_listed() {
        let twins = [info(Backend::Vulkan, 5, "0:1"), info(Backend::Vulkan, 5, "0:2"), info(Backend::Dx12, 5, "")];
        assert_eq!(kept(&twins), [0, 1]);
        assert_eq!(kept(&[info(Backend::Vulkan, 5, ""), info(Backend::Vulkan, 5, "")]), [0, 1]);
    }

    #[test]
    fn of_two_drivers_for_one_card_the_first_is_listed() {
        assert_eq!(kept(&[info(Backend::Vulkan, 5, "0:1"), info(Backend::Vulkan, 5, "0:1")]), [0]);
    }
}
