//! From the triangles of a mesh to what of it touches: its convex hull, with polygons, in a frame of its own; as MuJoCo's compiler makes it.

mod convex;
mod facets;
mod frame;
mod merged;
mod order;
mod simplex;

use crate::compile::MOST_CORNERS;
use crate::description::Hull;
use base64::prelude::{BASE64_STANDARD, Engine};
use myo_mjcf::Triangles;
use nalgebra::{Isometry3, Translation3, Vector3};
use std::collections::HashMap;

/// Most points of which a hull is made: what is beyond takes long, and is no bone.
const MOST_POINTS: usize = 100_000;

/// Why a mesh has no hull.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum HullError {
    #[error("it has fewer than four different points")]
    Few,
    #[error("it is flat, or nothing")]
    Flat,
    #[error("its points are so near to one plane that rounding decides what their hull is")]
    Narrow,
    #[error("it has {0} different points; hulls are made of at most {MOST_POINTS}")]
    ManyPoints(usize),
    #[error("its hull has {0} corners; at most {MOST_CORNERS} are simulated; make it coarser")]
    ManyCorners(usize),
}

/// What of a mesh touches.
#[derive(Clone, Debug)]
pub(super) struct Touching {
    pub hull: Hull,
    /// Its frame in that of the mesh.
    pub frame: Isometry3<f64>,
    /// Radius of a ball about its origin that holds it (m).
    pub reach: f64,
}

/// That of triangles.
pub(super) fn touching(triangles: &Triangles) -> Result<Touching, HullError> {
    let (points, faces) = distinct(triangles);
    if points.len() > MOST_POINTS {
        return Err(HullError::ManyPoints(points.len()));
    }
    let hull = convex::hull(&points)?;
    let polygons = merged::polygons(&points, &hull);
    let corners: Vec<[Vector3<f64>; 3]> = faces.iter().map(|face| face.map(|point| points[point])).collect();
    let frame = frame::frame(&corners)?;
    let mut used: Vec<usize> = hull.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    if used.len() > MOST_CORNERS {
        return Err(HullError::ManyCorners(used.len()));
    }
    let place = |point: &usize| used.binary_search(point).unwrap_or(0);
    let own: Vec<Vector3<f64>> =
        used.iter().map(|&point| frame.rotation.tr_mul(&(points[point] - frame.position))).collect();
    let reach = own.iter().map(Vector3::norm).fold(0.0, f64::max);
    let triangles = hull.iter().flatten().map(place);
    let polygons = polygons.iter().flat_map(|corners| std::iter::once(corners.len()).chain(corners.iter().map(place)));
    let hull = Hull {
        points: BASE64_STANDARD.encode(own.iter().flatten().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>()),
        triangles: words(triangles),
        polygons: words(polygons),
    };
    let frame = Isometry3::from_parts(Translation3::from(frame.position), frame.quaternion);
    Ok(Touching { hull, frame, reach })
}

/// Numbers as a model file has them.
fn words(numbers: impl Iterator<Item = usize>) -> String {
    BASE64_STANDARD.encode(numbers.flat_map(|number| (number as u16).to_le_bytes()).collect::<Vec<u8>>())
}

/// Points of triangles in the order in which they come first, equal ones once, and triangles of these.
fn distinct(triangles: &Triangles) -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
    let (mut known, mut points) = (HashMap::new(), vec![]);
    let mut number = |point: u32| {
        // Zero is zero whatever its sign.
        let place = triangles.points[point as usize].map(|x| f64::from(x) + 0.0);
        *known.entry(place.map(f64::to_bits)).or_insert_with(|| {
            points.push(Vector3::from(place));
            points.len() - 1
        })
    };
    let faces = triangles.faces.iter().map(|face| face.map(&mut number)).collect();
    (points, faces)
}
