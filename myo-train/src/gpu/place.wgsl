    // Where the tile lies, and this thread in it. Layers without outputs have one empty row of tiles.
    let tiles = max((shape.outputs + TILE_OUTPUTS - 1u) / TILE_OUTPUTS, 1u);
    let first_output = (tile % tiles) * TILE_OUTPUTS;
    let first_group = (tile / tiles) * TILE_GROUPS;
    let at_x = local % THREADS_X;
    let at_y = local / THREADS_X;