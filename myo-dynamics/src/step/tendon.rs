//! Lengths and rates of muscle paths, and what muscle forces do to the body.
//!
//! A straight segment from a to b with direction u pulls along the line (moment b x u, direction u); the same six numbers
//! give the rate of its length from the two links' velocities and the wrench that a force along it puts on them.

use crate::plan::{DoubleHingeSegment, HingeSegment, Plan, ProfileSegment};
use crate::spatial::{Frame, Vec3, Wrench};
use crate::step::wrap;
use crate::workspace::{JointState, ProfiledState, Workspace};
use myo_scalar::Scalar;

/// Shorter segments have no direction to speak of (m^2); keeps the reciprocal root finite.
const SHORTEST_SQUARED: f64 = 1e-20;

/// Fills `tendon_length` and `tendon_velocity`, and the slopes and lines that `pull` needs.
#[inline(always)]
pub fn lengths<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let tendons = &plan.tendons;
    // Slices of their own here and below: after a store through `ws` the compiler would fetch all addresses anew.
    let (length, rate) = (&mut ws.tendon_length[..], &mut ws.tendon_velocity[..]);
    let (joints, velocities, profiled) = (&ws.joint[..], &ws.velocity[..], &ws.profiled[..]);
    let (rotations, positions) = (&ws.rotation[..], &ws.position[..]);
    for (muscle, &constant) in tendons.constant.iter().enumerate() {
        length[muscle] = S::splat(constant);
        rate[muscle] = S::zero();
    }
    for (profile, slope) in tendons.profiles.iter().zip(&mut ws.profile_slope) {
        let added;
        let at = &profiled[profile.coordinate];
        (added, *slope) = profile_length(profile, at);
        length[profile.muscle] += added;
        add_product(&mut rate[profile.muscle], *slope, at.speed);
    }
    for (segment, slope) in tendons.hinge.iter().zip(&mut ws.hinge_slope) {
        let joint = &joints[segment.link];
        let added;
        (added, *slope) = hinge_length(segment, joint);
        length[segment.muscle] += added;
        add_product(&mut rate[segment.muscle], *slope, joint.rate);
    }
    for (segment, slope) in tendons.double_hinge.iter().zip(&mut ws.double_hinge_slope) {
        let (first, second) = (&joints[segment.links[0]], &joints[segment.links[1]]);
        let added;
        (added, *slope) = double_hinge_length(segment, first, second);
        length[segment.muscle] += added;
        add_product(&mut rate[segment.muscle], slope[0], first.rate);
        add_product(&mut rate[segment.muscle], slope[1], second.rate);
    }
    let (points, mut lines) = (&tendons.points[..], ws.line.iter_mut());
    for pair in &tendons.pairs {
        let frame_a = Frame { rotation: rotations[pair.a], position: positions[pair.a] };
        let frame_b = Frame { rotation: rotations[pair.b], position: positions[pair.b] };
        let velocity = if pair.a == 0 { velocities[pair.b] } else { velocities[pair.b] - velocities[pair.a] };
        for (segment, line) in pair.segments.iter().zip(&mut lines) {
            let (a, b) = (&points[segment.a].position, &points[segment.b].position);
            let (a, b) = (Vec3::splat(*a), frame_b.place(Vec3::splat(*b)));
            let a = if pair.a == 0 && plan.carried.is_none() { a } else { frame_a.place(a) };
            let between = b - a;
            let square = between.dot(between).max(S::lit(SHORTEST_SQUARED));
            let inverse = square.rsqrt();
            *line = Wrench::at(b, between.scale(inverse));
            length[segment.muscle] = square.mul_add(inverse, length[segment.muscle]);
            rate[segment.muscle] += velocity.dot(*line);
        }
    }
    wrap::lengths(plan, ws);
    let nmuscle = plan.nmuscle();
    for (k, branch) in tendons.branches.iter().enumerate() {
        let share = S::splat(branch.share);
        let [length, rate] = [ws.tendon_length[nmuscle + k], ws.tendon_velocity[nmuscle + k]];
        add_product(&mut ws.tendon_length[branch.muscle], share, length);
        add_product(&mut ws.tendon_velocity[branch.muscle], share, rate);
    }
}

/// Gives every branch its share of the force of its muscle.
#[inline(always)]
pub fn divide<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let (forces, branches) = ws.muscle_force.split_at_mut(plan.nmuscle());
    for (force, branch) in branches.iter_mut().zip(&plan.tendons.branches) {
        *force = S::splat(branch.share) * forces[branch.muscle];
    }
}

/// Adds the muscle forces, [divided](divide) among branches, to `wrench` and `joint_torque`; those along profiles are [`force::profiles`](super::force)'s.
#[inline(always)]
pub fn pull<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let tendons = &plan.tendons;
    let (force, wrenches) = (&ws.muscle_force[..], &mut ws.wrench[..]);
    let joint_torque = &mut ws.joint_torque[..];
    for (segment, &slope) in tendons.hinge.iter().zip(&ws.hinge_slope) {
        add_product(&mut joint_torque[segment.link], slope, force[segment.muscle]);
    }
    for (segment, &[first, second]) in tendons.double_hinge.iter().zip(&ws.double_hinge_slope) {
        add_product(&mut joint_torque[segment.links[0]], first, force[segment.muscle]);
        add_product(&mut joint_torque[segment.links[1]], second, force[segment.muscle]);
    }
    let mut lines = ws.line.iter();
    for pair in &tendons.pairs {
        let mut wrench = Wrench::zero();
        for (segment, line) in pair.segments.iter().zip(&mut lines) {
            wrench = line.mul_add(force[segment.muscle], wrench);
        }
        wrenches[pair.b] += wrench;
        if pair.a != 0 {
            wrenches[pair.a] -= wrench;
        }
    }
    wrap::pull(plan, ws);
}

#[inline(always)]
fn add_product<S: Scalar>(sum: &mut S, a: S, b: S) {
    *sum = a.mul_add(b, *sum);
}

/// Length and its derivative with respect to the coordinate, `l' = (l^2)' / (2 l)`. It never vanishes, see the plan.
#[inline(always)]
fn profile_length<S: Scalar>(segment: &ProfileSegment<S::Const>, at: &ProfiledState<S>) -> (S, S) {
    let square = segment.square.value(at.argument);
    let inverse = square.rsqrt();
    (square * inverse, segment.half_slope.value(at.argument) * inverse)
}

/// Length and its derivative with respect to the hinge angle. It never vanishes, see the plan.
#[inline(always)]
fn hinge_length<S: Scalar>(segment: &HingeSegment<S::Const>, joint: &JointState<S>) -> (S, S) {
    let [c0, c1, c2] = segment.square.map(S::splat);
    let [half1, half2] = segment.half.map(S::splat);
    let square = c1.mul_add(joint.cos, c2.mul_add(joint.sin, c0));
    let inverse = square.rsqrt();
    (square * inverse, half2.mul_add(joint.cos, -(half1 * joint.sin)) * inverse)
}

/// `c0 + c1 cos + c2 sin` of a hinge, and its derivative.
#[inline(always)]
fn harmonic<S: Scalar>(c: &[S::Const; 3], joint: &JointState<S>) -> (S, S) {
    let (c0, c1, c2) = (S::splat(c[0]), S::splat(c[1]), S::splat(c[2]));
    (c1.mul_add(joint.cos, c2.mul_add(joint.sin, c0)), c2.mul_add(joint.cos, -(c1 * joint.sin)))
}

/// Length and its derivatives with respect to the two hinge angles.
#[inline(always)]
fn double_hinge_length<S: Scalar>(
    segment: &DoubleHingeSegment<S::Const>,
    first: &JointState<S>,
    second: &JointState<S>,
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
