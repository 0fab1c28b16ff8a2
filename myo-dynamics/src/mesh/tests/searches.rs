//! What grows or walks finds what trying everything finds, wherever it begins.

use super::*;
use crate::mesh::difference;

/// A convex body of so many points on an ellipsoid.
fn pebble(draws: &mut Draws, count: usize, semiaxes: [f64; 3]) -> Vec<Vector3<f64>> {
    (0..count).map(|_| draws.vector().normalize().component_mul(&Vector3::from(semiaxes))).collect()
}

fn block(half: [f64; 3]) -> Vec<Vector3<f64>> {
    let side = |number: usize, axis: usize| if number >> axis & 1 == 0 { half[axis] } else { -half[axis] };
    (0..8).map(|number| Vector3::from_fn(|axis, _| side(number, axis))).collect()
}

/// Bodies of many kinds: round, thin, narrow, and with sides in one plane.
fn bodies() -> Vec<[Hull; 2]> {
    let mut draws = Draws(12);
    vec![
        hulls_of([pebble(&mut draws, 40, [0.1, 0.07, 0.04]), pebble(&mut draws, 70, [0.05, 0.08, 0.06])]),
        hulls_of([pebble(&mut draws, 30, [0.1, 0.07, 0.0005]), pebble(&mut draws, 50, [0.1, 0.08, 0.06])]),
        hulls_of([pebble(&mut draws, 12, [0.2, 0.002, 0.001]), pebble(&mut draws, 20, [0.001, 0.15, 0.002])]),
        hulls_of([block([0.1, 0.06, 0.03]), pebble(&mut draws, 25, [0.1, 0.08, 0.06])]),
    ]
}

#[test]
fn a_surface_grows_into_the_least_way_out() {
    for [one, other] in &bodies() {
        let mut scratch = Scratch::new([one, other].into_iter());
        let (mut draws, mut grown, mut overlapping) = (Draws(13), 0, 0);
        for case in 0..1000 {
            let distance = [0.0, 0.02, 0.1, 0.15][case % 4];
            let (one, other) = (placed(one, &draws.place(0.01)), placed(other, &draws.place(distance)));
            let wanted = least_overlap(&one, &other, &mut scratch);
            overlapping += usize::from(wanted.depth > 0.0);
            // None is rare, and then everything is tried.
            let Some(found) = difference::least(&one, &other, &draws.vector(), &mut scratch) else { continue };
            grown += 1;
            assert_eq!(found.depth > 0.0, wanted.depth > 0.0, "case {case}: {found:?}, {wanted:?}");
            if wanted.depth > 0.0 {
                assert!((found.depth - wanted.depth).abs() < 1e-12, "case {case}: {found:?}, {wanted:?}");
            }
            assert!(overlap(&one, &other, &found.normal) <= found.depth + 1e-12, "case {case}: {found:?}");
        }
        assert!(grown > 400 && overlapping > 50, "{grown}, {overlapping}");
    }
}

#[test]
fn walks_of_cylinders_find_what_trying_everything_finds() {
    let cylinders = [[0.05, 0.04], [0.3, 0.02], [0.01, 0.3], [1.0, 0.2]];
    for [one, other] in &bodies() {
        let (mut draws, mut scratch) = (Draws(14), Scratch::new([one, other].into_iter()));
        let (mut overlapping, mut near) = (0, 0);
        for case in 0..1200 {
            let [radius, half_length] = cylinders[case % 4];
            let cylinder = Cylinder { radius, half_length };
            // About the surface, half of them around an edge of it.
            let (rim, side) = (Vector3::new(radius, 0.0, half_length), 0.5 * (draws.next() + 1.0));
            let about = if case % 8 < 4 { rim } else { Vector3::new(side * radius, 0.0, half_length) };
            let mut place = draws.place(0.12);
            place.position += about;
            let mesh = placed([one, other][case % 2], &place);
            let wanted = cylinder.touch(&mesh, &mut scratch);
            let found = cylinder.nearest(&mesh, &draws.vector(), &mut scratch);
            overlapping += usize::from(wanted.depth > 0.0);
            near += usize::from(wanted.depth <= 0.0);
            assert!((found.depth - wanted.depth).abs() < 1e-9, "case {case}: {found:?}, {wanted:?}");
        }
        assert!(overlapping > 300 && near > 100, "{overlapping}, {near}");
    }
}

/// Contacts come out the same wherever a search begins; ends of an edge may come in either order.
#[test]
fn where_a_search_begins_does_not_count() {
    let [one, other] = &rocks([60, 9]);
    let (mut draws, mut scratch) = (Draws(15), Scratch::new([one, other].into_iter()));
    let shapes = [
        Other::Plane,
        Other::Cylinder { radius: 0.3, half_length: 0.2 },
        Other::Ellipsoid { radii: [0.1, 0.2, 0.15] },
        Other::Capsule { radius: 0.02, half_length: 0.1 },
        Other::Mesh(other),
    ];
    for shape in shapes {
        let mut touching = 0;
        for case in 0..500 {
            let place = draws.place(0.2);
            let mut all = |mut towards: Vector3<f64>| {
                let found = contacts(shape, one, &place, &mut towards, 0.002, &mut scratch);
                (found.iter().copied().collect::<Vec<_>>(), towards)
            };
            let (wanted, towards) = all(place.position);
            // From what was found, from the other side, from anywhere and from nowhere.
            for towards in [towards, -towards, draws.vector(), Vector3::zeros()] {
                let (found, _) = all(towards);
                assert_eq!(found.len(), wanted.len(), "{shape:?} {case}");
                for (found, wanted) in found.iter().zip(&wanted) {
                    let off = [
                        found.distance - wanted.distance,
                        (found.normal - wanted.normal).norm(),
                        (found.at - wanted.at).norm(),
                    ];
                    assert!(off.iter().all(|off| off.abs() < 1e-9), "{shape:?} {case}: {found:?}, {wanted:?}");
                }
            }
            touching += usize::from(!wanted.is_empty());
        }
        assert!(touching > 50, "{shape:?}: {touching}");
    }
}
