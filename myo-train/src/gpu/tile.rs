//! Sizes of the tiles that a workgroup makes, and the parts of the kernel's text that depend on them.

use std::fmt::Write;

/// What one workgroup makes of a matrix product, and in which pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tile {
    /// Rows (outputs of the layer), a multiple of `per_thread.0`.
    pub outputs: u32,
    /// Columns (samples), a multiple of `per_thread.1`.
    pub columns: u32,
    /// Inputs multiplied between two barriers.
    pub depth: u32,
    /// Rows and columns of one thread, multiples of 4.
    pub per_thread: (u32, u32),
}

/// Shared memory that every device has, in bytes.
const PORTABLE_SHARED: u32 = 16 << 10;
/// Threads of a workgroup that every device can run.
const PORTABLE_THREADS: u32 = 256;

/// Text that several kernels have in common.
const SHARED: [(&str, &str); 4] = [
    ("$SIZES", include_str!("tile.wgsl")),
    ("$JOB", include_str!("learn/job.wgsl")),
    ("$PLACE", include_str!("place.wgsl")),
    ("$PRODUCT", include_str!("product_loop.wgsl")),
];

impl Tile {
    /// A tile of some rows and columns.
    ///
    /// # Panics
    /// The pieces do not fill the tile, or some card could not run it: more than 256 threads or 16 KiB.
    pub const fn new(outputs: u32, columns: u32, depth: u32, per_thread: (u32, u32)) -> Self {
        let tile = Self { outputs, columns, depth, per_thread };
        assert!(per_thread.0.is_multiple_of(4) && per_thread.1.is_multiple_of(4), "threads hold groups of four");
        assert!(outputs.is_multiple_of(per_thread.0) && columns.is_multiple_of(per_thread.1), "threads fill the tile");
        assert!(tile.threads() <= PORTABLE_THREADS, "at most 256 threads");
        // Twice what is multiplied between two barriers, 4 bytes each.
        assert!(2 * 4 * depth * (outputs + columns) <= PORTABLE_SHARED, "at most 16 KiB");
        tile
    }

    /// Threads of the workgroup.
    pub const fn threads(self) -> u32 {
        self.threads_x() * self.threads_y()
    }

    /// Workgroups for a layer.
    pub const fn workgroups(self, outputs: u32, columns: u32) -> u32 {
        outputs.div_ceil(self.outputs) * columns.div_ceil(self.columns)
    }

    const fn threads_x(self) -> u32 {
        self.columns / self.per_thread.1
    }

    const fn threads_y(self) -> u32 {
        self.outputs / self.per_thread.0
    }

    /// Numbers of W in shared memory.
    const fn w_numbers(self) -> u32 {
        self.depth * self.outputs
    }

    /// Groups of four numbers of X in shared memory.
    const fn x_groups(self) -> u32 {
        self.depth * self.columns / 4
    }

    /// Fills in everything in the kernel's text that depends on the tile. `finish` is what becomes of the sum in row
    /// `output` and group `group`, as statements that use them.
    pub fn fill_in(self, template: &str, finish: &str) -> String {
        self.fill_in_copies(template, finish, false)
    }

    /// As [`Tile::fill_in`] for a product with the transposed weights: neighbouring threads fetch neighbouring inputs.
    pub fn fill_in_transposed(self, template: &str, finish: &str) -> String {
        self.fill_in_copies(template, finish, true)
    }

    fn fill_in_copies(self, template: &str, finish: &str, transposed: bool) -> String {
        let copies = [
            ("$FETCH_FIRST", self.fetch(true, transposed)),
            ("$FETCH_NEXT", self.fetch(false, transposed)),
            ("$STORE", self.store(transposed)),
        ];
        self.fill_in_parts(template, finish, &copies)
    }

    /// Input within the depth, and row within the tile, of an entry of W.
    fn w_place(self, at: &str, transposed: bool) -> [String; 2] {
        match transposed {
            false => [format!("({at}) / {}u", self.outputs), format!("({at}) % {}u", self.outputs)],
            true => [format!("({at}) % {}u", self.depth), format!("({at}) / {}u", self.depth)],
        }
    }

    /// As [`Tile::fill_in`] for products over samples, which lie side by side in both factors: they are fetched in groups of
    /// four and turned round on their way to the shared memory.
    pub fn fill_in_turned(self, template: &str, finish: &str) -> String {
        let copies = [
            ("$FETCH_FIRST", self.fetch_turned(true)),
            ("$FETCH_NEXT", self.fetch_turned(false)),
            ("$STORE", self.store_turned()),
            ("$NO_SUMS", self.no_sums()),
            ("$SUM_X", self.sum_turned()),
            ("$KEEP_SUMS", self.keep_sums()),
        ];
        self.fill_in_parts(template, finish, &copies)
    }

    fn fill_in_parts(self, template: &str, finish: &str, copies: &[(&str, String)]) -> String {
        let text = SHARED.iter().fold(template.to_owned(), |text, (name, part)| text.replace(name, part));
        // Longer names first where one begins with another.
        let parts = [
            ("$TILE_OUTPUTS", self.outputs.to_string()),
            ("$TILE_GROUPS", (self.columns / 4).to_string()),
            ("$THREADS_X", self.threads_x().to_string()),
            ("$THREADS_Y", self.threads_y().to_string()),
            ("$THREADS", self.threads().to_string()),
            ("$DEPTH", self.depth.to_string()),
            ("$W_TILE", (2 * self.w_numbers() / 4).to_string()),
            ("$X_TILE", (2 * self.x_groups()).to_string()),
            ("$ZERO", self.zero()),
            ("$MULTIPLY", self.multiply()),
            ("$FINISH", self.finish(finish)),
        ];
        parts.iter().chain(copies).fold(text, |text, (name, part)| text.replace(name, part))
    }

    /// Rows of a thread, and groups of columns of a thread.
    fn mine(self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.per_thread.0).flat_map(move |row| (0..self.per_thread.1 / 4).map(move |group| (row, group)))
    }

    fn zero(self) -> String {
        self.mine().fold(String::new(), |mut text, (row, group)| {
            _ = writeln!(text, "    var y_{row}_{group} = vec4<f32>(0.0);");
            text
        })
    }

    /// Copies to registers: entries `local`, `local + THREADS` and so on of both tiles.
    fn fetch(self, first: bool, transposed: bool) -> String {
        let (keyword, depth) = if first { ("var ", "0u") } else { ("", "depth + DEPTH") };
        let (groups, mut text) = (self.columns / 4, String::new());
        for (piece, at) in self.pieces(self.w_numbers()) {
            let [input, output] = self.w_place(&at, transposed);
            let place = format!("{depth} + {input}, first_output + {output}");
            _ = writeln!(text, "    {keyword}w_next_{piece} = fetch_w({place});");
        }
        for (piece, at) in self.pieces(self.x_groups()) {
            let place = format!("{depth} + ({at}) / {groups}u, first_group + ({at}) % {groups}u");
            _ = writeln!(text, "    {keyword}x_next_{piece} = fetch_x({place});");
        }
        text
    }

    /// Copies from registers to shared memory.
    fn store(self, transposed: bool) -> String {
        let (w_half, x_half, mut text) = (self.w_numbers() / 4, self.x_groups(), String::new());
        for (piece, at) in self.pieces(self.w_numbers()) {
            let guard = self.guard(piece, self.w_numbers());
            let [input, output] = self.w_place(&at, transposed);
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

    /// Copies to registers, four samples of a row at a time.
    fn fetch_turned(self, first: bool) -> String {
        let (keyword, depth) = if first { ("var ", "start") } else { ("", "depth + DEPTH") };
        let (quads, mut text) = (self.depth / 4, String::new());
        for (factor, rows, first) in [("w", self.outputs, "first_output"), ("x", self.columns, "4u * first_group")] {
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

    fn no_sums(self) -> String {
        let pieces = self.pieces(self.columns * self.depth / 4);
        pieces.map(|(piece, _)| format!("    var sums_{piece} = 0.0;\n")).collect()
    }

    /// Adds what is about to be stored of X to the thread's sums.
    fn sum_turned(self) -> String {
        let pieces = self.pieces(self.columns * self.depth / 4);
        pieces.map(|(piece, _)| format!("        sums_{piece} += dot(x_next_{piece}, vec4<f32>(1.0));\n")).collect()
    }

    /// Puts these sums where X was; `DEPTH / 4` of them belong to a row.
    fn keep_sums(self) -> String {
        let size = self.columns * self.depth / 4;
        let keep = |(piece, at)| format!("    {}{{ x_tile[{at}].x = sums_{piece}; }}\n", self.guard(piece, size));
        self.pieces(size).map(keep).collect()
    }

    /// The condition of a copy, where the last piece has fewer entries than there are threads.
    fn guard(self, piece: u32, size: u32) -> String {
        let first = piece * self.threads();
        if first + self.threads() > size { format!("if local + {first}u < {size}u ") } else { String::new() }
    }

    /// Pieces in which the threads copy so many entries, and the entry of a thread in each.
    fn pieces(self, size: u32) -> impl Iterator<Item = (u32, String)> {
        let threads = self.threads();
        (0..size.div_ceil(threads)).map(move |piece| (piece, format!("local + {}u", piece * threads)))
    }

    /// Products of the thread's rows and columns for all inputs of a depth.
    fn multiply(self) -> String {
        (0..self.depth).map(|input| format!("        {{\n{}        }}\n", self.products(input))).collect()
    }

    /// The same for one input.
    fn products(self, input: u32) -> String {
        let mut text = String::new();
        for quad in 0..self.per_thread.0 / 4 {
            let at = input * self.outputs / 4 + quad * self.threads_y();
            let place = format!("half * {}u + at_y + {at}u", self.w_numbers() / 4);
            _ = writeln!(text, "            let w_{quad} = w_tile[{place}];");
        }
        for group in 0..self.per_thread.1 / 4 {
            let at = input * self.columns / 4 + group * self.threads_x();
            let place = format!("half * {}u + at_x + {at}u", self.x_groups());
            _ = writeln!(text, "            let x_{group} = x_tile[{place}];");
        }
        for (row, group) in self.mine() {
            let w = format!("w_{}.{}", row / 4, ["x", "y", "z", "w"][row as usize % 4]);
            _ = writeln!(text, "            y_{row}_{group} = fma(vec4<f32>({w}), x_{group}, y_{row}_{group});");
        }
        text
    }

    fn finish(self, finish: &str) -> String {
        let mut text = String::new();
        for row in 0..self.per_thread.0 {
            let place = format!("4u * (at_y + {}u) + {}u", row / 4 * self.threads_y(), row % 4);
            _ = writeln!(text, "    {{ let output = first_output + {place};\n    if output < shape.outputs {{");
            _ = writeln!(text, "        let bias = fetch_bias(output);");
            for group in 0..self.per_thread.1 / 4 {
                let at = group * self.threads_x();
                _ = writeln!(text, "        {{ let group = first_group + at_x + {at}u;");
                _ = writeln!(text, "        let sum = y_{row}_{group} + bias;");
                _ = writeln!(text, "        if group < shape.groups {{ {finish} }} }}");
            }
            text.push_str("    } }\n");
        }
        text
    }
}
