//! Muscle paths over spheres and cylinders, as MuJoCo defines them.
//!
//! A path pulls on what its two straight ends are fixed to, along these lines, and on the round thing with what is left:
//! the arc between rests on it, and by the principle of virtual work its shape does not matter. So two lines are all that
//! forces and rates need, each six numbers as of a straight segment (see [`tendon`](super::tendon)).
//!
//! Where the path does not bend, both lines are the straight one.

mod around;
mod course;
mod flat;
mod within;

pub use course::{Course, OnSide, Round, course, points};

use crate::plan::{Plan, RoundThing, Side, Stretch};
use crate::spatial::{Frame, Vec3, Wrench};
use crate::workspace::Workspace;
use myo_scalar::{Scalar, Stage};

/// Adds the lengths and rates of the stretches that may bend; fills their lines.
#[inline(always)]
pub(super) fn lengths<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    if !plan.tendons.wraps.is_empty() {
        S::outline(Lengths { plan, ws });
    }
}

/// A function of its own: bodies without wraps must not pay for the size of this one.
struct Lengths<'a, S: Scalar> {
    plan: &'a Plan<S::Const>,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> Stage<S> for Lengths<'_, S> {
    const NAME: &'static str = "muscle paths over wraps";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { plan, ws } = self;
        let mut number = 0;
        for thing in &plan.tendons.wraps {
            let round = Round { shape: thing.shape, radius: S::splat(thing.radius), frame: ws.fixed(&thing.frame) };
            for stretch in &thing.stretches {
                let course = course_of(stretch, &round, ws);
                let lines = [
                    Wrench::at(ws.place(&stretch.ends[0]), course.leaving),
                    Wrench::at(ws.place(&stretch.ends[1]), course.arriving),
                ];
                ws.tendon_length[stretch.muscle] += course.length;
                let rate = rate(thing, stretch, &lines, ws);
                ws.tendon_velocity[stretch.muscle] += rate;
                ws.wrap_lines[number] = lines;
                number += 1;
            }
        }
    }
}

#[inline(always)]
fn course_of<S: Scalar>(stretch: &Stretch<S::Const>, round: &Round<S>, ws: &Workspace<S>) -> Course<S> {
    let (a, b) = (ws.place(&stretch.ends[0]), ws.place(&stretch.ends[1]));
    let local = [local(&round.frame, &stretch.local[0], a), local(&round.frame, &stretch.local[1], b)];
    let side = match &stretch.side {
        Side::Any => OnSide::Any,
        Side::Inside => OnSide::Inside,
        Side::Fixed(local) => OnSide::Of(Vec3::splat(*local)),
        Side::Moving(point) => {
            let side = round.frame.rotation.apply_inverse(ws.place(point) - round.frame.position);
            OnSide::Either(side, side.dot(side).lt(round.radius * round.radius))
        }
    };
    course(round, side, [a, b], local)
}

/// A place in axes of the round thing: known, if it is on the same link.
#[inline(always)]
fn local<S: Scalar>(frame: &Frame<S>, known: &Option<[S::Const; 3]>, place: Vec3<S>) -> Vec3<S> {
    match known {
        Some(local) => Vec3::splat(*local),
        None => frame.rotation.apply_inverse(place - frame.position),
    }
}

/// Rate of the length: both lines grow as their ends move apart, the round thing being one end of each.
#[inline(always)]
fn rate<S: Scalar>(
    thing: &RoundThing<S::Const>,
    stretch: &Stretch<S::Const>,
    [leaving, arriving]: &[Wrench<S>; 2],
    ws: &Workspace<S>,
) -> S {
    let middle = ws.velocity[thing.frame.origin.link];
    let (a, b) = (ws.velocity[stretch.ends[0].link], ws.velocity[stretch.ends[1].link]);
    (middle - a).dot(*leaving) + (b - middle).dot(*arriving)
}

/// Adds the muscle forces on these stretches to `wrench`.
#[inline(always)]
pub(super) fn pull<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let mut lines = ws.wrap_lines.iter();
    for thing in &plan.tendons.wraps {
        for (stretch, [leaving, arriving]) in thing.stretches.iter().zip(&mut lines) {
            let force = ws.muscle_force[stretch.muscle];
            let zero = Wrench::zero();
            let (leaving, arriving) = (leaving.mul_add(force, zero), arriving.mul_add(force, zero));
            let [a, b] = stretch.ends.each_ref().map(|end| end.link);
            let middle = thing.frame.origin.link;
            // The world is link 0: nobody asks what pulls on it.
            if a != 0 {
                ws.wrench[a] -= leaving;
            }
            if b != 0 {
                ws.wrench[b] += arriving;
            }
            if middle != 0 {
                ws.wrench[middle] += leaving - arriving;
            }
        }
    }
}
