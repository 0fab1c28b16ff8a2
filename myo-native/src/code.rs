//! What a program becomes before it has registers: instructions in the order in which they run.

use myo_scalar::symbolic::Sharing;

/// A number per lane that some instruction makes, or that lies in memory from the beginning.
pub type Value = u32;

/// A place in the routine's own memory, as wide as a register.
pub type Cell = u32;

/// What a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// 16 numbers or integers of 32 bits.
    Vector,
    /// 16 truth values.
    Mask,
}

/// Row of a buffer of the caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Entry {
    pub binding: u32,
    pub row: u32,
    pub sharing: Sharing,
}

/// Where a value can be read at any time from its beginning to its last use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Home {
    /// In a buffer of the caller.
    Entry(Entry),
    /// In a variable of a loop or branch.
    Cell(Cell),
}

/// What an instruction reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operand {
    Value(Value),
    /// The same 32 bits in every lane.
    Constant(u32),
    /// The number of the lane.
    LaneNumber,
}

/// Operations of two vectors of which the second may come from memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Min,
    Max,
    AddWords,
    MulWords,
    MinWords,
    Xor,
    And,
    Or,
    /// 64-bit products of the even lanes.
    MulEven,
}

impl Binary {
    /// Whether operands may change places. Which of two comes out if one is no number is part of `Min` and `Max`.
    pub fn commutes(self) -> bool {
        !matches!(self, Self::Sub | Self::Min | Self::Max)
    }
}

/// Operations of one vector, which may come from memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unary {
    Sqrt,
    /// Reciprocal square root to 14 bits.
    RsqrtGuess,
    /// Reciprocal to 14 bits.
    RecipGuess,
    Floor,
    Round,
    ToNumber,
    ToWord,
    ShiftLeft(u32),
    ShiftRight(u32),
    /// Shifts of 64-bit lanes.
    ShiftLeftWide(u32),
    ShiftRightWide(u32),
}

/// Signs of a fused product and sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signs {
    pub minus_product: bool,
    pub minus_addend: bool,
}

/// What [`Instruction::Gather`] reads from; the index counts words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A buffer of the caller, from its beginning.
    Buffer(u32),
    /// The program's table.
    Table,
}

/// An entry of an array of cells, in the chunk that a loop is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChunkEntry {
    /// Which loop.
    pub counter: u32,
    /// Entry 0 of chunk 0.
    pub first: Cell,
    /// Number of the entry.
    pub position: u32,
    /// Entries of a chunk.
    pub width: u32,
}

/// One step of a routine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Instruction {
    Unary(Unary, Value, Operand),
    Binary(Binary, Value, [Operand; 2]),
    /// `a * b + c`.
    MulAdd(Signs, Value, [Operand; 3]),
    /// `a < b`.
    Less(Value, [Operand; 2]),
    /// Mask, where it is true, where it is not.
    Select(Value, Value, [Operand; 2]),
    MaskAnd(Value, [Value; 2]),
    MaskOr(Value, [Value; 2]),
    MaskNot(Value, Value),
    MaskConstant(Value, bool),
    /// A value of its own of what lies in memory, which is going to be overwritten.
    Copy(Value, Value),
    /// Reads the entries whose numbers are in a vector.
    Gather(Value, Source, Value),
    /// Writes a row of a buffer, where a mask is true if there is one.
    Store(Entry, Operand, Option<Value>),
    /// Writes a variable.
    Put(Cell, Operand),
    /// Reads an entry of the current chunk.
    TakeEntry(Value, ChunkEntry),
    /// Writes an entry of the current chunk.
    PutEntry(ChunkEntry, Operand),
    /// The number of the current chunk, in every lane.
    ChunkNumber(Value, u32),
    /// What follows, up to `EndLoop`, runs again.
    BeginLoop {
        counter: u32,
    },
    /// Goes on if the counter is below the limit after this run and the mask, if there is one, is true in some lane.
    EndLoop {
        counter: u32,
        limit: u32,
        again: Option<Value>,
    },
    /// What follows, up to `EndBranch`, runs if the mask is true in some lane.
    BeginBranch {
        mask: Value,
    },
    EndBranch,
    /// Nothing.
    Nothing,
}

impl Instruction {
    /// What it makes.
    pub fn result(&self) -> Option<Value> {
        use Instruction::*;
        match *self {
            Unary(_, value, _)
            | Binary(_, value, _)
            | MulAdd(_, value, _)
            | Less(value, _)
            | Select(value, ..)
            | MaskAnd(value, _)
            | MaskOr(value, _)
            | MaskNot(value, _)
            | MaskConstant(value, _)
            | Copy(value, _)
            | Gather(value, ..)
            | TakeEntry(value, _)
            | ChunkNumber(value, _) => Some(value),
            _ => None,
        }
    }

    /// Calls `of` with each value that it reads.
    pub fn for_each_use(&self, mut of: impl FnMut(Value)) {
        use Instruction::*;
        let operands: &[Operand] = match self {
            Unary(_, _, x) | Store(_, x, _) | Put(_, x) | PutEntry(_, x) => std::slice::from_ref(x),
            Binary(_, _, xs) | Less(_, xs) | Select(_, _, xs) => xs,
            MulAdd(_, _, xs) => xs,
            _ => &[],
        };
        for operand in operands {
            if let Operand::Value(value) = *operand {
                of(value);
            }
        }
        match *self {
            Select(_, mask, _) | MaskNot(_, mask) | BeginBranch { mask } => of(mask),
            Store(_, _, Some(mask)) | EndLoop { again: Some(mask), .. } => of(mask),
            MaskAnd(_, masks) | MaskOr(_, masks) => masks.into_iter().for_each(of),
            Copy(_, value) | Gather(_, _, value) => of(value),
            _ => {}
        }
    }
}

/// A program without registers.
#[derive(Clone, Debug, Default)]
pub struct Code {
    pub instructions: Vec<Instruction>,
    /// What each value is.
    pub classes: Vec<Class>,
    /// Where values lie that no instruction makes.
    pub homes: Vec<Option<Home>>,
    /// How many cells there are.
    pub ncell: u32,
    /// How many counters of loops there are.
    pub ncounter: u32,
}

impl Code {
    /// A new value.
    pub fn value(&mut self, class: Class, home: Option<Home>) -> Value {
        self.classes.push(class);
        self.homes.push(home);
        (self.classes.len() - 1) as Value
    }

    /// Consecutive cells; the number of the first one.
    pub fn cells(&mut self, count: u32) -> Cell {
        let first = self.ncell;
        self.ncell += count;
        first
    }
}
