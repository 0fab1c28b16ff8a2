//! Nodes, and how they are shared.

use super::fold;
use super::number::Handle;
use super::region::{Region, Statement, Store};
use super::with_graph;
use super::{Sym, SymWord};
use std::collections::HashMap;

/// Index of a node.
pub type Id = u32;

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// `f32`.
    Number,
    /// `u32`.
    Word,
    /// `bool`.
    Mask,
}

/// How the entries of a buffer are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sharing {
    /// Entry `row` of environment `env` lies at `row * environments + env`.
    PerEnv,
    /// Entry `row` is the same for all environments.
    Shared,
}

/// A buffer outside the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Buffer {
    /// Its number among the program's buffers.
    pub binding: u32,
    /// How its entries are counted.
    pub sharing: Sharing,
}

impl Buffer {
    /// Reads a number. Reads see what was there before the program ran.
    pub fn number(self, row: usize) -> Sym {
        Sym::new(with_graph(|graph| graph.leaf(Op::Input(self, row as u32), Kind::Number)))
    }
    /// Reads an integer.
    pub fn word(self, row: usize) -> SymWord {
        SymWord::new(with_graph(|graph| graph.leaf(Op::Input(self, row as u32), Kind::Word)))
    }
    /// Writes a number at the program's end, or where the enclosing branch ends.
    pub fn set_number(self, row: usize, value: Sym) {
        with_graph(|graph| {
            graph.statement(Statement::Store(Store { buffer: self, row: row as u32, value: value.id() }))
        });
    }
    /// Writes an integer.
    pub fn set_word(self, row: usize, value: SymWord) {
        with_graph(|graph| {
            graph.statement(Statement::Store(Store { buffer: self, row: row as u32, value: value.id() }))
        });
    }
}

/// Evenly spaced entries of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rows {
    /// The first one.
    pub first: u32,
    /// From one to the next.
    pub step: u32,
    /// How many.
    pub count: u32,
}

impl Rows {
    /// Entry `index`, the last one beyond them.
    pub fn at(self, index: u32) -> u32 {
        self.first + self.step * index.min(self.count - 1)
    }
}

/// An operation; operands are in [`Node::args`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// A constant, as the bits of an `f64`.
    Number(u64),
    /// A constant integer.
    Word(u32),
    /// A constant truth value.
    Truth(bool),
    /// What a buffer held before the program.
    Input(Buffer, u32),
    /// Value of a loop's variable when its body begins: statement, number of the variable.
    Carried(u32, u32),
    /// Value of a variable after a loop or branch.
    Outcome(u32, u32),
    /// `a + b`.
    Add,
    /// `a - b`.
    Sub,
    /// `a * b`.
    Mul,
    /// `a * b + c`.
    MulAdd,
    /// `-a`.
    Neg,
    /// Square root.
    Sqrt,
    /// Reciprocal square root.
    Rsqrt,
    /// Reciprocal.
    Recip,
    /// Absolute value.
    Abs,
    /// Lesser of two.
    Min,
    /// Greater of two.
    Max,
    /// Clipped to [0, 1].
    Saturate,
    /// Whole number not above.
    Floor,
    /// Nearest whole number, halves to even.
    Round,
    /// `a < b`.
    Less,
    /// `a ? b : c`.
    Select,
    /// Both.
    And,
    /// Either.
    Or,
    /// Not.
    Not,
    /// Wrapping sum of integers.
    WordAdd,
    /// Exclusive or of bits.
    Xor,
    /// Common bits.
    BitAnd,
    /// Joint bits.
    BitOr,
    /// Shift to the left by a constant.
    ShiftLeft(u32),
    /// Shift to the right by a constant.
    ShiftRight(u32),
    /// Upper half of a 64-bit product.
    MulHigh,
    /// Lower half of a 64-bit product.
    MulLow,
    /// Integer to number.
    ToNumber,
    /// What a buffer held before the program, in the row of this number; in the last of the rows where there is no such one.
    Gather(Buffer, Rows),
    /// Entry of the program's table: `table[base + a]`.
    Table(u32),
    /// Whole number to integer, two's complement.
    ToWord,
    /// Number to its bits.
    ToBits,
    /// Bits to the number.
    FromBits,
}

/// An operation on other nodes; unused operands are zero.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// The operation.
    pub op: Op,
    /// Its operands.
    pub args: [Id; 3],
    /// What comes out.
    pub kind: Kind,
    /// Where it is computed.
    pub region: u32,
    /// For whom: index into the program's stages.
    pub stage: u32,
}

impl Op {
    /// How many operands it has.
    pub fn arity(self) -> usize {
        use Op::*;
        match self {
            Number(_) | Word(_) | Truth(_) | Input(..) | Carried(..) | Outcome(..) => 0,
            Gather(..) | Table(_) | Neg | Sqrt | Rsqrt | Recip | Abs | Saturate | Floor | Round | Not
            | ShiftLeft(_) | ShiftRight(_) | ToNumber | ToWord | ToBits | FromBits => 1,
            Add | Sub | Mul | Min | Max | Less | And | Or | WordAdd | Xor | BitAnd | BitOr | MulHigh | MulLow => 2,
            MulAdd | Select => 3,
        }
    }

    /// Whether it costs an instruction. Signs are part of the operation that takes them, and bits need no conversion.
    pub fn is_work(self) -> bool {
        self.arity() > 0 && !matches!(self, Op::Neg | Op::ToBits | Op::FromBits)
    }

    /// Whether it is a constant.
    pub fn is_constant(self) -> bool {
        matches!(self, Op::Number(_) | Op::Word(_) | Op::Truth(_))
    }

    /// Whether its first two operands may change places.
    fn commutes(self) -> bool {
        use Op::*;
        matches!(self, Add | Mul | MulAdd | Min | Max | And | Or | WordAdd | Xor | BitAnd | BitOr)
    }
}

impl Node {
    /// The operands that count.
    pub fn operands(&self) -> &[Id] {
        &self.args[..self.op.arity()]
    }
}

/// A stage of the generic code, by name; the first one is the whole program.
#[derive(Clone, Debug)]
pub struct StageName {
    /// Its name.
    pub name: &'static str,
    /// Index of the stage that it is part of.
    pub parent: u32,
}

/// What becomes of the rows of tables, [`Scalar::for_rows`](crate::Scalar::for_rows) and
/// [`Scalar::map_rows`](crate::Scalar::map_rows).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Form {
    /// Each row's own code, its constants in place: fastest, as long as the program fits the instruction cache and the
    /// driver compiles it in time.
    #[default]
    Straight,
    /// A loop for the rows of `map_rows`, whose bodies are long.
    Paths,
    /// A loop for the rows of both.
    Loops,
}

/// A program while it is recorded.
pub struct Graph {
    pub nodes: Vec<Node>,
    pub regions: Vec<Region>,
    pub statements: Vec<Statement>,
    pub stages: Vec<StageName>,
    /// Nodes that there were when a statement began.
    pub begun: Vec<Id>,
    /// Constants that loops look up.
    pub table: Vec<f64>,
    /// What becomes of tables.
    pub form: Form,
    /// Regions whose numbers may be used now, outermost first.
    pub open: Vec<u32>,
    stage: u32,
    known: HashMap<(Op, [Id; 3], Kind), Vec<Id>>,
}

impl Graph {
    pub fn new(form: Form) -> Self {
        Self {
            table: vec![],
            form,
            nodes: vec![],
            regions: vec![Region::default()],
            statements: vec![],
            stages: vec![StageName { name: "program", parent: 0 }],
            begun: vec![],
            open: vec![0],
            stage: 0,
            known: HashMap::new(),
        }
    }

    /// The region that is being recorded.
    pub fn region(&self) -> u32 {
        *self.open.last().expect("the outermost region stays open")
    }

    /// A constant; constants belong to the whole program.
    pub fn number(&mut self, x: f64) -> Id {
        // Minus zero is zero here.
        self.constant(Op::Number((x + 0.0).to_bits()), Kind::Number)
    }
    pub fn word(&mut self, x: u32) -> Id {
        self.constant(Op::Word(x), Kind::Word)
    }
    pub fn truth(&mut self, x: bool) -> Id {
        self.constant(Op::Truth(x), Kind::Mask)
    }

    fn constant(&mut self, op: Op, kind: Kind) -> Id {
        self.share(op, [0; 3], kind, 0)
    }

    /// Adds constants to the table; returns where they begin.
    pub fn put_in_table(&mut self, constants: impl IntoIterator<Item = f64>) -> u32 {
        let base = self.table.len() as u32;
        self.table.extend(constants);
        base
    }

    /// A node without operands that belongs to the whole program.
    pub fn leaf(&mut self, op: Op, kind: Kind) -> Id {
        self.share(op, [0; 3], kind, 0)
    }

    /// Where these nodes are what a buffer held, evenly spaced from the first to the last.
    pub fn rows(&self, ids: &[Id]) -> Option<(Buffer, Rows)> {
        let input = |id: Id| match self.nodes[id as usize].op {
            Op::Input(buffer, row) => Some((buffer, row)),
            _ => None,
        };
        let ((buffer, first), (_, second)) = (input(*ids.first()?)?, input(*ids.get(1)?)?);
        let rows = Rows { first, step: second.checked_sub(first)?, count: ids.len() as u32 };
        let fits = |(index, &id): (u32, &Id)| input(id) == Some((buffer, rows.at(index)));
        (0..).zip(ids).all(fits).then_some((buffer, rows))
    }

    /// A node that is not shared, of a given region.
    pub fn fresh(&mut self, op: Op, kind: Kind, region: u32) -> Id {
        self.push(op, [0; 3], kind, region)
    }

    /// An operation, simplified, shared with an equal one that is in sight.
    pub fn apply(&mut self, op: Op, args: &[Id], kind: Kind) -> Id {
        let mut operands = [0; 3];
        operands[..args.len()].copy_from_slice(args);
        if let Some(id) = fold::simplify(self, op, operands) {
            return id;
        }
        if op.commutes() && self.rank(operands[1]) > self.rank(operands[0]) {
            operands.swap(0, 1);
        }
        for &arg in args {
            self.check_in_sight(arg);
        }
        let region = self.home(args);
        self.share(op, operands, kind, region)
    }

    /// Region to compute from some operands in: outside of loops that do not change them.
    fn home(&self, args: &[Id]) -> u32 {
        let place = |&arg: &Id| {
            let region = self.nodes[arg as usize].region;
            self.open.iter().position(|&open| open == region).unwrap_or(0)
        };
        let needed = args.iter().map(place).max().unwrap_or(0);
        let mut place = self.open.len() - 1;
        while place > needed && self.regions[self.open[place] as usize].is_loop {
            place -= 1;
        }
        self.open[place]
    }

    /// Constants come second, whatever their age.
    fn rank(&self, id: Id) -> (bool, Id) {
        (!self.nodes[id as usize].op.is_constant(), id)
    }

    fn check_in_sight(&self, id: Id) {
        let region = self.nodes[id as usize].region;
        assert!(
            self.open.contains(&region),
            "a number computed in a loop or branch is used outside; it must be one of its variables (node {id}: {:?})",
            self.nodes[id as usize].op
        );
    }

    fn share(&mut self, op: Op, args: [Id; 3], kind: Kind, region: u32) -> Id {
        if let Some(equal) = self.known.get(&(op, args, kind)) {
            let in_sight = equal.iter().find(|&&id| self.open.contains(&self.nodes[id as usize].region));
            if let Some(&id) = in_sight {
                return id;
            }
        }
        let id = self.push(op, args, kind, region);
        self.known.entry((op, args, kind)).or_default().push(id);
        id
    }

    fn push(&mut self, op: Op, args: [Id; 3], kind: Kind, region: u32) -> Id {
        self.nodes.push(Node { op, args, kind, region, stage: self.stage });
        (self.nodes.len() - 1) as Id
    }

    /// Appends a statement to the region being recorded; returns its number.
    pub fn statement(&mut self, statement: Statement) -> u32 {
        let number = self.statements.len() as u32;
        self.statements.push(statement);
        self.begun.push(self.nodes.len() as Id);
        let region = self.region() as usize;
        self.regions[region].statements.push(number);
        number
    }

    /// Opens a region within the current one.
    pub fn open_region(&mut self, is_loop: bool) -> u32 {
        self.regions.push(Region { is_loop, ..Region::default() });
        let region = (self.regions.len() - 1) as u32;
        self.open.push(region);
        region
    }

    pub fn close_region(&mut self) {
        self.open.pop();
    }

    /// Enters a stage of the current one; returns the one to go back to.
    pub fn enter_stage(&mut self, name: &'static str) -> u32 {
        let (parent, before) = (self.stage, self.stage);
        let known = self.stages.iter().skip(1).position(|stage| stage.name == name && stage.parent == parent);
        self.stage = match known {
            Some(position) => position as u32 + 1,
            None => {
                self.stages.push(StageName { name, parent });
                (self.stages.len() - 1) as u32
            }
        };
        before
    }

    pub fn leave_stage(&mut self, before: u32) {
        self.stage = before;
    }
}
