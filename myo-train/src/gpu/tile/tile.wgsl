// What all kernels that make a product tile by tile have in common. mod.rs writes the sizes of the tile, as constants, and
// over_inputs.rs or over_samples.rs writes `make_tile`, where loops over a thread's own entries are written out. The kernel says
// what `shape`, `fetch_w`, `fetch_x`, `fetch_bias` and `keep` are.

const THREADS = THREADS_X * THREADS_Y;

// What a workgroup shares: two halves of what is multiplied between two barriers.
var<workgroup> w_tile: array<vec4<f32>, DEPTH * TILE_OUTPUTS / 2u>;
var<workgroup> x_tile: array<vec4<f32>, 2u * DEPTH * TILE_GROUPS>;

// First row and first group of columns of a tile.
struct Corner {
    output: u32,
    group: u32,
}

// Layers without outputs have one empty row of tiles.
fn corner_of(tile: u32) -> Corner {
    let tiles = max((shape.outputs + TILE_OUTPUTS - 1u) / TILE_OUTPUTS, 1u);
    return Corner((tile % tiles) * TILE_OUTPUTS, (tile / tiles) * TILE_GROUPS);
}
