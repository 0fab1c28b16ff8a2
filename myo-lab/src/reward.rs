//! What the reward of a task can be worth: the least and the greatest value of each of its terms, and how it lies in space.
//!
//! All of it is asked of the reward that training uses ([`myo_tasks::logic`]), tried out over what an episode may draw, every step of
//! the script, and places that the arm reaches.

use myo_model::StaticBox;
use myo_scalar::{Counter, Scalar, Word, seed_words};
use myo_tasks::logic::{
    self, CompiledTask, Efforts, Goal, Landmarks, Progress, Sensed, Stay, TaskState, begin_step, distance_to_goal,
    draw_objects, remaining_path, reward,
};
use myo_tasks::{InvalidTask, Reach, Task};

/// Episodes that are drawn to find the least and the greatest distance.
const EPISODES: u32 = 48;
/// Directions from the shoulder in which the arm is stretched.
const DIRECTIONS: u32 = 160;
/// Farther than any arm (m).
const FAR_M: f64 = 1.5;

/// A term of the reward.
#[derive(Clone, Debug, PartialEq)]
pub struct RewardTerm {
    /// Field of `reward` that weighs it.
    pub field: &'static str,
    /// Its weight, as it stands in the task.
    pub weight: f64,
    /// What is multiplied by it, for people.
    pub of: &'static str,
    /// Least and greatest value in one control step; none where there is no bound.
    pub step: [Option<f64>; 2],
    /// Least and greatest sum over an episode; none where there is no bound.
    pub episode: [Option<f64>; 2],
}

/// A rectangle in space over which the reward is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// A corner (m, from the shoulder centre).
    pub corner: [f64; 3],
    /// From it to the next corner along a row (m).
    pub along: [f64; 3],
    /// From it to the next corner from row to row (m).
    pub across: [f64; 3],
    /// Places in a row, and rows.
    pub places: [usize; 2],
}

/// A task at the beginning of episodes, whose reward can be asked.
struct Trial {
    task: CompiledTask<f64>,
    /// Each with what its random draws come from.
    episodes: Vec<(Draws, TaskState<f64>)>,
}

type Draws = Counter<<f64 as Scalar>::Word>;

impl Trial {
    fn new(task: &Task, episodes: u32) -> Result<Self, InvalidTask> {
        let task = CompiledTask::<f64>::new(task)?;
        let episodes = (1..=episodes).map(|episode| beginning(&task, episode)).collect();
        Ok(Self { task, episodes })
    }

    /// How far (m) the pointer must still go, as the reward counts it, with all other fingers where they should be.
    fn distance(&self, state: &TaskState<f64>, goal: &Goal<f64>, pointer: [f64; 3]) -> f64 {
        let mut stay = Stay::new(state, goal);
        stay.open = 1.0;
        let sensed = Sensed { body: others_at_their_goals(goal), pointer, stay, now: 0.0 };
        let distance = distance_to_goal(&self.task, &sensed, goal);
        if self.task.weights.remaining_path { distance + remaining_path(&self.task, state) } else { distance }
    }
}

/// A body of which nothing is known but that its other fingers are where the step wants them, a pinch closed.
fn others_at_their_goals(goal: &Goal<f64>) -> Landmarks<f64> {
    let mut body = Landmarks::unknown();
    for (place, finger) in body.fingers.iter_mut().zip(&goal.fingers).filter(|(_, finger)| finger.is_asked) {
        let button = finger.button.as_ref().filter(|_| goal.is_press);
        *place = button.map_or(finger.centre, |button| middle_of_face(&button.shape));
    }
    body
}

/// An episode of this number before its first step.
fn beginning(task: &CompiledTask<f64>, episode: u32) -> (Draws, TaskState<f64>) {
    let word = <f64 as Scalar>::Word::splat;
    let draws = Counter { seed: seed_words(1), env: word(0), episode: word(episode), step: word(0), stream: word(0) };
    let mut state = TaskState::new(task);
    state.restart(true);
    draw_objects(task, true, draws, &mut state);
    begin_step(task, true, draws, &mut state);
    (draws, state)
}

/// The same with another step of the script current, which counts already.
fn at_step(task: &CompiledTask<f64>, (draws, state): &(Draws, TaskState<f64>), step: usize) -> TaskState<f64> {
    // Where steps change places with each other.
    let place = state.order.iter().position(|&own| own == step as f64).unwrap_or(step);
    let mut state = TaskState { phase: place as f64, ..state.clone() };
    begin_step(task, true, *draws, &mut state);
    if let Some(cue) = &mut state.cue {
        cue.lit_at = 0.0;
    }
    state
}

/// How many bonuses for targets an episode brings at most: one for each, and one for every second of what is tracked.
fn bonuses(task: &CompiledTask<f64>, control_dt_s: f64) -> f64 {
    let of_step = |step: usize| match task.follows.get(step) {
        Some(&follows) if follows > 1.5 => task.steps[step].dwell * control_dt_s,
        _ => 1.0,
    };
    (0..task.steps.len()).map(of_step).sum()
}

/// The terms of the reward of a task, in the order in which they are summed up; those that cannot come up in it are left out.
///
/// Distances are the least and the greatest of 48 drawn episodes, every step and every place in reach, so they are about right where much
/// is drawn or moves; handles, sticks and ways are where they begin.
///
/// # Errors
/// The task has errors.
pub fn reward_terms(task: &Task, reach: &dyn Reach, muscles: usize) -> Result<Vec<RewardTerm>, InvalidTask> {
    let trial = Trial::new(task, EPISODES)?;
    let ([near, far], w) = (distances(&trial, reach), task.reward.per_second(task.control_dt_s));
    let (steps, limit) = (trial.task.steps.len() as f64, f64::from(task.time_limit_steps()));
    let dt = task.control_dt_s;
    let [near, far] = [near, far].map(|distance| logic::felt(distance, trial.task.weights.distance_scale));
    // A cost that is due in every control step: at best for as many as there are steps in the script, at worst to the time limit.
    let running = |field, weight: f64, of, [least, most]: [f64; 2]| RewardTerm {
        field,
        weight,
        of,
        step: [Some(-weight * most), Some(-weight * least)],
        episode: [Some(-weight * most * limit), Some(-weight * least * steps.min(limit))],
    };
    let once = |field, weight: f64, of, times: f64| RewardTerm {
        field,
        weight,
        of,
        step: [Some(0.0), Some(weight)],
        episode: [Some(0.0), Some(weight * times)],
    };
    let unbounded = |field, weight: f64, of| {
        let least = if weight == 0.0 { Some(0.0) } else { None };
        RewardTerm { field, weight, of, step: [least, Some(0.0)], episode: [least, Some(0.0)] }
    };
    let distance =
        if w.remaining_path { "s times m to the target and over those to come" } else { "s times m to the target" };
    let mut terms = vec![
        running("distance_cost", w.distance_cost, distance, [near * dt, far * dt]),
        running("time_cost", w.time_cost, "s", [dt; 2]),
        once(
            "subtask_bonus",
            w.subtask_bonus,
            "target done, or second inside what is tracked",
            bonuses(&trial.task, dt),
        ),
        once("completion_bonus", w.completion_bonus, "task done", 1.0),
        running("effort_cost", w.effort_cost, "s times the sum of squared muscle controls", [0.0, muscles as f64 * dt]),
        unbounded("acceleration_cost", w.acceleration_cost, "s times the sum of squared joint accelerations (rad/s²)²"),
        running(
            "control_change_cost",
            w.control_change_cost,
            "s times the sum of squared rates of change of muscle controls (1/s)²",
            [0.0, muscles as f64 / dt],
        ),
    ];
    if !trial.task.boxes.is_empty() {
        terms.push(unbounded("contact_cost", w.contact_cost, "s times the squared force of contact (N²)"));
    }
    if trial.task.kinds.press {
        terms.push(unbounded("wrong_press", w.wrong_press, "press that was not asked for"));
    }
    if trial.task.kinds.steer {
        terms.push(unbounded("exit", w.exit, "time that a way was left"));
    }
    Ok(terms)
}

/// Least and greatest distance that the reward counts (m).
fn distances(trial: &Trial, reach: &dyn Reach) -> [f64; 2] {
    // Distances are greatest where the arm is stretched out, and least as near as it comes.
    let stretched: Vec<[f64; 3]> =
        (0..DIRECTIONS).map(|k| reach.nearest_in_reach(direction(k).map(|x| FAR_M * x))).collect();
    let (mut near, mut far) = (f64::INFINITY, 0.0_f64);
    for episode in &trial.episodes {
        for step in 0..trial.task.steps.len() {
            let state = at_step(&trial.task, episode, step);
            let goal = Goal::of(&trial.task, &state);
            for place in std::iter::once(goal.centre).chain(face(&goal)) {
                near = near.min(trial.distance(&state, &goal, reach.nearest_in_reach(place)));
            }
            far = stretched.iter().map(|&place| trial.distance(&state, &goal, place)).fold(far, f64::max);
        }
    }
    [near.min(far), far]
}

/// Middle of the face that is to be pressed.
fn face(goal: &Goal<f64>) -> Option<[f64; 3]> {
    Some(middle_of_face(&goal.button.as_ref().filter(|_| goal.is_press)?.shape))
}

fn middle_of_face(shape: &StaticBox<f64>) -> [f64; 3] {
    std::array::from_fn(|k| shape.centre[k] + shape.axes[2][k] * shape.half_size[2])
}

/// Directions spread evenly over a sphere (Vogel 1979, doi 10.1016/0025-5564(79)90080-4).
fn direction(number: u32) -> [f64; 3] {
    let up = 1.0 - 2.0 * (f64::from(number) + 0.5) / f64::from(DIRECTIONS);
    let around = f64::from(number) * std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let level = (1.0 - up * up).sqrt();
    [level * around.cos(), level * around.sin(), up]
}

/// Reward per second for distance and time of a pointer that stays at each place of a slice, row by row, with the step of this number
/// current in the first drawn episode; and the slice, which is laid by where the object of that step is (m, from the shoulder centre).
///
/// # Errors
/// The task has errors.
pub fn reward_slice(
    task: &Task,
    step: usize,
    slice: impl Fn([f64; 3]) -> Slice,
) -> Result<(Slice, Vec<f64>), InvalidTask> {
    let trial = Trial::new(task, 1)?;
    let state = at_step(&trial.task, &trial.episodes[0], step.min(trial.task.steps.len().saturating_sub(1)));
    let goal = Goal::of(&trial.task, &state);
    let slice = slice(goal.centre);
    let Slice { corner, along, across, places: [columns, rows] } = slice;
    // Nothing is done there, and no muscle pulls.
    let nothing = Progress {
        target_done: false,
        target_over: false,
        task_done: false,
        task_over: false,
        timed_out: false,
        wrong_presses: 0.0,
        exits: 0.0,
        bonuses: 0.0,
    };
    let at = |row: usize, column: usize| {
        let share = |index: usize, count: usize| index as f64 / (count.max(2) - 1) as f64;
        let (x, y) = (share(column, columns), share(row, rows));
        let place = std::array::from_fn(|k| corner[k] + x * along[k] + y * across[k]);
        reward(&trial.task, &nothing, trial.distance(&state, &goal, place), Efforts::none()).sum() / task.control_dt_s
    };
    let values = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    Ok((slice, values.map(|(row, column)| at(row, column)).collect()))
}

#[cfg(test)]
mod tests {
    use myo_model::{Model, builtin};

    use super::*;
    use crate::ModelReach;

    /// A sphere of 2 cm half a metre before the shoulder, pointed at for 0.2 s within 4 s of control steps of 0.05 s.
    const BALL: &str = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: t\nscene: {ball: {kind: sphere, at: [0.5, 0, -0.1], radius: 0.02}}\n\
                        script: [dwell: {in: ball, for_s: 0.2}]\ntime_limit_s: 4\n";

    fn terms(text: &str) -> Vec<RewardTerm> {
        let task = Task::from_yaml(text, "t").unwrap();
        let reach = ModelReach::for_task(&Model::new(&builtin("mobl-arms").unwrap()).unwrap(), &task).unwrap();
        reward_terms(&task, &reach, 26).unwrap()
    }

    fn term(terms: &[RewardTerm], field: &str) -> RewardTerm {
        terms.iter().find(|term| term.field == field).unwrap().clone()
    }

    #[test]
    fn bounds_of_terms_are_those_of_the_task() {
        let found = terms(BALL);
        // A bonus of 3 for each target, 6 for the task; time costs 0.6 per second, at most for all of the 4 s.
        assert_eq!(term(&found, "subtask_bonus").episode, [Some(0.0), Some(3.0)]);
        assert_eq!(term(&found, "completion_bonus").episode, [Some(0.0), Some(6.0)]);
        let time = term(&found, "time_cost");
        assert!(
            (time.episode[0].unwrap() + 2.4).abs() < 1e-9 && (time.step[1].unwrap() + 0.03).abs() < 1e-9,
            "{time:?}"
        );
        // 26 muscles at full control in each of 80 control steps.
        let effort = term(&found, "effort_cost");
        assert!((effort.episode[0].unwrap() + 0.02 * 26.0 * 4.0).abs() < 1e-9, "{effort:?}");
        // Inside nothing is to be paid; the farthest place of an arm of 0.7 m is behind the body.
        let distance = term(&found, "distance_cost");
        assert_eq!(distance.step[1], Some(0.0));
        let far = -distance.step[0].unwrap() / (distance.weight * 0.05);
        assert!((0.8..1.3).contains(&far), "{far}");
        // What has no bound says so only where it counts.
        assert_eq!(term(&found, "acceleration_cost").step, [Some(0.0); 2]);
        let dear = terms(&format!("{BALL}reward: {{acceleration_cost: 2.0e-4}}\n"));
        assert_eq!(term(&dear, "acceleration_cost").step, [None, Some(0.0)]);
        // Without buttons nothing can be pressed by mistake.
        assert!(found.iter().all(|term| term.field != "wrong_press"));
    }

    #[test]
    fn a_target_out_of_reach_costs_something_at_best() {
        let distance = term(&terms(&BALL.replace("0.5, 0, -0.1", "1.2, 0, -0.1")), "distance_cost");
        assert!(distance.step[1].unwrap() < -0.05, "{distance:?}");
    }

    #[test]
    fn the_map_is_highest_at_the_target_and_falls_by_the_weight_per_metre() {
        let task = Task::from_yaml(BALL, "t").unwrap();
        let line = |[x, y, z]: [f64; 3]| Slice {
            corner: [x, y - 0.5, z],
            along: [0.0, 1.0, 0.0],
            across: [0.0; 3],
            places: [101, 1],
        };
        let (slice, values) = reward_slice(&task, 0, line).unwrap();
        assert!((slice.corner[0] - 0.5).abs() < 1e-9);
        // Per second: 0.6 for the time alone in the ball, and per metre from its surface 0.3 in each of 20 control steps.
        assert!((values[50] + 0.6).abs() < 1e-9, "{}", values[50]);
        assert!((values[0] + 0.6 + 0.3 * 20.0 * 0.48).abs() < 1e-9, "{}", values[0]);
        assert!((values[0] - values[100]).abs() < 1e-9);
    }

    #[test]
    fn touching_a_button_costs_no_distance() {
        let button = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: t\nscene: {ok: {kind: button, at: [0.45, 0, -0.1], size: [0.1, 0.1, 0.02], tilt_deg: 90}}\n\
                      script: [press: ok]\ntime_limit_s: 4\n";
        assert!(term(&terms(button), "distance_cost").step[1].unwrap().abs() < 1e-4, "{:?}", terms(button));
    }

    /// Each step of a task whose steps change places, and of one whose object is drawn, is about its own object.
    #[test]
    fn a_map_is_about_the_step_that_is_asked_for() {
        let scene = "scene:\n  left: {kind: sphere, at: [0.4, 0.2, -0.1], radius: 0.02}\n  right: {kind: sphere, at: [0.4, -0.2, -0.1], \
                     radius: 0.02}\n";
        let steps = "[dwell: {in: left, for_s: 0.1}, dwell: {in: right, for_s: 0.1}]";
        for script in
            [steps.to_owned(), format!("[random_order: {steps}]"), format!("[wait: [0.2, 0.5], {}", &steps[1..])]
        {
            let text = format!(
                "version: 2\nuser: fastest\nmodel: mobl-arms\nname: t\n{scene}script: {script}\ntime_limit_s: 4\n"
            );
            let task = Task::from_yaml(&text, "t").unwrap();
            for (step, y) in [(0, 0.2), (1, -0.2)] {
                let whole =
                    |centre: [f64; 3]| Slice { corner: centre, along: [0.0; 3], across: [0.0; 3], places: [1, 1] };
                let (slice, _) = reward_slice(&task, step, whole).unwrap();
                assert!((slice.corner[1] - y).abs() < 1e-9, "{script}, step {step}: {:?}", slice.corner);
            }
        }
    }
}
