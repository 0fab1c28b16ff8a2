//! Joint positions, poses, screws, velocities and drift accelerations of all links.

use crate::plan::{BallAxis, Drive, Form, Link, LinkMotion, Placement, Plan, PoseProfile};
use crate::polynomial::Polynomial;
use crate::spatial::{Motion, Rotation, Vec3};
use crate::workspace::{JointState, ProfiledState, Workspace};
use myo_scalar::Scalar;

/// Fills `profiled`, `joint`, `rotation`, `position`, `screw`, `velocity` and `acceleration`.
#[inline(always)]
pub fn kinematics<S: Scalar>(plan: &Plan<S::Const>, qpos: &[S], qvel: &[S], ws: &mut Workspace<S>) {
    for (at, coordinate) in ws.profiled.iter_mut().zip(&plan.profiled) {
        (at.argument, at.is_free) = coordinate.domain.map(qpos[coordinate.at]);
        at.speed = qvel[coordinate.dof].only(at.is_free);
    }
    if let Some(at) = plan.carried {
        let place = Vec3::new(qpos[at], qpos[at + 1], qpos[at + 2]);
        ws.position[0] = Vec3::splat(plan.origin) - place;
    }
    // Gravity acts like an upward acceleration of the world.
    let gravity = Vec3::splat(plan.gravity);
    ws.acceleration[0] = Motion { ang: Vec3::zero(), lin: -gravity };
    for (index, link) in plan.links.iter().enumerate().skip(1) {
        match &link.motion {
            LinkMotion::Fixed => {}
            LinkMotion::Hinge(placement) => {
                let mut joint = joint_state(&link.drive, qpos, qvel);
                (joint.sin, joint.cos) = joint.position.sin_cos();
                hinge(index, link, placement, joint, ws);
            }
            LinkMotion::Slide(placement) => {
                slide(index, link, placement, joint_state(&link.drive, qpos, qvel), ws);
            }
            LinkMotion::Ball(ball) => {
                let before = index - ball.axis;
                let joint = joint_state(&link.drive, qpos, qvel);
                turn(index, (link.parent, plan.links[before].parent), ball, qpos, joint, ws);
            }
            LinkMotion::Profile(profile) => {
                let joint = joint_state(&link.drive, qpos, qvel);
                follow(index, profile, joint, ws);
            }
        }
    }
    for (k, screw) in plan.screws.iter().enumerate() {
        let joint = ws.screw[screw.link];
        let slope = ws.joint[screw.link].slope;
        ws.screw[plan.links.len() + k] = match screw.parent {
            Some(parent) if plan.links[screw.link].drive.form == Form::Identity => ws.screw[parent] + joint,
            Some(parent) => joint.mul_add(slope, ws.screw[parent]),
            None => joint.scale(slope),
        };
    }
}

/// Position `p(q)`, rate `p' qvel`, slope `p'` and drift `p'' qvel^2` of a joint.
#[inline(always)]
pub fn joint_state<S: Scalar>(drive: &Drive<S::Const>, qpos: &[S], qvel: &[S]) -> JointState<S> {
    let (zero, one) = (S::zero(), S::lit(1.0));
    let still =
        JointState { position: S::splat(drive.poly[0]), rate: zero, slope: zero, drift: zero, sin: zero, cos: one };
    let Some(dof) = drive.dof else { return still };
    let (q, v) = (qpos[drive.at], qvel[dof]);
    let [c0, c1, c2, c3, c4] = &drive.poly;
    let (c0, c1, c2) = (S::splat(*c0), S::splat(*c1), S::splat(*c2));
    match drive.form {
        Form::Identity => JointState { position: q, rate: v, slope: one, ..still },
        Form::Linear => JointState { position: c1.mul_add(q, c0), rate: c1 * v, slope: c1, ..still },
        Form::Curved => {
            let (c3, c4) = (S::splat(*c3), S::splat(*c4));
            let position = c4.mul_add(q, c3).mul_add(q, c2).mul_add(q, c1).mul_add(q, c0);
            let (two_c2, three_c3, four_c4) = (c2 * S::lit(2.0), c3 * S::lit(3.0), c4 * S::lit(4.0));
            let slope = four_c4.mul_add(q, three_c3).mul_add(q, two_c2).mul_add(q, c1);
            JointState { position, rate: slope * v, slope, drift: curvature(drive, q) * v * v, ..still }
        }
    }
}

/// Second derivative `p''(q)` of a joint's position.
#[inline(always)]
pub(super) fn curvature<S: Scalar>(drive: &Drive<S::Const>, q: S) -> S {
    let [_, _, c2, c3, c4] = &drive.poly;
    let (two_c2, three_c3) = (S::splat(*c2) * S::lit(2.0), S::splat(*c3) * S::lit(3.0));
    let four_c4 = S::splat(*c4) * S::lit(4.0);
    (four_c4 * S::lit(3.0)).mul_add(q, three_c3 * S::lit(2.0)).mul_add(q, two_c2)
}

#[inline(always)]
fn hinge<S: Scalar>(
    index: usize,
    link: &Link<S::Const>,
    placement: &Placement<S::Const>,
    joint: JointState<S>,
    ws: &mut Workspace<S>,
) {
    let (axes, position) = place(link.parent, placement, ws);
    ws.position[index] = position;
    ws.rotation[index] = axes.times_about_z(joint.sin, joint.cos);
    // A turn about the axis a through p moves the point at O by p x a.
    let screw = Motion { ang: axes.z, lin: position.cross(axes.z) };
    drive(index, link, screw, joint, ws);
}

#[inline(always)]
fn slide<S: Scalar>(
    index: usize,
    link: &Link<S::Const>,
    placement: &Placement<S::Const>,
    joint: JointState<S>,
    ws: &mut Workspace<S>,
) {
    let (axes, position) = place(link.parent, placement, ws);
    ws.position[index] = axes.z.mul_add(joint.position, position);
    ws.rotation[index] = axes;
    drive(index, link, Motion { ang: Vec3::zero(), lin: axes.z }, joint, ws);
}

/// One axis of a ball joint, of which all links stand as the last one: the first works out how.
#[inline(always)]
fn turn<S: Scalar>(
    index: usize,
    (parent, before): (usize, usize),
    ball: &BallAxis<S::Const>,
    qpos: &[S],
    joint: JointState<S>,
    ws: &mut Workspace<S>,
) {
    if ball.axis == 0 {
        let (axes, position) = place(before, &ball.placement, ws);
        let turned = Rotation::of_quaternion([0, 1, 2, 3].map(|k| qpos[ball.at + k]));
        (ws.rotation[index], ws.position[index]) = (axes.after(&turned), position);
    } else {
        (ws.rotation[index], ws.position[index]) = (ws.rotation[parent], ws.position[parent]);
    }
    let Rotation { x, y, z } = ws.rotation[index];
    let axis = [x, y, z][ball.axis];
    let screw = Motion { ang: axis, lin: ws.position[index].cross(axis) };
    (ws.joint[index], ws.screw[index]) = (joint, screw);
    ws.velocity[index] = screw.mul_add(joint.rate, ws.velocity[parent]);
    // The axes turn with the body: together they drift as the link before them moves.
    ws.acceleration[index] = ws.velocity[before].cross(screw).mul_add(joint.rate, ws.acceleration[parent]);
}

/// Frame of the joint at position zero, in the world.
#[inline(always)]
fn place<S: Scalar>(parent: usize, placement: &Placement<S::Const>, ws: &Workspace<S>) -> (Rotation<S>, Vec3<S>) {
    let rotation = ws.rotation[parent];
    let offset = Vec3::splat(placement.offset);
    let axes = match &placement.axes {
        Some(columns) if parent == 0 => {
            Rotation { x: Vec3::splat(columns[0]), y: Vec3::splat(columns[1]), z: Vec3::splat(columns[2]) }
        }
        Some(columns) => rotation.times(columns),
        None => rotation,
    };
    let is_zero = placement.offset == [S::Const::default(); 3];
    let position = match (parent, is_zero) {
        (0, _) => ws.carried(offset),
        (_, true) => ws.position[parent],
        (_, false) => ws.frame(parent).place(offset),
    };
    (axes, position)
}

/// Velocity `v = v_parent + s rate` and drift `a = a_parent + (v x s) rate + s drift`.
#[inline(always)]
fn drive<S: Scalar>(
    index: usize,
    link: &Link<S::Const>,
    screw: Motion<S>,
    joint: JointState<S>,
    ws: &mut Workspace<S>,
) {
    let before = ws.velocity[link.parent];
    ws.joint[index] = joint;
    ws.screw[index] = screw;
    ws.velocity[index] = if link.parent == 0 { screw.scale(joint.rate) } else { screw.mul_add(joint.rate, before) };
    let mut acceleration = ws.acceleration[link.parent];
    if link.parent != 0 {
        acceleration = before.cross(screw).mul_add(joint.rate, acceleration);
    }
    if link.drive.form == Form::Curved {
        acceleration = screw.mul_add(joint.drift, acceleration);
    }
    ws.acceleration[index] = acceleration;
}

/// A link whose pose is a function of one coordinate: `v = s qvel`, `a = s' qvel^2`, minus gravity.
#[inline(always)]
fn follow<S: Scalar>(index: usize, profile: &PoseProfile<S::Const>, joint: JointState<S>, ws: &mut Workspace<S>) {
    let ProfiledState { argument: t, is_free, speed, .. } = ws.profiled[profile.coordinate];
    if let Some(axes) = &profile.axes {
        let (x, y) = (vector(&axes[0], t), vector(&axes[1], t));
        ws.rotation[index] = Rotation { x, y, z: x.cross(y) };
    }
    ws.position[index] = vector(&profile.position, t);
    let (screw, rate) = (motion(&profile.screw, t), motion(&profile.screw_rate, t));
    ws.joint[index] = joint;
    let held = Vec3::zero();
    ws.screw[index] =
        Motion { ang: Vec3::select(is_free, screw.ang, held), lin: Vec3::select(is_free, screw.lin, held) };
    ws.velocity[index] = screw.scale(speed);
    ws.acceleration[index] = rate.mul_add(speed * speed, ws.acceleration[0]);
}

#[inline(always)]
pub(super) fn motion<S: Scalar>(p: &[[Polynomial<S::Const>; 3]; 2], t: S) -> Motion<S> {
    Motion { ang: vector(&p[0], t), lin: vector(&p[1], t) }
}

#[inline(always)]
fn vector<S: Scalar>(p: &[Polynomial<S::Const>; 3], t: S) -> Vec3<S> {
    Vec3::new(p[0].value(t), p[1].value(t), p[2].value(t))
}
