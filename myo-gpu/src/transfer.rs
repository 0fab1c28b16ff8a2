//! Moving numbers between the program and the device.

use bytemuck::Pod;

use crate::buffer::Buffer;
use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::health::Fault;

/// Elements of a buffer, and the memory of the program that they are copied to. Made by [`Buffer::part`].
#[derive(Debug)]
pub struct Read<'a> {
    raw: &'a wgpu::Buffer,
    start: u64,
    out: &'a mut [u8],
}

impl<T: Pod> Buffer<T> {
    /// The elements from `offset` on, as many as `out` has room for, to be read with others at once.
    ///
    /// # Errors
    /// [`GpuError::OutOfRange`].
    pub fn part<'a>(&'a self, offset: usize, out: &'a mut [T]) -> Result<Read<'a>, GpuError> {
        let start = self.bytes(offset, out.len())?.start + self.parts().starts().next().unwrap_or(0);
        Ok(Read { raw: self.raw(), start, out: bytemuck::cast_slice_mut(out) })
    }
}

impl Gpu {
    /// Writes elements from `offset` on. They are there before any work submitted later begins.
    ///
    /// # Errors
    /// [`GpuError::OutOfRange`], no memory left for the copy, device lost.
    pub fn write<T: Pod>(&self, buffer: &Buffer<T>, offset: usize, data: &[T]) -> Result<(), GpuError> {
        let bytes = buffer.bytes(offset, data.len())?;
        if data.is_empty() {
            return Ok(());
        }
        let part = |start| self.queue().write_buffer(buffer.raw(), start + bytes.start, bytemuck::cast_slice(data));
        self.guarded(|| buffer.parts().starts().for_each(part))
            .map_err(|fault| fault.during(&format!("writing buffer {}", buffer.label())))
    }

    /// Reads elements from `offset` on, as many as `out` has room for, after all work submitted so far.
    ///
    /// # Errors
    /// [`GpuError::OutOfRange`], no memory left for the copy, device lost.
    pub fn read<T: Pod>(&self, buffer: &Buffer<T>, offset: usize, out: &mut [T]) -> Result<(), GpuError> {
        self.read_many(&mut [buffer.part(offset, out)?])
    }

    /// Reads several parts with one submission and one wait, together at most
    /// [`Adapter::max_buffer_bytes`](crate::Adapter::max_buffer_bytes).
    ///
    /// # Errors
    /// As for [`read`](Self::read).
    pub fn read_many(&self, reads: &mut [Read<'_>]) -> Result<(), GpuError> {
        self.batch().submit_and_read(reads)
    }
}

/// Bytes of the smallest staging buffer; below it, making a new one costs more than it saves.
const STAGING_MIN: u64 = 1 << 16;

/// Bytes of the largest one that is kept.
const STAGING_KEPT: u64 = 1 << 26;

/// A buffer that both sides can see, reused from one reading to the next.
#[derive(Debug, Default)]
pub(crate) struct Staging(Option<wgpu::Buffer>);

impl Staging {
    /// Adds the copies to the commands, submits them after those that are ready, does something else meanwhile, waits, and
    /// fills the parts.
    pub fn run<T>(
        &mut self,
        gpu: &Gpu,
        ready: Option<wgpu::CommandBuffer>,
        commands: wgpu::CommandEncoder,
        reads: &mut [Read<'_>],
        meanwhile: impl FnOnce() -> T,
    ) -> Result<T, Fault> {
        // On any error the buffer, which may be mapped still, is left behind.
        let buffer = self.take(gpu, reads.iter().map(Read::size).sum())?;
        let index = gpu.guarded(|| submit(gpu, &buffer, ready, commands, reads))?;
        let out = meanwhile();
        gpu.guarded(|| fill(gpu, &buffer, index, reads))??;
        self.0 = Some(buffer).filter(|buffer| buffer.size() <= STAGING_KEPT);
        Ok(out)
    }

    fn take(&mut self, gpu: &Gpu, size: u64) -> Result<wgpu::Buffer, Fault> {
        match self.0.take() {
            Some(buffer) if buffer.size() >= size => Ok(buffer),
            _ => gpu.guarded(|| {
                gpu.device().create_buffer(&wgpu::BufferDescriptor {
                    label: Some("staging"),
                    size: roomy(size),
                    usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            }),
        }
    }
}

/// Room for somewhat larger readings later on, unless the buffer will not be kept.
fn roomy(size: u64) -> u64 {
    let room = size.next_power_of_two().max(STAGING_MIN);
    if room <= STAGING_KEPT { room } else { size }
}

impl<'a> Read<'a> {
    /// The first bytes of a buffer that has no type.
    pub(crate) fn all(raw: &'a wgpu::Buffer, out: &'a mut [u8]) -> Self {
        Self { raw, start: 0, out }
    }

    fn size(&self) -> u64 {
        self.out.len() as u64
    }
}

fn submit(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    ready: Option<wgpu::CommandBuffer>,
    mut commands: wgpu::CommandEncoder,
    reads: &[Read<'_>],
) -> wgpu::SubmissionIndex {
    let mut end = 0;
    for read in reads.iter().filter(|read| read.size() > 0) {
        commands.copy_buffer_to_buffer(read.raw, read.start, buffer, end, read.size());
        end += read.size();
    }
    let index = gpu.queue().submit(ready.into_iter().chain([commands.finish()]));
    if end > 0 {
        // Whether it worked shows when the range is asked for.
        buffer.map_async(wgpu::MapMode::Read, ..end, |_| ());
    }
    index
}

fn fill(gpu: &Gpu, buffer: &wgpu::Buffer, index: wgpu::SubmissionIndex, reads: &mut [Read<'_>]) -> Result<(), Fault> {
    let wait = wgpu::PollType::Wait { submission_index: Some(index), timeout: None };
    gpu.device().poll(wait).map_err(|e| Fault::Refused(e.to_string()))?;
    let end: u64 = reads.iter().map(Read::size).sum();
    if end > 0 {
        let mapped = buffer.get_mapped_range(..end).map_err(|e| Fault::Refused(e.to_string()))?;
        let mut rest = &*mapped;
        for read in reads {
            let (this, others) = rest.split_at(read.out.len());
            read.out.copy_from_slice(this);
            rest = others;
        }
        drop(mapped);
        buffer.unmap();
    }
    Ok(())
}
