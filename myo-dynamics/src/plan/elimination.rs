//! Which coordinates feel each other, and in which order they are eliminated.
//!
//! Two fingers feel each other through the hand only, so entries of the mass matrix are zero for coordinates of which neither
//! carries the other. Eliminated from the leaves of the tree to its root, these zeros stay zero (Featherstone 2005, Efficient
//! Factorization of the Joint-Space Inertia Matrix for Branched Kinematic Trees, doi 10.1177/0278364905054928). A coupling of
//! joints, or a coordinate that drives joints on several branches, makes coordinates of two branches feel each other: what
//! elimination fills in then is found here by going through it once without numbers.

use super::{Connection, ContactPair, Plan};
use std::collections::BTreeSet;

/// The order of elimination, with the entries that are not always zero. Entries are numbered `row * ndof + column` in the
/// lower triangle.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Elimination {
    /// Coordinates, first those that are eliminated first.
    pub columns: Vec<Column>,
}

/// A coordinate's turn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// The coordinate.
    pub dof: usize,
    /// Its entry on the diagonal.
    pub diagonal: usize,
    /// Coordinates whose turn came before and that it feels.
    pub before: Vec<Felt>,
    /// Those whose turn comes later.
    pub after: Vec<Later>,
}

/// A coordinate that another one feels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Felt {
    /// The coordinate.
    pub dof: usize,
    /// Their common entry.
    pub entry: usize,
}

/// A coordinate that is eliminated later.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Later {
    /// The coordinate.
    pub dof: usize,
    /// Their common entry.
    pub entry: usize,
    /// Entries whose products were taken from it before.
    pub products: Vec<[usize; 2]>,
}

/// Pairs of coordinates that feel each other's inertia: the entries of the mass matrix off its diagonal, and some on it.
pub(super) fn inertial(plan: &Plan<f64>) -> impl Iterator<Item = (usize, usize)> {
    plan.mass_terms.iter().flat_map(|term| term.rows.iter().map(|&(_, dof)| (dof, term.column)))
}

impl Elimination {
    /// Of a plan whose mass matrix, couplings, contact and limited tendons are known.
    pub(super) fn of(plan: &Plan<f64>) -> Self {
        let ndof = plan.ndof();
        let mut pairs: BTreeSet<(usize, usize)> = inertial(plan).collect();
        pairs.extend(plan.equalities.iter().filter_map(|row| Some((row.dependent, row.drive.dof?))));
        let spheres = plan.contact_spheres.iter().map(|sphere| [0, sphere.centre.link]);
        let of_links = |links: [usize; 2]| {
            let moves = |dof: &usize| links.iter().any(|&link| plan.links[link].screw_of_dof[*dof].is_some());
            (0..ndof).filter(moves).collect::<Vec<_>>()
        };
        let parts = spheres.chain(plan.pairs.iter().map(ContactPair::links));
        let parts = parts.chain(plan.connections.iter().map(Connection::links)).map(of_links);
        for moving in parts.chain(plan.tendon_limits.iter().map(|limit| limit.dofs.clone())) {
            pairs.extend(moving.iter().flat_map(|&a| moving.iter().map(move |&b| (a, b))));
        }
        Self::new(ndof, &pairs)
    }

    /// For coordinates of which these pairs feel each other: first to last, or last to first where that leaves more zeros.
    fn new(ndof: usize, pairs: &BTreeSet<(usize, usize)>) -> Self {
        let [forward, backward] =
            [(0..ndof).collect::<Vec<_>>(), (0..ndof).rev().collect()].map(|order| Self::in_order(&order, pairs));
        if backward.entries() < forward.entries() { backward } else { forward }
    }

    fn in_order(order: &[usize], pairs: &BTreeSet<(usize, usize)>) -> Self {
        let ndof = order.len();
        let mut turn = vec![0; ndof];
        for (k, &dof) in order.iter().enumerate() {
            turn[dof] = k;
        }
        // By turns: the later ones that each is felt by.
        let mut later = vec![BTreeSet::new(); ndof];
        for &(a, b) in pairs.iter().filter(|(a, b)| a != b) {
            later[turn[a].min(turn[b])].insert(turn[a].max(turn[b]));
        }
        for k in 0..ndof {
            let felt: Vec<usize> = later[k].iter().copied().collect();
            for (number, &first) in felt.iter().enumerate() {
                later[first].extend(&felt[number + 1..]);
            }
        }
        let entry = |a: usize, b: usize| order[a].max(order[b]) * ndof + order[a].min(order[b]);
        let column = |k: usize| {
            let before: Vec<usize> = (0..k).filter(|&earlier| later[earlier].contains(&k)).collect();
            let products = |i: usize| {
                let common = before.iter().filter(|&&earlier| later[earlier].contains(&i));
                common.map(|&earlier| [entry(i, earlier), entry(k, earlier)]).collect()
            };
            Column {
                dof: order[k],
                diagonal: entry(k, k),
                before: before.iter().map(|&earlier| Felt { dof: order[earlier], entry: entry(k, earlier) }).collect(),
                after: later[k]
                    .iter()
                    .map(|&i| Later { dof: order[i], entry: entry(i, k), products: products(i) })
                    .collect(),
            }
        };
        Self { columns: (0..ndof).map(column).collect() }
    }

    /// What some coordinates feel of each other; nothing of the elimination itself.
    pub(super) fn among(&self, dofs: &[usize]) -> Vec<Column> {
        let column = |column: &Column| Column {
            before: column.before.iter().filter(|felt| dofs.contains(&felt.dof)).copied().collect(),
            after: vec![],
            ..*column
        };
        self.columns.iter().filter(|column| dofs.contains(&column.dof)).map(column).collect()
    }

    /// How many entries of the triangle are not always zero.
    pub fn entries(&self) -> usize {
        self.columns.iter().map(|column| 1 + column.before.len()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Unsymmetric;
    use crate::step::{cholesky, lu};
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    /// Pairs of coordinates of which one carries the other, in a tree of so many that is given by each one's parent. A
    /// coordinate that is its own parent is a root.
    fn tree(parents: &[usize]) -> BTreeSet<(usize, usize)> {
        let mut pairs = BTreeSet::new();
        for k in 0..parents.len() {
            let mut above = k;
            while parents[above] != above {
                above = parents[above];
                pairs.insert((k, above));
            }
        }
        pairs
    }

    fn parents() -> impl Strategy<Value = Vec<usize>> {
        (1_usize..14).prop_flat_map(|ndof| (0..ndof).map(|k| 0..=k).collect::<Vec<_>>())
    }

    /// A tree, and what couplings add to it.
    fn pattern() -> impl Strategy<Value = (usize, BTreeSet<(usize, usize)>)> {
        parents().prop_flat_map(|parents| {
            let ndof = parents.len();
            let couplings = prop::collection::btree_set((0..ndof, 0..ndof), 0..3);
            couplings.prop_map(move |couplings| (ndof, tree(&parents).union(&couplings).copied().collect()))
        })
    }

    /// Some positive definite matrix with these entries.
    fn matrix(ndof: usize, pairs: &BTreeSet<(usize, usize)>) -> DMatrix<f64> {
        let mut matrix = DMatrix::identity(ndof, ndof) * (2.0 * ndof as f64);
        for (number, &(a, b)) in pairs.iter().filter(|(a, b)| a != b).enumerate() {
            let value = (number as f64 * 0.7).sin();
            (matrix[(a, b)], matrix[(b, a)]) = (value, value);
        }
        matrix
    }

    proptest! {
        #[test]
        fn it_solves_what_nalgebra_solves((ndof, pairs) in pattern()) {
            let matrix = matrix(ndof, &pairs);
            let right = DVector::from_fn(ndof, |k, _| (k as f64 + 1.0).cos());
            let wanted = matrix.clone().cholesky().expect("it is positive definite").solve(&right);
            for order in [(0..ndof).collect::<Vec<_>>(), (0..ndof).rev().collect()] {
                let elimination = Elimination::in_order(&order, &pairs);
                let mut lower: Vec<f64> = (0..ndof * ndof).map(|at| matrix[(at / ndof, at % ndof)]).collect();
                let (mut pivot, mut x) = (vec![0.0; ndof], right.as_slice().to_vec());
                cholesky::factor_and_solve(&elimination, &mut lower, &mut pivot, &mut x);
                for (x, wanted) in x.iter().zip(&wanted) {
                    prop_assert!((x - wanted).abs() < 1e-12, "{x} and {wanted}");
                }
            }
        }

        #[test]
        fn halves_that_differ_are_solved_too((ndof, pairs) in pattern()) {
            let mut matrix = matrix(ndof, &pairs);
            for row in 0..ndof {
                for column in 0..row {
                    matrix[(row, column)] *= 0.3;
                }
            }
            let right = DVector::from_fn(ndof, |k, _| (k as f64 + 1.0).cos());
            let wanted = matrix.clone().lu().solve(&right).expect("it is not singular");
            for order in [(0..ndof).collect::<Vec<_>>(), (0..ndof).rev().collect()] {
                let elimination = Unsymmetric { columns: Unsymmetric::columns(&Elimination::in_order(&order, &pairs)), ..Unsymmetric::default() };
                let mut entries: Vec<f64> = (0..ndof * ndof).map(|at| matrix[(at / ndof, at % ndof)]).collect();
                let (mut pivot, mut x) = (vec![0.0; ndof], right.as_slice().to_vec());
                lu::factor_and_solve(&elimination, &mut entries, &mut pivot, &mut x);
                for (x, wanted) in x.iter().zip(&wanted) {
                    prop_assert!((x - wanted).abs() < 1e-12, "{x} and {wanted}");
                }
            }
        }

        #[test]
        fn leaves_first_fills_nothing_of_a_tree(parents in parents()) {
            let pairs = tree(&parents);
            let order: Vec<usize> = (0..parents.len()).rev().collect();
            prop_assert_eq!(Elimination::in_order(&order, &pairs).entries(), parents.len() + pairs.len());
        }
    }

    #[test]
    fn a_chain_is_eliminated_first_to_last() {
        let pairs = (0..5).flat_map(|a| (0..a).map(move |b| (a, b))).collect();
        let elimination = Elimination::new(5, &pairs);
        assert_eq!(elimination.columns.iter().map(|column| column.dof).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
        assert_eq!(elimination.entries(), 15);
    }

    /// Five fingers of four joints on an arm of seven.
    #[test]
    fn fingers_do_not_feel_each_other() {
        let parent = |dof: usize| if dof > 7 && (dof - 7).is_multiple_of(4) { 6 } else { dof.saturating_sub(1) };
        let pairs = tree(&(0..27).map(parent).collect::<Vec<_>>());
        let elimination = Elimination::new(27, &pairs);
        assert_eq!(elimination.entries(), 7 * 8 / 2 + 5 * (4 * 7 + 4 * 5 / 2), "of 378");
        assert_eq!(elimination.columns[0].dof, 26);
    }
}
