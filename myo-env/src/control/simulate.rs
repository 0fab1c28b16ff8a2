//! The physics of a control step.

use super::Scratch;
use crate::parameters::World;
use crate::state::EnvState;
use crate::trace::record;
use myo_dynamics::spatial::Vec3;
use myo_dynamics::{Clearance, SolverTally, Workspace, step};
use myo_scalar::{Carried, Scalar, Stage, Visitor};
use myo_tasks::logic::{self, Goal, Hold, Landmarks, Pressing, Ride, Stay, Steering, TaskState};

/// Looks at every physics step of a control step.
pub trait Watch<S: Scalar> {
    /// After a physics step.
    fn look(&mut self, world: &World<'_, S>, physics: &Workspace<S>);
    /// Shows what it hands on to the next physics step.
    fn visit(&mut self, world: &World<'_, S>, visitor: &mut impl Visitor<S>);
}

/// Runs the physics, step by step before the eyes of `watch`. The solver's tally is that of this control step afterwards.
#[inline(always)]
pub fn simulate<S: Scalar>(
    world: &World<'_, S>,
    env: &mut EnvState<S>,
    ws: &mut Scratch<S>,
    watch: &mut impl Watch<S>,
) {
    let Scratch { physics, ctrl, trace, .. } = ws;
    trace.iter_mut().for_each(Vec::clear);
    physics.tally = SolverTally::new();
    physics.forget_boxes();
    physics.offsets.clear();
    physics.offsets.extend(offsets(&env.task));
    let mut carried = Substep { world, env, physics, watch, trace };
    S::repeat(world.tables.substeps as usize, &mut carried, |Substep { env, physics, watch, trace, .. }| {
        step::step(&world.tables.plan, &world.obstacles, ctrl, &mut env.body, physics);
        watch.look(world, physics);
        if let Some(trace) = trace {
            record(&world.tables.plan, physics, &env.body, trace);
        }
    });
    env.qacc.copy_from_slice(&ws.physics.qacc);
}

/// How far boxes are off their places (m), by the numbers of their draws.
#[inline(always)]
pub fn offsets<S: Scalar>(task: &TaskState<S>) -> impl Iterator<Item = Vec3<S>> {
    task.shifts.iter().map(|&[x, y, z]| Vec3::new(x, y, z))
}

/// Follows what the pointer does with the current object, so that a short tap between two control steps counts, and a short slip breaks a
/// dwell.
pub struct Following<'a, S: Scalar> {
    /// The current step of the script.
    pub goal: &'a Goal<S>,
    /// What is done with its object.
    pub stay: &'a mut Stay<S>,
}

impl<S: Scalar> Watch<S> for Following<'_, S> {
    #[inline(always)]
    fn look(&mut self, world: &World<'_, S>, physics: &Workspace<S>) {
        let Self { goal, stay } = self;
        S::outline(Follow { world, goal, physics, stay });
    }

    #[inline(always)]
    fn visit(&mut self, world: &World<'_, S>, visitor: &mut impl Visitor<S>) {
        let kinds = world.parameters.task.kinds;
        let Stay {
            held,
            tracking,
            touch,
            squared_force,
            pressed,
            let_go,
            down,
            pressing,
            holds,
            wrong_presses,
            value,
            steering,
            hold,
            ride,
            open,
            passed,
            cursor,
        } = &mut self.stay;
        visitor.numbers([held, pressed]);
        if world.parameters.task.is_felt() {
            visitor.number(touch);
        }
        if world.parameters.task.weights.contact_cost.is_some() {
            visitor.number(squared_force);
        }
        if kinds.track {
            visitor.numbers(tracking.numbers());
        }
        if kinds.steer {
            let Steering { along, within, exits } = steering;
            visitor.numbers([along, within, exits]);
        }
        if kinds.swing {
            let Hold { angle, held } = hold;
            visitor.numbers([angle, held]);
        }
        if kinds.drive {
            let Ride { along, speed } = ride;
            visitor.numbers([along, speed]);
        }
        if kinds.release {
            let pressers = world.parameters.task.pressers();
            visitor.numbers([let_go, down, wrong_presses]);
            visitor.numbers(pressing[..pressers].iter_mut().flat_map(Pressing::numbers));
            if kinds.chord {
                visitor.numbers(&mut holds[..pressers]);
            }
        }
        if kinds.drag {
            visitor.number(value);
        }
        if kinds.pinch {
            visitor.number(open);
        }
        if kinds.motion {
            visitor.number(passed);
        }
        if world.parameters.task.pointer.is_rate_cursor() {
            visitor.numbers(cursor);
        }
    }
}

/// Nobody looks: what there is to judge is judged at the end of the control step.
pub struct Unwatched;

impl<S: Scalar> Watch<S> for Unwatched {
    #[inline(always)]
    fn look(&mut self, _: &World<'_, S>, _: &Workspace<S>) {}
    #[inline(always)]
    fn visit(&mut self, _: &World<'_, S>, _: &mut impl Visitor<S>) {}
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
        let task = &world.parameters.task;
        let share = world.tables.share();
        let at = goal.centre_after(stay.passed * S::lit(share));
        let body = landmarks(world, physics, stay.cursor);
        let pointer = goal.pointer(task, &body, at);
        let contacts = physics.box_contacts().zip(&world.tables.plan.contact_spheres).flat_map(|(contacts, sphere)| {
            let finger = sphere.finger;
            contacts.iter().map(move |c| logic::Contact {
                exists: c.exists,
                finger,
                number: c.index,
                force: c.force,
                facing: c.facing,
            })
        });
        stay.follow(task, goal, &body, pointer, share, contacts);
        stay.cursor = task.pointer.moved(&body, share);
    }
}

/// Places that techniques go by, after the kinematics; a cursor that moves by itself stands at `cursor`.
#[inline(always)]
pub fn landmarks<S: Scalar>(world: &World<'_, S>, physics: &Workspace<S>, cursor: [S; 2]) -> Landmarks<S> {
    let plan = &world.tables.plan;
    let fingertip = step::fingertip(plan, physics);
    let [elbow, wrist] =
        plan.arm.as_ref().map_or([fingertip; 2], |arm| arm.each_ref().map(|point| physics.place(point).array()));
    let mut fingers = Landmarks::unknown().fingers;
    for (finger, place) in fingers.iter_mut().zip(step::fingers(plan, physics)) {
        *finger = place;
    }
    Landmarks { fingertip, elbow, wrist, fingers, cursor }
}

/// What a physics step hands on.
///
/// Named one by one, and not taken from [`EnvState::numbers`]: on a card each number named here lies in a register from the first
/// physics step to the last, and most of a state does not change in between.
struct Substep<'a, S: Scalar, W> {
    world: &'a World<'a, S>,
    env: &'a mut EnvState<S>,
    physics: &'a mut Workspace<S>,
    watch: &'a mut W,
    /// Of processors alone: nothing of it is handed on.
    trace: &'a mut Option<Vec<S>>,
}

impl<S: Scalar, W: Watch<S>> Carried<S> for Substep<'_, S, W> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let body = &mut self.env.body;
        visitor.numbers(body.qpos.iter_mut().chain(&mut body.qvel).chain(&mut body.act));
        self.watch.visit(self.world, visitor);
        visitor.numbers(&mut self.physics.qacc);
        let boxes = self.world.parameters.task.boxes.len();
        if step::nearby::lists::<S>(boxes) {
            self.physics.nearby.iter_mut().for_each(|nearby| nearby.visit(visitor));
        }
        if boxes > 0 {
            for Clearance { from, free } in &mut self.physics.clearance {
                visitor.numbers([&mut from.x, &mut from.y, &mut from.z, free]);
            }
        }
        visitor.word(&mut self.physics.tally.rounds);
        visitor.word(&mut self.physics.tally.unsolved);
    }
}
