// Actions with the standard normal noise that `y` holds at their place.
fn action_of(output: u32, place: u32, mean: vec4<f32>) -> vec4<f32> {
    return fma(vec4<f32>(exp(parameters[shape.log_std + output])), y[place], mean);
}

@group(0) @binding(5) var<storage, read> held: array<vec4<f32>>;

// What is left of earlier noise.
fn held_of(output: u32, place: u32) -> vec4<f32> {
    return exp(parameters[shape.log_std + output]) * held[place];
}
