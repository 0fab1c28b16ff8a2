// Sums stay as they are.
fn keep(output: u32, group: u32, sum: vec4<f32>) {
    y[output * shape.y_stride + shape.y_first + group] = sum;
}
