// Actions with the standard normal noise that `y` holds at their place.
fn action_of(output: u32, place: u32, mean: vec4<f32>) -> vec4<f32> {
    return fma(vec4<f32>(exp(parameters[shape.log_std + output])), y[place], mean);
}
