// Products of layers of both networks in one dispatch: every workgroup makes a tile of one of the jobs. See dense.wgsl for
// how a tile is made. product_forward.wgsl or product_backward.wgsl says which product.

struct Job {
    // Workgroups of this job and those before it.
    end: u32,
    inputs: u32,
    outputs: u32,
    // Where W, (outputs, inputs) column-major for the layer, and b begin.
    weight: u32,
    bias: u32,
    // First rows of what goes in and what comes out.
    x_row: u32,
    y_row: u32,
    // Whether the layer is hidden.
    hidden: u32,
}

struct Shape {
    jobs: u32,
    // Columns in groups of four, of every row.
    groups: u32,
    // Rows of activations that have no gradient.
    observations: u32,
}

@group(0) @binding(0) var<storage, read> parameters: array<f32>;
@group(0) @binding(1) var<storage, read> jobs: array<Job>;
@group(0) @binding(2) var<storage, read_write> gradient: array<vec4<f32>>;

// The job that the tile belongs to, as the functions of the tile call it.
struct Part {
    inputs: u32,
    outputs: u32,
    groups: u32,
    weight: u32,
    bias: u32,
    x_row: u32,
    y_row: u32,
    hidden: u32,
}

var<private> shape: Part;

fn fetch_w(input: u32, output: u32) -> f32 {
    if input < shape.inputs && output < shape.outputs {
        return parameters[weight_at(input, output)];
    }
    return 0.0;
}

fn fetch_x(input: u32, group: u32) -> vec4<f32> {
    if input < shape.inputs && group < shape.groups {
        return entering((shape.x_row + input) * shape.groups + group);
    }
    return vec4<f32>(0.0);
}

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let tile = workgroup.y * workgroups.x + workgroup.x;
    let found = job_of(tile);
    let job = jobs[found.index];
    shape = Part(job.inputs, job.outputs, all.groups, job.weight, job.bias, job.x_row, job.y_row, job.hidden);
    make_tile(tile - found.begin, local);
}
