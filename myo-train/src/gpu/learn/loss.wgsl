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
}

@group(0) @binding(0) var<storage, read> parameters: array<f32>;
@group(0) @binding(1) var<storage, read> activation: array<f32>;
// Action, log-probability, advantage, target, weight: (actions + 4, chunk)
@group(0) @binding(2) var<storage, read> sample: array<f32>;
@group(0) @binding(3) var<storage, read_write> gradient: array<f32>;
@group(0) @binding(4) var<uniform> shape: Shape;

const HALF_LN_TAU = 0.9189385;

fn z(column: u32, i: u32, inverse_std: f32) -> f32 {
    let mean = activation[(shape.observations + shape.mean_row + i) * shape.chunk + column];
    return (sample[i * shape.chunk + column] - mean) * inverse_std;
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
    let old = sample[first];
    let advantage = sample[first + shape.chunk];
    let goal = sample[first + 2u * shape.chunk];
    let weight = sample[first + 3u * shape.chunk];
    let used = weight > 0.0;

    var squares = 0.0;
    var log_stds = 0.0;
    for (var i = 0u; i < shape.actions; i += 1u) {
        let log_std = parameters[shape.log_std + i];
        let z = z(column, i, exp(-log_std));
        squares += z * z;
        log_stds += log_std;
    }
    let log_ratio = -log_stds - f32(shape.actions) * HALF_LN_TAU - 0.5 * squares - old;
    // Held where the exponential would overflow.
    let ratio = exp(clamp(log_ratio, -87.0, 88.0));
    let free = ratio * advantage;
    let held = clamp(ratio, 1.0 - shape.clip, 1.0 + shape.clip) * advantage;
    let cut = held < free;
    let slope = select(-free * weight, 0.0, cut || !used);
    let sums = shape.sums_row * shape.chunk + column;
    for (var i = 0u; i < shape.actions; i += 1u) {
        let inverse_std = exp(-parameters[shape.log_std + i]);
        let z = z(column, i, inverse_std);
        gradient[(shape.mean_row + i) * shape.chunk + column] = slope * z * inverse_std;
        gradient[sums + i * shape.chunk] = slope * (z * z - 1.0);
    }

    let value = activation[(shape.observations + shape.value_row) * shape.chunk + column];
    let error = select(0.0, value - goal, used);
    gradient[shape.value_row * shape.chunk + column] = 2.0 * shape.value_coefficient * weight * error;

    let metrics = sums + shape.actions * shape.chunk;
    gradient[metrics] = select(0.0, -select(free, held, cut), used);
    gradient[metrics + shape.chunk] = select(0.0, ratio - 1.0 - log_ratio, used);
    gradient[metrics + 2u * shape.chunk] = select(0.0, 1.0, cut && used);
    gradient[metrics + 3u * shape.chunk] = error * error;
}
