//! Between rows of environments, as callers have them, and columns, as a card has them.

/// Memory of the host, entries in the order of the card.
#[derive(Default)]
pub struct HostColumns {
    pub actions: Vec<f32>,
    pub observation: Vec<f32>,
    pub result: Vec<f32>,
    pub final_observation: Vec<f32>,
    pub episode: Vec<f32>,
}

/// Rows of environments to columns.
pub fn transpose(from: &[f32], rows: usize, columns: usize, to: &mut [f32]) {
    for (column, to) in to.chunks_exact_mut(rows).enumerate() {
        for (row, x) in to.iter_mut().enumerate() {
            *x = from[row * columns + column];
        }
    }
}
