//! Products of weights and columns of samples: sums over the inputs of a layer.

use std::fmt::Write;

use super::Tile;

/// Which of the weights lie side by side: neighbouring threads fetch neighbouring ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// Those of neighbouring outputs.
    AsStored,
    /// Those of neighbouring inputs: the product is one with the transposed weights.
    Transposed,
}

impl Tile {
    /// What a kernel needs besides its own files. `make_tile(tile, local)` makes a tile and hands its sums to `keep`.
    pub fn over_inputs(self, weights: Weights) -> String {
        let (zero, multiply, keep) = (self.zero(), self.multiply(), self.keep());
        let [fetch_first, fetch_next] = [true, false].map(|first| self.fetch(first, weights));
        let store = self.store(weights);
        self.with(&format!(
            "fn make_tile(tile: u32, local: u32) {{
    let corner = corner_of(tile);
    let at_x = local % THREADS_X;
    let at_y = local / THREADS_X;
{zero}{fetch_first}    // Which half of the shared memory this depth takes.
    var half = 0u;
    for (var depth = 0u; depth < shape.inputs; depth += DEPTH) {{
{store}        workgroupBarrier();
{fetch_next}{multiply}        half = 1u - half;
    }}
{keep}}}
"
        ))
    }

    /// Input within the depth, and row within the tile, of an entry of W.
    fn w_place(self, at: &str, weights: Weights) -> [String; 2] {
        match weights {
            Weights::AsStored => [format!("({at}) / {}u", self.outputs), format!("({at}) % {}u", self.outputs)],
            Weights::Transposed => [format!("({at}) % {}u", self.depth), format!("({at}) / {}u", self.depth)],
        }
    }

    /// Copies to registers: entries `local`, `local + THREADS` and so on of both tiles.
    fn fetch(self, first: bool, weights: Weights) -> String {
        let (keyword, depth) = if first { ("var ", "0u") } else { ("", "depth + DEPTH") };
        let (groups, mut text) = (self.columns / 4, String::new());
        for (piece, at) in self.pieces(self.w_numbers()) {
            let [input, output] = self.w_place(&at, weights);
            let place = format!("{depth} + {input}, corner.output + {output}");
            _ = writeln!(text, "    {keyword}w_next_{piece} = fetch_w({place});");
        }
        for (piece, at) in self.pieces(self.x_groups()) {
            let place = format!("{depth} + ({at}) / {groups}u, corner.group + ({at}) % {groups}u");
            _ = writeln!(text, "    {keyword}x_next_{piece} = fetch_x({place});");
        }
        text
    }

    /// Copies from registers to shared memory.
    fn store(self, weights: Weights) -> String {
        let (w_half, x_half, mut text) = (self.w_numbers() / 4, self.x_groups(), String::new());
        for (piece, at) in self.pieces(self.w_numbers()) {
            let guard = self.guard(piece, self.w_numbers());
            let [input, output] = self.w_place(&at, weights);
            let row = format!("half * {w_half}u + {input} * {}u + ({output}) / 4u", self.outputs / 4);
            let place = format!("w_tile[{row}][({output}) % 4u]");
            _ = writeln!(text, "        {guard}{{ {place} = w_next_{piece}; }}");
        }
        for (piece, at) in self.pieces(self.x_groups()) {
            let guard = self.guard(piece, self.x_groups());
            _ = writeln!(text, "        {guard}{{ x_tile[half * {x_half}u + {at}] = x_next_{piece}; }}");
        }
        text
    }
}
