//! Elimination of a matrix whose halves differ: what one coordinate does to another is not what that does to it.

use super::Elimination;

/// The turns of an [`Elimination`] with the entries of both halves. Entries are numbered `row * ndof + column`; of a pair the first is in
/// the row of the coordinate that is eliminated later.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Unsymmetric {
    /// Coordinates, first those that are eliminated first.
    pub columns: Vec<UnsymmetricColumn>,
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
    /// In the same order and with the same zeros: without pivots the factors have no others.
    pub(super) fn of(elimination: &Elimination) -> Self {
        let ndof = elimination.columns.len();
        let both = |later: usize, earlier: usize| [later * ndof + earlier, earlier * ndof + later];
        // The other coordinate of an entry.
        let other = |entry: usize, dof: usize| entry / ndof + entry % ndof - dof;
        let columns = elimination.columns.iter().map(|column| {
            let dof = column.dof;
            let felt = |felt: &super::Felt| FeltBothWays { dof: felt.dof, entries: both(dof, felt.dof) };
            let later = |later: &super::Later| {
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
        Self { columns: columns.collect() }
    }
}
