// Keeps what a step returned: one thread per environment and row of the sums over episodes.

struct Shape {
    num_envs: u32,
    // First column of the step in the records.
    first: u32,
    // Columns of an episode's summary.
    summary: u32,
    reward_scale: f32,
}

// Reward, terminated, truncated, summary: (3 + summary, num_envs)
@group(0) @binding(0) var<storage, read> result: array<f32>;
@group(0) @binding(1) var<storage, read_write> reward: array<f32>;
// 1 where the task ended the episode, 2 where the time limit did, else 0.
@group(0) @binding(2) var<storage, read_write> ended: array<u32>;
// Episodes that ended, then per column of the summary the sum of its entries and their number: (1 + 2 summary, num_envs)
@group(0) @binding(3) var<storage, read_write> episodes: array<f32>;
@group(0) @binding(4) var<uniform> shape: Shape;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let thread = (workgroup.y * workgroups.x + workgroup.x) * 64u + local;
    let n = shape.num_envs;
    let row = thread / n;
    let env = thread % n;
    if row >= 1u + 2u * shape.summary { return; }

    let terminated = result[n + env] > 0.5;
    let truncated = result[2u * n + env] > 0.5;
    if row == 0u {
        reward[shape.first + env] = shape.reward_scale * result[env];
        ended[shape.first + env] = select(select(0u, 2u, truncated), 1u, terminated);
    }

    // The first step of a roll-out begins the sums anew.
    let anew = shape.first == 0u;
    let counts = terminated || truncated;
    if anew || counts {
        var sum = 0.0;
        if !anew { sum = episodes[row * n + env]; }
        if counts { sum += entry(row, env); }
        episodes[row * n + env] = sum;
    }
}

// What an episode adds to a row; entries that are not a number are left out.
fn entry(row: u32, env: u32) -> f32 {
    if row == 0u { return 1.0; }
    let column = (row - 1u) % shape.summary;
    let x = result[(3u + column) * shape.num_envs + env];
    let number = (bitcast<u32>(x) & 0x7fffffffu) <= 0x7f800000u;
    if row > shape.summary { return select(0.0, 1.0, number); }
    return select(0.0, x, number);
}
