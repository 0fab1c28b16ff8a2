//! The physics of a control step alone, on the state of existing environments: what benchmarks measure.

use super::env::GpuEnv;
use super::record::{self, PHYSICS_BUFFERS};
use super::shard::Compiled;
use crate::config::BuildError;
use crate::tables::Tables;
use myo_gpu::{Batch, Bindings, Buffer, GpuError, Kernel};

/// A kernel that runs the physics and nothing else.
pub struct PhysicsBench {
    kernel: Compiled,
    bindings: Vec<(Bindings, u32)>,
    /// Keeps the numbers of environments alive.
    _environments: Vec<Buffer<u32>>,
}

impl PhysicsBench {
    /// Compiles the kernel for the environments of `env`; its actions are taken as excitations.
    ///
    /// # Errors
    /// The kernel is too large or refused, or the device lost.
    pub fn new(env: &GpuEnv, tables: &Tables<f64>) -> Result<Self, BuildError> {
        let gpu = env.gpu();
        let kernel = Compiled::new(gpu, "physics", &record::physics(tables, env.kernels().form()), &PHYSICS_BUFFERS)?;
        let mut environments = Vec::new();
        let bind = |shard: &super::Shard| {
            let count = gpu.buffer("environments", 1)?;
            gpu.write(&count, 0, &[shard.num_envs as u32])?;
            let buffers = [shard.numbers.binding(), shard.words.binding(), shard.actions.binding()];
            let bindings = kernel.bind(&buffers, &count)?;
            environments.push(count);
            Ok((bindings, shard.num_envs as u32))
        };
        let bindings = env.shards().iter().map(bind).collect::<Result<_, GpuError>>()?;
        Ok(Self { kernel, bindings, _environments: environments })
    }

    /// The compiled kernel.
    pub fn kernel(&self) -> &Kernel {
        &self.kernel.kernel
    }

    /// Adds the physics of one control step of all environments to a batch.
    pub fn step(&self, batch: &mut Batch) {
        for (bindings, num_envs) in &self.bindings {
            batch.dispatch(&self.kernel.kernel, bindings, *num_envs);
        }
    }
}
