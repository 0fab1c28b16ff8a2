//! Variables that lie where an earlier statement left their first value.
//!
//! Contact after contact may add to a matrix, each within a branch. With places of its own for every branch, all entries would be
//! copied from one branch's to the next, taken or not, which costs more than what the branches do. So a variable takes over the place
//! of what it begins with where nobody else wants that any more.

use myo_scalar::symbolic::{Id, Op, Program, Statement};
use std::collections::HashMap;

/// A variable: number of its statement, and its number there.
pub type Variable = (u32, usize);

/// Each variable that takes over the place of another, and which.
pub fn heirs(program: &Program) -> HashMap<Variable, Variable> {
    let tree = Tree::of(program);
    let mut claims: HashMap<Id, Claim> = HashMap::new();
    for claim in tree.statements().flat_map(|number| tree.claims(number)) {
        claims.insert(claim.what, claim);
    }
    // Of those who want a value, its heir does so once, as it begins.
    let mut others: HashMap<Id, usize> = claims.keys().map(|&id| (id, 0)).collect();
    tree.for_each_use(|id, region| {
        if claims.get(&id).is_some_and(|claim| !claim.shelter.is_some_and(|body| tree.is_within(region, body))) {
            *others.get_mut(&id).expect("all claims were put there") += 1;
        }
    });
    let undisputed = claims.into_values().filter(|claim| others[&claim.what] == 1);
    undisputed.map(|claim| (claim.heir, claim.from)).collect()
}

/// A variable that begins as what another was at its end.
struct Claim {
    what: Id,
    heir: Variable,
    from: Variable,
    /// A region that may read it, too: the body of a branch writes its variables when all is read. That of a loop runs again.
    shelter: Option<u32>,
}

/// Which statement is where.
struct Tree<'a> {
    program: &'a Program,
    /// Region that each live statement is in.
    home: HashMap<u32, u32>,
    /// Statement that a region is the body of.
    owner: HashMap<u32, u32>,
}

impl<'a> Tree<'a> {
    fn of(program: &'a Program) -> Self {
        let mut tree = Self { program, home: HashMap::new(), owner: HashMap::new() };
        let mut regions = vec![0];
        while let Some(region) = regions.pop() {
            for number in program.statements_of(region) {
                tree.home.insert(number, region);
                if let Some(body) = program.statements[number as usize].body() {
                    tree.owner.insert(body, number);
                    regions.push(body);
                }
            }
        }
        tree
    }

    fn statements(&self) -> impl Iterator<Item = u32> + '_ {
        self.home.keys().copied()
    }

    fn is_within(&self, mut region: u32, body: u32) -> bool {
        while region != body {
            match self.owner.get(&region) {
                Some(owner) => region = self.home[owner],
                None => return false,
            }
        }
        true
    }

    /// The variables of a statement that begin as another's end, in the same region: a loop around only one of both would run again.
    fn claims(&self, number: u32) -> impl Iterator<Item = Claim> + '_ {
        let shelter = match &self.program.statements[number as usize] {
            Statement::Branch(x) => Some(x.body),
            _ => None,
        };
        self.program.live_carries(number).filter_map(move |(index, carry)| {
            let node = self.program.nodes[carry.init as usize];
            let Op::Outcome(statement, other) = node.op else { return None };
            let has_cell =
                matches!(self.program.statements[statement as usize], Statement::Branch(_) | Statement::Loop(_));
            (has_cell && node.region == self.home[&number]).then_some(Claim {
                what: carry.init,
                heir: (number, index),
                from: (statement, other as usize),
                shelter,
            })
        })
    }

    /// Calls `of` with every node that a node or statement reads, and the region that reads it.
    fn for_each_use(&self, mut of: impl FnMut(Id, u32)) {
        for id in self.program.live_nodes() {
            let node = &self.program.nodes[id as usize];
            node.operands().iter().for_each(|&operand| of(operand, node.region));
        }
        for (&number, &home) in &self.home {
            for (_, carry) in self.program.live_carries(number) {
                of(carry.init, home);
                of(carry.next, self.program.statements[number as usize].body().unwrap_or(home));
            }
            match &self.program.statements[number as usize] {
                Statement::Loop(x) => x.again.iter().for_each(|&id| of(id, x.body)),
                Statement::Branch(x) => of(x.mask, home),
                Statement::Chunks(x) => {
                    x.init.iter().for_each(|&id| of(id, home));
                    x.next.iter().for_each(|&id| of(id, x.body));
                }
                Statement::Store(x) => of(x.value, home),
            }
        }
    }
}
