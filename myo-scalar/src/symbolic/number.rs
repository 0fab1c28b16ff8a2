//! The symbolic number and its companions.

use super::graph::{Form, Id, Kind, Op};
use super::{region, with_graph};
use crate::carried::{Carried, Visitor};
use crate::elementary::{self, Bits};
use crate::scalar::{Mask, Row, RowMap, Scalar, Stage, Word};
use std::ops::{Add, AddAssign, BitAnd, BitOr, BitXor, Mul, Neg, Not, Shl, Shr, Sub, SubAssign};

/// A node of the running trace as a value.
pub trait Handle: Copy {
    /// Its node.
    fn id(self) -> Id;
}

macro_rules! handle {
    ($(#[$doc:meta])* $name:ident, $kind:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name(Id);

        impl $name {
            pub(super) fn new(id: Id) -> Self {
                Self(id)
            }
            /// Whether both are one node, and so certainly equal.
            pub fn is_same(self, other: Self) -> bool {
                self.0 == other.0
            }
            fn apply(op: Op, args: &[Id]) -> Self {
                Self(with_graph(|graph| graph.apply(op, args, $kind)))
            }
        }

        impl Handle for $name {
            fn id(self) -> Id {
                self.0
            }
        }
    };
}
handle!(
    /// A number that stands for its computation.
    Sym,
    Kind::Number
);
handle!(
    /// A truth value that stands for its computation.
    SymMask,
    Kind::Mask
);
handle!(
    /// An integer that stands for its computation.
    SymWord,
    Kind::Word
);

macro_rules! binary {
    ($type:ident, $trait:ident, $method:ident, $op:expr) => {
        impl $trait for $type {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self::apply($op, &[self.0, other.0])
            }
        }
    };
}
binary!(Sym, Add, add, Op::Add);
binary!(Sym, Sub, sub, Op::Sub);
binary!(Sym, Mul, mul, Op::Mul);
binary!(SymMask, BitAnd, bitand, Op::And);
binary!(SymMask, BitOr, bitor, Op::Or);
binary!(SymWord, Add, add, Op::WordAdd);
binary!(SymWord, BitXor, bitxor, Op::Xor);
binary!(SymWord, BitAnd, bitand, Op::BitAnd);
binary!(SymWord, BitOr, bitor, Op::BitOr);

impl Neg for Sym {
    type Output = Self;
    fn neg(self) -> Self {
        Self::apply(Op::Neg, &[self.0])
    }
}

impl AddAssign for Sym {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Sym {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Not for SymMask {
    type Output = Self;
    fn not(self) -> Self {
        Self::apply(Op::Not, &[self.0])
    }
}

impl SymMask {
    /// Its value, if it is a constant.
    pub(super) fn known(self) -> Option<bool> {
        with_graph(|graph| match graph.nodes[self.0 as usize].op {
            Op::Truth(x) => Some(x),
            _ => None,
        })
    }
}

impl Mask for SymMask {
    fn splat(value: bool) -> Self {
        Self(with_graph(|graph| graph.truth(value)))
    }
    /// True unless it is known to be false.
    fn any(self) -> bool {
        self.known().unwrap_or(true)
    }
}

impl Shl<u32> for SymWord {
    type Output = Self;
    fn shl(self, by: u32) -> Self {
        Self::apply(Op::ShiftLeft(by), &[self.0])
    }
}

impl Shr<u32> for SymWord {
    type Output = Self;
    fn shr(self, by: u32) -> Self {
        Self::apply(Op::ShiftRight(by), &[self.0])
    }
}

impl Word for SymWord {
    fn splat(x: u32) -> Self {
        Self(with_graph(|graph| graph.word(x)))
    }
    fn mul_wide(self, by: u32) -> (Self, Self) {
        let by = Self::splat(by);
        (Self::apply(Op::MulHigh, &[self.0, by.0]), Self::apply(Op::MulLow, &[self.0, by.0]))
    }
    fn load(_: &[u32]) -> Self {
        panic!("symbolic integers are read from a Buffer")
    }
    fn store(self, _: &mut [u32]) {
        panic!("symbolic integers are written to a Buffer")
    }
}

impl Sym {
    /// Its value, if it is a constant.
    pub(super) fn constant(self) -> Option<f64> {
        with_graph(|graph| match graph.nodes[self.0 as usize].op {
            Op::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        })
    }
    fn one(op: Op, a: Self) -> Self {
        Self::apply(op, &[a.0])
    }
    fn two(op: Op, a: Self, b: Self) -> Self {
        Self::apply(op, &[a.0, b.0])
    }
}

/// Variables of a loop over rows, and the row.
struct Counted<'a, V> {
    row: SymWord,
    vars: &'a mut V,
}

impl<V: Carried<Sym>> Carried<Sym> for Counted<'_, V> {
    fn visit(&mut self, visitor: &mut impl Visitor<Sym>) {
        visitor.word(&mut self.row);
        self.vars.visit(visitor);
    }
}

/// A row by its number.
fn gather<const N: usize>(count: usize, entry: impl Fn(usize) -> [Sym; N], index: SymWord) -> [Sym; N] {
    let rows: Vec<[Sym; N]> = (0..count).map(entry).collect();
    std::array::from_fn(|column| gather_column(&rows.iter().map(|row| row[column]).collect::<Vec<_>>(), index))
}

/// An entry by its number: from memory where it lies there, else chosen from all.
fn gather_column(entries: &[Sym], index: SymWord) -> Sym {
    let ids: Vec<Id> = entries.iter().map(|x| x.id()).collect();
    if ids.iter().all(|id| *id == ids[0]) {
        return entries[0];
    }
    if let Some((buffer, rows)) = with_graph(|graph| graph.rows(&ids)) {
        return Sym::apply(Op::Gather(buffer, rows), &[index.0]);
    }
    let number = Sym::from_word(index);
    let [others @ .., last] = entries else { unreachable!("there is an entry") };
    let choose = |found, (k, &entry): (usize, &Sym)| Sym::select(number.lt(Sym::lit(k as f64 + 0.5)), entry, found);
    others.iter().enumerate().rev().fold(*last, choose)
}

impl Scalar for Sym {
    type Const = f64;
    type Mask = SymMask;
    type Word = SymWord;
    const LANES: usize = 1;
    const EPSILON: f64 = f32::EPSILON as f64;
    const READS_ROWS: bool = true;

    fn splat(c: f64) -> Self {
        Self(with_graph(|graph| graph.number(c)))
    }
    fn load(_: &[f64]) -> Self {
        panic!("symbolic numbers are read from a Buffer")
    }
    fn store(self, _: &mut [f64]) {
        panic!("symbolic numbers are written to a Buffer")
    }
    fn lane_by_lane<const I: usize, const O: usize>(
        _: SymMask,
        _: [Self; I],
        _: impl FnMut(&[f64; I]) -> [f64; O],
    ) -> [Self; O] {
        panic!("work in double precision cannot be recorded")
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self::apply(Op::MulAdd, &[self.0, a.0, b.0])
    }
    fn sqrt(self) -> Self {
        Self::one(Op::Sqrt, self)
    }
    fn rsqrt(self) -> Self {
        Self::one(Op::Rsqrt, self)
    }
    fn recip(self) -> Self {
        Self::one(Op::Recip, self)
    }
    fn abs(self) -> Self {
        Self::one(Op::Abs, self)
    }
    fn min(self, other: Self) -> Self {
        Self::two(Op::Min, self, other)
    }
    fn max(self, other: Self) -> Self {
        Self::two(Op::Max, self, other)
    }
    fn floor(self) -> Self {
        Self::one(Op::Floor, self)
    }
    // Polynomials instead of the graphics card's own functions, whose errors differ from card to card.
    fn sin_cos(self) -> (Self, Self) {
        // Two joints may turn by opposite angles.
        let minus = -self;
        if minus.0 < self.0 {
            let (sin, cos) = elementary::sin_cos(minus);
            return (-sin, cos);
        }
        elementary::sin_cos(self)
    }
    fn exp(self) -> Self {
        elementary::exp(self)
    }
    fn ln(self) -> Self {
        elementary::ln(self)
    }
    fn lt(self, other: Self) -> SymMask {
        SymMask::apply(Op::Less, &[self.0, other.0])
    }
    fn select(mask: SymMask, a: Self, b: Self) -> Self {
        Self::apply(Op::Select, &[mask.0, a.0, b.0])
    }
    fn from_word(word: SymWord) -> Self {
        Self::apply(Op::ToNumber, &[word.0])
    }
    fn select_word(mask: SymMask, a: SymWord, b: SymWord) -> SymWord {
        SymWord::apply(Op::Select, &[mask.0, a.0, b.0])
    }
    fn outline<T: Stage<Self>>(stage: T) -> T::Output {
        let before = with_graph(|graph| graph.enter_stage(T::NAME));
        let output = stage.run();
        with_graph(|graph| graph.leave_stage(before));
        output
    }
    fn repeat<V: Carried<Self>>(count: usize, vars: &mut V, mut body: impl FnMut(&mut V)) {
        region::record_loop(count, vars, |vars| {
            body(vars);
            None
        });
    }
    fn repeat_while<V: Carried<Self>>(limit: usize, vars: &mut V, body: impl FnMut(&mut V) -> SymMask) {
        let mut body = body;
        region::record_loop(limit, vars, |vars| Some(body(vars)));
    }
    fn when<V: Carried<Self>>(mask: SymMask, vars: &mut V, body: impl FnOnce(&mut V)) {
        region::record_branch(mask, vars, body);
    }
    fn map_chunks<const N: usize>(values: &mut [Self], mut body: impl FnMut(SymWord, [Self; N]) -> [Self; N]) {
        assert_eq!(values.len() % N, 0, "the values are whole chunks");
        if !values.is_empty() {
            region::record_chunks(values, N, |index, chunk| body(index, std::array::from_fn(|k| chunk[k])).to_vec());
        }
    }
    fn for_each_row<V: Carried<Self>>(count: usize, vars: &mut V, mut body: impl FnMut(&mut V, Row<SymWord>)) {
        if count < 2 {
            return (0..count).for_each(|row| body(vars, Row::Known(row)));
        }
        let mut counted = Counted { row: SymWord::splat(0), vars };
        Self::repeat(count, &mut counted, |Counted { row, vars }| {
            body(vars, Row::Counted(*row));
            *row = *row + SymWord::splat(1);
        });
    }
    fn of_row<const N: usize>(row: Row<SymWord>, count: usize, entry: impl Fn(usize) -> [Self; N]) -> [Self; N] {
        match row {
            Row::Known(row) => entry(row),
            Row::Counted(row) => gather(count, entry, row),
        }
    }
    fn gather<const N: usize>(count: usize, entry: impl Fn(usize) -> [Self; N], index: Self) -> [Self; N] {
        gather(count, entry, index.clamp(0.0, (count - 1) as f64).to_word())
    }
    fn for_rows<const K: usize, const I: usize>(
        constants: impl Fn(usize) -> [f64; K],
        inputs: [&[Self]; I],
        output: &mut [Self],
        mut body: impl FnMut([Self; K], [Self; I], Self) -> Self,
    ) {
        let table: Vec<[f64; K]> = (0..output.len()).map(constants).collect();
        if with_graph(|graph| graph.form) == Form::Loops && table.len() > 1 {
            return region::record_rows(&table, inputs, output, body);
        }
        for (k, value) in output.iter_mut().enumerate() {
            *value = body(table[k].map(Self::splat), inputs.map(|input| input[k]), *value);
        }
    }
    fn rows_are_a_loop() -> bool {
        with_graph(|graph| graph.form) != Form::Straight
    }
    fn map_rows<const I: usize, const O: usize>(count: usize, rows: &mut impl RowMap<Self, I, O>) {
        if count < 2 || !Self::rows_are_a_loop() {
            for k in 0..count {
                let found = rows.map(rows.take(k));
                rows.put(k, found);
            }
            return;
        }
        let taken: Vec<[Self; I]> = (0..count).map(|k| rows.take(k)).collect();
        for (k, found) in region::map_rows(&taken, |taken| rows.map(taken)).into_iter().enumerate() {
            rows.put(k, found);
        }
    }
}

impl Bits for Sym {
    fn to_bits(self) -> SymWord {
        SymWord::apply(Op::ToBits, &[self.0])
    }
    fn from_bits(bits: SymWord) -> Self {
        Self::apply(Op::FromBits, &[bits.0])
    }
    fn round(self) -> Self {
        Self::one(Op::Round, self)
    }
    fn to_word(self) -> SymWord {
        SymWord::apply(Op::ToWord, &[self.0])
    }
}
