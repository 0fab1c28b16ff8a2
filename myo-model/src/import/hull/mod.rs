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
    #[error("the hulls of all meshes together have more corners than are looked for; make them coarser")]
    Slow,
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

/// That of triangles; it takes away from the points that may be added to hulls.
pub(super) fn touching(triangles: &Triangles, left: &mut usize) -> Result<Touching, HullError> {
    let (points, faces) = distinct(triangles);
    if points.len() > MOST_POINTS {
        return Err(HullError::ManyPoints(points.len()));
    }
    let hull = convex::hull(&points, left)?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile::hull;
    use crate::model;
    use nalgebra::Matrix3;

    /// Numbers from 0 to 1 that look random.
    struct Draws(u64);

    impl Draws {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// A mesh of points, whose triangles are anything.
    fn mesh(points: Vec<[f64; 3]>) -> Triangles {
        let count = points.len() as u32;
        let points = points.iter().map(|point| point.map(|x| x as f32)).collect();
        Triangles { points, faces: (0..count).map(|k| [k, (k + 1) % count, (k + 2) % count]).collect() }
    }

    /// What is found, checked as a model's is: closed, convex, through all of its corners; with all points of the mesh in it.
    fn checked(mesh: &Triangles) -> Result<model::Hull, HullError> {
        let found = touching(mesh, &mut 100_000)?;
        let hull = hull(0, &found.hull).unwrap();
        for point in &mesh.points {
            let seen = found.frame.inverse_transform_point(&point.map(f64::from).into()).coords;
            for corners in &hull.triangles {
                let [a, b, c] = corners.map(|corner| hull.points[corner]);
                let height = (b - a).cross(&(c - a)).normalize().dot(&(seen - a));
                // Of narrow triangles, whose normal is not known better.
                assert!(height < 1e-7, "{seen} is {height} m outside");
            }
        }
        Ok(hull)
    }

    #[test]
    fn points_on_a_ball_are_all_corners() {
        let mut draws = Draws(1);
        for count in [4, 5, 8, 20, 100, 400] {
            let mut point = || loop {
                let place = Vector3::from_fn(|_, _| 2.0 * draws.next() - 1.0);
                if place.norm() > 0.1 {
                    return place.normalize().into();
                }
            };
            let hull = checked(&mesh((0..count).map(|_| point()).collect())).unwrap();
            assert_eq!((hull.points.len(), hull.triangles.len()), (count, 2 * count - 4));
        }
    }

    #[test]
    fn points_on_a_grid_have_a_hull_though_many_lie_in_one_plane() {
        let mut draws = Draws(2);
        let mut narrow = 0;
        for case in 0..400 {
            let count = 5 + (150.0 * draws.next()) as usize;
            let points = (0..count).map(|_| [0; 3].map(|_| (draws.next() * 5.0).floor() * 0.1)).collect();
            match checked(&mesh(points)) {
                Ok(hull) => assert!(hull.points.len() <= 125, "case {case}"),
                Err(HullError::Narrow) => narrow += 1,
                Err(HullError::Flat | HullError::Few) if count < 15 => {}
                Err(why) => panic!("case {case}: {why}"),
            }
        }
        assert!(narrow == 0, "{narrow} of 400");
    }

    #[test]
    fn sides_of_a_block_are_one_polygon_each() {
        let sides = [0.0, 0.1, 0.2, 0.3];
        let points = sides.iter().flat_map(|&x| sides.iter().flat_map(move |&y| sides.map(|z| [x, y, 2.0 * z])));
        let hull = checked(&mesh(points.collect())).unwrap();
        assert_eq!((hull.points.len(), hull.triangles.len(), hull.polygons.len()), (8, 12, 6));
        assert!(hull.polygons.iter().all(|corners| corners.len() == 4), "{:?}", hull.polygons);
        let volume: f64 = hull
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| hull.points[corner]);
                Matrix3::from_columns(&[a, b, c]).determinant() / 6.0
            })
            .sum();
        assert!((volume - 0.3 * 0.3 * 0.6).abs() < 1e-8, "{volume}");
    }

    #[test]
    fn prisms_and_pyramids_of_many_sides_are_whole() {
        for sides in [3, 4, 16, 64, 200] {
            let rim = |z: f64, radius: f64| {
                (0..sides).map(move |k| {
                    let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
                    [radius * cos, radius * sin, z]
                })
            };
            let prism = checked(&mesh(rim(-0.1, 0.05).chain(rim(0.1, 0.05)).collect())).unwrap();
            assert_eq!(prism.points.len(), 2 * sides as usize);
            let pyramid = checked(&mesh(rim(0.0, 0.05).chain([[0.0, 0.0, 0.2]]).collect())).unwrap();
            assert_eq!(pyramid.points.len(), sides as usize + 1);
        }
    }

    #[test]
    fn what_has_no_hull_is_told() {
        let few = mesh(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(touching(&few, &mut 9).unwrap_err(), HullError::Few);
        let same = mesh(vec![[1.0, 2.0, 3.0]; 50]);
        assert_eq!(touching(&same, &mut 9).unwrap_err(), HullError::Few);
        let flat = |z: fn(f64, f64) -> f64| {
            let mut draws = Draws(3);
            mesh((0..50).map(|_| [draws.next(), draws.next()]).map(|[x, y]| [x, y, z(x, y)]).collect())
        };
        assert_eq!(touching(&flat(|_, _| 0.0), &mut 9).unwrap_err(), HullError::Flat);
        // Single precision has no points in this plane but near it, whose hull is thin.
        assert!(touching(&flat(|x, y| x + 0.3 * y), &mut 99).is_ok());
        let line = mesh((0..50).map(|k| [f64::from(k), 2.0 * f64::from(k), 0.0]).collect());
        assert_eq!(touching(&line, &mut 9).unwrap_err(), HullError::Flat);
        let mut draws = Draws(4);
        let hundred = mesh((0..100).map(|_| [0; 3].map(|_| draws.next())).collect());
        assert_eq!(touching(&hundred, &mut 9).unwrap_err(), HullError::Slow);
        let many = mesh((0..100_001).map(|_| [0; 3].map(|_| draws.next())).collect());
        assert_eq!(touching(&many, &mut 9).unwrap_err(), HullError::ManyPoints(100_001));
    }
}
