// Keeps observations: one workgroup per observation feature and WORKGROUP environments.
//
// Normalises the current observations, adds up their moments, and keeps the last observations of episodes that the time
// limit cut off with the step before.

struct Shape {
    num_envs: u32,
    features: u32,
    // From one row of the record to the next, first column of these observations, first column for last observations.
    stride: u32,
    first: u32,
    last: u32,
    // Whether a step came before.
    stepped: u32,
    // Place of these moments in their row, and the length of a row.
    moment: u32,
    moments: u32,
    limit: f32,
}

// (features, num_envs)
@group(0) @binding(0) var<storage, read> observation: array<f32>;
@group(0) @binding(1) var<storage, read> final_observation: array<f32>;
// Reward, terminated, truncated: (3, num_envs)
@group(0) @binding(2) var<storage, read> result: array<f32>;
// Means, then one over standard deviations.
@group(0) @binding(3) var<storage, read> scaling: array<f32>;
// (features, stride)
@group(0) @binding(4) var<storage, read_write> record: array<f32>;
// Sums of x - mean, then of its square, a row each per feature.
@group(0) @binding(5) var<storage, read_write> moments: array<f32>;
// Least feature that was not finite.
@group(0) @binding(6) var<storage, read_write> wrong: array<atomic<u32>>;
@group(0) @binding(7) var<uniform> shape: Shape;

const WORKGROUP = 256u;

var<workgroup> sums: array<vec2<f32>, WORKGROUP>;

// As in simd.rs; NaN becomes the lower limit.
fn normalized(deviation: f32, scale: f32) -> f32 {
    let x = deviation * scale;
    return min(select(-shape.limit, x, x > -shape.limit), shape.limit);
}

fn note_if_wrong(x: f32, feature: u32) {
    if (bitcast<u32>(x) & 0x7f800000u) == 0x7f800000u {
        atomicMin(&wrong[0], feature);
    }
}

@compute @workgroup_size(256)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let chunks = (shape.num_envs + WORKGROUP - 1u) / WORKGROUP;
    let group = workgroup.y * workgroups.x + workgroup.x;
    let feature = group / chunks;
    let chunk = group % chunks;
    let env = chunk * WORKGROUP + local;

    var mine = vec2<f32>(0.0);
    if feature < shape.features && env < shape.num_envs {
        let mean = scaling[feature];
        let scale = scaling[shape.features + feature];
        let x = observation[feature * shape.num_envs + env];
        let row = feature * shape.stride;
        record[row + shape.first + env] = normalized(x - mean, scale);
        note_if_wrong(x, feature);
        mine = vec2<f32>(x - mean, (x - mean) * (x - mean));
        if shape.stepped != 0u && result[2u * shape.num_envs + env] > 0.5 {
            let last = final_observation[feature * shape.num_envs + env];
            record[row + shape.last + env] = normalized(last - mean, scale);
            note_if_wrong(last, feature);
        }
    }

    sums[local] = mine;
    for (var half = WORKGROUP / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            sums[local] += sums[local + half];
        }
    }
    if local == 0u && feature < shape.features {
        let place = feature * shape.moments + shape.moment + chunk;
        moments[place] = sums[0].x;
        moments[shape.features * shape.moments + place] = sums[0].y;
    }
}
