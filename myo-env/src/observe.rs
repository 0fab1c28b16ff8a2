//! The observation: which parts it has, what they are called, and their values.

use crate::control::offsets;
use crate::misjudge::seems_off;
use crate::parameters::{Parameters, World};
use crate::state::EnvState;
use myo_dynamics::spatial::Vec3;
use myo_dynamics::step::boxes::{Boxes, Which};
use myo_dynamics::step::contact::surface;
use myo_model::Model;
use myo_scalar::{Carried, Real, Scalar, Visitor};
use myo_tasks::logic::{CompiledTask, Goal, Kinds, Point, Sensed, TaskState, centre_ahead, difference, inside, norm};
use myo_tasks::{Observation, logic};

/// What is farther away than this (m) is observed as if it were so far.
const NEAR: f64 = 1.0;
/// Farther than any obstacle (m).
const FAR: f64 = 1e3;
/// What users of one body differ in, and the unit in which they observe it.
const TRAITS: [(&str, f64); 4] =
    [("signal_dependent", 0.1), ("vision_noise", 0.2), ("effort_cost", 4.0), ("control_change_cost", 10.0)];

/// What is observed of another finger.
const FINGER: [&str; 6] = ["x", "y", "z", "size", "asked", "ready"];

/// A part of the observation. Positions are m from the shoulder centre in world axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObservationPart {
    /// Joint positions, the joint's range mapped to [-1, 1].
    JointPosition,
    /// Joint velocities (rad/s).
    JointVelocity,
    /// Joint accelerations (rad/s^2) divided by 100.
    JointAcceleration,
    /// Position of the fingertip (m).
    FingertipPosition,
    /// Position of the pointer (m), where it is not the fingertip.
    PointerPosition,
    /// Muscle activations, [0, 1] mapped to [-1, 1].
    Activation,
    /// What of each muscle is fatigued, where muscles tire.
    Fatigue,
    /// Centre of the current target (m).
    TargetPosition,
    /// Radius of the current sphere or half the width of the button (m).
    TargetSize,
    /// From the pointer to the centre of the current target (m).
    TargetVector,
    /// The same way, divided by its length and the radius together.
    TargetDirection,
    /// Where the face of the current button or slider looks; zeros for spheres.
    TargetNormal,
    /// Control that each muscle was last asked for, where changing it costs something.
    Control,
    /// One where the current step asks to press or drag, zero where to point.
    TargetKind,
    /// Velocity of the current target (m/s), where something moves.
    TargetVelocity,
    /// From the current target to the next (m).
    NextTargetVector,
    /// Share of targets done.
    Phase,
    /// Share of the dwell time passed.
    DwellFraction,
    /// Share of time left.
    TimeLeft,
    /// One inside the current sphere.
    Inside,
    /// Greatest force on the fingertip within the control step, whatever it touches, as a share of what the current button needs, at most one.
    Touch,
    /// One where the current step counts already, where some must be waited for.
    Cue,
    /// Share of the pause after a wrong press that is left, where there is one.
    Pause,
    /// One while the current handle or knob is held, and the way that it must go (m), where there are sliders or sticks.
    Drag,
    /// From the current vehicle to where it must stop (m), and its speed (m/s), where something is driven.
    Drive,
    /// From the pointer to the farthest place of the current way that was come to (m), and one within the way, where there are ways.
    Steer,
    /// One where the fingertip holds its button of several. Of every other finger: the way to where it must be and how large that is (m), one where it is asked for, and one where it holds its button or is open for a pinch.
    Fingers,
    /// From the fingertip to the nearest place of the surface of any box but the current one (m), where there are boxes.
    NearestObstacle,
    /// What the user is like: motor noise, misjudged targets, effort, changes of control, each in a unit that people have about one of.
    Traits,
}

impl ObservationPart {
    /// Whether it is about body, boxes and time, and not about a script.
    pub(crate) const fn is_of_body(self) -> bool {
        use ObservationPart as Part;
        matches!(
            self,
            Part::JointPosition
                | Part::JointVelocity
                | Part::JointAcceleration
                | Part::FingertipPosition
                | Part::Activation
                | Part::Fatigue
                | Part::Control
                | Part::TimeLeft
                | Part::NearestObstacle
        )
    }
}

impl ObservationPart {
    /// How many entries it has, of a body with so many independent joints and so many muscles, where so many other fingers are asked for.
    pub(crate) const fn width(self, [ndof, nmuscle, fingers]: [usize; 3]) -> usize {
        match self {
            Self::JointPosition | Self::JointVelocity | Self::JointAcceleration => ndof,
            Self::Activation | Self::Fatigue | Self::Control => nmuscle,
            Self::FingertipPosition
            | Self::PointerPosition
            | Self::TargetPosition
            | Self::TargetVector
            | Self::TargetDirection
            | Self::TargetNormal
            | Self::TargetVelocity
            | Self::NextTargetVector
            | Self::NearestObstacle => 3,
            Self::TargetSize
            | Self::TargetKind
            | Self::Phase
            | Self::DwellFraction
            | Self::TimeLeft
            | Self::Inside
            | Self::Touch
            | Self::Cue
            | Self::Pause => 1,
            Self::Drag | Self::Drive | Self::Steer => 4,
            Self::Fingers => 1 + fingers * FINGER.len(),
            Self::Traits => TRAITS.len(),
        }
    }

    /// Its key in `observation` of a task file, with which the names of its entries begin.
    pub const fn name(self) -> &'static str {
        match self {
            Self::JointPosition => "joint_position",
            Self::JointVelocity => "joint_velocity",
            Self::JointAcceleration => "joint_acceleration",
            Self::FingertipPosition => "fingertip_position",
            Self::PointerPosition => "pointer_position",
            Self::Activation => "activation",
            Self::Fatigue => "fatigue",
            Self::Control => "control",
            Self::TargetPosition => "target_position",
            Self::TargetSize => "target_size",
            Self::TargetVector => "target_vector",
            Self::TargetDirection => "target_direction",
            Self::TargetNormal => "target_normal",
            Self::TargetKind => "target_kind",
            Self::TargetVelocity => "target_velocity",
            Self::NextTargetVector => "next_target_vector",
            Self::Phase => "phase",
            Self::DwellFraction => "dwell_fraction",
            Self::TimeLeft => "time_left",
            Self::Inside => "inside",
            Self::Touch => "touch",
            Self::Cue => "cue",
            Self::Pause => "pause",
            Self::Drag => "drag",
            Self::Drive => "drive",
            Self::Steer => "steer",
            Self::Fingers => "fingers",
            Self::NearestObstacle => "nearest_obstacle",
            Self::Traits => "traits",
        }
    }

    /// In which tasks there is such a part, as half a sentence; none if in all that ask for it.
    pub const fn only_where(self) -> Option<&'static str> {
        match self {
            Self::Fatigue => Some("where muscles tire"),
            Self::Control => Some("where changing controls costs something"),
            Self::PointerPosition => Some("where the technique is not the fingertip"),
            Self::TargetVelocity => Some("where something moves"),
            Self::Cue => Some("where a step must be waited for"),
            Self::Pause => Some("where a wrong press takes time"),
            Self::Drag => Some("where there is a slider to drag or a stick to swing"),
            Self::Drive => Some("where something is driven"),
            Self::Steer => Some("where there is a way to steer along"),
            Self::Fingers => Some("where other fingers are asked for"),
            Self::NearestObstacle => Some("where there are boxes"),
            _ => None,
        }
    }
}

/// The parts that a task asks for and has, in order.
pub fn parts<T>(o: &Observation, parameters: &Parameters<T>) -> Vec<ObservationPart> {
    let task = &parameters.task;
    let Kinds { motion, cue, drag, swing, drive, steer, .. } = task.kinds;
    let all = [
        (o.joint_position, ObservationPart::JointPosition),
        (o.joint_velocity, ObservationPart::JointVelocity),
        (o.joint_acceleration, ObservationPart::JointAcceleration),
        (o.fingertip_position, ObservationPart::FingertipPosition),
        (o.pointer_position && !task.pointer.is_fingertip(), ObservationPart::PointerPosition),
        (o.activation, ObservationPart::Activation),
        (o.fatigue && parameters.fatigue.is_some(), ObservationPart::Fatigue),
        (o.control && task.weights.change_cost.is_some(), ObservationPart::Control),
        (o.target_position, ObservationPart::TargetPosition),
        (o.target_size, ObservationPart::TargetSize),
        (o.target_vector, ObservationPart::TargetVector),
        (o.target_direction, ObservationPart::TargetDirection),
        (o.target_normal, ObservationPart::TargetNormal),
        (o.target_kind, ObservationPart::TargetKind),
        (o.target_velocity && motion, ObservationPart::TargetVelocity),
        (o.next_target_vector, ObservationPart::NextTargetVector),
        (o.phase, ObservationPart::Phase),
        (o.dwell_fraction, ObservationPart::DwellFraction),
        (o.time_left, ObservationPart::TimeLeft),
        (o.inside, ObservationPart::Inside),
        (o.touch, ObservationPart::Touch),
        (o.cue && cue, ObservationPart::Cue),
        (o.pause && task.error_pause.is_some(), ObservationPart::Pause),
        (o.drag && (drag || swing), ObservationPart::Drag),
        (o.drive && drive, ObservationPart::Drive),
        (o.steer && steer, ObservationPart::Steer),
        (o.fingers && !task.fingers.is_empty(), ObservationPart::Fingers),
        (o.nearest_obstacle && !task.boxes.is_empty(), ObservationPart::NearestObstacle),
        (o.traits, ObservationPart::Traits),
    ];
    all.into_iter().filter_map(|(wanted, part)| wanted.then_some(part)).collect()
}

/// Name of every entry, for example `joint_velocity.elbow_flexion`; `fingers` are those that are asked for.
pub fn names(model: &Model, parts: &[ObservationPart], dofs: &[String], fingers: &[String]) -> Vec<String> {
    let muscles: Vec<String> = model.muscles.iter().map(|m| m.name.clone()).collect();
    let axes = ["x", "y", "z"].map(String::from).to_vec();
    let entries = |part: ObservationPart| -> Vec<String> {
        let name = part.name();
        let of = |entries: &[String]| entries.iter().map(|entry| format!("{name}.{entry}")).collect();
        match part {
            ObservationPart::JointPosition | ObservationPart::JointVelocity | ObservationPart::JointAcceleration => {
                of(dofs)
            }
            ObservationPart::FingertipPosition
            | ObservationPart::PointerPosition
            | ObservationPart::TargetPosition
            | ObservationPart::TargetVector
            | ObservationPart::TargetDirection
            | ObservationPart::TargetNormal
            | ObservationPart::TargetVelocity
            | ObservationPart::NextTargetVector
            | ObservationPart::NearestObstacle => of(&axes),
            ObservationPart::Activation | ObservationPart::Fatigue | ObservationPart::Control => of(&muscles),
            ObservationPart::TargetSize
            | ObservationPart::TargetKind
            | ObservationPart::Phase
            | ObservationPart::DwellFraction
            | ObservationPart::TimeLeft
            | ObservationPart::Inside
            | ObservationPart::Touch
            | ObservationPart::Cue
            | ObservationPart::Pause => vec![name.into()],
            ObservationPart::Drag => of(&["held", "x", "y", "z"].map(String::from)),
            ObservationPart::Drive => of(&["x", "y", "z", "speed"].map(String::from)),
            ObservationPart::Steer => of(&["x", "y", "z", "within"].map(String::from)),
            ObservationPart::Fingers => {
                let each = |finger: &String| FINGER.map(|entry| format!("{finger}.{entry}"));
                let all = ["fingertip.ready".into()].into_iter().chain(fingers.iter().flat_map(each));
                of(&all.collect::<Vec<_>>())
            }
            ObservationPart::Traits => of(&TRAITS.map(|(trait_name, _)| trait_name.to_owned())),
        }
    };
    parts.iter().flat_map(|&part| entries(part)).collect()
}

/// Appends the observation of the current state to `out`.
#[inline(always)]
pub fn observe<S: Scalar>(
    world: &World<'_, S>,
    goal: &Goal<S>,
    env: &EnvState<S>,
    sensed: &Sensed<S>,
    out: &mut Vec<S>,
) {
    let (task, state) = (&world.parameters.task, &env.task);
    let away = difference(goal.centre, sensed.pointer);
    let off = seems_off(world, env, away);
    for part in &world.tables.observation {
        match part {
            ObservationPart::PointerPosition => out.extend_from_slice(&sensed.pointer),
            ObservationPart::TargetPosition => out.extend_from_slice(&add(goal.centre, off)),
            ObservationPart::TargetSize => out.push(goal.size),
            ObservationPart::TargetVector => out.extend_from_slice(&add(away, off)),
            ObservationPart::TargetDirection => out.extend_from_slice(&direction(add(away, off), goal.size)),
            ObservationPart::TargetNormal => out.extend_from_slice(&normal(goal)),
            ObservationPart::TargetKind => out.push(S::indicator(goal.is_press)),
            ObservationPart::TargetVelocity => out.extend_from_slice(&velocity(world, goal)),
            ObservationPart::NextTargetVector => {
                let away = to_next(task, state, goal);
                out.extend_from_slice(&add(away, seems_off(world, env, away)));
            }
            ObservationPart::Phase => out.push(state.phase * S::lit(1.0 / task.steps.len() as f64)),
            ObservationPart::DwellFraction => out.push((state.dwell * goal.dwell.recip()).only(!goal.is_press)),
            ObservationPart::Inside => out.push(S::indicator(inside(sensed, goal) & goal.lit() & goal.is_seen())),
            ObservationPart::Touch => out.push(touch(goal, env.touch)),
            ObservationPart::Cue => out.push(S::indicator(goal.lit())),
            ObservationPart::Pause => out.push(pause(task, state)),
            ObservationPart::Drag => drag(goal, state, out),
            ObservationPart::Drive => drive(goal, out),
            ObservationPart::Steer => steer(goal, state, sensed, out),
            ObservationPart::Fingers => fingers(world, goal, env, sensed, out),
            ObservationPart::NearestObstacle => {
                let current = goal.button.as_ref().map_or(S::lit(-1.0), |button| button.number);
                out.extend_from_slice(&to_nearest_obstacle(world, current, state, sensed.body.fingertip));
            }
            ObservationPart::Traits => traits(world, out),
            &of_body => observe_body(of_body, world, env, &sensed.body.fingertip, out),
        }
    }
}

/// Appends a part that is about body, boxes and time; nothing where it is about a script.
#[inline(always)]
pub fn observe_body<S: Scalar>(
    part: ObservationPart,
    world: &World<'_, S>,
    env: &EnvState<S>,
    fingertip: &Point<S>,
    out: &mut Vec<S>,
) {
    match part {
        ObservationPart::JointPosition => joint_positions(world, env, out),
        ObservationPart::JointVelocity => out.extend_from_slice(&env.body.qvel),
        ObservationPart::JointAcceleration => scaled(&env.qacc, 0.01, 0.0, out),
        ObservationPart::FingertipPosition => out.extend_from_slice(fingertip),
        ObservationPart::Activation => scaled(&env.body.act, 2.0, -1.0, out),
        ObservationPart::Fatigue => out.extend_from_slice(&env.fatigue),
        ObservationPart::Control => scaled(&env.asked, 2.0, -1.0, out),
        ObservationPart::TimeLeft => out.push(S::lit(1.0) - env.task.step * world.parameters.task.time_limit.recip()),
        ObservationPart::NearestObstacle => {
            out.extend_from_slice(&to_nearest_obstacle(world, S::lit(-1.0), &env.task, *fingertip));
        }
        _ => {}
    }
}

/// Appends what the user is like.
#[inline(always)]
fn traits<S: Scalar>(world: &World<'_, S>, out: &mut Vec<S>) {
    let (own, control_dt) = (&world.parameters, world.tables.control_dt());
    let weights = &own.task.weights;
    // Costs as the task has them, not by the control step.
    let all = [
        (own.noise.map(|noise| noise.deviations[0]), 1.0),
        (own.vision_noise.map(|vision| vision.share), 1.0),
        (Some(weights.effort_cost), control_dt.recip()),
        (weights.change_cost, control_dt),
    ];
    let values = all.into_iter().zip(TRAITS);
    out.extend(values.map(|((x, by), (_, unit))| x.map_or(S::zero(), |x| x * S::lit(by / unit))));
}

/// A way as a share of its length and a radius together: as fine near a small target as near a large one.
#[inline(always)]
fn direction<S: Scalar>(away: Point<S>, radius: S) -> Point<S> {
    // Not 0 / 0 where a target has no size.
    let scale = (norm(away) + radius + S::lit(1e-6)).recip();
    away.map(|x| x * scale)
}

#[inline(always)]
fn add<S: Scalar>(a: Point<S>, b: Option<Point<S>>) -> Point<S> {
    b.map_or(a, |b| [0, 1, 2].map(|k| a[k] + b[k]))
}

/// From the current target to the next (m), which is the current step's where a wrong press is to be corrected first; zero where what
/// comes next is not shown.
#[inline(always)]
fn to_next<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>, goal: &Goal<S>) -> [S; 3] {
    if !task.kinds.next {
        return [S::zero(); 3];
    }
    let next = centre_ahead(task, state, 1);
    let Some(corrects) = goal.corrects else { return difference(next, goal.centre) };
    let (current, goal) = (centre_ahead(task, state, 0), goal.centre);
    [0, 1, 2].map(|k| S::select(corrects, current[k], next[k]) - goal[k])
}

/// Appends `x * factor + offset`.
#[inline(always)]
fn scaled<S: Scalar>(values: &[S], factor: f64, offset: f64, out: &mut Vec<S>) {
    for &x in values {
        out.push(x.mul_add(S::lit(factor), S::lit(offset)));
    }
}

#[inline(always)]
fn joint_positions<S: Scalar>(world: &World<'_, S>, env: &EnvState<S>, out: &mut Vec<S>) {
    for (dof, &q) in world.tables.plan.dofs.iter().zip(&env.body.qpos) {
        let Some([lo, hi]) = dof.range.map(|range| range.map(Real::to_f64)) else {
            out.push(q);
            continue;
        };
        let scale = 2.0 / (hi - lo);
        out.push(q.mul_add(S::lit(scale), S::lit(-1.0 - lo * scale)));
    }
}

/// Velocity of the current target (m/s); zero where nothing moves.
#[inline(always)]
fn velocity<S: Scalar>(world: &World<'_, S>, goal: &Goal<S>) -> [S; 3] {
    let per_second = 1.0 / (f64::from(world.tables.substeps) * world.tables.timestep);
    let is_sphere = !goal.is_press;
    goal.moves.map_or([S::zero(); 3], |moves| moves.map(|x| (x * S::lit(per_second)).only(is_sphere)))
}

/// Share of the pause after a wrong press that is left; none where there is no such pause.
#[inline(always)]
fn pause<S: Scalar>(task: &CompiledTask<S>, state: &TaskState<S>) -> S {
    let (Some(left), Some(whole)) = (state.pause, task.error_pause) else { return S::zero() };
    // A pause of no length is never begun.
    left * whole.max(S::lit(1.0)).recip()
}

/// Appends whether the current handle or knob is held, and the way that it must go (m); zeros where the step asks for none.
#[inline(always)]
fn drag<S: Scalar>(goal: &Goal<S>, state: &TaskState<S>, out: &mut Vec<S>) {
    let mut sum = [S::zero(); 4];
    if let Some(drag) = goal.drag() {
        let [x, y, z] = drag.way_left(drag.value);
        sum = [S::indicator(drag.is_drag & S::lit(0.5).lt(state.down)), x, y, z];
    }
    if let (Some(swing), Some(sticks)) = (&goal.swing, &state.sticks) {
        let [x, y, z] = swing.way_left();
        let terms = [sticks.held.only(swing.is_swing), x, y, z];
        sum = [0, 1, 2, 3].map(|k| sum[k] + terms[k]);
    }
    out.extend_from_slice(&sum);
}

/// Appends the way that the current vehicle must go (m) and its speed (m/s); zeros where the step asks for none.
#[inline(always)]
fn drive<S: Scalar>(goal: &Goal<S>, out: &mut Vec<S>) {
    let Some(drive) = &goal.drive else { return out.extend([S::zero(); 4]) };
    out.extend_from_slice(&drive.way_left(drive.ride.along));
    out.push(drive.ride.speed.only(drive.is_drive));
}

/// Appends the vector to where the current way was left off (m), and whether the pointer is within it; zeros where the step is no way.
#[inline(always)]
fn steer<S: Scalar>(goal: &Goal<S>, state: &TaskState<S>, sensed: &Sensed<S>, out: &mut Vec<S>) {
    let (Some(steer), Some(steering)) = (&goal.steer, &state.steering) else { return out.extend([S::zero(); 4]) };
    out.extend_from_slice(&steer.to_gone(sensed.pointer, steering.along));
    out.push(steering.within.only(steer.is_steer));
}

/// Appends where other fingers must go, see [`FINGER`]; zeros where the step asks nothing of them.
#[inline(always)]
fn fingers<S: Scalar>(world: &World<'_, S>, goal: &Goal<S>, env: &EnvState<S>, sensed: &Sensed<S>, out: &mut Vec<S>) {
    let task = &world.parameters.task;
    let count = task.fingers.len();
    let holds = |finger: usize| env.task.holds.get(finger).copied().unwrap_or(S::zero());
    out.push(holds(0));
    for finger in 0..count {
        let mut entries = [S::zero(); FINGER.len()];
        let holds = holds(finger + 1);
        let mut ask = |is_asked: S::Mask, away: Point<S>, size: S| {
            let [x, y, z] = add(away, seems_off(world, env, away));
            for (entry, own) in entries.iter_mut().zip([x, y, z, size, S::lit(1.0), holds]) {
                *entry = S::select(is_asked, own, *entry);
            }
        };
        if let Some(other) = goal.fingers.get(finger) {
            ask(other.is_asked, other.away(sensed.body.fingers[finger], S::zero()), other.size);
        }
        if goal.lead.is_some() {
            ask(goal.leads(finger), difference(goal.centre, sensed.body.fingers[finger]), goal.size);
        }
        if let Some(pinch) = &goal.pinch {
            // Nobody misjudges how far apart two of the own fingers are.
            let [x, y, z] = pinch.away(&sensed.body, count);
            let open = env.task.open.unwrap_or(S::zero());
            let own = [x, y, z, pinch.step.closer_than, S::lit(1.0), open];
            let is_it = pinch.is_pinch & logic::is_pinched_with(pinch, finger);
            for (entry, own) in entries.iter_mut().zip(own) {
                *entry = S::select(is_it, own, *entry);
            }
        }
        out.extend_from_slice(&entries);
    }
}

/// Outward normal of the face of the current button or slider; zeros where the step asks for a sphere.
#[inline(always)]
fn normal<S: Scalar>(goal: &Goal<S>) -> Point<S> {
    let Some(button) = &goal.button else { return [S::zero(); 3] };
    button.shape.axes[2].map(|x| x.only(goal.is_press & goal.lit()))
}

/// From the fingertip to the nearest place of the surface of any box but the one of this number (m); shortened to [`NEAR`], and as
/// long downwards where there is none.
#[inline(always)]
fn to_nearest_obstacle<S: Scalar>(
    world: &World<'_, S>,
    current: S,
    state: &TaskState<S>,
    [x, y, z]: Point<S>,
) -> Point<S> {
    let offsets: Vec<Vec3<S>> = offsets(state).collect();
    let boxes = Boxes { obstacles: &world.obstacles, offsets: &offsets };
    let (o, fingertip) = (S::zero(), Vec3::new(x, y, z));
    let mut nearest = Nearest { distance: S::lit(FAR), way: Vec3::new(o, o, S::lit(-NEAR)) };
    S::for_each_row(boxes.count(), &mut nearest, |nearest, row| {
        let which = Which::Row(row);
        let (away, _) = boxes.seen_from(fingertip, which);
        let (axes, half_size) = boxes.sides(which);
        let (distance, normal) = surface(axes, half_size, away);
        let is_nearer = distance.lt(nearest.distance) & !(which.number() - current).abs().lt(S::lit(0.5));
        nearest.distance = S::select(is_nearer, distance, nearest.distance);
        nearest.way = Vec3::select(is_nearer, normal.scale(-distance), nearest.way);
    });
    // Inside of a box, too, the way is as long as the distance.
    let longer = nearest.distance.max(S::lit(NEAR)).recip() * S::lit(NEAR);
    let is_none = S::lit(0.5 * FAR).lt(nearest.distance);
    nearest.way.scale(S::select(is_none, S::lit(1.0), longer)).array()
}

/// The nearest obstacle so far.
struct Nearest<S> {
    distance: S,
    way: Vec3<S>,
}

impl<S: Scalar> Carried<S> for Nearest<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self { distance, way: Vec3 { x, y, z } } = self;
        visitor.numbers([distance, x, y, z]);
    }
}

/// Greatest force on the fingertip within the control step, whatever it touches, as a share of what the current button needs, at most one.
#[inline(always)]
fn touch<S: Scalar>(goal: &Goal<S>, force: S) -> S {
    let Some(button) = &goal.button else { return S::zero() };
    (force * button.min_force.recip()).min(S::lit(1.0)).only(goal.is_press)
}
