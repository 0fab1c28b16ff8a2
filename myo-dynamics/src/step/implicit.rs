//! Muscles at the end of a step instead of its beginning: MuJoCo's `implicitfast`, and with Coriolis forces (`coriolis.rs`) its `implicit`.
//!
//! A muscle pulls less the faster it shortens, as if it were a damper beside its tendon. With its moment arms `m` and the slope `-d` of its force
//! by its rate, `h d m m^T` is added to the mass matrix, as `h B` of joint dampers is.

use crate::plan::Plan;
use crate::spatial::Wrench;
use crate::workspace::{State, Workspace};
use myo_muscle::ForceCurves;
use myo_scalar::{Scalar, Stage};

/// Adds what muscles do by their rates to the matrix of the step.
#[inline(always)]
pub fn resist<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    S::outline(Arms { plan, ws });
    S::outline(Resist { plan, state, ws });
}

/// Moment arms of all muscles.
struct Arms<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Arms<'_, S> {
    const NAME: &'static str = "moment arms";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, ws } = self;
        ws.arms.fill(S::zero());
        of_segments(plan, ws);
        of_lines(plan, ws);
        of_branches(plan, ws);
        // Far beyond its limits what a coordinate drives by profiles stands still.
        let n = plan.ndof();
        for (profiled, at) in plan.profiled.iter().zip(&ws.profiled) {
            for arms in ws.arms.chunks_exact_mut(n) {
                arms[profiled.dof] = arms[profiled.dof].only(at.is_free);
            }
        }
    }
}

/// Adds segments whose slope by a joint or a coordinate is known.
#[inline(always)]
fn of_segments<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let (n, tendons) = (plan.ndof(), &plan.tendons);
    let Workspace { arms, joint, hinge_slope, double_hinge_slope, profile_slope, .. } = ws;
    let mut by_joint = |muscle: usize, link: usize, slope: S| {
        if let Some(dof) = plan.links[link].drive.dof {
            let arm = &mut arms[muscle * n + dof];
            *arm = slope.mul_add(joint[link].slope, *arm);
        }
    };
    for (segment, &slope) in tendons.hinge.iter().zip(&*hinge_slope) {
        by_joint(segment.muscle, segment.link, slope);
    }
    for (segment, &[first, second]) in tendons.double_hinge.iter().zip(&*double_hinge_slope) {
        by_joint(segment.muscle, segment.links[0], first);
        by_joint(segment.muscle, segment.links[1], second);
    }
    for (profile, &slope) in tendons.profiles.iter().zip(&*profile_slope) {
        arms[profile.muscle * n + plan.profiled[profile.coordinate].dof] += slope;
    }
}

/// Adds straight lines between links.
#[inline(always)]
fn of_lines<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let tendons = &plan.tendons;
    let mut number = 0;
    for pair in &tendons.pairs {
        for segment in &pair.segments {
            add(plan, segment.muscle, [pair.a, pair.b], ws.line[number], ws);
            number += 1;
        }
    }
    let mut number = 0;
    for bundle in &tendons.wraps {
        for stretch in &bundle.stretches {
            let [leaving, arriving] = ws.wrap_lines[number];
            let middle = stretch.round.frame.origin.link;
            let [first, last] = stretch.ends.each_ref().map(|end| end.link);
            add(plan, stretch.muscle, [middle, last], arriving, ws);
            if !bundle.is_moored {
                add(plan, stretch.muscle, [first, middle], leaving, ws);
            }
            number += 1;
        }
    }
}

/// Adds a line from one link to another.
#[inline(always)]
fn add<S: Scalar>(
    plan: &Plan<S::Const>,
    muscle: usize,
    [from, to]: [usize; 2],
    line: Wrench<S>,
    ws: &mut Workspace<S>,
) {
    let n = plan.ndof();
    for dof in 0..n {
        let [over, under] = [to, from].map(|link| plan.links[link].screw_of_dof[dof]);
        // What moves both alike does not change the distance.
        if over == under {
            continue;
        }
        let arm = &mut ws.arms[muscle * n + dof];
        if let Some(screw) = over {
            *arm += ws.screw[screw].dot(line);
        }
        if let Some(screw) = under {
            *arm -= ws.screw[screw].dot(line);
        }
    }
}

/// Adds branches to their muscles, as far as they count.
#[inline(always)]
fn of_branches<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let n = plan.ndof();
    let (muscles, branches) = ws.arms.split_at_mut(plan.nmuscle() * n);
    for (branch, arms) in plan.tendons.branches.iter().zip(branches.chunks_exact(n)) {
        let share = S::splat(branch.share);
        for (sum, &arm) in muscles[branch.muscle * n..][..n].iter_mut().zip(arms) {
            *sum = arm.mul_add(share, *sum);
        }
    }
}

/// Muscles as dampers.
struct Resist<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    state: &'a State<S>,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Resist<'_, S> {
    const NAME: &'static str = "muscles as dampers";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, state, ws } = self;
        let (n, h) = (plan.ndof(), S::splat(plan.timestep));
        for (muscle, implicit) in plan.implicit_muscles.iter().enumerate() {
            let (length, velocity) = (ws.tendon_length[muscle], ws.tendon_velocity[muscle]);
            let curves = ForceCurves::from_row(plan.muscles[muscle].curves.row().map(S::splat));
            let damping = curves.damping(length, velocity, state.act[muscle]) * h;
            let arms = &ws.arms[muscle * n..][..n];
            for &[row, column] in &implicit.pairs {
                let entry = &mut ws.matrix[row * n + column];
                *entry = (damping * arms[row]).mul_add(arms[column], *entry);
            }
        }
    }
}
