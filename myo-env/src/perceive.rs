//! Senses that are late: what an entry of the observation was so many control steps ago.
//!
//! Every late entry has a line of its own in [`EnvState::late`](crate::state::EnvState::late): what it is now, what it was a control step ago, and so
//! on back to what is perceived. At the start of an episode all of them are what they are then.

use crate::observe::ObservationPart;
use myo_scalar::Scalar;
use myo_tasks::Task;

/// Which sense a part comes by.
enum Sense {
    Vision,
    Body,
    Touch,
    /// Not a sense: known at once.
    Clock,
}

const fn sense(part: ObservationPart) -> Sense {
    use ObservationPart as Part;
    match part {
        Part::JointPosition
        | Part::JointVelocity
        | Part::JointAcceleration
        | Part::FingertipPosition
        | Part::Activation
        | Part::Fatigue => Sense::Body,
        Part::Touch => Sense::Touch,
        // What one asks for oneself one knows.
        Part::TimeLeft | Part::Control | Part::Pause | Part::Traits => Sense::Clock,
        Part::PointerPosition
        | Part::TargetPosition
        | Part::TargetSize
        | Part::TargetVector
        | Part::TargetDirection
        | Part::TargetNormal
        | Part::TargetKind
        | Part::TargetVelocity
        | Part::NextTargetVector
        | Part::Phase
        | Part::DwellFraction
        | Part::Inside
        | Part::Cue
        | Part::Drag
        | Part::Drive
        | Part::Steer
        | Part::Fingers
        | Part::NearestObstacle => Sense::Vision,
    }
}

/// How many control steps every entry of these parts is late, of a body with so many independent joints and so many muscles, where so many
/// other fingers are asked for.
pub fn delays(task: &Task, parts: &[ObservationPart], body: [usize; 3]) -> Vec<usize> {
    let perception = &task.perception;
    let delay = |part: ObservationPart| {
        let delay_ms = match sense(part) {
            Sense::Vision => perception.vision_delay_ms,
            Sense::Body => perception.body_delay_ms,
            Sense::Touch => perception.touch_delay_ms,
            Sense::Clock => 0.0,
        };
        (1e-3 * delay_ms / task.control_dt_s).round() as usize
    };
    parts.iter().flat_map(|&part| std::iter::repeat_n(delay(part), part.width(body))).collect()
}

/// How many numbers are remembered.
pub fn memory(delays: &[usize]) -> usize {
    delays.iter().filter(|&&delay| delay > 0).map(|delay| delay + 1).sum()
}

/// Every late entry of `observation` with its line.
#[inline(always)]
fn lines<'a, S: Scalar>(
    delays: &'a [usize],
    mut late: &'a mut [S],
    observation: &'a mut [S],
) -> impl Iterator<Item = (&'a mut [S], &'a mut S)> {
    let delayed = delays.iter().zip(observation).filter(|(delay, _)| **delay > 0);
    delayed.map(move |(&delay, entry)| {
        let (line, rest) = std::mem::take(&mut late).split_at_mut(delay + 1);
        late = rest;
        (line, entry)
    })
}

/// A control step later: `observation` holds what there is to perceive, and then what is perceived of it.
#[inline(always)]
pub fn after_step<S: Scalar>(delays: &[usize], late: &mut [S], observation: &mut [S]) {
    for (line, entry) in lines(delays, late, observation) {
        for at in (1..line.len()).rev() {
            line[at] = line[at - 1];
        }
        line[0] = *entry;
        *entry = line[line.len() - 1];
    }
}

/// The same after a reset where the mask is true; elsewhere nothing was perceived since.
#[inline(always)]
pub fn after_reset<S: Scalar>(delays: &[usize], mask: S::Mask, late: &mut [S], observation: &mut [S]) {
    for (line, entry) in lines(delays, late, observation) {
        for was in line.iter_mut() {
            *was = S::select(mask, *entry, *was);
        }
        *entry = line[line.len() - 1];
    }
}
