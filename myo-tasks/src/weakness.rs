//! Spheres in which muscles cannot hold the fingertip still.

use crate::check::Reach;
use crate::flat::Sphere;
use crate::geometry::spread;
use crate::report::{Element, HeldPlace, TaskWarning};

/// Places of a sphere that are tried.
const PLACES: u32 = 32;

/// How far (m) from a place that cannot be held another is looked for.
const AROUND: [f64; 4] = [0.05, 0.1, 0.15, 0.2];

/// Ways to look: an axis, a sign, and what people call it.
const WAYS: [(usize, f64, &str); 6] = [
    (0, -1.0, "farther back"),
    (0, 1.0, "farther forward"),
    (1, -1.0, "farther to the right"),
    (1, 1.0, "farther to the left"),
    (2, -1.0, "lower"),
    (2, 1.0, "higher"),
];

/// The warning about a sphere that needs hold for a dwell of so many seconds, where there is one. What is out of reach is another finding.
pub(crate) fn weakness(target: Element, sphere: &Sphere, dwell_s: f64, reach: &dyn Reach) -> Option<TaskWarning> {
    let place = |number| {
        let [x, y, z, radius] = spread(number);
        (sphere.region.at([x, y, z]), sphere.radius.at(radius))
    };
    let mut places: Vec<_> = (0..PLACES).map(place).collect();
    places.dedup();
    places.retain(|&(centre, radius)| reach.distance_out_of_reach(centre) < radius);
    let lost: Vec<_> = places.iter().filter(|&&(centre, radius)| !reach.can_hold(centre, radius)).collect();
    let &&(place, radius) = lost.first()?;
    Some(TaskWarning::CannotHold {
        target,
        fraction: lost.len() as f64 / places.len() as f64,
        place,
        dwell_s,
        held: held_nearby(place, radius, reach),
    })
}

/// The nearest place tried in which muscles can hold the fingertip.
fn held_nearby(place: [f64; 3], radius: f64, reach: &dyn Reach) -> Option<HeldPlace> {
    AROUND.iter().flat_map(|&by_m| WAYS.map(|way| (by_m, way))).find_map(|(by_m, (axis, sign, way))| {
        let mut point = place;
        point[axis] += sign * by_m;
        let is_held = reach.distance_out_of_reach(point) == 0.0 && reach.can_hold(point, radius);
        is_held.then_some(HeldPlace { point, by_m, way })
    })
}
