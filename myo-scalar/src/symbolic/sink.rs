//! Reads that only a branch needs are made in the branch: who does not take it need not wait for them.

use super::graph::{Id, Op};
use super::needs::OUTERMOST;
use super::program::Program;
use super::region::Statement;

impl Program {
    /// Moves inputs into the branches that alone need them: into the innermost one that is in no loop, where nothing outside it writes
    /// the buffer.
    pub(super) fn sink_inputs(&mut self) {
        let parents = self.parents();
        let needed = self.needed_in(&parents);
        for id in 0..self.nodes.len() as Id {
            let (Op::Input(buffer, _), Some(region)) = (self.nodes[id as usize].op, needed[id as usize]) else {
                continue;
            };
            let region = self.out_of_loops(region, &parents);
            let elsewhere = self.written_in(buffer.binding).any(|write| common(write, region, &parents) != region);
            if !elsewhere {
                self.nodes[id as usize].region = region;
            }
        }
    }

    /// The innermost region in which all that needs a node is; none where nothing does.
    fn needed_in(&self, parents: &[u32]) -> Vec<Option<u32>> {
        let mut needed: Vec<Option<u32>> = vec![None; self.nodes.len()];
        self.for_each_need(|id, region| {
            let all = &mut needed[id as usize];
            *all = Some(all.map_or(region, |others| common(others, region, parents)));
        });
        needed
    }

    /// The region, or the one around the outermost loop that it is in.
    fn out_of_loops(&self, region: u32, parents: &[u32]) -> u32 {
        let (mut out, mut at) = (region, region);
        while at != OUTERMOST {
            let around = parents[at as usize];
            if self.regions[at as usize].is_loop {
                out = around;
            }
            at = around;
        }
        out
    }

    /// Regions that write a buffer.
    fn written_in(&self, binding: u32) -> impl Iterator<Item = u32> + '_ {
        let writes = move |&statement: &u32| match &self.statements[statement as usize] {
            Statement::Store(store) => store.buffer.binding == binding,
            _ => false,
        };
        (0..self.regions.len() as u32).filter(move |&region| self.statements_of(region).any(|s| writes(&s)))
    }
}

/// The innermost region that both are in. Regions inside are opened later.
fn common(mut a: u32, mut b: u32, parents: &[u32]) -> u32 {
    while a != b {
        let inner = if a > b { &mut a } else { &mut b };
        *inner = parents[*inner as usize];
    }
    a
}
