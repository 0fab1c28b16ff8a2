//! What is seen of a body, from the meshes of its file.

use super::Names;
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

/// Looks of all meshes that are seen on bodies, with fewer points each, and what is wrong with those that cannot be read. No file outside of a folder
/// is opened.
pub fn looks(mjcf: &Mjcf, folder: &Folder) -> (Vec<Look>, Vec<MeshError>) {
    let names = Names::of(mjcf);
    let (mut looks, mut unread) = (vec![], vec![]);
    for (body, geom) in mjcf.geoms().filter(|&(body, geom)| body != 0 && is_seen(geom)) {
        let mesh = mjcf.meshes.iter().find(|mesh| mesh.name == geom.mesh);
        match mesh.map(|mesh| mesh.triangles(folder)) {
            Some(Ok(triangles)) => looks.extend(look(names.bodies[body].clone(), geom, &triangles)),
            Some(Err(why)) => unread.push(why),
            // Names are looked up where they count.
            None => {}
        }
    }
    (looks, unread)
}

fn is_seen(geom: &Geom) -> bool {
    geom.kind() == Shape::Mesh && geom.group() <= SEEN && geom.rgba()[3] > 0.0
}

/// None of a mesh that has no extent.
fn look(body: String, geom: &Geom, triangles: &Triangles) -> Option<Look> {
    let most = triangles.points.iter().flatten().fold(0.0_f64, |most, &x| most.max(f64::from(x).abs()));
    if most <= 0.0 {
        return None;
    }
    let (points, faces) = simplified(triangles);
    let step = most / f64::from(i16::MAX);
    let points = points.iter().flatten().flat_map(|&x| ((x / step).round() as i16).to_le_bytes());
    let faces = faces.iter().flatten().flat_map(|index| index.to_le_bytes());
    Some(Look {
        body,
        pos: geom.pose.pos(),
        quat: geom.pose.quat(),
        step,
        points: BASE64_STANDARD.encode(points.collect::<Vec<u8>>()),
        faces: BASE64_STANDARD.encode(faces.collect::<Vec<u8>>()),
    })
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
        let sides = 2 * rings;
        let point = |ring: u32, side: u32| {
            let (up, around) =
                (std::f32::consts::PI * ring as f32 / rings as f32, std::f32::consts::TAU * side as f32 / sides as f32);
            [up.sin() * around.cos(), up.sin() * around.sin(), up.cos()]
        };
        let points = (0..=rings).flat_map(|ring| (0..sides).map(move |side| point(ring, side))).collect();
        let at = |ring: u32, side: u32| ring * sides + side % sides;
        let faces = (0..rings).flat_map(|ring| {
            (0..sides).flat_map(move |side| {
                let (a, b, c, d) = (at(ring, side), at(ring + 1, side), at(ring + 1, side + 1), at(ring, side + 1));
                [[a, b, c], [a, c, d]]
            })
        });
        Triangles { points, faces: faces.collect() }
    }

    #[test]
    fn a_surface_with_fewer_points_is_still_closed_and_as_large() {
        let fine = ball(60);
        let (points, faces) = simplified(&fine);
        assert!(points.len() <= MOST_POINTS && points.len() > MOST_POINTS / 2, "{}", points.len());
        let corner = |index: u16| nalgebra::Vector3::from(points[usize::from(index)]);
        let volume: f64 = faces.iter().map(|&[a, b, c]| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0).sum();
        let whole = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((volume - whole).abs() < 0.05 * whole, "{volume}");
        let mut edges: HashMap<[u16; 2], i32> = HashMap::new();
        for &[a, b, c] in &faces {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&sum| sum == 0), "every edge is gone along both ways");
    }
}
