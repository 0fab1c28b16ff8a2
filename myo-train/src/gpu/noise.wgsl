// All noise of a roll-out at once: one thread per sample draws standard normal numbers for its action, and the logarithm of
// the probability density of the action, which depends on nothing else:
//
// ln density = -sum ln std - actions ln(2 pi) / 2 - sum noise^2 / 2.
//
// The same counters and formulas as in random.rs and gaussian.rs; `open_units` is printed of what they call, see noise.rs.

struct Shape {
    num_envs: u32,
    // Columns of one step, and of all.
    padded: u32,
    columns: u32,
    actions: u32,
    // Place of the logarithms of the standard deviations.
    log_std: u32,
    // The first so many environments act without.
    noise_free: u32,
    // Draws that the noise of an action is the sum of.
    noise_steps: u32,
}

@group(0) @binding(0) var<storage, read> parameters: array<f32>;
// Seed and number of the first step, low halves first.
@group(0) @binding(1) var<storage, read> clock: array<u32>;
// (actions, columns)
@group(0) @binding(2) var<storage, read_write> noise: array<f32>;
@group(0) @binding(3) var<storage, read_write> log_prob: array<f32>;
// What is left of earlier draws, as in `fill_held` of random.rs: (actions, columns)
@group(0) @binding(4) var<storage, read_write> held: array<f32>;
@group(0) @binding(5) var<uniform> shape: Shape;

const STREAM = 2u;
const HALF_LN_TAU = 0.9189385;
const LN_2 = 0.6931472;
const TAU = 6.2831855;

// Natural logarithm. The built-in one may be off by 5e-7 near 1, where the result must not become positive.
fn logarithm(x: f32) -> f32 {
    let bits = bitcast<u32>(x);
    let e = bitcast<i32>(bits - 0x3f3504f3u) >> 23u;
    let m = bitcast<f32>(bits - (bitcast<u32>(e) << 23u));
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    var p = 2.0 / 9.0;
    p = fma(p, s2, 2.0 / 7.0);
    p = fma(p, s2, 2.0 / 5.0);
    p = fma(p, s2, 2.0 / 3.0);
    p = fma(p, s2, 2.0);
    return fma(f32(e), LN_2, s * p);
}

// Cosine and sine of `t` turns.
fn cos_sin_turns(t: f32) -> vec2<f32> {
    let quarter = i32(fma(t, 4.0, 0.5));
    let a = fma(f32(quarter), -0.25, t) * TAU;
    let a2 = a * a;
    var s = 1.0 / 362880.0;
    s = fma(s, a2, -1.0 / 5040.0);
    s = fma(s, a2, 1.0 / 120.0);
    s = fma(s, a2, -1.0 / 6.0);
    s = fma(s, a2, 1.0) * a;
    var c = 1.0 / 40320.0;
    c = fma(c, a2, -1.0 / 720.0);
    c = fma(c, a2, 1.0 / 24.0);
    c = fma(c, a2, -0.5);
    c = fma(c, a2, 1.0);
    let swap = (quarter & 1) != 0;
    let cosine = select(c, s, swap);
    let sine = select(s, c, swap);
    return vec2<f32>(
        select(cosine, -cosine, ((quarter + 1) & 2) != 0),
        select(sine, -sine, (quarter & 2) != 0),
    );
}

// Two standard normal numbers from uniform ones in (0, 1) (Box and Muller, doi 10.1214/aoms/1177706645).
fn normal_pair(first: f32, second: f32) -> vec2<f32> {
    return sqrt(-2.0 * logarithm(first)) * cos_sin_turns(second);
}

fn log_peak() -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < shape.actions; i += 1u) {
        sum += parameters[shape.log_std + i];
    }
    return -sum - f32(shape.actions) * HALF_LN_TAU;
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let column = (workgroup.y * workgroups.x + workgroup.x) * 64u + local;
    let env = column % shape.padded;
    if column >= shape.columns || env >= shape.num_envs { return; }

    // The step's number has 64 bits.
    let low = clock[2] + column / shape.padded;
    let high = clock[3] + select(0u, 1u, low < clock[2]);
    var seed = array<u32, 2>(clock[0], clock[1]);
    let blocks = (shape.actions + 3u) / 4u;
    var squares = 0.0;
    for (var block = 0u; block < blocks; block += 1u) {
        var normal = vec4<f32>(0.0);
        var left = vec4<f32>(0.0);
        for (var earlier = 0u; earlier < shape.noise_steps && env >= shape.noise_free; earlier += 1u) {
            var counter = array<u32, 4>(env * blocks + block, low - earlier, high - select(0u, 1u, low < earlier), STREAM);
            var units: array<f32, 4>;
            open_units(&seed, &counter, &units);
            let draw = vec4<f32>(normal_pair(units[0], units[1]), normal_pair(units[2], units[3]));
            if earlier == 0u { normal = draw; } else { left += draw; }
        }
        for (var i = 0u; i < 4u; i += 1u) {
            let action = 4u * block + i;
            if action < shape.actions {
                noise[action * shape.columns + column] = normal[i];
                held[action * shape.columns + column] = left[i];
                squares += normal[i] * normal[i];
            }
        }
    }
    log_prob[column] = log_peak() - 0.5 * squares;
}
