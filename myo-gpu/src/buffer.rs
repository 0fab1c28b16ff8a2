//! Memory on the device.

use std::marker::PhantomData;
use std::ops::Range;

use bytemuck::Pod;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::health::Fault;

/// An array of `T` in the device's memory. Clones are handles on the same memory.
///
/// The size of `T` must be a multiple of 4 bytes, which the compiler checks.
#[derive(Debug)]
pub struct Buffer<T> {
    raw: wgpu::Buffer,
    label: Box<str>,
    len: usize,
    element: PhantomData<fn() -> T>,
}

impl<T> Clone for Buffer<T> {
    fn clone(&self) -> Self {
        Self { raw: self.raw.clone(), label: self.label.clone(), len: self.len, element: PhantomData }
    }
}

/// A buffer without the type of its elements, to be bound to a kernel.
#[derive(Clone, Copy, Debug)]
pub struct BufferRef<'a> {
    pub(crate) raw: &'a wgpu::Buffer,
    label: &'a str,
}

impl<'a> BufferRef<'a> {
    /// Its name in messages.
    pub fn label(self) -> &'a str {
        self.label
    }

    /// Its size in bytes.
    pub fn bytes(self) -> u64 {
        self.raw.size()
    }
}

impl<T: Pod> Buffer<T> {
    /// Bytes of one element, known to be a multiple of 4.
    pub(crate) const STRIDE: u64 = {
        assert!(size_of::<T>() > 0 && size_of::<T>().is_multiple_of(4), "elements must be multiples of 4 bytes");
        size_of::<T>() as u64
    };

    /// Its name in messages.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Number of elements, at least 1.
    #[expect(clippy::len_without_is_empty, reason = "a buffer is never empty")]
    pub fn len(&self) -> usize {
        self.len
    }

    /// All of it, to be bound to a kernel.
    pub fn binding(&self) -> BufferRef<'_> {
        BufferRef { raw: &self.raw, label: &self.label }
    }

    pub(crate) fn raw(&self) -> &wgpu::Buffer {
        &self.raw
    }

    /// The bytes of some elements.
    pub(crate) fn bytes(&self, offset: usize, count: usize) -> Result<Range<u64>, GpuError> {
        let end = offset.saturating_add(count);
        if end > self.len {
            return Err(GpuError::OutOfRange { buffer: self.label.to_string(), start: offset, end, len: self.len });
        }
        Ok(offset as u64 * Self::STRIDE..end as u64 * Self::STRIDE)
    }
}

impl Gpu {
    /// Memory for `len` elements, all bits zero.
    ///
    /// # Errors
    /// `len` is 0, over the device's limits, or there is no memory left.
    pub fn buffer<T: Pod>(&self, label: &str, len: usize) -> Result<Buffer<T>, GpuError> {
        let size = self.checked_size(label, len, Buffer::<T>::STRIDE)?;
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage: USAGE, mapped_at_creation: false };
        let raw = self.guarded(|| self.device().create_buffer(&descriptor)).map_err(|fault| match fault {
            Fault::OutOfMemory => GpuError::OutOfMemory { what: format!("buffer {label}, {size} bytes") },
            other => other.during(&format!("buffer {label}")),
        })?;
        Ok(Buffer { raw, label: label.into(), len, element: PhantomData })
    }

    /// Size in bytes, if the device allows it.
    fn checked_size(&self, label: &str, len: usize, stride: u64) -> Result<u64, GpuError> {
        let buffer = || label.to_owned();
        let bytes = (len as u64).saturating_mul(stride);
        let max = self.limits().max_buffer_size.min(self.limits().max_storage_buffer_binding_size);
        match bytes {
            0 => Err(GpuError::EmptyBuffer { buffer: buffer() }),
            _ if bytes > max => {
                Err(GpuError::TooLarge { buffer: buffer(), bytes, max, adapter: self.adapter().name.clone() })
            }
            _ => Ok(bytes),
        }
    }
}

const USAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE
    .union(wgpu::BufferUsages::UNIFORM)
    .union(wgpu::BufferUsages::COPY_SRC)
    .union(wgpu::BufferUsages::COPY_DST);
