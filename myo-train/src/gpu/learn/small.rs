//! The kernels of an update around the matrix products.

use myo_gpu::{Access, GpuError, Recipe};

use super::context::Context;
use super::layout::{METRICS, Precision, SCALARS};
use crate::gaussian::Bound;
use crate::gpu::Sizes;
use crate::gpu::dense::Dispatch;
use crate::gpu::kernels::{prepare, sums};

use Access::{Read, ReadWrite, Uniform};

const SCALE: &str = concat!(include_str!("scale.wgsl"), include_str!("../workgroup_sum.wgsl"));
const GATHER_F32: &str = concat!(include_str!("gather_f32.wgsl"), include_str!("gather.wgsl"));
const GATHER_F16: &str = concat!(include_str!("gather_f16.wgsl"), include_str!("gather.wgsl"));
const LOSS: &str = concat!(include_str!("loss.wgsl"), include_str!("objective.wgsl"));
const REDUCE: &str = concat!(include_str!("reduce.wgsl"), include_str!("../workgroup_sum.wgsl"));
const ADAM: &str = concat!(include_str!("adam.wgsl"), include_str!("../workgroup_sum.wgsl"));

/// All of them that are made of several files.
#[cfg(test)]
pub const TEXTS: [&str; 6] = [SCALE, GATHER_F32, GATHER_F16, LOSS, REDUCE, ADAM];

/// What all of them are compiled from, the loss among them where nothing else makes it.
pub fn recipes(precision: Precision) -> Vec<Recipe> {
    let loss = (precision == Precision::Single).then(loss);
    let all = [advantages(), sums(), scale(), gather(precision), reduce(), adam()];
    all.into_iter().chain(loss).collect()
}

fn advantages() -> Recipe {
    Recipe::new("advantages", include_str!("estimate.wgsl"), [Read, Read, Read, ReadWrite, ReadWrite, Uniform])
}

fn scale() -> Recipe {
    Recipe::new("advantage scale", SCALE, [Read, Read, ReadWrite, Uniform])
}

fn gather(precision: Precision) -> Recipe {
    let text = match precision {
        Precision::Single => GATHER_F32,
        Precision::Half => GATHER_F16,
    };
    Recipe::new("gather", text, [Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite, Uniform])
}

fn loss() -> Recipe {
    Recipe::new("loss", LOSS, [Read, Read, Read, ReadWrite, Uniform])
}

fn reduce() -> Recipe {
    Recipe::new("reduce", REDUCE, [Read, ReadWrite, ReadWrite, Uniform])
}

fn adam() -> Recipe {
    Recipe::new("adam", ADAM, [Read, Read, Read, ReadWrite, ReadWrite, ReadWrite, ReadWrite, Uniform])
}

impl Context<'_> {
    /// Advantages and targets, their sums, and their scale in every minibatch.
    pub fn estimates(&self) -> Result<Vec<Dispatch>, GpuError> {
        Ok(vec![self.estimate()?, self.estimate_sums()?, self.scale()?])
    }

    fn estimate(&self) -> Result<Dispatch, GpuError> {
        let kernel = self.gpu.kernel(&advantages())?;
        let Sizes { envs, padded, steps, between_cuts, control_dt, noise_free, .. } = *self.sizes;
        // As on the processor, the decay is the product of two rounded numbers.
        let (gamma, lambda) = (self.config.gamma(control_dt) as f32, self.config.gae_lambda(control_dt) as f32);
        let numbers = [gamma, gamma * lambda].map(f32::to_bits);
        let whole = [envs, padded, steps, between_cuts].map(|x| x as u32);
        let most = (self.config.advantage_max as f32).to_bits();
        let shape: Vec<_> = whole.into_iter().chain(numbers).chain([noise_free as u32, most]).collect();
        let (record, memory) = (self.record, self.memory);
        let buffers = [
            record.reward.binding(),
            record.value.binding(),
            record.ended.binding(),
            memory.estimate.binding(),
            memory.estimate_parts.binding(),
        ];
        prepare(self.gpu, &kernel, &buffers, &shape, envs)
    }

    fn estimate_sums(&self) -> Result<Dispatch, GpuError> {
        let kernel = self.gpu.kernel(&sums())?;
        let shape = [4, self.sizes.envs as u32, self.sizes.envs as u32, 0, 0, 1];
        let buffers = [self.memory.estimate_parts.binding(), self.memory.estimate_sums.binding()];
        prepare(self.gpu, &kernel, &buffers, &shape, 4 * kernel.workgroup_size() as usize)
    }

    fn scale(&self) -> Result<Dispatch, GpuError> {
        let kernel = self.gpu.kernel(&scale())?;
        let (sizes, layout) = (self.sizes, self.layout);
        let shape = [
            sizes.envs,
            sizes.padded,
            sizes.samples(),
            layout.block,
            layout.blocks,
            layout.minibatches,
            layout.steps(),
        ]
        .map(|x| x as u32);
        let memory = self.memory;
        let buffers = [memory.order.binding(), memory.estimate.binding(), memory.scale.binding()];
        prepare(self.gpu, &kernel, &buffers, &shape, layout.steps() * kernel.workgroup_size() as usize)
    }

    /// The samples of every chunk of every gradient step.
    pub fn gather(&self) -> Result<Vec<Vec<Dispatch>>, GpuError> {
        let kernel = self.gpu.kernel(&gather(self.layout.precision))?;
        let (record, memory) = (self.record, self.memory);
        let buffers = [
            memory.order.binding(),
            record.observation.binding(),
            record.action.binding(),
            record.log_prob.binding(),
            memory.estimate.binding(),
            memory.scale.binding(),
            memory.activation.binding(),
            memory.sample.binding(),
        ];
        let (sizes, layout) = (self.sizes, self.layout);
        let chunk = |step: usize, chunk: usize| {
            let blocks = layout.range(step);
            let start = chunk * layout.chunk;
            let columns = (blocks.len() * layout.block).saturating_sub(start).min(layout.chunk);
            let shape = [
                sizes.envs,
                sizes.padded,
                sizes.samples(),
                sizes.columns(),
                sizes.observations,
                sizes.actions,
                layout.block,
                layout.chunk,
                columns,
                start,
                blocks.start,
                step,
                layout.rows,
            ]
            .map(|x| x as u32);
            let rows = sizes.observations + sizes.actions + SCALARS;
            prepare(self.gpu, &kernel, &buffers, &shape, rows * layout.chunk)
        };
        let step = |step| (0..layout.chunks).map(|index| chunk(step, index)).collect();
        (0..layout.steps()).map(step).collect()
    }

    /// Gradients with respect to the outputs of both networks, whose first rows are given.
    pub fn loss(&self, [mean_row, value_row]: [usize; 2]) -> Result<Dispatch, GpuError> {
        let kernel = self.gpu.kernel(&loss())?;
        let (sizes, layout) = (self.sizes, self.layout);
        let log_std = self.networks.log_std_range().start;
        let places = [layout.chunk, sizes.actions, log_std, mean_row, value_row, sizes.observations, layout.sums_row];
        let Bound { least, most, factor } = self.config.bound();
        let (clip, value) = (self.config.ratio_clip(sizes.control_dt), self.config.value_coefficient as f32);
        let numbers = [clip, value, least, most, factor].map(f32::to_bits);
        let shape: Vec<_> = places.map(|x| x as u32).into_iter().chain(numbers).collect();
        let memory = self.memory;
        let [activation, sample] = [memory.activation.binding(), memory.sample.binding()];
        let buffers = [self.parameters.binding(), activation, sample, memory.gradient.binding()];
        prepare(self.gpu, &kernel, &buffers, &shape, layout.chunk)
    }

    /// The sum of `slots` partial gradients.
    pub fn reduce(&self, slots: usize) -> Result<Dispatch, GpuError> {
        let kernel = self.gpu.kernel(&reduce())?;
        let parameters = self.networks.len();
        let length = parameters + METRICS;
        let log_std = self.networks.log_std_range();
        let entropy = (self.config.entropy_coefficient as f32).to_bits();
        let places = [length, parameters, slots, log_std.start, log_std.len()];
        let shape: Vec<_> = places.map(|x| x as u32).into_iter().chain([entropy]).collect();
        let memory = self.memory;
        let buffers = [memory.partial.binding(), memory.total.binding(), memory.squares.binding()];
        prepare(self.gpu, &kernel, &buffers, &shape, length)
    }

    /// The Adam step of every gradient step.
    pub fn adam(&self) -> Result<Vec<Dispatch>, GpuError> {
        let kernel = self.gpu.kernel(&adam())?;
        let (memory, config, log_std) = (self.memory, self.config, self.networks.log_std_range());
        let buffers = [
            memory.total.binding(),
            memory.squares.binding(),
            memory.rates.binding(),
            self.parameters.binding(),
            memory.mean.binding(),
            memory.square.binding(),
            memory.metrics.binding(),
        ];
        let bounds = config.log_std(self.sizes.control_dt);
        let numbers = [
            config.gradient_norm_max,
            config.adam_beta1,
            config.adam_beta2,
            config.adam_epsilon,
            bounds.min,
            bounds.max,
        ]
        .map(|x| (x as f32).to_bits());
        let step = |step: usize| {
            let places = [self.networks.len(), memory.squares.len(), step, log_std.start, log_std.len()];
            let shape: Vec<_> = places.map(|x| x as u32).into_iter().chain(numbers).collect();
            prepare(self.gpu, &kernel, &buffers, &shape, self.networks.len().max(METRICS + 1))
        };
        (0..self.layout.steps()).map(step).collect()
    }
}
