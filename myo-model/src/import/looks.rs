//! What is seen of a body, from the meshes of its file.

use super::Names;
use super::muscles::run_over;
use crate::description::Look;
use base64::prelude::{BASE64_STANDARD, Engine};
use myo_mjcf::{Folder, Geom, MeshError, Mjcf, Shape, Triangles};
use std::collections::{BTreeSet, HashMap};

/// Groups up to this one are seen in MuJoCo unless somebody asks for others.
const SEEN: i32 = 2;
/// Most points of a look: a model file is text, and goes with every run.
const MOST_POINTS: usize = 400;
/// Cells along the longest side in which points become one, to begin with; and by how much fewer there are in the next round.
const CELLS: f64 = 96.0;
const COARSER: f64 = 0.85;

/// Most triangles that are read of a file's meshes together.
const MOST_TRIANGLES: usize = 5_000_000;

/// Looks of all shapes and meshes that are seen on bodies, with fewer points each, and what is wrong with meshes that cannot be read. No file outside
/// of a folder is opened, and each mesh is read once.
pub fn looks(mjcf: &Mjcf, folder: &Folder) -> (Vec<Look>, Vec<MeshError>) {
    let (names, wraps) = (Names::of(mjcf), run_over(mjcf));
    let mut meshes = Meshes { mjcf, folder, read: HashMap::new(), triangles: 0 };
    let (mut looks, mut unread) = (vec![], vec![]);
    // What tendons run over is drawn to be understood.
    let is_wrap = |geom: &Geom| geom.name.as_ref().is_some_and(|name| wraps.contains(name.as_str()));
    for (body, geom) in mjcf.geoms().filter(|&(body, geom)| body != 0 && is_seen(geom) && !is_wrap(geom)) {
        let surface = match &geom.mesh {
            // Names are looked up where they count.
            Some(mesh) => meshes.surface(mesh).cloned(),
            None => solid(geom).map(|triangles| Ok(Surface::of(&triangles))),
        };
        match surface {
            Some(Ok(Some(surface))) => looks.push(surface.look(&names.bodies[body], geom)),
            Some(Err(why)) => unread.push(why),
            Some(Ok(None)) | None => {}
        }
    }
    (looks, unread)
}

/// The meshes of a file.
struct Meshes<'a> {
    mjcf: &'a Mjcf,
    folder: &'a Folder,
    read: HashMap<usize, Result<Option<Surface>, MeshError>>,
    /// How many have been read.
    triangles: usize,
}

impl Meshes<'_> {
    /// The surface of the mesh of this name; none without one.
    fn surface(&mut self, name: &str) -> Option<&Result<Option<Surface>, MeshError>> {
        let number = self.mjcf.meshes.iter().position(|mesh| mesh.name.as_deref() == Some(name))?;
        if !self.read.contains_key(&number) {
            let found = self.reads(name, number);
            self.read.insert(number, found);
        }
        self.read.get(&number)
    }

    fn reads(&mut self, name: &str, number: usize) -> Result<Option<Surface>, MeshError> {
        if self.triangles >= MOST_TRIANGLES {
            let what = format!("comes after {MOST_TRIANGLES} triangles of other meshes; no more are read");
            return Err(MeshError::Contents { file: name.to_owned(), what });
        }
        let triangles = self.mjcf.meshes[number].triangles(self.folder)?;
        self.triangles += triangles.faces.len();
        Ok(Surface::of(&triangles))
    }
}

fn is_seen(geom: &Geom) -> bool {
    geom.group() <= SEEN && geom.rgba()[3] > 0.0
}

/// Sides of what is round about an axis, and rings of a ball.
const SIDES: u32 = 16;
const RINGS: u32 = 12;

/// The surface of a solid shape; none of a plane, a height field, and what is fitted to a mesh.
fn solid(geom: &Geom) -> Option<Triangles> {
    if geom.mesh.is_some() {
        return None;
    }
    let [a, b, c] = geom.size();
    let ball = |radius: f64, shift: f64| {
        (0..=RINGS).map(move |ring| {
            let (sin, cos) = (std::f64::consts::PI * f64::from(ring) / f64::from(RINGS)).sin_cos();
            let shift = if 2 * ring < RINGS { -shift } else { shift };
            [radius * sin, shift - radius * cos]
        })
    };
    let whole = [1.0; 3];
    match geom.kind() {
        Shape::Sphere => Some(turned(&ball(a, 0.0).collect::<Vec<_>>(), whole)),
        Shape::Capsule => Some(turned(&ball(a, b).collect::<Vec<_>>(), whole)),
        Shape::Ellipsoid => Some(turned(&ball(1.0, 0.0).collect::<Vec<_>>(), [a, b, c])),
        Shape::Cylinder => Some(turned(&[[0.0, -b], [a, -b], [a, b], [0.0, b]], whole)),
        Shape::Box => Some(block([a, b, c])),
        Shape::Plane | Shape::HeightField | Shape::Mesh | Shape::Sdf => None,
    }
}

/// What a line of radii and heights (m) makes when it turns about z, from below to above, scaled along the axes.
fn turned(line: &[[f64; 2]], scale: [f64; 3]) -> Triangles {
    let points = line.iter().flat_map(|&[radius, height]| {
        (0..SIDES).map(move |side| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(side) / f64::from(SIDES)).sin_cos();
            let place = [radius * cos, radius * sin, height];
            [0, 1, 2].map(|axis| (place[axis] * scale[axis]) as f32)
        })
    });
    let at = |ring: u32, side: u32| ring * SIDES + side % SIDES;
    let faces = (1..line.len() as u32).flat_map(|ring| {
        (0..SIDES).flat_map(move |side| {
            let (a, b, c, d) = (at(ring - 1, side), at(ring - 1, side + 1), at(ring, side + 1), at(ring, side));
            [[a, b, c], [a, c, d]]
        })
    });
    Triangles { points: points.collect(), faces: faces.collect() }
}

/// A box of these half sizes (m).
fn block(half: [f64; 3]) -> Triangles {
    let corner = |k: u32| [0, 1, 2].map(|axis| (if k >> axis & 1 == 1 { half[axis] } else { -half[axis] }) as f32);
    // Seen from outside, counter-clockwise.
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Triangles { points: (0..8).map(corner).collect(), faces: faces.collect() }
}

/// Triangles as a model file has them.
#[derive(Clone)]
struct Surface {
    step: f64,
    points: String,
    faces: String,
}

impl Surface {
    /// None of a mesh that has no extent.
    fn of(triangles: &Triangles) -> Option<Self> {
        let most = triangles.points.iter().flatten().fold(0.0_f64, |most, &x| most.max(f64::from(x).abs()));
        if most <= 0.0 {
            return None;
        }
        let (points, faces) = simplified(triangles);
        let step = most / f64::from(i16::MAX);
        let points = points.iter().flatten().flat_map(|&x| ((x / step).round() as i16).to_le_bytes());
        let faces = faces.iter().flatten().flat_map(|index| index.to_le_bytes());
        let written = |bytes: Vec<u8>| BASE64_STANDARD.encode(bytes);
        Some(Self { step, points: written(points.collect()), faces: written(faces.collect()) })
    }

    fn look(self, body: &str, geom: &Geom) -> Look {
        let Self { step, points, faces } = self;
        Look { body: body.to_owned(), pos: geom.pose.pos(), quat: geom.pose.quat(), step, points, faces }
    }
}

/// The same surface with few points: those that lie in one cell become their middle, and triangles that lose a side go.
///
/// After J. Rossignac and P. Borrel 1993 (doi 10.1007/978-3-642-78114-8_29).
fn simplified(triangles: &Triangles) -> (Vec<[f64; 3]>, Vec<[u16; 3]>) {
    let axis = |axis: usize| triangles.points.iter().map(move |point| f64::from(point[axis]));
    let low = [0, 1, 2].map(|k| axis(k).fold(f64::INFINITY, f64::min));
    let high = [0, 1, 2].map(|k| axis(k).fold(f64::NEG_INFINITY, f64::max));
    let extent = (0..3).map(|k| high[k] - low[k]).fold(f64::MIN_POSITIVE, f64::max);
    let mut cells = CELLS;
    loop {
        let cell_of = |point: &[f32; 3]| [0, 1, 2].map(|k| ((f64::from(point[k]) - low[k]) * cells / extent) as u32);
        let mut known: HashMap<[u32; 3], usize> = HashMap::new();
        let mut sums: Vec<([f64; 3], f64)> = vec![];
        let of: Vec<usize> = triangles
            .points
            .iter()
            .map(|point| {
                let cell = *known.entry(cell_of(point)).or_insert_with(|| {
                    sums.push(([0.0; 3], 0.0));
                    sums.len() - 1
                });
                let (sum, count) = &mut sums[cell];
                (0..3).for_each(|k| sum[k] += f64::from(point[k]));
                *count += 1.0;
                cell
            })
            .collect();
        if sums.len() <= MOST_POINTS {
            let points = sums.iter().map(|(sum, count)| sum.map(|x| x / count)).collect();
            return (points, faces(triangles, &of));
        }
        cells *= COARSER;
    }
}

/// Triangles between cells, each once.
fn faces(triangles: &Triangles, cells: &[usize]) -> Vec<[u16; 3]> {
    let mut seen = BTreeSet::new();
    let moved = triangles.faces.iter().map(|face| face.map(|point| cells[point as usize] as u16));
    let is_face = |&[a, b, c]: &[u16; 3]| a != b && b != c && c != a;
    let is_new = |face: &[u16; 3]| {
        let first = (0..3).min_by_key(|&k| face[k]).unwrap_or(0);
        seen.insert([0, 1, 2].map(|k| face[(first + k) % 3]))
    };
    moved.filter(is_face).filter(is_new).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of many triangles.
    fn ball(rings: u32) -> Triangles {
        let line = |ring: u32| {
            let (sin, cos) = (std::f64::consts::PI * f64::from(ring) / f64::from(rings)).sin_cos();
            [sin, -cos]
        };
        let mut ball = turned(&(0..=rings).map(line).collect::<Vec<_>>(), [1.0; 3]);
        // Each triangle in four, twice.
        for _ in 0..2 {
            let mut points = ball.points.clone();
            let mut middle = |a: u32, b: u32| {
                let between = [0, 1, 2].map(|axis| 0.5 * (points[a as usize][axis] + points[b as usize][axis]));
                points.push(between);
                points.len() as u32 - 1
            };
            let cut = |&[a, b, c]: &[u32; 3]| {
                let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, x, z], [x, b, y], [z, y, c], [x, y, z]]
            };
            let faces = ball.faces.iter().flat_map(cut).collect();
            ball = Triangles { points, faces };
        }
        ball
    }

    fn volume(points: &[[f64; 3]], faces: &[[u16; 3]]) -> f64 {
        let corner = |index: u16| nalgebra::Vector3::from(points[usize::from(index)]);
        faces.iter().map(|&[a, b, c]| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0).sum()
    }

    #[test]
    fn solid_shapes_are_as_large_as_they_are() {
        let near = |triangles: &Triangles, wanted: f64| {
            let (points, faces) = simplified(triangles);
            let found = volume(&points, &faces);
            assert!(found < wanted * (1.0 + 1e-6) && found > 0.93 * wanted, "{found} for {wanted}");
        };
        near(&block([0.1, 0.2, 0.3]), 8.0 * 0.1 * 0.2 * 0.3);
        near(&turned(&[[0.0, -0.3], [0.1, -0.3], [0.1, 0.3], [0.0, 0.3]], [1.0; 3]), std::f64::consts::PI * 0.01 * 0.6);
        let text = r#"<mujoco><worldbody><body>
            <geom type="sphere" size="0.1"/><geom type="capsule" size="0.1 0.2"/><geom type="ellipsoid" size="0.1 0.2 0.3"/>
        </body></worldbody></mujoco>"#;
        let files = std::collections::BTreeMap::from([("a.xml".to_owned(), text.to_owned())]);
        let mjcf = myo_mjcf::read_from(&files, "a.xml", myo_mjcf::Limits::default()).unwrap();
        let ball = 4.0 / 3.0 * std::f64::consts::PI;
        let wanted = [ball * 1e-3, ball * 1e-3 + std::f64::consts::PI * 0.01 * 0.4, ball * 6e-3];
        for ((_, geom), wanted) in mjcf.geoms().zip(wanted) {
            near(&solid(geom).unwrap(), wanted);
        }
    }

    #[test]
    fn a_surface_with_fewer_points_is_still_closed_and_as_large() {
        let fine = ball(20);
        let (points, faces) = simplified(&fine);
        assert!(points.len() <= MOST_POINTS && points.len() > MOST_POINTS / 2, "{}", points.len());
        let fine_points: Vec<[f64; 3]> = fine.points.iter().map(|point| point.map(f64::from)).collect();
        let fine_faces: Vec<[u16; 3]> = fine.faces.iter().map(|face| face.map(|point| point as u16)).collect();
        let (found, whole) = (volume(&points, &faces), volume(&fine_points, &fine_faces));
        assert!((found - whole).abs() < 0.05 * whole, "{found} of {whole}");
        let mut edges: HashMap<[u16; 2], i32> = HashMap::new();
        for &[a, b, c] in &faces {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&sum| sum == 0), "every edge is gone along both ways");
    }
}
