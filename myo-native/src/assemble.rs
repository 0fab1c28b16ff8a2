//! From instructions to machine code: which value is in which register, and when.
//!
//! Registers are given as the instructions come. Where none is left, the value gives way that is read last, as Belady has it; it goes
//! into the frame unless it lies somewhere in memory anyway. A loop begins with empty registers, and what a branch leaves in other
//! registers than it found it in is read from memory again.

use crate::LANES;
use crate::code::{
    Binary, Cell, ChunkEntry, Class, Code, Entry, Home, Instruction, Operand, Signs, Source, Unary, Value,
};
use crate::emit::{Emitter, From, Jump, Place};
use crate::pieces::Pieces;
use crate::registers::Bank;
use crate::uses::{Uses, last_uses};
use iced_x86::Code as Machine;
use myo_scalar::symbolic::Sharing;
use std::collections::HashMap;

const WIDTH: u32 = 4 * LANES as u32;
/// Mask register for what one instruction needs.
const SPARE_MASK: u8 = 7;
/// Where the numbers of lanes stand among the constants.
const LANE_NUMBERS: u32 = 0;

/// Machine code, and what it wants to find in memory.
pub struct Assembled {
    pub bytes: Vec<u8>,
    pub constants: Vec<u32>,
    /// Bytes of the frame.
    pub frame: usize,
}

/// Makes machine code of instructions.
pub fn assemble(code: &Code, table: &[f64], nbuffer: usize, pieces: &Pieces) -> Assembled {
    let mut assembler = Assembler::new(code, table, nbuffer, pieces);
    for at in 0..code.instructions.len() {
        if assembler.pieces.begins_at(at) {
            assembler.cut();
        }
        assembler.at = at;
        assembler.instruction(&code.instructions[at]);
        assembler.end_of_instruction();
    }
    assembler.finish()
}

struct Assembler<'a> {
    code: &'a Code,
    emitter: Emitter,
    uses: Uses,
    /// Values by the instruction after which nothing reads them any more.
    ending: HashMap<usize, Vec<Value>>,
    at: usize,
    vectors: Bank,
    masks: Bank,
    /// Where values are kept that gave way.
    slots: HashMap<Value, u32>,
    free_slots: Vec<u32>,
    nslot: u32,
    constants: Vec<u32>,
    known: HashMap<u32, u32>,
    table_at: u32,
    pieces: &'a Pieces,
    /// Where loops begin, and whether they have pieces of their own.
    loops: Vec<(usize, bool)>,
    branches: Vec<(Jump, Bank, Bank)>,
}

impl<'a> Assembler<'a> {
    fn new(code: &'a Code, table: &[f64], nbuffer: usize, pieces: &'a Pieces) -> Self {
        let mut ending: HashMap<usize, Vec<Value>> = HashMap::new();
        for (value, at) in last_uses(code).into_iter().enumerate() {
            ending.entry(at).or_default().push(value as Value);
        }
        let lanes: Vec<u32> = (0..LANES as u32).collect();
        let table_at = lanes.len() as u32;
        let constants = lanes.into_iter().chain(table.iter().map(|&x| (x as f32).to_bits())).collect();
        Self {
            code,
            emitter: Emitter::new(nbuffer),
            uses: Uses::of(code),
            ending,
            at: 0,
            vectors: Bank::new(0, 32),
            masks: Bank::new(1, usize::from(SPARE_MASK) - 1),
            slots: HashMap::new(),
            free_slots: vec![],
            nslot: 0,
            constants,
            known: HashMap::new(),
            table_at,
            pieces,
            loops: vec![],
            branches: vec![],
        }
    }

    fn finish(self) -> Assembled {
        let frame = self.slot_offset(self.nslot) as usize;
        Assembled { bytes: self.emitter.finish(), constants: self.constants, frame }
    }

    // --- the frame: cells, counters, slots ---

    fn cell(cell: Cell) -> Place {
        Place::frame(cell * WIDTH)
    }

    fn counter(&self, counter: u32) -> Place {
        Place::frame(self.code.ncell * WIDTH + 4 * counter)
    }

    fn slot_offset(&self, slot: u32) -> u32 {
        let counters = (4 * self.code.ncounter).next_multiple_of(WIDTH);
        (self.code.ncell + slot) * WIDTH + counters
    }

    fn constant(&mut self, bits: u32) -> Place {
        let next = self.constants.len() as u32;
        let number = *self.known.entry(bits).or_insert(next);
        if number == next {
            self.constants.push(bits);
        }
        self.emitter.constant(number)
    }

    fn entry(entry: Entry) -> Place {
        match entry.sharing {
            Sharing::PerEnv => Place::buffer(entry.binding, i64::from(entry.row) * i64::from(WIDTH)),
            Sharing::Shared => Place::buffer(entry.binding, i64::from(entry.row) * 4).broadcast(),
        }
    }

    /// Where a value lies in memory.
    fn place(&self, value: Value) -> Option<Place> {
        match self.code.homes[value as usize] {
            Some(Home::Entry(entry)) => Some(Self::entry(entry)),
            Some(Home::Cell(cell)) => Some(Self::cell(cell)),
            None => self.slots.get(&value).map(|&slot| Place::frame(self.slot_offset(slot))),
        }
    }

    // --- registers ---

    fn class(&self, value: Value) -> Class {
        self.code.classes[value as usize]
    }

    fn bank(&mut self, class: Class) -> &mut Bank {
        match class {
            Class::Vector => &mut self.vectors,
            Class::Mask => &mut self.masks,
        }
    }

    fn is_needed(&mut self, value: Value) -> bool {
        self.uses.next(value, self.at).is_some()
    }

    /// Sees to it that a value in a register is in memory, too.
    fn keep(&mut self, register: u8, value: Value) {
        if self.place(value).is_some() {
            return;
        }
        let slot = self.free_slots.pop().unwrap_or_else(|| {
            self.nslot += 1;
            self.nslot - 1
        });
        self.slots.insert(value, slot);
        let place = Place::frame(self.slot_offset(slot));
        match self.class(value) {
            Class::Vector => self.emitter.store(place, register, None),
            Class::Mask => self.emitter.store_mask(place, register),
        }
    }

    /// A register that may be written to, locked.
    fn free(&mut self, class: Class) -> u8 {
        let bank = if class == Class::Vector { &self.vectors } else { &self.masks };
        let register = bank.choose(&mut self.uses, self.at);
        if let Some(value) = self.bank(class).at(register) {
            if self.is_needed(value) {
                self.keep(register, value);
            }
            self.bank(class).drop_value(value);
        }
        self.bank(class).lock(register);
        register
    }

    /// The register of a value, loaded if need be, locked.
    fn register(&mut self, value: Value) -> u8 {
        let class = self.class(value);
        if let Some(register) = self.bank(class).find(value) {
            self.bank(class).lock(register);
            return register;
        }
        let register = self.free(class);
        self.load(register, value);
        self.bank(class).hold(register, value);
        register
    }

    fn load(&mut self, register: u8, value: Value) {
        let place = self.place(value).expect("what is in no register is in memory");
        match self.class(value) {
            Class::Vector => self.emitter.load(register, place),
            Class::Mask => self.emitter.load_mask(register, place),
        }
    }

    /// A register for an operand, locked.
    fn in_register(&mut self, operand: Operand) -> u8 {
        if let Operand::Value(value) = operand {
            return self.register(value);
        }
        let register = self.free(Class::Vector);
        self.load_literal(register, operand);
        register
    }

    fn load_literal(&mut self, register: u8, operand: Operand) {
        match operand {
            Operand::Constant(0) => self.emitter.zero(register),
            Operand::Constant(bits) => {
                let place = self.constant(bits);
                self.emitter.load(register, place);
            }
            Operand::LaneNumber => self.emitter.load(register, Place::vector_of_constants(LANE_NUMBERS)),
            Operand::Value(value) => self.load(register, value),
        }
    }

    /// An operand where it is, if it is not worth a register: nothing reads it soon.
    fn source(&mut self, operand: Operand) -> From {
        match operand {
            Operand::Constant(bits) => From::Memory(self.constant(bits)),
            Operand::LaneNumber => From::Memory(Place::vector_of_constants(LANE_NUMBERS)),
            Operand::Value(value) => {
                if self.vectors.find(value).is_none() && !self.is_worth_a_register(value) {
                    return From::Memory(self.place(value).expect("what is in no register is in memory"));
                }
                From::Register(self.register(value))
            }
        }
    }

    fn is_worth_a_register(&mut self, value: Value) -> bool {
        let Some(next) = self.uses.next(value, self.at) else { return false };
        let given = self.vectors.choose(&mut self.uses, self.at);
        match self.vectors.at(given) {
            None => true,
            Some(other) => self.uses.next(other, self.at).is_none_or(|other| other > next),
        }
    }

    fn is_in_register(&self, operand: Operand) -> bool {
        matches!(operand, Operand::Value(value) if self.vectors.find(value).is_some())
    }

    /// Whether the register of an operand is free after this instruction.
    fn gives_way(&mut self, operand: Operand) -> bool {
        match operand {
            Operand::Value(value) => self.is_in_register(operand) && !self.is_needed(value),
            _ => false,
        }
    }

    /// Keeps operands where they are until the instruction has read them.
    fn lock_operands(&mut self, instruction: &Instruction) {
        instruction.for_each_use(|value| {
            let class = self.class(value);
            if let Some(register) = self.bank(class).find(value) {
                self.bank(class).lock(register);
            }
        });
    }

    /// Takes values out of registers that nothing reads after this instruction.
    fn release(&mut self, instruction: &Instruction) {
        instruction.for_each_use(|value| {
            if !self.is_needed(value) {
                let class = self.class(value);
                self.bank(class).drop_value(value);
            }
        });
    }

    /// The register of what an instruction makes; its operands may be in it.
    fn result(&mut self, instruction: &Instruction) -> u8 {
        let value = instruction.result().expect("the instruction makes something");
        self.release(instruction);
        let class = self.class(value);
        self.bank(class).unlock_all();
        let register = self.free(class);
        self.bank(class).hold(register, value);
        register
    }

    fn end_of_instruction(&mut self) {
        self.vectors.unlock_all();
        self.masks.unlock_all();
        for value in self.ending.remove(&self.at).unwrap_or_default() {
            let class = self.class(value);
            // What nothing reads is never made.
            if self.uses.is_used(value) {
                self.bank(class).drop_value(value);
            }
            if let Some(slot) = self.slots.remove(&value) {
                self.free_slots.push(slot);
            }
        }
    }

    /// Sees to it that all that is needed is in memory.
    fn keep_all(&mut self) {
        for class in [Class::Vector, Class::Mask] {
            let held: Vec<(u8, Value)> = self.bank(class).values().collect();
            for (register, value) in held {
                if self.is_needed(value) {
                    self.keep(register, value);
                }
            }
        }
    }

    // --- instructions ---

    fn instruction(&mut self, instruction: &Instruction) {
        if instruction.result().is_some_and(|value| !self.uses.is_used(value)) {
            return self.release(instruction);
        }
        self.lock_operands(instruction);
        match *instruction {
            Instruction::Unary(op, _, a) => self.unary(instruction, op, a),
            Instruction::Binary(op, _, [a, b]) => self.binary(instruction, op, a, b),
            Instruction::MulAdd(signs, value, operands) => self.mul_add(instruction, signs, value, operands),
            Instruction::Less(_, [a, b]) => {
                let a = self.in_register(a);
                let b = self.source(b);
                let to = self.result(instruction);
                self.emitter.less(to, a, b);
            }
            Instruction::Select(_, mask, [yes, no]) => self.select(instruction, mask, yes, no),
            Instruction::MaskAnd(_, masks) => self.masks(instruction, Machine::VEX_Kandw_kr_kr_kr, masks),
            Instruction::MaskOr(_, masks) => self.masks(instruction, Machine::VEX_Korw_kr_kr_kr, masks),
            Instruction::MaskNot(_, a) => {
                let a = self.register(a);
                let to = self.result(instruction);
                self.emitter.mask_not(to, a);
            }
            Instruction::MaskConstant(_, truth) => {
                let to = self.result(instruction);
                let code = if truth { Machine::VEX_Kxnorw_kr_kr_kr } else { Machine::VEX_Kxorw_kr_kr_kr };
                self.emitter.masks(code, to, to, to);
            }
            Instruction::Copy(_, from) => self.copy(instruction, from),
            Instruction::Gather(_, source, index) => self.gather(instruction, source, index),
            Instruction::Store(entry, operand, only) => {
                let only = only.map(|only| self.register(only));
                let from = self.in_register(operand);
                self.emitter.store(Self::entry(entry), from, only);
                self.release(instruction);
            }
            Instruction::Put(cell, operand) => self.put(instruction, cell, operand),
            Instruction::TakeEntry(_, entry) => {
                let to = self.result(instruction);
                let place = self.chunk_entry(entry);
                self.emitter.load(to, place);
            }
            Instruction::PutEntry(entry, operand) => {
                let from = self.in_register(operand);
                let place = self.chunk_entry(entry);
                self.emitter.store(place, from, None);
                self.release(instruction);
            }
            Instruction::ChunkNumber(_, counter) => {
                let to = self.result(instruction);
                self.emitter.load(to, self.counter(counter).broadcast());
            }
            Instruction::BeginLoop { counter } => self.begin_loop(counter),
            Instruction::EndLoop { counter, limit, again } => self.end_loop(counter, limit, again),
            Instruction::BeginBranch { mask } => self.begin_branch(instruction, mask),
            Instruction::EndBranch => self.end_branch(),
            Instruction::Nothing => {}
        }
    }

    fn unary(&mut self, instruction: &Instruction, op: Unary, a: Operand) {
        let a = match op {
            // Constants are repeated every 32 bits only.
            Unary::ShiftLeftWide(_) | Unary::ShiftRightWide(_) => From::Register(self.in_register(a)),
            _ => self.source(a),
        };
        let to = self.result(instruction);
        const FLOOR: u32 = 9;
        const NEAREST: u32 = 8;
        let rounding = Machine::EVEX_Vrndscaleps_zmm_k1z_zmmm512b32_imm8_sae;
        match op {
            Unary::Sqrt => self.emitter.one(Machine::EVEX_Vsqrtps_zmm_k1z_zmmm512b32_er, to, a),
            Unary::RsqrtGuess => self.emitter.one(Machine::EVEX_Vrsqrt14ps_zmm_k1z_zmmm512b32, to, a),
            Unary::RecipGuess => self.emitter.one(Machine::EVEX_Vrcp14ps_zmm_k1z_zmmm512b32, to, a),
            Unary::Floor => self.emitter.one_by(rounding, to, a, FLOOR),
            Unary::Round => self.emitter.one_by(rounding, to, a, NEAREST),
            Unary::ToNumber => self.emitter.one(Machine::EVEX_Vcvtdq2ps_zmm_k1z_zmmm512b32_er, to, a),
            Unary::ToWord => self.emitter.one(Machine::EVEX_Vcvtps2dq_zmm_k1z_zmmm512b32_er, to, a),
            Unary::ShiftLeft(by) => self.emitter.one_by(Machine::EVEX_Vpslld_zmm_k1z_zmmm512b32_imm8, to, a, by),
            Unary::ShiftRight(by) => self.emitter.one_by(Machine::EVEX_Vpsrld_zmm_k1z_zmmm512b32_imm8, to, a, by),
            Unary::ShiftLeftWide(by) => self.emitter.one_by(Machine::EVEX_Vpsllq_zmm_k1z_zmmm512b64_imm8, to, a, by),
            Unary::ShiftRightWide(by) => self.emitter.one_by(Machine::EVEX_Vpsrlq_zmm_k1z_zmmm512b64_imm8, to, a, by),
        }
    }

    fn binary(&mut self, instruction: &Instruction, op: Binary, mut a: Operand, mut b: Operand) {
        if op.commutes() && self.is_in_register(b) && !self.is_in_register(a) {
            std::mem::swap(&mut a, &mut b);
        }
        let a = self.in_register(a);
        let b = if op == Binary::MulEven { From::Register(self.in_register(b)) } else { self.source(b) };
        let to = self.result(instruction);
        self.emitter.two(binary_code(op), to, a, b);
    }

    /// One operand is overwritten: one that nothing else reads, or a copy.
    fn mul_add(&mut self, instruction: &Instruction, signs: Signs, value: Value, operands: [Operand; 3]) {
        let [mut a, mut b, c] = operands;
        let is_overwritten = match [a, b, c].map(|operand| self.gives_way(operand)) {
            [_, _, true] => Overwritten::Addend,
            [true, ..] => Overwritten::Factor,
            [_, true, _] => {
                std::mem::swap(&mut a, &mut b);
                Overwritten::Factor
            }
            _ => match [a, b, c].map(|operand| self.is_in_register(operand)) {
                [_, _, false] | [true, true, _] => Overwritten::Addend,
                [false, ..] => Overwritten::Factor,
                [true, false, true] => {
                    std::mem::swap(&mut a, &mut b);
                    Overwritten::Factor
                }
            },
        };
        // The other two; the second one of them may come from memory.
        let (to, [mut x, mut y]) = match is_overwritten {
            Overwritten::Addend => (c, [a, b]),
            Overwritten::Factor => (a, [b, c]),
        };
        let swapped = !self.is_in_register(x) && (self.is_in_register(y) || !matches!(x, Operand::Value(_)));
        if swapped {
            std::mem::swap(&mut x, &mut y);
        }
        let reused = if self.gives_way(to) { Some(self.in_register(to)) } else { None };
        let x = self.in_register(x);
        let y = self.source(y);
        let form = match (is_overwritten, swapped) {
            (Overwritten::Addend, _) => Form::Sum,
            (Overwritten::Factor, false) => Form::ProductThenSum,
            (Overwritten::Factor, true) => Form::SumThenProduct,
        };
        let register = reused.unwrap_or_else(|| self.own_copy(to));
        self.emitter.two(fused_code(signs, form), register, x, y);
        self.release(instruction);
        self.vectors.hold(register, value);
    }

    /// A register with a copy of an operand, which may be overwritten.
    fn own_copy(&mut self, operand: Operand) -> u8 {
        let from = match operand {
            Operand::Value(value) => self.vectors.find(value),
            _ => None,
        };
        if let Some(from) = from {
            self.vectors.lock(from);
        }
        let register = self.free(Class::Vector);
        match from {
            Some(from) => self.emitter.copy(register, from),
            None => self.load_literal(register, operand),
        }
        register
    }

    fn select(&mut self, instruction: &Instruction, mask: Value, yes: Operand, no: Operand) {
        let only = self.register(mask);
        if no == Operand::Constant(0) {
            let from = self.source(yes);
            let to = self.result(instruction);
            return self.emitter.keep(to, only, from);
        }
        let no = self.in_register(no);
        let yes = self.source(yes);
        let to = self.result(instruction);
        self.emitter.blend(to, only, no, yes);
    }

    fn masks(&mut self, instruction: &Instruction, code: Machine, masks: [Value; 2]) {
        let [a, b] = masks.map(|mask| self.register(mask));
        let to = self.result(instruction);
        self.emitter.masks(code, to, a, b);
    }

    fn copy(&mut self, instruction: &Instruction, from: Value) {
        let class = self.class(from);
        let from = self.register(from);
        let to = self.result(instruction);
        if to != from {
            match class {
                Class::Vector => self.emitter.copy(to, from),
                Class::Mask => self.emitter.copy_mask(to, from),
            }
        }
    }

    fn gather(&mut self, instruction: &Instruction, source: Source, index: Value) {
        let index = self.register(index);
        let base = match source {
            Source::Buffer(binding) => Place::buffer(binding, 0),
            Source::Table => Place::vector_of_constants(self.table_at),
        };
        // The index must not be overwritten.
        let to = self.free(Class::Vector);
        self.emitter.gather(to, base, index, SPARE_MASK);
        self.release(instruction);
        self.vectors.hold(to, instruction.result().expect("a gather makes something"));
    }

    fn put(&mut self, instruction: &Instruction, cell: Cell, operand: Operand) {
        match operand {
            Operand::Value(value) if self.class(value) == Class::Mask => {
                let from = self.register(value);
                self.emitter.store_mask(Self::cell(cell), from);
            }
            _ => {
                let from = self.in_register(operand);
                self.emitter.store(Self::cell(cell), from, None);
            }
        }
        self.release(instruction);
    }

    fn chunk_entry(&mut self, entry: ChunkEntry) -> Place {
        let counter = self.counter(entry.counter);
        self.emitter.chunk_offset(counter, entry.width * WIDTH);
        Place::frame_with_offset((entry.first + entry.position) * WIDTH)
    }

    /// Empties registers: what is needed is in memory.
    fn leave_registers(&mut self) {
        self.keep_all();
        self.vectors.clear();
        self.masks.clear();
    }

    fn cut(&mut self) {
        self.leave_registers();
        self.emitter.end_piece();
        self.emitter.begin_piece();
    }

    fn begin_loop(&mut self, counter: u32) {
        self.leave_registers();
        let counter = self.counter(counter);
        self.emitter.set_counter(counter, 0);
        let is_cut = self.pieces.is_cut(self.at);
        if is_cut {
            self.emitter.end_piece();
        }
        self.loops.push((self.emitter.here(), is_cut));
        if is_cut {
            self.emitter.begin_piece();
        }
    }

    fn end_loop(&mut self, counter: u32, limit: u32, again: Option<Value>) {
        let (begin, is_cut) = self.loops.pop().expect("a loop began");
        let exit = again.map(|again| {
            let again = self.register(again);
            self.emitter.test(again);
            self.emitter.jump_if_none()
        });
        let counter = self.counter(counter);
        self.emitter.count_up(counter);
        if is_cut {
            self.leave_registers();
            self.emitter.end_piece();
        }
        self.emitter.jump_if_below(counter, limit, begin);
        if is_cut {
            self.emitter.begin_piece();
        }
        if let Some(exit) = exit {
            self.emitter.land(exit);
        }
    }

    fn begin_branch(&mut self, instruction: &Instruction, mask: Value) {
        let mask = self.register(mask);
        self.release(instruction);
        self.keep_all();
        self.emitter.test(mask);
        let jump = self.emitter.jump_if_none();
        self.branches.push((jump, self.vectors.clone(), self.masks.clone()));
    }

    fn end_branch(&mut self) {
        let (jump, vectors, masks) = self.branches.pop().expect("a branch began");
        self.emitter.land(jump);
        self.vectors.intersect(&vectors);
        self.masks.intersect(&masks);
    }
}

/// Operand of a fused product and sum in whose register the result comes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Overwritten {
    Factor,
    Addend,
}

/// Which of its three operands is what.
#[derive(Clone, Copy)]
enum Form {
    /// 231: the product of the second and third is added to the first.
    Sum,
    /// 213: the first times the second, and the third added.
    ProductThenSum,
    /// 132: the first times the third, and the second added.
    SumThenProduct,
}

fn fused_code(signs: Signs, form: Form) -> Machine {
    use Machine::*;
    match (form, signs.minus_product, signs.minus_addend) {
        (Form::Sum, false, false) => EVEX_Vfmadd231ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::Sum, false, true) => EVEX_Vfmsub231ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::Sum, true, false) => EVEX_Vfnmadd231ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::Sum, true, true) => EVEX_Vfnmsub231ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::ProductThenSum, false, false) => EVEX_Vfmadd213ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::ProductThenSum, false, true) => EVEX_Vfmsub213ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::ProductThenSum, true, false) => EVEX_Vfnmadd213ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::ProductThenSum, true, true) => EVEX_Vfnmsub213ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::SumThenProduct, false, false) => EVEX_Vfmadd132ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::SumThenProduct, false, true) => EVEX_Vfmsub132ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::SumThenProduct, true, false) => EVEX_Vfnmadd132ps_zmm_k1z_zmm_zmmm512b32_er,
        (Form::SumThenProduct, true, true) => EVEX_Vfnmsub132ps_zmm_k1z_zmm_zmmm512b32_er,
    }
}

fn binary_code(op: Binary) -> Machine {
    use Machine::*;
    match op {
        Binary::Add => EVEX_Vaddps_zmm_k1z_zmm_zmmm512b32_er,
        Binary::Sub => EVEX_Vsubps_zmm_k1z_zmm_zmmm512b32_er,
        Binary::Mul => EVEX_Vmulps_zmm_k1z_zmm_zmmm512b32_er,
        Binary::Min => EVEX_Vminps_zmm_k1z_zmm_zmmm512b32_sae,
        Binary::Max => EVEX_Vmaxps_zmm_k1z_zmm_zmmm512b32_sae,
        Binary::AddWords => EVEX_Vpaddd_zmm_k1z_zmm_zmmm512b32,
        Binary::MulWords => EVEX_Vpmulld_zmm_k1z_zmm_zmmm512b32,
        Binary::MinWords => EVEX_Vpminud_zmm_k1z_zmm_zmmm512b32,
        Binary::Xor => EVEX_Vpxord_zmm_k1z_zmm_zmmm512b32,
        Binary::And => EVEX_Vpandd_zmm_k1z_zmm_zmmm512b32,
        Binary::Or => EVEX_Vpord_zmm_k1z_zmm_zmmm512b32,
        Binary::MulEven => EVEX_Vpmuludq_zmm_k1z_zmm_zmmm512b64,
    }
}
