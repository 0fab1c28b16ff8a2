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
pub(crate) use within::Gap;

use crate::plan::{Bundle, Plan, RoundShape, Side, Stretch, Way};
use crate::spatial::{Frame, Motion, Rotation, Vec3, Wrench};
use crate::workspace::Workspace;
use course::{angle_through, course_by};
use myo_scalar::{RowMap, Scalar, Stage};
use within::GAP;

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
        let bundles = &plan.tendons.wraps;
        if !S::rows_are_a_loop() {
            find_gaps(bundles, ws);
        }
        let (mut first, mut first_gap) = (0, 0);
        for bundle in bundles {
            S::map_rows(bundle.stretches.len(), &mut Ways { bundle, first, first_gap, ws });
            first += bundle.stretches.len();
            first_gap += bundle.ngap();
        }
    }
}

/// Finds the angles of all ways through round things at once: where rows are not a loop, a round of all takes hardly longer than that of one.
#[inline(always)]
fn find_gaps<S: Scalar>(bundles: &[Bundle<S::Const>], ws: &mut Workspace<S>) {
    let mut first = 0;
    for bundle in bundles {
        S::map_rows(bundle.ngap(), &mut Gaps { bundle, first, ws });
        first += bundle.ngap();
    }
    if !ws.gaps.is_empty() {
        within::settle(&mut ws.gaps);
    }
}

/// What is looked for of a bundle whose ways lead through round things; its first one is the `first`-th of all such.
struct Gaps<'a, S: Scalar> {
    bundle: &'a Bundle<S::Const>,
    first: usize,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> RowMap<S, GIVEN, GAP> for Gaps<'_, S> {
    #[inline(always)]
    fn take(&self, k: usize) -> [S; GIVEN] {
        Given::of(&self.bundle.stretches[k], S::zero(), self.ws).array()
    }
    #[inline(always)]
    fn map(&self, given: [S; GIVEN]) -> [S; GAP] {
        let given = Given::from_array(given);
        course::gap(self.bundle.shape, given.radius, local_ends(self.bundle, &given)).array()
    }
    #[inline(always)]
    fn put(&mut self, k: usize, gap: [S; GAP]) {
        self.ws.gaps[self.first + k] = Gap::from_array(gap);
    }
}

/// The ways of a bundle's stretches, whose first one is the `first`-th of all.
struct Ways<'a, S: Scalar> {
    bundle: &'a Bundle<S::Const>,
    first: usize,
    /// Where its gaps are, if it has some.
    first_gap: usize,
    ws: &'a mut Workspace<S>,
}

impl<S: Scalar> RowMap<S, GIVEN, FOUND> for Ways<'_, S> {
    #[inline(always)]
    fn take(&self, k: usize) -> [S; GIVEN] {
        let psi = match self.bundle.way {
            Way::Through | Way::Either if !S::rows_are_a_loop() => self.ws.gaps[self.first_gap + k].psi(),
            Way::Around | Way::Through | Way::Either => S::zero(),
        };
        Given::of(&self.bundle.stretches[k], psi, self.ws).array()
    }
    #[inline(always)]
    fn map(&self, given: [S; GIVEN]) -> [S; FOUND] {
        way(self.bundle, &Given::from_array(given)).array()
    }
    #[inline(always)]
    fn put(&mut self, k: usize, found: [S; FOUND]) {
        take_in(self.bundle, k, self.first + k, &Found::from_array(found), self.ws);
    }
}

/// What the way of a stretch follows from; places and velocities from O.
struct Given<S> {
    radius: S,
    /// Of the link of the round thing.
    link: Frame<S>,
    /// Of the round thing on its link.
    frame: Frame<S>,
    /// First and last end. The first one of a moored stretch is given from the centre and in axes of the round thing.
    ends: [Vec3<S>; 2],
    /// On the side. One that does not move is given like a moored end.
    side: Vec3<S>,
    /// Velocity of the last end's link against that of the round thing.
    velocity: Motion<S>,
    /// The angle of a way through the round thing, if it was found before.
    psi: S,
}

/// How many numbers that is.
const GIVEN: usize = 41;

impl<S: Scalar> Given<S> {
    #[inline(always)]
    fn of(stretch: &Stretch<S::Const>, psi: S, ws: &Workspace<S>) -> Self {
        let frame = &stretch.round.frame;
        let [x, y, z] = &frame.axes;
        let (middle, last) = (frame.origin.link, &stretch.ends[1]);
        Self {
            radius: S::splat(stretch.round.radius),
            link: ws.frame(middle),
            frame: Frame {
                rotation: Rotation { x: Vec3::splat(*x), y: Vec3::splat(*y), z: Vec3::splat(*z) },
                position: Vec3::splat(frame.origin.position),
            },
            ends: [
                match &stretch.local {
                    Some(local) => Vec3::splat(*local),
                    None => ws.place(&stretch.ends[0]),
                },
                ws.place(last),
            ],
            side: match &stretch.side {
                // It is on no side.
                Side::Any | Side::Inside => Vec3::zero(),
                Side::Fixed(local) => Vec3::splat(*local),
                Side::Moving(point) => ws.place(point),
            },
            velocity: ws.velocity[last.link] - ws.velocity[middle],
            psi,
        }
    }

    #[inline(always)]
    fn array(self) -> [S; GIVEN] {
        let mut out = [self.radius; GIVEN];
        let (link, frame) = (&self.link, &self.frame);
        set(&mut out, 1, link.rotation.x);
        set(&mut out, 4, link.rotation.y);
        set(&mut out, 7, link.rotation.z);
        set(&mut out, 10, link.position);
        set(&mut out, 13, frame.rotation.x);
        set(&mut out, 16, frame.rotation.y);
        set(&mut out, 19, frame.rotation.z);
        set(&mut out, 22, frame.position);
        set(&mut out, 25, self.ends[0]);
        set(&mut out, 28, self.ends[1]);
        set(&mut out, 31, self.side);
        set(&mut out, 34, self.velocity.ang);
        set(&mut out, 37, self.velocity.lin);
        out[40] = self.psi;
        out
    }

    #[inline(always)]
    fn from_array(x: [S; GIVEN]) -> Self {
        Self {
            radius: x[0],
            link: Frame {
                rotation: Rotation { x: vector(&x, 1), y: vector(&x, 4), z: vector(&x, 7) },
                position: vector(&x, 10),
            },
            frame: Frame {
                rotation: Rotation { x: vector(&x, 13), y: vector(&x, 16), z: vector(&x, 19) },
                position: vector(&x, 22),
            },
            ends: [vector(&x, 25), vector(&x, 28)],
            side: vector(&x, 31),
            velocity: Motion { ang: vector(&x, 34), lin: vector(&x, 37) },
            psi: x[40],
        }
    }
}

/// What is found of a stretch.
struct Found<S> {
    length: S,
    /// As far as the last end moves.
    rate: S,
    /// At the last end.
    arriving: Wrench<S>,
    /// At the first end, of a stretch that is not moored.
    leaving: Wrench<S>,
    /// One where it bends, else zero.
    bends: S,
}

/// How many numbers that is.
const FOUND: usize = 15;

impl<S: Scalar> Found<S> {
    #[inline(always)]
    fn array(self) -> [S; FOUND] {
        let mut out = [self.bends; FOUND];
        (out[0], out[1]) = (self.length, self.rate);
        set(&mut out, 2, self.arriving.ang);
        set(&mut out, 5, self.arriving.lin);
        set(&mut out, 8, self.leaving.ang);
        set(&mut out, 11, self.leaving.lin);
        out
    }

    #[inline(always)]
    fn from_array(x: [S; FOUND]) -> Self {
        Self {
            length: x[0],
            rate: x[1],
            arriving: Wrench { ang: vector(&x, 2), lin: vector(&x, 5) },
            leaving: Wrench { ang: vector(&x, 8), lin: vector(&x, 11) },
            bends: x[14],
        }
    }
}

#[inline(always)]
fn vector<S: Scalar, const N: usize>(numbers: &[S; N], first: usize) -> Vec3<S> {
    Vec3::new(numbers[first], numbers[first + 1], numbers[first + 2])
}

#[inline(always)]
fn set<S: Scalar, const N: usize>(numbers: &mut [S; N], first: usize, v: Vec3<S>) {
    (numbers[first], numbers[first + 1], numbers[first + 2]) = (v.x, v.y, v.z);
}

/// The way of a stretch. Its line grows as the last end moves away from the round thing.
#[inline(always)]
fn way<S: Scalar>(bundle: &Bundle<S::Const>, given: &Given<S>) -> Found<S> {
    let Given { radius, link, frame, ends: [first, last], .. } = given;
    let shape = bundle.shape;
    let side = match bundle.way {
        Way::Around => OnSide::Of(given.side),
        Way::Through => OnSide::Inside,
        Way::Either => {
            let side = local(shape, frame, link.seen(given.side));
            OnSide::Either(side, side.dot(side).lt(*radius * *radius))
        }
    };
    let ends = local_ends(bundle, given);
    let psi = if S::rows_are_a_loop() { angle_through(shape, *radius, side, ends) } else { given.psi };
    let course = course_by(shape, bundle.rule, *radius, side, psi, ends);
    let arriving = Wrench::at(*last, world(shape, given, course.arriving));
    let leaving = match bundle.is_moored {
        true => Wrench::zero(),
        false => Wrench::at(*first, world(shape, given, course.leaving)),
    };
    let rate = given.velocity.dot(arriving);
    Found { length: course.length, rate, arriving, leaving, bends: S::indicator(course.bends) }
}

/// The ends from the centre and in axes of the round thing.
#[inline(always)]
fn local_ends<S: Scalar>(bundle: &Bundle<S::Const>, given: &Given<S>) -> [Vec3<S>; 2] {
    let Given { link, frame, ends: [first, last], .. } = given;
    let a = if bundle.is_moored { *first } else { local(bundle.shape, frame, link.seen(*first)) };
    [a, local(bundle.shape, frame, link.seen(*last))]
}

/// A direction that is given in axes of the round thing.
#[inline(always)]
fn world<S: Scalar>(shape: RoundShape, given: &Given<S>, direction: Vec3<S>) -> Vec3<S> {
    match shape {
        RoundShape::Sphere => given.link.rotation.apply(direction),
        RoundShape::Cylinder => given.link.rotation.apply(given.frame.rotation.apply(direction)),
    }
}

/// A place in axes of the round thing.
#[inline(always)]
fn local<S: Scalar>(shape: RoundShape, frame: &Frame<S>, place: Vec3<S>) -> Vec3<S> {
    match shape {
        RoundShape::Sphere => place - frame.position,
        RoundShape::Cylinder => frame.seen(place),
    }
}

/// Takes in what was found of stretch `k` of a bundle, the `number`-th of all.
#[inline(always)]
fn take_in<S: Scalar>(bundle: &Bundle<S::Const>, k: usize, number: usize, found: &Found<S>, ws: &mut Workspace<S>) {
    let stretch = &bundle.stretches[k];
    let mut rate = found.rate;
    if !bundle.is_moored {
        let middle = stretch.round.frame.origin.link;
        rate += (ws.velocity[middle] - ws.velocity[stretch.ends[0].link]).dot(found.leaving);
        ws.wrap_lines[number][0] = found.leaving;
    }
    ws.wrap_lines[number][1] = found.arriving;
    ws.wrap_bends[number] = found.bends;
    ws.tendon_length[stretch.muscle] += found.length;
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
