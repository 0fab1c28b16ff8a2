//! In which order to compute.
//!
//! The order in which the generic code computes is kept, since it was written so that a number is used soon after it is
//! made; inputs and numbers that do not change in a loop come where they are first needed. (An order that keeps the
//! fewest numbers waiting, after Sethi and Ullman, ran slower on graphics cards, whose drivers order anew anyway; see
//! `docs/performance.md`.)

use super::graph::{Id, Op};
use super::program::Program;
use super::region::Statement;

/// One thing to do in a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Item {
    /// Compute a node.
    Node(Id),
    /// Run a statement; its body's items are those of its region.
    Statement(u32),
}

impl Program {
    /// What to do in each region, in order; constants are left out.
    pub fn order(&self) -> Vec<Vec<Item>> {
        (0..self.regions.len() as u32).map(|region| Scheduler::new(self, region).run()).collect()
    }

    /// Nodes outside a statement's bodies that it or they name.
    fn outside(&self, statement: u32) -> Vec<Id> {
        let mut regions = Vec::new();
        let mut named = Vec::new();
        self.collect(statement, &mut regions, &mut named);
        named.retain(|&id| !regions.contains(&self.nodes[id as usize].region));
        named
    }

    fn collect(&self, statement: u32, regions: &mut Vec<u32>, named: &mut Vec<Id>) {
        named.extend(self.beginnings(statement));
        let Some(body) = self.statements[statement as usize].body() else { return };
        regions.push(body);
        named.extend(self.results(body, statement));
        let inside = self.live_nodes().filter(|&id| self.nodes[id as usize].region == body);
        for id in inside {
            named.extend(self.nodes[id as usize].operands());
        }
        for inner in self.statements_of(body) {
            self.collect(inner, regions, named);
        }
    }

    /// What a statement names before its body.
    pub(super) fn beginnings(&self, statement: u32) -> Vec<Id> {
        let mut named: Vec<Id> = self.live_carries(statement).map(|(_, carry)| carry.init).collect();
        match &self.statements[statement as usize] {
            Statement::Loop(_) => {}
            Statement::Branch(x) => named.push(x.mask),
            Statement::Chunks(x) => {
                let read = (0..x.start.len()).filter(|&entry| self.reads_entry(x, entry));
                named.extend(read.flat_map(|entry| x.init_of(entry)));
            }
            Statement::Store(x) => named.push(x.value),
        }
        named
    }

    /// What the end of a body names.
    pub(super) fn results(&self, body: u32, statement: u32) -> Vec<Id> {
        debug_assert_eq!(self.statements[statement as usize].body(), Some(body));
        match &self.statements[statement as usize] {
            Statement::Loop(x) => self.live_carries(statement).map(|(_, carry)| carry.next).chain(x.again).collect(),
            Statement::Branch(_) => self.live_carries(statement).map(|(_, carry)| carry.next).collect(),
            Statement::Chunks(x) => {
                let written = (0..x.next.len()).filter(|&entry| self.writes_entry(statement, x, entry));
                written.map(|entry| x.next[entry]).collect()
            }
            Statement::Store(_) => vec![],
        }
    }

    /// Buffers that a statement writes.
    fn written(&self, statement: u32, buffers: &mut Vec<u32>) {
        match &self.statements[statement as usize] {
            Statement::Store(store) => buffers.push(store.buffer.binding),
            other => {
                for inner in other.body().into_iter().flat_map(|body| self.statements_of(body)) {
                    self.written(inner, buffers);
                }
            }
        }
    }
}

struct Scheduler<'a> {
    program: &'a Program,
    region: u32,
    done: Vec<bool>,
    items: Vec<Item>,
}

impl<'a> Scheduler<'a> {
    fn new(program: &'a Program, region: u32) -> Self {
        Self { program, region, done: vec![false; program.nodes.len()], items: vec![] }
    }

    fn run(mut self) -> Vec<Item> {
        let program = self.program;
        let here = |id: &Id| program.nodes[*id as usize].region == self.region;
        let work: Vec<Id> =
            program.live_nodes().filter(here).filter(|&id| program.nodes[id as usize].op.arity() > 0).collect();
        let mut work = work.into_iter().peekable();
        for statement in program.statements_of(self.region) {
            let begun = program.begun[statement as usize];
            while let Some(id) = work.next_if(|&id| id < begun) {
                self.compute(id);
            }
            self.read_before_writing(statement);
            for id in program.outside(statement) {
                self.compute(id);
            }
            self.items.push(Item::Statement(statement));
        }
        for id in work {
            self.compute(id);
        }
        let owner =
            (0..program.statements.len() as u32).find(|&s| program.statements[s as usize].body() == Some(self.region));
        for id in owner.map(|owner| program.results(self.region, owner)).unwrap_or_default() {
            self.compute(id);
        }
        self.items
    }

    /// Reads of a buffer see what was there before the program, so they come before the first write.
    fn read_before_writing(&mut self, statement: u32) {
        let program = self.program;
        let mut written = vec![];
        program.written(statement, &mut written);
        for id in program.live_nodes() {
            if let Op::Input(buffer, _) | Op::Gather(buffer, _) = program.nodes[id as usize].op
                && written.contains(&buffer.binding)
            {
                self.compute(id);
            }
        }
    }

    /// A node of this region, after its operands.
    fn compute(&mut self, id: Id) {
        let node = &self.program.nodes[id as usize];
        if node.region != self.region || node.op.is_constant() || std::mem::replace(&mut self.done[id as usize], true) {
            return;
        }
        for &arg in node.operands() {
            self.compute(arg);
        }
        self.items.push(Item::Node(id));
    }
}
