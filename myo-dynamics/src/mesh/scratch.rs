//! Memory that looking for contacts of meshes needs: no step allocates.

use super::hull::Hull;
use super::polytope::Polytope;
use super::seed::Seed;
use super::walked::Walked;
use nalgebra::Vector3;

/// What the search for a touch of two hulls, and clipping, write down.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// What is remembered of pairs of hulls, and the number of the one that counts.
    seeds: Vec<Seed>,
    seed: usize,
    /// The difference of two shapes.
    pub(super) polytope: Polytope,
    /// Of each triangle of a hull how far another one reaches behind it at least.
    pub(super) least: Vec<f64>,
    /// Points of each hull that are deep in the other one.
    pub(super) deep: [Vec<Vector3<f64>>; 2],
    /// Edges of both that may be where they touch.
    pub(super) arcs: [Vec<Arc>; 2],
    /// Corners and normals of triangles of a hull where it is.
    pub(super) vertices: Vec<Vector3<f64>>,
    pub(super) normals: Vec<Vector3<f64>>,
    /// What a walk over a hull came to.
    pub(super) walked: Walked,
    /// Corners of a polygon, and of what is left of it.
    pub(super) corners: Vec<Vector3<f64>>,
    pub(super) left: Vec<Vector3<f64>>,
}

/// An edge, and the arc between the normals of its triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    pub edge: usize,
    pub point: Vector3<f64>,
    pub along: Vector3<f64>,
    pub begin: Vector3<f64>,
    pub end: Vector3<f64>,
    /// Which way the arc turns about the edge: 1 or -1.
    pub turn: f64,
}

impl Default for Scratch {
    fn default() -> Self {
        Self::new(std::iter::empty())
    }
}

impl Scratch {
    /// The same with memory of so many pairs of bodies, instead of one.
    pub fn remembering(mut self, pairs: usize) -> Self {
        self.seeds.resize(pairs.max(1), Seed::default());
        self
    }

    /// Remembers nothing.
    pub fn forget(&mut self) {
        self.seeds.iter_mut().for_each(Seed::forget);
    }

    /// The pair that is looked at next.
    pub fn recall(&mut self, pair: usize) {
        self.seed = pair;
    }

    /// The difference of two shapes, and what is remembered of it.
    pub(super) fn remembered(&mut self) -> (&mut Polytope, &mut Seed) {
        (&mut self.polytope, &mut self.seeds[self.seed])
    }

    /// Enough for these.
    pub fn new<'a>(hulls: impl Iterator<Item = &'a Hull>) -> Self {
        let (mut vertices, mut triangles, mut corners) = (0, 0, 0);
        for hull in hulls {
            vertices = vertices.max(hull.vertices.len());
            triangles = triangles.max(hull.triangles.len());
            let polygons = hull.polygons.iter().map(|polygon| polygon.corners.len());
            corners = polygons.fold(corners, usize::max);
        }
        // A closed surface of triangles has three edges for two of them. Each side that clips adds a corner or two.
        let (edges, corners) = (triangles * 3 / 2, 2 * (2 * corners + super::cap::CAP_CORNERS));
        Self {
            seeds: vec![Seed::default()],
            seed: 0,
            polytope: Polytope::new(),
            least: Vec::with_capacity(triangles),
            deep: std::array::from_fn(|_| Vec::with_capacity(vertices)),
            arcs: std::array::from_fn(|_| Vec::with_capacity(edges)),
            vertices: Vec::with_capacity(vertices),
            walked: Walked::new(vertices, triangles),
            normals: Vec::with_capacity(triangles),
            corners: Vec::with_capacity(corners),
            left: Vec::with_capacity(corners),
        }
    }
}
