//! A finished program: what of the graph is needed.

use super::graph::{Buffer, Graph, Id, Node, Op, Sharing, StageName};
use super::region::{Carry, Chunks, Region, Statement};

/// What a trace computed and stored, without what no store needs.
#[derive(Clone, Debug)]
pub struct Program {
    /// All nodes; only those that [`Program::is_live`] matter. Node 0 is a constant.
    pub nodes: Vec<Node>,
    /// All statements.
    pub statements: Vec<Statement>,
    pub(super) regions: Vec<Region>,
    pub(super) stages: Vec<StageName>,
    /// Nodes that there were when a statement began.
    pub(super) begun: Vec<Id>,
    /// Constants that loops look up.
    pub table: Vec<f64>,
    live: Vec<bool>,
    live_statements: Vec<bool>,
    live_vars: Vec<Vec<bool>>,
}

/// The entries of a buffer that a program touches: all of a row below these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Entries {
    /// Rows of one entry per environment.
    pub per_env: u32,
    /// Entries that are the same for all environments.
    pub shared: u32,
}

impl Entries {
    /// Entries that the buffer must have for so many environments.
    pub fn needed(self, num_envs: u32) -> u64 {
        u64::from(self.shared).max(u64::from(self.per_env) * u64::from(num_envs))
    }

    fn with(self, buffer: Buffer, row: u32) -> Self {
        match buffer.sharing {
            Sharing::PerEnv => Self { per_env: self.per_env.max(row + 1), ..self },
            Sharing::Shared => Self { shared: self.shared.max(row + 1), ..self },
        }
    }
}

impl Program {
    pub(super) fn new(graph: Graph) -> Self {
        let Graph { nodes, regions, statements, stages, begun, table, .. } = graph;
        let nvar = |statement: &Statement| match statement {
            Statement::Loop(x) => x.vars.len(),
            Statement::Branch(x) => x.vars.len(),
            // Entries of a chunk that are wanted afterwards.
            Statement::Chunks(x) => x.start.len(),
            Statement::Store(_) => 0,
        };
        let mut program = Self {
            live: vec![false; nodes.len()],
            live_statements: vec![false; statements.len()],
            live_vars: statements.iter().map(|s| vec![false; nvar(s)]).collect(),
            nodes,
            statements,
            regions,
            stages,
            begun,
            table,
        };
        program.resolve_constant_vars();
        program.mark();
        program.sink_inputs();
        program
    }

    /// Whether some store needs a node.
    pub fn is_live(&self, id: Id) -> bool {
        self.live[id as usize]
    }

    /// Whether some store needs variable `index` of a statement.
    pub fn is_live_var(&self, statement: u32, index: usize) -> bool {
        self.live_vars[statement as usize][index]
    }

    /// Live statements of a region, in order.
    pub fn statements_of(&self, region: u32) -> impl Iterator<Item = u32> + '_ {
        let all = self.regions[region as usize].statements.iter().copied();
        all.filter(|&s| self.live_statements[s as usize])
    }

    /// Live nodes.
    pub fn live_nodes(&self) -> impl Iterator<Item = Id> + '_ {
        (0..self.nodes.len() as Id).filter(|&id| self.is_live(id))
    }

    /// What the program reads and writes of the buffer with this number: what must be there before it may run unchecked.
    pub fn entries(&self, binding: u32) -> Entries {
        let read = self.live_nodes().filter_map(|id| match self.nodes[id as usize].op {
            Op::Input(buffer, row) => Some((buffer, row)),
            Op::Gather(buffer, rows) => Some((buffer, rows.at(u32::MAX))),
            _ => None,
        });
        let written = self.statements.iter().filter_map(|statement| match statement {
            Statement::Store(store) => Some((store.buffer, store.row)),
            _ => None,
        });
        let touched = read.chain(written).filter(|(buffer, _)| buffer.binding == binding);
        touched.fold(Entries::default(), |entries, (buffer, row)| entries.with(buffer, row))
    }

    /// Operations that are computed, see [`Op::is_work`]; loops count once.
    pub fn operations(&self) -> usize {
        self.live_nodes().filter(|&id| self.nodes[id as usize].op.is_work()).count()
    }

    /// Variables that a loop leaves as they are become what they were before it.
    fn resolve_constant_vars(&mut self) {
        let mut same: Vec<Id> = (0..self.nodes.len() as Id).collect();
        for statement in &self.statements {
            let Statement::Loop(each) = statement else { continue };
            for carry in each.vars.iter().filter(|carry| carry.is_constant()) {
                // Statements are in order of their beginning, so the outer loop's variable is resolved already.
                same[carry.start as usize] = same[carry.init as usize];
            }
        }
        let of = |id: &mut Id| *id = same[*id as usize];
        for node in &mut self.nodes {
            let arity = node.op.arity();
            node.args[..arity].iter_mut().for_each(of);
        }
        for statement in &mut self.statements {
            statement.operands_mut(of);
        }
    }

    /// Marks everything that stores need.
    fn mark(&mut self) {
        let mut todo = Vec::new();
        let mut enclosing = vec![None; self.regions.len()];
        for (number, statement) in self.statements.iter().enumerate() {
            if let Some(body) = statement.body() {
                enclosing[body as usize] = Some(number as u32);
            }
        }
        let home = self.homes();
        for number in 0..self.statements.len() as u32 {
            if let Statement::Store(store) = &self.statements[number as usize] {
                todo.push(store.value);
                self.need(number, &home, &enclosing, &mut todo);
            }
        }
        while let Some(id) = todo.pop() {
            if std::mem::replace(&mut self.live[id as usize], true) {
                continue;
            }
            let node = self.nodes[id as usize];
            todo.extend(node.operands());
            if let Op::Carried(statement, index) | Op::Outcome(statement, index) = node.op {
                self.need(statement, &home, &enclosing, &mut todo);
                if let Statement::Chunks(x) = &self.statements[statement as usize] {
                    // What one chunk needs of its entries, all do. The body begins with its number and then the entries.
                    match (node.op, index.checked_sub(1)) {
                        (Op::Outcome(..), _) => {
                            let entry = index as usize % x.start.len();
                            self.live_vars[statement as usize][entry] = true;
                            todo.push(x.next[entry]);
                        }
                        (_, Some(entry)) => todo.extend(x.init_of(entry as usize)),
                        (_, None) => {}
                    }
                }
                if let Some(carry) = self.carry(statement, index) {
                    let carry = *carry;
                    self.live_vars[statement as usize][index as usize] = true;
                    todo.extend([carry.init, carry.next]);
                }
            }
        }
    }

    /// Region that each statement is in.
    pub(super) fn homes(&self) -> Vec<u32> {
        let mut home = vec![0; self.statements.len()];
        for (region, each) in self.regions.iter().enumerate() {
            for &statement in &each.statements {
                home[statement as usize] = region as u32;
            }
        }
        home
    }

    /// Marks a statement and those around it, and what decides whether they run.
    fn need(&mut self, statement: u32, home: &[u32], enclosing: &[Option<u32>], todo: &mut Vec<Id>) {
        let mut next = Some(statement);
        while let Some(number) = next {
            if std::mem::replace(&mut self.live_statements[number as usize], true) {
                return;
            }
            match &self.statements[number as usize] {
                Statement::Loop(x) => todo.extend(x.again),
                Statement::Branch(x) => todo.push(x.mask),
                Statement::Chunks(_) | Statement::Store(_) => {}
            }
            next = enclosing[home[number as usize] as usize];
        }
    }

    /// Whether the body of a loop over chunks reads an entry as it was before.
    pub fn reads_entry(&self, each: &Chunks, entry: usize) -> bool {
        self.is_live(each.start[entry])
    }

    /// Whether a loop over chunks changes an entry that something needs afterwards.
    pub fn writes_entry(&self, statement: u32, each: &Chunks, entry: usize) -> bool {
        self.is_live_var(statement, entry) && each.next[entry] != each.start[entry]
    }

    fn carry(&self, statement: u32, index: u32) -> Option<&Carry> {
        match &self.statements[statement as usize] {
            Statement::Loop(x) => x.vars.get(index as usize),
            Statement::Branch(x) => x.vars.get(index as usize),
            Statement::Chunks(_) | Statement::Store(_) => None,
        }
    }

    /// Live variables of a statement, with their numbers.
    pub fn live_carries(&self, statement: u32) -> impl Iterator<Item = (usize, &Carry)> + '_ {
        let vars: &[Carry] = match &self.statements[statement as usize] {
            Statement::Loop(x) => &x.vars,
            Statement::Branch(x) => &x.vars,
            Statement::Chunks(_) | Statement::Store(_) => &[],
        };
        vars.iter().enumerate().filter(move |(index, _)| self.is_live_var(statement, *index))
    }
}

impl Statement {
    /// The region inside.
    pub fn body(&self) -> Option<u32> {
        match self {
            Self::Loop(x) => Some(x.body),
            Self::Branch(x) => Some(x.body),
            Self::Chunks(x) => Some(x.body),
            Self::Store(_) => None,
        }
    }

    /// Every node that the statement names, except those that its body begins with.
    fn operands_mut(&mut self, mut of: impl FnMut(&mut Id)) {
        match self {
            Self::Loop(x) => {
                x.again.iter_mut().for_each(&mut of);
                x.vars.iter_mut().flat_map(|carry| [&mut carry.init, &mut carry.next]).for_each(of);
            }
            Self::Branch(x) => {
                of(&mut x.mask);
                x.vars.iter_mut().flat_map(|carry| [&mut carry.init, &mut carry.next]).for_each(of);
            }
            Self::Chunks(x) => x.init.iter_mut().chain(&mut x.next).for_each(of),
            Self::Store(x) => of(&mut x.value),
        }
    }
}
