// Gradients of weights, dW = dZ H^T summed over samples, of all layers of both networks in one dispatch, on the matrix units.
// Under every layer's H lies a row of ones, of which the gradients of the biases come out, after those of the weights as among
// the parameters. The samples are split among workgroups; each writes a partial gradient, summed up in order by reduce.wgsl.
//
// Samples lie in groups of 16, rows of one group one after the other, so that matrices are loaded from where they are. Rows of a
// tile are inputs of the layer, columns its outputs. What a tile reads beyond its job belongs to other rows and is left out.
//
// weights.rs writes the sizes of the tile, as constants, and `make_part`, where loops over a subgroup's own matrices are written
// out, as these cannot lie in arrays.

enable f16;
enable wgpu_cooperative_matrix;

struct Job {
    // Tiles of this job and those before it.
    end: u32,
    // Inputs with the row of ones, or 0 where rows of the summands are summed up; outputs.
    inputs: u32,
    outputs: u32,
    // First row of H among the activations, of dZ among the gradients or of the summands.
    h_row: u32,
    z_row: u32,
    // Where the weights begin among the parameters.
    weight: u32,
    spare0: u32,
    spare1: u32,
}

struct Shape {
    jobs: u32,
    // Blocks of 64 samples, parts into which they are split, and blocks of each.
    blocks: u32,
    splits: u32,
    split_blocks: u32,
    // Partial gradients before these, and numbers of each.
    slot: u32,
    length: u32,
    // Of activations and of gradients.
    h_rows: u32,
    z_rows: u32,
    // What brings gradients back to their size.
    down: f32,
}

@group(0) @binding(0) var<storage, read> activation: array<vec4<f16>>;
@group(0) @binding(1) var<storage, read> gradient: array<vec4<f16>>;
@group(0) @binding(2) var<storage, read> summand: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> jobs: array<Job>;
@group(0) @binding(4) var<storage, read_write> partial: array<f32>;
@group(0) @binding(5) var<uniform> all: Shape;

// Subgroups side by side.
const ACROSS = TILE_COLUMNS / COLUMNS_EACH;

// What a subgroup makes of a tile: a part of the gradient of these rows and columns, from these blocks of samples.
struct Part {
    // Where the gradient of its job begins.
    first: u32,
    first_row: u32,
    first_column: u32,
    begin_block: u32,
    end_block: u32,
}

fn keep(job: Job, first: u32, row: u32, column: u32, scaled: vec4<f32>) {
    if row >= job.inputs || column >= job.outputs { return; }
    let sum = all.down * scaled;
    let place = first + row * job.outputs + column;
    let left = job.outputs - column;
    partial[place] = sum.x;
    if left > 1u { partial[place + 1u] = sum.y; }
    if left > 2u { partial[place + 2u] = sum.z; }
    if left > 3u { partial[place + 3u] = sum.w; }
}

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(subgroup_id) subgroup: u32,
    @builtin(subgroup_invocation_id) lane: u32,
) {
    let place = workgroup.y * workgroups.x + workgroup.x;
    // Workgroups after the last tile make it again: they write the same.
    var tile = min(place / all.splits, jobs[all.jobs - 1u].end - 1u);
    let split = place % all.splits;
    let found = job_of(tile);
    let job = jobs[found.index];
    tile -= found.begin;
    let first = (all.slot + split) * all.length + job.weight;
    let begin_block = split * all.split_blocks;
    let end_block = min(begin_block + all.split_blocks, all.blocks);
    let tiles = (job.outputs + TILE_COLUMNS - 1u) / TILE_COLUMNS;
    let first_row = tile / tiles * TILE_ROWS + subgroup / ACROSS * ROWS_EACH;
    let first_column = tile % tiles * TILE_COLUMNS + subgroup % ACROSS * COLUMNS_EACH;
    // Nothing to multiply where only summands are summed up.
    let products_end = select(end_block, begin_block, job.inputs == 0u);
    make_part(job, Part(first, first_row, first_column, begin_block, products_end), subgroup, lane);

    if job.inputs == 0u {
        // Every subgroup takes some rows, every thread some samples.
        for (var row = subgroup; row < job.outputs; row += SUBGROUPS) {
            var sum = vec4<f32>(0.0);
            for (var group = begin_block * 16u + lane; group < end_block * 16u; group += 32u) {
                sum += summand[(job.z_row + row) * all.blocks * 16u + group];
            }
            let staged = subgroup * 16u * STAGE_STRIDE;
            stage[staged + lane] = sum;
            subgroupBarrier();
            if lane == 0u {
                for (var i = 1u; i < 32u; i += 1u) { sum += stage[staged + i]; }
                partial[first + row] = dot(sum, vec4<f32>(1.0));
            }
            subgroupBarrier();
        }
    }
}
