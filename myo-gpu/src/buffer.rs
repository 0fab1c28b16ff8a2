//! Memory on the device.

use std::marker::PhantomData;
use std::ops::Range;

use bytemuck::Pod;

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::groups::part_bytes;
use crate::health::Fault;

/// An array of `T` in the device's memory. Clones are handles on the same memory.
///
/// The size of `T` must be a multiple of 4 bytes, which the compiler checks. Made by a [`Gpu`] in [groups](Gpu::in_groups), it has
/// as many parts of `len` elements: writing goes to all of them, reading is from the first, unless it is the buffer
/// [`of`](Self::of) one group.
#[derive(Debug)]
pub struct Buffer<T> {
    raw: wgpu::Buffer,
    label: Box<str>,
    len: usize,
    parts: Parts,
    element: PhantomData<fn() -> T>,
}

impl<T> Clone for Buffer<T> {
    fn clone(&self) -> Self {
        let Self { len, parts, .. } = *self;
        Self { raw: self.raw.clone(), label: self.label.clone(), len, parts, element: PhantomData }
    }
}

/// The parts of a buffer, one per group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts {
    count: usize,
    /// From one to the next.
    bytes: u64,
    /// The one that is meant, or all.
    only: Option<usize>,
}

impl Parts {
    /// Where the part of a group begins, in bytes; buffers of no groups have one part for all.
    pub fn start(self, group: usize) -> u64 {
        if self.count == 1 { 0 } else { group as u64 * self.bytes }
    }

    /// Where all parts begin that are meant.
    pub fn starts(self) -> impl Iterator<Item = u64> {
        let groups = self.only.map_or(0..self.count, |only| only..only + 1);
        groups.map(move |group| self.start(group))
    }
}

/// A buffer without the type of its elements, to be bound to a kernel.
#[derive(Clone, Copy, Debug)]
pub struct BufferRef<'a> {
    pub(crate) raw: &'a wgpu::Buffer,
    label: &'a str,
    bytes: u64,
    parts: Parts,
}

impl<'a> BufferRef<'a> {
    /// Its name in messages.
    pub fn label(self) -> &'a str {
        self.label
    }

    /// Its size in bytes, for one group.
    pub fn bytes(self) -> u64 {
        self.bytes
    }

    /// Bytes from one group's part to the next; 0 where all have the same.
    pub(crate) fn part_bytes(self) -> u64 {
        if self.parts.count == 1 { 0 } else { self.parts.bytes }
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

    /// Number of elements, at least 1; of one group.
    #[expect(clippy::len_without_is_empty, reason = "a buffer is never empty")]
    pub fn len(&self) -> usize {
        self.len
    }

    /// All of it, to be bound to a kernel.
    pub fn binding(&self) -> BufferRef<'_> {
        let bytes = self.len as u64 * Self::STRIDE;
        BufferRef { raw: &self.raw, label: &self.label, bytes, parts: self.parts }
    }

    /// The part of a group: what is written and read through it is of that group alone. Bound to a kernel, or in a batch, it is
    /// the whole buffer: there, the batch tells the groups. A buffer of no groups is the same for all.
    ///
    /// # Panics
    /// The buffer has parts, but none for this group.
    pub fn of(&self, group: usize) -> Self {
        let Parts { count, .. } = self.parts;
        assert!(count == 1 || group < count, "group {group} of {count} of buffer {}", self.label);
        let mut part = self.clone();
        part.parts.only = (count > 1).then_some(group);
        part
    }

    pub(crate) fn raw(&self) -> &wgpu::Buffer {
        &self.raw
    }

    pub(crate) fn parts(&self) -> Parts {
        self.parts
    }

    /// The bytes of some elements within a part.
    pub(crate) fn bytes(&self, offset: usize, count: usize) -> Result<Range<u64>, GpuError> {
        let end = offset.saturating_add(count);
        if end > self.len {
            return Err(GpuError::OutOfRange { buffer: self.label.to_string(), start: offset, end, len: self.len });
        }
        Ok(offset as u64 * Self::STRIDE..end as u64 * Self::STRIDE)
    }
}

impl Gpu {
    /// Memory for `len` elements, all bits zero; for so many of every [group](Self::in_groups).
    ///
    /// # Errors
    /// `len` is 0, over the device's limits, or there is no memory left.
    pub fn buffer<T: Pod>(&self, label: &str, len: usize) -> Result<Buffer<T>, GpuError> {
        let (size, parts) = self.checked_size(label, len, Buffer::<T>::STRIDE)?;
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage: USAGE, mapped_at_creation: false };
        let raw = self.guarded(|| self.device().create_buffer(&descriptor)).map_err(|fault| match fault {
            Fault::OutOfMemory => GpuError::OutOfMemory { what: format!("buffer {label}, {size} bytes") },
            other => other.during(&format!("buffer {label}")),
        })?;
        Ok(Buffer { raw, label: label.into(), len, parts, element: PhantomData })
    }

    /// Size in bytes, if the device allows it, and its parts.
    fn checked_size(&self, label: &str, len: usize, stride: u64) -> Result<(u64, Parts), GpuError> {
        let buffer = || label.to_owned();
        let (count, each) = (self.groups(), (len as u64).saturating_mul(stride));
        let part = if count == 1 { each } else { part_bytes(each) };
        let bytes = part.saturating_mul(count as u64);
        let max = self.limits().max_buffer_size.min(self.limits().max_storage_buffer_binding_size);
        match bytes {
            0 => Err(GpuError::EmptyBuffer { buffer: buffer() }),
            _ if bytes > max => {
                Err(GpuError::TooLarge { buffer: buffer(), bytes, max, adapter: self.adapter().name.clone() })
            }
            _ => Ok((bytes, Parts { count, bytes: part, only: None })),
        }
    }
}

const USAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE
    .union(wgpu::BufferUsages::UNIFORM)
    .union(wgpu::BufferUsages::COPY_SRC)
    .union(wgpu::BufferUsages::COPY_DST);
