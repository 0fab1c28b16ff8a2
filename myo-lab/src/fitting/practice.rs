//! What anybody practises, and what a nature is asked.

use myo_measure::signal;
use myo_model::Model;
use myo_tasks::{LoadError, Task};
use myo_train::Policy;
use serde_json::json;

use super::FittingError;
use super::figures::Aim;
use super::nature::{Nature, PRACTISED, natures};
use crate::protocol::{
    CUT_OFF_HZ, DWELL_S, Layout, PLANE_X, ProtocolError, Recording, Track, circle, circle_targets, record,
};

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
        "kind": "sphere", "copies": TARGETS, "at": {"x": PLANE_X, "y": [-0.25, 0.25], "z": [-0.25, 0.25]},
        "radius": [0.4 * least, 0.5 * most], "min_distance_from_previous": DISTANCES[0],
    });
    let task = Layout {
        name: "spheres".into(),
        scene: json!({"ball": ball}),
        script: json!([{"dwell": {"in": "ball", "for_s": DWELL_S}}]),
        time_limit_s: 24.0,
    };
    let task = task.task(user)?;
    Ok(natures(PRACTISED).into_iter().map(|nature| nature.doing(task.clone())).collect())
}

/// Movements of the user of a task with another nature, at targets across a circle (ISO 9241-411) for each pair of distance and width (m), in so many
/// episodes of each with this seed; those from target to target, with the activations of muscles of these numbers.
///
/// # Errors
/// The policy has not learnt to be anybody, or what the user brings along fits no such task.
pub fn aims(
    policy: &mut Policy,
    model: &Model,
    (user, nature): (&Task, Nature),
    (pairs, muscles): (&[[f64; 2]], &[usize]),
    asked: (usize, u64),
) -> Result<Vec<Aim>, FittingError> {
    let layouts = pairs.iter().map(|&pair| Ok(nature.doing(circle(pair).task(user)?)));
    let layouts = layouts.collect::<Result<Vec<Task>, LoadError>>()?;
    let by_pair = record(policy, model, &layouts, asked)?;
    let mut all = vec![];
    for (&pair, recordings) in pairs.iter().zip(&by_pair) {
        for recording in recordings {
            all.extend(between((pair, muscles), recording, model.muscles.len())?);
        }
    }
    Ok(all)
}

/// The movements of an episode from target to target.
fn between((pair, muscles): ([f64; 2], &[usize]), recording: &Recording, all: usize) -> Result<Vec<Aim>, FittingError> {
    let measuring = || ProtocolError::measuring("a movement");
    let smooth = signal::low_pass_points(&recording.fingertip, recording.rate_hz, CUT_OFF_HZ).map_err(measuring())?;
    let track = Track { raw: &recording.fingertip, smooth: &smooth, rate_hz: recording.rate_hz };
    let (targets, done) = (circle_targets(pair[0]), &recording.done);
    let aim = |selection: usize| {
        let aimed = track.aimed(done[selection], targets[selection], done[selection - 1].entry).map_err(measuring())?;
        let [first, last] = aimed.samples;
        let active = |&muscle: &usize| {
            let own = (first..=last).map(|sample| f64::from(recording.activations[sample * all + muscle]));
            own.sum::<f64>() / (last + 1 - first) as f64
        };
        Ok(aimed.movement.is_some().then(|| Aim::new(pair, &aimed, muscles.iter().map(active).collect())))
    };
    (1..done.len()).filter_map(|selection| aim(selection).transpose()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::Done;
    use crate::recordings::{Outcome, Participant, Selection, Trial, measured};

    const RATE_HZ: f64 = 500.0;
    const PAIR: [f64; 2] = [0.2, 0.05];
    /// Samples of a movement, and of the stay after it.
    const MOVING: usize = 200;
    const STAYING: usize = 125;

    /// A hand that goes across the circle by minimum jerk, each time a little beside the middle.
    fn hand(selections: usize) -> (Vec<[f64; 3]>, Vec<Done>) {
        let targets = circle_targets(PAIR[0]);
        let (mut path, mut done, mut from) = (vec![], vec![], [0.4, 0.05, -0.2]);
        for (selection, &target) in targets.iter().enumerate().take(selections) {
            let (begin, to) = (path.len(), target.map(|x| x + 0.004 * (selection as f64).sin()));
            for sample in 1..=MOVING {
                let s = sample as f64 / MOVING as f64;
                let share = s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
                path.push([0, 1, 2].map(|k| from[k] + share * (to[k] - from[k])));
            }
            let inside = |point: &[f64; 3]| crate::advice::distance(*point, target) < 0.5 * PAIR[1];
            let entry = begin + path[begin..].iter().position(inside).unwrap();
            path.extend(std::iter::repeat_n(to, STAYING));
            done.push(Done { begin, entry, end: path.len() });
            from = to;
        }
        (path, done)
    }

    #[test]
    fn a_user_and_a_person_who_move_alike_have_the_same_figures() {
        let (path, done) = hand(9);
        let recording = Recording {
            rate_hz: RATE_HZ,
            force: vec![0.0; path.len()],
            qpos: vec![],
            qvel: vec![],
            // Two muscles, of which the second becomes more and more active.
            activations: (0..path.len()).flat_map(|sample| [1.0, 1e-4 * sample as f32]).collect(),
            done: done.clone(),
            exits: 0.0,
            wrong_presses: 0.0,
            targets: None,
            fingertip: path.clone(),
        };
        let user = between((PAIR, &[1]), &recording, 2).unwrap();

        let targets = circle_targets(PAIR[0]);
        let selection = |(number, done): (usize, &Done)| Selection {
            target: targets[number],
            width: PAIR[1],
            samples: [done.begin, done.end - 1],
            entry: done.entry,
            outcome: Outcome::Hit,
        };
        let trial = Trial {
            name: "1".into(),
            times: (0..path.len()).map(|sample| sample as f64 / RATE_HZ).collect(),
            activations: (0..path.len()).map(|sample| 1e-4 * sample as f64).collect(),
            points: path,
            selections: done.iter().enumerate().map(selection).collect(),
        };
        let person = Participant { name: "Ada".into(), muscles: vec!["DELT1".into()], trials: vec![trial] };
        let (all, missed) = measured(&person).unwrap();
        // The first one began elsewhere.
        let person: Vec<Aim> = all.iter().skip(1).map(Aim::from).collect();
        assert_eq!((missed, user.len(), person.len()), (0, 8, 8));
        for (user, person) in user.iter().zip(&person) {
            assert!(user.is_like(person, 0.003), "{user:?} and {person:?}");
        }
    }
}
