//! In which order to compute.
//!
//! Generic code computes one thing after the other, each a chain whose next link waits for the last. A processor looks ahead, but only
//! as far as it has room for what waits. So instructions change places within a window: of those that need not wait, first what the
//! longest chain hangs on, as long as there are registers for what is begun; then what sets some free (list scheduling; Gibbons and
//! Muchnick 1986, <https://doi.org/10.1145/12276.13312>). Registers that run out cost a load, which is less than to wait.

use crate::code::{Class, Code, Instruction, Unary as Op, Value};
use std::collections::BTreeSet;

/// How far an instruction may come forward.
const WINDOW: usize = 400;
/// Values that are begun before registers run out, some being left for what is only read.
const REGISTERS: usize = 24;
/// Instructions that begin in one cycle.
const AT_ONCE: u32 = 2;

/// Reorders what is between branches, loops and writes.
pub fn schedule(code: &mut Code) {
    let mut scheduler = Scheduler::new(code);
    let mut stretch = vec![];
    for instruction in &code.instructions {
        match instruction {
            Instruction::Nothing => {}
            pinned if is_pinned(pinned) => {
                scheduler.reorder(&mut stretch);
                scheduler.ordered.push(*pinned);
            }
            &free => stretch.push(free),
        }
    }
    scheduler.reorder(&mut stretch);
    code.instructions = scheduler.ordered;
}

/// Whether an instruction stays where it is: it writes memory that others read, reads what others write, or decides what runs.
fn is_pinned(instruction: &Instruction) -> bool {
    use Instruction::*;
    matches!(
        instruction,
        Store(..)
            | Put(..)
            | TakeEntry(..)
            | PutEntry(..)
            | Copy(..)
            | BeginLoop { .. }
            | EndLoop { .. }
            | BeginBranch { .. }
            | EndBranch
    )
}

/// Cycles from the beginning of an instruction to its result, about as recent processors take.
fn latency(instruction: &Instruction) -> u32 {
    use Instruction::*;
    match instruction {
        Unary(Op::Sqrt, ..) => 20,
        Unary(Op::RsqrtGuess | Op::RecipGuess, ..) => 7,
        Unary(Op::Floor | Op::Round, ..) => 8,
        Gather(..) => 26,
        MaskAnd(..) | MaskOr(..) | MaskNot(..) | MaskConstant(..) => 1,
        _ => 4,
    }
}

/// An instruction of a stretch.
#[derive(Clone, Debug, Default)]
struct Node {
    /// What reads its result.
    readers: Vec<usize>,
    /// How many of its operands are still to be computed.
    waits: usize,
    /// Cycles from its beginning to the end of the longest chain that hangs on it.
    height: u32,
    /// When its operands are there.
    earliest: u32,
}

struct Scheduler {
    is_vector: Vec<bool>,
    /// Which instruction of the stretch makes each value.
    maker: Vec<Option<usize>>,
    /// How often what is left of the stretch reads each value.
    reads: Vec<u32>,
    ordered: Vec<Instruction>,
}

impl Scheduler {
    fn new(code: &Code) -> Self {
        let count = code.classes.len();
        Self {
            is_vector: code.classes.iter().map(|&class| class == Class::Vector).collect(),
            maker: vec![None; count],
            reads: vec![0; count],
            ordered: Vec::with_capacity(code.instructions.len()),
        }
    }

    /// Appends a stretch in its new order, and empties it.
    fn reorder(&mut self, stretch: &mut Vec<Instruction>) {
        let mut nodes = self.nodes(stretch);
        let mut queue = Queue::new(&nodes);
        // Registers that hold something, the cycle, and instructions that began in it.
        let (mut held, mut time, mut begun) = (0, 0, 0);
        while let Some(chosen) = queue.choose(&nodes, time, held >= REGISTERS as i32, |at| self.change(&stretch[at])) {
            let instruction = stretch[chosen];
            if nodes[chosen].earliest > time {
                (time, begun) = (nodes[chosen].earliest, 0);
            }
            held += self.change(&instruction);
            instruction.for_each_use(|value| self.reads[value as usize] -= 1);
            let end = time + latency(&instruction);
            for reader in std::mem::take(&mut nodes[chosen].readers) {
                let node = &mut nodes[reader];
                node.earliest = node.earliest.max(end);
                node.waits -= 1;
                if node.waits == 0 {
                    queue.add(reader);
                }
            }
            self.ordered.push(instruction);
            begun += 1;
            if begun == AT_ONCE {
                (time, begun) = (time + 1, 0);
            }
        }
        for value in stretch.drain(..).filter_map(|instruction| instruction.result()) {
            self.maker[value as usize] = None;
        }
    }

    fn nodes(&mut self, stretch: &[Instruction]) -> Vec<Node> {
        let mut nodes = vec![Node::default(); stretch.len()];
        for (at, instruction) in stretch.iter().enumerate() {
            instruction.for_each_use(|value| {
                self.reads[value as usize] += 1;
                if let Some(maker) = self.maker[value as usize]
                    && nodes[maker].readers.last() != Some(&at)
                {
                    nodes[maker].readers.push(at);
                    nodes[at].waits += 1;
                }
            });
            if let Some(value) = instruction.result() {
                self.maker[value as usize] = Some(at);
            }
        }
        for (at, instruction) in stretch.iter().enumerate().rev() {
            let after = nodes[at].readers.iter().map(|&reader| nodes[reader].height).max();
            nodes[at].height = after.unwrap_or(0) + latency(instruction);
        }
        nodes
    }

    /// By how many more registers hold something after an instruction.
    fn change(&self, instruction: &Instruction) -> i32 {
        let is_held = |value: Value| self.is_vector[value as usize] && self.maker[value as usize].is_some();
        let mut change = i32::from(instruction.result().is_some_and(is_held));
        let mut seen = [(Value::MAX, 0); 4];
        instruction.for_each_use(|value| {
            let place = seen.iter_mut().find(|(other, _)| *other == value || *other == Value::MAX);
            let (other, times) = place.expect("an instruction reads four values at most");
            (*other, *times) = (value, *times + 1);
            change -= i32::from(is_held(value) && self.reads[value as usize] == *times);
        });
        change
    }
}

/// Instructions whose operands are there, or will be.
struct Queue {
    /// Within the window.
    near: Vec<usize>,
    /// Beyond it.
    far: BTreeSet<usize>,
    is_done: Vec<bool>,
    /// The first one that is not done.
    first: usize,
}

impl Queue {
    fn new(nodes: &[Node]) -> Self {
        let far = (0..nodes.len()).filter(|&at| nodes[at].waits == 0).collect();
        Self { near: vec![], far, is_done: vec![false; nodes.len()], first: 0 }
    }

    fn add(&mut self, at: usize) {
        self.far.insert(at);
    }

    /// Takes out what is to come next, of what waits least: what the longest chain hangs on, or, where registers are short, what sets some
    /// free.
    fn choose(&mut self, nodes: &[Node], time: u32, is_full: bool, change: impl Fn(usize) -> i32) -> Option<usize> {
        while self.is_done.get(self.first) == Some(&true) {
            self.first += 1;
        }
        let beyond = self.far.split_off(&(self.first + WINDOW));
        self.near.extend(std::mem::replace(&mut self.far, beyond));
        let is_there = |at: usize| nodes[at].earliest.max(time);
        let (place, &chosen) = if is_full {
            self.near.iter().enumerate().min_by_key(|&(_, &at)| (is_there(at), change(at), at))?
        } else {
            self.near.iter().enumerate().min_by_key(|&(_, &at)| (is_there(at), u32::MAX - nodes[at].height, at))?
        };
        self.near.swap_remove(place);
        self.is_done[chosen] = true;
        Some(chosen)
    }
}
