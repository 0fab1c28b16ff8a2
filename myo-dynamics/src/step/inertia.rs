//! Inertia of the links, the mass matrix, and the forces that inertia and gravity cause.

use crate::plan::{Body, LinkSet, Plan};
use crate::spatial::{Inertia, Motion, Symmetric, Vec3, Wrench};
use crate::step::kinematics::joint_state;
use crate::workspace::{State, Workspace};
use myo_scalar::Scalar;

/// Fills `inertia` of every massive link and subtracts its inertial wrench (gravity included) from `wrench`.
#[inline(always)]
pub fn resist<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    for body in &plan.bodies {
        let (about_com, com) = in_world(body, ws);
        ws.inertia[body.link] = Inertia::new(S::splat(body.mass), com, about_com);
        let (velocity, acceleration) = (ws.velocity[body.link], ws.acceleration[body.link]);
        ws.wrench[body.link] -= inertial_wrench(S::splat(body.mass), about_com, com, velocity, acceleration);
    }
}

/// Inertia about the centre of mass in world axes, and the centre of mass (m, from O).
#[inline(always)]
fn in_world<S: Scalar>(body: &Body<S::Const>, ws: &Workspace<S>) -> (Symmetric<S>, Vec3<S>) {
    let [xx, yy, zz, yz, xz, xy] = body.inertia;
    let local = Symmetric { diagonal: Vec3::splat([xx, yy, zz]), off: Vec3::splat([yz, xz, xy]) };
    let rotation = &ws.rotation[body.link];
    let com = ws.frame(body.link).place(Vec3::splat(body.com));
    // An inertia that is the same about every axis does not notice rotations.
    let zero = S::Const::default();
    let isotropic = xx == yy && yy == zz && [yz, xz, xy] == [zero; 3];
    (if isotropic { local } else { local.rotated(rotation) }, com)
}

/// Newton and Euler: `f = m a_com`, `n_com = I alpha + omega x I omega`.
#[inline(always)]
fn inertial_wrench<S: Scalar>(
    mass: S,
    about_com: Symmetric<S>,
    com: Vec3<S>,
    velocity: Motion<S>,
    acceleration: Motion<S>,
) -> Wrench<S> {
    let omega = velocity.ang;
    // a_com = a_O + alpha x c + omega x (v_O + omega x c)
    let a_com = acceleration.at(com) + omega.cross(velocity.at(com));
    let force = a_com.scale(mass);
    let moment = about_com.apply(acceleration.ang) + omega.cross(about_com.apply(omega));
    Wrench { ang: moment + com.cross(force), lin: force }
}

/// Fills the lower triangle of `mass`.
#[inline(always)]
pub fn mass_matrix<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    let n = plan.ndof();
    for (k, set) in plan.sets.iter().enumerate() {
        ws.set_inertia[k] = set_inertia(set, ws);
    }
    let (mass, screws, inertias) = (&mut ws.mass[..], &ws.screw[..], &ws.set_inertia[..]);
    for entry in mass.iter_mut() {
        *entry = S::zero();
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
        let t = profile.domain.map(state.qpos[profile.dof]);
        ws.mass[profile.dof * n + profile.dof] += profile.inertia.value(t);
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
