//! Where values are read.

use crate::code::{Code, Instruction, Value};

/// Positions of the instructions that read each value, in order.
pub struct Uses {
    starts: Vec<u32>,
    positions: Vec<u32>,
    /// How many of a value's uses are past.
    past: Vec<u32>,
}

impl Uses {
    pub fn of(code: &Code) -> Self {
        let mut starts = vec![0; code.classes.len() + 1];
        for_each(code, |_, value| starts[value as usize + 1] += 1);
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        let mut next = starts.clone();
        let mut positions = vec![0; starts[code.classes.len()] as usize];
        for_each(code, |at, value| {
            positions[next[value as usize] as usize] = at as u32;
            next[value as usize] += 1;
        });
        Self { starts, positions, past: vec![0; code.classes.len()] }
    }

    /// Where a value is read next, after the instruction at `at`. Instructions are asked about in order.
    pub fn next(&mut self, value: Value, at: usize) -> Option<usize> {
        let k = value as usize;
        let all = &self.positions[self.starts[k] as usize..self.starts[k + 1] as usize];
        let past = &mut self.past[k];
        while all.get(*past as usize).is_some_and(|&position| position as usize <= at) {
            *past += 1;
        }
        all.get(*past as usize).map(|&position| position as usize)
    }

    /// Whether anything reads a value.
    pub fn is_used(&self, value: Value) -> bool {
        self.starts[value as usize] < self.starts[value as usize + 1]
    }
}

fn for_each(code: &Code, mut of: impl FnMut(usize, Value)) {
    for (at, instruction) in code.instructions.iter().enumerate() {
        instruction.for_each_use(|value| of(at, value));
    }
}

/// Where each value is read for the last time: at the end of a loop, if the loop reads it and did not make it. Zero of those that
/// nothing reads.
pub fn last_uses(code: &Code) -> Vec<usize> {
    let ends = ends_of_loops(code);
    let (mut made, mut last) = (vec![0; code.classes.len()], vec![0; code.classes.len()]);
    let mut open: Vec<usize> = vec![];
    for (at, instruction) in code.instructions.iter().enumerate() {
        instruction.for_each_use(|value| {
            let around = open.iter().find(|&&begin| begin > made[value as usize]);
            let until = around.map_or(at, |&begin| ends[begin]);
            last[value as usize] = until.max(last[value as usize]);
        });
        if let Some(value) = instruction.result() {
            made[value as usize] = at;
        }
        match instruction {
            Instruction::BeginLoop { .. } => open.push(at),
            Instruction::EndLoop { .. } => drop(open.pop()),
            _ => {}
        }
    }
    last
}

/// Where the loop ends that begins at a position.
fn ends_of_loops(code: &Code) -> Vec<usize> {
    let (mut ends, mut open) = (vec![0; code.instructions.len()], vec![]);
    for (at, instruction) in code.instructions.iter().enumerate() {
        match instruction {
            Instruction::BeginLoop { .. } => open.push(at),
            Instruction::EndLoop { .. } => ends[open.pop().expect("a loop began")] = at,
            _ => {}
        }
    }
    ends
}
