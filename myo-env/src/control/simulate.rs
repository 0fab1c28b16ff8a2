//! The physics of a control step.

use super::Scratch;
use crate::parameters::World;
use crate::state::EnvState;
use myo_dynamics::{Clearance, SolverTally, Workspace, step};
use myo_scalar::{Carried, Scalar, Stage, Visitor};
use myo_tasks::logic::{self, Goal, Kinds, Stay};

/// Runs the physics and follows what the fingertip does with the current object, so that a short tap between two control
/// steps counts. The solver's tally is that of this control step afterwards.
#[inline(always)]
pub fn simulate<S: Scalar>(
    world: &World<'_, S>,
    goal: &Goal<S>,
    env: &mut EnvState<S>,
    ws: &mut Scratch<S>,
    stay: &mut Stay<S>,
) {
    let Scratch { physics, ctrl, .. } = ws;
    physics.tally = SolverTally::new();
    physics.clearance = Clearance::unknown();
    let task = &world.parameters.task;
    let mut carried = Substep { env, physics, stay, kinds: task.kinds, has_boxes: !task.boxes.is_empty() };
    S::repeat(world.tables.substeps as usize, &mut carried, |Substep { env, physics, stay, .. }| {
        step::step(&world.tables.plan, &world.obstacles, ctrl, &mut env.body, physics);
        S::outline(Follow { world, goal, physics, stay });
    });
    env.qacc.copy_from_slice(&ws.physics.qacc);
}

/// What the fingertip does with the current object in a physics step.
struct Follow<'a, S: Scalar> {
    world: &'a World<'a, S>,
    goal: &'a Goal<S>,
    physics: &'a Workspace<S>,
    stay: &'a mut Stay<S>,
}

impl<S: Scalar> Stage<S> for Follow<'_, S> {
    const NAME: &'static str = "following the fingertip";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { world, goal, physics, stay } = self;
        // Positions and contact are those from which the step was made.
        let fingertip = step::fingertip(&world.tables.plan, physics);
        let contacts = physics.contacts.iter();
        let contacts = contacts.map(|c| logic::Contact { exists: c.exists, number: c.index, force: c.force });
        stay.follow(&world.parameters.task, goal, fingertip, contacts);
    }
}

/// What a physics step hands on.
struct Substep<'a, S: Scalar> {
    env: &'a mut EnvState<S>,
    physics: &'a mut Workspace<S>,
    stay: &'a mut Stay<S>,
    /// What is followed.
    kinds: Kinds,
    /// Whether there is anything to touch.
    has_boxes: bool,
}

impl<S: Scalar> Carried<S> for Substep<'_, S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let body = &mut self.env.body;
        visitor.numbers(body.qpos.iter_mut().chain(&mut body.qvel).chain(&mut body.act));
        let Stay { held, touch, pressed, let_go, down, old, wrong, wrong_presses } = &mut self.stay;
        visitor.number(held);
        if self.kinds.press {
            visitor.numbers([touch, pressed]);
        }
        if self.kinds.release {
            visitor.numbers([let_go, down, old, wrong, wrong_presses]);
        }
        visitor.numbers(&mut self.physics.qacc);
        if self.has_boxes {
            let Clearance { from, free } = &mut self.physics.clearance;
            visitor.numbers([&mut from.x, &mut from.y, &mut from.z, free]);
        }
        visitor.word(&mut self.physics.tally.rounds);
        visitor.word(&mut self.physics.tally.unsolved);
    }
}
