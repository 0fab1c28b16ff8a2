// Sums of rows, always in the same order: one workgroup per row.

struct Shape {
    rows: u32,
    // Columns end before this one.
    end: u32,
    // From one row to the next.
    stride: u32,
    // Place of the first sum.
    first: u32,
    // They start with this one.
    start: u32,
    // From one column to the next.
    step: u32,
}

@group(0) @binding(0) var<storage, read> numbers: array<f32>;
@group(0) @binding(1) var<storage, read_write> sums: array<f32>;
@group(0) @binding(2) var<uniform> shape: Shape;

alias Summand = f32;

@compute @workgroup_size(256)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let row = workgroup.y * workgroups.x + workgroup.x;
    var mine = 0.0;
    if row < shape.rows {
        for (var column = shape.start + local * shape.step; column < shape.end; column += WORKGROUP * shape.step) {
            mine += numbers[row * shape.stride + column];
        }
    }
    let sum = workgroup_sum(local, mine);
    if local == 0u && row < shape.rows { sums[shape.first + row] = sum; }
}
