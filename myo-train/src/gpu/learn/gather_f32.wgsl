// Activations for products made by threads.

alias Real = f32;

// Rows one after the other.
fn place_of(row: u32, column: u32, rows: u32, columns: u32) -> u32 {
    return row * columns + column;
}
