//! Lengths and rates of muscle paths, and what muscle forces do to the body.
//!
//! A straight segment from a to b with direction u pulls along the line (moment b x u, direction u); the same six numbers
//! give the rate of its length from the two links' velocities and the wrench that a force along it puts on them.

use crate::plan::{DoubleHingeSegment, HingeSegment, Plan, ProfileSegment};
use crate::spatial::{Vec3, Wrench};
use crate::workspace::{JointState, Workspace};
use myo_scalar::Scalar;

/// Shorter segments have no direction to speak of (m^2); keeps the reciprocal root finite.
const SHORTEST_SQUARED: f64 = 1e-20;

/// Fills `tendon_length` and `tendon_velocity`, and the slopes and lines that `pull` needs.
#[inline(always)]
pub fn lengths<S: Scalar>(plan: &Plan<S::Const>, qpos: &[S], qvel: &[S], ws: &mut Workspace<S>) {
    let tendons = &plan.tendons;
    for (muscle, &constant) in tendons.constant.iter().enumerate() {
        ws.tendon_length[muscle] = S::splat(constant);
        ws.tendon_velocity[muscle] = S::zero();
    }
    for (k, profile) in tendons.profiles.iter().enumerate() {
        let (length, slope) = profile_length(profile, qpos[profile.dof]);
        ws.profile_slope[k] = slope;
        ws.tendon_length[profile.muscle] += length;
        add_product(&mut ws.tendon_velocity[profile.muscle], slope, qvel[profile.dof]);
    }
    for (k, segment) in tendons.hinge.iter().enumerate() {
        let joint = ws.joint[segment.link];
        let (length, slope) = hinge_length(segment, joint);
        ws.hinge_slope[k] = slope;
        ws.tendon_length[segment.muscle] += length;
        add_product(&mut ws.tendon_velocity[segment.muscle], slope, joint.rate);
    }
    for (k, segment) in tendons.double_hinge.iter().enumerate() {
        let (first, second) = (ws.joint[segment.links[0]], ws.joint[segment.links[1]]);
        let (length, slope) = double_hinge_length(segment, first, second);
        ws.double_hinge_slope[k] = slope;
        ws.tendon_length[segment.muscle] += length;
        add_product(&mut ws.tendon_velocity[segment.muscle], slope[0], first.rate);
        add_product(&mut ws.tendon_velocity[segment.muscle], slope[1], second.rate);
    }
    let mut k = 0;
    for pair in &tendons.pairs {
        let (frame_a, frame_b) = (ws.frame(pair.a), ws.frame(pair.b));
        let velocity = if pair.a == 0 { ws.velocity[pair.b] } else { ws.velocity[pair.b] - ws.velocity[pair.a] };
        for segment in &pair.segments {
            let [a, b] = [&tendons.points[segment.a].position, &tendons.points[segment.b].position];
            let a = if pair.a == 0 { Vec3::splat(*a) } else { frame_a.place(Vec3::splat(*a)) };
            let b = frame_b.place(Vec3::splat(*b));
            let between = b - a;
            let square = between.dot(between).max(S::lit(SHORTEST_SQUARED));
            let inverse = square.rsqrt();
            let line = Wrench::at(b, between.scale(inverse));
            ws.line[k] = line;
            ws.tendon_length[segment.muscle] = square.mul_add(inverse, ws.tendon_length[segment.muscle]);
            ws.tendon_velocity[segment.muscle] += velocity.dot(line);
            k += 1;
        }
    }
}

/// Adds the muscle forces to `wrench`, `joint_torque` and `torque`.
#[inline(always)]
pub fn pull<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let tendons = &plan.tendons;
    for (k, profile) in tendons.profiles.iter().enumerate() {
        add_product(&mut ws.torque[profile.dof], ws.profile_slope[k], ws.muscle_force[profile.muscle]);
    }
    for (k, segment) in tendons.hinge.iter().enumerate() {
        add_product(&mut ws.joint_torque[segment.link], ws.hinge_slope[k], ws.muscle_force[segment.muscle]);
    }
    for (k, segment) in tendons.double_hinge.iter().enumerate() {
        let force = ws.muscle_force[segment.muscle];
        let [first, second] = ws.double_hinge_slope[k];
        add_product(&mut ws.joint_torque[segment.links[0]], first, force);
        add_product(&mut ws.joint_torque[segment.links[1]], second, force);
    }
    let mut k = 0;
    for pair in &tendons.pairs {
        let mut wrench = Wrench::zero();
        for segment in &pair.segments {
            wrench = ws.line[k].mul_add(ws.muscle_force[segment.muscle], wrench);
            k += 1;
        }
        ws.wrench[pair.b] += wrench;
        if pair.a != 0 {
            ws.wrench[pair.a] -= wrench;
        }
    }
}

#[inline(always)]
fn add_product<S: Scalar>(sum: &mut S, a: S, b: S) {
    *sum = a.mul_add(b, *sum);
}

/// Length and its derivative with respect to the coordinate.
#[inline(always)]
fn profile_length<S: Scalar>(segment: &ProfileSegment<S::Const>, q: S) -> (S, S) {
    let (square, slope) = segment.square.value_and_slope(segment.domain.map(q));
    let square = square.max(S::lit(SHORTEST_SQUARED));
    let inverse = square.rsqrt();
    (square * inverse, slope * inverse * S::splat(segment.slope) * S::lit(0.5))
}

/// Length and its derivative with respect to the hinge angle: `l' = (l^2)' / (2 l)`.
#[inline(always)]
fn hinge_length<S: Scalar>(segment: &HingeSegment<S::Const>, joint: JointState<S>) -> (S, S) {
    let (square, slope) = harmonic(&segment.square, joint);
    let square = square.max(S::lit(SHORTEST_SQUARED));
    let inverse = square.rsqrt();
    (square * inverse, slope * inverse * S::lit(0.5))
}

/// `c0 + c1 cos + c2 sin` of a hinge, and its derivative.
#[inline(always)]
fn harmonic<S: Scalar>(c: &[S::Const; 3], joint: JointState<S>) -> (S, S) {
    let (c0, c1, c2) = (S::splat(c[0]), S::splat(c[1]), S::splat(c[2]));
    (c1.mul_add(joint.cos, c2.mul_add(joint.sin, c0)), c2.mul_add(joint.cos, -(c1 * joint.sin)))
}

/// Length and its derivatives with respect to the two hinge angles.
#[inline(always)]
fn double_hinge_length<S: Scalar>(
    segment: &DoubleHingeSegment<S::Const>,
    first: JointState<S>,
    second: JointState<S>,
) -> (S, [S; 2]) {
    // Each row, and its derivative, as a function of the second hinge.
    let [row0, row1, row2] = &segment.square;
    let ((r0, d0), (r1, d1), (r2, d2)) = (harmonic(row0, second), harmonic(row1, second), harmonic(row2, second));
    let square = r1.mul_add(first.cos, r2.mul_add(first.sin, r0)).max(S::lit(SHORTEST_SQUARED));
    let inverse = square.rsqrt();
    let half = inverse * S::lit(0.5);
    let by_first = r2.mul_add(first.cos, -(r1 * first.sin));
    let by_second = d1.mul_add(first.cos, d2.mul_add(first.sin, d0));
    (square * inverse, [by_first * half, by_second * half])
}
