//! What anybody practises, and what a nature is asked.

use myo_measure::signal;
use myo_model::Model;
use myo_tasks::{LoadError, Task};
use myo_train::Policy;
use serde_json::json;

use super::FittingError;
use super::figures::Aim;
use super::nature::{Nature, PRACTISED, natures};
use crate::protocol::{CUT_OFF_HZ, Layout, ProtocolError, Recording, Track, circle, circle_targets, record};

/// Targets of an episode, as many as on the circle that is asked.
const TARGETS: usize = crate::protocol::SELECTIONS;
/// Distances and widths (m) that are practised, and so can be asked.
pub(super) const DISTANCES: [f64; 2] = [0.06, 0.4];
pub(super) const WIDTHS: [f64; 2] = [0.012, 0.12];

/// The tasks in which a user learns to be anybody, of one structure: spheres of any size at any place before the shoulder, each layout done by another
/// nature. All else is that user's.
///
/// # Errors
/// What the user brings along fits no such task.
pub fn practice(user: &Task) -> Result<Vec<Task>, LoadError> {
    let [least, most] = WIDTHS;
    let ball = json!({
        "kind": "sphere", "copies": TARGETS, "at": {"x": 0.5, "y": [-0.25, 0.25], "z": [-0.25, 0.25]},
        "radius": [0.4 * least, 0.5 * most], "min_distance_from_previous": DISTANCES[0],
    });
    let task = Layout {
        name: "spheres".into(),
        scene: json!({"ball": ball}),
        script: json!([{"dwell": {"in": "ball", "for_s": 0.25}}]),
        time_limit_s: 24.0,
    };
    let task = task.task(user)?;
    Ok(natures(PRACTISED).into_iter().map(|nature| nature.doing(task.clone())).collect())
}

/// Movements of the user of a task with another nature, at targets across a circle (ISO 9241-411) for each pair of distance and width (m), in so many
/// episodes of each with this seed; those from target to target.
///
/// # Errors
/// The policy has not learnt to be anybody, or what the user brings along fits no such task.
pub fn aims(
    policy: &mut Policy,
    model: &Model,
    (user, nature): (&Task, Nature),
    pairs: &[[f64; 2]],
    asked: (usize, u64),
) -> Result<Vec<Aim>, FittingError> {
    let layouts = pairs.iter().map(|&pair| Ok(nature.doing(circle(pair).task(user)?)));
    let layouts = layouts.collect::<Result<Vec<Task>, LoadError>>()?;
    let by_pair = record(policy, model, &layouts, asked)?;
    let mut all = vec![];
    for (&pair, recordings) in pairs.iter().zip(&by_pair) {
        for recording in recordings {
            all.extend(between(pair, recording)?);
        }
    }
    Ok(all)
}

/// The movements of an episode from target to target.
fn between(pair: [f64; 2], recording: &Recording) -> Result<Vec<Aim>, FittingError> {
    let measuring = || ProtocolError::measuring("a movement");
    let smooth = signal::low_pass_points(&recording.fingertip, recording.rate_hz, CUT_OFF_HZ).map_err(measuring())?;
    let track = Track { raw: &recording.fingertip, smooth: &smooth, rate_hz: recording.rate_hz };
    let (targets, done) = (circle_targets(pair[0]), &recording.done);
    let aim = |selection: usize| {
        let aimed = track.aimed(done[selection], targets[selection], done[selection - 1].entry).map_err(measuring())?;
        Ok(aimed.movement.is_some().then(|| Aim::new(pair, &aimed)))
    };
    (1..done.len()).filter_map(|selection| aim(selection).transpose()).collect()
}
