// Brings the samples of a chunk of a minibatch together: one thread per number. gather_f32.wgsl or gather_f16.wgsl says what
// activations are and where they lie.

struct Shape {
    num_envs: u32,
    padded: u32,
    samples: u32,
    // From one row of the observations to the next.
    record: u32,
    observations: u32,
    actions: u32,
    block: u32,
    // Columns to fill, and how many of them the minibatch has.
    chunk: u32,
    columns: u32,
    // Columns of the minibatch before this chunk.
    start: u32,
    // First block in the order of all passes.
    first: u32,
    // Gradient step.
    step: u32,
    // Of activations.
    rows: u32,
}

@group(0) @binding(0) var<storage, read> order: array<u32>;
@group(0) @binding(1) var<storage, read> observation: array<f32>;
@group(0) @binding(2) var<storage, read> action: array<f32>;
@group(0) @binding(3) var<storage, read> log_prob: array<f32>;
// Advantages, then targets.
@group(0) @binding(4) var<storage, read> estimate: array<f32>;
@group(0) @binding(5) var<storage, read> scale: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> activation: array<Real>;
// Action, log-probability, advantage, target, weight: (actions + 4, chunk)
@group(0) @binding(7) var<storage, read_write> sample: array<f32>;
@group(0) @binding(8) var<uniform> shape: Shape;

@compute @workgroup_size(256)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let thread = (workgroup.y * workgroups.x + workgroup.x) * 256u + local;
    let row = thread / shape.chunk;
    let column = thread % shape.chunk;
    if row >= shape.observations + shape.actions + 4u { return; }
    var source = 0u;
    var used = column < shape.columns;
    if used {
        let place = shape.start + column;
        source = order[shape.first + place / shape.block] * shape.block + place % shape.block;
        used = source < shape.samples && source % shape.padded < shape.num_envs;
    }
    if row < shape.observations {
        var x = 0.0;
        if used { x = observation[row * shape.record + source]; }
        activation[place_of(row, column, shape.rows, shape.chunk)] = Real(x);
    } else {
        var x = 0.0;
        if used { x = scalar(row - shape.observations, source); }
        sample[thread - shape.observations * shape.chunk] = x;
    }
}

fn scalar(row: u32, source: u32) -> f32 {
    if row < shape.actions { return action[row * shape.samples + source]; }
    let scaling = scale[shape.step];
    switch row - shape.actions {
        case 0u: { return log_prob[source]; }
        case 1u: { return (estimate[source] - scaling.x) * scaling.y; }
        case 2u: { return estimate[shape.samples + source]; }
        default: { return scaling.z; }
    }
}
