//! Soft constraints: limits, contact and couplings, solved together.
//!
//! MuJoCo's convex problem `min 1/2 |a - a_0|_M^2 + sum_i D_i/2 min(0, J_i a - aref_i)^2` (equality rows without the
//! minimum) is quadratic for a given set of pushing rows, so a primal active-set method solves it: assume the rows, solve
//! `(M + J^T D J) a = tau + J^T D aref`, look which rows push, repeat. It settles in one or two rounds; the number of
//! rounds is fixed in advance and skipped only where no lane would change.

use crate::plan::Plan;
use crate::step::{cholesky, kinematics::joint_state};
use crate::workspace::{PYRAMID, Row, State, Workspace};
use myo_scalar::{Carried, Mask, Scalar, Visitor};

/// Rounds after which the set of pushing rows is taken as it is.
pub const MAX_ROUNDS: usize = 8;

/// Fills the limit rows.
#[inline(always)]
pub fn limits<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    for (k, limit) in plan.limits.iter().enumerate() {
        let joint = joint_state(&limit.drive, &state.qpos, &state.qvel);
        let (lo, hi) = (S::splat(limit.range[0]), S::splat(limit.range[1]));
        // Only the nearer bound can be violated.
        let (above, below) = (joint.position - lo, hi - joint.position);
        let lower = above.lt(below);
        let distance = above.min(below);
        let sign = S::select(lower, S::lit(1.0), S::lit(-1.0));
        let (weight, reference) = limit.impedance.row(distance, sign * joint.rate, S::splat(limit.diagonal));
        let exists = distance.lt(S::zero());
        ws.limit[k] = Row { exists, active: exists, weight, reference, slope: sign * joint.slope };
    }
}

/// Fills the rows of couplings that are kept as constraints.
#[inline(always)]
pub fn equalities<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    let n = plan.ndof();
    ws.equality_jacobian.fill(S::zero());
    for (k, equality) in plan.equalities.iter().enumerate() {
        let leader = joint_state(&equality.drive, &state.qpos, &state.qvel);
        let row = &mut ws.equality_jacobian[k * n..(k + 1) * n];
        row[equality.dependent] = S::lit(1.0);
        if let Some(dof) = equality.drive.dof {
            row[dof] -= leader.slope;
        }
        let violation = state.qpos[equality.dependent] - leader.position;
        let velocity = state.qvel[equality.dependent] - leader.rate;
        let (weight, reference) = equality.impedance.row(violation, velocity, S::splat(equality.diagonal));
        let always = S::Mask::splat(true);
        ws.equality[k] = Row { exists: always, active: always, weight, reference, slope: S::lit(1.0) };
    }
}

/// Solves for `qacc`; fills the contact's force.
#[inline(always)]
pub fn solve<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let mut violated = S::Mask::splat(false);
    for row in &ws.limit {
        violated = violated | row.exists;
    }
    let limited = violated.any();
    let touching = ws.contact.exists.any();
    ws.rounds = 0;
    S::repeat_while(MAX_ROUNDS, &mut Round(ws), |Round(ws)| {
        assemble(plan, ws, limited, touching);
        cholesky::factor_and_solve(plan.ndof(), &mut ws.matrix, &mut ws.pivot, &mut ws.qacc);
        ws.rounds += 1;
        if limited || touching { update(plan, ws, touching) } else { S::Mask::splat(false) }
    });
    if touching {
        contact_force(plan, ws);
    }
}

/// What a round hands on: which rows push, and the acceleration.
struct Round<'a, S: Scalar>(&'a mut Workspace<S>);

impl<S: Scalar> Carried<S> for Round<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        for row in self.0.limit.iter_mut().chain(&mut self.0.contact.rows) {
            visitor.mask(&mut row.active);
        }
        visitor.numbers(&mut self.0.qacc);
    }
}

/// `matrix = M + J^T D J` and `qacc = tau + J^T D aref` over the rows that push.
#[inline(always)]
fn assemble<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, limited: bool, touching: bool) {
    let n = plan.ndof();
    ws.matrix.copy_from_slice(&ws.mass);
    ws.qacc.copy_from_slice(&ws.torque);
    if limited {
        for (row, limit) in ws.limit.iter().zip(&plan.limits) {
            let Some(dof) = limit.drive.dof else { continue };
            let pull = (row.weight * row.slope).only(row.active);
            ws.matrix[dof * n + dof] += pull * row.slope;
            ws.qacc[dof] += pull * row.reference;
        }
    }
    if touching {
        for (row, jacobian) in ws.contact.rows.iter().zip(ws.contact_jacobian.chunks_exact(n)) {
            add_row(n, row, jacobian, &mut ws.matrix, &mut ws.qacc);
        }
    }
    for (row, jacobian) in ws.equality.iter().zip(ws.equality_jacobian.chunks_exact(n)) {
        add_row(n, row, jacobian, &mut ws.matrix, &mut ws.qacc);
    }
}

#[inline(always)]
fn add_row<S: Scalar>(n: usize, row: &Row<S>, jacobian: &[S], matrix: &mut [S], right: &mut [S]) {
    let weight = row.weight.only(row.active);
    for i in 0..n {
        let scaled = weight * jacobian[i];
        right[i] = scaled.mul_add(row.reference, right[i]);
        for j in 0..=i {
            matrix[i * n + j] = scaled.mul_add(jacobian[j], matrix[i * n + j]);
        }
    }
}

/// Looks which rows push at the new acceleration; returns where the set changed.
#[inline(always)]
fn update<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, touching: bool) -> S::Mask {
    let mut changed = S::Mask::splat(false);
    for (row, limit) in ws.limit.iter_mut().zip(&plan.limits) {
        if let Some(dof) = limit.drive.dof {
            changed = changed | judge(row, ws.qacc[dof] * row.slope);
        }
    }
    if touching {
        let n = plan.ndof();
        for (row, jacobian) in ws.contact.rows.iter_mut().zip(ws.contact_jacobian.chunks_exact(n)) {
            changed = changed | judge(row, product(jacobian, &ws.qacc));
        }
    }
    changed
}

/// Decides whether a row pushes; returns where that is news.
#[inline(always)]
fn judge<S: Scalar>(row: &mut Row<S>, acceleration: S) -> S::Mask {
    let active = row.exists & acceleration.lt(row.reference);
    let changed = (active & !row.active) | (row.active & !active);
    row.active = active;
    changed
}

#[inline(always)]
fn product<S: Scalar>(a: &[S], b: &[S]) -> S {
    let mut sum = S::zero();
    for (&x, &y) in a.iter().zip(b) {
        sum = x.mul_add(y, sum);
    }
    sum
}

/// Normal force: the sum of the pyramid's edge forces `-D (J a - aref)`.
#[inline(always)]
fn contact_force<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let n = plan.ndof();
    let mut force = S::zero();
    for k in 0..PYRAMID {
        let row = &ws.contact.rows[k];
        let acceleration = product(&ws.contact_jacobian[k * n..(k + 1) * n], &ws.qacc);
        force += (row.weight * (row.reference - acceleration)).only(row.active);
    }
    ws.contact.force = force;
}
