//! The physics of a control step.

use super::Scratch;
use crate::parameters::World;
use crate::state::EnvState;
use myo_dynamics::{SolverTally, Workspace, step};
use myo_scalar::{Carried, Scalar, Visitor};
use myo_tasks::logic::{self, Aim, Stay};

/// Runs the physics; a short tap between two control steps counts, so the greatest force is kept. How long the fingertip has
/// been on its target is counted in physics steps. The solver's tally is that of this control step afterwards.
#[inline(always)]
pub fn simulate<S: Scalar>(world: &World<'_, S>, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
    let Scratch { physics, ctrl, .. } = ws;
    (env.touch, env.touched) = (S::zero(), S::lit(-1.0));
    physics.tally = SolverTally::new();
    let aim = Aim::new(&world.parameters.task, &env.task);
    let mut stay = Stay { held: env.task.held, pressed: S::zero() };
    let presses = aim.has_buttons();
    let mut carried = Substep { env, physics, stay: &mut stay, presses };
    S::repeat(world.tables.substeps as usize, &mut carried, |Substep { env, physics, stay, .. }| {
        step::step(&world.tables.plan, &world.obstacles, ctrl, &mut env.body, physics);
        let contact = &physics.contact;
        let harder = contact.exists & env.touch.lt(contact.force);
        env.touch = S::select(harder, contact.force, env.touch);
        env.touched = S::select(harder, contact.index, env.touched);
        // Positions and contact are those from which the step was made.
        let contact = logic::Contact { exists: contact.exists, button: contact.index, force: contact.force };
        aim.follow(step::fingertip(&world.tables.plan, physics), &contact, stay);
    });
    (env.task.held, env.pressed) = (stay.held, stay.pressed);
    env.qacc.copy_from_slice(&ws.physics.qacc);
}

/// What a physics step hands on.
struct Substep<'a, S: Scalar> {
    env: &'a mut EnvState<S>,
    physics: &'a mut Workspace<S>,
    stay: &'a mut Stay<S>,
    /// Whether presses are followed.
    presses: bool,
}

impl<S: Scalar> Carried<S> for Substep<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let body = &mut self.env.body;
        visitor.numbers(body.qpos.iter_mut().chain(&mut body.qvel).chain(&mut body.act));
        visitor.numbers([&mut self.env.touch, &mut self.env.touched, &mut self.stay.held]);
        if self.presses {
            visitor.number(&mut self.stay.pressed);
        }
        visitor.numbers(&mut self.physics.qacc);
        visitor.word(&mut self.physics.tally.rounds);
        visitor.word(&mut self.physics.tally.unsolved);
    }
}
