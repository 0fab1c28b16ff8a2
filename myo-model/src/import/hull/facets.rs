//! Facets of a growing hull, in a list with its order.

use nalgebra::Vector3;

/// Number of a facet, or none.
pub(super) const NONE: usize = usize::MAX;

/// A triangle of the hull.
#[derive(Clone, Debug)]
pub(super) struct Facet {
    /// Corners, the last one added first.
    pub corners: [usize; 3],
    /// Facets across the sides that are opposite of these.
    pub neighbours: [usize; 3],
    /// Whether the corners are in the order of a right-handed turn.
    pub is_upright: bool,
    pub normal: Vector3<f64>,
    pub offset: f64,
    /// Points outside of it, the furthest last.
    pub outside: Vec<usize>,
    pub furthest: f64,
    /// Whether the point that is being added sees it.
    pub is_visible: bool,
    /// Whether it was made, or moved, for that point.
    pub is_new: bool,
    /// The last search that came by.
    pub visit: usize,
    previous: usize,
    next: usize,
}

impl Facet {
    /// How far a point is outside (m).
    pub fn distance(&self, point: &Vector3<f64>) -> f64 {
        self.offset + point.x * self.normal.x + point.y * self.normal.y + point.z * self.normal.z
    }
}

/// All facets that were ever made, and the list of those that count.
#[derive(Clone, Debug, Default)]
pub(super) struct Facets {
    pub all: Vec<Facet>,
    first: Option<usize>,
    last: Option<usize>,
    /// Where points that are still outside are looked for; beyond the end if none is.
    pub next: Option<usize>,
    /// The first of those made for a point.
    pub new: Option<usize>,
    /// Whether facets are being made for one.
    is_making: bool,
}

impl Facets {
    pub fn first(&self) -> Option<usize> {
        self.first
    }

    pub fn after(&self, facet: usize) -> Option<usize> {
        Some(self.all[facet].next).filter(|&next| next != NONE)
    }

    /// From one to the end.
    pub fn from(&self, first: Option<usize>) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(first, |&facet| self.after(facet))
    }

    /// From here on facets are new.
    pub fn begin(&mut self) {
        (self.new, self.is_making) = (None, true);
    }

    /// None is new any more.
    pub fn finish(&mut self) {
        let new: Vec<usize> = self.from(self.new).collect();
        new.into_iter().for_each(|facet| self.all[facet].is_new = false);
        (self.new, self.is_making) = (None, false);
    }

    /// Makes one at the end of the list.
    pub fn make(&mut self, corners: [usize; 3], is_upright: bool) -> usize {
        self.all.push(Facet {
            corners,
            neighbours: [NONE; 3],
            is_upright,
            normal: Vector3::zeros(),
            offset: 0.0,
            outside: vec![],
            furthest: 0.0,
            is_visible: false,
            is_new: true,
            visit: 0,
            previous: NONE,
            next: NONE,
        });
        self.append(self.all.len() - 1);
        self.all.len() - 1
    }

    fn append(&mut self, facet: usize) {
        let previous = self.last.replace(facet);
        self.all[facet].previous = previous.unwrap_or(NONE);
        self.all[facet].next = NONE;
        match previous {
            Some(previous) => self.all[previous].next = facet,
            None => self.first = Some(facet),
        }
        // What was beyond the end is here now.
        self.next = self.next.or(Some(facet));
        if self.is_making {
            self.new = self.new.or(Some(facet));
        }
    }

    /// Takes one out of the list.
    pub fn remove(&mut self, facet: usize) {
        let after = self.after(facet);
        let before = Some(self.all[facet].previous).filter(|&before| before != NONE);
        for place in [&mut self.next, &mut self.new] {
            if *place == Some(facet) {
                *place = after;
            }
        }
        match before {
            Some(before) => self.all[before].next = after.unwrap_or(NONE),
            None => self.first = after,
        }
        match after {
            Some(after) => self.all[after].previous = before.unwrap_or(NONE),
            None => self.last = before,
        }
    }

    /// Moves one to the end.
    pub fn move_to_end(&mut self, facet: usize) {
        self.remove(facet);
        self.append(facet);
    }

    /// Moves one to where points are looked for next.
    pub fn move_to_next(&mut self, facet: usize) {
        self.remove(facet);
        let Some(next) = self.next else { return self.append(facet) };
        let before = std::mem::replace(&mut self.all[next].previous, facet);
        (self.all[facet].previous, self.all[facet].next) = (before, next);
        if before == NONE {
            self.first = Some(facet);
        } else {
            self.all[before].next = facet;
        }
        self.next = Some(facet);
    }
}
