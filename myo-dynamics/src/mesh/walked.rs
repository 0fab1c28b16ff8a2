//! Corners of a hull that a walk came to, and what it knows of its triangles, so that it looks at nothing twice.

use super::hull::Hull;
use super::round::Towards;

/// Memory of a walk, for one after the other.
#[derive(Clone, Debug)]
pub(super) struct Walked {
    /// Corners that were looked at, and then those that are to be.
    corners: Vec<usize>,
    /// How many were looked at, the one that is looked at now included.
    count: usize,
    /// By their numbers, corners that were looked at before that one.
    passed: Vec<bool>,
    /// By their numbers, what is known of triangles, and of which something is.
    towards: Vec<Option<Towards>>,
    seen: Vec<usize>,
}

impl Walked {
    /// Memory for hulls of so many corners and triangles.
    pub fn new(corners: usize, triangles: usize) -> Self {
        Self {
            corners: Vec::with_capacity(corners),
            count: 0,
            passed: vec![false; corners],
            towards: vec![None; triangles],
            seen: Vec::with_capacity(triangles),
        }
    }

    /// Begins a walk over a hull.
    pub fn begin(&mut self, hull: &Hull) {
        let Self { corners, count, passed, towards, seen } = self;
        corners.drain(..).for_each(|corner| passed[corner] = false);
        seen.drain(..).for_each(|triangle| towards[triangle] = None);
        *count = 0;
        passed.resize(passed.len().max(hull.vertices.len()), false);
        towards.resize(towards.len().max(hull.triangles.len()), None);
    }

    /// Adds a corner that is not there.
    pub fn come_to(&mut self, corner: usize) {
        if !self.corners.contains(&corner) {
            self.corners.push(corner);
        }
    }

    /// The next corner to look at.
    pub fn next(&mut self) -> Option<usize> {
        let next = self.corners.get(self.count).copied()?;
        if let Some(last) = self.count.checked_sub(1) {
            self.passed[self.corners[last]] = true;
        }
        self.count += 1;
        Some(next)
    }

    /// Whether one of these corners was looked at before: then so was all that both it and the one that is looked at now are part of.
    pub fn has_passed(&self, corners: &[usize]) -> bool {
        corners.iter().any(|&corner| self.passed[corner])
    }

    /// What is known of a triangle, or found now.
    pub fn towards(&mut self, triangle: usize, find: impl FnOnce() -> Towards) -> Towards {
        let Self { towards, seen, .. } = self;
        *towards[triangle].get_or_insert_with(|| {
            seen.push(triangle);
            find()
        })
    }
}
