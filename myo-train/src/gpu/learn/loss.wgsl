// The clipped objective of PPO and the squared error of the values, as in gaussian.rs: one thread per sample. Writes the
// gradients with respect to the outputs of both networks, and what is summed up over samples.

struct Shape {
    chunk: u32,
    actions: u32,
    // Place of the logarithms of the standard deviations.
    log_std: u32,
    // Rows of the outputs of the policy and the value network among the gradients, and how many more there are before
    // them among the activations.
    mean_row: u32,
    value_row: u32,
    observations: u32,
    // First row of the sums.
    sums_row: u32,
    clip: f32,
    // Weight of the squared error.
    value_coefficient: f32,
    // Between which means have an effect, and twice the weight of the squared distance beyond.
    least: f32,
    most: f32,
    bound_factor: f32,
}

@group(0) @binding(0) var<storage, read> parameters: array<f32>;
@group(0) @binding(1) var<storage, read> activation: array<f32>;
// Action, log-probability, advantage, target, weight: (actions + 4, chunk)
@group(0) @binding(2) var<storage, read> sample: array<f32>;
@group(0) @binding(3) var<storage, read_write> gradient: array<f32>;
@group(0) @binding(4) var<uniform> shape: Shape;

fn mean(column: u32, i: u32) -> f32 {
    return activation[(shape.observations + shape.mean_row + i) * shape.chunk + column];
}

fn z(column: u32, i: u32, inverse_std: f32) -> f32 {
    return (sample[i * shape.chunk + column] - mean(column, i)) * inverse_std;
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let column = (workgroup.y * workgroups.x + workgroup.x) * 64u + local;
    if column >= shape.chunk { return; }
    let first = shape.actions * shape.chunk + column;
    let weight = sample[first + 3u * shape.chunk];

    var squares = 0.0;
    var log_stds = 0.0;
    for (var i = 0u; i < shape.actions; i += 1u) {
        let log_std = parameters[shape.log_std + i];
        let z = z(column, i, exp(-log_std));
        squares += z * z;
        log_stds += log_std;
    }
    let log_ratio = log_density(shape.actions, squares, log_stds) - sample[first];
    let sums = shape.sums_row * shape.chunk + column;
    let objective = objective(log_ratio, sample[first + shape.chunk], weight, shape.clip);
    for (var i = 0u; i < shape.actions; i += 1u) {
        let inverse_std = exp(-parameters[shape.log_std + i]);
        let z = z(column, i, inverse_std);
        let back = weight * shape.bound_factor * beyond(mean(column, i), shape.least, shape.most);
        gradient[(shape.mean_row + i) * shape.chunk + column] = fma(objective.slope * z, inverse_std, back);
        gradient[sums + i * shape.chunk] = objective.slope * (z * z - 1.0);
    }

    let value = activation[(shape.observations + shape.value_row) * shape.chunk + column];
    let error = select(0.0, value - sample[first + 2u * shape.chunk], weight > 0.0);
    gradient[shape.value_row * shape.chunk + column] = 2.0 * shape.value_coefficient * weight * error;

    let metrics = sums + shape.actions * shape.chunk;
    gradient[metrics] = objective.loss;
    gradient[metrics + shape.chunk] = objective.divergence;
    gradient[metrics + 2u * shape.chunk] = objective.cut;
    gradient[metrics + 3u * shape.chunk] = error * error;
}
