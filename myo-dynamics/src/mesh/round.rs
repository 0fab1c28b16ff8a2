//! Where a round shape and a hull touch: the least overlap over all normals, which are those of the hull's faces, of its corners and of its edges.

use super::placed::{Feature, Placed};
use super::root::root;
use super::scratch::Scratch;
use super::touch::Touch;
use nalgebra::{Unit, Vector3};

/// What a height may be off by rounding (m).
pub(super) const ROUNDING: f64 = 1e-12;
/// How many corners are remembered that were deepest.
const DEEP: usize = 4;
/// How often the arc between the normals of two faces is halved at most to look for least overlaps, and the share that is left then.
const HALVES: usize = 5;
const SMALLEST: f64 = 1.0 / (1 << HALVES) as f64;
/// Halvings of an interval in which a root was found; it is as exact as its numbers then.
const HALVINGS: usize = 80;

/// A shape in its own frame.
pub(super) trait Round {
    /// Its furthest point in a direction.
    fn furthest(&self, direction: &Vector3<f64>) -> Vector3<f64>;
}

/// The search for the least overlap of a shape and a hull in its frame.
pub(super) struct Search<'a, R> {
    pub shape: &'a R,
    pub hull: &'a Placed<'a>,
    vertices: &'a [Vector3<f64>],
    normals: &'a [Vector3<f64>],
    /// Corners that were deepest along normals before, the latest in the place that `turn` is past.
    deep: [usize; DEEP],
    turn: usize,
    corners: Corners,
    pub best: Touch,
}

/// Points of a shape that are furthest along the diagonals of the eight octants. That of the octant which a normal points into is nearly as far along it as any.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners([Vector3<f64>; 8]);

impl Corners {
    pub fn of(shape: &impl Round) -> Self {
        let side = |number: usize, bit: usize| if number & bit == 0 { 1.0 } else { -1.0 };
        Self(std::array::from_fn(|k| shape.furthest(&Vector3::new(side(k, 1), side(k, 2), side(k, 4)))))
    }

    /// The one of a direction's octant.
    fn along(&self, direction: &Vector3<f64>) -> &Vector3<f64> {
        let bit = |x: f64, bit: usize| if x < 0.0 { bit } else { 0 };
        &self.0[bit(direction.x, 1) | bit(direction.y, 2) | bit(direction.z, 4)]
    }
}

impl<'a, R: Round> Search<'a, R> {
    /// Begins with the faces.
    pub fn new(shape: &'a R, hull: &'a Placed<'a>, scratch: &'a mut Scratch) -> Self {
        let Scratch { vertices, normals, .. } = scratch;
        vertices.clear();
        vertices.extend((0..hull.hull.vertices.len()).map(|number| hull.vertex(number)));
        normals.clear();
        normals.extend((0..hull.hull.triangles.len()).map(|number| hull.triangle_normal(number)));
        let none = Touch::none(&Vector3::z());
        let mut search =
            Self { shape, hull, vertices, normals, deep: [0; DEEP], turn: 0, corners: Corners::of(shape), best: none };
        for (triangle, normal) in hull.hull.triangles.iter().zip(search.normals) {
            let corner = search.vertices[triangle.corners[0]];
            // Any point of the shape tells how deep it is at least.
            if (corner - search.corners.along(&-normal)).dot(normal) >= search.best.depth {
                continue;
            }
            let (first, feature) = (search.shape.furthest(&-normal), Feature::triangle(triangle.corners));
            let depth = (corner - first).dot(normal);
            search.best.keep_less(depth, || on_first(-normal, depth, first, feature));
        }
        search
    }

    pub fn vertices(&self) -> &'a [Vector3<f64>] {
        self.vertices
    }

    /// The corner that is deepest against a direction.
    pub fn deepest(&self, normal: &Vector3<f64>) -> usize {
        self.hull.furthest(&-normal)
    }

    /// Whether there may be less overlap at a corner than is known: between the normals of the triangles around it the overlap is at least that of any
    /// one point of the shape, and this, where it is positive, no less than at the worst of these.
    pub fn may_count(&self, vertex: usize) -> bool {
        let around = &self.hull.hull.triangles_around[vertex];
        let sum: Vector3<f64> = around.iter().map(|&triangle| self.normals[triangle]).sum();
        let off = self.vertices[vertex] - self.shape.furthest(&-sum);
        let least = self.best.depth.max(0.0);
        !around.iter().all(|&triangle| self.normals[triangle].dot(&off) >= least)
    }

    /// A normal that belongs to a corner, if that is the deepest along it.
    pub fn at_vertex(&mut self, normal: &Vector3<f64>, vertex: usize) {
        let second = self.vertices[vertex];
        let overlap = |vertex: usize| (self.shape.furthest(normal) - self.vertices[vertex]).dot(normal);
        let least = overlap(vertex);
        // What was deepest along another normal nearly always tells that this corner is not.
        if least < self.best.depth && self.deep.iter().all(|&deep| overlap(deep) <= least + ROUNDING) {
            let deepest = self.deepest(normal);
            let depth = overlap(deepest);
            (self.deep[self.turn % DEEP], self.turn) = (deepest, self.turn + 1);
            if depth <= least + ROUNDING {
                self.best.keep_less(depth, || at_second(*normal, depth, second, Feature::vertex(vertex)));
            }
        }
    }

    /// Normals that are square to an edge and to a direction, `point` being a point of the shape's line in that direction.
    pub fn along_line(&mut self, axis: &Vector3<f64>, point: impl Fn(&Vector3<f64>) -> Vector3<f64>) {
        for edge in &self.hull.hull.edges {
            let [begin, end] = edge.sides.map(|side| -self.normals[side]);
            let Some(normal) = level_between(&begin, &end, axis) else { continue };
            let [corner, other] = edge.ends.map(|end| self.vertices[end]);
            let on_line = point(&normal);
            let depth = (on_line - corner).dot(&normal);
            self.best.keep_less(depth, || {
                let points = lines_meet([on_line, *axis], [corner, other - corner]);
                Touch { depth, normal, points, features: [Feature::vertex(0), Feature::edge(edge.ends)] }
            });
        }
    }

    /// Normals within the arcs of edges along which the overlap is least; those for which `counts` holds.
    pub fn along_arcs(&mut self, counts: impl Fn(&Vector3<f64>) -> bool) {
        for edge in &self.hull.hull.edges {
            let [begin, end] = edge.sides.map(|side| Towards::of(self.shape, -self.normals[side]));
            let corner = self.vertices[edge.ends[0]];
            let arc = Arc { shape: self.shape, corners: Some(&self.corners), begin, end, corner };
            arc.minima(&mut |normal| {
                let Some(normal) = normal else { return self.best.depth };
                let first = self.shape.furthest(&normal);
                let depth = (first - corner).dot(&normal);
                if counts(&normal) {
                    self.best.keep_less(depth, || on_first(normal, depth, first, Feature::edge(edge.ends)));
                }
                self.best.depth
            });
        }
    }
}

impl Touch {
    /// One that any other is less than.
    pub(super) fn none(normal: &Vector3<f64>) -> Self {
        let (none, origin) = (Feature::vertex(0), Vector3::zeros());
        Self { depth: f64::INFINITY, normal: *normal, points: [origin; 2], features: [none; 2] }
    }

    /// Becomes another one of less depth.
    pub(super) fn keep_less(&mut self, depth: f64, other: impl FnOnce() -> Self) {
        if depth < self.depth {
            *self = other();
        }
    }
}

/// A touch at a point of the first shape.
pub(super) fn on_first(normal: Vector3<f64>, depth: f64, first: Vector3<f64>, feature: Feature) -> Touch {
    Touch { depth, normal, points: [first, first - depth * normal], features: [Feature::vertex(0), feature] }
}

/// A touch at a point of the second.
pub(super) fn at_second(normal: Vector3<f64>, depth: f64, second: Vector3<f64>, feature: Feature) -> Touch {
    Touch { depth, normal, points: [second + depth * normal, second], features: [Feature::vertex(0), feature] }
}

/// The normal between two that is square to an axis, if there is one.
pub(super) fn level_between(begin: &Vector3<f64>, end: &Vector3<f64>, axis: &Vector3<f64>) -> Option<Vector3<f64>> {
    let (rise, other_rise) = (begin.dot(axis), end.dot(axis));
    if rise * other_rise >= 0.0 {
        return None;
    }
    let share = rise / (rise - other_rise);
    let mixed = begin * (1.0 - share) + end * share;
    Some((mixed - mixed.dot(axis) * axis).normalize())
}

/// The points of two lines, by a point and a direction each, that are nearest to each other.
pub(super) fn lines_meet([point, u]: [Vector3<f64>; 2], [other, v]: [Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
    let between = other - point;
    let (uu, uv, vv) = (u.norm_squared(), u.dot(&v), v.norm_squared());
    let determinant = uu * vv - uv * uv;
    let (s, t) = (vv * u.dot(&between) - uv * v.dot(&between), uv * u.dot(&between) - uu * v.dot(&between));
    [point + s / determinant * u, other + t / determinant * v]
}

/// A normal, and the point of a shape that is furthest along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Towards {
    pub normal: Vector3<f64>,
    pub first: Vector3<f64>,
}

impl Towards {
    pub fn of(shape: &impl Round, normal: Vector3<f64>) -> Self {
        Self { normal, first: shape.furthest(&normal) }
    }
}

/// The normals between those of two faces, turned to the shape.
pub(super) struct Arc<'a, R> {
    pub shape: &'a R,
    /// Points of the shape that rule out most arcs, where these are all there is to be looked at.
    pub corners: Option<&'a Corners>,
    pub begin: Towards,
    pub end: Towards,
    /// The corner of the hull at one end.
    pub corner: Vector3<f64>,
}

impl<R: Round> Arc<'_, R> {
    /// Whether the overlap is no less than `bound` along all normals between two of the arc, as far as some points of the shape tell: along any it is no
    /// less than that of any one point, and this, where it is positive, no less than at the worse of both; else no more than so much further below
    /// as normals between are shorter when mixed.
    pub fn is_no_less(&self, begin: &Towards, end: &Towards, bound: f64) -> bool {
        let mixed = begin.normal + end.normal;
        let bound = if bound < 0.0 { bound * 0.5 * mixed.norm() } else { bound };
        let tells = |point: &Vector3<f64>| {
            let off = point - self.corner;
            begin.normal.dot(&off) >= bound && end.normal.dot(&off) >= bound
        };
        self.corners.is_some_and(|corners| tells(corners.along(&mixed)))
            || tells(&begin.first)
            || tells(&end.first)
            || tells(&self.shape.furthest(&mixed))
    }

    fn normal(&self, place: f64) -> Vector3<f64> {
        (self.begin.normal * (1.0 - place) + self.end.normal * place).normalize()
    }

    /// How the overlap changes along the arc, at a place with its normal.
    fn slope(&self, at: &Towards) -> f64 {
        let chord = self.end.normal - self.begin.normal;
        let along = chord - chord.dot(&at.normal) * at.normal;
        (at.first - self.corner).dot(&along)
    }

    /// Which way the overlap becomes less where both shapes are apart along some normal of the arc: below zero if it does further on. Unless normals are brought to
    /// length one it is a convex function, and what is below zero stays one piece with one least value if they are.
    fn uphill(&self, mixed: &Towards) -> f64 {
        let off = mixed.first - self.corner;
        let (chord, overlap) = (self.end.normal - self.begin.normal, off.dot(&mixed.normal));
        let slope = off.dot(&chord);
        if overlap < 0.0 { slope - overlap * mixed.normal.dot(&chord) / mixed.normal.norm_squared() } else { slope }
    }

    /// The normal within the arc at which the overlap is least, where that is less than `bound`, which is no more than zero.
    pub fn least(&self, bound: f64) -> Option<Vector3<f64>> {
        let Self { begin, end, .. } = self;
        if self.uphill(begin) >= 0.0 || self.uphill(end) <= 0.0 || self.is_no_less(begin, end, bound) {
            return None;
        }
        let mixed = |place: f64| Towards::of(self.shape, begin.normal * (1.0 - place) + end.normal * place);
        Some(self.normal(root(|place| self.uphill(&mixed(place)), 0.0, 1.0)))
    }

    /// Tells normals at which the overlap is least, of pieces of the arc where it may be less than what `found` tells when it is asked.
    pub fn minima(&self, found: &mut impl FnMut(Option<Vector3<f64>>) -> f64) {
        let at = |place: f64| Towards::of(self.shape, self.normal(place));
        // Halves of halves: at most one of each size waits.
        let mut waiting = [(0.0, 0.0); HALVES + 1];
        waiting[0] = (0.0, 1.0);
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (low, size) = waiting[count];
            let high = low + size;
            let [begin, end] = if size == 1.0 { [self.begin, self.end] } else { [at(low), at(high)] };
            if self.is_no_less(&begin, &end, found(None)) {
                continue;
            }
            if size > SMALLEST {
                waiting[count] = (low + 0.5 * size, 0.5 * size);
                waiting[count + 1] = (low, 0.5 * size);
                count += 2;
            } else if self.slope(&begin) < 0.0 && self.slope(&end) > 0.0 {
                found(Some(self.normal(root(|place| self.slope(&at(place)), low, high))));
            }
        }
    }
}

/// Where a function changes its sign between two places.
pub(super) fn bisected(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = function(low).signum();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if function(middle).signum() == sign { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// What of a vector is square to an axis, at length one; none of one along it.
pub(super) fn across(vector: &Vector3<f64>) -> Option<Vector3<f64>> {
    let level = Vector3::new(vector.x, vector.y, 0.0);
    Unit::try_new(level, f64::MIN_POSITIVE).map(Unit::into_inner)
}
