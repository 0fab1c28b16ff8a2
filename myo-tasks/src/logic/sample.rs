//! Drawing the targets of an episode.

use super::{CompiledTask, Point, Sphere, TARGET_STREAM, TargetKind, TaskState, difference, norm, select_point};
use myo_scalar::{Counter, Mask, Scalar, Word, philox, unit};

/// Draws of one position before the farthest of them is taken, closer to its predecessor than asked. A task whose rule can
/// hardly be met is warned about before training.
pub const MAX_DRAWS: u32 = 64;

/// Draws all targets in order where the mask is true. `counter` names the episode; its step and stream are set here.
#[inline(always)]
pub fn draw_targets<S: Scalar>(
    task: &CompiledTask<S::Const>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    state: &mut TaskState<S>,
) {
    for (index, target) in task.targets.iter().enumerate() {
        let (position, size) = match target {
            TargetKind::Button(button) => (button.centre.map(S::splat), S::splat(button.half_size[1])),
            TargetKind::Sphere(sphere) => {
                let counter = Counter { stream: S::Word::splat(TARGET_STREAM + index as u32), ..counter };
                let previous = (index > 0).then(|| state.position[index - 1]);
                draw_sphere(sphere, mask, counter, previous)
            }
        };
        state.position[index] = select_point(mask, position, state.position[index]);
        state.size[index] = S::select(mask, size, state.size[index]);
    }
}

/// Centre and radius; the centre is redrawn while it is too close to the previous one.
#[inline(always)]
fn draw_sphere<S: Scalar>(
    sphere: &Sphere<S::Const>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    previous: Option<Point<S>>,
) -> (Point<S>, S) {
    let mut best = [S::zero(); 3];
    let mut radius = S::zero();
    let mut farthest = S::lit(-1.0);
    for draw in 0..MAX_DRAWS {
        let words = philox(Counter { step: S::Word::splat(draw), ..counter });
        let mut candidate = best;
        for (k, x) in candidate.iter_mut().enumerate() {
            *x = unit::<S>(words[k]).mul_add(S::splat(sphere.extent[k]), S::splat(sphere.lo[k]));
        }
        if draw == 0 {
            radius = unit::<S>(words[3]).mul_add(S::splat(sphere.radius_extent), S::splat(sphere.radius));
        }
        let distance = previous.map_or(S::zero(), |p| norm(difference(candidate, p)));
        // The first candidate far enough is kept: a later one replaces only a closer one.
        let searching = farthest.lt(S::splat(sphere.min_distance)) | farthest.lt(S::zero());
        let better = searching & farthest.lt(distance);
        best = select_point(better, candidate, best);
        farthest = S::select(better, distance, farthest);
        if !(mask & farthest.lt(S::splat(sphere.min_distance))).any() {
            break;
        }
    }
    (best, radius)
}
