// Products of layers of both networks in one dispatch: every workgroup makes a tile of one of the jobs. See dense.wgsl for
// how a tile is made.

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
$BINDINGS
@group(0) @binding($SHAPE) var<uniform> all: Shape;

const DEPTH = $DEPTHu;
const TILE_OUTPUTS = $TILE_OUTPUTSu;
const TILE_GROUPS = $TILE_GROUPSu;
const THREADS_X = $THREADS_Xu;
const THREADS_Y = $THREADS_Yu;

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
var<workgroup> w_tile: array<vec4<f32>, $W_TILE>;
var<workgroup> x_tile: array<vec4<f32>, $X_TILE>;

fn fetch_w(input: u32, output: u32) -> f32 {
    if input < shape.inputs && output < shape.outputs {
        return parameters[$WEIGHT];
    }
    return 0.0;
}

fn fetch_x(input: u32, group: u32) -> vec4<f32> {
    if input < shape.inputs && group < shape.groups {
        return $SOURCE[(shape.x_row + input) * shape.groups + group];
    }
    return vec4<f32>(0.0);
}

$FUNCTIONS

@compute @workgroup_size($THREADS)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    var tile = workgroup.y * workgroups.x + workgroup.x;
    var begin = 0u;
    var index = 0u;
    while index + 1u < all.jobs && tile >= jobs[index].end {
        begin = jobs[index].end;
        index += 1u;
    }
    if tile >= jobs[index].end { return; }
    let job = jobs[index];
    shape = Part(job.inputs, job.outputs, all.groups, job.weight, job.bias, job.x_row, job.y_row, job.hidden);
    tile -= begin;

    let tiles = (shape.outputs + TILE_OUTPUTS - 1u) / TILE_OUTPUTS;
    let first_output = (tile % tiles) * TILE_OUTPUTS;
    let first_group = (tile / tiles) * TILE_GROUPS;
    let at_x = local % THREADS_X;
    let at_y = local / THREADS_X;

$ZERO
$FETCH_FIRST
    var half = 0u;
    for (var depth = 0u; depth < shape.inputs; depth += DEPTH) {
$STORE
        workgroupBarrier();
$FETCH_NEXT
$MULTIPLY
        half = 1u - half;
    }
$FINISH
}
