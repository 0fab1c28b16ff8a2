//! Where a round shape and a hull touch, found by walking over corners of the hull, instead of looking at all of it.
//!
//! Along the normals of which a corner is the deepest the overlap is least at normals of its own, in the arcs of its edges, or at normals of its triangles. Where the
//! shapes are apart the overlap is a convex function of the normal: it has one least value, and none beside that is less than all around it, so a walk on to the
//! corners of what is less ends there. Where they overlap it goes on, too, over all edges that may be less than what is known.

use super::hull::Edge;
use super::placed::{Feature, Placed};
use super::polytope::{Point, Support};
use super::round::{Arc, ROUNDING, Round, Towards, at_second, level_between, lines_meet, on_first};
use super::touch::Touch;
use super::walked::Walked;
use nalgebra::Vector3;

/// A walk to the least overlap.
pub(super) struct Descent<'a, R> {
    shape: &'a R,
    pub hull: &'a Placed<'a>,
    pub best: Touch,
    does_overlap: bool,
    walked: &'a mut Walked,
}

impl<'a, R: Round> Descent<'a, R> {
    /// Of shapes that are apart along a normal.
    pub fn apart(shape: &'a R, hull: &'a Placed<'a>, normal: &Vector3<f64>, walked: &'a mut Walked) -> Self {
        Self::new(shape, hull, false, [normal].into_iter(), walked)
    }

    /// Of shapes that overlap no less than is known along all normals but near these.
    pub fn overlapping<'n>(
        shape: &'a R,
        hull: &'a Placed<'a>,
        normals: impl Iterator<Item = &'n Vector3<f64>>,
        walked: &'a mut Walked,
    ) -> Self {
        Self::new(shape, hull, true, normals, walked)
    }

    /// From the corners on that are deepest along some normals.
    fn new<'n>(
        shape: &'a R,
        hull: &'a Placed<'a>,
        does_overlap: bool,
        normals: impl Iterator<Item = &'n Vector3<f64>>,
        walked: &'a mut Walked,
    ) -> Self {
        walked.begin(hull.hull);
        normals.for_each(|normal| walked.come_to(hull.climbed(&-normal, None)));
        Self { shape, hull, best: Touch::none(&Vector3::z()), does_overlap, walked }
    }

    /// The next corner to look at.
    pub fn next(&mut self) -> Option<usize> {
        if self.best.depth.is_finite() {
            self.best.features[1].corners().into_iter().for_each(|corner| self.walked.come_to(corner));
        }
        self.walked.next()
    }

    /// The normal of a triangle, to the shape.
    fn towards(&mut self, triangle: usize) -> Towards {
        let (shape, hull) = (self.shape, self.hull);
        self.walked.towards(triangle, || Towards::of(shape, -hull.triangle_normal(triangle)))
    }

    /// The normals of the triangles around a corner.
    pub fn at_faces(&mut self, corner: usize) {
        for &number in &self.hull.hull.triangles_around[corner] {
            let triangle = &self.hull.hull.triangles[number];
            if self.walked.has_passed(&triangle.corners) {
                continue;
            }
            let Towards { normal, first } = self.towards(number);
            let depth = (first - self.hull.vertex(triangle.corners[0])).dot(&normal);
            self.best.keep_less(depth, || on_first(normal, depth, first, Feature::triangle(triangle.corners)));
        }
    }

    /// A normal, if a corner is the deepest along it.
    pub fn at_vertex(&mut self, normal: &Vector3<f64>, corner: usize) {
        let second = self.hull.vertex(corner);
        let depth = (self.shape.furthest(normal) - second).dot(normal);
        if depth >= self.best.depth {
            return;
        }
        // Only of what its neighbours do not rule out all corners are asked.
        if self.hull.climbed(&-normal, Some(corner)) != corner {
            return;
        }
        let deepest = self.hull.vertex(self.hull.furthest(&-normal));
        if (second - deepest).dot(normal) <= ROUNDING {
            self.best.keep_less(depth, || at_second(*normal, depth, second, Feature::vertex(corner)));
        }
    }

    /// The edges at a corner: normals that are square to them and to an axis, `point` being a point of the shape's line in that direction, and those within their
    /// arcs along which the overlap is least, if `counts` holds.
    pub fn at_edges(
        &mut self,
        corner: usize,
        axis: &Vector3<f64>,
        point: impl Fn(&Vector3<f64>) -> Vector3<f64>,
        counts: impl Fn(&Vector3<f64>) -> bool,
    ) {
        for &number in &self.hull.hull.edges_around[corner] {
            let edge = &self.hull.hull.edges[number];
            if self.walked.has_passed(&edge.ends) {
                continue;
            }
            let [begin, end] = edge.sides.map(|side| self.towards(side));
            let ends = edge.ends.map(|end| self.hull.vertex(end));
            if let Some(normal) = level_between(&begin.normal, &end.normal, axis) {
                let on_line = point(&normal);
                let depth = (on_line - ends[0]).dot(&normal);
                self.best.keep_less(depth, || {
                    let points = lines_meet([on_line, *axis], [ends[0], ends[1] - ends[0]]);
                    Touch { depth, normal, points, features: [Feature::vertex(0), Feature::edge(edge.ends)] }
                });
            }
            let arc = Arc { shape: self.shape, corners: None, begin, end, corner: ends[0] };
            if self.does_overlap {
                self.along_overlapping(&arc, edge, &counts);
            } else if let Some(normal) = arc.least(self.best.depth.min(0.0)).filter(&counts) {
                self.on_arc(&arc, edge, normal);
            }
        }
    }

    /// An arc along which the overlap may be less than is known; then what is beyond it counts, too.
    fn along_overlapping(&mut self, arc: &Arc<'_, R>, edge: &Edge, counts: &impl Fn(&Vector3<f64>) -> bool) {
        if arc.is_no_less(&arc.begin, &arc.end, self.best.depth) {
            return;
        }
        arc.minima(&mut |normal| {
            if let Some(normal) = normal.filter(counts) {
                self.on_arc(arc, edge, normal);
            }
            self.best.depth
        });
        edge.ends.into_iter().for_each(|end| self.walked.come_to(end));
    }

    /// A normal within the arc of an edge.
    fn on_arc(&mut self, arc: &Arc<'_, R>, edge: &Edge, normal: Vector3<f64>) {
        let first = self.shape.furthest(&normal);
        let depth = (first - arc.corner).dot(&normal);
        self.best.keep_less(depth, || on_first(normal, depth, first, Feature::edge(edge.ends)));
    }
}

/// A round shape and a hull, for their difference.
pub(super) struct Two<'a, R> {
    pub shape: &'a R,
    pub hull: &'a Placed<'a>,
}

impl<R: Round> Two<'_, R> {
    fn point(&self, direction: &Vector3<f64>, vertex: usize) -> Point {
        Point { at: self.shape.furthest(direction) - self.hull.vertex(vertex), of: [0, vertex] }
    }
}

impl<R: Round> Support for Two<'_, R> {
    fn near(&self, direction: &Vector3<f64>, from: Option<[usize; 2]>) -> Point {
        self.point(direction, self.hull.climbed(&-direction, from.map(|of| of[1])))
    }

    fn surely(&self, direction: &Vector3<f64>) -> Point {
        self.point(direction, self.hull.furthest(&-direction))
    }
}
