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
    let parents = program.parents();
    let mut claims: HashMap<Id, Claim> = HashMap::new();
    for region in 0..parents.len() as u32 {
        claims.extend(program.statements_of(region).flat_map(|number| claims_of(program, number, region)));
    }
    program.for_each_need(|id, region| {
        if let Some(claim) = claims.get_mut(&id)
            && !claim.shelter.is_some_and(|body| is_within(region, body, &parents))
        {
            claim.wanted += 1;
        }
    });
    // Once by the heir, as it begins.
    let undisputed = claims.into_values().filter(|claim| claim.wanted == 1);
    undisputed.map(|claim| (claim.heir, claim.from)).collect()
}

/// A variable that begins as what another was at its end.
struct Claim {
    heir: Variable,
    from: Variable,
    /// A region that may read it, too: the body of a branch writes its variables when all is read. That of a loop runs again.
    shelter: Option<u32>,
    /// How often it is read outside of that.
    wanted: usize,
}

/// The variables of a statement that begin as another's end, in the same region: a loop around only one of both would run again.
fn claims_of(program: &Program, number: u32, region: u32) -> impl Iterator<Item = (Id, Claim)> + '_ {
    let shelter = match &program.statements[number as usize] {
        Statement::Branch(x) => Some(x.body),
        _ => None,
    };
    program.live_carries(number).filter_map(move |(index, carry)| {
        let node = program.nodes[carry.init as usize];
        let Op::Outcome(statement, other) = node.op else { return None };
        let has_cell = matches!(program.statements[statement as usize], Statement::Branch(_) | Statement::Loop(_));
        let from = (statement, other as usize);
        let claim = Claim { heir: (number, index), from, shelter, wanted: 0 };
        (has_cell && node.region == region).then_some((carry.init, claim))
    })
}

fn is_within(mut region: u32, body: u32, parents: &[u32]) -> bool {
    // Regions inside are opened later.
    while region > body {
        region = parents[region as usize];
    }
    region == body
}

#[cfg(test)]
mod tests {
    use super::*;
    use myo_scalar::symbolic::{Buffer, Sharing, Sym, trace};
    use myo_scalar::{Carried, Scalar, Visitor};

    const ROWS: Buffer = Buffer { binding: 0, sharing: Sharing::PerEnv };

    struct Sum(Sym);

    impl Carried<Sym> for Sum {
        fn visit(&mut self, visitor: &mut impl Visitor<Sym>) {
            visitor.number(&mut self.0);
        }
    }

    /// Two branches that add to one number, with something between them and something within the second.
    fn adding_twice(between: impl Fn(Sym), within: impl Fn(Sym)) -> Program {
        trace(|| {
            let mut sum = Sum(ROWS.number(0));
            let [first, second]: [Sym; 2] = [1, 2].map(|row| ROWS.number(row));
            Sym::when(Sym::zero().lt(first), &mut sum, |sum| sum.0 += first);
            let once = sum.0;
            between(once);
            Sym::when(Sym::zero().lt(second), &mut sum, |sum| {
                within(once);
                sum.0 += second;
            });
            ROWS.set_number(0, sum.0);
        })
    }

    #[test]
    fn the_second_of_two_branches_that_add_to_a_number_takes_over_its_place() {
        let heirs = heirs(&adding_twice(|_| (), |_| ()));
        assert_eq!(heirs.into_values().map(|(_, index)| index).collect::<Vec<_>>(), [0]);
    }

    #[test]
    fn what_is_read_outside_of_the_second_branch_keeps_its_place() {
        let kept = |once| ROWS.set_number(3, once);
        assert!(heirs(&adding_twice(kept, |_| ())).is_empty());
        assert_eq!(
            heirs(&adding_twice(|_| (), kept)).len(),
            1,
            "who reads it within the branch reads it before it changes"
        );
    }
}
