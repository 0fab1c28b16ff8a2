//! What other fingers do while one points: be in spheres of their own, or come to its tip.
//!
//! A pinch is one only where fingers come together: who arrives with closed fingers, or closes them on the way, has pinched
//! nothing there, and must open them first.

use super::reward::distance_to_face;
use super::touch::Asked;
use super::{
    CompiledTask, Goal, GoalButton, Landmarks, Point, Stay, TaskState, TouchBox, difference, dot, goal, is_same, norm,
    select_point,
};
use crate::flat;
use myo_model::StaticBox;
use myo_scalar::{Mask, Real, Scalar};

/// How a step wants the fingertip and another finger to come together. Lengths m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinchStep<T> {
    /// Number of the finger; negative where the step is no pinch.
    pub finger: T,
    /// Nearer than this they are together.
    pub closer_than: T,
    /// Farther than this they are apart.
    pub apart: T,
}

impl<C: Real> PinchStep<C> {
    pub(super) fn new(pinch: Option<&flat::Pinch>) -> Self {
        let c = C::from_f64;
        pinch.map_or(Self { finger: c(-1.0), closer_than: c(0.0), apart: c(0.0) }, |pinch| Self {
            finger: c(pinch.finger as f64),
            closer_than: c(pinch.closer_than),
            apart: c(pinch.apart),
        })
    }
}

impl<T> PinchStep<T> {
    #[inline(always)]
    pub(super) fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> PinchStep<U> {
        PinchStep { finger: f(&self.finger), closer_than: f(&self.closer_than), apart: f(&self.apart) }
    }
}

/// Where another finger must be during the current step.
#[derive(Clone, Debug)]
pub struct GoalFinger<S: Scalar> {
    /// Where it must be anywhere at all.
    pub is_asked: S::Mask,
    /// Centre of its sphere at the beginning of the control step (m).
    pub centre: Point<S>,
    /// How far the centre moves within the control step (m); none where all stands still.
    pub moves: Option<Point<S>>,
    /// Radius of the sphere, half the width of the button (m).
    pub size: S,
    /// The button that it must press, in tasks in which other fingers press.
    pub button: Option<FingerButton<S>>,
}

/// A button that another finger must press.
#[derive(Clone, Copy, Debug)]
pub struct FingerButton<S: Scalar> {
    /// Its number among the boxes; negative where it must press none.
    pub number: S,
    /// Where it is, and how large.
    pub shape: StaticBox<S>,
    /// Force that counts as pressed (N).
    pub min_force: S,
}

/// The pinch that the current step asks for.
#[derive(Clone, Copy, Debug)]
pub struct GoalPinch<S: Scalar> {
    /// Where it asks for one.
    pub is_pinch: S::Mask,
    /// How.
    pub step: PinchStep<S>,
}

impl<S: Scalar> GoalFinger<S> {
    /// Of all fingers of the task in the step of this number.
    #[inline(always)]
    pub(super) fn all(task: &CompiledTask<S>, state: &TaskState<S>, number: S, goal: &Goal<S>) -> Vec<Self> {
        if !task.kinds.also {
            return vec![];
        }
        (0..task.fingers.len()).map(|finger| Self::of(task, state, (finger, number), goal)).collect()
    }

    #[inline(always)]
    fn of(task: &CompiledTask<S>, state: &TaskState<S>, (finger, number): (usize, S), goal: &Goal<S>) -> Self {
        let (also, is_press) = (&task.also, goal.is_press);
        let [mut object] = S::gather(also.len(), |k| [also[k][finger]], number);
        // What corrects, and what does not count yet, asks nothing of other fingers.
        for asks_nothing in goal.corrects.into_iter().chain(goal.is_lit.map(|is_lit| !is_lit)) {
            object = S::select(asks_nothing, S::lit(-1.0), object);
        }
        let is_asked = S::lit(-0.5).lt(object);
        let which = object.max(S::zero());
        let mut this = Self { is_asked, centre: [S::zero(); 3], moves: None, size: S::zero(), button: None };
        if task.kinds.dwell {
            (this.centre, this.size, this.moves) = goal::sphere(task, state, which);
        }
        if task.kinds.chord {
            let TouchBox { shape, min_force } = goal::touch_box(task, state, which);
            this.centre = select_point(is_press, shape.centre, this.centre);
            this.size = S::select(is_press, shape.half_size[1], this.size);
            this.moves = this.moves.map(|moves| moves.map(|x| x.only(!is_press)));
            let number = S::select(is_press, object, S::lit(-1.0));
            this.button = Some(FingerButton { number, shape, min_force });
        }
        this
    }

    /// From where the finger is to the centre, when this share of the control step has passed (m).
    #[inline(always)]
    pub fn away(&self, finger: Point<S>, share: S) -> Point<S> {
        let mut away = difference(self.centre, finger);
        if let Some(moves) = self.moves {
            for (x, moves) in away.iter_mut().zip(moves) {
                *x = moves.mul_add(share, *x);
            }
        }
        away
    }
}

impl<S: Scalar> GoalPinch<S> {
    /// Of the step of this number; none in tasks without pinches.
    #[inline(always)]
    pub(super) fn of(task: &CompiledTask<S>, number: S, corrects: Option<S::Mask>) -> Option<Self> {
        let steps = &task.pinches;
        task.kinds.pinch.then(|| {
            let [finger, closer_than, apart] =
                S::gather(steps.len(), |k| [steps[k].finger, steps[k].closer_than, steps[k].apart], number);
            let is_pinch = S::lit(-0.5).lt(finger);
            let is_pinch = corrects.map_or(is_pinch, |corrects| is_pinch & !corrects);
            Self { is_pinch, step: PinchStep { finger, closer_than, apart } }
        })
    }

    /// From the finger to the fingertip (m).
    #[inline(always)]
    pub fn away(&self, body: &Landmarks<S>, fingers: usize) -> Point<S> {
        difference(body.fingertip, body.finger(fingers, self.step.finger))
    }

    /// How far (m) fingers still have to go, opening them counted where they must be opened first; before the pointer is there they need
    /// not be nearer than open.
    #[inline(always)]
    fn left(&self, gap: S, is_open: S, inside: S::Mask) -> S {
        let PinchStep { closer_than, apart, .. } = self.step;
        let closing = S::select(inside, gap, gap.max(apart)) - closer_than;
        let opening = (apart - gap).max(S::zero()) + (apart - closer_than);
        S::select(S::lit(0.5).lt(is_open), closing.max(S::zero()), opening)
    }
}

/// Where other fingers are where they must be, at a physics step when this share of the control step has passed.
#[inline(always)]
pub(super) fn others_inside<S: Scalar>(goal: &Goal<S>, body: &Landmarks<S>, share: S) -> S::Mask {
    let mut inside = S::Mask::splat(true);
    for (finger, &place) in goal.fingers.iter().zip(&body.fingers) {
        let away = finger.away(place, share);
        inside = inside & (dot(away, away).lt(finger.size * finger.size) | !finger.is_asked);
    }
    inside
}

/// Whether fingers are open for a pinch: one since they were apart, until they close elsewhere than where they should.
#[inline(always)]
pub(super) fn opened<S: Scalar>(pinch: &GoalPinch<S>, gap: S, was_open: S, inside: S::Mask) -> S {
    let (is_apart, is_closed) = (pinch.step.apart.lt(gap), gap.lt(pinch.step.closer_than));
    let closes_elsewhere = is_closed & !inside;
    S::select(is_apart & pinch.is_pinch, S::lit(1.0), was_open.only(!closes_elsewhere))
}

/// Distance (m) that other fingers still have to go at the end of a control step, all together; `inside` is where the pointer is in its
/// sphere.
#[inline(always)]
pub(super) fn fingers_left<S: Scalar>(
    task: &CompiledTask<S>,
    goal: &Goal<S>,
    body: &Landmarks<S>,
    stay: &Stay<S>,
    inside: S::Mask,
) -> S {
    let mut left = S::zero();
    for (number, (finger, &place)) in goal.fingers.iter().zip(&body.fingers).enumerate() {
        let away = norm(finger.away(place, S::lit(1.0)));
        let inside_is_zero = task.weights.inside_is_zero;
        let mut away = if inside_is_zero { (away - finger.size).max(S::zero()) } else { away };
        if let Some(button) = &finger.button {
            if inside_is_zero {
                away = S::select(goal.is_press, distance_to_face(&button.shape, place), away);
            }
            let holds = S::lit(0.5).lt(stay.holds[number + 1]);
            away = away.only(!(goal.is_press & holds));
        }
        left += away.only(finger.is_asked);
    }
    if let Some(pinch) = &goal.pinch {
        let gap = norm(pinch.away(body, task.fingers.len()));
        left += pinch.left(gap, stay.open, inside).only(pinch.is_pinch);
    }
    left
}

/// Where a pinch of this gap (m) is one.
#[inline(always)]
pub(super) fn is_pinched<S: Scalar>(pinch: &GoalPinch<S>, gap: S, is_open: S) -> S::Mask {
    gap.lt(pinch.step.closer_than) & S::lit(0.5).lt(is_open) | !pinch.is_pinch
}

/// Number of the finger that leads in the step of this number, or -1; none in tasks where none ever does.
#[inline(always)]
pub(super) fn lead_of<S: Scalar>(task: &CompiledTask<S>, step: S) -> Option<S> {
    let leads = &task.leads;
    task.kinds.lead.then(|| S::gather(leads.len(), |k| [leads[k]], step)[0])
}

/// How far (m) the body is from having what points in the step of this number at a place; see [`Pointer::gap`](super::Pointer::gap).
#[inline(always)]
pub fn gap<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, body: &Landmarks<S>, place: Point<S>) -> S {
    let gap = task.pointer.gap(body, place);
    let Some(lead) = lead_of(task, state.step_ahead(0)) else { return gap };
    let finger = norm(difference(place_of(task, body, Some(lead), place), place));
    S::select(S::lit(-0.5).lt(lead), finger, gap)
}

/// Where what points is with this finger in the lead.
#[inline(always)]
pub(super) fn place_of<S: Scalar>(
    task: &CompiledTask<S>,
    body: &Landmarks<S>,
    lead: Option<S>,
    at: Point<S>,
) -> Point<S> {
    let place = task.pointer.place(body, at);
    let Some(lead) = lead else { return place };
    select_point(S::lit(-0.5).lt(lead), body.finger(task.fingers.len(), lead), place)
}

impl<S: Scalar> Goal<S> {
    /// Where what points is, with the body here and the current object at `at`: what the technique makes of the posture, or the finger that leads.
    #[inline(always)]
    pub fn pointer(&self, task: &CompiledTask<S>, body: &Landmarks<S>, at: Point<S>) -> Point<S> {
        place_of(task, body, self.lead, at)
    }

    /// Where another finger leads, of this number.
    #[inline(always)]
    pub fn leads(&self, finger: usize) -> S::Mask {
        self.lead.map_or_else(|| S::Mask::splat(false), |lead| is_same(lead, S::lit(finger as f64)))
    }

    /// The button that a finger is asked to press: 0, the fingertip, or one more than the number of another.
    #[inline(always)]
    pub(super) fn asked_of<'a>(&self, button: &'a GoalButton<S>, finger: usize, is_chord: bool) -> Asked<'a, S> {
        let (mut number, mut min_force) = (button.number, button.min_force);
        if is_chord {
            let leads = match (finger.checked_sub(1), self.lead) {
                (Some(other), _) => self.leads(other),
                (None, Some(lead)) => lead.lt(S::lit(-0.5)),
                (None, None) => S::Mask::splat(true),
            };
            let other = finger.checked_sub(1).and_then(|other| self.fingers.get(other)?.button.as_ref());
            let (own, force) = other.map_or((S::lit(-1.0), S::zero()), |other| (other.number, other.min_force));
            number = S::select(leads, number, own);
            min_force = S::select(leads, min_force, force);
        }
        Asked { number, min_force, button }
    }
}

/// Where this finger of the task is asked for by a pinch.
#[inline(always)]
pub fn is_pinched_with<S: Scalar>(pinch: &GoalPinch<S>, finger: usize) -> S::Mask {
    is_same(pinch.step.finger, S::lit(finger as f64))
}
