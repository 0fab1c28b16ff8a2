// Advantages and targets of the value network, as in gae.rs: one thread per environment, from the last step to the first.

struct Shape {
    num_envs: u32,
    // Columns of one step.
    padded: u32,
    steps: u32,
    // Control steps from one cut by the time limit to the next, at least: where the values of cut off episodes are.
    between_cuts: u32,
    gamma: f32,
    decay: f32,
    // The first so many environments acted without noise: they tried nothing that could have an advantage.
    noise_free: u32,
    // What an advantage counts for at most, where it is not 0.
    most: f32,
}

@group(0) @binding(0) var<storage, read> reward: array<f32>;
@group(0) @binding(1) var<storage, read> value: array<f32>;
// 1 where the task ended the episode, 2 where the time limit did, else 0.
@group(0) @binding(2) var<storage, read> ended: array<u32>;
// Advantages, then targets: (2, samples)
@group(0) @binding(3) var<storage, read_write> estimate: array<f32>;
// Sums of advantages, of targets, and of their squares: (4, num_envs)
@group(0) @binding(4) var<storage, read_write> sums: array<f32>;
@group(0) @binding(5) var<uniform> shape: Shape;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let env = (workgroup.y * workgroups.x + workgroup.x) * 64u + local;
    if env >= shape.num_envs { return; }
    let samples = shape.steps * shape.padded;
    var later = 0.0;
    var sum = vec4<f32>(0.0);
    for (var left = shape.steps; left > 0u; left -= 1u) {
        let t = left - 1u;
        let i = t * shape.padded + env;
        var next = value[i + shape.padded];
        if ended[i] == 1u {
            next = 0.0;
        } else if ended[i] == 2u {
            next = value[(shape.steps + 1u + t / shape.between_cuts) * shape.padded + env];
        }
        if ended[i] != 0u { later = 0.0; }
        let delta = reward[i] + shape.gamma * next - value[i];
        later = delta + shape.decay * later;
        let advantage = select(later, clamp(later, -shape.most, shape.most), shape.most > 0.0);
        let goal = advantage + value[i];
        estimate[i] = select(advantage, 0.0, env < shape.noise_free);
        estimate[samples + i] = goal;
        sum += vec4<f32>(advantage, goal, advantage * advantage, goal * goal);
    }
    sums[env] = sum.x;
    sums[shape.num_envs + env] = sum.y;
    sums[2u * shape.num_envs + env] = sum.z;
    sums[3u * shape.num_envs + env] = sum.w;
}
