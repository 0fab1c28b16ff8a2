//! Contact of the fingertip's sphere with the nearest box: MuJoCo's sphere-box geometry and its pyramidal friction cone.
//!
//! Boxes may not be so close that the fingertip touches two at once (tasks check it), so the nearest is the only one.

use crate::obstacles::{Obstacles, StaticBox};
use crate::plan::{ContactSphere, Plan};
use crate::spatial::{Rotation, Vec3, Wrench};
use crate::workspace::{Row, State, Workspace};
use myo_scalar::{Carried, Mask, Scalar, Visitor};

/// Farther than anything in reach (m).
const FAR: f64 = 1e3;
/// Centres nearer to the surface than this are inside (m); MuJoCo's smallest norm, in reach of single precision.
const SURFACE: f64 = 1e-15;

/// The nearest surface point.
#[derive(Clone, Copy)]
struct Nearest<S> {
    /// Distance of the surfaces, negative inside (m).
    distance: S,
    /// Out of the box.
    normal: Vec3<S>,
    index: S,
}

/// Fills `contact` and `contact_jacobian`.
#[inline(always)]
pub fn contact<S: Scalar>(
    plan: &Plan<S::Const>,
    obstacles: &Obstacles<S::Const, S>,
    state: &State<S>,
    ws: &mut Workspace<S>,
) {
    ws.contact.exists = S::Mask::splat(false);
    ws.contact.force = S::zero();
    let Some(sphere) = &plan.contact_sphere else { return };
    if obstacles.boxes.is_empty() {
        return;
    }
    let centre = ws.place(&sphere.centre);
    let nearest = nearest_surface(sphere, &obstacles.boxes, centre);
    ws.contact.index = nearest.index;
    ws.contact.exists = nearest.distance.lt(S::splat(obstacles.margin));
    S::when(ws.contact.exists, &mut Edges(ws), |Edges(ws)| {
        pyramid(plan, sphere, obstacles, state, centre, nearest, ws);
    });
}

/// The rows that [`pyramid`] writes.
struct Edges<'a, S: Scalar>(&'a mut Workspace<S>);

impl<S: Scalar> Carried<S> for Edges<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        for row in &mut self.0.contact.rows {
            visitor.mask(&mut row.exists);
            visitor.mask(&mut row.active);
            visitor.numbers([&mut row.weight, &mut row.reference, &mut row.slope]);
        }
        visitor.numbers(&mut self.0.contact_jacobian);
    }
}

#[inline(always)]
fn nearest_surface<S: Scalar>(sphere: &ContactSphere<S::Const>, boxes: &[StaticBox<S>], centre: Vec3<S>) -> Nearest<S> {
    let mut best = Nearest { distance: S::lit(FAR), normal: Vec3::zero(), index: S::zero() };
    for (index, each) in boxes.iter().enumerate() {
        let (distance, normal) = surface(each, centre);
        let closer = distance.lt(best.distance);
        best.distance = S::select(closer, distance, best.distance);
        best.normal = Vec3::select(closer, normal, best.normal);
        best.index = S::select(closer, S::lit(index as f64), best.index);
    }
    best.distance -= S::splat(sphere.radius);
    best
}

/// Signed distance of a point from a box's surface, and the direction out of the box (world axes).
#[inline(always)]
fn surface<S: Scalar>(each: &StaticBox<S>, point: Vec3<S>) -> (S, Vec3<S>) {
    let vector = |[x, y, z]: [S; 3]| Vec3::new(x, y, z);
    let [x, y, z] = each.axes.map(vector);
    let axes = Rotation { x, y, z };
    let local = axes.apply_inverse(point - vector(each.centre)).array();
    let mut excess = [S::zero(); 3];
    let (mut depth, mut face) = (S::lit(FAR), [S::zero(); 3]);
    for k in 0..3 {
        let half = each.half_size[k];
        excess[k] = local[k] - local[k].max(-half).min(half);
        // Depth below the nearer of the two faces across this axis; the negative face wins ties.
        let inside = half - local[k].abs();
        let nearer = inside.lt(depth);
        let sign = S::select(S::zero().lt(local[k]), S::lit(1.0), S::lit(-1.0));
        depth = S::select(nearer, inside, depth);
        for (j, component) in face.iter_mut().enumerate() {
            *component = S::select(nearer, if j == k { sign } else { S::zero() }, *component);
        }
    }
    let [x, y, z] = excess;
    let excess = Vec3::new(x, y, z);
    let square = excess.dot(excess);
    let outside = S::lit(SURFACE * SURFACE).lt(square);
    let inverse = square.max(S::lit(SURFACE * SURFACE)).rsqrt();
    let [fx, fy, fz] = face;
    let normal = Vec3::select(outside, excess.scale(inverse), Vec3::new(fx, fy, fz));
    (S::select(outside, square * inverse, -depth), axes.apply(normal))
}

/// The four edges of the friction pyramid as constraint rows.
#[inline(always)]
fn pyramid<S: Scalar>(
    plan: &Plan<S::Const>,
    sphere: &ContactSphere<S::Const>,
    obstacles: &Obstacles<S::Const, S>,
    state: &State<S>,
    centre: Vec3<S>,
    nearest: Nearest<S>,
    ws: &mut Workspace<S>,
) {
    // Midway between the two surfaces.
    let depth = nearest.distance.mul_add(S::lit(0.5), S::splat(sphere.radius));
    let at = centre - nearest.normal.scale(depth);
    let [first, second] = tangents(nearest.normal);
    let n = plan.ndof();
    let friction = S::splat(obstacles.friction);
    let violation = nearest.distance - S::splat(obstacles.margin);
    let screws = &plan.links[sphere.centre.link].screw_of_dof;
    for (k, direction) in [first, -first, second, -second].into_iter().enumerate() {
        let edge = Wrench::at(at, direction.mul_add(friction, nearest.normal));
        let mut velocity = S::zero();
        for (dof, screw) in screws.iter().enumerate() {
            let entry = match *screw {
                Some(screw) => ws.screw[screw].dot(edge),
                None => S::zero(),
            };
            ws.contact_jacobian[k * n + dof] = entry;
            velocity = entry.mul_add(state.qvel[dof], velocity);
        }
        let (weight, reference) = obstacles.impedance.row(violation, velocity, S::splat(obstacles.diagonal));
        let exists = ws.contact.exists;
        ws.contact.rows[k] = Row { exists, active: exists, weight, reference, slope: S::lit(1.0) };
    }
}

/// Two directions across a normal, as MuJoCo chooses them: from the world's y axis, or z where the normal is near y.
#[inline(always)]
fn tangents<S: Scalar>(normal: Vec3<S>) -> [Vec3<S>; 2] {
    let (o, i) = (S::zero(), S::lit(1.0));
    let steep = normal.y.abs().lt(S::lit(0.5));
    let guide = Vec3::select(steep, Vec3::new(o, i, o), Vec3::new(o, o, i));
    let across = guide - normal.scale(normal.dot(guide));
    let first = across.scale(across.dot(across).rsqrt());
    [first, normal.cross(first)]
}
