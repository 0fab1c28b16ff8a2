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

use crate::plan::{Bundle, Plan, RoundShape, Side, Stretch, Way};
use crate::spatial::{Frame, Rotation, Vec3, Wrench};
use crate::workspace::Workspace;
use myo_scalar::{RowMap, Scalar, Stage};

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
        let mut first = 0;
        for bundle in &plan.tendons.wraps {
            S::map_rows(bundle.stretches.len(), &mut Ways { bundle, first, ws });
            first += bundle.stretches.len();
        }
    }
}

/// The ways of a bundle's stretches, whose first one is the `first`-th of all.
struct Ways<'a, S: Scalar> {
    bundle: &'a Bundle<S::Const>,
    first: usize,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> RowMap<S, GIVEN, FOUND> for Ways<'_, S> {
    #[inline(always)]
    fn take(&self, k: usize) -> [S; GIVEN] {
        Given::of(&self.bundle.stretches[k], self.ws).array()
    }
    #[inline(always)]
    fn map(&self, given: [S; GIVEN]) -> [S; FOUND] {
        way(self.bundle, Given::from_array(given))
    }
    #[inline(always)]
    fn put(&mut self, k: usize, found: [S; FOUND]) {
        take_in(self.bundle, k, self.first + k, found, self.ws);
    }
}

/// What the way of a stretch follows from. Points are given in axes of the link of the round thing, except for those that are
/// fixed to it.
struct Given<S> {
    radius: S,
    /// Of the round thing.
    frame: Frame<S>,
    /// First and last end. The first one of a moored stretch is given from the centre and in axes of the round thing.
    ends: [Vec3<S>; 2],
    /// On the side. One that does not move is given like a moored end.
    side: Vec3<S>,
}

/// How many numbers that is.
const GIVEN: usize = 22;
/// Numbers that tell a way: its length, the directions of its last and its first line, and one where it bends.
const FOUND: usize = 8;

impl<S: Scalar> Given<S> {
    #[inline(always)]
    fn of(stretch: &Stretch<S::Const>, ws: &Workspace<S>) -> Self {
        let frame = &stretch.round.frame;
        let link = ws.frame(frame.origin.link);
        let first = match &stretch.local {
            Some(local) => Vec3::splat(*local),
            None => link.seen(ws.place(&stretch.ends[0])),
        };
        let [x, y, z] = &frame.axes;
        Self {
            radius: S::splat(stretch.round.radius),
            frame: Frame {
                rotation: Rotation { x: Vec3::splat(*x), y: Vec3::splat(*y), z: Vec3::splat(*z) },
                position: Vec3::splat(frame.origin.position),
            },
            ends: [first, link.seen(ws.place(&stretch.ends[1]))],
            side: match &stretch.side {
                // It is on no side.
                Side::Any | Side::Inside => Vec3::zero(),
                Side::Fixed(local) => Vec3::splat(*local),
                Side::Moving(point) => link.seen(ws.place(point)),
            },
        }
    }

    #[inline(always)]
    fn array(self) -> [S; GIVEN] {
        let Self { radius, frame: Frame { rotation: Rotation { x, y, z }, position: p }, ends: [a, b], side: s } = self;
        [
            radius, p.x, p.y, p.z, x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z, a.x, a.y, a.z, b.x, b.y, b.z, s.x, s.y,
            s.z,
        ]
    }

    #[inline(always)]
    fn from_array(numbers: [S; GIVEN]) -> Self {
        let vector = Self::vector;
        Self {
            radius: numbers[0],
            frame: Frame {
                rotation: Rotation { x: vector(&numbers, 4), y: vector(&numbers, 7), z: vector(&numbers, 10) },
                position: vector(&numbers, 1),
            },
            ends: [vector(&numbers, 13), vector(&numbers, 16)],
            side: vector(&numbers, 19),
        }
    }

    #[inline(always)]
    fn vector(numbers: &[S; GIVEN], first: usize) -> Vec3<S> {
        Vec3::new(numbers[first], numbers[first + 1], numbers[first + 2])
    }
}

/// The way of a stretch, in axes of the link of the round thing.
#[inline(always)]
fn way<S: Scalar>(bundle: &Bundle<S::Const>, given: Given<S>) -> [S; FOUND] {
    let Given { radius, frame, ends: [a, b], side } = given;
    let shape = bundle.shape;
    let a = if bundle.is_moored { a } else { local(shape, &frame, a) };
    let b = local(shape, &frame, b);
    let side = match bundle.way {
        Way::Around => OnSide::Of(side),
        Way::Through => OnSide::Inside,
        Way::Either => {
            let side = local(shape, &frame, side);
            OnSide::Either(side, side.dot(side).lt(radius * radius))
        }
    };
    let Course { length, leaving, arriving, bends } = course(shape, radius, side, [a, b]);
    let [leaving, arriving] = match shape {
        RoundShape::Sphere => [leaving, arriving],
        RoundShape::Cylinder => [frame.rotation.apply(leaving), frame.rotation.apply(arriving)],
    };
    let (l, a) = (leaving, arriving);
    [length, a.x, a.y, a.z, l.x, l.y, l.z, S::indicator(bends)]
}

/// A place in axes of the round thing.
#[inline(always)]
fn local<S: Scalar>(shape: RoundShape, frame: &Frame<S>, place: Vec3<S>) -> Vec3<S> {
    match shape {
        RoundShape::Sphere => place - frame.position,
        RoundShape::Cylinder => frame.seen(place),
    }
}

/// Takes in what was found of stretch `k` of a bundle, the `number`-th of all. Both lines grow as their ends move apart, the round
/// thing being one end of each.
#[inline(always)]
fn take_in<S: Scalar>(
    bundle: &Bundle<S::Const>,
    k: usize,
    number: usize,
    [length, ax, ay, az, lx, ly, lz, bends]: [S; FOUND],
    ws: &mut Workspace<S>,
) {
    let stretch = &bundle.stretches[k];
    let middle = stretch.round.frame.origin.link;
    let rotation = ws.rotation[middle];
    let [first, last] = &stretch.ends;
    let arriving = Wrench::at(ws.place(last), rotation.apply(Vec3::new(ax, ay, az)));
    let mut rate = (ws.velocity[last.link] - ws.velocity[middle]).dot(arriving);
    if !bundle.is_moored {
        let leaving = Wrench::at(ws.place(first), rotation.apply(Vec3::new(lx, ly, lz)));
        rate += (ws.velocity[middle] - ws.velocity[first.link]).dot(leaving);
        ws.wrap_lines[number][0] = leaving;
    }
    ws.wrap_lines[number][1] = arriving;
    ws.wrap_bends[number] = bends;
    ws.tendon_length[stretch.muscle] += length;
    ws.tendon_velocity[stretch.muscle] += rate;
}

/// Adds the muscle forces on these stretches to `wrench`.
#[inline(always)]
pub(super) fn pull<S: Scalar>(plan: &Plan<S::Const>, ws: &mut Workspace<S>) {
    let mut lines = ws.wrap_lines.iter();
    let (forces, wrench) = (&ws.muscle_force[..], &mut ws.wrench[..]);
    for bundle in &plan.tendons.wraps {
        for (stretch, [leaving, arriving]) in bundle.stretches.iter().zip(&mut lines) {
            let force = forces[stretch.muscle];
            let middle = stretch.round.frame.origin.link;
            let [first, last] = stretch.ends.each_ref().map(|end| end.link);
            draw(wrench, [middle, last], arriving, force);
            if !bundle.is_moored {
                draw(wrench, [first, middle], leaving, force);
            }
        }
    }
}

/// Adds a force along the line from one link to another. The world is link 0: nobody asks what pulls on it.
#[inline(always)]
fn draw<S: Scalar>(wrench: &mut [Wrench<S>], [from, to]: [usize; 2], line: &Wrench<S>, force: S) {
    if to != 0 {
        wrench[to] = line.mul_add(force, wrench[to]);
    }
    if from != 0 {
        wrench[from] = line.mul_add(-force, wrench[from]);
    }
}
