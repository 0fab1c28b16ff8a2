//! Tables of a convex mesh.

use myo_model::model;
use nalgebra::Vector3;

/// A convex mesh: the hull's triangles, and the polygons that neighbours were merged into.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    /// Corners (m), in single precision as MuJoCo has them.
    pub(super) vertices: Vec<Vector3<f64>>,
    pub(super) triangles: Vec<Triangle>,
    pub(super) edges: Vec<Edge>,
    pub(super) polygons: Vec<Polygon>,
    /// Of each corner the polygons around it, in their order.
    pub(super) around: Vec<Vec<usize>>,
    /// Of each corner the other ends of its edges, in the order in which they are tried: in each polygon around it the corner before.
    pub(super) neighbours: Vec<Vec<usize>>,
    /// Of each corner the triangles around it.
    pub(super) triangles_around: Vec<Vec<usize>>,
    /// Of each corner the edges that end there.
    pub(super) edges_around: Vec<Vec<usize>>,
    /// Of each corner those at the other ends of its edges, and where they are.
    pub(super) beside: Vec<Vec<(usize, Vector3<f64>)>>,
    /// Corners once more, as many at a time as are compared at once; the last ones are filled up with the first.
    chunks: Vec<[[f64; CHUNK]; 3]>,
    /// Corners that are furthest along directions all around, by the [cell](cell) that a direction is in.
    starts: Vec<usize>,
    /// Corners once more, as lanes read them.
    corners: Vec<[f32; 3]>,
    /// Radius of a ball about the origin that holds it (m).
    pub(super) reach: f64,
}

/// Faces of a box in MuJoCo's order: across x, y and z, each the positive one first, and from the corner that counts. The bits of a corner tell along which
/// axes it is on the positive side.
const BOX_FACES: [[usize; 4]; 6] = [[5, 1, 3, 7], [0, 4, 6, 2], [6, 7, 3, 2], [0, 1, 5, 4], [4, 5, 7, 6], [1, 0, 2, 3]];

/// Corners that are compared at once.
const CHUNK: usize = 4;
/// Cells along each side of a cube's faces.
pub(super) const CELLS: usize = 4;

/// A triangle of the hull.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Triangle {
    /// Counterclockwise as seen from outside.
    pub corners: [usize; 3],
    /// Unit, outward.
    pub normal: Vector3<f64>,
    /// Height of the triangle along the normal (m).
    pub height: f64,
}

/// An edge between two triangles.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Edge {
    pub ends: [usize; 2],
    /// The triangle whose outline goes along it, and that whose goes back.
    pub sides: [usize; 2],
}

/// Triangles that lie nearly in one plane.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polygon {
    /// Counterclockwise as seen from outside.
    pub corners: Vec<usize>,
    /// Unit, outward.
    pub normal: Vector3<f64>,
}

impl Hull {
    /// The tables of a model's hull, so much larger.
    pub fn new(hull: &model::Hull, scale: f64) -> Self {
        let points: Vec<Vector3<f64>> = hull.points.iter().map(|point| scale * point).collect();
        let rounded = |point: &Vector3<f64>| point.map(|x| f64::from(x as f32));
        Self::with_vertices(points.iter().map(rounded).collect(), &points, hull)
    }

    /// A box of these half sides (m), which are not rounded.
    pub fn of_box(half_size: [f64; 3]) -> Self {
        let side =
            |corner: usize, axis: usize| if corner >> axis & 1 == 1 { half_size[axis] } else { -half_size[axis] };
        let points: Vec<Vector3<f64>> = (0..8).map(|corner| [0, 1, 2].map(|axis| side(corner, axis)).into()).collect();
        let halves = |&[a, b, c, d]: &[usize; 4]| [[a, b, c], [a, c, d]];
        let hull = model::Hull {
            points: points.clone(),
            triangles: BOX_FACES.iter().flat_map(halves).collect(),
            polygons: BOX_FACES.iter().map(|corners| corners.to_vec()).collect(),
        };
        // Along x, y and z.
        let neighbours = (0..8).map(|corner| vec![corner ^ 1, corner ^ 2, corner ^ 4]).collect();
        Self { neighbours, ..Self::with_vertices(points.clone(), &points, &hull) }
    }

    /// Corners as they collide, and as normals of polygons are made of them.
    fn with_vertices(vertices: Vec<Vector3<f64>>, points: &[Vector3<f64>], hull: &model::Hull) -> Self {
        let triangle = |&corners: &[usize; 3]| {
            let normal = |of: &[Vector3<f64>]| {
                let [a, b, c] = corners.map(|corner| of[corner]);
                (b - a).cross(&(c - a)).try_normalize(f64::MIN_POSITIVE)
            };
            // Narrow ones may lose their area in rounding.
            let normal = normal(&vertices).or_else(|| normal(points)).unwrap_or_default();
            Triangle { corners, normal, height: normal.dot(&vertices[corners[0]]) }
        };
        // Normals are those of the points before these are rounded.
        let polygon = |corners: &Vec<usize>| {
            let next = corners.iter().cycle().skip(1);
            let sum: Vector3<f64> = corners.iter().zip(next).map(|(&a, &b)| points[a].cross(&points[b])).sum();
            Polygon { corners: corners.clone(), normal: sum.normalize() }
        };
        let (mut around, mut neighbours) = (vec![vec![]; vertices.len()], vec![vec![]; vertices.len()]);
        for (number, corners) in hull.polygons.iter().enumerate() {
            let before = corners.iter().cycle().skip(corners.len().saturating_sub(1));
            for (&corner, &before) in corners.iter().zip(before) {
                around[corner].push(number);
                neighbours[corner].push(before);
            }
        }
        let mut triangles_around = vec![vec![]; vertices.len()];
        for (number, corners) in hull.triangles.iter().enumerate() {
            corners.iter().for_each(|&corner| triangles_around[corner].push(number));
        }
        let edges = edges(&hull.triangles);
        let mut edges_around = vec![vec![]; vertices.len()];
        for (number, edge) in edges.iter().enumerate() {
            edge.ends.iter().for_each(|&end| edges_around[end].push(number));
        }
        let mut beside = vec![vec![]; vertices.len()];
        for [from, to] in edges.iter().map(|edge| edge.ends) {
            beside[from].push((to, vertices[to]));
            beside[to].push((from, vertices[from]));
        }
        let mut hull = Self {
            chunks: chunks(&vertices),
            starts: vec![],
            triangles_around,
            edges_around,
            beside,
            corners: vertices.iter().map(|vertex| vertex.map(|x| x as f32).into()).collect(),
            triangles: hull.triangles.iter().map(triangle).collect(),
            edges,
            polygons: hull.polygons.iter().map(polygon).collect(),
            around,
            neighbours,
            reach: vertices.iter().map(|vertex| vertex.norm()).fold(0.0, f64::max),
            vertices,
        };
        hull.starts = (0..6 * CELLS * CELLS).map(|number| hull.furthest(&middle(number))).collect();
        hull
    }

    /// Radius of a ball about the origin that holds it (m).
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Its corners (m).
    pub fn corners(&self) -> &[[f32; 3]] {
        &self.corners
    }

    /// The corner that is furthest in a direction; the first of several.
    pub(super) fn furthest(&self, direction: &Vector3<f64>) -> usize {
        let (mut best, mut furthest) = ([f64::NEG_INFINITY; CHUNK], [0; CHUNK]);
        for (number, [x, y, z]) in self.chunks.iter().enumerate() {
            for k in 0..CHUNK {
                let height = x[k] * direction.x + y[k] * direction.y + z[k] * direction.z;
                let is_further = height > best[k];
                best[k] = if is_further { height } else { best[k] };
                furthest[k] = if is_further { number } else { furthest[k] };
            }
        }
        let candidates = (0..CHUNK).map(|k| (best[k], furthest[k] * CHUNK + k));
        let first = |one: (f64, usize), other: (f64, usize)| {
            if other.0 > one.0 || other.0 == one.0 && other.1 < one.1 { other } else { one }
        };
        candidates.fold((f64::NEG_INFINITY, 0), first).1
    }

    /// A corner that no neighbour is further in a direction than, found by walking upward from one, or from what is furthest in the middle of the direction's cell; but
    /// for rounding the furthest of all.
    pub(super) fn climbed(&self, direction: &Vector3<f64>, from: Option<usize>) -> usize {
        let from = from.unwrap_or_else(|| self.starts[cell(direction)]);
        let (mut corner, mut height) = (from, self.vertices[from].dot(direction));
        loop {
            let start = corner;
            for (other, at) in &self.beside[start] {
                let other_height = at.dot(direction);
                if other_height > height {
                    (corner, height) = (*other, other_height);
                }
            }
            if corner == start {
                return corner;
            }
        }
    }
}

/// Corners, some at a time.
fn chunks(vertices: &[Vector3<f64>]) -> Vec<[[f64; CHUNK]; 3]> {
    let chunk = |corners: &[Vector3<f64>]| {
        [0, 1, 2].map(|axis| std::array::from_fn(|k| corners.get(k).unwrap_or(&vertices[0])[axis]))
    };
    vertices.chunks(CHUNK).map(chunk).collect()
}

/// The number of the cell of a cube's surface that a direction points at.
pub(super) fn cell(direction: &Vector3<f64>) -> usize {
    let axis = direction.iamax();
    let place = |k: usize| {
        let share = 0.5 + 0.5 * direction[(axis + k) % 3] / direction[axis].abs();
        // No direction at all is in the first cell.
        ((share * CELLS as f64) as usize).min(CELLS - 1)
    };
    let face = 2 * axis + usize::from(direction[axis] < 0.0);
    (face * CELLS + place(1)) * CELLS + place(2)
}

/// The middle of a cell.
pub(super) fn middle(number: usize) -> Vector3<f64> {
    let (face, cell) = (number / (CELLS * CELLS), number % (CELLS * CELLS));
    let axis = face / 2;
    let place = |cell: usize| (2 * cell + 1) as f64 / CELLS as f64 - 1.0;
    let mut direction = Vector3::zeros();
    direction[axis] = if face % 2 == 0 { 1.0 } else { -1.0 };
    direction[(axis + 1) % 3] = place(cell / CELLS);
    direction[(axis + 2) % 3] = place(cell % CELLS);
    direction
}

/// Edges of a closed surface, each once.
fn edges(triangles: &[[usize; 3]]) -> Vec<Edge> {
    let mut begun = std::collections::HashMap::new();
    let mut edges = vec![];
    for (number, &[a, b, c]) in triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            match begun.remove(&(to, from)) {
                Some(first) => edges.push(Edge { ends: [to, from], sides: [first, number] }),
                None => _ = begun.insert((from, to), number),
            }
        }
    }
    edges
}
