//! What is found quickly is what trying everything finds; and what is found is the least way out.

mod searches;

use super::cylinder::Cylinder;
use super::ellipsoid::Ellipsoid;
use super::hull::{CELLS, Hull, cell, middle};
use super::placed::{Feature, Placed};
use super::round::Round;
use super::scratch::Scratch;
use super::touch::{Touch, hulls, least_overlap};
use super::{MOST_CONTACTS, Other, Place, contacts};
use myo_model::Model;
use myo_model::description::Landmarks;
use myo_model::import::{ImportOptions, from_mjcf};
use nalgebra::{UnitQuaternion, Vector3};
use std::collections::BTreeMap;

/// Numbers from -1 to 1 that look random.
pub(super) struct Draws(pub u64);

impl Draws {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.next())
    }

    /// Anywhere within a distance (m), turned any way.
    pub fn place(&mut self, distance: f64) -> Place {
        let turn = UnitQuaternion::from_scaled_axis(4.0 * self.vector());
        Place { rotation: turn.to_rotation_matrix().into_inner(), position: distance * self.vector() }
    }
}

/// Convex rocks of so many points, a decimetre or two large.
fn rocks(counts: [usize; 2]) -> [Hull; 2] {
    let mut draws = Draws(3);
    let mut point = |_| 0.1 * draws.vector().normalize().component_mul(&Vector3::new(1.0, 0.7, 0.4));
    hulls_of(counts.map(|count| (0..count).map(&mut point).collect()))
}

/// Hulls of points, another number of each.
fn hulls_of(points: [Vec<Vector3<f64>>; 2]) -> [Hull; 2] {
    let counts = points.each_ref().map(Vec::len);
    let asset = |points: Vec<Vector3<f64>>| {
        let count = points.len();
        let points: Vec<String> =
            points.iter().flat_map(|point| [point.x, point.y, point.z]).map(|x| x.to_string()).collect();
        let face = |k: usize| format!("{k} {} {}", (k + 1) % count, (k + 2) % count);
        let faces: Vec<String> = (0..count).map(face).collect();
        format!("<mesh name=\"rock{count}\" vertex=\"{}\" face=\"{}\"/>", points.join(" "), faces.join(" "))
    };
    let assets = points.map(asset).concat();
    let body = |count: usize| {
        format!(
            "<body name=\"body{count}\"><freejoint/><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>\
             <site name=\"tip{count}\"/><geom type=\"mesh\" mesh=\"rock{count}\"/></body>"
        )
    };
    let bodies = counts.map(body).concat();
    let text = format!("<mujoco><asset>{assets}</asset><worldbody>{bodies}</worldbody></mujoco>");
    let files = BTreeMap::from([("rocks.xml".to_owned(), text)]);
    let mjcf = myo_mjcf::read_from(&files, "rocks.xml", myo_mjcf::Limits::default()).unwrap();
    let landmarks = Landmarks::new(&format!("tip{}", counts[0]), &format!("body{}", counts[0]));
    let model = Model::new(&from_mjcf(&mjcf, &ImportOptions::new(landmarks)).unwrap()).unwrap();
    [0, 1].map(|number| Hull::new(&model.hulls[number], 1.0))
}

fn placed<'a>(hull: &'a Hull, place: &Place) -> Placed<'a> {
    Placed { hull, rotation: place.rotation, position: place.position }
}

#[test]
fn the_furthest_corner_is_the_first_of_those_that_no_other_is_beyond() {
    let [rock, other] = rocks([30, 41]);
    let mut draws = Draws(21);
    // Several corners of a box are as far along an axis, and all along no direction.
    let axes = (0..3).flat_map(|axis| [Vector3::ith(axis, 1.0), Vector3::ith(axis, -1.0)]);
    let directions: Vec<Vector3<f64>> =
        axes.chain([Vector3::zeros()]).chain((0..2000).map(|_| draws.vector())).collect();
    for hull in [&rock, &other, &Hull::of_box([0.1, 0.2, 0.3])] {
        for direction in &directions {
            let heights: Vec<f64> = hull.vertices.iter().map(|corner| corner.dot(direction)).collect();
            let top = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(Some(hull.furthest(direction)), heights.iter().position(|&height| height == top), "{direction}");
            // Corners are rounded to single precision, so that a hull is convex but for that.
            assert!(heights[hull.climbed(direction, None)] > top - 1e-8, "{direction}");
        }
    }
}

#[test]
fn every_direction_is_in_a_cell_whose_middle_is_near() {
    for number in 0..6 * CELLS * CELLS {
        assert_eq!(cell(&middle(number)), number);
    }
    let mut draws = Draws(22);
    for _ in 0..2000 {
        let direction = draws.vector().normalize();
        assert!(middle(cell(&direction)).normalize().dot(&direction) > 0.9, "{direction}");
    }
}

/// How far two hulls overlap along a direction.
fn overlap(one: &Placed<'_>, other: &Placed<'_>, normal: &Vector3<f64>) -> f64 {
    (one.vertex(one.furthest(normal)) - other.vertex(other.furthest(&-normal))).dot(normal)
}

/// The least overlap along normals of faces and of all pairs of edges, whether their arcs cross or not: others have no less.
fn least_of_all(one: &Placed<'_>, other: &Placed<'_>) -> f64 {
    let faces = (0..one.hull.triangles.len()).map(|k| one.triangle_normal(k));
    let other_faces = (0..other.hull.triangles.len()).map(|k| -other.triangle_normal(k));
    let along = |placed: &Placed<'_>, ends: [usize; 2]| placed.vertex(ends[1]) - placed.vertex(ends[0]);
    let edges = one.hull.edges.iter().flat_map(|edge| {
        let own = along(one, edge.ends);
        other
            .hull
            .edges
            .iter()
            .filter_map(move |other_edge| own.cross(&along(other, other_edge.ends)).try_normalize(1e-12))
    });
    let both_ways = |normal: Vector3<f64>| overlap(one, other, &normal).min(overlap(one, other, &-normal));
    let least = faces.chain(other_faces).map(|normal| overlap(one, other, &normal));
    least.chain(edges.map(both_ways)).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_least_way_out_of_two_hulls_is_that_of_all() {
    let [one, other] = &rocks([12, 20]);
    let (mut draws, mut scratch) = (Draws(5), Scratch::new([one, other].into_iter()));
    let mut kinds = BTreeMap::new();
    for case in 0..300 {
        let (one, other) = (placed(one, &draws.place(0.01)), placed(other, &draws.place(0.08)));
        let least = least_of_all(&one, &other);
        let touch = least_overlap(&one, &other, &mut scratch);
        // Where they are apart along a face, edges are not looked at.
        if least <= 0.0 {
            assert!(touch.depth <= 0.0, "case {case}");
            continue;
        }
        assert!((touch.depth - least).abs() < 1e-12, "case {case}: {} for {least}", touch.depth);
        assert!((overlap(&one, &other, &touch.normal) - touch.depth).abs() < 1e-12, "case {case}");
        let [first, second] = touch.points;
        assert!((first - second - touch.depth * touch.normal).norm() < 1e-9, "case {case}");
        *kinds.entry(touch.features.map(|feature| feature.size)).or_insert(0) += 1;
        // Moved out of it, they touch nowhere.
        let moved = Placed { position: other.position + (touch.depth + 1e-9) * touch.normal, ..other };
        assert!(least_overlap(&one, &moved, &mut scratch).depth <= 1e-12, "case {case}");
    }
    assert_eq!(kinds.keys().copied().collect::<Vec<_>>(), [[1, 3], [2, 2], [3, 1]], "{kinds:?}");
    assert!(kinds.values().all(|&count| count > 20), "{kinds:?}");
}

#[test]
fn nearest_points_of_hulls_are_as_far_apart_as_these() {
    let [one, other] = &rocks([12, 20]);
    let (mut draws, mut scratch) = (Draws(6), Scratch::new([one, other].into_iter()));
    let (mut found, mut sizes) = (0, BTreeMap::new());
    for case in 0..3000 {
        let (one, other) = (placed(one, &draws.place(0.01)), placed(other, &draws.place(0.2)));
        let reach = 0.02;
        let Touch { depth, normal, points: [first, second], features } =
            hulls(&one, &other, &draws.vector(), reach, &mut scratch);
        if depth <= -reach {
            // A direction proves it, if a rough one.
            assert!(least_of_all(&one, &other) <= 0.0, "case {case}");
            continue;
        }
        if depth > 0.0 {
            continue;
        }
        found += 1;
        // Points of both, and a direction along which nothing is nearer.
        assert!((second - first + depth * normal).norm() < 1e-9, "case {case}");
        assert!((overlap(&one, &other, &normal) - depth).abs() < 1e-9 && depth > -reach, "case {case}");
        *sizes.entry(features.map(|feature| feature.size)).or_insert(0) += 1;
    }
    assert!(found > 150 && sizes.len() >= 5, "{found}, {sizes:?}");
}

/// Nothing overlaps less than what is found, as far as random directions tell, and what is found is an overlap.
fn is_least<R: Round>(shape: &R, mesh: &Placed<'_>, touch: &Touch, draws: &mut Draws) {
    let overlap = |normal: &Vector3<f64>| (shape.furthest(normal) - mesh.vertex(mesh.furthest(&-normal))).dot(normal);
    assert!((overlap(&touch.normal) - touch.depth).abs() < 1e-9, "{touch:?}");
    let (mut best, mut step) = (touch.normal, 1.0);
    for _ in 0..400 {
        let normal = (best + step * draws.vector()).normalize();
        assert!(overlap(&normal) > touch.depth - 1e-9, "{} along {normal}, {touch:?}", overlap(&normal));
        step *= 0.95;
        if overlap(&normal) < overlap(&best) {
            best = normal;
        }
    }
}

#[test]
fn the_least_way_out_of_round_shapes_is_that_of_all_directions() {
    let [hull, _] = &rocks([30, 5]);
    let (mut draws, mut scratch) = (Draws(7), Scratch::new([hull].into_iter()));
    let cylinder = Cylinder { radius: 0.05, half_length: 0.04 };
    let ellipsoid = Ellipsoid { radii: Vector3::new(0.04, 0.1, 0.07) };
    for _ in 0..300 {
        let mesh = placed(hull, &draws.place(0.15));
        is_least(&cylinder, &mesh, &cylinder.touch(&mesh, &mut scratch), &mut draws);
        is_least(&ellipsoid, &mesh, &ellipsoid.touch(&mesh, &mut scratch), &mut draws);
    }
}

#[test]
fn contacts_are_whole_numbers_wherever_a_mesh_is() {
    let [one, other] = &rocks([60, 9]);
    let (mut draws, mut scratch) = (Draws(8), Scratch::new([one, other].into_iter()));
    let shapes = [
        Other::Plane,
        Other::Cylinder { radius: 0.03, half_length: 0.2 },
        Other::Ellipsoid { radii: [0.01, 0.1, 0.05] },
        Other::Capsule { radius: 0.02, half_length: 0.1 },
        Other::Mesh(other),
        Other::Mesh(one),
    ];
    for shape in shapes {
        let mut counts = [0; MOST_CONTACTS + 1];
        for case in 0..500 {
            let mut place = draws.place(0.2);
            // In the same place, too, or right over it.
            match case % 20 {
                0 => place = Place { rotation: nalgebra::Matrix3::identity(), position: Vector3::zeros() },
                1 => place = Place { rotation: nalgebra::Matrix3::identity(), position: 0.1 * Vector3::z() },
                _ => {}
            }
            let found = contacts(shape, one, &place, &mut draws.vector(), 0.001, &mut scratch);
            for contact in found.iter() {
                let numbers = [contact.distance, contact.normal.norm_squared(), contact.at.norm()];
                assert!(numbers.iter().all(|x| x.is_finite()), "{shape:?}: {contact:?}");
                assert!(contact.distance <= 0.001 && (numbers[1] - 1.0).abs() < 1e-9, "{shape:?}: {contact:?}");
            }
            counts[found.iter().count()] += 1;
        }
        assert!(counts[0] > 20 && counts[1..].iter().sum::<i32>() > 20, "{shape:?}: {counts:?}");
    }
}

#[test]
fn a_feature_has_the_polygons_it_is_a_part_of() {
    let [hull, _] = &rocks([40, 5]);
    for edge in &hull.edges {
        let polygons: Vec<usize> = Feature::edge(edge.ends).polygons(hull).collect();
        assert!((1..=2).contains(&polygons.len()), "{polygons:?}");
    }
    for triangle in &hull.triangles {
        assert_eq!(Feature::triangle(triangle.corners).polygons(hull).count(), 1);
    }
    for vertex in 0..hull.vertices.len() {
        let feature = Feature::vertex(vertex);
        assert_eq!(feature.polygons(hull).count(), feature.edge_ends(hull).count());
    }
}

/// A body that went to ruin is found by its state; looking for its contacts must end.
#[test]
fn a_search_ends_wherever_numbers_are_none() {
    let [one, other] = &rocks([40, 30]);
    let mut scratch = Scratch::new([one, other].into_iter());
    let shapes = [
        Other::Plane,
        Other::Cylinder { radius: 0.03, half_length: 0.2 },
        Other::Ellipsoid { radii: [0.01, 0.1, 0.05] },
        Other::Capsule { radius: 0.02, half_length: 0.1 },
        Other::Mesh(other),
    ];
    let whole = Place { rotation: nalgebra::Matrix3::identity(), position: Vector3::zeros() };
    for number in [f64::NAN, f64::INFINITY] {
        let turned = Place { rotation: nalgebra::Matrix3::repeat(number), ..whole };
        let moved = Place { position: Vector3::repeat(number), ..whole };
        for (shape, place) in shapes.iter().flat_map(|shape| [(shape, &turned), (shape, &moved)]) {
            let mut towards = place.position;
            let found = contacts(*shape, one, place, &mut towards, 0.001, &mut scratch);
            assert!(found.iter().count() <= MOST_CONTACTS, "{shape:?}");
        }
    }
}
