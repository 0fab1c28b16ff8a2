//! What a thread does with the entries of its own, whatever is multiplied.

use std::fmt::Write;

use super::Tile;

impl Tile {
    /// Rows of a thread, and groups of columns of a thread.
    fn mine(self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.per_thread.0).flat_map(move |row| (0..self.per_thread.1 / 4).map(move |group| (row, group)))
    }

    /// Declares the thread's entries, zero.
    pub(super) fn zero(self) -> String {
        self.mine().fold(String::new(), |mut text, (row, group)| {
            _ = writeln!(text, "    var y_{row}_{group} = vec4<f32>(0.0);");
            text
        })
    }

    /// Products of the thread's rows and columns for all inputs of a depth.
    pub(super) fn multiply(self) -> String {
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

    /// Hands the thread's sums to `keep`.
    pub(super) fn keep(self) -> String {
        let mut text = String::new();
        for row in 0..self.per_thread.0 {
            let place = format!("4u * (at_y + {}u) + {}u", row / 4 * self.threads_y(), row % 4);
            _ = writeln!(text, "    {{ let output = corner.output + {place};\n    if output < shape.outputs {{");
            _ = writeln!(text, "        let bias = fetch_bias(output);");
            for group in 0..self.per_thread.1 / 4 {
                let at = group * self.threads_x();
                _ = writeln!(text, "        {{ let group = corner.group + at_x + {at}u;");
                _ = writeln!(text, "        let sum = y_{row}_{group} + bias;");
                _ = writeln!(text, "        if group < shape.groups {{ keep(output, group, sum); }} }}");
            }
            text.push_str("    } }\n");
        }
        text
    }

    /// Pieces in which the threads copy so many entries, and the entry of a thread in each.
    pub(super) fn pieces(self, size: u32) -> impl Iterator<Item = (u32, String)> {
        let threads = self.threads();
        (0..size.div_ceil(threads)).map(move |piece| (piece, format!("local + {}u", piece * threads)))
    }

    /// The condition of a copy, where the last piece has fewer entries than there are threads.
    pub(super) fn guard(self, piece: u32, size: u32) -> String {
        let first = piece * self.threads();
        if first + self.threads() > size { format!("if local + {first}u < {size}u ") } else { String::new() }
    }
}
