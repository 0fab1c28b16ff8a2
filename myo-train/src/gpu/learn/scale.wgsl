// Mean, one over the standard deviation, and number of the advantages of every minibatch of an update: one workgroup each.

struct Shape {
    num_envs: u32,
    padded: u32,
    samples: u32,
    block: u32,
    blocks: u32,
    minibatches: u32,
    steps: u32,
}

@group(0) @binding(0) var<storage, read> order: array<u32>;
@group(0) @binding(1) var<storage, read> estimate: array<f32>;
// Mean, scale, weight of a sample: (steps, 4)
@group(0) @binding(2) var<storage, read_write> scale: array<vec4<f32>>;
@group(0) @binding(3) var<uniform> shape: Shape;

alias Summand = vec2<f32>;

@compute @workgroup_size(256)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let step = min(workgroup.y * workgroups.x + workgroup.x, shape.steps - 1u);
    let taken = step / shape.minibatches * shape.blocks;
    let index = step % shape.minibatches;
    let first = taken + index * shape.blocks / shape.minibatches;
    let end = taken + (index + 1u) * shape.blocks / shape.minibatches;
    let columns = (end - first) * shape.block;

    // Deviations from the first advantage of the roll-out keep their digits.
    let origin = estimate[0];
    var sum = vec2<f32>(0.0);
    var count = 0.0;
    for (var column = local; column < columns; column += WORKGROUP) {
        let source = order[first + column / shape.block] * shape.block + column % shape.block;
        if source < shape.samples && source % shape.padded < shape.num_envs {
            let deviation = estimate[source] - origin;
            sum += vec2<f32>(deviation, deviation * deviation);
            count += 1.0;
        }
    }
    let sums = workgroup_sum(local, sum);
    let n = max(workgroup_sum(local, vec2<f32>(count, 0.0)).x, 1.0);
    if local == 0u {
        let mean = sums.x / n;
        let deviation = sqrt(max(sums.y / n - mean * mean, 0.0));
        // Equal advantages have no scale: they are left at zero.
        scale[step] = vec4<f32>(origin + mean, 1.0 / (deviation + 1e-8), 1.0 / n, 0.0);
    }
}
