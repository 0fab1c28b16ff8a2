//! Boxes as the fingertip finds them: gone through in a row or asked for by number, each where it stands and as large as it is now.

use crate::obstacles::Obstacles;
use crate::spatial::Vec3;
use myo_scalar::{Row, Scalar};

/// All boxes, and how far those are off their places that are moved, and how much larger or smaller those that are drawn so.
pub struct Boxes<'a, S: Scalar> {
    /// The boxes.
    pub obstacles: &'a Obstacles<S::Const, S>,
    /// See [`Workspace::offsets`](crate::Workspace::offsets).
    pub offsets: &'a [Vec3<S>],
}

// By hand: derived, they would ask the same of the number.
impl<S: Scalar> Clone for Boxes<'_, S> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Scalar> Copy for Boxes<'_, S> {}

/// Which box is looked at.
#[derive(Clone, Copy)]
pub enum Which<S: Scalar> {
    /// One of all, gone through in a row.
    Row(Row<S::Word>),
    /// One by its number.
    Listed(S),
}

impl<S: Scalar> Boxes<'_, S> {
    /// How many there are.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.obstacles.boxes.len()
    }

    /// From the centre of a box to a point, and the radius of the ball around it.
    #[inline(always)]
    pub fn seen_from(&self, point: Vec3<S>, which: Which<S>) -> (Vec3<S>, S) {
        let boxes = &self.obstacles.boxes;
        let [x, y, z, radius] = which.entries(boxes.len(), |k| {
            let [x, y, z] = boxes[k].centre;
            [x, y, z, boxes[k].radius]
        });
        let away = point - Vec3::new(x, y, z);
        if self.offsets.is_empty() {
            return (away, radius);
        }
        let moved_by = &self.obstacles.moved_by;
        let [offset] = which.entries(moved_by.len(), |k| [moved_by[k]]);
        (away - self.offset(offset), radius)
    }

    /// Axes as columns, and half sizes, of a box.
    #[inline(always)]
    pub fn sides(&self, which: Which<S>) -> ([[S; 3]; 3], [S; 3]) {
        let boxes = &self.obstacles.boxes;
        let [a, b, c, e, f, g, i, j, k, h, w, d] = which.entries(boxes.len(), |k| boxes[k].sides());
        let (axes, half_size) = ([[a, b, c], [e, f, g], [i, j, k]], [h, w, d]);
        let grown_by = &self.obstacles.grown_by;
        if self.offsets.is_empty() || grown_by.is_empty() {
            return (axes, half_size);
        }
        let [offset] = which.entries(grown_by.len(), |k| [grown_by[k]]);
        (axes, (Vec3::new(h, w, d) + self.offset(offset)).array())
    }

    /// The offset of this number; none where there is no such one.
    #[inline(always)]
    fn offset(&self, number: S) -> Vec3<S> {
        let entry = |k: usize| self.offsets.get(k).map_or([S::zero(); 3], |offset| offset.array());
        let [x, y, z] = S::gather(self.offsets.len() + 1, entry, number);
        Vec3::new(x, y, z)
    }
}

impl<S: Scalar> Which<S> {
    #[inline(always)]
    fn entries<const N: usize>(self, count: usize, entry: impl Fn(usize) -> [S; N]) -> [S; N] {
        match self {
            Self::Row(row) => S::of_row(row, count, entry),
            Self::Listed(number) => S::gather(count, entry, number),
        }
    }

    /// Its number.
    #[inline(always)]
    pub fn number(self) -> S {
        match self {
            Self::Row(row) => S::row_number(row),
            Self::Listed(number) => number,
        }
    }
}
