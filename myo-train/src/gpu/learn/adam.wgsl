// One Adam step with the gradient shortened to `norm_max`, as in kernels.rs: one thread per parameter. Every workgroup sums
// up the squared length of the gradient for itself, always in the same order.

struct Shape {
    parameters: u32,
    // Partial sums of squares.
    parts: u32,
    // Gradient step of this update.
    step: u32,
    log_std: u32,
    actions: u32,
    norm_max: f32,
    beta1: f32,
    beta2: f32,
    epsilon: f32,
    log_std_min: f32,
    log_std_max: f32,
}

@group(0) @binding(0) var<storage, read> gradient: array<f32>;
@group(0) @binding(1) var<storage, read> squares: array<f32>;
// Step size and one over the root of the bias of v: (steps, 2)
@group(0) @binding(2) var<storage, read> rates: array<vec2<f32>>;
@group(0) @binding(3) var<storage, read_write> parameters: array<f32>;
@group(0) @binding(4) var<storage, read_write> mean: array<f32>;
@group(0) @binding(5) var<storage, read_write> square: array<f32>;
// Sums over the minibatch, length of the gradient, whether a parameter is not finite: (steps, 6)
@group(0) @binding(6) var<storage, read_write> metrics: array<f32>;
@group(0) @binding(7) var<uniform> shape: Shape;

alias Summand = f32;

@compute @workgroup_size(256)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    var mine = 0.0;
    for (var part = local; part < shape.parts; part += WORKGROUP) {
        mine += squares[part];
    }
    let norm = sqrt(workgroup_sum(local, mine));
    let i = (workgroup.y * workgroups.x + workgroup.x) * WORKGROUP + local;
    if i < 4u { metrics[6u * shape.step + i] = gradient[shape.parameters + i]; }
    if i == 4u { metrics[6u * shape.step + 4u] = norm; }
    if i >= shape.parameters { return; }

    // A gradient of length 0 needs no shortening.
    let scale = select(1.0, shape.norm_max / norm, norm > shape.norm_max);
    let g = scale * gradient[i];
    let m = fma(shape.beta1, mean[i] - g, g);
    let v = fma(shape.beta2, square[i] - g * g, g * g);
    mean[i] = m;
    square[i] = v;
    let rate = rates[shape.step];
    var w = parameters[i] - rate.x * m / fma(sqrt(v), rate.y, shape.epsilon);
    if i >= shape.log_std && i < shape.log_std + shape.actions {
        w = clamp(w, shape.log_std_min, shape.log_std_max);
    }
    parameters[i] = w;
    // All threads that write here write the same.
    if (bitcast<u32>(w) & 0x7f800000u) == 0x7f800000u { metrics[6u * shape.step + 5u] = 1.0; }
}
