//! A convex mesh over a plane: the deepest vertex, and corners of the polygon there that faces the plane most squarely. Of these those within the margin
//! alone, and none that is higher than the origin of the mesh's frame. A vertex that no polygon has lies alone.

use super::contacts::{Contact, Contacts, MOST_CONTACTS};
use super::hull::Hull;
use super::placed::Placed;
use super::quad;
use nalgebra::Vector3;

/// The half space below z = 0, and a mesh in its frame.
pub(super) fn plane_mesh(mesh: &Placed<'_>, margin: f64) -> Contacts {
    let up = Vector3::z();
    let deepest = mesh.furthest(&-up);
    let mut contacts = Contacts::default();
    let lowest = mesh.vertex(deepest);
    if lowest.z > margin {
        return contacts;
    }
    let mut add = |point: Vector3<f64>| {
        contacts.push(Contact { distance: point.z, at: point - 0.5 * point.z * up, normal: up });
    };
    add(lowest);
    for vertex in corners_after(mesh.hull, deepest, &mesh.rotation.tr_mul(&up)).into_iter().flatten() {
        let point = mesh.vertex(vertex);
        if point.z <= margin && point.z <= mesh.position.z {
            add(point);
        }
    }
    contacts
}

/// The other corners, at most three, of the polygon at a vertex that is turned most against a direction.
fn corners_after(hull: &Hull, vertex: usize, up: &Vector3<f64>) -> [Option<usize>; 3] {
    let rise = |polygon: usize| hull.polygons[polygon].normal.dot(up);
    let around = hull.around[vertex].iter().copied();
    let Some(polygon) = around.min_by(|&a, &b| rise(a).total_cmp(&rise(b))) else { return [None; 3] };
    let corners = &hull.polygons[polygon].corners;
    let (count, start) = (corners.len(), corners.iter().position(|&corner| corner == vertex).unwrap_or(0));
    if count > MOST_CONTACTS {
        let quad = quad::through(count, start, |number| hull.vertices[corners[number]]);
        return [1, 2, 3].map(|k| Some(corners[quad[k]]));
    }
    [1, 2, 3].map(|k| (k < count).then(|| corners[(start + k) % count]))
}
