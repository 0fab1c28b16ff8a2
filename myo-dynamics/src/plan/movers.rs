//! Which coordinates move two surfaces against each other.

use super::{Column, Elimination, Link};

/// A coordinate that moves one of two surfaces, or both in different ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mover {
    /// The coordinate.
    pub dof: usize,
    /// The screw with which it moves the first surface.
    pub under: Option<usize>,
    /// That of the second.
    pub over: Option<usize>,
}

/// All that move two surfaces against each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Movers {
    /// The coordinates.
    pub each: Vec<Mover>,
    /// Their entries of the mass matrix.
    pub columns: Vec<Column>,
}

impl Movers {
    /// Of the surfaces of two links.
    pub(super) fn of([under, over]: [usize; 2], links: &[Link<f64>], elimination: &Elimination) -> Self {
        let screws = links[under].screw_of_dof.iter().zip(&links[over].screw_of_dof).enumerate();
        let each: Vec<Mover> = screws
            .filter(|(_, (under, over))| under != over)
            .map(|(dof, (&under, &over))| Mover { dof, under, over })
            .collect();
        let dofs: Vec<usize> = each.iter().map(|mover| mover.dof).collect();
        Self { each, columns: elimination.among(&dofs) }
    }
}
