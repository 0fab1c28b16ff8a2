//! Running a program in double precision, one environment at a time: slow, and a check on everything that comes after
//! recording.

use super::graph::{Id, Op};
use super::order::Item;
use super::program::Program;
use super::region::{Chunks, Loop, Statement, Store};

/// A number, an integer or a truth value.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Value {
    Number(f64),
    Word(u32),
    Truth(bool),
}

/// What a buffer holds for one environment.
#[derive(Clone, Debug, PartialEq)]
pub enum Contents {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Integers.
    Words(Vec<u32>),
}

impl Contents {
    fn get(&self, row: usize) -> Value {
        match self {
            Self::Numbers(x) => Value::Number(x[row]),
            Self::Words(x) => Value::Word(x[row]),
        }
    }
    fn set(&mut self, row: usize, value: Value) {
        match (self, value) {
            (Self::Numbers(x), Value::Number(value)) => x[row] = value,
            (Self::Words(x), Value::Word(value)) => x[row] = value,
            (column, value) => panic!("{value:?} does not fit {column:?}"),
        }
    }
}

impl Program {
    /// Runs the program on the buffers of one environment, by binding.
    ///
    /// # Panics
    /// If a buffer is missing, too short or of the wrong kind.
    pub fn interpret(&self, buffers: &mut [Contents]) {
        let mut run = Run {
            program: self,
            order: self.order(),
            buffers,
            values: vec![None; self.nodes.len()],
            variables: self.statements.iter().map(|_| vec![]).collect(),
        };
        run.region(0);
    }
}

struct Run<'a> {
    program: &'a Program,
    order: Vec<Vec<Item>>,
    buffers: &'a mut [Contents],
    values: Vec<Option<Value>>,
    /// Variables of each statement.
    variables: Vec<Vec<Value>>,
}

impl Run<'_> {
    fn region(&mut self, region: u32) {
        for k in 0..self.order[region as usize].len() {
            match self.order[region as usize][k] {
                Item::Node(id) => self.values[id as usize] = Some(self.compute(id)),
                Item::Statement(number) => self.statement(number),
            }
        }
    }

    fn value(&self, id: Id) -> Value {
        match self.program.nodes[id as usize].op {
            Op::Number(bits) => Value::Number(f64::from_bits(bits)),
            Op::Word(x) => Value::Word(x),
            Op::Truth(x) => Value::Truth(x),
            _ => self.values[id as usize].expect("computed before it is used"),
        }
    }

    fn number(&self, id: Id) -> f64 {
        match self.value(id) {
            Value::Number(x) => x,
            other => panic!("{other:?} is no number"),
        }
    }

    fn word(&self, id: Id) -> u32 {
        match self.value(id) {
            Value::Word(x) => x,
            other => panic!("{other:?} is no integer"),
        }
    }

    fn truth(&self, id: Id) -> bool {
        match self.value(id) {
            Value::Truth(x) => x,
            other => panic!("{other:?} is no truth value"),
        }
    }

    fn statement(&mut self, number: u32) {
        let program = self.program;
        match &program.statements[number as usize] {
            Statement::Loop(each) => self.run_loop(number, each),
            Statement::Branch(each) => {
                self.set_variables(number, |carry| carry.init);
                if self.truth(each.mask) {
                    self.region(each.body);
                    self.set_variables(number, |carry| carry.next);
                }
            }
            Statement::Chunks(each) => self.run_chunks(number, each),
            &Statement::Store(Store { buffer, row, value }) => {
                let value = self.value(value);
                self.buffers[buffer.binding as usize].set(row as usize, value);
            }
        }
    }

    /// Variables that nothing needs keep a stand-in.
    fn set_variables(&mut self, number: u32, which: impl Fn(&super::Carry) -> Id) {
        let program = self.program;
        let count = program.live_carries(number).map(|(index, _)| index + 1).max().unwrap_or(0);
        let mut variables = vec![Value::Truth(false); count];
        for (index, carry) in program.live_carries(number) {
            variables[index] = self.value(which(carry));
        }
        self.variables[number as usize] = variables;
    }

    fn run_loop(&mut self, number: u32, each: &Loop) {
        self.set_variables(number, |carry| carry.init);
        for _ in 0..each.limit {
            self.region(each.body);
            self.set_variables(number, |carry| carry.next);
            if each.again.is_some_and(|again| !self.truth(again)) {
                break;
            }
        }
    }

    fn run_chunks(&mut self, number: u32, each: &Chunks) {
        let (program, size) = (self.program, each.start.len());
        // What nothing needs keeps a stand-in.
        let read = |(k, &id): (usize, &Id)| {
            if program.reads_entry(each, k % size) { self.value(id) } else { Value::Number(f64::NAN) }
        };
        let mut array: Vec<Value> = each.init.iter().enumerate().map(read).collect();
        for (index, chunk) in array.chunks_exact_mut(size).enumerate() {
            self.values[each.index as usize] = Some(Value::Word(index as u32));
            for (&id, &value) in each.start.iter().zip(&*chunk) {
                self.values[id as usize] = Some(value);
            }
            self.region(each.body);
            for entry in (0..size).filter(|&entry| program.writes_entry(number, each, entry)) {
                chunk[entry] = self.value(each.next[entry]);
            }
        }
        self.variables[number as usize] = array;
    }

    fn compute(&self, id: Id) -> Value {
        let node = &self.program.nodes[id as usize];
        match node.op {
            Op::Input(buffer, row) => self.buffers[buffer.binding as usize].get(row as usize),
            Op::Gather(buffer, rows) => {
                self.buffers[buffer.binding as usize].get(rows.at(self.word(node.args[0])) as usize)
            }
            // The index and the entries of a chunk are set when its body begins.
            Op::Carried(statement, index) => match &self.program.statements[statement as usize] {
                Statement::Chunks(_) => self.values[id as usize].expect("set when the body began"),
                _ => self.variables[statement as usize][index as usize],
            },
            Op::Outcome(statement, index) => self.variables[statement as usize][index as usize],
            Op::Select => {
                let [mask, a, b] = node.args;
                self.value(if self.truth(mask) { a } else { b })
            }
            op => self.number_op(op, node.args).or_else(|| self.word_op(op, node.args)).unwrap_or_else(|| {
                let [a, b, _] = node.args;
                Value::Truth(match op {
                    Op::Less => self.number(a) < self.number(b),
                    Op::And => self.truth(a) & self.truth(b),
                    Op::Or => self.truth(a) | self.truth(b),
                    Op::Not => !self.truth(a),
                    op => panic!("{op:?} is not known to the interpreter"),
                })
            }),
        }
    }

    fn number_op(&self, op: Op, [a, b, c]: [Id; 3]) -> Option<Value> {
        let x = |id| self.number(id);
        Some(Value::Number(match op {
            Op::Add => x(a) + x(b),
            Op::Sub => x(a) - x(b),
            Op::Mul => x(a) * x(b),
            Op::MulAdd => x(a) * x(b) + x(c),
            Op::Neg => -x(a),
            Op::Sqrt => x(a).sqrt(),
            Op::Rsqrt => x(a).sqrt().recip(),
            Op::Recip => x(a).recip(),
            Op::Abs => x(a).abs(),
            Op::Min => x(a).min(x(b)),
            Op::Max => x(a).max(x(b)),
            Op::Saturate => x(a).clamp(0.0, 1.0),
            Op::Floor => x(a).floor(),
            Op::Round => x(a).round_ties_even(),
            Op::ToNumber => f64::from(self.word(a)),
            Op::Table(base) => self.program.table[(base + self.word(a)) as usize],
            Op::FromBits => f64::from(f32::from_bits(self.word(a))),
            _ => return None,
        }))
    }

    fn word_op(&self, op: Op, [a, b, _]: [Id; 3]) -> Option<Value> {
        let x = |id| self.word(id);
        let wide = |a, b| u64::from(x(a)) * u64::from(x(b));
        Some(Value::Word(match op {
            Op::WordAdd => x(a).wrapping_add(x(b)),
            Op::Xor => x(a) ^ x(b),
            Op::BitAnd => x(a) & x(b),
            Op::BitOr => x(a) | x(b),
            Op::ShiftLeft(by) => x(a) << by,
            Op::ShiftRight(by) => x(a) >> by,
            Op::MulHigh => (wide(a, b) >> 32) as u32,
            Op::MulLow => wide(a, b) as u32,
            Op::ToBits => (self.number(a) as f32).to_bits(),
            Op::ToWord => self.number(a) as i64 as u32,
            _ => return None,
        }))
    }
}
