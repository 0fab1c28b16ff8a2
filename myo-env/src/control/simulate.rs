//! The physics of a control step.

use super::Scratch;
use crate::state::EnvState;
use crate::tables::Tables;
use myo_dynamics::{SolverTally, Workspace, step};
use myo_scalar::{Carried, Scalar, Visitor};

/// Runs the physics; a short tap between two control steps counts, so the greatest force is kept. The solver's tally is
/// that of this control step afterwards.
#[inline(always)]
pub fn simulate<S: Scalar>(tables: &Tables<S::Const>, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
    let Scratch { physics, ctrl, .. } = ws;
    (env.touch, env.touched) = (S::zero(), S::lit(-1.0));
    physics.tally = SolverTally::new();
    S::repeat(tables.substeps as usize, &mut Substep { env, physics }, |Substep { env, physics }| {
        step::step(&tables.plan, &tables.obstacles, ctrl, &mut env.body, physics);
        let contact = &physics.contact;
        let harder = contact.exists & env.touch.lt(contact.force);
        env.touch = S::select(harder, contact.force, env.touch);
        env.touched = S::select(harder, contact.index, env.touched);
    });
    env.qacc.copy_from_slice(&ws.physics.qacc);
}

/// What a physics step hands on.
struct Substep<'a, S: Scalar> {
    env: &'a mut EnvState<S>,
    physics: &'a mut Workspace<S>,
}

impl<S: Scalar> Carried<S> for Substep<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let body = &mut self.env.body;
        visitor.numbers(body.qpos.iter_mut().chain(&mut body.qvel).chain(&mut body.act));
        visitor.numbers([&mut self.env.touch, &mut self.env.touched]);
        visitor.numbers(&mut self.physics.qacc);
        visitor.word(&mut self.physics.tally.rounds);
        visitor.word(&mut self.physics.tally.unsolved);
    }
}
