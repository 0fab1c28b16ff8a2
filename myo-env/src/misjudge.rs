//! Targets that seem to be elsewhere: who aims misjudges where a target is from the hand, by a share of how far that is.
//!
//! How wrong one is is drawn once for each target and shrinks as the pointer comes nearer, so that the first movement ends beside the target, the more so the
//! farther it was, and is corrected. Where movements of people end that nothing corrects scatters with their length, more along the way
//! than across it (Gordon et al. 1994, doi 10.1007/BF00241415).

use crate::parameters::World;
use crate::state::EnvState;
use myo_scalar::{Counter, Scalar, Stage, Word, normal_pair, philox};
use myo_tasks::logic::{Point, dot, norm};

/// Random stream of how wrong one is.
const VISION_STREAM: u32 = 0x7000;
/// Numbers that this takes, see [`EnvState::misjudged`].
pub const DRAWS: usize = 3;
/// As if a target were so much (m) farther away than it is: where hand and target are to each other is not quite known near the target, either.
const NEAR: f64 = 0.01;
/// How much of it is across the way, as a share of that along it.
const ACROSS: f64 = 0.5;

/// Draws how wrong one is about the current target, where the mask is true.
#[inline(always)]
pub fn misjudge<S: Scalar>(world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>) {
    if world.parameters.vision_noise.is_some() {
        S::outline(Misjudge { mask, env });
    }
}

struct Misjudge<'a, S: Scalar> {
    mask: S::Mask,
    env: &'a mut EnvState<S>,
}

impl<S: Scalar> Stage<S> for Misjudge<'_, S> {
    const NAME: &'static str = "how far off targets seem";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { mask, env } = self;
        let words = philox::<S>(Counter { stream: S::Word::splat(VISION_STREAM), ..env.counter() });
        let ((a, b), (c, _)) = (normal_pair(words[0], words[1]), normal_pair(words[2], words[3]));
        for (number, draw) in env.misjudged.iter_mut().zip([a, b, c]) {
            *number = S::select(mask, draw, *number);
        }
    }
}

/// How far off a place seems that is `away` (m); none where everything is seen as it is.
#[inline(always)]
pub fn seems_off<S: Scalar>(world: &World<'_, S>, env: &EnvState<S>, away: Point<S>) -> Option<Point<S>> {
    let (share, &[x, y, z]) = (world.parameters.vision_noise?, &env.misjudged[..]) else { return None };
    let (wrong, distance) = ([x, y, z], norm(away));
    // Where there is no way there is nothing along it.
    let per_length = (distance + S::lit(1e-9)).recip();
    let along = dot(wrong, away) * per_length * per_length * S::lit(1.0 - ACROSS);
    let size = share * (distance + S::lit(NEAR).only(S::zero().lt(distance)));
    Some([0, 1, 2].map(|k| size * wrong[k].mul_add(S::lit(ACROSS), along * away[k])))
}
