//! Generalised forces: passive joint forces, what acts along profiles, and the work of wrenches on screws.

use crate::plan::{DofKind, LinkSet, Plan};
use crate::spatial::Wrench;
use crate::step::kinematics::joint_state;
use crate::step::tendon;
use crate::workspace::{ProfiledState, State, Workspace};
use myo_scalar::Scalar;

/// Starts `torque` with springs, dampers and coupled armatures; clears the wrenches.
#[inline(always)]
pub fn passive<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    ws.wrench.fill(Wrench::zero());
    ws.joint_torque.fill(S::zero());
    for (k, dof) in plan.dofs.iter().enumerate() {
        // What turns any way has no spring.
        let position = if dof.kind == DofKind::Turn { S::zero() } else { state.qpos[dof.at] };
        let spring = S::splat(dof.stiffness).mul_add(position, S::splat(dof.spring_torque));
        ws.torque[k] = -(S::splat(dof.damping).mul_add(state.qvel[k], spring));
    }
    for joint in &plan.curved_joints {
        let j = joint_state(&joint.drive, &state.qpos, &state.qvel);
        let spring = S::splat(joint.stiffness) * (j.position - S::splat(joint.spring_ref));
        let force = S::splat(joint.damping).mul_add(j.rate, spring) + S::splat(joint.armature) * j.drift;
        let dof = joint.drive.dof.expect("curved joints follow a coordinate");
        ws.torque[dof] -= force * j.slope;
    }
}

/// Adds weight, centrifugal force and muscles along profiles to `torque`: nothing where a coordinate is held.
#[inline(always)]
pub fn profiles<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let dof = |coordinate: usize| plan.profiled[coordinate].dof;
    for (coordinate, at) in ws.profiled.iter_mut().enumerate() {
        at.passive = ws.torque[dof(coordinate)];
    }
    for profile in &plan.energy_profiles {
        let &ProfiledState { argument, speed, .. } = &ws.profiled[profile.coordinate];
        let bias = profile.centrifugal.value(argument).mul_add(speed * speed, profile.weight.value(argument));
        ws.torque[dof(profile.coordinate)] -= bias;
    }
    along_profiles(plan, ws);
    for (coordinate, at) in ws.profiled.iter().enumerate() {
        let torque = &mut ws.torque[dof(coordinate)];
        *torque = S::select(at.is_free, *torque, at.passive);
    }
}

/// Adds muscle forces along profiles to `torque`.
#[inline(always)]
fn along_profiles<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    for (profile, &slope) in plan.tendons.profiles.iter().zip(&ws.profile_slope) {
        let torque = &mut ws.torque[plan.profiled[profile.coordinate].dof];
        *torque = slope.mul_add(ws.muscle_force[profile.muscle], *torque);
    }
}

/// Adds `wrench` and `joint_torque` to `torque`.
#[inline(always)]
pub fn project<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    for (k, set) in plan.sets.iter().enumerate() {
        ws.set_wrench[k] = set_wrench(set, ws);
    }
    let torque = &mut ws.torque[..];
    let (screws, wrenches) = (&ws.screw[..], &ws.set_wrench[..]);
    for projection in &plan.projections {
        torque[projection.dof] += screws[projection.screw].dot(wrenches[projection.set]);
    }
    for ((link, joint), &applied) in plan.links.iter().zip(&ws.joint).zip(&ws.joint_torque) {
        if let Some(dof) = link.drive.dof {
            torque[dof] = joint.slope.mul_add(applied, torque[dof]);
        }
    }
}

#[inline(always)]
fn set_wrench<S: Scalar>(set: &LinkSet, ws: &Workspace<S>) -> Wrench<S> {
    let (sets, links) = (set.sets.iter().map(|&k| ws.set_wrench[k]), set.links.iter().map(|&k| ws.wrench[k]));
    let mut all = sets.chain(links);
    let mut sum = all.next().expect("a set has members");
    for wrench in all {
        sum += wrench;
    }
    sum
}

/// Fills `torque` with what a newton along one muscle does to every coordinate, whose paths [`tendon::lengths`] has worked out. Muscle forces and
/// wrenches of `ws` are of no use afterwards.
#[inline(always)]
pub fn pull_alone<S: Scalar>(plan: &Plan<S::Const>, muscle: usize, ws: &mut Workspace<S>) {
    ws.muscle_force.fill(S::zero());
    ws.muscle_force[muscle] = S::lit(1.0);
    tendon::divide(plan, ws);
    pull(plan, ws);
}

/// Moment arms (m or 1) of a muscle on every coordinate, whose paths [`tendon::lengths`] has worked out: the generalised
/// force of one newton along it, as which MuJoCo has the slope of its length, by virtual work: positive where moving up lengthens it. Muscle forces, torques and wrenches of `ws` are of no use afterwards.
pub fn moment_arms<S: Scalar>(plan: &Plan<S::Const>, muscle: usize, ws: &mut Workspace<S>) -> Vec<S> {
    pull_alone(plan, muscle, ws);
    ws.torque.clone()
}

/// What muscles with the forces of `ws` do to every coordinate (N m or N), whose paths [`tendon::lengths`] has worked out. Torques and
/// wrenches of `ws` are of no use afterwards.
pub fn muscle_torques<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) -> Vec<S> {
    pull(plan, ws);
    ws.torque.clone()
}

/// Fills `torque` with what muscles do.
#[inline(always)]
fn pull<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    ws.torque.fill(S::zero());
    ws.wrench.fill(Wrench::zero());
    ws.joint_torque.fill(S::zero());
    along_profiles(plan, ws);
    tendon::pull(plan, ws);
    project(plan, ws);
}
