//! Soft constraints: limits of joints and tendons, contact and couplings, solved together.
//!
//! MuJoCo's convex problem `min 1/2 |a - a_0|_M^2 + sum_i D_i/2 min(0, J_i a - aref_i)^2` (equality rows without the
//! minimum) is quadratic for a given set of pushing rows, so a primal active-set method solves it: assume the rows, solve
//! `(M + J^T D J) a = tau + J^T D aref`, look which rows are wrong (they push and should not, or the other way round),
//! change them, repeat.
//!
//! Changing all wrong rows at once settles in one or two rounds nearly always, but may go round in circles. From round
//! [`BLOCK_ROUNDS`] on only the first wrong row changes, which cannot (Murty 1974, Opsearch 11, 123-130: the forces solve
//! a linear complementarity problem with the positive definite matrix `J M^-1 J^T + D^-1`, and for such matrices the
//! least-index rule never meets a set twice). Both rules stop at the same set, since there is only one.

use crate::plan::{Column, Elimination, Form, Plan};
use crate::step::{cholesky, cone, kinematics::joint_state};
use crate::workspace::{PYRAMID, PairContact, Row, State, Workspace};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor, Word};

/// Rounds that may change several rows.
pub const BLOCK_ROUNDS: usize = 4;
/// Rounds after which the set of pushing rows is taken as it is, and the step counted as unsolved.
pub const MAX_ROUNDS: usize = 100;
/// Where rows change one by one, those that are wrong by less than this many units of rounding (of the numbers that their
/// acceleration is the sum of) are right: both answers then give the same acceleration, and could take turns for ever.
const ROUNDING: f64 = 64.0;

/// Fills the limit rows.
#[inline(always)]
pub fn limits<S: Scalar>(plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) {
    for (k, limit) in plan.limits.iter().enumerate() {
        let joint = joint_state(&limit.drive, &state.qpos, &state.qvel);
        let (distance, sign) = within(limit.range.map(S::splat), joint.position);
        let (weight, mut reference) = limit.impedance.row(distance, sign * joint.rate, S::splat(limit.diagonal));
        // The row's acceleration is `J a + Jdot v`, and the solver compares `J a`.
        if limit.drive.form == Form::Curved {
            reference -= sign * joint.drift;
        }
        let exists = distance.lt(S::zero());
        ws.limit[k] = Row { exists, active: exists, weight, reference, slope: sign * joint.slope };
    }
}

/// Distance of a position from the nearer end of its range, negative beyond it, and the way back: 1 upwards, -1 downwards. Only that end
/// can be violated.
#[inline(always)]
pub(crate) fn within<S: Scalar>([low, high]: [S; 2], position: S) -> (S, S) {
    let (above, below) = (position - low, high - position);
    (above.min(below), S::select(above.lt(below), S::lit(1.0), S::lit(-1.0)))
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
        let violation = state.qpos[equality.at] - leader.position;
        let velocity = state.qvel[equality.dependent] - leader.rate;
        let (weight, reference) = equality.impedance.row(violation, velocity, S::splat(equality.diagonal));
        let always = S::Mask::splat(true);
        ws.equality[k] = Row { exists: always, active: always, weight, reference, slope: S::lit(1.0) };
    }
}

/// Solves for `qacc`; fills the contact's force and counts the rounds.
#[inline(always)]
pub fn solve<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let mut violated = S::Mask::splat(false);
    for row in &ws.limit {
        violated = violated | row.exists;
    }
    let touching = list_contacts(plan, ws);
    let tethered = ws.tendon_limit.iter().any(|row| row.exists.any());
    let rows = Rows { limited: violated.any(), tethered, touching };
    ws.tally.rounds = ws.tally.rounds + S::Word::splat(1);
    if plan.has_cones() {
        cone::solve(plan, ws, rows);
    } else {
        exchange(plan, ws, rows);
    }
    let (none, one) = (S::Word::splat(0), S::Word::splat(1));
    ws.tally.unsolved = ws.tally.unsolved + S::select_word(ws.unsettled, one, none);
}

/// Lists the contacts of pairs that are there in any lane, since a plan may have hundreds; whether there are any contacts at all.
#[inline(always)]
fn list_contacts<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) -> bool {
    let (boxes, of_pairs) = ws.contacts.split_at(ws.box_slots);
    ws.touching_pairs.clear();
    let mut touches = boxes.iter().any(|contact| contact.exists.any());
    for (number, pair) in plan.pairs.iter().enumerate() {
        for (slot, contact) in of_pairs[pair.slot..][..pair.slots()].iter().enumerate() {
            if contact.exists.any() {
                touches = true;
                ws.touching_pairs.push(PairContact { pair: number, contact: ws.box_slots + pair.slot + slot });
            }
        }
    }
    touches
}

/// Solves by exchange of rows, as there are no cones.
#[inline(always)]
fn exchange<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows) {
    ws.unsettled = S::Mask::splat(false);
    // One loop for both rules: what a round computes stands in a card's kernel once.
    S::repeat_while(MAX_ROUNDS, &mut Round { ws, number: S::zero() }, |Round { ws, number }| {
        accelerate(plan, ws, rows);
        if rows.any() {
            let early = number.lt(S::lit(BLOCK_ROUNDS as f64));
            for (mask, is_early) in [(early, true), (!early, false)] {
                let exchange =
                    |Exchange(ws): &mut Exchange<'_, S>| S::outline(ExchangeRows { plan, ws, rows, is_early });
                S::when(mask, &mut Exchange(ws), exchange);
            }
            *number += S::lit(1.0);
        }
        ws.unsettled
    });
    if rows.touching {
        each_contact(Weigh, plan, ws);
    }
}

/// Which rows there may be in any lane.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    pub limited: bool,
    /// Tendons at their limits.
    pub tethered: bool,
    pub touching: bool,
}

impl Rows {
    pub(super) fn any(self) -> bool {
        self.limited || self.tethered || self.touching
    }
}

/// What a round hands on: its number, the acceleration, and what it exchanged.
struct Round<'a, S: Scalar> {
    ws: &'a mut Workspace<S>,
    number: S,
}

impl<S: Scalar> Carried<S> for Round<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Round { ws, number } = self;
        visitor.number(number);
        visitor.numbers(&mut ws.qacc);
        Exchange(ws).visit(visitor);
    }
}

/// What an exchange of rows changes: which rows push, and how it went.
struct Exchange<'a, S: Scalar>(&'a mut Workspace<S>);

impl<S: Scalar> Carried<S> for Exchange<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Exchange(ws) = self;
        let touched = ws.contacts.iter_mut().flat_map(|contact| &mut contact.rows);
        for row in ws.limit.iter_mut().chain(&mut ws.tendon_limit).chain(touched) {
            visitor.mask(&mut row.active);
        }
        visitor.mask(&mut ws.unsettled);
        visitor.word(&mut ws.tally.rounds);
    }
}

/// The acceleration with the rows that push.
#[inline(always)]
fn accelerate<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows) {
    assemble(plan, ws, rows);
    cholesky::factor_and_solve(&plan.elimination, &mut ws.matrix, &mut ws.pivot, &mut ws.qacc);
}

/// `matrix = M + J^T D J` and `qacc = tau + J^T D aref` over the rows that push.
#[inline(always)]
pub(super) fn assemble<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows) {
    let n = plan.ndof();
    cholesky::copy(&plan.elimination, &ws.mass, &mut ws.matrix);
    ws.qacc.copy_from_slice(&ws.torque);
    if rows.limited {
        for (row, limit) in ws.limit.iter().zip(&plan.limits) {
            let Some(dof) = limit.drive.dof else { continue };
            let pull = (row.weight * row.slope).only(row.active);
            ws.matrix[dof * n + dof] += pull * row.slope;
            ws.qacc[dof] += pull * row.reference;
        }
    }
    if rows.tethered {
        for (row, jacobian) in ws.tendon_limit.iter().zip(ws.tendon_limit_jacobian.chunks_exact(n)) {
            add_row(&plan.elimination, row, jacobian, &mut ws.matrix, &mut ws.qacc);
        }
    }
    if rows.touching {
        each_contact(Assemble, plan, ws);
    }
    for (row, jacobian) in ws.equality.iter().zip(ws.equality_jacobian.chunks_exact(n)) {
        add_row(&plan.elimination, row, jacobian, &mut ws.matrix, &mut ws.qacc);
    }
}

/// What a round does with a contact.
pub(super) trait Part<S: Scalar>: Copy {
    /// Does it with a contact.
    fn run(self, contact: Touch<'_>, ws: &mut Workspace<S>);
}

/// A contact of a plan.
#[derive(Clone, Copy)]
pub(super) struct Touch<'a> {
    /// Its number.
    pub number: usize,
    /// Coordinates that move its surfaces, with what they feel of each other.
    pub columns: &'a [Column],
}

/// Does a part of a round with every contact that has rows. The first one of a step is there so often that a card does not branch for it;
/// others are stages, since a closure that is not inlined would be compiled without its level's instructions.
#[inline(always)]
pub(super) fn each_contact<S: Scalar>(part: impl Part<S>, plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let (columns, boxes) = (&plan.elimination.columns[..], ws.box_slots);
    if boxes > 0 {
        part.run(Touch { number: 0, columns }, ws);
    }
    for number in 1..boxes {
        further(part, Touch { number, columns }, ws);
    }
    for k in 0..ws.touching_pairs.len() {
        let PairContact { pair, contact } = ws.touching_pairs[k];
        let pair = &plan.pairs[pair];
        if !pair.is_cone {
            further(part, Touch { number: contact, columns: &pair.movers.columns }, ws);
        }
    }
}

/// Does a part of a round with a contact that is rarely there.
#[inline(always)]
fn further<S: Scalar>(part: impl Part<S>, contact: Touch<'_>, ws: &mut Workspace<S>) {
    let exists = ws.contacts[contact.number].exists;
    S::when(exists, &mut Touched { contact, ws }, |Touched { ws, .. }| {
        S::outline(FurtherContact { part, contact, ws });
    });
}

/// See [`each_contact`].
struct FurtherContact<'a, S: Scalar, P> {
    part: P,
    contact: Touch<'a>,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar, P: Part<S>> Stage<S> for FurtherContact<'_, S, P> {
    const NAME: &'static str = "further contacts";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.part.run(self.contact, self.ws);
    }
}

/// What a contact's part of a round changes.
pub(super) struct Touched<'a, S: Scalar> {
    pub contact: Touch<'a>,
    pub ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Carried<S> for Touched<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self { contact: Touch { number, columns }, ws } = self;
        for column in *columns {
            visitor.number(&mut ws.matrix[column.diagonal]);
            for felt in &column.before {
                visitor.number(&mut ws.matrix[felt.entry]);
            }
            visitor.number(&mut ws.qacc[column.dof]);
        }
        let contact = &mut ws.contacts[*number];
        for row in &mut contact.rows {
            visitor.mask(&mut row.active);
        }
        visitor.number(&mut contact.force);
        visitor.mask(&mut ws.unsettled);
        ws.search.visit(visitor);
    }
}

/// Adds the rows that push.
#[derive(Clone, Copy)]
struct Assemble;

impl<S: Scalar> Part<S> for Assemble {
    #[inline(always)]
    fn run(self, Touch { number, columns }: Touch<'_>, ws: &mut Workspace<S>) {
        let n = ws.qacc.len();
        let Workspace { contacts, contact_jacobian, matrix, qacc, .. } = ws;
        let (rows, o) = (&contacts[number].rows, S::zero());
        let jacobian = &contact_jacobian[number * PYRAMID * n..][..PYRAMID * n];
        let [mut weight, mut pull] = [[o; PYRAMID]; 2];
        for (k, row) in rows.iter().enumerate() {
            weight[k] = row.weight.only(row.active);
            pull[k] = row.reference;
        }
        for column in columns {
            let mut scaled = [o; PYRAMID];
            let (mut right, mut diagonal) = (qacc[column.dof], matrix[column.diagonal]);
            for k in 0..PYRAMID {
                let entry = jacobian[k * n + column.dof];
                scaled[k] = weight[k] * entry;
                right = scaled[k].mul_add(pull[k], right);
                diagonal = scaled[k].mul_add(entry, diagonal);
            }
            (qacc[column.dof], matrix[column.diagonal]) = (right, diagonal);
            for felt in &column.before {
                let mut sum = matrix[felt.entry];
                for k in 0..PYRAMID {
                    sum = scaled[k].mul_add(jacobian[k * n + felt.dof], sum);
                }
                matrix[felt.entry] = sum;
            }
        }
    }
}

#[inline(always)]
fn add_row<S: Scalar>(elimination: &Elimination, row: &Row<S>, jacobian: &[S], matrix: &mut [S], right: &mut [S]) {
    let weight = row.weight.only(row.active);
    for column in &elimination.columns {
        let scaled = weight * jacobian[column.dof];
        right[column.dof] = scaled.mul_add(row.reference, right[column.dof]);
        for felt in &column.before {
            matrix[felt.entry] = scaled.mul_add(jacobian[felt.dof], matrix[felt.entry]);
        }
        matrix[column.diagonal] = scaled.mul_add(jacobian[column.dof], matrix[column.diagonal]);
    }
}

/// The exchange of an early round or of a later one. A stage, since what a closure does that is not inlined has not its level's instructions.
struct ExchangeRows<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    ws: &'a mut Workspace<S>,
    rows: Rows,
    is_early: bool,
}

impl<S: Scalar> Stage<S> for ExchangeRows<'_, S> {
    const NAME: &'static str = "exchange of rows";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, ws, rows, is_early } = self;
        if is_early { exchange_all(plan, ws, rows) } else { exchange_first(plan, ws, rows) }
    }
}

/// Changes all rows that are wrong at the new acceleration; `unsettled` is where there were any.
#[inline(always)]
fn exchange_all<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows) {
    judge_all(plan, ws, rows);
    settle(ws, ws.unsettled);
}

/// Decides which rows push at the new acceleration; `unsettled` is where that is news.
#[inline(always)]
pub(super) fn judge_all<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows) {
    let mut changed = S::Mask::splat(false);
    for (row, limit) in ws.limit.iter_mut().zip(&plan.limits) {
        if let Some(dof) = limit.drive.dof {
            changed = changed | judge(row, ws.qacc[dof] * row.slope);
        }
    }
    if rows.tethered {
        let jacobians = ws.tendon_limit_jacobian.chunks_exact(plan.ndof());
        for (row, jacobian) in ws.tendon_limit.iter_mut().zip(jacobians) {
            changed = changed | judge(row, product(jacobian, &ws.qacc));
        }
    }
    ws.unsettled = changed;
    if rows.touching {
        each_contact(Judge, plan, ws);
    }
}

/// Decides which rows push; adds to `unsettled` where that is news.
#[derive(Clone, Copy)]
struct Judge;

impl<S: Scalar> Part<S> for Judge {
    #[inline(always)]
    fn run(self, contact: Touch<'_>, ws: &mut Workspace<S>) {
        for (k, acceleration) in accelerations(contact, ws).into_iter().enumerate() {
            let changed = judge(&mut ws.contacts[contact.number].rows[k], acceleration);
            ws.unsettled = ws.unsettled | changed;
        }
    }
}

/// Accelerations of the rows of a contact.
#[inline(always)]
fn accelerations<S: Scalar>(Touch { number, columns }: Touch<'_>, ws: &Workspace<S>) -> [S; PYRAMID] {
    let n = ws.qacc.len();
    let jacobian = &ws.contact_jacobian[number * PYRAMID * n..][..PYRAMID * n];
    let mut sums = [S::zero(); PYRAMID];
    for column in columns {
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = jacobian[k * n + column.dof].mul_add(ws.qacc[column.dof], *sum);
        }
    }
    sums
}

/// Decides whether a row pushes; returns where that is news.
#[inline(always)]
fn judge<S: Scalar>(row: &mut Row<S>, acceleration: S) -> S::Mask {
    let active = row.exists & acceleration.lt(row.reference);
    let changed = differ(active, row.active);
    row.active = active;
    changed
}

/// Changes the first row that is wrong by more than rounding; `unsettled` is where there was one.
#[inline(always)]
fn exchange_first<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows) {
    let Workspace { limit, tendon_limit, tendon_limit_jacobian, qacc, unsettled, .. } = &mut *ws;
    *unsettled = S::Mask::splat(false);
    for (row, limit) in limit.iter_mut().zip(&plan.limits) {
        if let Some(dof) = limit.drive.dof {
            let acceleration = qacc[dof] * row.slope;
            change_unless(unsettled, row, acceleration, acceleration.abs());
        }
    }
    if rows.tethered {
        for (row, jacobian) in tendon_limit.iter_mut().zip(tendon_limit_jacobian.chunks_exact(qacc.len())) {
            let mut size = S::zero();
            for (&x, &y) in jacobian.iter().zip(&*qacc) {
                size += (x * y).abs();
            }
            change_unless(unsettled, row, product(jacobian, qacc), size);
        }
    }
    if rows.touching {
        each_contact(ChangeFirst, plan, ws);
    }
    settle(ws, ws.unsettled);
}

/// Changes the first row of a contact that is wrong, unless another one was before.
#[derive(Clone, Copy)]
struct ChangeFirst;

impl<S: Scalar> Part<S> for ChangeFirst {
    #[inline(always)]
    fn run(self, Touch { number, columns }: Touch<'_>, ws: &mut Workspace<S>) {
        let n = ws.qacc.len();
        let Workspace { contacts, contact_jacobian, qacc, unsettled, .. } = ws;
        let jacobian = &contact_jacobian[number * PYRAMID * n..][..PYRAMID * n];
        let [mut acceleration, mut size] = [[S::zero(); PYRAMID]; 2];
        for column in columns {
            for k in 0..PYRAMID {
                let moved = jacobian[k * n + column.dof] * qacc[column.dof];
                acceleration[k] += moved;
                size[k] += moved.abs();
            }
        }
        for (k, row) in contacts[number].rows.iter_mut().enumerate() {
            change_unless(unsettled, row, acceleration[k], size[k]);
        }
    }
}

/// Changes a row that is clearly wrong where none was `changed` before it. `size` is what rounding of the acceleration is
/// relative to.
#[inline(always)]
fn change_unless<S: Scalar>(changed: &mut S::Mask, row: &mut Row<S>, acceleration: S, size: S) {
    let rounding = (size + row.reference.abs()) * S::lit(ROUNDING * S::EPSILON);
    let wrong = differ(row.exists & acceleration.lt(row.reference), row.active)
        & rounding.lt((acceleration - row.reference).abs());
    let first = wrong & !*changed;
    *changed = *changed | first;
    row.active = differ(row.active, first);
}

/// Ends a round in which rows changed where the mask is true.
#[inline(always)]
pub(super) fn settle<S: Scalar>(ws: &mut Workspace<S>, changed: S::Mask) {
    ws.unsettled = changed;
    let (none, one) = (S::Word::splat(0), S::Word::splat(1));
    ws.tally.rounds = ws.tally.rounds + S::select_word(changed, one, none);
}

#[inline(always)]
fn differ<M: Mask>(a: M, b: M) -> M {
    (a & !b) | (b & !a)
}

#[inline(always)]
fn product<S: Scalar>(a: &[S], b: &[S]) -> S {
    let mut sum = S::zero();
    for (&x, &y) in a.iter().zip(b) {
        sum = x.mul_add(y, sum);
    }
    sum
}

/// Normal forces: the sum of the pyramid's edge forces `-D (J a - aref)` of each contact.
#[derive(Clone, Copy)]
pub(super) struct Weigh;

impl<S: Scalar> Part<S> for Weigh {
    #[inline(always)]
    fn run(self, contact: Touch<'_>, ws: &mut Workspace<S>) {
        let accelerations = accelerations(contact, ws);
        let touched = &mut ws.contacts[contact.number];
        let mut force = S::zero();
        for (row, acceleration) in touched.rows.iter().zip(accelerations) {
            force += row.force(acceleration);
        }
        touched.force = force;
    }
}
