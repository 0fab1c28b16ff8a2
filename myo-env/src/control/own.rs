//! Rules of one's own as the judge.

use super::simulate::landmarks;
use super::{Judge, Outcome, Scratch, Unwatched, stages, summary};
use crate::observe::observe_body;
use crate::parameters::World;
use crate::perceive;
use crate::rules::{Ball, Moment, Rules, Verdict};
use crate::state::EnvState;
use myo_dynamics::Workspace;
use myo_scalar::{Mask, Scalar, Stage};
use myo_tasks::logic::{self, Landmarks};

/// Rules of one's own.
pub struct Own<R>(pub R);

impl<R: Rules> Judge for Own<R> {
    #[inline(always)]
    fn control_step<S: Scalar>(&self, world: &World<'_, S>, env: &mut EnvState<S>, ws: &mut Scratch<S>) -> Outcome<S> {
        S::outline(stages::Excite { world, env, ws });
        S::outline(stages::Physics { world, env, ws, watch: &mut Unwatched });
        env.task.step += S::lit(1.0);
        let mut verdict = Verdict::goes_on(S::zero());
        let Scratch { physics, ctrl, observation, .. } = ws;
        let mask = S::Mask::splat(true);
        S::outline(Ask {
            rules: &self.0,
            world,
            mask,
            controls: ctrl,
            env,
            physics,
            out: observation,
            verdict: &mut verdict,
        });
        perceive::after_step(&world.tables.delays, &mut env.late, observation);
        let Verdict { reward, done, failed } = verdict;
        let terminated = done | failed;
        let truncated = world.parameters.task.time_limit.le(env.task.step) & !terminated;
        summary::add_up(world, env, &[reward], [S::zero(); 2], ws.squared_control, &ws.physics.tally);
        summary::summarise_own(world, env, [done & !failed, failed], &mut ws.episode);
        Outcome { reward, terminated, truncated }
    }

    #[inline(always)]
    fn reset<S: Scalar>(&self, world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
        if mask.any() {
            S::outline(stages::Draw { world, mask, env });
        }
        let controls = &vec![S::zero(); ws.ctrl.len()];
        let mut verdict = Verdict::goes_on(S::zero());
        let Scratch { physics, next_observation, .. } = ws;
        let (rules, out) = (&self.0, &mut *next_observation);
        S::outline(Ask { rules, world, mask, controls, env, physics, out, verdict: &mut verdict });
        perceive::after_reset(&world.tables.delays, mask, &mut env.late, next_observation);
    }
}

/// Asks the rules at the state reached, and observes. Where the mask is false, environments keep what was remembered and observed
/// last.
struct Ask<'a, S: Scalar, R> {
    rules: &'a R,
    world: &'a World<'a, S>,
    mask: S::Mask,
    /// Of the control step that led here.
    controls: &'a [S],
    env: &'a mut EnvState<S>,
    physics: &'a mut Workspace<S>,
    /// The whole observation.
    out: &'a mut Vec<S>,
    verdict: &'a mut Verdict<S>,
}

impl<S: Scalar, R: Rules> Stage<S> for Ask<'_, S, R> {
    const NAME: &'static str = "rules";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { rules, world, mask, controls, env, physics, out, verdict } = self;
        let mut body = Landmarks::unknown();
        S::outline(stages::Look { world, env, physics, cursor: [S::zero(); 2], out: &mut body });
        if mask.any() {
            let (mut remembered, mut observed) = (env.remembered.clone(), Vec::with_capacity(env.observed.len()));
            let spheres = spheres(world, env);
            let moment = moment(world, env, physics, controls, &spheres);
            *verdict = rules.step(&moment, &mut remembered, &mut observed);
            let kept = env.remembered.iter_mut().chain(&mut env.observed);
            for (old, new) in kept.zip(remembered.into_iter().chain(observed)) {
                *old = S::select(mask, new, *old);
            }
        }
        out.clear();
        for &part in &world.tables.observation {
            observe_body(part, world, env, &body.fingertip, out);
        }
        out.extend_from_slice(&env.observed);
    }
}

/// What rules see, after the kinematics.
#[inline(always)]
fn moment<'a, S: Scalar>(
    world: &World<'_, S>,
    env: &'a EnvState<S>,
    physics: &Workspace<S>,
    controls: &'a [S],
    spheres: &'a [Ball<S>],
) -> Moment<'a, S> {
    let (plan, control_dt) = (&world.tables.plan, world.tables.control_dt());
    let body = landmarks(world, physics, [S::zero(); 2]);
    let velocity = physics.velocity[plan.fingertip.link].at(physics.place(&plan.fingertip));
    let has_arm = plan.arm.is_some();
    Moment {
        qpos: &env.body.qpos,
        qvel: &env.body.qvel,
        qacc: &env.qacc,
        activation: &env.body.act,
        controls,
        fingertip: body.fingertip,
        fingertip_velocity: velocity.array(),
        elbow: has_arm.then_some(body.elbow),
        wrist: has_arm.then_some(body.wrist),
        spheres,
        time: env.task.step * S::lit(control_dt),
        time_limit: world.parameters.task.time_limit * S::lit(control_dt),
        control_dt,
    }
}

/// The spheres of the scene where they are now.
#[inline(always)]
fn spheres<S: Scalar>(world: &World<'_, S>, env: &EnvState<S>) -> Vec<Ball<S>> {
    let mut spheres = Vec::with_capacity(env.task.position.len());
    for number in 0..env.task.position.len() {
        let (centre, radius, _) = logic::sphere(&world.parameters.task, &env.task, S::lit(number as f64));
        spheres.push(Ball { centre, radius });
    }
    spheres
}
