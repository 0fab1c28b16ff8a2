//! The stages of a control step that are functions of their own.

use super::Scratch;
use super::episode::draw_episode;
use super::excite::{excite, resist_stretch};
use super::explore::{Search, begin_anywhere, explore, try_pose};
use super::simulate::{Watch, landmarks, simulate};
use crate::observe::observe;
use crate::parameters::{Reflex, World};
use crate::state::EnvState;
use myo_dynamics::{State, Workspace, step};
use myo_scalar::{Scalar, Stage};
use myo_tasks::logic::{Goal, Landmarks, Point, Sensed, choose_nearest};

/// Noise.
pub struct Excite<'a, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub env: &'a mut EnvState<S>,
    pub ws: &'a mut Scratch<S>,
}

impl<S: Scalar> Stage<S> for Excite<'_, S> {
    const NAME: &'static str = "excitation and noise";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        excite(self.world, self.env, self.ws);
    }
}

/// Stretch reflexes.
pub struct ResistStretch<'a, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub reflex: Reflex<S>,
    pub body: &'a State<S>,
    pub physics: &'a mut Workspace<S>,
    pub ctrl: &'a mut [S],
}

impl<S: Scalar> Stage<S> for ResistStretch<'_, S> {
    const NAME: &'static str = "stretch reflexes";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        resist_stretch(self.world, self.reflex, self.body, self.physics, self.ctrl);
    }
}

/// All physics steps of a control step.
pub struct Physics<'a, S: Scalar, W> {
    pub world: &'a World<'a, S>,
    pub env: &'a mut EnvState<S>,
    pub ws: &'a mut Scratch<S>,
    pub watch: &'a mut W,
}

impl<S: Scalar, W: Watch<S>> Stage<S> for Physics<'_, S, W> {
    const NAME: &'static str = "physics";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        simulate(self.world, self.env, self.ws, self.watch);
    }
}

/// Kinematics of the state reached, and where the body is that techniques go by.
pub struct Look<'a, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub env: &'a EnvState<S>,
    pub physics: &'a mut Workspace<S>,
    /// Where a cursor that moves by itself stands.
    pub cursor: [S; 2],
    pub out: &'a mut Landmarks<S>,
}

impl<S: Scalar> Stage<S> for Look<'_, S> {
    const NAME: &'static str = "fingertip";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { world, env, physics, cursor, out } = self;
        step::kinematics::kinematics(&world.tables.plan, &env.body.qpos, &env.body.qvel, physics);
        *out = landmarks(world, physics, cursor);
    }
}

/// Choice of the current step.
pub struct Choose<'a, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub body: &'a Landmarks<S>,
    pub env: &'a mut EnvState<S>,
}

impl<S: Scalar> Stage<S> for Choose<'_, S> {
    const NAME: &'static str = "choice of the current step";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        choose_nearest(&self.world.parameters.task, self.body, &mut self.env.task);
    }
}

/// The observation.
pub struct Observe<'a, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub goal: &'a Goal<S>,
    pub env: &'a EnvState<S>,
    pub sensed: &'a Sensed<S>,
    pub out: &'a mut Vec<S>,
}

impl<S: Scalar> Stage<S> for Observe<'_, S> {
    const NAME: &'static str = "observation";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.out.clear();
        observe(self.world, self.goal, self.env, self.sensed, self.out);
    }
}

/// Draws of a new episode.
pub struct Draw<'a, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub mask: S::Mask,
    pub env: &'a mut EnvState<S>,
}

impl<S: Scalar> Stage<S> for Draw<'_, S> {
    const NAME: &'static str = "draws of a new episode";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        draw_episode(self.world, self.mask, self.env);
    }
}

/// Exploring starts.
pub struct Explore<'a, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub mask: S::Mask,
    /// Targets that were done when the last episode ended.
    pub done_before: S,
    pub env: &'a mut EnvState<S>,
    pub physics: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Explore<'_, S> {
    const NAME: &'static str = "exploring starts";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        explore(self.world, self.mask, self.done_before, self.env, self.physics);
    }
}

/// A beginning in the middle of a task.
pub struct BeginAnywhere<'a, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub explores: S::Mask,
    /// Targets that were done when the last episode ended.
    pub done_before: S,
    pub env: &'a mut EnvState<S>,
    pub physics: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for BeginAnywhere<'_, S> {
    const NAME: &'static str = "beginning anywhere";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        begin_anywhere(self.world, self.explores, self.done_before, self.env, self.physics);
    }
}

/// One of the poses that exploring starts choose from; true where another is asked for.
pub struct TryPose<'a, 'b, S: Scalar> {
    pub world: &'a World<'a, S>,
    pub target: Point<S>,
    pub mask: S::Mask,
    pub again: S::Mask,
    pub search: &'a mut Search<'b, S>,
}

impl<S: Scalar> Stage<S> for TryPose<'_, '_, S> {
    const NAME: &'static str = "any pose";
    type Output = S::Mask;
    #[inline(always)]
    fn run(self) -> S::Mask {
        try_pose(self.world, self.target, self.mask, self.again, self.search)
    }
}
