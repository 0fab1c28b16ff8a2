//! The computation itself.

use super::shell::{Types, entry, entry_of};
use crate::symbolic::graph::{Buffer, Id, Op, Rows};
use crate::symbolic::order::Item;
use crate::symbolic::program::Program;
use crate::symbolic::region::{Branch, Chunks, Loop, Statement, Store};
use naga::{
    ArraySize, BinaryOperator, Block, Expression, Function, FunctionArgument, Handle, Literal, LocalVariable,
    MathFunction, Module, Range, ScalarKind, Span, Statement as Instruction, Type, TypeInner, UnaryOperator,
};
use std::collections::HashMap;

/// Adding it to a whole number below 2^22 puts the number into the low bits.
const WHOLE: f32 = 12_582_912.0;

type Expr = Handle<Expression>;

/// A function while it is written.
pub struct Body<'a> {
    program: &'a Program,
    order: Vec<Vec<Item>>,
    names: &'a [&'a str],
    function: Function,
    /// Blocks being written, outermost first.
    blocks: Vec<Block>,
    /// First expression that no block has taken up yet.
    pending: Option<Expr>,
    /// Where each node is computed.
    values: Vec<Option<Expr>>,
    words: HashMap<u32, Expr>,
    numbers: HashMap<u32, Expr>,
    /// Pointers to the program's buffers and to its table.
    buffers: Vec<Expr>,
    table: Option<Expr>,
    environment: Option<(Expr, Expr)>,
    /// Pointers to the variables of statements; arrays are variable 0 of theirs.
    variables: HashMap<(u32, usize), Expr>,
    counters: HashMap<u32, Expr>,
    /// Entries of a chunk that are kept, of each loop over chunks.
    kept: HashMap<u32, Vec<usize>>,
}

impl<'a> Body<'a> {
    /// `names` are those of the buffers.
    pub fn new(
        program: &'a Program,
        module: &mut Module,
        types: &Types,
        arguments: Vec<FunctionArgument>,
        names: &'a [&'a str],
    ) -> Self {
        let mut body = Self {
            program,
            order: program.order(),
            names,
            function: Function { arguments, ..Function::default() },
            blocks: vec![Block::new()],
            pending: None,
            values: vec![None; program.nodes.len()],
            words: HashMap::new(),
            numbers: HashMap::new(),
            buffers: vec![],
            table: None,
            environment: None,
            variables: HashMap::new(),
            counters: HashMap::new(),
            kept: HashMap::new(),
        };
        body.declare_variables(module, types);
        body
    }

    /// Writes the whole program.
    pub fn run(&mut self) {
        self.region(0);
    }

    pub fn finish(mut self) -> Function {
        self.flush();
        self.function.body = self.blocks.pop().expect("the outermost block");
        self.function.body.push(Instruction::Return { value: None }, Span::default());
        self.function
    }

    // --- declarations; these expressions belong to no block ---

    /// Says where the program's buffers are, and its table if it has one.
    pub fn bind(&mut self, buffers: impl Iterator<Item = Expression>, table: Option<Expression>) {
        self.buffers = buffers.map(|buffer| self.declare(buffer)).collect();
        self.table = table.map(|table| self.declare(table));
    }

    pub fn declare(&mut self, expression: Expression) -> Expr {
        self.flush();
        self.function.expressions.append(expression, Span::default())
    }

    fn variable(&mut self, name: String, ty: Handle<Type>) -> Expr {
        let variable = LocalVariable { name: Some(name), ty, init: None };
        let variable = self.function.local_variables.append(variable, Span::default());
        self.declare(Expression::LocalVariable(variable))
    }

    fn declare_variables(&mut self, module: &mut Module, types: &Types) {
        let program = self.program;
        for region in 0..self.order.len() as u32 {
            for number in program.statements_of(region) {
                for (index, carry) in program.live_carries(number) {
                    let pointer = self.variable(format!("v{number}_{index}"), types.of(carry.kind));
                    self.variables.insert((number, index), pointer);
                }
                match &program.statements[number as usize] {
                    Statement::Loop(_) => {
                        let counter = self.variable(format!("count{number}"), types.word);
                        self.counters.insert(number, counter);
                    }
                    Statement::Chunks(x) => {
                        self.declare_chunks(module, types, number, x);
                        let counter = self.variable(format!("count{number}"), types.word);
                        self.counters.insert(number, counter);
                    }
                    Statement::Branch(_) | Statement::Store(_) => {}
                }
            }
        }
    }

    fn declare_chunks(&mut self, module: &mut Module, types: &Types, number: u32, each: &Chunks) {
        let size = each.start.len();
        let is_kept =
            |&entry: &usize| self.program.reads_entry(each, entry) || self.program.writes_entry(number, each, entry);
        let kept: Vec<usize> = (0..size).filter(is_kept).collect();
        let chunks = each.init.len() / size;
        let entries = (kept.len() * chunks) as u32;
        let size = ArraySize::Constant(entries.try_into().expect("a loop that is needed keeps something"));
        let inner = TypeInner::Array { base: types.number, size, stride: 4 };
        let array = module.types.insert(Type { name: None, inner }, Span::default());
        let pointer = self.variable(format!("array{number}"), array);
        self.variables.insert((number, 0), pointer);
        self.kept.insert(number, kept);
    }

    fn constant(&mut self, op: Op) -> Expr {
        match op {
            Op::Number(bits) => match f64::from_bits(bits) as f32 {
                x if x.is_finite() => self.literal_number(x),
                // There is no literal for it.
                x => {
                    let bits = self.literal_word(x.to_bits());
                    self.reinterpret(bits, ScalarKind::Float)
                }
            },
            Op::Word(x) => self.literal_word(x),
            Op::Truth(x) => self.declare(Expression::Literal(Literal::Bool(x))),
            op => unreachable!("{op:?} is no constant"),
        }
    }

    pub fn literal_word(&mut self, x: u32) -> Expr {
        if let Some(&known) = self.words.get(&x) {
            return known;
        }
        let literal = self.declare(Expression::Literal(Literal::U32(x)));
        self.words.insert(x, literal);
        literal
    }

    fn literal_number(&mut self, x: f32) -> Expr {
        if let Some(&known) = self.numbers.get(&x.to_bits()) {
            return known;
        }
        let literal = self.declare(Expression::Literal(Literal::F32(x)));
        self.numbers.insert(x.to_bits(), literal);
        literal
    }

    // --- expressions of the current block ---

    fn emit(&mut self, expression: Expression) -> Expr {
        let handle = self.function.expressions.append(expression, Span::default());
        self.pending.get_or_insert(handle);
        handle
    }

    /// Hands the expressions since the last instruction to the current block.
    fn flush(&mut self) {
        let Some(first) = self.pending.take() else { return };
        let (last, _) = self.function.expressions.iter().next_back().expect("at least `first`");
        self.push(Instruction::Emit(Range::new_from_bounds(first, last)));
    }

    fn push(&mut self, instruction: Instruction) {
        self.blocks.last_mut().expect("a block is open").push(instruction, Span::default());
    }

    fn instruct(&mut self, instruction: Instruction) {
        self.flush();
        self.push(instruction);
    }

    /// Writes a block of its own.
    fn block(&mut self, write: impl FnOnce(&mut Self)) -> Block {
        self.flush();
        self.blocks.push(Block::new());
        write(self);
        self.flush();
        self.blocks.pop().expect("the block pushed above")
    }

    pub fn branch(&mut self, condition: Expr, accept: Block, reject: Block) {
        self.instruct(Instruction::If { condition, accept, reject });
    }

    pub fn binary(&mut self, op: BinaryOperator, left: Expr, right: Expr) -> Expr {
        self.emit(Expression::Binary { op, left, right })
    }

    fn unary(&mut self, op: UnaryOperator, expr: Expr) -> Expr {
        self.emit(Expression::Unary { op, expr })
    }

    fn math(&mut self, fun: MathFunction, args: &[Expr]) -> Expr {
        let arg = |k: usize| args.get(k).copied();
        self.emit(Expression::Math { fun, arg: args[0], arg1: arg(1), arg2: arg(2), arg3: None })
    }

    pub fn component(&mut self, base: Expr, index: u32) -> Expr {
        self.emit(Expression::AccessIndex { base, index })
    }

    pub fn load(&mut self, pointer: Expr) -> Expr {
        self.emit(Expression::Load { pointer })
    }

    fn store(&mut self, pointer: Expr, value: Expr) {
        self.instruct(Instruction::Store { pointer, value });
    }

    /// Same bits, other type.
    fn reinterpret(&mut self, expr: Expr, kind: ScalarKind) -> Expr {
        self.emit(Expression::As { expr, kind, convert: None })
    }

    fn access(&mut self, base: Expr, index: Expr) -> Expr {
        self.emit(Expression::Access { base, index })
    }

    // --- the invocation's place ---

    pub fn set_environment(&mut self, environment: Expr, environments: Expr) {
        self.environment = Some((environment, environments));
    }

    /// Number of this environment, number of environments.
    pub fn environment(&self) -> (Expr, Expr) {
        self.environment.expect("set by the guard of a kernel")
    }

    // --- the program ---

    fn region(&mut self, region: u32) {
        for item in std::mem::take(&mut self.order[region as usize]) {
            match item {
                Item::Node(id) => {
                    let value = self.node(id);
                    self.values[id as usize] = Some(value);
                }
                Item::Statement(number) => self.statement(number),
            }
        }
    }

    fn value(&mut self, id: Id) -> Expr {
        let op = self.program.nodes[id as usize].op;
        if op.is_constant() {
            return self.constant(op);
        }
        self.values[id as usize].expect("operands are computed before they are used")
    }

    fn statement(&mut self, number: u32) {
        let program = self.program;
        match &program.statements[number as usize] {
            Statement::Loop(each) => self.write_loop(number, each),
            Statement::Branch(each) => self.write_branch(number, each),
            Statement::Chunks(each) => self.write_chunks(number, each),
            Statement::Store(each) => self.write_store(each),
        }
    }

    fn write_loop(&mut self, number: u32, each: &Loop) {
        self.set_variables(number, |carry| carry.init);
        let counter = self.counters[&number];
        let zero = self.literal_word(0);
        self.store(counter, zero);
        let body = self.block(|this| {
            this.region(each.body);
            this.set_variables(number, |carry| carry.next);
            if let Some(again) = each.again {
                let again = this.value(again);
                let leave = Block::from_vec(vec![Instruction::Break]);
                this.branch(again, Block::new(), leave);
            }
        });
        let limit = self.literal_word(each.limit);
        self.count_up(counter, limit, body);
    }

    /// A loop that counts from zero below a limit.
    fn count_up(&mut self, counter: Expr, limit: Expr, body: Block) {
        let mut full = None;
        let continuing = self.block(|this| {
            let (before, one) = (this.load(counter), this.literal_word(1));
            let after = this.binary(BinaryOperator::Add, before, one);
            full = Some(this.binary(BinaryOperator::GreaterEqual, after, limit));
            this.store(counter, after);
        });
        self.instruct(Instruction::Loop { body, continuing, break_if: full });
    }

    fn set_variables(&mut self, number: u32, which: impl Fn(&crate::symbolic::Carry) -> Id) {
        let program = self.program;
        let values: Vec<(usize, Expr)> =
            program.live_carries(number).map(|(index, carry)| (index, self.value(which(carry)))).collect();
        for (index, value) in values {
            self.store(self.variables[&(number, index)], value);
        }
    }

    fn write_branch(&mut self, number: u32, each: &Branch) {
        self.set_variables(number, |carry| carry.init);
        let condition = self.value(each.mask);
        let accept = self.block(|this| {
            this.region(each.body);
            this.set_variables(number, |carry| carry.next);
        });
        self.branch(condition, accept, Block::new());
    }

    fn write_chunks(&mut self, number: u32, each: &Chunks) {
        let (program, counter, size) = (self.program, self.counters[&number], each.start.len());
        for (k, &id) in each.init.iter().enumerate().filter(|(k, _)| program.reads_entry(each, k % size)) {
            let value = self.value(id);
            let pointer = self.entry_of_chunks(number, size, k);
            self.store(pointer, value);
        }
        let zero = self.literal_word(0);
        let chunks = (each.init.len() / size) as u32;
        let limit = match each.count {
            None => self.literal_word(chunks),
            Some(at) => {
                let count = self.look_up(at, zero);
                self.emit(Expression::As { expr: count, kind: ScalarKind::Uint, convert: Some(4) })
            }
        };
        self.store(counter, zero);
        let body = self.block(|this| {
            let index = this.load(counter);
            this.values[each.index as usize] = Some(index);
            this.take_chunk(number, each, index);
            this.region(each.body);
            this.put_chunk(number, each, index);
        });
        self.count_up(counter, limit, body);
    }

    /// Reads what the body needs of a chunk.
    fn take_chunk(&mut self, number: u32, each: &Chunks, index: Expr) {
        let (program, size) = (self.program, each.start.len());
        let read: Vec<usize> = (0..size).filter(|&entry| program.reads_entry(each, entry)).collect();
        for entry in read {
            let pointer = self.indexed_entry(number, index, entry);
            self.values[each.start[entry] as usize] = Some(self.load(pointer));
        }
        self.flush();
    }

    /// Writes what is needed of a chunk afterwards.
    fn put_chunk(&mut self, number: u32, each: &Chunks, index: Expr) {
        let (program, size) = (self.program, each.start.len());
        let written = (0..size).filter(|&entry| program.writes_entry(number, each, entry));
        let written: Vec<(usize, Expr)> = written.map(|entry| (entry, self.value(each.next[entry]))).collect();
        for (entry, value) in written {
            let pointer = self.indexed_entry(number, index, entry);
            self.store(pointer, value);
        }
    }

    /// Where an entry of a chunk lies whose number is counted as the loop runs.
    fn indexed_entry(&mut self, number: u32, chunk: Expr, entry: usize) -> Expr {
        let (position, width) = self.position_in_chunk(number, entry);
        let [width, position] = [width, position].map(|word| self.literal_word(word));
        let first = self.binary(BinaryOperator::Multiply, chunk, width);
        let at = self.binary(BinaryOperator::Add, first, position);
        self.access(self.variables[&(number, 0)], at)
    }

    /// Where entry `k` of all chunks lies.
    fn entry_of_chunks(&mut self, number: u32, size: usize, k: usize) -> Expr {
        let (position, width) = self.position_in_chunk(number, k % size);
        let index = self.literal_word((k / size) as u32 * width + position);
        self.access(self.variables[&(number, 0)], index)
    }

    /// Place of an entry among those of a chunk that are kept, and how many these are.
    fn position_in_chunk(&self, number: u32, entry: usize) -> (u32, u32) {
        let kept = &self.kept[&number];
        let position = kept.iter().position(|&other| other == entry).expect("what is needed is kept");
        (position as u32, kept.len() as u32)
    }

    fn write_store(&mut self, each: &Store) {
        let value = self.value(each.value);
        let index = entry(self, each.buffer.sharing, each.row);
        let pointer = self.access(self.buffers[each.buffer.binding as usize], index);
        self.store(pointer, value);
    }

    fn node(&mut self, id: Id) -> Expr {
        let node = self.program.nodes[id as usize];
        if let Some(value) = self.values[id as usize] {
            return value;
        }
        let args: Vec<Expr> = node.operands().iter().map(|&arg| self.value(arg)).collect();
        match node.op {
            Op::Number(_) | Op::Word(_) | Op::Truth(_) => unreachable!("constants are declared"),
            Op::Input(buffer, row) => {
                let index = entry(self, buffer.sharing, row);
                let pointer = self.access(self.buffers[buffer.binding as usize], index);
                let value = self.load(pointer);
                let name = format!("{}_{row}", self.names[buffer.binding as usize]);
                self.function.named_expressions.insert(value, name);
                value
            }
            Op::Carried(statement, index) => self.load(self.variables[&(statement, index as usize)]),
            Op::Outcome(statement, index) => self.outcome(statement, index),
            Op::Neg => self.unary(UnaryOperator::Negate, args[0]),
            Op::Not => self.unary(UnaryOperator::LogicalNot, args[0]),
            Op::Select => self.emit(Expression::Select { condition: args[0], accept: args[1], reject: args[2] }),
            Op::Recip => {
                let one = self.literal_number(1.0);
                self.binary(BinaryOperator::Divide, one, args[0])
            }
            Op::ShiftLeft(by) | Op::ShiftRight(by) => {
                let by = self.literal_word(by);
                let left = matches!(node.op, Op::ShiftLeft(_));
                let op = if left { BinaryOperator::ShiftLeft } else { BinaryOperator::ShiftRight };
                self.binary(op, args[0], by)
            }
            Op::Gather(buffer, rows) => self.gather(buffer, rows, args[0]),
            Op::Table(base) => self.look_up(base, args[0]),
            Op::MulHigh => self.mul_high(args[0], args[1]),
            Op::ToNumber => self.emit(Expression::As { expr: args[0], kind: ScalarKind::Float, convert: Some(4) }),
            Op::ToWord => self.whole_to_word(args[0]),
            Op::ToBits => self.reinterpret(args[0], ScalarKind::Uint),
            Op::FromBits => self.reinterpret(args[0], ScalarKind::Float),
            op => match (binary_operator(op), function(op)) {
                (Some(op), _) => self.binary(op, args[0], args[1]),
                (None, Some(function)) => self.math(function, &args),
                (None, None) => unreachable!("every operation is printed: {op:?}"),
            },
        }
    }

    fn outcome(&mut self, statement: u32, index: u32) -> Expr {
        if let Statement::Chunks(each) = &self.program.statements[statement as usize] {
            let pointer = self.entry_of_chunks(statement, each.start.len(), index as usize);
            return self.load(pointer);
        }
        self.load(self.variables[&(statement, index as usize)])
    }

    /// Never reads beyond the rows, whatever the index is.
    fn gather(&mut self, buffer: Buffer, rows: Rows, index: Expr) -> Expr {
        let [first, step, last] = [rows.first, rows.step, rows.count - 1].map(|word| self.literal_word(word));
        let index = self.math(MathFunction::Min, &[index, last]);
        let row = self.binary(BinaryOperator::Multiply, index, step);
        let row = self.binary(BinaryOperator::Add, row, first);
        let index = entry_of(self, buffer.sharing, row);
        let pointer = self.access(self.buffers[buffer.binding as usize], index);
        self.load(pointer)
    }

    fn look_up(&mut self, base: u32, row: Expr) -> Expr {
        let base = self.literal_word(base);
        let index = self.binary(BinaryOperator::Add, base, row);
        let pointer = self.access(self.table.expect("declared if anything is looked up"), index);
        self.load(pointer)
    }

    /// Upper half of a 64-bit product, from products of 16-bit halves; no sum exceeds 32 bits.
    fn mul_high(&mut self, a: Expr, b: Expr) -> Expr {
        use BinaryOperator::{Add, And, Multiply, ShiftRight};
        let (half, low) = (self.literal_word(16), self.literal_word(0xffff));
        let [a1, b1] = [a, b].map(|x| self.binary(ShiftRight, x, half));
        let [a0, b0] = [a, b].map(|x| self.binary(And, x, low));
        let [p00, p01] = [b0, b1].map(|b| self.binary(Multiply, a0, b));
        let [p10, p11] = [b0, b1].map(|b| self.binary(Multiply, a1, b));
        let carry = self.binary(ShiftRight, p00, half);
        let middle = self.binary(Add, p10, carry);
        let rest = self.binary(And, middle, low);
        let other = self.binary(Add, p01, rest);
        let [middle, other] = [middle, other].map(|x| self.binary(ShiftRight, x, half));
        let high = self.binary(Add, p11, middle);
        self.binary(Add, high, other)
    }

    /// Two's complement of a whole number, from the bits of its sum with [`WHOLE`].
    fn whole_to_word(&mut self, x: Expr) -> Expr {
        let whole = self.literal_number(WHOLE);
        let sum = self.binary(BinaryOperator::Add, x, whole);
        let bits = self.reinterpret(sum, ScalarKind::Uint);
        let offset = self.literal_word(WHOLE.to_bits().wrapping_neg());
        self.binary(BinaryOperator::Add, bits, offset)
    }
}

fn binary_operator(op: Op) -> Option<BinaryOperator> {
    Some(match op {
        Op::Add | Op::WordAdd => BinaryOperator::Add,
        Op::Sub => BinaryOperator::Subtract,
        Op::Mul | Op::MulLow => BinaryOperator::Multiply,
        Op::Less => BinaryOperator::Less,
        Op::And | Op::BitAnd => BinaryOperator::And,
        Op::Or | Op::BitOr => BinaryOperator::InclusiveOr,
        Op::Xor => BinaryOperator::ExclusiveOr,
        _ => return None,
    })
}

fn function(op: Op) -> Option<MathFunction> {
    Some(match op {
        Op::MulAdd => MathFunction::Fma,
        Op::Sqrt => MathFunction::Sqrt,
        Op::Rsqrt => MathFunction::InverseSqrt,
        Op::Abs => MathFunction::Abs,
        Op::Saturate => MathFunction::Saturate,
        Op::Min => MathFunction::Min,
        Op::Max => MathFunction::Max,
        Op::Floor => MathFunction::Floor,
        Op::Round => MathFunction::Round,
        _ => return None,
    })
}
