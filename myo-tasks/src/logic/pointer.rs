//! The pointer: what a technique makes of a body's posture.

use super::{Point, difference, norm};
use crate::flat::{self, FlatTask};
use crate::technique::RayFrom;
use myo_model::MOST_FINGERS;
use myo_scalar::{Real, Scalar};
use nalgebra::Rotation3;

/// How far (m) a ray goes that meets nothing.
const FAR: f64 = 20.0;
/// A ray that meets a face at less than this, as the cosine to its normal, is taken as one that meets it at this.
const GRAZING: f64 = 0.05;

/// What points. Lengths m from the shoulder centre.
#[derive(Clone, Debug, PartialEq)]
pub enum Pointer<T> {
    /// The fingertip.
    Fingertip,
    /// Where a ray meets a face; without one, its point nearest to the current object.
    Ray {
        /// What it follows.
        from: RayFrom,
        /// The face.
        onto: Option<Face<T>>,
    },
    /// A hand that reaches farther than the arm.
    GoGo {
        /// Distance from the shoulder centre up to which it is the fingertip.
        beyond: T,
        /// How fast it goes away beyond it (1/m).
        gain: T,
    },
    /// A cursor on a face.
    Cursor {
        /// The face.
        onto: Face<T>,
        /// Where the fingertip is when the cursor is in the middle.
        at: [T; 3],
        /// Directions in which the hand moves it: up the face, and across it.
        hand: [[T; 3]; 2],
        /// Metres of the cursor per metre of the fingertip.
        gain: T,
    },
    /// A cursor on a face that moves as long as the fingertip is off its rest.
    RateCursor {
        /// The face.
        onto: Face<T>,
        /// How far the cursor may go from its middle: up, and across.
        half: [T; 2],
        /// Where the fingertip rests.
        at: [T; 3],
        /// Directions in which the hand moves it: up the face, and across it.
        hand: [[T; 3]; 2],
        /// Metres of the cursor per metre of the fingertip, in a control step.
        gain: T,
        /// How far off its rest the fingertip moves nothing.
        still: T,
    },
}

/// The face of a box.
#[derive(Clone, Debug, PartialEq)]
pub struct Face<T> {
    /// Its middle.
    pub middle: [T; 3],
    /// Its directions: up, across to the left, and out of it.
    pub axes: [[T; 3]; 3],
}

/// Places that techniques go by (m, from the shoulder centre).
#[derive(Clone, Copy, Debug)]
pub struct Landmarks<S> {
    /// The fingertip.
    pub fingertip: Point<S>,
    /// Elbow and wrist; the same as the fingertip where no technique asks for them.
    pub elbow: Point<S>,
    /// See `elbow`.
    pub wrist: Point<S>,
    /// Other fingers that the task asks for; the origin where there are fewer.
    pub fingers: [Point<S>; MOST_FINGERS],
    /// Where a cursor that moves by itself stands, from the middle of its face: up, and across; zeros where there is none.
    pub cursor: [S; 2],
}

impl<S: Scalar> Landmarks<S> {
    /// Before anything is known.
    #[inline(always)]
    pub fn unknown() -> Self {
        let origin = [S::zero(); 3];
        Self {
            fingertip: origin,
            elbow: origin,
            wrist: origin,
            fingers: [origin; MOST_FINGERS],
            cursor: [S::zero(); 2],
        }
    }
}

impl<S: Scalar> Landmarks<S> {
    /// The finger of this number of so many, the first where there is no such one.
    #[inline(always)]
    pub(super) fn finger(&self, count: usize, number: S) -> Point<S> {
        S::gather(count, |k| self.fingers[k], number.max(S::zero()))
    }
}

impl<C: Real> Pointer<C> {
    pub(super) fn new(flat: &FlatTask, control_dt_s: f64) -> Self {
        let c = C::from_f64;
        let hand = |rotation: &Rotation3<f64>| [0, 1].map(|k| [0, 1, 2].map(|row| c(rotation[(row, k)])));
        match &flat.pointer {
            flat::Pointer::Fingertip => Self::Fingertip,
            flat::Pointer::Ray { from, onto } => {
                Self::Ray { from: *from, onto: onto.and_then(|object| Face::new(flat, object)) }
            }
            flat::Pointer::GoGo { beyond_m, gain } => Self::GoGo { beyond: c(*beyond_m), gain: c(*gain) },
            flat::Pointer::Cursor { onto, at, rotation, gain } => match Face::new(flat, *onto) {
                Some(onto) => Self::Cursor { onto, at: at.map(c), hand: hand(rotation), gain: c(*gain) },
                None => Self::Fingertip,
            },
            flat::Pointer::RateCursor { onto, at, rotation, gain_per_s, still_m } => {
                let Some((face, block)) = Face::new(flat, *onto).zip(flat.objects[*onto].block()) else {
                    return Self::Fingertip;
                };
                let [up, across, _] = block.half_extents();
                let (gain, still) = (c(gain_per_s * control_dt_s), c(*still_m));
                let half = [c(up), c(across)];
                Self::RateCursor { onto: face, half, at: at.map(c), hand: hand(rotation), gain, still }
            }
        }
    }
}

impl<C: Real> Face<C> {
    fn new(flat: &FlatTask, object: usize) -> Option<Self> {
        let (block, c) = (flat.objects[object].block()?, C::from_f64);
        let column = |k: usize| [0, 1, 2].map(|row| c(block.rotation[(row, k)]));
        Some(Self { middle: block.face_point(0.0, 0.0).map(c), axes: [column(0), column(1), column(2)] })
    }
}

impl<T> Pointer<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Pointer<U> {
        match self {
            Self::Fingertip => Pointer::Fingertip,
            Self::Ray { from, onto } => Pointer::Ray { from: *from, onto: onto.as_ref().map(|face| face.map(f)) },
            Self::GoGo { beyond, gain } => Pointer::GoGo { beyond: f(beyond), gain: f(gain) },
            Self::Cursor { onto, at, hand, gain } => Pointer::Cursor {
                onto: onto.map(f),
                at: at.each_ref().map(&mut *f),
                hand: hand.each_ref().map(|axis| axis.each_ref().map(&mut *f)),
                gain: f(gain),
            },
            Self::RateCursor { onto, half, at, hand, gain, still } => Pointer::RateCursor {
                onto: onto.map(f),
                half: half.each_ref().map(&mut *f),
                at: at.each_ref().map(&mut *f),
                hand: hand.each_ref().map(|axis| axis.each_ref().map(&mut *f)),
                gain: f(gain),
                still: f(still),
            },
        }
    }

    /// Whether it is the fingertip itself.
    pub const fn is_fingertip(&self) -> bool {
        matches!(self, Self::Fingertip)
    }

    /// Whether it moves by itself.
    pub const fn is_rate_cursor(&self) -> bool {
        matches!(self, Self::RateCursor { .. })
    }

    /// Whether elbow and wrist must be known.
    pub const fn is_ray(&self) -> bool {
        matches!(self, Self::Ray { .. })
    }
}

impl<T> Face<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Face<U> {
        Face {
            middle: self.middle.each_ref().map(&mut *f),
            axes: self.axes.each_ref().map(|axis| axis.each_ref().map(&mut *f)),
        }
    }
}

impl<S: Scalar> Pointer<S> {
    /// Where it is, with the current object at `goal` (m).
    #[inline(always)]
    pub fn place(&self, body: &Landmarks<S>, goal: Point<S>) -> Point<S> {
        match self {
            Self::Fingertip => body.fingertip,
            Self::Ray { from, onto } => {
                let (from, origin) = match from {
                    RayFrom::Forearm => (body.elbow, body.wrist),
                    RayFrom::Hand => (body.wrist, body.fingertip),
                };
                ray(from, origin, onto.as_ref(), goal)
            }
            Self::GoGo { beyond, gain } => {
                let reach = norm(body.fingertip);
                let more = (reach - *beyond).max(S::zero());
                // A fingertip at the shoulder centre has no direction, and is not beyond anything either.
                let factor = (more * more).mul_add(*gain * reach.max(S::lit(1e-6)).recip(), S::lit(1.0));
                body.fingertip.map(|x| x * factor)
            }
            Self::Cursor { onto, at, hand, gain } => {
                let off = difference(body.fingertip, *at);
                onto.at([dot(off, hand[0]) * *gain, dot(off, hand[1]) * *gain])
            }
            Self::RateCursor { onto, .. } => onto.at(body.cursor),
        }
    }

    /// How far (m) the body is from having it at the goal: of what moves by itself, from its rest.
    #[inline(always)]
    pub fn gap(&self, body: &Landmarks<S>, goal: Point<S>) -> S {
        match self {
            Self::RateCursor { at, .. } => norm(difference(body.fingertip, *at)),
            _ => norm(difference(self.place(body, goal), goal)),
        }
    }

    /// Where it may be in time, with the body here: what moves by itself comes to whatever is on its face.
    #[inline(always)]
    pub fn place_in_time(&self, body: &Landmarks<S>, goal: Point<S>) -> Point<S> {
        match self {
            Self::RateCursor { onto, half, .. } => {
                let off = difference(goal, onto.middle);
                let [up, across] = [0, 1].map(|k| within(dot(off, onto.axes[k]), half[k]));
                onto.at([up, across])
            }
            _ => self.place(body, goal),
        }
    }

    /// Where a cursor that moves by itself stands a `share` of a control step later, with the body here.
    #[inline(always)]
    pub fn moved(&self, body: &Landmarks<S>, share: f64) -> [S; 2] {
        let Self::RateCursor { half, at, hand, gain, still, .. } = self else { return body.cursor };
        let off = difference(body.fingertip, *at);
        let [up, across] = [dot(off, hand[0]), dot(off, hand[1])];
        let far = up.mul_add(up, across * across).sqrt();
        // Nearer to its rest than a micrometre the fingertip has no direction, and moves nothing.
        let rate = (far - *still).max(S::zero()) * far.max(S::lit(1e-6)).recip() * *gain * S::lit(share);
        let [x, y] = body.cursor;
        [within(up.mul_add(rate, x), half[0]), within(across.mul_add(rate, y), half[1])]
    }
}

impl<S: Scalar> Face<S> {
    /// The place that is so far (m) up and across from the middle.
    #[inline(always)]
    fn at(&self, [up, across]: [S; 2]) -> Point<S> {
        let mut place = self.middle;
        for (k, x) in place.iter_mut().enumerate() {
            *x = self.axes[0][k].mul_add(up, self.axes[1][k].mul_add(across, *x));
        }
        place
    }
}

/// The nearest number that is at most so far from zero.
#[inline(always)]
fn within<S: Scalar>(x: S, most: S) -> S {
    x.min(most).max(-most)
}

/// Where the ray from `origin`, away from `from`, meets the face; without one, its point that is nearest to the goal.
#[inline(always)]
fn ray<S: Scalar>(from: Point<S>, origin: Point<S>, onto: Option<&Face<S>>, goal: Point<S>) -> Point<S> {
    let way = difference(origin, from);
    let scale = norm(way).max(S::lit(1e-6)).recip();
    let direction = [way[0] * scale, way[1] * scale, way[2] * scale];
    let along = match onto {
        Some(face) => {
            let normal = face.axes[2];
            let above = dot(difference(origin, face.middle), normal);
            // The ray goes against the normal; one that does not meets the face far away.
            let towards = (S::zero() - dot(direction, normal)).max(S::lit(GRAZING));
            above * towards.recip()
        }
        None => dot(difference(goal, origin), direction),
    };
    let along = along.clamp(0.0, FAR);
    [0, 1, 2].map(|k| direction[k].mul_add(along, origin[k]))
}

#[inline(always)]
fn dot<S: Scalar>(a: Point<S>, b: Point<S>) -> S {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}
