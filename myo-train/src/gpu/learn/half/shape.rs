//! The kernel that takes samples through both networks and back, as far as it depends on their sizes.

use std::fmt::Write;

use myo_gpu::Adapter;

use super::super::layers::layers;
use super::super::layout::Precision;
use crate::gpu::units::{Matrices, STAGE_BYTES, SUBGROUP, THREAD, UNIT, units};
use crate::networks::Networks;

/// Columns that a workgroup may take: few give more workgroups and share their work among more threads, many use a weight more
/// often.
const COLUMNS: [u32; 2] = [32, 64];

/// The better of them on an H200 (`benches/examples/gpu_learner.rs`, `tiles`).
pub fn columns_for(networks: &Networks, samples: usize) -> u32 {
    let [few, many] = COLUMNS;
    if widest(networks) > 128 && samples >= 4096 { many } else { few }
}

/// Inputs or outputs of the widest layer.
fn widest(networks: &Networks) -> usize {
    let layers = layers(networks, 0, Precision::Half).into_iter().flatten();
    layers.map(|layer| layer.inputs.max(layer.outputs)).max().unwrap_or(1)
}

/// Sizes of the kernel.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Columns of a workgroup.
    pub columns: u32,
    /// Matrices of 16 rows that the widest layer has.
    rows16: u32,
}

impl Shape {
    /// For these networks.
    pub fn new(networks: &Networks, columns: u32) -> Self {
        Self { columns, rows16: matrices(widest(networks)) as u32 }
    }

    /// A power of two: threads share the columns evenly.
    fn subgroups(self) -> u32 {
        let most = if self.columns > 32 { 8 } else { 16 };
        self.rows16.next_power_of_two().clamp(self.columns / SUBGROUP, most)
    }

    /// Threads of a workgroup.
    pub fn threads(self) -> u32 {
        SUBGROUP * self.subgroups()
    }

    fn shared_bytes(self) -> u32 {
        UNIT * self.rows16 * (self.columns + 8) * 2 + self.subgroups() * STAGE_BYTES
    }

    /// What a subgroup makes.
    fn matrices(self) -> Matrices {
        Matrices { rows: self.rows16.div_ceil(self.subgroups()), columns: self.columns / UNIT }
    }

    /// The kernel.
    pub fn text(self) -> String {
        const FILES: &str =
            concat!(include_str!("passes.wgsl"), include_str!("../objective.wgsl"), include_str!("../sigmoid.wgsl"));
        let sizes = format!("const COLUMNS = {}u;\nconst ROWS = {}u;\n", self.columns, UNIT * self.rows16);
        [FILES, &units(self.subgroups()), &sizes, &self.forward(), &self.backward()].concat()
    }

    /// From what goes into a layer, in `x_tile`, to what goes into the next one, in its place.
    fn forward(self) -> String {
        let keep = self.matrices().staged(|row, column, half| {
            let (at, sum) = (self.place(row, column, half), format!("sum_{half} + bias_{row}_{half}"));
            self.if_there(row, &format!("keep_forward(layer, hidden, first_output, {at}, {sum});"))
        });
        let (biases, product) = (self.biases(), self.product());
        format!(
            "
fn forward(layer: Layer, hidden: bool, first_output: u32, subgroup: u32, lane: u32) {{
{THREAD}    let weight = layer.weight;
    let rows16 = in_matrices(layer.outputs);
    let depth16 = in_matrices(layer.inputs);
{biases}{product}    // Everyone has read what went in.
    workgroupBarrier();
{keep}    workgroupBarrier();
}}
"
        )
    }

    /// From the gradients with respect to the outputs of a layer, in `x_tile`, to those of the layer below, in their place.
    fn backward(self) -> String {
        let keep = self.matrices().staged(|row, column, half| {
            let at = self.place(row, column, half);
            let dz = format!("sum_{half} * vec4<f32>(d_{row}_{column}_{half})");
            self.if_there(row, &format!("keep_backward(below, {at}, {dz});"))
        });
        let (product, derivatives) = (self.product(), self.derivatives());
        format!(
            "
fn backward(layer: Layer, below: Layer, subgroup: u32, lane: u32) {{
{THREAD}    let weight = layer.transposed;
    let rows16 = in_matrices(layer.inputs);
    let depth16 = in_matrices(layer.outputs);
{product}{derivatives}    workgroupBarrier();
{keep}    workgroupBarrier();
}}
"
        )
    }

    /// A statement for those of a subgroup's rows of matrices that the layer has.
    fn if_there(self, row: u32, statement: &str) -> String {
        format!("if subgroup + {}u < rows16 {{ {statement} }}", row * self.subgroups())
    }

    /// Row of a thread's group of four within the layer.
    fn line(self, row: u32, half: u32) -> String {
        format!("16u * (subgroup + {}u) + {}u + line", row * self.subgroups(), 8 * half)
    }

    /// Row and group of columns of a thread's group of four.
    fn place(self, row: u32, column: u32, half: u32) -> String {
        format!("{}, {}u + quad", self.line(row, half), UNIT / 4 * column)
    }

    /// Biases of the rows that a thread will keep.
    fn biases(self) -> String {
        let rows = (0..self.matrices().rows).flat_map(|row| [(row, 0), (row, 1)]);
        let bias = |(row, half)| format!("    let bias_{row}_{half} = bias_of(layer, {});\n", self.line(row, half));
        rows.map(bias).collect()
    }

    /// Derivatives of all that a thread will keep, fetched at once.
    fn derivatives(self) -> String {
        self.matrices().each(|row, column| {
            let one = |half| {
                let place = self.place(row, column, half);
                format!("    let d_{row}_{column}_{half} = derivative_of(below, {place});\n")
            };
            one(0) + &one(1)
        })
    }

    /// The subgroup's matrices of the product of packed weights, from `weight` on, with what goes into the layer.
    fn product(self) -> String {
        let matrices = self.matrices();
        let mut text = matrices.zero();
        for row in 0..matrices.rows {
            // Beyond the last row the last one again, which nobody keeps.
            let matrix = format!("min(subgroup + {}u, rows16 - 1u)", row * self.subgroups());
            _ = writeln!(text, "    let line_{row} = weight + {matrix} * depth16 * 64u;");
        }
        text.push_str("    for (var k = 0u; k < depth16; k += 1u) {\n");
        for row in 0..matrices.rows {
            let place = format!("line_{row} + 64u * k");
            _ = writeln!(text, "        let w_{row} = coopLoadT<coop_mat16x16<f16, A>>(&packed[{place}], 4u);");
        }
        for column in 0..matrices.columns {
            let place = format!("16u * k * STRIDE + {}u", UNIT / 4 * column);
            _ = writeln!(text, "        let x_{column} = coopLoadT<coop_mat16x16<f16, B>>(&x_tile[{place}], STRIDE);");
        }
        text + &matrices.multiply() + "    }\n"
    }
}

/// Whether the networks are narrow enough for a card: what goes into a layer has room in shared memory.
pub fn fits(networks: &Networks, adapter: &Adapter) -> bool {
    fits_within(networks, adapter.max_workgroup_bytes, adapter.max_workgroup_threads)
}

fn fits_within(networks: &Networks, bytes: u32, threads: u32) -> bool {
    let mut shapes = COLUMNS.iter().map(|&columns| Shape::new(networks, columns));
    shapes.all(|shape| shape.shared_bytes() <= bytes && shape.threads() <= threads)
}

/// Matrices of 16 that hold so many rows or columns.
pub fn matrices(size: usize) -> usize {
    size.div_ceil(UNIT as usize)
}

/// Kernels for layers of so many matrices, with fewer, as many and more than there are subgroups.
#[cfg(test)]
pub fn texts() -> Vec<String> {
    let shapes = [1, 2, 3, 8, 9, 16].into_iter().flat_map(|rows16| COLUMNS.map(|columns| Shape { columns, rows16 }));
    shapes.map(Shape::text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mlp;

    fn networks(policy: &[usize], value: &[usize]) -> Networks {
        Networks { policy: Mlp::new(55, policy, 26), value: Mlp::new(55, value, 1) }
    }

    #[test]
    fn wide_networks_do_not_fit() {
        let fits = |networks: &Networks| fits_within(networks, 48 << 10, 1024);
        assert!(fits(&networks(&[256], &[256])));
        assert!(!fits(&networks(&[128], &[257])));
        assert!(!fits(&Networks { policy: Mlp::new(600, &[128], 26), value: Mlp::new(600, &[128], 1) }));
        assert!(!fits_within(&networks(&[256], &[256]), 16 << 10, 1024));
        assert!(!fits_within(&networks(&[256], &[256]), 48 << 10, 256));
    }
}
