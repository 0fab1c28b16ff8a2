//! What an implicit step needs to know of muscles.

use super::Plan;
use super::elimination::inertial;
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
        let own = dofs.iter().map(|&dof| [dof, dof]);
        let felt = inertial(plan).map(|(a, b)| [a.max(b), a.min(b)]);
        let all: BTreeSet<[usize; 2]> =
            own.chain(felt.filter(|pair| pair.iter().all(|dof| dofs.contains(dof)))).collect();
        Self { dofs, pairs: all.into_iter().collect() }
    }
}
