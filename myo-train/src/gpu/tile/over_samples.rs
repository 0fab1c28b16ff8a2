//! Products over samples, which lie side by side in both factors: they are fetched in groups of four and turned round on their
//! way to the shared memory. The sums over the samples of the second factor come out besides.

use std::fmt::Write;

use super::Tile;

impl Tile {
    /// What a kernel needs besides its own files. `make_tile(tile, local, start, end)` makes a tile from samples `start` to
    /// `end` and hands its sums to `keep`; those of X lie in `x_tile`, `DEPTH / 4` to a column, when it calls
    /// `keep_column_sums(group, local)`.
    pub fn over_samples(self) -> String {
        let (zero, multiply, keep) = (self.zero(), self.multiply(), self.keep());
        let [fetch_first, fetch_next] = [true, false].map(|first| self.fetch_samples(first));
        let store = self.store_turned();
        let (zero_sums, add_to_sums, store_sums) = (self.zero_sums(), self.add_to_sums(), self.store_sums());
        self.with(&format!(
            "fn make_tile(tile: u32, local: u32, start: u32, end: u32) {{
    let corner = corner_of(tile);
    let at_x = local % THREADS_X;
    let at_y = local / THREADS_X;
{zero}{zero_sums}{fetch_first}    // Which half of the shared memory this depth takes.
    var half = 0u;
    for (var depth = start; depth < end; depth += DEPTH) {{
{store}{add_to_sums}        workgroupBarrier();
{fetch_next}{multiply}        half = 1u - half;
    }}
{keep}    // Once per column of tiles.
    if corner.output == 0u {{
        workgroupBarrier();
{store_sums}        workgroupBarrier();
        keep_column_sums(corner.group, local);
    }}
}}
"
        ))
    }

    /// Copies to registers, four samples of a row at a time.
    fn fetch_samples(self, first: bool) -> String {
        let (keyword, depth) = if first { ("var ", "start") } else { ("", "depth + DEPTH") };
        let (quads, mut text) = (self.depth / 4, String::new());
        for (factor, rows, first) in [("w", self.outputs, "corner.output"), ("x", self.columns, "4u * corner.group")] {
            for (piece, at) in self.pieces(rows * quads) {
                let place = format!("({depth}) / 4u + ({at}) % {quads}u, {first} + ({at}) / {quads}u");
                _ = writeln!(text, "    {keyword}{factor}_next_{piece} = fetch_{factor}({place});");
            }
        }
        text
    }

    /// Copies from registers to shared memory, every sample to its own depth.
    fn store_turned(self) -> String {
        let (quads, mut text) = (self.depth / 4, String::new());
        for (factor, rows) in [("w", self.outputs), ("x", self.columns)] {
            let half = self.depth * rows / 4;
            for (piece, at) in self.pieces(rows * quads) {
                let guard = self.guard(piece, rows * quads);
                _ = writeln!(
                    text,
                    "        {guard}{{ let row = ({at}) / {quads}u; let first = 4u * (({at}) % {quads}u);"
                );
                for (sample, part) in ["x", "y", "z", "w"].iter().enumerate() {
                    let place = format!("half * {half}u + (first + {sample}u) * {}u + row / 4u", rows / 4);
                    _ = writeln!(text, "            {factor}_tile[{place}][row % 4u] = {factor}_next_{piece}.{part};");
                }
                text.push_str("        }\n");
            }
        }
        text
    }

    /// Declares the thread's sums of X, zero.
    fn zero_sums(self) -> String {
        let pieces = self.pieces(self.columns * self.depth / 4);
        pieces.map(|(piece, _)| format!("    var sums_{piece} = 0.0;\n")).collect()
    }

    /// Adds what is about to be stored of X to them.
    fn add_to_sums(self) -> String {
        let pieces = self.pieces(self.columns * self.depth / 4);
        pieces.map(|(piece, _)| format!("        sums_{piece} += dot(x_next_{piece}, vec4<f32>(1.0));\n")).collect()
    }

    /// Puts them where X was.
    fn store_sums(self) -> String {
        let size = self.columns * self.depth / 4;
        let store = |(piece, at)| format!("        {}{{ x_tile[{at}].x = sums_{piece}; }}\n", self.guard(piece, size));
        self.pieces(size).map(store).collect()
    }
}
