//! How Coriolis and centrifugal forces change with the velocities: what MuJoCo's `implicit` has, and `implicitfast` of free bodies alone.
//!
//! A link with inertia `I` and velocity `v` feels the wrench `I a + v x* I v` (Featherstone 2008, doi 10.1007/978-1-4899-7560-7, 5.3).
//! When the speed of a coordinate changes, which moves the link along the screw `s`, its velocity changes by `s` and its acceleration by `d - v x s`:
//! `d` is the same for all links that move along `s`. So the wrench changes by `I d + B s` with a matrix `B` of the link alone, and links that move
//! together are summed once, as their inertias are in the mass matrix (Singh, Russell and Wensing 2021, doi 10.48550/arXiv.2105.05102).
//!
//! `B` is short: of a point with mass `m` and velocity `u` the force changes by `2 m w x u` with the angular part `w` of `s`, and nothing by its
//! linear part.

use crate::plan::{Body, Form, LinkMotion, LinkSet, Plan, Unsymmetric};
use crate::spatial::{Inertia, Motion, Symmetric, Vec3, Wrench};
use crate::step::inertia::about_com;
use crate::step::kinematics::{curvature, joint_state, motion};
use crate::workspace::{State, Workspace};
use myo_scalar::{Scalar, Stage};

/// The matrix `B` of a moving body about O.
#[derive(Clone, Copy, Debug)]
pub struct Turning<S> {
    /// Columns of what an angular velocity does to the moment.
    moment: [Vec3<S>; 3],
    /// Twice the momentum.
    momentum: Vec3<S>,
}

impl<S: Scalar> Turning<S> {
    /// Of nothing that moves.
    fn zero() -> Self {
        Self { moment: [Vec3::zero(); 3], momentum: Vec3::zero() }
    }

    /// Of what resists turning only, with such an inertia and angular velocity.
    #[inline(always)]
    fn of_inertia(inertia: Symmetric<S>, velocity: Vec3<S>) -> Self {
        // w x (2 I - tr I), column by column.
        let (d, off) = (inertia.diagonal, inertia.off.scale(S::lit(2.0)));
        let x = velocity.cross(Vec3::new(d.x - d.y - d.z, off.z, off.y));
        let y = velocity.cross(Vec3::new(off.z, d.y - d.x - d.z, off.x));
        let z = velocity.cross(Vec3::new(off.y, off.x, d.z - d.x - d.y));
        Self { moment: [x, y, z], momentum: Vec3::zero() }
    }

    /// The same, and a mass at a point `c` with such a momentum.
    #[inline(always)]
    fn with_mass(self, c: Vec3<S>, momentum: Vec3<S>) -> Self {
        let momentum = momentum.scale(S::lit(2.0));
        // c x (w x p) = (c.p 1 - p c^T) w
        let along = c.dot(momentum);
        let [mut x, mut y, mut z] = self.moment;
        (x, y, z) = (momentum.mul_add(-c.x, x), momentum.mul_add(-c.y, y), momentum.mul_add(-c.z, z));
        (x.x, y.y, z.z) = (x.x + along, y.y + along, z.z + along);
        Self { moment: [x, y, z], momentum }
    }

    /// `B s`.
    #[inline(always)]
    fn apply(&self, screw: Motion<S>) -> Wrench<S> {
        let [x, y, z] = self.moment;
        let Vec3 { x: a, y: b, z: c } = screw.ang;
        Wrench { ang: x.mul_add(a, y.mul_add(b, z.scale(c))), lin: screw.ang.cross(self.momentum) }
    }

    /// `B^T s`, of which there is an angular part only.
    #[inline(always)]
    fn apply_transposed(&self, screw: Motion<S>) -> Vec3<S> {
        let [x, y, z] = self.moment;
        Vec3::new(x.dot(screw.ang), y.dot(screw.ang), z.dot(screw.ang)) + self.momentum.cross(screw.lin)
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        let [a, b] = [self.moment, other.moment];
        Self { moment: [a[0] + b[0], a[1] + b[1], a[2] + b[2]], momentum: self.momentum + other.momentum }
    }
}

/// Scratch memory; empty where steps ask for none of this.
#[derive(Clone, Debug)]
pub struct Coriolis<S> {
    /// Of each link.
    link: Vec<Turning<S>>,
    /// Of each of the plan's sets.
    set: Vec<Turning<S>>,
    /// What `d` is of each screw.
    drift: Vec<Motion<S>>,
}

impl<S: Scalar> Coriolis<S> {
    /// Memory for a plan.
    pub(crate) fn new(plan: &Plan<S::Const>) -> Self {
        let (mut links, mut sets, mut screws) = (plan.links.len(), plan.sets.len(), plan.screws.len());
        screws += links;
        if plan.unsymmetric.is_none() {
            (links, sets, screws) = (0, 0, 0);
        }
        Self {
            link: vec![Turning::zero(); links],
            set: vec![Turning::zero(); sets],
            drift: vec![Motion::zero(); screws],
        }
    }
}

/// Adds to the matrix of the step, both halves of it, how forces of inertia change with the velocities in one time step.
#[inline(always)]
pub fn resist<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    S::outline(Turnings { plan, state, ws });
    S::outline(Changes { plan, state, ws });
}

/// What belongs to one screw or to one link.
struct Turnings<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    state: &'a State<S>,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Turnings<'_, S> {
    const NAME: &'static str = "drifts of screws";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, state, ws } = self;
        for index in 1..plan.links.len() {
            ws.coriolis.drift[index] = drift(plan, index, state, ws);
        }
        for (k, screw) in plan.screws.iter().enumerate() {
            let own = ws.coriolis.drift[screw.link];
            ws.coriolis.drift[plan.links.len() + k] = match screw.parent {
                Some(parent) => ws.coriolis.drift[parent] + own,
                None => own,
            };
        }
        for body in &plan.bodies {
            ws.coriolis.link[body.link] = turning(body, ws);
        }
        for (k, set) in plan.sets.iter().enumerate() {
            ws.coriolis.set[k] = turning_of_set(set, ws);
        }
    }
}

/// Share of a link's joint in the drift of its coordinate.
#[inline(always)]
fn drift<S: Scalar>(plan: &Plan<S::Const>, index: usize, state: &State<S>, ws: &Workspace<S>) -> Motion<S> {
    let (link, screw, joint) = (&plan.links[index], ws.screw[index], ws.joint[index]);
    let two = S::lit(2.0);
    match &link.motion {
        LinkMotion::Fixed => Motion::zero(),
        LinkMotion::Hinge(_) | LinkMotion::Slide(_) => {
            let mut drift = Motion::zero();
            if link.parent != 0 {
                drift = ws.velocity[link.parent].cross(screw).scale(two * joint.slope);
            }
            if let (Form::Curved, Some(dof)) = (link.drive.form, link.drive.dof) {
                drift = screw.mul_add(two * curvature(&link.drive, state.qpos[link.drive.at]) * state.qvel[dof], drift);
            }
            drift
        }
        LinkMotion::Ball(ball) => {
            // Half of it as the axes drift by the link before, half by all three turns together.
            let first = index - ball.axis;
            let velocity = ws.velocity[plan.links[first].parent] + ws.velocity[first + 2];
            velocity.cross(screw)
        }
        LinkMotion::Profile(profile) => {
            // It has its coordinate alone, so that `v x s` is nothing.
            let at = &ws.profiled[profile.coordinate];
            motion(&profile.screw_rate, at.argument).scale(two * at.speed)
        }
    }
}

#[inline(always)]
fn turning<S: Scalar>(body: &Body<S::Const>, ws: &Workspace<S>) -> Turning<S> {
    let velocity = ws.velocity[body.link];
    let about_com = about_com(body, &ws.rotation[body.link]);
    let turning = Turning::of_inertia(about_com, velocity.ang);
    if body.mass == S::Const::default() {
        return turning;
    }
    let com = ws.frame(body.link).place(Vec3::splat(body.com));
    turning.with_mass(com, velocity.at(com).scale(S::splat(body.mass)))
}

#[inline(always)]
fn turning_of_set<S: Scalar>(set: &LinkSet, ws: &Workspace<S>) -> Turning<S> {
    let of = &ws.coriolis;
    let mut all = set.sets.iter().map(|&k| of.set[k]).chain(set.links.iter().map(|&k| of.link[k]));
    let mut sum = all.next().expect("a set has members");
    for turning in all {
        sum = sum.plus(turning);
    }
    sum
}

/// The entries of the matrix.
struct Changes<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    state: &'a State<S>,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Changes<'_, S> {
    const NAME: &'static str = "Coriolis forces by velocities";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, state, ws } = self;
        let Some(unsymmetric) = &plan.unsymmetric else { return };
        of_links(plan, unsymmetric, ws);
        if unsymmetric.only.is_none() {
            of_coordinates(plan, state, ws);
        }
    }
}

/// Adds what links do to each other, in the terms of the mass matrix.
#[inline(always)]
fn of_links<S: Scalar>(plan: &Plan<S::Const>, unsymmetric: &Unsymmetric, ws: &mut Workspace<S>) {
    let (n, h) = (plan.ndof(), S::splat(plan.timestep));
    let Workspace { matrix, screw: screws, coriolis, set_inertia, .. } = ws;
    for &number in &unsymmetric.terms {
        let term = &plan.mass_terms[number];
        let (inertia, turning): (&Inertia<S>, &Turning<S>) = (&set_inertia[term.set], &coriolis.set[term.set]);
        let screw = screws[term.screw];
        let by_column = inertia.apply(coriolis.drift[term.screw]) + turning.apply(screw);
        let (of_drift, of_turn) = (inertia.apply(screw), turning.apply_transposed(screw));
        for &(other, dof) in &term.rows {
            let entry = &mut matrix[dof * n + term.column];
            *entry = screws[other].dot(by_column).mul_add(h, *entry);
            if other != term.screw {
                let back = coriolis.drift[other].dot(of_drift) + screws[other].ang.dot(of_turn);
                let entry = &mut matrix[term.column * n + dof];
                *entry = back.mul_add(h, *entry);
            }
        }
    }
}

/// Adds what a coordinate does to itself by profiles and the armature of curved couplings.
#[inline(always)]
fn of_coordinates<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    let (n, two_h) = (plan.ndof(), S::splat(plan.timestep) * S::lit(2.0));
    for profile in &plan.energy_profiles {
        let (dof, at) = (plan.profiled[profile.coordinate].dof, &ws.profiled[profile.coordinate]);
        ws.matrix[dof * n + dof] += two_h * profile.centrifugal.value(at.argument) * at.speed;
    }
    for joint in &plan.curved_joints {
        let dof = joint.drive.dof.expect("curved joints follow a coordinate");
        let slope = joint_state(&joint.drive, &state.qpos, &state.qvel).slope;
        let rate = curvature(&joint.drive, state.qpos[joint.drive.at]) * state.qvel[dof];
        ws.matrix[dof * n + dof] += two_h * S::splat(joint.armature) * slope * rate;
    }
}
