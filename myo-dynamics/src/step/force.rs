//! Generalised forces: passive joint forces, and the work of wrenches on screws.

use crate::plan::{LinkSet, Plan};
use crate::spatial::Wrench;
use crate::step::kinematics::joint_state;
use crate::workspace::{State, Workspace};
use myo_scalar::Scalar;

/// Starts `torque` with springs, dampers, coupled armatures and the energy profiles' share; clears the wrenches.
#[inline(always)]
pub fn passive<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    ws.wrench.fill(Wrench::zero());
    ws.joint_torque.fill(S::zero());
    for (k, dof) in plan.dofs.iter().enumerate() {
        let spring = S::splat(dof.stiffness).mul_add(state.qpos[k], S::splat(dof.spring_torque));
        ws.torque[k] = -(S::splat(dof.damping).mul_add(state.qvel[k], spring));
    }
    for joint in &plan.curved_joints {
        let j = joint_state(&joint.drive, &state.qpos, &state.qvel);
        let spring = S::splat(joint.stiffness) * (j.position - S::splat(joint.spring_ref));
        let force = S::splat(joint.damping).mul_add(j.rate, spring) + S::splat(joint.armature) * j.drift;
        let dof = joint.drive.dof.expect("curved joints follow a coordinate");
        ws.torque[dof] -= force * j.slope;
    }
    for profile in &plan.energy_profiles {
        let (dof, at) = (plan.profiled[profile.coordinate].dof, &ws.profiled[profile.coordinate]);
        let (t, speed) = (at.argument, state.qvel[dof]);
        let bias = profile.centrifugal.value(t).mul_add(speed * speed, profile.weight.value(t));
        ws.torque[dof] -= bias.only(at.is_free);
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
