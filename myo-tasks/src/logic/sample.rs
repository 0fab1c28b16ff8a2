//! Drawing the objects of an episode.

use super::order::draw_order;
use super::shift::{draw_shifts, drawn};
use super::slide::draw_values;
use super::swing::draw_angles;
use super::waves::draw_phases;
use super::{CompiledTask, DrawnSphere, Point, TARGET_STREAM, TaskState, Which, difference, norm, select_point};
use myo_scalar::{Carried, Counter, Scalar, Visitor, Word, philox, unit};

/// Draws of one position before the farthest of them is taken, closer to its predecessor than asked. A task whose rule can
/// hardly be met is warned about before training.
pub const MAX_DRAWS: u32 = 64;

/// Draws where groups, boxes and spheres are, where paths begin, where handles and sticks stand and in which order steps come, where the
/// mask is true. `counter` names the episode; its step and stream are set here.
#[inline(always)]
pub fn draw_objects<S: Scalar>(
    task: &CompiledTask<S>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    state: &mut TaskState<S>,
) {
    draw_shifts(&task.shifts, mask, counter, state);
    draw_spheres(task, mask, counter, state);
    draw_phases(task, mask, counter, state);
    draw_values(task, mask, counter, state);
    draw_angles(task, mask, counter, state);
    draw_order(task, mask, counter, state);
}

/// Draws all spheres in order.
#[inline(always)]
fn draw_spheres<S: Scalar>(task: &CompiledTask<S>, mask: S::Mask, counter: Counter<S::Word>, state: &mut TaskState<S>) {
    for (index, sphere) in task.spheres.iter().enumerate() {
        let counter = Counter { stream: S::Word::splat(TARGET_STREAM + sphere.number), ..counter };
        let previous = sphere.previous.map(|previous| match previous {
            Which::Sphere(index) => state.position[index],
            Which::Box(index) => task.shifts.move_box(state, S::lit(index as f64), task.boxes[index].shape.centre),
        });
        let shift = task.shifts.spheres.get(index).map(|&number| drawn(&state.shifts, number));
        let (position, radius) = draw_sphere(sphere, shift, mask, counter, previous);
        state.position[index] = select_point(mask, position, state.position[index]);
        state.size[index] = S::select(mask, radius, state.size[index]);
    }
}

/// Centre and radius; the centre is redrawn while it is too close to the previous one.
#[inline(always)]
fn draw_sphere<S: Scalar>(
    sphere: &DrawnSphere<S>,
    shift: Option<Point<S>>,
    mask: S::Mask,
    counter: Counter<S::Word>,
    previous: Option<Point<S>>,
) -> (Point<S>, S) {
    let least = sphere.min_distance;
    let mut corner = sphere.lo;
    for (x, shift) in corner.iter_mut().zip(shift.into_iter().flatten()) {
        *x += shift;
    }
    let mut search = Search {
        draw: S::Word::splat(0),
        best: [S::zero(); 3],
        // Nothing is closer than minus one, so the first candidate is always taken.
        farthest: S::lit(-1.0),
        radius: S::zero(),
    };
    S::repeat_while(MAX_DRAWS as usize, &mut search, |search| {
        let words = philox::<S>(Counter { step: search.draw, ..counter });
        let mut candidate = search.best;
        for (k, x) in candidate.iter_mut().enumerate() {
            *x = unit::<S>(words[k]).mul_add(sphere.extent[k], corner[k]);
        }
        let radius = unit::<S>(words[3]).mul_add(sphere.radius_extent, sphere.radius);
        let first = search.farthest.lt(S::zero());
        search.radius = S::select(first, radius, search.radius);
        let distance = previous.map_or(S::zero(), |p| norm(difference(candidate, p)));
        // The first candidate far enough is kept: a later one replaces only a closer one.
        let searching = search.farthest.lt(least) | first;
        let better = searching & search.farthest.lt(distance);
        search.best = select_point(better, candidate, search.best);
        search.farthest = S::select(better, distance, search.farthest);
        search.draw = search.draw + S::Word::splat(1);
        mask & search.farthest.lt(least)
    });
    (search.best, search.radius)
}

/// The search for a centre.
struct Search<S: Scalar> {
    /// Draws so far.
    draw: S::Word,
    /// The candidate that is farthest from the previous target.
    best: Point<S>,
    /// Its distance from it.
    farthest: S,
    /// Radius, of the first draw.
    radius: S,
}

impl<S: Scalar> Carried<S> for Search<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.word(&mut self.draw);
        visitor.numbers(self.best.iter_mut().chain([&mut self.farthest, &mut self.radius]));
    }
}
