//! What is remembered of a surface, for one that grows later from where it ended.

use super::polytope::{Point, Polytope};

/// Points and triangles that a surface has that is remembered: as a closed one of so many points has.
pub(super) const POINTS: usize = 24;
const FACES: usize = 2 * POINTS - 4;

/// The origin is not so far outside of what is remembered (m), else it is of another body or long ago.
const FAR: f64 = 0.01;

/// A surface by numbers. No result depends on it: a surface that has grown proves itself, whatever it began with.
#[derive(Clone, Copy, Debug)]
pub struct Seed {
    /// How many corners the hulls have that it is of, none of nothing.
    hulls: [usize; 2],
    /// Corners that points are made of.
    points: [[u16; 2]; POINTS],
    /// Points that triangles are between.
    faces: [[u8; 3]; FACES],
    counts: [usize; 2],
}

impl Default for Seed {
    fn default() -> Self {
        Self { hulls: [0; 2], points: [[0; 2]; POINTS], faces: [[0; 3]; FACES], counts: [0; 2] }
    }
}

impl Seed {
    /// Remembers nothing.
    pub(super) fn forget(&mut self) {
        self.hulls = [0; 2];
    }

    /// Remembers a surface between hulls of so many corners, unless it is too large.
    pub(super) fn keep(&mut self, hulls: [usize; 2], polytope: &Polytope) {
        let counts = [polytope.points.len(), polytope.faces.len()];
        let fits = counts[0] <= POINTS && counts[1] <= FACES;
        (self.hulls, self.counts) = (if fits { hulls } else { [0; 2] }, counts);
        for (kept, point) in self.points.iter_mut().zip(&polytope.points) {
            *kept = point.of.map(|corner| corner as u16);
        }
        for (kept, face) in self.faces.iter_mut().zip(&polytope.faces) {
            *kept = face.corners.map(|corner| corner as u8);
        }
    }

    /// Makes a surface of what is remembered of hulls of so many corners; whether there is one.
    pub(super) fn sow(&self, hulls: [usize; 2], polytope: &mut Polytope, point: impl Fn([usize; 2]) -> Point) -> bool {
        polytope.clear();
        if self.hulls != hulls {
            return false;
        }
        let [points, faces] = self.counts;
        polytope.points.extend(self.points[..points].iter().map(|of| point(of.map(usize::from))));
        let mut faces = self.faces[..faces].iter();
        faces.all(|corners| polytope.add(corners.map(usize::from)).is_some_and(|height| height > -FAR))
    }
}
