// Sums partial gradients in order; the parts of the squared length of the sum, one per workgroup.

struct Shape {
    // Numbers of a partial gradient, of which the last are no gradient but sums over samples.
    length: u32,
    parameters: u32,
    slots: u32,
    // Place of the logarithms of the standard deviations, and their number.
    log_std: u32,
    actions: u32,
    entropy_coefficient: f32,
}

@group(0) @binding(0) var<storage, read> partial: array<f32>;
@group(0) @binding(1) var<storage, read_write> total: array<f32>;
@group(0) @binding(2) var<storage, read_write> squares: array<f32>;
@group(0) @binding(3) var<uniform> shape: Shape;

alias Summand = f32;

@compute @workgroup_size(256)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let group = workgroup.y * workgroups.x + workgroup.x;
    let i = group * WORKGROUP + local;
    var sum = 0.0;
    if i < shape.length {
        for (var slot = 0u; slot < shape.slots; slot += 1u) {
            sum += partial[slot * shape.length + i];
        }
        // d(-entropy) / d log_std = -1
        if i >= shape.log_std && i < shape.log_std + shape.actions { sum -= shape.entropy_coefficient; }
        total[i] = sum;
    }
    let square = workgroup_sum(local, select(0.0, sum * sum, i < shape.parameters));
    if local == 0u && group * WORKGROUP < shape.length { squares[group] = square; }
}
