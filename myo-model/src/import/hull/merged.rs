//! Triangles merged into polygons, as MuJoCo's compiler does it: those whose normals have the same angles, rounded, and hang together.

use super::order::Table;
use nalgebra::Vector3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// What angles are rounded to (rad).
const ANGLE: f64 = 0.01;
/// A normal is that of an end of z if its cosine with it is at least this near to one.
const UPRIGHT: f64 = 1e-7;
/// Twice the area of triangles that have none (m^2).
const NOTHING: f64 = 1e-15;

/// Polygons of a hull's triangles. Their outlines count: what corner is within is lost.
pub(super) fn polygons(points: &[Vector3<f64>], triangles: &[[usize; 3]]) -> Vec<Vec<usize>> {
    let mut table = Table::default();
    let (mut numbers, mut merged): (HashMap<[u64; 2], usize>, Vec<Merged>) = (HashMap::new(), vec![]);
    for &triangle in triangles {
        let Some(key) = angles(points, triangle) else { continue };
        match numbers.get(&key.map(f64::to_bits)) {
            Some(&number) => merged[number].add(triangle),
            None => {
                numbers.insert(key.map(f64::to_bits), merged.len());
                table.add(merged.len(), key);
                merged.push(Merged::new(triangle));
            }
        }
    }
    table.numbers().flat_map(|number| merged[number].outlines()).collect()
}

/// Azimuth and polar angle of a triangle's normal, in units of what they are rounded to; none of one without area.
fn angles(points: &[Vector3<f64>], [a, b, c]: [usize; 3]) -> Option<[f64; 2]> {
    let normal = (points[b] - points[a]).cross(&(points[c] - points[a])).try_normalize(NOTHING)?;
    if normal.z.abs() > 1.0 - UPRIGHT {
        return Some([0.0, if normal.z < 0.0 { (PI / ANGLE).round() } else { 0.0 }]);
    }
    // Nothing is zero whatever its sign.
    Some([(normal.y + 0.0).atan2(normal.x + 0.0) / ANGLE, normal.z.acos() / ANGLE].map(|angle| angle.round() + 0.0))
}

/// Sides of triangles that were merged, each with the number of its island.
struct Merged {
    sides: Vec<([usize; 2], usize)>,
    islands: usize,
}

fn sides([a, b, c]: [usize; 3]) -> [[usize; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

impl Merged {
    fn new(triangle: [usize; 3]) -> Self {
        Self { sides: sides(triangle).map(|side| (side, 0)).to_vec(), islands: 1 }
    }

    fn add(&mut self, triangle: [usize; 3]) {
        let (mut island, mut new) = (None, vec![]);
        for [from, to] in sides(triangle) {
            let Some(place) = self.sides.iter().position(|&(side, _)| side == [to, from]) else {
                new.push([from, to]);
                continue;
            };
            let (_, found) = self.sides.remove(place);
            island = match island {
                Some(own) if own != found => Some(self.join(own, found)),
                _ => Some(found),
            };
        }
        let island = island.unwrap_or_else(|| {
            self.islands += 1;
            self.islands - 1
        });
        self.sides.extend(new.into_iter().map(|side| (side, island)));
    }

    /// Makes one island of two, and tells its number.
    fn join(&mut self, one: usize, other: usize) -> usize {
        let (low, high) = (one.min(other), one.max(other));
        for (_, island) in &mut self.sides {
            *island = if *island == high { low } else { *island - usize::from(*island > high) };
        }
        self.islands -= 1;
        low
    }

    /// The outline of each island, as far as it is closed.
    fn outlines(&self) -> Vec<Vec<usize>> {
        (0..self.islands).filter_map(|island| self.outline(island)).filter(|outline| outline.len() >= 3).collect()
    }

    fn outline(&self, island: usize) -> Option<Vec<usize>> {
        let (first, _) = self.sides.iter().find(|(_, own)| *own == island)?;
        let mut outline = first.to_vec();
        for _ in 0..self.sides.len() {
            let last = *outline.last()?;
            let follows = |(side, own): &&([usize; 2], usize)| *own == island && side[0] == last;
            let (side, _) = self.sides.iter().skip(1).find(follows)?;
            if side[1] == outline[0] {
                return Some(outline);
            }
            outline.push(side[1]);
        }
        None
    }
}
