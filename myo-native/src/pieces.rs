//! Where a routine is cut into pieces.
//!
//! A body of many muscles takes more code than a processor's first cache holds, and to read it from the second takes longer than what
//! it does. So a routine runs for several blocks of environments, one piece of code after the other: each piece runs for all blocks
//! before the next one does, and stays in the cache meanwhile. Cuts are where all blocks come by equally often: outside of branches, and
//! within loops only if their count is fixed.

use crate::code::{Code, Instruction};
use std::collections::HashSet;

/// Cuts of a routine, by the number of the instruction before which they are.
#[derive(Debug, Default)]
pub struct Pieces {
    starts: HashSet<usize>,
    /// Loops with pieces of their own.
    loops: HashSet<usize>,
}

impl Pieces {
    /// Cuts code into pieces of at most so many instructions, where it can be cut.
    pub fn of(code: &Code, most: usize) -> Self {
        let mut this = Self::default();
        this.cut(&code.instructions, 0, most);
        this
    }

    /// Whether a piece begins with an instruction.
    pub fn begins_at(&self, at: usize) -> bool {
        self.starts.contains(&at)
    }

    /// Whether the loop that begins with an instruction has pieces of its own.
    pub fn is_cut(&self, begin: usize) -> bool {
        self.loops.contains(&begin)
    }

    /// Cuts instructions of which the first one is number `first`.
    fn cut(&mut self, instructions: &[Instruction], first: usize, most: usize) {
        let (mut at, mut length) = (0, 0);
        while at < instructions.len() {
            let end = end_of(instructions, at);
            let longer = length + end - at;
            if end - at > most && has_fixed_count(&instructions[end - 1]) {
                self.loops.insert(first + at);
                self.cut(&instructions[at + 1..end - 1], first + at + 1, most);
                length = 0;
            } else if longer > most && length > 0 {
                self.starts.insert(first + at);
                length = end - at;
            } else {
                length = longer;
            }
            at = end;
        }
    }
}

/// Where what begins at a position is over: after one instruction, or after the end of the loop or branch.
fn end_of(instructions: &[Instruction], at: usize) -> usize {
    let mut open = 0;
    for (k, instruction) in instructions.iter().enumerate().skip(at) {
        match instruction {
            Instruction::BeginLoop { .. } | Instruction::BeginBranch { .. } => open += 1,
            Instruction::EndLoop { .. } | Instruction::EndBranch => open -= 1,
            _ => {}
        }
        if open == 0 {
            return k + 1;
        }
    }
    instructions.len()
}

fn has_fixed_count(end: &Instruction) -> bool {
    matches!(end, Instruction::EndLoop { again: None, .. })
}
