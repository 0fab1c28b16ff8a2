//! Inertia of the links, the mass matrix, and the forces that inertia and gravity cause.

use crate::plan::{Body, LinkSet, Plan};
use crate::spatial::{Inertia, Motion, Rotation, Symmetric, Vec3, Wrench};
use crate::step::kinematics::joint_state;
use crate::workspace::{State, Workspace};
use myo_scalar::Scalar;

/// Fills `inertia` of every massive link and subtracts its inertial wrench (gravity included) from `wrench`.
#[inline(always)]
pub fn resist<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let zero = S::Const::default();
    for body in &plan.bodies {
        let about_com = about_com(body, &ws.rotation[body.link]);
        let (velocity, acceleration) = (ws.velocity[body.link], ws.acceleration[body.link]);
        let mut moment = about_com.apply(acceleration.ang);
        // What resists alike about every axis has its angular momentum along the angular velocity.
        if body.arms != [[zero; 3]; 2] {
            moment = moment + velocity.ang.cross(about_com.apply(velocity.ang));
        }
        ws.wrench[body.link].ang = ws.wrench[body.link].ang - moment;
        if body.mass == zero {
            ws.inertia[body.link] = Inertia { second: about_com, ..Inertia::zero() };
            continue;
        }
        let (mass, com) = (S::splat(body.mass), ws.frame(body.link).place(Vec3::splat(body.com)));
        ws.inertia[body.link] = Inertia::new(mass, com, about_com);
        ws.wrench[body.link] -= Wrench::at(com, com_acceleration(com, velocity, acceleration).scale(mass));
    }
}

/// Inertia about the centre of mass in world axes.
#[inline(always)]
pub(super) fn about_com<S: Scalar>(body: &Body<S::Const>, rotation: &Rotation<S>) -> Symmetric<S> {
    let mut sum = Symmetric::isotropic(S::splat(body.isotropic));
    for &arm in &body.arms {
        if arm != [S::Const::default(); 3] {
            sum = sum.plus_square(rotation.apply(Vec3::splat(arm)));
        }
    }
    sum
}

/// `a_com = a_O + alpha x c + omega x (v_O + omega x c)`.
#[inline(always)]
fn com_acceleration<S: Scalar>(com: Vec3<S>, velocity: Motion<S>, acceleration: Motion<S>) -> Vec3<S> {
    acceleration.at(com) + velocity.ang.cross(velocity.at(com))
}

/// Fills the lower triangle of `mass`.
#[inline(always)]
pub fn mass_matrix<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    let n = plan.ndof();
    for (k, set) in plan.sets.iter().enumerate() {
        ws.set_inertia[k] = set_inertia(set, ws);
    }
    let (mass, screws, inertias) = (&mut ws.mass[..], &ws.screw[..], &ws.set_inertia[..]);
    for column in &plan.elimination.columns {
        mass[column.diagonal] = S::zero();
        for felt in &column.before {
            mass[felt.entry] = S::zero();
        }
    }
    for term in &plan.mass_terms {
        let wrench = inertias[term.set].apply(screws[term.screw]);
        for &(screw, dof) in &term.rows {
            let (row, column) = (dof.max(term.column), dof.min(term.column));
            mass[row * n + column] += screws[screw].dot(wrench);
        }
    }
    for (k, dof) in plan.dofs.iter().enumerate() {
        ws.mass[k * n + k] += S::splat(dof.armature);
    }
    for profile in &plan.energy_profiles {
        let dof = plan.profiled[profile.coordinate].dof;
        ws.mass[dof * n + dof] += profile.inertia.value(ws.profiled[profile.coordinate].argument);
    }
    for joint in &plan.curved_joints {
        let j = joint_state(&joint.drive, &state.qpos, &state.qvel);
        let dof = joint.drive.dof.expect("curved joints follow a coordinate");
        ws.mass[dof * n + dof] += S::splat(joint.armature) * j.slope * j.slope;
    }
}

#[inline(always)]
fn set_inertia<S: Scalar>(set: &LinkSet, ws: &Workspace<S>) -> Inertia<S> {
    let (sets, links) = (set.sets.iter().map(|&k| ws.set_inertia[k]), set.links.iter().map(|&k| ws.inertia[k]));
    let mut all = sets.chain(links);
    let mut sum = all.next().expect("a set has members");
    for inertia in all {
        sum = sum + inertia;
    }
    sum
}
