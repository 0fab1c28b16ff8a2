//! Graphics cards as compute devices, through Vulkan, Metal or Direct3D 12.
//!
//! [`adapters`] lists the cards, [`Gpu::open`] opens one. [`Buffer`]s are its memory, [`Kernel`]s its programs, and a
//! [`Batch`] is work in order, submitted at once.
//!
//! ```
//! use myo_gpu::{Access, Gpu, Source, AdapterChoice};
//!
//! let double = "
//!     @group(0) @binding(0) var<storage, read_write> x: array<f32>;
//!     @compute @workgroup_size(64)
//!     fn double(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
//!               @builtin(local_invocation_index) local: u32) {
//!         let i = (group.y * groups.x + group.x) * 64u + local;
//!         if i < arrayLength(&x) { x[i] *= 2.0; }
//!     }";
//! # if std::env::var_os("MYO_NO_GPU").is_some() { return Ok(()); }
//! let gpu = Gpu::open(&AdapterChoice::Any)?;
//! let kernel = gpu.compile("double", Source::Wgsl(double), "double", &[Access::ReadWrite])?;
//! let x = gpu.buffer::<f32>("x", 1000)?;
//! let bindings = kernel.bind(&[x.binding()])?;
//!
//! gpu.write(&x, 0, &[1.0; 1000])?;
//! let mut batch = gpu.batch();
//! batch.dispatch(&kernel, &bindings, 1000).dispatch(&kernel, &bindings, 1000);
//! let mut y = [0.0; 1000];
//! batch.submit_and_read(&mut [x.part(0, &mut y)?])?;
//! assert_eq!(y, [4.0; 1000]);
//! # Ok::<(), myo_gpu::GpuError>(())
//! ```
//!
//! Every failure is a [`GpuError`], also what drivers report late or with a panic; after a device was lost, every call
//! says so. Calls may come from several threads.
//!
//! This crate does not know physics, environments, networks, or how kernels are generated.

mod adapter;
mod adapter_choice;
mod batch;
mod buffer;
mod cache;
mod commands;
mod error;
mod gpu;
mod groups;
mod health;
mod kernel;
mod parts;
mod recipe;
mod shelf;
mod source;
mod timing;
mod transfer;

pub use adapter::{Adapter, AdapterKind, adapters};
pub use adapter_choice::AdapterChoice;
pub use batch::Batch;
pub use buffer::{Buffer, BufferRef};
pub use cache::Cached;
pub use commands::{Commands, Submitted};
pub use error::GpuError;
pub use gpu::Gpu;
pub use groups::{MAX_GROUPS, kernel_in_groups};
pub use kernel::{Access, Bindings, Kernel, MAX_STORAGE_BUFFERS};
pub use recipe::Recipe;
pub use source::Source;
pub use timing::{MAX_TIMED, Timing};
pub use transfer::Read;
