//! Contacts of parts of a body with each other and with what stands around, the same however they are computed.

use super::{Look, difference, greatest, narrow_state};
use myo_dynamics::{Obstacles, Plan, State, Workspace, step};
use myo_scalar::Scalar;

/// States that are looked at: a multiple of any number of lanes.
pub const STATES: u32 = 1024;

/// Accelerations, then of each contact its distance, zero where there is none.
#[derive(Clone, Copy)]
pub struct Forward;

impl Look for Forward {
    #[inline(always)]
    fn look<S: Scalar>(self, plan: &Plan<S::Const>, state: &State<S>, ws: &mut Workspace<S>) -> Vec<S> {
        step::forward(plan, &Obstacles::none(plan), state, ws);
        let mut all = ws.qacc.clone();
        all.extend(ws.contacts[ws.box_slots..].iter().map(|contact| contact.distance.only(contact.exists)));
        all
    }
}

/// What the exact evaluator finds in all states.
pub fn in_double_precision(plan: &Plan<f64>) -> Vec<Vec<f64>> {
    let mut ws = Workspace::new(plan);
    (0..STATES).map(|number| Forward.look(plan, &narrow_state(plan, number), &mut ws)).collect()
}

/// Greatest error of accelerations relative to the greatest of them, and of distances (m), which one is which aside: the ends of an edge may come in either order.
pub fn errors(ndof: usize, wanted: &[f64], found: &[f64]) -> [f64; 2] {
    let (wanted, found) = (wanted.split_at(ndof), found.split_at(ndof));
    let sorted = |distances: &[f64]| {
        let mut sorted = distances.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted
    };
    let distance = difference(&sorted(wanted.1), &sorted(found.1));
    [difference(wanted.0, found.0) / greatest(wanted.0).max(1.0), distance]
}
