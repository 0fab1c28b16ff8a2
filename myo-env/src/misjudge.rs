//! Targets that seem to be elsewhere: who aims misjudges where a target is from the hand, by a share of how far that is.
//!
//! How wrong one is is drawn for each target and shrinks as the pointer comes nearer, so that the first movement ends beside the target, the more so the
//! farther it was, and is corrected. Where movements of people end that nothing corrects scatters with their length, more along the way
//! than across it (Gordon et al. 1994, doi 10.1007/BF00241415). And who looks again judges anew: step by step what was drawn is forgotten and something else
//! takes its place. Else a user who takes a target beside its finger for being under it stays there.

use crate::parameters::{Vision, World};
use crate::state::EnvState;
use myo_scalar::{Counter, Scalar, Stage, Word, normal_pair, philox};
use myo_tasks::logic::{Point, dot, norm};

/// Random streams of how wrong one is, at the start of an episode and later.
const FIRST_STREAM: u32 = 0x7001;
const VISION_STREAM: u32 = 0x7000;
/// Numbers that this takes, see [`EnvState::misjudged`].
pub const DRAWS: usize = 3;
/// As if a target were so much (m) farther away than it is: where hand and target are to each other is not quite known near the target, either. With
/// a share of 0.2 it is 0.2 mm along the way; ten times as much bent Fitts' law, and four times as much made fingers miss keys (`docs/search.md`).
const NEAR: f64 = 0.001;
/// How much of it is across the way, as a share of that along it.
const ACROSS: f64 = 0.5;
/// Standard deviations by which a distance is misjudged at most. Who took a target for being where the hand is, half way to it, would look for it there
/// for ever; people notice.
const MOST: f64 = 2.0;

/// Draws how wrong one is about the current target at the start of an episode, where the mask is true.
#[inline(always)]
pub fn look<S: Scalar>(world: &World<'_, S>, mask: S::Mask, env: &mut EnvState<S>) {
    if world.parameters.vision_noise.is_some() {
        let [kept, fresh] = [S::lit(1.0), S::zero()];
        S::outline(Look { stream: FIRST_STREAM, anew: mask, kept, fresh, env });
    }
}

/// How wrong one is a control step later, about another target where the mask is true.
#[inline(always)]
pub fn look_again<S: Scalar>(world: &World<'_, S>, begins: S::Mask, env: &mut EnvState<S>) {
    if let Some(Vision { kept, fresh, .. }) = world.parameters.vision_noise {
        S::outline(Look { stream: VISION_STREAM, anew: begins, kept, fresh, env });
    }
}

struct Look<'a, S: Scalar> {
    stream: u32,
    anew: S::Mask,
    kept: S,
    fresh: S,
    env: &'a mut EnvState<S>,
}

impl<S: Scalar> Stage<S> for Look<'_, S> {
    const NAME: &'static str = "how far off targets seem";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { stream, anew, kept, fresh, env } = self;
        let words = philox::<S>(Counter { stream: S::Word::splat(stream), ..env.counter() });
        let ((a, b), (c, _)) = (normal_pair(words[0], words[1]), normal_pair(words[2], words[3]));
        for (number, draw) in env.misjudged.iter_mut().zip([a, b, c]) {
            *number = S::select(anew, draw, number.mul_add(kept, draw * fresh));
        }
    }
}

/// How far off a place seems that is `away` (m); none where everything is seen as it is.
#[inline(always)]
pub fn seems_off<S: Scalar>(world: &World<'_, S>, env: &EnvState<S>, away: Point<S>) -> Option<Point<S>> {
    let (Vision { share, .. }, &[x, y, z]) = (world.parameters.vision_noise?, &env.misjudged[..]) else { return None };
    let (wrong, distance) = ([x, y, z], norm(away));
    // Where there is no way there is nothing along it.
    let per_length = (distance + S::lit(1e-9)).recip();
    let along = dot(wrong, away) * per_length;
    let more = along.clamp(-MOST, MOST) - along * S::lit(ACROSS);
    let per_metre = more * per_length;
    let size = share * (distance + S::lit(NEAR).only(S::zero().lt(distance)));
    Some([0, 1, 2].map(|k| size * wrong[k].mul_add(S::lit(ACROSS), per_metre * away[k])))
}
