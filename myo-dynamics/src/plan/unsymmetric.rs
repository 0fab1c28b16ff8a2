//! Elimination of a matrix whose halves differ: what one coordinate does to another is not what that does to it.

use super::coordinates::Coordinates;
use super::{Elimination, Felt, Later, Plan};
use myo_model::Model;
use myo_model::description::{Integrator, JointKind};
use myo_model::model::Joint;

/// The turns of an [`Elimination`] with the entries of both halves. Entries are numbered `row * ndof + column`; of a pair the first is in
/// the row of the coordinate that is eliminated later.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Unsymmetric {
    /// Coordinates, first those that are eliminated first.
    pub columns: Vec<UnsymmetricColumn>,
    /// The only coordinates by which Coriolis forces are taken along, if it is not all.
    pub only: Option<Vec<usize>>,
    /// Terms of the mass matrix whose coordinates these are.
    pub terms: Vec<usize>,
}

/// A coordinate's turn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnsymmetricColumn {
    /// The coordinate.
    pub dof: usize,
    /// Its entry on the diagonal.
    pub diagonal: usize,
    /// Coordinates whose turn came before and that it feels.
    pub before: Vec<FeltBothWays>,
    /// Those whose turn comes later.
    pub after: Vec<LaterBothWays>,
}

/// A coordinate that another one feels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeltBothWays {
    /// The coordinate.
    pub dof: usize,
    /// Their common entries.
    pub entries: [usize; 2],
}

/// A coordinate that is eliminated later.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LaterBothWays {
    /// The coordinate.
    pub dof: usize,
    /// Their common entries.
    pub entries: [usize; 2],
    /// Common entries of each, first of the later one, with a coordinate that was eliminated before both.
    pub products: Vec<[[usize; 2]; 2]>,
}

impl Unsymmetric {
    /// For steps of a model: MuJoCo's `implicitfast` takes Coriolis forces along of free bodies that carry no other joint.
    pub(super) fn asked(model: &Model, coordinates: &Coordinates) -> Option<Self> {
        match model.options.integrator {
            Integrator::Euler => None,
            Integrator::Implicit => Some(Self::default()),
            Integrator::ImplicitFast => {
                let only = alone(model, coordinates);
                (!only.is_empty()).then(|| Self { only: Some(only), ..Self::default() })
            }
        }
    }

    /// Of a plan whose mass matrix is known.
    pub(super) fn of(self, plan: &Plan<f64>) -> Self {
        let counts = |dof: usize| self.only.as_ref().is_none_or(|only| only.contains(&dof));
        let terms = plan.mass_terms.iter().enumerate();
        let terms = terms.filter(|(_, term)| counts(term.column)).map(|(number, _)| number).collect();
        Self { terms, columns: Self::columns(&plan.elimination), ..self }
    }

    /// In the same order and with the same zeros: without pivots the factors have no others.
    pub(super) fn columns(elimination: &Elimination) -> Vec<UnsymmetricColumn> {
        let ndof = elimination.columns.len();
        let both = |later: usize, earlier: usize| [later * ndof + earlier, earlier * ndof + later];
        // The other coordinate of an entry.
        let other = |entry: usize, dof: usize| entry / ndof + entry % ndof - dof;
        let columns = elimination.columns.iter().map(|column| {
            let dof = column.dof;
            let felt = |felt: &Felt| FeltBothWays { dof: felt.dof, entries: both(dof, felt.dof) };
            let later = |later: &Later| {
                let earlier = later.products.iter().map(|&[_, own]| other(own, dof));
                LaterBothWays {
                    dof: later.dof,
                    entries: both(later.dof, dof),
                    products: earlier.map(|earlier| [both(later.dof, earlier), both(dof, earlier)]).collect(),
                }
            };
            UnsymmetricColumn {
                dof,
                diagonal: column.diagonal,
                before: column.before.iter().map(felt).collect(),
                after: column.after.iter().map(later).collect(),
            }
        });
        columns.collect()
    }
}

/// Coordinates of free bodies on which no other joint hangs. What is fixed to them counts, as MuJoCo 4.0.0 has it.
fn alone(model: &Model, coordinates: &Coordinates) -> Vec<usize> {
    let carries = |body: usize, mut below: usize| {
        while below != 0 && below != body {
            below = model.bodies[below].parent;
        }
        below == body
    };
    let is_alone = |joint: &Joint| {
        let carried = model.joints.iter().filter(|other| carries(joint.body, other.body));
        joint.kind == JointKind::Free && carried.count() == 1
    };
    let free = model.joints.iter().zip(&coordinates.joints).filter(|(joint, _)| is_alone(joint));
    free.flat_map(|(_, own)| own.dofs()).collect()
}
