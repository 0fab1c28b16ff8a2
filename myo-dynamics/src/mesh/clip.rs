//! What of a polygon, or of an edge taken for one, is right over a face.

use super::face::Face;
use nalgebra::Vector3;

/// What is less than this outside the face that clips is inside (m): a guess, on which nothing depends but exact ties.
const ROUNDING: f64 = 1e-15;

/// Leaves of the corners of a polygon those of what is right over or under a face, up to a height (m). `left` is used on the way.
pub(super) fn clip(corners: &mut Vec<Vector3<f64>>, left: &mut Vec<Vector3<f64>>, face: &Face<'_>, height: f64) {
    let (count, plane) = (face.count(), face.plane());
    let mut begin = plane.corner;
    for number in 0..count {
        let end = face.corner((number + 1) % count);
        left.clear();
        cut(corners, &begin, &(end - begin).cross(&plane.normal).normalize(), left);
        std::mem::swap(corners, left);
        begin = end;
    }
    corners.retain(|point| plane.height(point) <= height);
}

/// The part of a polygon on one side of a plane through a corner.
///
/// I. Sutherland and G. Hodgman 1974 (doi 10.1145/360767.360802).
fn cut(polygon: &[Vector3<f64>], corner: &Vector3<f64>, inward: &Vector3<f64>, kept: &mut Vec<Vector3<f64>>) {
    let is_inside = |point: &Vector3<f64>| inward.dot(&(point - corner)) > -ROUNDING;
    let Some(mut begin) = polygon.first() else { return };
    let mut begins_inside = is_inside(begin);
    for end in polygon[1..].iter().chain([begin]) {
        let ends_inside = is_inside(end);
        if begins_inside != ends_inside {
            let rise = inward.dot(&(end - begin));
            let share = (inward.dot(corner) - inward.dot(begin)) / rise;
            if rise != 0.0 && (0.0..=1.0).contains(&share) {
                kept.push(begin + share * (end - begin));
            }
        }
        if ends_inside {
            kept.push(*end);
        }
        (begin, begins_inside) = (end, ends_inside);
    }
}
