//! Compute kernels.

use std::sync::Arc;

use crate::buffer::{Buffer, BufferRef};
use crate::cache::{Cached, Slot};
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::groups;
use crate::health::Fault;
use crate::source::{self, Source};

/// Storage buffers that every device with compute kernels can bind at once.
pub const MAX_STORAGE_BUFFERS: usize = 8;

/// How a kernel uses one of its buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// `var<storage, read>`.
    Read,
    /// `var<storage, read_write>`.
    ReadWrite,
    /// `var<uniform>`: small, the same for all threads.
    Uniform,
}

/// A compiled compute kernel. Clones are handles on the same one.
#[derive(Clone, Debug)]
pub struct Kernel(pub(crate) Arc<Inner>);

#[derive(Debug)]
pub(crate) struct Inner {
    label: String,
    gpu: Gpu,
    layout: wgpu::BindGroupLayout,
    bindings: usize,
    cached: Cached,
    pub pipeline: wgpu::ComputePipeline,
    pub workgroup: u32,
    /// Whether it runs for several groups, and how long their parts are is bound behind its buffers.
    pub in_groups: bool,
}

/// Buffers bound to a kernel, made once and used again and again, also with other kernels of the same accesses. They live
/// as long as this does.
#[derive(Clone, Debug)]
pub struct Bindings(pub(crate) wgpu::BindGroup);

impl Kernel {
    /// Its name in messages.
    pub fn label(&self) -> &str {
        &self.0.label
    }

    /// Threads in one workgroup.
    pub fn workgroup_size(&self) -> u32 {
        self.0.workgroup
    }

    /// Whether the compiled kernel was found on disk or is there now.
    pub fn cached(&self) -> &Cached {
        &self.0.cached
    }

    /// Binds buffers to `@group(0) @binding(0)` and following.
    ///
    /// # Errors
    /// The number of buffers is wrong, one is of another device, or larger than the device allows for a uniform.
    pub fn bind(&self, buffers: &[BufferRef<'_>]) -> Result<Bindings, GpuError> {
        let Inner { label, gpu, layout, bindings, .. } = &*self.0;
        let refused = |reason| GpuError::Bind { kernel: label.clone(), reason };
        if buffers.len() != *bindings {
            return Err(refused(format!("it has {bindings} bindings, but {} buffers were given", buffers.len())));
        }
        let lengths = self.part_lengths(buffers)?;
        let lengths = lengths.as_ref().map(Buffer::binding);
        let all: Vec<_> = buffers.iter().copied().chain(lengths).collect();
        let entries: Vec<_> = (0..).zip(&all).map(|(binding, buffer)| entry(binding, buffer)).collect();
        let descriptor = wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries };
        gpu.guarded(|| gpu.device().create_bind_group(&descriptor)).map(Bindings).map_err(|fault| match fault {
            Fault::Refused(reason) => refused(reason),
            other => other.during(&format!("binding kernel {label}")),
        })
    }
}

impl Kernel {
    /// How long the parts of these buffers are, for a kernel for groups.
    fn part_lengths(&self, buffers: &[BufferRef<'_>]) -> Result<Option<Buffer<u32>>, GpuError> {
        let Inner { label, gpu, in_groups, .. } = &*self.0;
        if !in_groups {
            return Ok(None);
        }
        let words = groups::lengths(buffers.iter().map(|buffer| buffer.part_bytes())).ok_or_else(|| {
            GpuError::Bind { kernel: label.clone(), reason: "a group has 4 GiB or more of a buffer".into() }
        })?;
        let plain = gpu.with_groups(None);
        let lengths = plain.buffer("part lengths", words.len())?;
        plain.write(&lengths, 0, &words)?;
        Ok(Some(lengths))
    }
}

fn entry<'a>(binding: u32, buffer: &BufferRef<'a>) -> wgpu::BindGroupEntry<'a> {
    wgpu::BindGroupEntry { binding, resource: buffer.raw.as_entire_binding() }
}

impl Gpu {
    /// Compiles the compute entry point `entry` of a shader for buffers at `@group(0)`, `@binding(0)` and following.
    ///
    /// Accesses out of bounds are caught and loops end, whatever the shader says.
    ///
    /// # Errors
    /// More than [`MAX_STORAGE_BUFFERS`], or the shader is refused; the message says where.
    pub fn compile(
        &self,
        label: &str,
        source: Source<'_>,
        entry: &str,
        bindings: &[Access],
    ) -> Result<Kernel, GpuError> {
        self.compile_with(label, source, entry, bindings, wgpu::ShaderRuntimeChecks::checked())
    }

    /// As [`compile`](Self::compile), but without these checks and without clearing the workgroup's memory at the start.
    ///
    /// # Safety
    /// Whenever this kernel runs, and whatever is in its buffers, it must not access anything outside them or outside its
    /// own arrays, divide an integer by zero, or loop forever. Kernels generated as straight-line code, or with constant
    /// loop bounds, that first return on all threads beyond the number of elements, fulfil this for buffers that have as
    /// many. [`Kernel::bind`] and [`Batch::dispatch`](crate::Batch::dispatch) do not know that number: whoever compiles the
    /// kernel must keep it, and all [`Bindings`] that it is run with, where no other code can bind other buffers.
    pub unsafe fn compile_trusted(
        &self,
        label: &str,
        source: Source<'_>,
        entry: &str,
        bindings: &[Access],
    ) -> Result<Kernel, GpuError> {
        self.compile_with(label, source, entry, bindings, wgpu::ShaderRuntimeChecks::unchecked())
    }

    fn compile_with(
        &self,
        label: &str,
        source: Source<'_>,
        entry: &str,
        bindings: &[Access],
        checks: wgpu::ShaderRuntimeChecks,
    ) -> Result<Kernel, GpuError> {
        check_count(label, bindings)?;
        let refused = |reason| GpuError::Kernel { kernel: label.to_owned(), reason };
        let in_groups = self.groups() > 1;
        let module = match in_groups {
            false => source::module(source),
            true => groups::kernel_in_groups(source, entry, bindings.len()),
        };
        let module = module.map_err(refused)?;
        let workgroup = source::workgroup_size(&module, entry).map_err(refused)?;
        let compiled = self.guarded(|| {
            let slot = Slot::open(self, &module);
            let module = self.shader(label, module, checks);
            let lengths = in_groups.then_some(Access::Uniform);
            let layout = self.layout(label, bindings.iter().copied().chain(lengths));
            let cache = slot.as_ref().map(|slot| &slot.raw);
            let pipeline = self.pipeline(label, &module, entry, &layout, cache, checks);
            (layout, pipeline, slot)
        });
        let (layout, pipeline, slot) = compiled.map_err(|fault| match fault {
            Fault::Refused(reason) => refused(reason),
            other => other.during(&format!("compiling kernel {label}")),
        })?;
        let cached = slot.map_or(Cached::Off, Slot::store);
        let (label, gpu, bindings) = (label.to_owned(), self.clone(), bindings.len());
        Ok(Kernel(Arc::new(Inner { label, gpu, layout, bindings, cached, pipeline, workgroup, in_groups })))
    }

    fn shader(&self, label: &str, module: naga::Module, checks: wgpu::ShaderRuntimeChecks) -> wgpu::ShaderModule {
        let source = wgpu::ShaderSource::Naga(std::borrow::Cow::Owned(module));
        let descriptor = wgpu::ShaderModuleDescriptor { label: Some(label), source };
        // SAFETY: unchecked only where the caller of `compile_trusted` vouches for the kernel.
        unsafe { self.device().create_shader_module_trusted(descriptor, checks) }
    }

    fn layout(&self, label: &str, bindings: impl Iterator<Item = Access>) -> wgpu::BindGroupLayout {
        let entries: Vec<_> = (0..).zip(bindings).map(|(binding, access)| layout_entry(binding, access)).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries };
        self.device().create_bind_group_layout(&descriptor)
    }

    fn pipeline(
        &self,
        label: &str,
        module: &wgpu::ShaderModule,
        entry: &str,
        layout: &wgpu::BindGroupLayout,
        cache: Option<&wgpu::PipelineCache>,
        checks: wgpu::ShaderRuntimeChecks,
    ) -> wgpu::ComputePipeline {
        let label = Some(label);
        let groups = self.groups.as_ref().map(|groups| Some(&groups.layout));
        let layouts: Vec<_> = [Some(layout)].into_iter().chain(groups).collect();
        let layout = self.device().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        self.device().create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&layout),
            module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: checks.bounds_checks,
                ..Default::default()
            },
            cache,
        })
    }
}

fn check_count(label: &str, bindings: &[Access]) -> Result<(), GpuError> {
    let got = bindings.iter().filter(|access| **access != Access::Uniform).count();
    match got > MAX_STORAGE_BUFFERS {
        true => Err(GpuError::TooManyBuffers { kernel: label.to_owned(), got, max: MAX_STORAGE_BUFFERS }),
        false => Ok(()),
    }
}

fn layout_entry(binding: u32, access: Access) -> wgpu::BindGroupLayoutEntry {
    let ty = match access {
        Access::Uniform => wgpu::BufferBindingType::Uniform,
        Access::Read => wgpu::BufferBindingType::Storage { read_only: true },
        Access::ReadWrite => wgpu::BufferBindingType::Storage { read_only: false },
    };
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
