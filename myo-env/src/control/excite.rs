//! From actions to excitations: the range of controls, stretch reflexes, motor noise, and fatigue.

use super::{Scratch, stages, sum_of_squares};
use crate::parameters::{Motor, Reflex, World};
use crate::state::EnvState;
use myo_dynamics::{State, Workspace, step};
use myo_muscle::{left_of, noisy_excitation};
use myo_scalar::{Counter, Scalar, Word, normal_pair, philox};
use myo_tasks::Control;

/// Random stream of motor noise.
const NOISE_STREAM: u32 = 0x1000;

/// The excitation that an action from -1 to 1 asks a muscle for whose activation is `act`.
#[inline(always)]
pub fn excitation<S: Scalar>(control: Control, action: S, act: S) -> S {
    let action = action.clamp(-1.0, 1.0);
    match control {
        Control::Absolute => action.mul_add(S::lit(0.5), S::lit(0.5)),
        Control::Relative => (act + action).clamp(0.0, 1.0),
    }
}

/// Maps actions (in `ctrl`) to [excitations](excitation) and adds reflexes and motor noise, which begins anew with each episode; then muscles tire,
/// and none is excited beyond what is left of it.
#[inline(always)]
pub fn excite<S: Scalar>(world: &World<'_, S>, env: &mut EnvState<S>, ws: &mut Scratch<S>) {
    let Scratch { physics, ctrl, squared_change, squared_control, draws, .. } = ws;
    for (u, &act) in ctrl.iter_mut().zip(&env.body.act) {
        *u = excitation(world.parameters.control, *u, act);
    }
    *squared_change = remember(ctrl, &mut env.asked);
    if let Some(reflex) = world.parameters.reflex {
        S::outline(stages::ResistStretch { world, reflex, body: &env.body, physics, ctrl });
    }
    if let Some(Motor { deviations: [signal_dependent, constant], process }) = world.parameters.noise {
        let counter = env.counter();
        // One block of random words serves four muscles.
        S::map_chunks(draws, |block, _: [S; 4]| {
            let words = philox::<S>(Counter { stream: S::Word::splat(NOISE_STREAM) + block, ..counter });
            let ((a, b), (c, d)) = (normal_pair(words[0], words[1]), normal_pair(words[2], words[3]));
            [a, b, c, d]
        });
        let begins = S::from_word(env.step).lt(S::lit(0.5));
        for ((u, z), &draw) in ctrl.iter_mut().zip(&mut env.noise).zip(&*draws) {
            *z = S::select(begins, draw, process.next(*z, draw));
            *u = noisy_excitation(*u, signal_dependent, constant, process.deviation(*z));
        }
    }
    // Effort is what is asked for: a tired muscle is not a cheap one.
    *squared_control = sum_of_squares(ctrl);
    tire(world, env, ctrl);
    env.step = env.step + S::Word::splat(1);
}

/// Lets muscles tire by what they do and recover, and be excited as far as they can.
#[inline(always)]
fn tire<S: Scalar>(world: &World<'_, S>, env: &mut EnvState<S>, ctrl: &mut [S]) {
    let Some(tiring) = &world.parameters.fatigue else { return };
    let muscles = ctrl.iter_mut().zip(&mut env.fatigue).zip(&env.body.act).zip(&tiring.group);
    for (((u, fatigued), &act), &group) in muscles {
        *fatigued = tiring.groups[group].next(*fatigued, act, *u);
        *u = left_of(*u, *fatigued);
    }
}

/// Lets muscles that lengthen be excited more, and those that shorten less.
#[inline(always)]
pub fn resist_stretch<S: Scalar>(
    world: &World<'_, S>,
    Reflex { gain, most }: Reflex<S>,
    body: &State<S>,
    physics: &mut Workspace<S>,
    ctrl: &mut [S],
) {
    let plan = &world.tables.plan;
    step::kinematics::kinematics(plan, &body.qpos, &body.qvel, physics);
    step::tendon::lengths(plan, physics);
    let velocity_scale = |muscle: usize| [plan.muscles[muscle].curves.velocity_scale()];
    S::for_rows(velocity_scale, [&physics.tendon_velocity], ctrl, |[scale], [velocity], u| {
        let more = (velocity * scale * gain).max(-most).min(most);
        more.mul_add(u, u).min(S::lit(1.0))
    });
}

/// Sum of squared changes since what was asked before, where that is remembered; remembers what is asked now.
#[inline(always)]
fn remember<S: Scalar>(ctrl: &[S], asked: &mut [S]) -> S {
    let mut sum = S::zero();
    for (&u, before) in ctrl.iter().zip(asked) {
        let change = u - *before;
        sum = change.mul_add(change, sum);
        *before = u;
    }
    sum
}
