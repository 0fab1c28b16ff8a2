//! The observation: which parts it has, what they are called, and their values.

use crate::parameters::World;
use crate::state::EnvState;
use myo_model::Model;
use myo_scalar::{Real, Scalar};
use myo_tasks::logic::{Goal, Sensed, centre_ahead, difference, inside};
use myo_tasks::{Observation, Task};

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
    /// Muscle activations, [0, 1] mapped to [-1, 1].
    Activation,
    /// Centre of the current target (m).
    TargetPosition,
    /// Radius of the current sphere or half the width of the button (m).
    TargetSize,
    /// From the fingertip to the centre of the current target (m).
    TargetVector,
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
    /// Share of the force that the current button needs, at most one.
    Touch,
}

/// The parts that a task asks for, in order.
pub fn parts(o: &Observation) -> Vec<ObservationPart> {
    let all = [
        (o.joint_position, ObservationPart::JointPosition),
        (o.joint_velocity, ObservationPart::JointVelocity),
        (o.joint_acceleration, ObservationPart::JointAcceleration),
        (o.fingertip_position, ObservationPart::FingertipPosition),
        (o.activation, ObservationPart::Activation),
        (o.target_position, ObservationPart::TargetPosition),
        (o.target_size, ObservationPart::TargetSize),
        (o.target_vector, ObservationPart::TargetVector),
        (o.next_target_vector, ObservationPart::NextTargetVector),
        (o.phase, ObservationPart::Phase),
        (o.dwell_fraction, ObservationPart::DwellFraction),
        (o.time_left, ObservationPart::TimeLeft),
        (o.inside, ObservationPart::Inside),
        (o.touch, ObservationPart::Touch),
    ];
    all.into_iter().filter_map(|(wanted, part)| wanted.then_some(part)).collect()
}

/// Name of every entry, for example `joint_velocity.elbow_flexion`.
pub fn names(model: &Model, task: &Task, dofs: &[String]) -> Vec<String> {
    let muscles: Vec<String> = model.muscles.iter().map(|m| m.name.clone()).collect();
    let axes = ["x", "y", "z"].map(String::from).to_vec();
    let of = |name: &str, entries: &[String]| entries.iter().map(|e| format!("{name}.{e}")).collect();
    let entries = |part: ObservationPart| -> Vec<String> {
        match part {
            ObservationPart::JointPosition => of("joint_position", dofs),
            ObservationPart::JointVelocity => of("joint_velocity", dofs),
            ObservationPart::JointAcceleration => of("joint_acceleration", dofs),
            ObservationPart::FingertipPosition => of("fingertip_position", &axes),
            ObservationPart::Activation => of("activation", &muscles),
            ObservationPart::TargetPosition => of("target_position", &axes),
            ObservationPart::TargetSize => vec!["target_size".into()],
            ObservationPart::TargetVector => of("target_vector", &axes),
            ObservationPart::NextTargetVector => of("next_target_vector", &axes),
            ObservationPart::Phase => vec!["phase".into()],
            ObservationPart::DwellFraction => vec!["dwell_fraction".into()],
            ObservationPart::TimeLeft => vec!["time_left".into()],
            ObservationPart::Inside => vec!["inside".into()],
            ObservationPart::Touch => vec!["touch".into()],
        }
    };
    parts(&task.observation).into_iter().flat_map(entries).collect()
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
    for part in &world.tables.observation {
        match part {
            ObservationPart::JointPosition => joint_positions(world, env, out),
            ObservationPart::JointVelocity => out.extend_from_slice(&env.body.qvel),
            ObservationPart::JointAcceleration => scaled(&env.qacc, 0.01, 0.0, out),
            ObservationPart::FingertipPosition => out.extend_from_slice(&sensed.fingertip),
            ObservationPart::Activation => scaled(&env.body.act, 2.0, -1.0, out),
            ObservationPart::TargetPosition => out.extend_from_slice(&goal.centre),
            ObservationPart::TargetSize => out.push(goal.size),
            ObservationPart::TargetVector => out.extend_from_slice(&difference(goal.centre, sensed.fingertip)),
            ObservationPart::NextTargetVector => {
                out.extend_from_slice(&difference(centre_ahead(task, state, 1), goal.centre));
            }
            ObservationPart::Phase => out.push(state.phase * S::lit(1.0 / task.steps.len() as f64)),
            ObservationPart::DwellFraction => out.push((state.dwell * goal.dwell.recip()).only(!goal.is_press)),
            ObservationPart::TimeLeft => out.push(S::lit(1.0) - state.step * task.time_limit.recip()),
            ObservationPart::Inside => out.push(S::indicator(inside(sensed, goal))),
            ObservationPart::Touch => out.push(touch(goal, env.touch)),
        }
    }
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

/// Share of the force that the current button needs, at most one.
#[inline(always)]
fn touch<S: Scalar>(goal: &Goal<S>, force: S) -> S {
    let Some(button) = &goal.button else { return S::zero() };
    (force * button.shape.min_force.recip()).min(S::lit(1.0)).only(goal.is_press)
}
