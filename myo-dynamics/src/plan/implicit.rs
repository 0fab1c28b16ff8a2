//! What an implicit step needs to know of muscles.

use super::Plan;
use std::collections::BTreeSet;

/// A muscle whose force at the end of a step counts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImplicitMuscle {
    /// Coordinates that change its length.
    pub dofs: Vec<usize>,
    /// Pairs of these, the greater one first, that feel each other's inertia: MuJoCo's `implicitfast` knows no others.
    pub pairs: Vec<[usize; 2]>,
}

impl ImplicitMuscle {
    /// Of the coordinates along its path, in a plan whose mass matrix is known.
    pub(super) fn of(dofs: Vec<usize>, plan: &Plan<f64>) -> Self {
        let felt = plan.mass_terms.iter().flat_map(|term| term.rows.iter().map(|&(_, dof)| (dof, term.column)));
        let both: BTreeSet<(usize, usize)> = felt.flat_map(|(a, b)| [(a.max(b), a.min(b))]).collect();
        let on = plan.energy_profiles.iter().map(|profile| plan.profiled[profile.coordinate].dof);
        let own: BTreeSet<(usize, usize)> = on.map(|dof| (dof, dof)).collect();
        let all = || both.union(&own).filter(|(a, b)| dofs.contains(a) && dofs.contains(b));
        let pairs = all().map(|&(a, b)| [a, b]).collect();
        Self { dofs, pairs }
    }
}
