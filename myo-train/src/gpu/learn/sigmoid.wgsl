fn sigmoid(z: vec4<f32>) -> vec4<f32> {
    // Held where the exponential would overflow.
    return 1.0 / (1.0 + exp(-max(z, vec4<f32>(-87.0))));
}
