// From the gradients with respect to the outputs of the layers to those with respect to the outputs of the layers below: a
// product with the transposed weights, times the derivatives, which lie where it goes.

@group(0) @binding(3) var<uniform> all: Shape;

fn weight_at(input: u32, output: u32) -> u32 {
    return shape.weight + output * shape.inputs + input;
}

fn entering(place: u32) -> vec4<f32> {
    return gradient[place];
}

fn fetch_bias(output: u32) -> f32 {
    return 0.0;
}

fn keep(output: u32, group: u32, sum: vec4<f32>) {
    gradient[(shape.y_row + output) * shape.groups + group] *= sum;
}
