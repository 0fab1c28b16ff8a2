// Gradients of weights, dW = dZ H^T summed over samples, and of biases, the sums of dZ: all layers of both networks in one
// dispatch. The samples are split among workgroups; each writes a partial gradient, summed up in order by reduce.wgsl.
//
// Rows of a tile are inputs of the layer, columns its outputs, which lie side by side in the parameters.

struct Job {
    // Tiles of this job and those before it.
    end: u32,
    // Inputs, or 0 where only the sums of dZ are wanted; outputs.
    inputs: u32,
    outputs: u32,
    // First row of H among the activations, of dZ among the gradients.
    h_row: u32,
    z_row: u32,
    // Where the weights and the biases begin among the parameters.
    weight: u32,
    bias: u32,
    spare: u32,
}

struct Shape {
    jobs: u32,
    // Columns of every row, in groups of four.
    stride: u32,
    // Parts the columns are split into, and groups of four columns of each.
    splits: u32,
    split_groups: u32,
    // Partial gradients before these, and numbers of each.
    slot: u32,
    length: u32,
}

@group(0) @binding(0) var<storage, read> activation: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read> gradient: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> jobs: array<Job>;
@group(0) @binding(3) var<storage, read_write> partial: array<f32>;
@group(0) @binding(4) var<uniform> all: Shape;

// The job that the tile belongs to, as the functions of the tile call it: rows and columns of the product, and where the
// gradients go.
struct Part {
    outputs: u32,
    groups: u32,
    columns: u32,
    h_row: u32,
    z_row: u32,
    end: u32,
    first: u32,
    bias: u32,
}

var<private> shape: Part;

fn fetch_w(sample: u32, row: u32) -> vec4<f32> {
    if sample < shape.end && row < shape.outputs {
        return activation[(shape.h_row + row) * all.stride + sample];
    }
    return vec4<f32>(0.0);
}

fn fetch_x(sample: u32, row: u32) -> vec4<f32> {
    if sample < shape.end && row < shape.columns {
        return gradient[(shape.z_row + row) * all.stride + sample];
    }
    return vec4<f32>(0.0);
}

fn fetch_bias(row: u32) -> f32 {
    return 0.0;
}

fn keep(row: u32, group: u32, sum: vec4<f32>) {
    let place = shape.first + row * shape.columns + 4u * group;
    let left = shape.columns - 4u * group;
    partial[place] = sum.x;
    if left > 1u { partial[place + 1u] = sum.y; }
    if left > 2u { partial[place + 2u] = sum.z; }
    if left > 3u { partial[place + 3u] = sum.w; }
}

// The sums of dZ, from those that the threads have of every output.
fn keep_column_sums(first_group: u32, local: u32) {
    for (var row = local; row < 4u * TILE_GROUPS; row += THREADS) {
        let output = 4u * first_group + row;
        if output < shape.columns {
            var sum = 0.0;
            for (var quad = 0u; quad < DEPTH / 4u; quad += 1u) {
                sum += x_tile[row * (DEPTH / 4u) + quad].x;
            }
            partial[shape.bias + output] = sum;
        }
    }
}

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let group = workgroup.y * workgroups.x + workgroup.x;
    let tile = group / all.splits;
    let split = group % all.splits;
    let found = job_of(tile);
    let job = jobs[found.index];
    let slot = (all.slot + split) * all.length;
    let end = min((split + 1u) * all.split_groups, all.stride);
    let groups = (job.outputs + 3u) / 4u;
    shape = Part(job.inputs, groups, job.outputs, job.h_row, job.z_row, end, slot + job.weight, slot + job.bias);
    make_tile(tile - found.begin, local, 4u * split * all.split_groups, 4u * end);
}
