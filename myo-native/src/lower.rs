//! From a recorded program to instructions.
//!
//! What the program's order says comes one after the other. Signs become part of products and sums, better reciprocals and roots
//! grow from the processor's guesses, and writes within branches go where the branch's mask is true. Loops and branches run as long
//! as *some* lane wants them; that lanes which do not are left as they are is what generic code promises of them.

use crate::code::{
    Binary, Cell, ChunkEntry, Class, Code, Entry, Home, Instruction, Operand, Signs, Source, Unary, Value,
};
use crate::heirs::{Variable, heirs};
use crate::{LANES, NativeError};
use myo_scalar::symbolic::{
    Branch, Buffer, Chunks, Id, Item, Kind, Loop, Op, Program, Rows, Sharing, Statement, Store,
};
use std::collections::HashMap;

const SIGN: u32 = 1 << 31;

/// Instructions of a program.
pub fn lower(program: &Program) -> Result<Code, NativeError> {
    let mut lowering = Lowering {
        program,
        order: program.order(),
        code: Code::default(),
        operands: vec![None; program.nodes.len()],
        cells: HashMap::new(),
        heirs: heirs(program),
        counters: HashMap::new(),
        chunks: HashMap::new(),
        masks: vec![],
        loads: vec![],
        gathers: vec![],
    };
    lowering.region(0)?;
    lowering.check_gathers()?;
    lowering.leave_inputs_in_place();
    Ok(lowering.code)
}

/// Entries of an array that a loop over chunks keeps.
struct Kept {
    first: Cell,
    entries: Vec<usize>,
}

struct Lowering<'a> {
    program: &'a Program,
    order: Vec<Vec<Item>>,
    code: Code,
    /// What each node became.
    operands: Vec<Option<Operand>>,
    /// Where variables of statements are.
    cells: HashMap<Variable, Cell>,
    /// Variables that take over another's place.
    heirs: HashMap<Variable, Variable>,
    counters: HashMap<u32, u32>,
    chunks: HashMap<u32, Kept>,
    /// Masks of the branches that are open.
    masks: Vec<Value>,
    /// Copies of inputs: where they are, and of what.
    loads: Vec<(usize, Entry)>,
    /// Where rows of buffers are looked up, and which.
    gathers: Vec<(usize, Buffer, Rows)>,
}

impl Lowering<'_> {
    fn region(&mut self, region: u32) -> Result<(), NativeError> {
        for item in std::mem::take(&mut self.order[region as usize]) {
            match item {
                Item::Node(id) => self.operands[id as usize] = Some(self.node(id)),
                Item::Statement(number) => self.statement(number)?,
            }
        }
        Ok(())
    }

    fn push(&mut self, instruction: Instruction) {
        self.code.instructions.push(instruction);
    }

    fn make(&mut self, class: Class, instruction: impl FnOnce(Value) -> Instruction) -> Value {
        let value = self.code.value(class, None);
        self.push(instruction(value));
        value
    }

    fn vector(&mut self, instruction: impl FnOnce(Value) -> Instruction) -> Operand {
        Operand::Value(self.make(Class::Vector, instruction))
    }

    fn mask(&mut self, instruction: impl FnOnce(Value) -> Instruction) -> Operand {
        Operand::Value(self.make(Class::Mask, instruction))
    }

    fn unary(&mut self, op: Unary, a: Operand) -> Operand {
        self.vector(|to| Instruction::Unary(op, to, a))
    }

    fn binary(&mut self, op: Binary, a: Operand, b: Operand) -> Operand {
        self.vector(|to| Instruction::Binary(op, to, [a, b]))
    }

    fn mul_add(&mut self, minus_product: bool, a: Operand, b: Operand, c: Operand) -> Operand {
        let signs = Signs { minus_product, minus_addend: false };
        self.vector(|to| Instruction::MulAdd(signs, to, [a, b, c]))
    }

    // --- operands ---

    /// An operand as it is, signs computed.
    fn operand(&mut self, id: Id) -> Operand {
        match self.program.nodes[id as usize].op {
            Op::Number(bits) => number(f64::from_bits(bits)),
            Op::Word(x) => Operand::Constant(x),
            Op::Truth(x) => self.mask(|to| Instruction::MaskConstant(to, x)),
            _ => self.operands[id as usize].expect("operands are computed before they are used"),
        }
    }

    fn operands<const N: usize>(&mut self, args: &[Id]) -> [Operand; N] {
        std::array::from_fn(|k| self.operand(args[k]))
    }

    /// A truth value, or an index, which are never literals.
    fn value(&mut self, id: Id) -> Value {
        match self.operand(id) {
            Operand::Value(value) => value,
            constant => {
                self.make(Class::Vector, |to| Instruction::Binary(Binary::Or, to, [constant, Operand::Constant(0)]))
            }
        }
    }

    /// An operand of a fused product and sum, without its sign.
    fn unsigned(&mut self, id: Id) -> (bool, Operand) {
        let node = self.program.nodes[id as usize];
        match node.op {
            Op::Neg => (true, self.operand(node.args[0])),
            _ => (false, self.operand(id)),
        }
    }

    // --- nodes ---

    fn node(&mut self, id: Id) -> Operand {
        let node = self.program.nodes[id as usize];
        match node.op {
            Op::Input(buffer, row) => self.input(buffer, row),
            Op::Carried(statement, index) => self.carried(id, statement, index as usize, node.kind),
            Op::Outcome(statement, index) => self.outcome(statement, index as usize, node.kind),
            Op::Gather(buffer, rows) => self.gather(buffer, rows, node.args[0]),
            Op::Table(base) => self.table(base, node.args[0]),
            Op::Select if node.kind == Kind::Mask => self.select_mask(node.args),
            Op::Select => {
                let mask = self.value(node.args[0]);
                let [a, b] = self.operands(&node.args[1..]);
                self.vector(|to| Instruction::Select(to, mask, [a, b]))
            }
            Op::And | Op::Or | Op::Not | Op::Less => self.truth(node.op, node.args),
            Op::MulAdd => self.fused(node.args),
            op => self.arithmetic(op, node.operands()),
        }
    }

    fn fused(&mut self, [a, b, c]: [Id; 3]) -> Operand {
        let [(minus_a, a), (minus_b, b), (minus_addend, c)] = [a, b, c].map(|id| self.unsigned(id));
        let signs = Signs { minus_product: minus_a != minus_b, minus_addend };
        self.vector(|to| Instruction::MulAdd(signs, to, [a, b, c]))
    }

    fn truth(&mut self, op: Op, [a, b, _]: [Id; 3]) -> Operand {
        if op == Op::Less {
            let operands = [a, b].map(|id| self.operand(id));
            return self.mask(|to| Instruction::Less(to, operands));
        }
        let a = self.value(a);
        if op == Op::Not {
            return self.mask(|to| Instruction::MaskNot(to, a));
        }
        let b = self.value(b);
        self.mask(|to| if op == Op::And { Instruction::MaskAnd(to, [a, b]) } else { Instruction::MaskOr(to, [a, b]) })
    }

    fn select_mask(&mut self, [mask, a, b]: [Id; 3]) -> Operand {
        let [mask, a, b] = [mask, a, b].map(|id| self.value(id));
        let taken = self.make(Class::Mask, |to| Instruction::MaskAnd(to, [mask, a]));
        let not = self.make(Class::Mask, |to| Instruction::MaskNot(to, mask));
        let other = self.make(Class::Mask, |to| Instruction::MaskAnd(to, [not, b]));
        self.mask(|to| Instruction::MaskOr(to, [taken, other]))
    }

    fn arithmetic(&mut self, op: Op, args: &[Id]) -> Operand {
        let a = self.operand(args[0]);
        let b = args.get(1).map_or(a, |&id| self.operand(id));
        match op {
            Op::Add => self.binary(Binary::Add, a, b),
            Op::Sub => self.binary(Binary::Sub, a, b),
            Op::Mul => self.binary(Binary::Mul, a, b),
            Op::Min => self.binary(Binary::Min, a, b),
            Op::Max => self.binary(Binary::Max, a, b),
            Op::Saturate => {
                let above = self.binary(Binary::Max, a, number(0.0));
                self.binary(Binary::Min, above, number(1.0))
            }
            Op::Neg => self.binary(Binary::Xor, a, Operand::Constant(SIGN)),
            Op::Abs => self.binary(Binary::And, a, Operand::Constant(!SIGN)),
            Op::Sqrt => self.unary(Unary::Sqrt, a),
            Op::Rsqrt => self.rsqrt(a),
            Op::Recip => self.recip(a),
            Op::Floor => self.unary(Unary::Floor, a),
            Op::Round => self.unary(Unary::Round, a),
            Op::WordAdd => self.binary(Binary::AddWords, a, b),
            Op::Xor => self.binary(Binary::Xor, a, b),
            Op::BitAnd => self.binary(Binary::And, a, b),
            Op::BitOr => self.binary(Binary::Or, a, b),
            Op::ShiftLeft(by) => self.unary(Unary::ShiftLeft(by), a),
            Op::ShiftRight(by) => self.unary(Unary::ShiftRight(by), a),
            Op::MulLow => self.binary(Binary::MulWords, a, b),
            Op::MulHigh => self.mul_high(a, b),
            Op::ToNumber => self.unary(Unary::ToNumber, a),
            Op::ToWord => self.unary(Unary::ToWord, a),
            // Registers hold bits.
            Op::ToBits | Op::FromBits => a,
            op => unreachable!("{op:?} is taken care of"),
        }
    }

    /// One step of Newton's method, as lanes do it: `y + y (1/2 - x/2 y²)`.
    fn rsqrt(&mut self, x: Operand) -> Operand {
        let y = self.unary(Unary::RsqrtGuess, x);
        let half = self.binary(Binary::Mul, x, number(0.5));
        let half = self.binary(Binary::Mul, half, y);
        let off = self.mul_add(true, half, y, number(0.5));
        self.mul_add(false, y, off, y)
    }

    /// The same of `1 / x`: `y + y (1 - x y)`.
    fn recip(&mut self, x: Operand) -> Operand {
        let y = self.unary(Unary::RecipGuess, x);
        let off = self.mul_add(true, x, y, number(1.0));
        self.mul_add(false, y, off, y)
    }

    /// The processor multiplies every other lane; the odd ones are shifted down, and their upper halves stay where they are.
    fn mul_high(&mut self, a: Operand, b: Operand) -> Operand {
        let even = self.binary(Binary::MulEven, a, b);
        let even = self.unary(Unary::ShiftRightWide(32), even);
        let [a, b] =
            [a, b].map(|x| if let Operand::Constant(_) = x { x } else { self.unary(Unary::ShiftRightWide(32), x) });
        let odd = self.binary(Binary::MulEven, a, b);
        let odd = self.unary(Unary::ShiftRightWide(32), odd);
        let odd = self.unary(Unary::ShiftLeftWide(32), odd);
        self.binary(Binary::Or, even, odd)
    }

    // --- memory ---

    /// A row of a buffer: a copy, until it is known that the row is not overwritten before it is read for the last time.
    fn input(&mut self, buffer: Buffer, row: u32) -> Operand {
        let entry = Entry { binding: buffer.binding, row, sharing: buffer.sharing };
        let place = self.code.value(Class::Vector, Some(Home::Entry(entry)));
        self.loads.push((self.code.instructions.len(), entry));
        self.vector(|to| Instruction::Copy(to, place))
    }

    fn gather(&mut self, buffer: Buffer, rows: Rows, index: Id) -> Operand {
        self.gathers.push((self.code.instructions.len(), buffer, rows));
        // A row is so many words wide.
        let width = if buffer.sharing == Sharing::PerEnv { LANES as u32 } else { 1 };
        let index = self.operand(index);
        let within = self.binary(Binary::MinWords, index, Operand::Constant(rows.count - 1));
        let rows_on = self.binary(Binary::MulWords, within, Operand::Constant(rows.step * width));
        let mut at = self.binary(Binary::AddWords, rows_on, Operand::Constant(rows.first * width));
        if buffer.sharing == Sharing::PerEnv {
            at = self.binary(Binary::AddWords, at, Operand::LaneNumber);
        }
        self.gather_at(Source::Buffer(buffer.binding), at)
    }

    fn table(&mut self, base: u32, index: Id) -> Operand {
        let index = self.operand(index);
        // Never beyond the table, whatever the index.
        let last = self.program.table.len() as u32 - 1;
        let at = self.binary(Binary::AddWords, index, Operand::Constant(base));
        let at = self.binary(Binary::MinWords, at, Operand::Constant(last));
        self.gather_at(Source::Table, at)
    }

    fn gather_at(&mut self, source: Source, at: Operand) -> Operand {
        let Operand::Value(at) = at else { unreachable!("an instruction made it") };
        self.vector(|to| Instruction::Gather(to, source, at))
    }

    /// Refuses to look up what may be written before: it would have to be what was there before the program.
    fn check_gathers(&self) -> Result<(), NativeError> {
        let written = self.first_writes();
        for &(at, buffer, rows) in &self.gathers {
            let is_late = |row| {
                let entry = Entry { binding: buffer.binding, row, sharing: buffer.sharing };
                written.get(&entry).is_some_and(|&written| written < at)
            };
            if (0..rows.count).any(|k| is_late(rows.at(k))) {
                return Err(NativeError::GathersWhatItWrites { binding: buffer.binding });
            }
        }
        Ok(())
    }

    /// Where each row is written first; within loops, where the outermost one begins.
    fn first_writes(&self) -> HashMap<Entry, usize> {
        let (mut written, mut loops) = (HashMap::new(), vec![]);
        for (at, instruction) in self.code.instructions.iter().enumerate() {
            match instruction {
                Instruction::BeginLoop { .. } => loops.push(at),
                Instruction::EndLoop { .. } => drop(loops.pop()),
                Instruction::Store(entry, ..) => {
                    written.entry(*entry).or_insert(loops.first().copied().unwrap_or(at));
                }
                _ => {}
            }
        }
        written
    }

    /// Inputs whose rows are not written before their last use are read where they lie.
    fn leave_inputs_in_place(&mut self) {
        let written = self.first_writes();
        let last = crate::uses::last_uses(&self.code);
        for (at, entry) in std::mem::take(&mut self.loads) {
            let Instruction::Copy(copy, _) = self.code.instructions[at] else { unreachable!("a copy was put there") };
            if written.get(&entry).is_none_or(|&written| last[copy as usize] <= written) {
                self.code.homes[copy as usize] = Some(Home::Entry(entry));
                self.code.instructions[at] = Instruction::Nothing;
            }
        }
    }

    // --- statements ---

    fn statement(&mut self, number: u32) -> Result<(), NativeError> {
        let program = self.program;
        match &program.statements[number as usize] {
            Statement::Loop(each) => self.write_loop(number, each),
            Statement::Branch(each) => self.write_branch(number, each),
            Statement::Chunks(each) => self.write_chunks(number, each),
            &Statement::Store(Store { buffer, row, value }) => {
                let value = self.operand(value);
                let entry = Entry { binding: buffer.binding, row, sharing: buffer.sharing };
                if buffer.sharing == Sharing::Shared {
                    return Err(NativeError::WritesShared { binding: buffer.binding });
                }
                let mask = self.masks.last().copied();
                self.push(Instruction::Store(entry, value, mask));
                Ok(())
            }
        }
    }

    fn declare(&mut self, number: u32) {
        let live: Vec<usize> = self.program.live_carries(number).map(|(index, _)| index).collect();
        for index in live {
            if !self.cells.contains_key(&(number, index)) {
                let taken_over = self.heirs.get(&(number, index)).map(|from| self.cells[from]);
                let cell = taken_over.unwrap_or_else(|| self.code.cells(1));
                self.cells.insert((number, index), cell);
            }
        }
    }

    /// Writes all variables of a statement. All are read first: one may become what another was.
    fn put_variables(&mut self, number: u32, which: impl Fn(&myo_scalar::symbolic::Carry) -> Id) {
        let program = self.program;
        let own: Vec<Cell> = program.live_carries(number).map(|(index, _)| self.cells[&(number, index)]).collect();
        let mut puts = vec![];
        for (index, carry) in program.live_carries(number) {
            let mut operand = self.operand(which(carry));
            let cell = self.cells[&(number, index)];
            if let Operand::Value(value) = operand
                && let Some(Home::Cell(home)) = self.code.homes[value as usize]
                && own.contains(&home)
            {
                if home == cell {
                    continue;
                }
                let class = self.code.classes[value as usize];
                operand = Operand::Value(self.make(class, |to| Instruction::Copy(to, value)));
            }
            puts.push(Instruction::Put(cell, operand));
        }
        self.code.instructions.extend(puts);
    }

    fn carried(&mut self, id: Id, statement: u32, index: usize, kind: Kind) -> Operand {
        if let Statement::Chunks(_) = self.program.statements[statement as usize] {
            return self.operands[id as usize].expect("what a chunk begins with is set when its body begins");
        }
        self.in_cell(self.cells[&(statement, index)], kind)
    }

    fn outcome(&mut self, statement: u32, index: usize, kind: Kind) -> Operand {
        match &self.program.statements[statement as usize] {
            Statement::Chunks(each) => {
                let size = each.start.len();
                let cell = self.cell_of_entry(statement, index / size, index % size);
                self.in_cell(cell, kind)
            }
            _ => self.in_cell(self.cells[&(statement, index)], kind),
        }
    }

    fn in_cell(&mut self, cell: Cell, kind: Kind) -> Operand {
        let class = if kind == Kind::Mask { Class::Mask } else { Class::Vector };
        Operand::Value(self.code.value(class, Some(Home::Cell(cell))))
    }

    fn counter(&mut self, number: u32) -> u32 {
        let next = self.code.ncounter;
        let counter = *self.counters.entry(number).or_insert(next);
        self.code.ncounter = self.code.ncounter.max(counter + 1);
        counter
    }

    fn write_loop(&mut self, number: u32, each: &Loop) -> Result<(), NativeError> {
        self.declare(number);
        self.put_variables(number, |carry| carry.init);
        let counter = self.counter(number);
        self.push(Instruction::BeginLoop { counter });
        self.region(each.body)?;
        let again = each.again.map(|id| self.value(id));
        self.put_variables(number, |carry| carry.next);
        self.push(Instruction::EndLoop { counter, limit: each.limit, again });
        Ok(())
    }

    fn write_branch(&mut self, number: u32, each: &Branch) -> Result<(), NativeError> {
        self.declare(number);
        self.put_variables(number, |carry| carry.init);
        let mut mask = self.value(each.mask);
        if let Some(&outer) = self.masks.last() {
            mask = self.make(Class::Mask, |to| Instruction::MaskAnd(to, [outer, mask]));
        }
        self.push(Instruction::BeginBranch { mask });
        self.masks.push(mask);
        self.region(each.body)?;
        self.masks.pop();
        self.put_variables(number, |carry| carry.next);
        self.push(Instruction::EndBranch);
        Ok(())
    }

    fn write_chunks(&mut self, number: u32, each: &Chunks) -> Result<(), NativeError> {
        let (program, size) = (self.program, each.start.len());
        let is_kept = |&entry: &usize| program.reads_entry(each, entry) || program.writes_entry(number, each, entry);
        let entries: Vec<usize> = (0..size).filter(is_kept).collect();
        let chunks = each.init.len() / size;
        let first = self.code.cells((entries.len() * chunks) as u32);
        let width = entries.len() as u32;
        self.chunks.insert(number, Kept { first, entries });
        for (k, &id) in each.init.iter().enumerate().filter(|(k, _)| program.reads_entry(each, k % size)) {
            let operand = self.operand(id);
            let cell = self.cell_of_entry(number, k / size, k % size);
            self.push(Instruction::Put(cell, operand));
        }
        let counter = self.counter(number);
        self.push(Instruction::BeginLoop { counter });
        self.operands[each.index as usize] = Some(self.vector(|to| Instruction::ChunkNumber(to, counter)));
        let place = |this: &Self, entry| ChunkEntry { counter, first, position: this.position(number, entry), width };
        for entry in (0..size).filter(|&entry| program.reads_entry(each, entry)) {
            let entry_of = place(self, entry);
            let taken = self.vector(|to| Instruction::TakeEntry(to, entry_of));
            self.operands[each.start[entry] as usize] = Some(taken);
        }
        self.region(each.body)?;
        for entry in (0..size).filter(|&entry| program.writes_entry(number, each, entry)) {
            let next = self.operand(each.next[entry]);
            let entry_of = place(self, entry);
            self.push(Instruction::PutEntry(entry_of, next));
        }
        self.push(Instruction::EndLoop { counter, limit: chunks as u32, again: None });
        Ok(())
    }

    /// Place of an entry among those of a chunk that are kept.
    fn position(&self, number: u32, entry: usize) -> u32 {
        let entries = &self.chunks[&number].entries;
        entries.iter().position(|&other| other == entry).expect("what is needed is kept") as u32
    }

    fn cell_of_entry(&self, number: u32, chunk: usize, entry: usize) -> Cell {
        let kept = &self.chunks[&number];
        kept.first + (chunk * kept.entries.len()) as u32 + self.position(number, entry)
    }
}

fn number(x: f64) -> Operand {
    Operand::Constant((x as f32).to_bits())
}
