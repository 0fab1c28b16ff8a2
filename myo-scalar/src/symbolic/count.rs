//! How many operations each stage takes.

use super::program::Program;

/// Operations of one stage, those of the stages in it not counted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StageCount {
    /// Names from the outermost stage to this one.
    pub path: Vec<&'static str>,
    /// Operations; what several stages share counts where it came up first.
    pub operations: usize,
}

impl Program {
    /// Counts per stage, in the order in which stages were first entered.
    pub fn stage_counts(&self) -> Vec<StageCount> {
        let mut operations = vec![0; self.stages.len()];
        for id in self.live_nodes() {
            let node = &self.nodes[id as usize];
            operations[node.stage as usize] += usize::from(node.op.is_work());
        }
        let count = |(stage, operations)| StageCount { path: self.path(stage), operations };
        operations.into_iter().enumerate().map(count).collect()
    }

    fn path(&self, stage: usize) -> Vec<&'static str> {
        let each = &self.stages[stage];
        if stage == 0 {
            return vec![each.name];
        }
        let mut path = self.path(each.parent as usize);
        path.push(each.name);
        path
    }
}
