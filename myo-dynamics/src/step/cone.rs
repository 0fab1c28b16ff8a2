//! The acceleration where forces of contacts are in elliptic cones.
//!
//! In coordinates in which sliding is as long as its friction, and the normal as the opening `mu` of the cone, a contact costs half the squared distance
//! from the cone `N >= mu |T|`, times one weight (MuJoCo's three zones: nothing inside, the whole vector where its tip is nearest, and a
//! slope between). The sum over all contacts and rows is convex and has a continuous slope, so that Newton's method finds its least value from
//! anywhere if each step goes to the least value along it. Between zones that stay, that is the whole step.

use super::constraint::{Part, Rows, Touch, Touched, assemble, each_contact, judge_all, settle};
use crate::plan::{Column, ContactPair, Plan};
use crate::step::cholesky;
use crate::step::constraint::{MAX_ROUNDS, Weigh};
use crate::workspace::{PYRAMID, Row, Workspace};
use myo_scalar::{Carried, Mask, Scalar, Stage, Visitor};

/// Most dimensions of a contact.
const MOST: usize = 6;
/// Rounds of the search along a step.
const MAX_SHARES: usize = 20;
/// How near to the least value along a step is near enough, in shares of the step. The next step is as good.
const NEAR: f64 = 0.02;
/// Longest step, in shares of Newton's.
const LONGEST: f64 = 2.0;
/// A step that is so much less than the acceleration, in units of rounding, is the last: what is left then is its square.
const SETTLED: f64 = 1024.0;
/// Squares below which a vector has no direction.
const TINY: f64 = 1e-24;

/// Solves for `qacc`; fills the contacts' forces and counts the rounds.
#[inline(always)]
pub(super) fn solve<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows) {
    // As if nothing slid.
    assemble(plan, ws, rows);
    each_cone(Assemble { whole: true }, plan, ws);
    cholesky::factor_and_solve(&plan.elimination, &mut ws.matrix, &mut ws.pivot, &mut ws.qacc);
    ws.unsettled = S::Mask::splat(false);
    if rows.any() {
        S::repeat_while(MAX_ROUNDS, &mut Descent(ws), |Descent(ws)| {
            S::outline(Round { plan, ws, rows });
            ws.unsettled
        });
    }
    if rows.touching {
        each_contact(Weigh, plan, ws);
        each_cone(WeighCone, plan, ws);
    }
}

/// What a round hands on.
struct Descent<'a, S: Scalar>(&'a mut Workspace<S>);

impl<S: Scalar> Carried<S> for Descent<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Descent(ws) = self;
        visitor.numbers(&mut ws.qacc);
        let touched = ws.contacts.iter_mut().flat_map(|contact| &mut contact.rows);
        for row in ws.limit.iter_mut().chain(&mut ws.tendon_limit).chain(touched) {
            visitor.mask(&mut row.active);
        }
        visitor.mask(&mut ws.unsettled);
        visitor.word(&mut ws.tally.rounds);
    }
}

/// One step of Newton's method.
struct Round<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    ws: &'a mut Workspace<S>,
    rows: Rows,
}

impl<S: Scalar> Stage<S> for Round<'_, S> {
    const NAME: &'static str = "step towards the acceleration";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, ws, rows } = self;
        judge_all(plan, ws, rows);
        ws.step_qacc.copy_from_slice(&ws.qacc);
        assemble(plan, ws, rows);
        each_cone(Assemble { whole: false }, plan, ws);
        cholesky::factor_and_solve(&plan.elimination, &mut ws.matrix, &mut ws.pivot, &mut ws.qacc);
        let (mut step, mut size) = (S::zero(), S::zero());
        for (k, &before) in ws.step_qacc.iter().enumerate() {
            let direction = ws.qacc[k] - before;
            ws.search.direction[k] = direction;
            step = direction.mul_add(direction, step);
            size = before.mul_add(before, size);
        }
        let is_step = (size * S::lit((SETTLED * S::EPSILON).powi(2))).lt(step);
        let share = share(plan, ws, rows, is_step);
        for (k, after) in ws.qacc.iter_mut().enumerate() {
            *after = ws.search.direction[k].mul_add(share, ws.step_qacc[k]);
        }
        settle(ws, is_step);
    }
}

/// The search along a step: where it is, between which shares the least value is, and whether it goes on.
struct Search<'a, S: Scalar> {
    ws: &'a mut Workspace<S>,
    share: S,
    low: S,
    high: S,
    goes_on: S::Mask,
}

impl<S: Scalar> Carried<S> for Search<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers([&mut self.share, &mut self.low, &mut self.high]);
        visitor.mask(&mut self.goes_on);
    }
}

/// Which share of the step leads to the least value along it.
#[inline(always)]
fn share<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows, is_step: S::Mask) -> S {
    let masses = along_masses(plan, ws);
    let mut search =
        Search { ws, share: S::lit(1.0), low: S::zero(), high: S::lit(LONGEST), goes_on: S::Mask::splat(true) };
    S::repeat_while(MAX_SHARES, &mut search, |search| {
        S::outline(Shorten { plan, rows, masses, is_step, search });
        search.goes_on
    });
    S::select(is_step, search.share, S::lit(1.0))
}

/// What the masses make of the slope along the step: at its beginning, and by how much it rises along it.
#[inline(always)]
fn along_masses<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) -> [S; 2] {
    let Workspace { search, mass, step_qacc, torque, .. } = ws;
    let [mut slope, mut rise] = [S::zero(); 2];
    cholesky::product(&plan.elimination, mass, step_qacc, &mut search.trial);
    for (k, &direction) in search.direction.iter().enumerate() {
        slope = direction.mul_add(search.trial[k] - torque[k], slope);
    }
    cholesky::product(&plan.elimination, mass, &search.direction, &mut search.trial);
    for (&direction, &product) in search.direction.iter().zip(&search.trial) {
        rise = direction.mul_add(product, rise);
    }
    [slope, rise]
}

/// One step of the search along a step.
struct Shorten<'a, 'b, S: Scalar> {
    plan: &'a Plan<S::Const>,
    rows: Rows,
    masses: [S; 2],
    is_step: S::Mask,
    search: &'a mut Search<'b, S>,
}

impl<S: Scalar> Stage<S> for Shorten<'_, '_, S> {
    const NAME: &'static str = "share of a step";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, rows, masses: [slope, rise], is_step, search: Search { ws, share, low, high, goes_on } } =
            self;
        ws.search.slope = [rise.mul_add(*share, slope), rise];
        for k in 0..plan.ndof() {
            ws.search.trial[k] = ws.search.direction[k].mul_add(*share, ws.step_qacc[k]);
        }
        lean(plan, ws, rows);
        let [slope, rise] = ws.search.slope;
        let is_low = slope.lt(S::zero());
        *low = S::select(is_low, *share, *low);
        *high = S::select(is_low, *high, *share);
        let change = slope * rise.max(S::lit(TINY)).recip();
        let next = *share - change;
        let is_between = low.lt(next) & next.lt(*high);
        let next = S::select(is_between, next, (*low + *high) * S::lit(0.5));
        let goes_on_here = *goes_on & is_step & S::lit(NEAR).lt(change.abs());
        *share = S::select(goes_on_here, next, *share);
        *goes_on = goes_on_here;
    }
}

/// Adds what all rows and cones make of the slope along the step and of its rise, at the trial.
#[inline(always)]
fn lean<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>, rows: Rows) {
    let n = plan.ndof();
    let Workspace { search, limit, tendon_limit, tendon_limit_jacobian, equality, equality_jacobian, .. } = &mut *ws;
    if rows.limited {
        for (row, limit) in limit.iter().zip(&plan.limits) {
            let Some(dof) = limit.drive.dof else { continue };
            search.lean(row, search.trial[dof] * row.slope, search.direction[dof] * row.slope, true);
        }
    }
    if rows.tethered {
        for (row, jacobian) in tendon_limit.iter().zip(tendon_limit_jacobian.chunks_exact(n)) {
            search.lean_along(row, jacobian, true);
        }
    }
    for (row, jacobian) in equality.iter().zip(equality_jacobian.chunks_exact(n)) {
        search.lean_along(row, jacobian, false);
    }
    if rows.touching {
        each_contact(Lean, plan, ws);
        each_cone(Lean, plan, ws);
    }
}

/// Scratch of the search for an acceleration with cones; empty where there are none.
#[derive(Clone, Debug)]
pub struct ConeSearch<S> {
    /// Newton's step.
    direction: Vec<S>,
    /// The acceleration that is looked at.
    trial: Vec<S>,
    /// Slope and rise there.
    slope: [S; 2],
}

impl<S: Scalar> ConeSearch<S> {
    /// For so many coordinates.
    pub(crate) fn new(ndof: usize) -> Self {
        Self { direction: vec![S::zero(); ndof], trial: vec![S::zero(); ndof], slope: [S::zero(); 2] }
    }

    /// What contacts change of it.
    pub(super) fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        if !self.trial.is_empty() {
            visitor.numbers(&mut self.slope);
        }
    }

    /// Adds a row that has such an acceleration at the trial, which changes so along the step.
    #[inline(always)]
    fn lean(&mut self, row: &Row<S>, acceleration: S, change: S, is_one_sided: bool) {
        let apart = acceleration - row.reference;
        let pushes = if is_one_sided { row.exists & apart.lt(S::zero()) } else { row.exists };
        let weighed = (row.weight * change).only(pushes);
        self.slope[0] = weighed.mul_add(apart, self.slope[0]);
        self.slope[1] = weighed.mul_add(change, self.slope[1]);
    }

    #[inline(always)]
    fn lean_along(&mut self, row: &Row<S>, jacobian: &[S], is_one_sided: bool) {
        let [mut acceleration, mut change] = [S::zero(); 2];
        for (k, &entry) in jacobian.iter().enumerate() {
            acceleration = entry.mul_add(self.trial[k], acceleration);
            change = entry.mul_add(self.direction[k], change);
        }
        self.lean(row, acceleration, change, is_one_sided);
    }
}

/// What a round does with a cone.
trait ConePart<S: Scalar>: Copy {
    fn run(self, cone: Cone<'_, S::Const>, ws: &mut Workspace<S>);
}

/// A point in which a pair touches.
#[derive(Clone, Copy)]
struct Cone<'a, C> {
    /// The number of its first contact.
    number: usize,
    /// Coordinates that move its surfaces.
    columns: &'a [Column],
    /// Its dimensions.
    dimensions: usize,
    /// Normal force for each sliding one, as sliding is counted.
    opening: C,
}

/// Does a part of a round with every cone.
#[inline(always)]
fn each_cone<S: Scalar>(part: impl ConePart<S>, plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    for pair in plan.pairs.iter().filter(|pair| pair.is_cone) {
        for point in 0..pair.points {
            let number = ws.box_slots + pair.slot + point * pair.slots_each();
            let exists = ws.contacts[number].exists;
            let contact = Touch { number, columns: &pair.movers.columns };
            S::when(exists, &mut Touched { contact, ws }, |Touched { ws, .. }| {
                S::outline(OfCone { part, pair, number, ws });
            });
        }
    }
}

/// See [`each_cone`].
struct OfCone<'a, S: Scalar, P> {
    part: P,
    pair: &'a ContactPair<S::Const>,
    number: usize,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar, P: ConePart<S>> Stage<S> for OfCone<'_, S, P> {
    const NAME: &'static str = "elliptic cone";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { part, pair, number, ws } = self;
        let columns = &pair.movers.columns[..];
        part.run(Cone { number, columns, dimensions: pair.condim, opening: pair.opening }, ws);
    }
}

impl<C: Copy> Cone<'_, C> {
    /// One of its rows.
    #[inline(always)]
    fn row<S: Scalar<Const = C>>(&self, k: usize, ws: &Workspace<S>) -> Row<S> {
        ws.contacts[self.number + k / PYRAMID].rows[k % PYRAMID]
    }

    /// What its rows make of accelerations of all coordinates.
    #[inline(always)]
    fn product<S: Scalar<Const = C>>(&self, jacobian: &[S], of: &[S]) -> [S; MOST] {
        let (n, mut sums) = (of.len(), [S::zero(); MOST]);
        for column in self.columns {
            for (k, sum) in sums.iter_mut().enumerate().take(self.dimensions) {
                *sum = jacobian[(self.number * PYRAMID + k) * n + column.dof].mul_add(of[column.dof], *sum);
            }
        }
        sums
    }

    /// How far an acceleration is from the reference.
    #[inline(always)]
    fn apart<S: Scalar<Const = C>>(&self, acceleration: &[S; MOST], ws: &Workspace<S>) -> [S; MOST] {
        let mut apart = *acceleration;
        for (k, apart) in apart.iter_mut().enumerate().take(self.dimensions) {
            *apart -= self.row(k, ws).reference;
        }
        apart
    }
}

/// What a cone does at some acceleration.
struct Zone<S> {
    /// Weight of the whole vector, if its tip is nearest.
    whole: S,
    /// Weight of the distance from its side, if that is nearest.
    side: S,
    /// That distance, times the length of its direction.
    distance: S,
    /// The direction across the side: one along the normal, and this along each other dimension.
    across: [S; MOST],
    /// Which way it slides.
    along: [S; MOST],
    /// How much the side bends around the axis.
    bend: S,
    apart: [S; MOST],
}

impl<S: Scalar> Zone<S> {
    #[inline(always)]
    fn of(cone: &Cone<'_, S::Const>, apart: [S; MOST], ws: &Workspace<S>) -> Self {
        let (opening, first) = (S::splat(cone.opening), cone.row(0, ws));
        let mut square = S::zero();
        for x in &apart[1..] {
            square = x.mul_add(*x, square);
        }
        let inverse = square.max(S::lit(TINY)).rsqrt();
        let sliding = square * inverse;
        let distance = apart[0] - opening * sliding;
        let is_out = first.exists & distance.lt(S::zero());
        let at_tip = is_out & opening.mul_add(apart[0], sliding).le(S::zero());
        let at_side = is_out & !at_tip;
        let mut along = apart.map(|x| x * inverse);
        along[0] = S::zero();
        let mut across = along.map(|x| -opening * x);
        across[0] = S::lit(1.0);
        let side = first.weight * opening.mul_add(opening, S::lit(1.0)).recip();
        Self {
            whole: first.weight.only(at_tip),
            side: side.only(at_side),
            distance,
            across,
            along,
            bend: -distance * opening * inverse,
            apart,
        }
    }

    /// The force.
    #[inline(always)]
    fn force(&self) -> [S; MOST] {
        std::array::from_fn(|k| -self.whole.mul_add(self.apart[k], self.side * self.distance * self.across[k]))
    }

    /// How much less of it there is for a change of the acceleration.
    #[inline(always)]
    fn change(&self, by: &[S; MOST]) -> [S; MOST] {
        let dot = |a: &[S; MOST]| a.iter().zip(by).fold(S::zero(), |sum, (&x, &y)| x.mul_add(y, sum));
        let (out, on) = (dot(&self.across), dot(&self.along));
        std::array::from_fn(|k| {
            let around = if k == 0 { S::zero() } else { by[k] - self.along[k] * on };
            let side = self.across[k].mul_add(out, self.bend * around);
            self.whole.mul_add(by[k], self.side * side)
        })
    }
}

/// Adds cones, as they are at the acceleration before the step, or as if their tips were nearest.
#[derive(Clone, Copy)]
struct Assemble {
    whole: bool,
}

impl<S: Scalar> ConePart<S> for Assemble {
    #[inline(always)]
    fn run(self, cone: Cone<'_, S::Const>, ws: &mut Workspace<S>) {
        let n = ws.qacc.len();
        let (acceleration, zone) = if self.whole {
            let first = cone.row(0, ws);
            let o = S::zero();
            let whole = first.weight.only(first.exists);
            let apart = cone.apart(&[o; MOST], ws);
            ([o; MOST], Zone { whole, side: o, distance: o, across: [o; MOST], along: [o; MOST], bend: o, apart })
        } else {
            let acceleration = cone.product(&ws.contact_jacobian, &ws.step_qacc);
            (acceleration, Zone::of(&cone, cone.apart(&acceleration, ws), ws))
        };
        let (force, change) = (zone.force(), zone.change(&acceleration));
        let pull: [S; MOST] = std::array::from_fn(|k| force[k] + change[k]);
        let Workspace { contact_jacobian, matrix, qacc, .. } = ws;
        let entry = |k: usize, dof: usize| contact_jacobian[(cone.number * PYRAMID + k) * n + dof];
        for column in cone.columns {
            let mut own = [S::zero(); MOST];
            for (k, own) in own.iter_mut().enumerate().take(cone.dimensions) {
                *own = entry(k, column.dof);
            }
            let scaled = zone.change(&own);
            let (mut right, mut diagonal) = (qacc[column.dof], matrix[column.diagonal]);
            for k in 0..cone.dimensions {
                right = own[k].mul_add(pull[k], right);
                diagonal = scaled[k].mul_add(own[k], diagonal);
            }
            (qacc[column.dof], matrix[column.diagonal]) = (right, diagonal);
            for felt in &column.before {
                let mut sum = matrix[felt.entry];
                for (k, &scaled) in scaled.iter().enumerate().take(cone.dimensions) {
                    sum = scaled.mul_add(entry(k, felt.dof), sum);
                }
                matrix[felt.entry] = sum;
            }
        }
    }
}

/// Adds to the slope along a step.
#[derive(Clone, Copy)]
struct Lean;

impl<S: Scalar> Part<S> for Lean {
    #[inline(always)]
    fn run(self, Touch { number, columns }: Touch<'_>, ws: &mut Workspace<S>) {
        let n = ws.qacc.len();
        let Workspace { search, contacts, contact_jacobian, .. } = ws;
        for (k, row) in contacts[number].rows.iter().enumerate() {
            let [mut acceleration, mut change] = [S::zero(); 2];
            for column in columns {
                let entry = contact_jacobian[(number * PYRAMID + k) * n + column.dof];
                acceleration = entry.mul_add(search.trial[column.dof], acceleration);
                change = entry.mul_add(search.direction[column.dof], change);
            }
            search.lean(row, acceleration, change, true);
        }
    }
}

impl<S: Scalar> ConePart<S> for Lean {
    #[inline(always)]
    fn run(self, cone: Cone<'_, S::Const>, ws: &mut Workspace<S>) {
        let acceleration = cone.product(&ws.contact_jacobian, &ws.search.trial);
        let zone = Zone::of(&cone, cone.apart(&acceleration, ws), ws);
        let along = cone.product(&ws.contact_jacobian, &ws.search.direction);
        let (force, change) = (zone.force(), zone.change(&along));
        let [mut slope, mut rise] = ws.search.slope;
        for k in 0..cone.dimensions {
            slope = (-force[k]).mul_add(along[k], slope);
            rise = change[k].mul_add(along[k], rise);
        }
        ws.search.slope = [slope, rise];
    }
}

/// Normal forces.
#[derive(Clone, Copy)]
struct WeighCone;

impl<S: Scalar> ConePart<S> for WeighCone {
    #[inline(always)]
    fn run(self, cone: Cone<'_, S::Const>, ws: &mut Workspace<S>) {
        let acceleration = cone.product(&ws.contact_jacobian, &ws.qacc);
        let zone = Zone::of(&cone, cone.apart(&acceleration, ws), ws);
        ws.contacts[cone.number].force = zone.force()[0] * S::splat(cone.opening);
    }
}
