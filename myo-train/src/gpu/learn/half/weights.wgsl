// Gradients of weights, dW = dZ H^T summed over samples, of all layers of both networks in one dispatch, on the matrix units.
// Under every layer's H lies a row of ones, of which the gradients of the biases come out, after those of the weights as among
// the parameters. The samples are split among workgroups; each writes a partial gradient, summed up in order by reduce.wgsl.
//
// Samples lie in groups of 16, rows of one group one after the other, so that matrices are loaded from where they are. Rows of a
// tile are inputs of the layer, columns its outputs. What a tile reads beyond its job belongs to other rows and is left out.

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

const TILE_ROWS = $TILE_ROWSu;
const TILE_COLUMNS = $TILE_COLUMNSu;

$UNITS

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
$JOB
    tile -= begin;
    let first = (all.slot + split) * all.length + job.weight;
    let begin_block = split * all.split_blocks;
    let end_block = min(begin_block + all.split_blocks, all.blocks);

    let line = lane / 4u;
    let quad = lane % 4u;
    let staged = subgroup * 16u * STAGE_STRIDE;
    let tiles = (job.outputs + TILE_COLUMNS - 1u) / TILE_COLUMNS;
    let first_row = tile / tiles * TILE_ROWS + subgroup / $ACROSSu * $ROWS_EACHu;
    let first_column = tile % tiles * TILE_COLUMNS + subgroup % $ACROSSu * $COLUMNS_EACHu;
    // Nothing to multiply where only summands are summed up.
    let products_end = select(end_block, begin_block, job.inputs == 0u);

$ZERO
    // Groups of four numbers from 16 samples to the next.
    let h_step = all.h_rows * 4u;
    let z_step = all.z_rows * 4u;
    var h = (begin_block * 4u * all.h_rows + job.h_row + first_row) * 4u;
    var z = (begin_block * 4u * all.z_rows + job.z_row + first_column) * 4u;
$FIRST
    for (var block = begin_block; block < products_end; block += 1u) {
        for (var samples = 0u; samples < 64u; samples += 16u) {
            // After the last ones the last ones again.
            let more = block + 1u < products_end || samples < 48u;
            h += select(0u, h_step, more);
            z += select(0u, z_step, more);
$NEXT
$MULTIPLY
$MOVE
        }
    }
$KEEP

    if job.inputs == 0u {
        // Every subgroup takes some rows, every thread some samples.
        for (var row = subgroup; row < job.outputs; row += SUBGROUPS) {
            var sum = vec4<f32>(0.0);
            for (var group = begin_block * 16u + lane; group < end_block * 16u; group += 32u) {
                sum += summand[(job.z_row + row) * all.blocks * 16u + group];
            }
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
