//! The physics of a control step alone, on the state of existing environments: what benchmarks measure.

use super::env::GpuEnv;
use super::program::{Bound, Compiled};
use crate::config::BuildError;
use crate::record::{self, PHYSICS_BUFFERS};
use crate::tables::Tables;
use myo_gpu::{Batch, Cached, GpuError};

/// A kernel that runs the physics and nothing else.
pub struct PhysicsBench {
    kernel: Compiled,
    shards: Vec<Bound>,
}

impl PhysicsBench {
    /// Compiles the kernel for the environments of `env`; its actions are taken as excitations.
    ///
    /// # Errors
    /// The tables are of a larger model or task than the environments', the kernel is too large or refused, or the device
    /// is lost.
    pub fn new(env: &GpuEnv, tables: &Tables<f64>) -> Result<Self, BuildError> {
        let gpu = env.gpu();
        let kernel = Compiled::new(gpu, "physics", &record::physics(tables, env.kernels().form()), &PHYSICS_BUFFERS)?;
        let bind = |shard: &super::Shard| {
            let buffers =
                [shard.numbers.binding(), shard.words.binding(), shard.parameters.binding(), shard.actions.binding()];
            kernel.bind(gpu, &buffers, shard.num_envs as u32)
        };
        let shards = env.shards().iter().map(bind).collect::<Result<_, GpuError>>()?;
        Ok(Self { kernel, shards })
    }

    /// Whether the kernel was found on disk or is there now.
    pub fn cached(&self) -> &Cached {
        self.kernel.cached()
    }

    /// Adds the physics of one control step of all environments to a batch.
    pub fn step(&self, batch: &mut Batch) {
        self.shards.iter().for_each(|shard| shard.dispatch(batch));
    }
}
