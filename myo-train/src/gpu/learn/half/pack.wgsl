// Packs the weights for the matrix units: rounded to 16 bits, in matrices of 16 lines one after the other, zero where there is
// no weight. Every layer comes twice: with an output's inputs in a line and with an input's outputs. One thread per four.

enable f16;

struct Job {
    // Groups of four of this job and those before it.
    end: u32,
    lines: u32,
    // Weights in a line, and matrices.
    length: u32,
    matrices: u32,
    // First weight; from one to the next within a line, and from one line to the next.
    weight: u32,
    step: u32,
    line_step: u32,
    spare: u32,
}

struct Shape {
    jobs: u32,
}

@group(0) @binding(0) var<storage, read> parameters: array<f32>;
@group(0) @binding(1) var<storage, read> jobs: array<Job>;
@group(0) @binding(2) var<storage, read_write> packed: array<vec4<f16>>;
@group(0) @binding(3) var<uniform> all: Shape;

@compute @workgroup_size(256)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let place = (workgroup.y * workgroups.x + workgroup.x) * 256u + local;
    var tile = place;
    let found = job_of(tile);
    let job = jobs[found.index];
    if tile >= job.end { return; }
    tile -= found.begin;
    let matrix = tile / 64u;
    let line = matrix / job.matrices * 16u + tile % 64u / 4u;
    let first = matrix % job.matrices * 16u + tile % 4u * 4u;
    var four = vec4<f32>(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        let at = first + i;
        if line < job.lines && at < job.length {
            four[i] = parameters[job.weight + line * job.line_step + at * job.step];
        }
    }
    packed[place] = vec4<f16>(clamp(four, vec4<f32>(-65504.0), vec4<f32>(65504.0)));
}
