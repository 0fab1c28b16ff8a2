// Both networks and the loss, forward and backward, in one dispatch: every workgroup takes COLUMNS samples through one of the
// networks. What goes from layer to layer stays in shared memory, rounded to 16 bits; matrix units multiply it with the packed
// weights and sum up in 32 bits. Activations and gradients are written for the gradients of the weights (weights.wgsl).
//
// Subgroup s makes the rows 16 s to 16 s + 15 of a layer, then those 16 SUBGROUPS further, and so on. shape.rs writes `forward`
// and `backward`, where loops over a subgroup's own matrices are written out, as these cannot lie in arrays; COLUMNS; and ROWS,
// of the widest layer.

enable f16;
enable wgpu_cooperative_matrix;

struct Layer {
    inputs: u32,
    outputs: u32,
    // Where the packed weights begin with an output's inputs in a line and with an input's outputs, in groups of four.
    weight: u32,
    transposed: u32,
    bias: u32,
    // First row of its outputs among the activations and the gradients.
    h_row: u32,
    z_row: u32,
    spare: u32,
}

struct Shape {
    // Columns of every row, in groups of four.
    groups: u32,
    // Workgroups per network.
    blocks: u32,
    policy_layers: u32,
    value_layers: u32,
    // Of activations and of gradients.
    h_rows: u32,
    z_rows: u32,
    actions: u32,
    log_std: u32,
    clip: f32,
    // Weight of the squared error.
    value_coefficient: f32,
    // Factor of the gradients, which are as small as a minibatch is large.
    up: f32,
    // Between which means have an effect, and twice the weight of the squared distance beyond.
    least: f32,
    most: f32,
    bound_factor: f32,
}

@group(0) @binding(0) var<storage, read> parameters: array<f32>;
@group(0) @binding(1) var<storage, read> packed: array<vec4<f16>>;
@group(0) @binding(2) var<storage, read> layers: array<Layer>;
// Action, log-probability, advantage, target, weight: (actions + 4, columns)
@group(0) @binding(3) var<storage, read> sample: array<f32>;
@group(0) @binding(4) var<storage, read_write> activation: array<vec4<f16>>;
@group(0) @binding(5) var<storage, read_write> gradient: array<vec4<f16>>;
// Gradients of the logarithms of the standard deviations, four metrics: (actions + 4, columns)
@group(0) @binding(6) var<storage, read_write> summand: array<f32>;
// Of both networks: (actions + 1, columns)
@group(0) @binding(7) var<storage, read_write> output: array<vec4<f32>>;
@group(0) @binding(8) var<uniform> all: Shape;

const GROUPS = COLUMNS / 4u;
// Groups of four from one row to the next: eight rows lie in different banks.
const STRIDE = GROUPS + 2u;

// What goes into a layer: (rows, columns)
var<workgroup> x_tile: array<vec4<f16>, ROWS * STRIDE>;

var<private> first_group: u32;

// Place of row `row` of so many, in group `quad` of this workgroup's columns.
fn place_of(rows: u32, row: u32, quad: u32) -> u32 {
    let group = first_group + quad;
    return (group / 4u * rows + row) * 4u + group % 4u;
}

// Matrices of 16 that hold so many rows.
fn in_matrices(rows: u32) -> u32 {
    return (rows + 15u) / 16u;
}

fn bias_of(layer: Layer, row: u32) -> f32 {
    if row < layer.outputs { return parameters[layer.bias + row]; }
    return 0.0;
}

fn rounded(numbers: vec4<f32>) -> vec4<f16> {
    return vec4<f16>(clamp(numbers, vec4<f32>(-65504.0), vec4<f32>(65504.0)));
}

// Keeps four numbers z = W x + b of a layer: of the samples in `quad` of this workgroup's columns.
fn keep_forward(layer: Layer, hidden: bool, first_output: u32, row: u32, quad: u32, z: vec4<f32>) {
    var h = vec4<f32>(0.0);
    if row < layer.outputs {
        if hidden {
            let s = sigmoid(z);
            h = z * s;
            activation[place_of(all.h_rows, layer.h_row + row, quad)] = rounded(h);
            gradient[place_of(all.z_rows, layer.z_row + row, quad)] = rounded(fma(h, 1.0 - s, s));
        } else {
            output[(first_output + row) * all.groups + first_group + quad] = z;
        }
    }
    x_tile[row * STRIDE + quad] = rounded(h);
}

// Derivatives of four activations of a layer.
fn derivative_of(layer: Layer, row: u32, quad: u32) -> vec4<f16> {
    if row < layer.outputs { return gradient[place_of(all.z_rows, layer.z_row + row, quad)]; }
    return vec4<f16>(0.0);
}

// Keeps four gradients with respect to what went into the activation of the layer below, in place of its derivative.
fn keep_backward(below: Layer, row: u32, quad: u32, sum: vec4<f32>) {
    let dz = rounded(sum);
    if row < below.outputs { gradient[place_of(all.z_rows, below.z_row + row, quad)] = dz; }
    x_tile[row * STRIDE + quad] = dz;
}

// The row of ones after what goes into a layer: the gradients of its biases come out of it.
fn keep_ones(row: u32, quad: u32) {
    activation[place_of(all.h_rows, row, quad)] = vec4<f16>(1.0);
}

// Gradient with respect to output `i` of a network.
fn keep_output(layer: Layer, i: u32, column: u32, number: f32) {
    let dz = f16(clamp(all.up * number, -65504.0, 65504.0));
    x_tile[i * STRIDE + column / 4u][column % 4u] = dz;
    if i < layer.outputs {
        gradient[place_of(all.z_rows, layer.z_row + i, column / 4u)][column % 4u] = dz;
    }
}

// Entry `row` of this column of the samples.
fn of_sample(row: u32, column: u32) -> f32 {
    return sample[4u * (row * all.groups + first_group) + column];
}

fn output_of(row: u32, column: u32) -> f32 {
    return output[row * all.groups + first_group + column / 4u][column % 4u];
}

fn keep_summand(row: u32, column: u32, number: f32) {
    summand[4u * (row * all.groups + first_group) + column] = number;
}

fn z_of(i: u32, column: u32) -> f32 {
    return (of_sample(i, column) - output_of(i, column)) * exp(-parameters[all.log_std + i]);
}

// A column's share of squared z, of every PARTS-th action: PARTS threads work on a column.
const PARTS = THREADS / COLUMNS;

fn squares(column: u32, part: u32) -> f32 {
    var sum = 0.0;
    for (var i = part; i < all.actions; i += PARTS) {
        let z = z_of(i, column);
        sum += z * z;
    }
    return sum;
}

fn policy_loss(layer: Layer, column: u32, part: u32) {
    var squares = 0.0;
    for (var i = 0u; i < PARTS; i += 1u) { squares += stage[i * COLUMNS + column].x; }
    var log_stds = 0.0;
    for (var i = 0u; i < all.actions; i += 1u) { log_stds += parameters[all.log_std + i]; }
    let first = all.actions;
    let log_ratio = log_density(all.actions, squares, log_stds) - of_sample(first, column);
    let weight = of_sample(first + 3u, column);
    let objective = objective(log_ratio, of_sample(first + 1u, column), weight, all.clip);
    for (var i = part; i < 16u * in_matrices(layer.outputs); i += PARTS) {
        var dz = 0.0;
        if i < all.actions {
            let z = z_of(i, column);
            let back = weight * all.bound_factor * beyond(output_of(i, column), all.least, all.most);
            dz = fma(objective.slope * z, exp(-parameters[all.log_std + i]), back);
            keep_summand(i, column, objective.slope * (z * z - 1.0));
        }
        keep_output(layer, i, column, dz);
    }
    if part == 0u {
        keep_summand(first, column, objective.loss);
        keep_summand(first + 1u, column, objective.divergence);
        keep_summand(first + 2u, column, objective.cut);
    }
}

fn value_loss(layer: Layer, column: u32, part: u32) {
    let weight = of_sample(all.actions + 3u, column);
    let error = select(0.0, output_of(all.actions, column) - of_sample(all.actions + 2u, column), weight > 0.0);
    for (var i = part; i < 16u * in_matrices(layer.outputs); i += PARTS) {
        keep_output(layer, i, column, select(0.0, 2.0 * all.value_coefficient * weight * error, i == 0u));
    }
    if part == 0u { keep_summand(all.actions + 3u, column, error * error); }
}

@compute @workgroup_size(THREADS)
fn main(
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
    @builtin(subgroup_id) subgroup: u32,
    @builtin(subgroup_invocation_id) lane: u32,
) {
    let index = workgroup.y * workgroups.x + workgroup.x;
    let network = select(0u, 1u, index >= all.blocks);
    let first_layer = network * all.policy_layers;
    let last_layer = select(all.policy_layers, all.policy_layers + all.value_layers, network == 1u) - 1u;
    first_group = (index - network * all.blocks) * GROUPS;

    let entering = layers[first_layer].inputs;
    for (var item = local; item < 16u * in_matrices(entering) * GROUPS; item += THREADS) {
        let row = item / GROUPS;
        var x = vec4<f16>(0.0);
        if row < entering { x = activation[place_of(all.h_rows, row, item % GROUPS)]; }
        x_tile[row * STRIDE + item % GROUPS] = x;
    }
    if local < GROUPS { keep_ones(entering, local); }
    workgroupBarrier();

    for (var i = first_layer; i <= last_layer; i += 1u) {
        let layer = layers[i];
        let hidden = i < last_layer;
        if hidden && local < GROUPS { keep_ones(layer.h_row + layer.outputs, local); }
        forward(layer, hidden, network * all.actions, subgroup, lane);
    }

    let column = local % COLUMNS;
    let part = local / COLUMNS;
    let leaving = layers[last_layer];
    storageBarrier();
    if network == 0u { stage[local].x = squares(column, part); }
    workgroupBarrier();
    if network == 0u { policy_loss(leaving, column, part); } else { value_loss(leaving, column, part); }
    workgroupBarrier();

    for (var i = last_layer; i > first_layer; i -= 1u) {
        backward(layers[i], layers[i - 1u], subgroup, lane);
    }
}
