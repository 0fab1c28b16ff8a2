// Y = keep(W X + b) for columns of samples, four of them to a vector.
//
// A workgroup makes a tile of TILE_OUTPUTS rows and TILE_GROUPS groups of four columns. Depth by depth it copies the parts of
// W and X that it needs to its shared memory; those of the next depth are fetched while this one is multiplied, and go to the
// other half of the shared memory, so one barrier per depth is enough. Every thread sums up its own entries of Y in
// registers, in the order of the inputs: neither the tile nor the place or number of columns changes a bit of the result.
//
// The tile and the loops come from the folder tile; dense_silu.wgsl, dense_linear.wgsl or dense_sample.wgsl says what `keep`
// makes of a sum.

struct Shape {
    inputs: u32,
    outputs: u32,
    // Columns to make, in groups of four.
    groups: u32,
    // Where W, (outputs, inputs) column-major, and b begin in the parameters.
    weight: u32,
    bias: u32,
    // From one row to the next and to the first column, in groups of four.
    x_stride: u32,
    x_first: u32,
    y_stride: u32,
    y_first: u32,
    // For sampling: where the logarithms of the standard deviations begin, environment of the first column, number
    // of environments, and the mapping from the policy's output to actions.
    log_std: u32,
    first_env: u32,
    num_envs: u32,
    offset: f32,
    scale: f32,
}

@group(0) @binding(0) var<storage, read> parameters: array<f32>;
@group(0) @binding(1) var<storage, read> x: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> y: array<vec4<f32>>;
@group(0) @binding(3) var<uniform> shape: Shape;

fn fetch_w(input: u32, output: u32) -> f32 {
    if input < shape.inputs && output < shape.outputs {
        return parameters[shape.weight + input * shape.outputs + output];
    }
    return 0.0;
}

fn fetch_x(input: u32, group: u32) -> vec4<f32> {
    if input < shape.inputs && group < shape.groups {
        return x[input * shape.x_stride + shape.x_first + group];
    }
    return vec4<f32>(0.0);
}

fn fetch_bias(output: u32) -> f32 {
    return parameters[shape.bias + output];
}

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    // Tiles of the same columns follow each other and share X in the cache.
    make_tile(workgroup.y * workgroups.x + workgroup.x, local);
}
