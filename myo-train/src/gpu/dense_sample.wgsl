// Sums are means of actions. `y` gets the actions, and the environment gets them mapped and clipped. `action_of` and `held_of`
// come from dense_noisy.wgsl or dense_mean.wgsl.

@group(0) @binding(4) var<storage, read_write> env_actions: array<f32>;

fn keep(output: u32, group: u32, mean: vec4<f32>) {
    let place = output * shape.y_stride + shape.y_first + group;
    let action = action_of(output, place, mean);
    y[place] = action;
    let done = action + held_of(output, place);
    let mapped = clamp(fma(vec4<f32>(shape.scale), done, vec4<f32>(shape.offset)), vec4<f32>(-1.0), vec4<f32>(1.0));
    let env = shape.first_env + 4u * group;
    let first = output * shape.num_envs + env;
    if env < shape.num_envs { env_actions[first] = mapped.x; }
    if env + 1u < shape.num_envs { env_actions[first + 1u] = mapped.y; }
    if env + 2u < shape.num_envs { env_actions[first + 2u] = mapped.z; }
    if env + 3u < shape.num_envs { env_actions[first + 3u] = mapped.w; }
}
