// Hidden layers.
fn keep(output: u32, group: u32, sum: vec4<f32>) {
    y[output * shape.y_stride + shape.y_first + group] = silu(sum);
}

fn silu(z: vec4<f32>) -> vec4<f32> {
    // Held where the exponential would overflow.
    return z / (1.0 + exp(-max(z, vec4<f32>(-87.0))));
}
