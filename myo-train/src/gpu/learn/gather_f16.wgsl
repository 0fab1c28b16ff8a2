// Activations for products on matrix units.
enable f16;

alias Real = f16;

// Columns in groups of 16, rows of one group one after the other.
fn place_of(row: u32, column: u32, rows: u32, columns: u32) -> u32 {
    return (column / 16u * rows + row) * 16u + column % 16u;
}
