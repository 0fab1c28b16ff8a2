//! Convex meshes: whether they are whole, closed and convex.

use crate::check::{Bound, Check};
use crate::description::{self as source, ModelDescription};
use crate::error::{ElementKind, ModelError};
use crate::model::Hull;
use base64::prelude::{BASE64_STANDARD, Engine};
use nalgebra::Vector3;
use std::collections::HashSet;

/// Most corners: what touches is looked for among pairs of triangles and corners.
pub(crate) const MOST_CORNERS: usize = 2000;
/// By how much of its size a corner may be outside of a triangle's plane.
const BULGE: f64 = 1e-6;

/// All convex meshes of a description.
pub(super) fn hulls(description: &ModelDescription) -> Result<Vec<Hull>, ModelError> {
    description.hulls.iter().enumerate().map(|(number, written)| hull(number, written)).collect()
}

pub(crate) fn hull(number: usize, written: &source::Hull) -> Result<Hull, ModelError> {
    let check = Check::new(ElementKind::Hull, &number.to_string());
    let bad = |what: String| ModelError::BadHull { element: check.element.clone(), what };
    let hull = read(written).map_err(bad)?;
    for point in &hull.points {
        check.within("points", point.as_slice(), &Bound::LENGTH)?;
    }
    whole(&hull).map_err(bad)?;
    Ok(hull)
}

/// What stands in the lists.
fn read(written: &source::Hull) -> Result<Hull, String> {
    let bytes = |list: &str, text: &str, size: usize| match BASE64_STANDARD.decode(text) {
        Err(why) => Err(format!("`{list}` is not in base 64: {why}")),
        Ok(bytes) if bytes.len() % size != 0 => Err(format!("`{list}` is no list of {size} bytes each")),
        Ok(bytes) => Ok(bytes),
    };
    let words = |list: &str, text: &str, size: usize| {
        let word = |pair: &[u8]| usize::from(u16::from_le_bytes([pair[0], pair[1]]));
        bytes(list, text, size).map(|bytes| bytes.chunks_exact(2).map(word).collect::<Vec<usize>>())
    };
    let points = bytes("points", &written.points, 24)?;
    let number = |bytes: &[u8]| bytes.try_into().map_or(f64::NAN, f64::from_le_bytes);
    let point = |bytes: &[u8]| Vector3::new(number(&bytes[..8]), number(&bytes[8..16]), number(&bytes[16..]));
    Ok(Hull {
        points: points.chunks_exact(24).map(point).collect(),
        triangles: words("triangles", &written.triangles, 6)?.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        polygons: polygons(&words("polygons", &written.polygons, 2)?)?,
    })
}

/// Polygons of a list that says of each how many corners it has.
fn polygons(mut words: &[usize]) -> Result<Vec<Vec<usize>>, String> {
    let mut polygons = vec![];
    while let Some((&count, rest)) = words.split_first() {
        let (corners, rest) = rest
            .split_at_checked(count)
            .ok_or_else(|| format!("`polygons` ends before polygon {} does", polygons.len()))?;
        polygons.push(corners.to_vec());
        words = rest;
    }
    Ok(polygons)
}

/// Whether a hull is one.
fn whole(hull: &Hull) -> Result<(), String> {
    let Hull { points, triangles, polygons } = hull;
    if !(4..=MOST_CORNERS).contains(&points.len()) {
        return Err(format!("it has {} corners; from 4 to {MOST_CORNERS} are simulated", points.len()));
    }
    if let Some(corner) = triangles.iter().flatten().chain(polygons.iter().flatten()).find(|&&k| k >= points.len()) {
        return Err(format!("corner {corner}, counted from 0, is not there; it has {}", points.len()));
    }
    // Euler's formula for closed surfaces without holes.
    if triangles.len() + 4 != 2 * points.len() || !is_closed(triangles) {
        return Err("its triangles are no closed surface through all of its corners".into());
    }
    let size = points.iter().map(Vector3::norm).fold(0.0, f64::max);
    for (number, corners) in triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|corner| points[corner]);
        let normal = (b - a).cross(&(c - a)).try_normalize(f64::MIN_POSITIVE);
        let normal = normal.ok_or_else(|| format!("triangle {number}, counted from 0, has no area"))?;
        if points.iter().any(|point| normal.dot(&(point - a)) > BULGE * size) {
            return Err(format!("it is not convex: corners are outside of triangle {number}, counted from 0"));
        }
    }
    let is_flat = |corners: &Vec<usize>| {
        let distinct: HashSet<_> = corners.iter().collect();
        distinct.len() < corners.len().max(3) || newell(corners, points).norm() < f64::MIN_POSITIVE
    };
    match polygons.iter().position(is_flat) {
        Some(number) => Err(format!("polygon {number}, counted from 0, has no area, or a corner twice")),
        None => Ok(()),
    }
}

/// Whether every edge is gone along once each way.
fn is_closed(triangles: &[[usize; 3]]) -> bool {
    let edges: HashSet<[usize; 2]> = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    edges.len() == 3 * triangles.len() && edges.iter().all(|&[from, to]| edges.contains(&[to, from]))
}

/// Twice the area of a polygon as a vector, after Newell.
fn newell(corners: &[usize], points: &[Vector3<f64>]) -> Vector3<f64> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(&a, &b)| points[a].cross(&points[b])).sum()
}
