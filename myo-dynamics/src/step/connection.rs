//! Rows of bodies that are held together: MuJoCo's `connect` and `weld`.
//!
//! Where they are apart is `p1 - p2` of the two points, in axes of the world, and for welded ones the vector part of the quaternion that
//! turns the second into the first, in axes of the second: about half the angle. Rows are the derivatives of these. What they
//! would accelerate by without any acceleration of coordinates is taken off the reference, as MuJoCo has it since 3.4.

use crate::impedance::TINY;
use crate::plan::{Connection, Plan};
use crate::spatial::{Vec3, quaternion_between};
use crate::workspace::{Row, Workspace};
use myo_scalar::{Mask, Scalar};

/// Fills the rows of connections, which stand behind those of couplings.
#[inline(always)]
pub fn connections<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let mut first = plan.equalities.len();
    for connection in &plan.connections {
        let ends = Ends::of(connection, ws);
        let turned = connection.torque_scale.map(|scale| Turned::of(&ends, S::splat(scale)));
        jacobian(plan, connection, &ends, turned.as_ref(), first, ws);
        rows(connection, &ends, turned.as_ref(), first, ws);
        first += connection.rows();
    }
}

/// One of two bodies at the point where it is held.
#[derive(Clone, Copy)]
struct End<S> {
    /// The link; the world's is 0.
    link: usize,
    /// The point.
    at: Vec3<S>,
    /// Axes of its frame.
    axes: [Vec3<S>; 3],
    /// Velocity of the point, and how fast it turns.
    velocity: Vec3<S>,
    turning: Vec3<S>,
    /// Their rates without any acceleration of coordinates.
    acceleration: Vec3<S>,
    spin: Vec3<S>,
}

/// Both bodies.
struct Ends<S>([End<S>; 2]);

impl<S: Scalar> Ends<S> {
    #[inline(always)]
    fn of(connection: &Connection<S::Const>, ws: &Workspace<S>) -> Self {
        Self(connection.frames.each_ref().map(|frame| {
            let (link, seen) = (frame.origin.link, ws.fixed(frame));
            let (moves, drift) = (ws.velocity[link], ws.acceleration[link]);
            let velocity = moves.at(seen.position);
            End {
                link,
                at: seen.position,
                axes: [seen.rotation.x, seen.rotation.y, seen.rotation.z],
                velocity,
                turning: moves.ang,
                acceleration: drift.at(seen.position) + moves.ang.cross(velocity),
                spin: drift.ang,
            }
        }))
    }
}

/// How welded bodies are turned against each other: vectors are in axes of the second.
struct Turned<S> {
    /// Length by which it counts.
    scale: S,
    /// The quaternion that turns the second into the first: its scalar part and its vector.
    cosine: S,
    sine: Vec3<S>,
    /// Rate of the vector, and the rate of that without any acceleration of coordinates.
    rate: Vec3<S>,
    drift: Vec3<S>,
    /// Axes of the second.
    axes: [Vec3<S>; 3],
}

impl<S: Scalar> Turned<S> {
    #[inline(always)]
    fn of(Ends([one, other]): &Ends<S>, scale: S) -> Self {
        let (cosine, sine) = quaternion_between(other.axes, one.axes);
        let half = S::lit(0.5);
        let axes = other.axes;
        let relative = one.turning - other.turning;
        let turning = seen_from(axes, relative);
        let spin = seen_from(axes, one.spin - other.spin - other.turning.cross(relative));
        let mut turned = Self { scale, cosine, sine, rate: Vec3::zero(), drift: Vec3::zero(), axes };
        turned.rate = turned.turned_by(turning);
        // The product rule: of the turning, and of the quaternion that it turns.
        let cosine_rate = -turning.dot(sine) * half;
        let along = turning.scale(cosine_rate) + turning.cross(turned.rate);
        turned.drift = turned.turned_by(spin) + along.scale(half);
        turned
    }

    /// Rate of the vector if the first turns so against the second.
    #[inline(always)]
    fn turned_by(&self, turning: Vec3<S>) -> Vec3<S> {
        (turning.scale(self.cosine) + turning.cross(self.sine)).scale(S::lit(0.5))
    }
}

#[inline(always)]
fn seen_from<S: Scalar>([x, y, z]: [Vec3<S>; 3], vector: Vec3<S>) -> Vec3<S> {
    Vec3::new(x.dot(vector), y.dot(vector), z.dot(vector))
}

/// How every coordinate moves and turns the first body, as seen from the second.
#[inline(always)]
fn jacobian<S: Scalar>(
    plan: &Plan<S::Const>,
    connection: &Connection<S::Const>,
    Ends([one, other]): &Ends<S>,
    turned: Option<&Turned<S>>,
    first: usize,
    ws: &mut Workspace<S>,
) {
    let n = plan.ndof();
    for dof in 0..n {
        let [over, under] = [one, other].map(|end| plan.links[end.link].screw_of_dof[dof].map(|k| ws.screw[k]));
        let (mut way, mut turning) = (Vec3::zero(), Vec3::zero());
        if let Some(screw) = over {
            (way, turning) = (way + screw.at(one.at), turning + screw.ang);
        }
        if let Some(screw) = under {
            (way, turning) = (way - screw.at(other.at), turning - screw.ang);
        }
        let mut entries = [S::zero(); 6];
        entries[..3].copy_from_slice(&way.array());
        if let Some(turned) = turned {
            let rate = turned.turned_by(seen_from(turned.axes, turning)).scale(turned.scale);
            entries[3..].copy_from_slice(&rate.array());
        }
        for (k, &entry) in entries.iter().take(connection.rows()).enumerate() {
            ws.equality_jacobian[(first + k) * n + dof] = entry;
        }
    }
}

/// The rows themselves. How hard they are goes with how far the bodies are apart altogether.
#[inline(always)]
fn rows<S: Scalar>(
    connection: &Connection<S::Const>,
    Ends([one, other]): &Ends<S>,
    turned: Option<&Turned<S>>,
    first: usize,
    ws: &mut Workspace<S>,
) {
    let apart = one.at - other.at;
    let away = turned.map_or_else(Vec3::zero, |turned| turned.sine.scale(turned.scale));
    let norm = (apart.dot(apart) + away.dot(away)).sqrt();
    let place = [apart, one.velocity - other.velocity, one.acceleration - other.acceleration];
    fill(connection, (norm, connection.diagonals[0]), place, first, ws);
    if let Some(turned) = turned {
        let orientation = [away, turned.rate.scale(turned.scale), turned.drift.scale(turned.scale)];
        fill(connection, (norm, connection.diagonals[1]), orientation, first + 3, ws);
    }
}

/// Three rows, of a vector that is to be zero, its rate, and the rate of that without any acceleration of coordinates.
#[inline(always)]
fn fill<S: Scalar>(
    connection: &Connection<S::Const>,
    (norm, diagonal): (S, S::Const),
    [violation, velocity, drift]: [Vec3<S>; 3],
    first: usize,
    ws: &mut Workspace<S>,
) {
    let [violation, velocity, drift] = [violation, velocity, drift].map(Vec3::array);
    let always = S::Mask::splat(true);
    for k in 0..3 {
        let (weight, reference) =
            connection.impedance.row_of(norm, violation[k], velocity[k], S::splat(diagonal), S::lit(TINY));
        let reference = reference - drift[k];
        ws.equality[first + k] = Row { exists: always, active: always, weight, reference, slope: S::lit(1.0) };
    }
}
