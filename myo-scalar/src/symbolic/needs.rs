//! Who needs a node, and where.

use super::graph::Id;
use super::program::Program;

/// The outermost region.
pub(super) const OUTERMOST: u32 = 0;

impl Program {
    /// The region around each; the outermost one, number 0, is around itself.
    pub fn parents(&self) -> Vec<u32> {
        let mut parents = vec![OUTERMOST; self.regions.len()];
        for (statement, home) in self.statements.iter().zip(self.homes()) {
            if let Some(body) = statement.body() {
                parents[body as usize] = home;
            }
        }
        parents
    }

    /// Calls `need` with each node that a live node or statement reads, once for each time, and the region in which it is read.
    pub fn for_each_need(&self, mut need: impl FnMut(Id, u32)) {
        for id in self.live_nodes() {
            let node = &self.nodes[id as usize];
            node.operands().iter().for_each(|&operand| need(operand, node.region));
        }
        for region in 0..self.regions.len() as u32 {
            for statement in self.statements_of(region) {
                self.beginnings(statement).into_iter().for_each(|id| need(id, region));
                if let Some(body) = self.statements[statement as usize].body() {
                    self.results(body, statement).into_iter().for_each(|id| need(id, body));
                }
            }
        }
    }
}
