// From what goes into the layers to their outputs, and their derivatives where they are hidden.

@group(0) @binding(3) var<storage, read_write> activation: array<vec4<f32>>;
@group(0) @binding(4) var<uniform> all: Shape;

fn weight_at(input: u32, output: u32) -> u32 {
    return shape.weight + input * shape.outputs + output;
}

fn entering(place: u32) -> vec4<f32> {
    return activation[place];
}

fn fetch_bias(output: u32) -> f32 {
    return parameters[shape.bias + output];
}

fn keep(output: u32, group: u32, z: vec4<f32>) {
    let place = (shape.y_row + output) * shape.groups + group;
    let above = all.observations * shape.groups;
    if shape.hidden == 0u {
        activation[above + place] = z;
        return;
    }
    let s = sigmoid(z);
    let h = z * s;
    activation[above + place] = h;
    gradient[place] = fma(h, 1.0 - s, s);
}
