//! What counts as a press, what touching costs, and what an error costs.

use crate::common::run::{SUBSTEPS, task};
use myo_tasks::Task;
use myo_tasks::logic::{CompiledTask, Contact, Goal, Landmarks, Sensed, Stay, TaskState, advance};

/// What share of a control step of 50 ms a physics step is.
const SHARE: f64 = 1.0 / SUBSTEPS as f64;
const KEYS: &str = "  a: {kind: button, at: [0.4, 0, 0], size: [0.03, 0.03, 0.01], min_force_n: 2}
  b: {kind: button, at: [0.4, 0.1, 0], size: [0.03, 0.03, 0.01], min_force_n: 1}
  desk: {kind: obstacle, at: [0.4, 0, -0.5], size: [1, 1, 0.01]}";
const A: f64 = 0.0;
const B: f64 = 1.0;
const DESK: f64 = 2.0;

/// What became of a task that asks for `a`.
struct Told {
    /// Control step at which it was done; negative if it was not.
    done_at: f64,
    /// Wrong presses.
    wrong: f64,
    /// Sum of squared forces (N^2) over all physics steps.
    squared_force: f64,
    /// Whether presses counted, per control step.
    counts: Vec<bool>,
}

/// Eight control steps of a task that asks for `a`, with these contacts: from, to, box, force, facing.
fn touched(task: &Task, contacts: &[(usize, usize, f64, f64, f64)]) -> Told {
    let task = CompiledTask::<f64>::new(task).unwrap();
    let mut state = TaskState::new(&task);
    state.restart(true);
    let mut told = Told { done_at: -1.0, wrong: 0.0, squared_force: 0.0, counts: vec![] };
    for step in 0..8 {
        let goal = Goal::of(&task, &state);
        told.counts.push(!state.pauses().unwrap_or(false));
        let mut stay = Stay::new(&state, &goal);
        for now in step * SUBSTEPS..(step + 1) * SUBSTEPS {
            let here = contacts.iter().map(|&(from, to, number, force, facing)| Contact {
                finger: 0,
                exists: (from..to).contains(&now),
                number,
                force,
                facing,
            });
            stay.follow(&task, &goal, &Landmarks::unknown(), [0.0; 3], SHARE, here);
        }
        told.squared_force += stay.squared_force;
        let now = ((step + 1) * SUBSTEPS) as f64;
        let sensed = Sensed { body: Landmarks::unknown(), pointer: [0.0; 3], stay, now };
        told.wrong += advance(&task, &goal, &sensed, &mut state, SHARE).wrong_presses;
    }
    told.done_at = state.done_at[0];
    told
}

/// A task that asks for `a`, of a user with such a pause (s) after an error, to whom touching costs so much.
fn press(error_pause_s: f64, contact_cost: f64) -> Task {
    let mut task = task(KEYS, "  - press: a");
    task.perception.error_pause_s = error_pause_s;
    task.reward.contact_cost = contact_cost;
    task
}

#[test]
fn a_button_is_pressed_on_its_face() {
    let task = press(0.0, 0.0);
    assert_eq!(touched(&task, &[(30, 40, A, 2.0, 1.0)]).done_at, 2.0);
    assert_eq!(touched(&task, &[(30, 40, A, 100.0, 0.0)]).done_at, -1.0, "brushed on a side");
    assert_eq!(touched(&task, &[(30, 40, A, 100.0, -1.0)]).done_at, -1.0, "from behind");
    // On an edge what points into the face counts.
    assert_eq!(touched(&task, &[(30, 40, A, 3.9, 0.5)]).done_at, -1.0);
    assert_eq!(touched(&task, &[(30, 40, A, 4.1, 0.5)]).done_at, 2.0);
    // The same of buttons that are not asked for.
    assert_eq!(touched(&task, &[(30, 40, B, 100.0, 0.0)]).wrong, 0.0);
    assert_eq!(touched(&task, &[(30, 40, B, 1.0, 1.0)]).wrong, 1.0);
}

#[test]
fn a_finger_presses_one_thing_at_a_time() {
    let both = |on_b: f64| touched(&press(0.0, 0.0), &[(30, 40, A, 3.0, 1.0), (30, 40, B, on_b, 1.0)]);
    for (on_b, done_at, wrong) in [(2.9, 2.0, 0.0), (3.0, 2.0, 0.0), (3.1, -1.0, 1.0)] {
        let told = both(on_b);
        assert_eq!((told.done_at, told.wrong), (done_at, wrong), "{on_b} N beside it");
    }
    // What cannot be pressed takes nothing away.
    let on_desk = touched(&press(0.0, 0.0), &[(30, 40, A, 2.0, 1.0), (30, 40, DESK, 50.0, 1.0)]);
    assert_eq!(on_desk.done_at, 2.0);
}

#[test]
fn what_the_finger_slides_onto_is_not_pressed() {
    let told = |contacts: &[(usize, usize, f64, f64, f64)]| {
        let told = touched(&press(0.0, 0.0), contacts);
        (told.done_at, told.wrong)
    };
    let on_a = (30, 40, A, 5.0, 1.0);
    assert_eq!(told(&[(20, 60, DESK, 1.0, 1.0), on_a]), (-1.0, 0.0), "from the desk");
    assert_eq!(told(&[(20, 60, DESK, 1.0, 1.0), (30, 40, B, 5.0, 1.0)]), (-1.0, 0.0), "nor is that an error");
    assert_eq!(told(&[(20, 30, B, 0.9, 1.0), on_a]), (-1.0, 0.0), "from a key that was not pressed");
    assert_eq!(told(&[(20, 30, B, 1.1, 1.0), on_a]), (-1.0, 1.0), "from a key that was pressed by mistake");
    assert_eq!(
        told(&[(20, 30, A, 1.9, 1.0), (30, 35, DESK, 1.0, 1.0), (35, 40, A, 2.0, 1.0)]),
        (2.0, 0.0),
        "it came down on it"
    );
    // Lifted for 30 ms, fifteen physics steps, it comes down anew.
    for (lifted, done_at) in [(16, -1.0), (15, 2.0)] {
        assert_eq!(told(&[(0, lifted, DESK, 1.0, 1.0), on_a]).0, done_at, "lifted at {lifted}");
    }
}

#[test]
fn after_a_wrong_press_presses_do_not_count_for_a_while() {
    // Two control steps.
    let task = press(0.1, 0.0);
    let counts = [true, true, false, false, true, true, true, true];
    let told = touched(&task, &[(30, 40, B, 1.0, 1.0)]);
    assert_eq!((told.wrong, &told.counts[..]), (1.0, &counts[..]));
    // The right one is in vain meanwhile, until it was let go and is pressed again; another wrong one is none, nor one that lasts.
    let early = (60, 80, A, 3.0, 1.0);
    assert_eq!(touched(&task, &[(30, 40, B, 1.0, 1.0), early]).done_at, -1.0);
    assert_eq!(touched(&task, &[(30, 40, B, 1.0, 1.0), (60, 120, A, 3.0, 1.0)]).done_at, -1.0);
    assert_eq!(touched(&task, &[(30, 40, B, 1.0, 1.0), early, (110, 120, A, 3.0, 1.0)]).done_at, 5.0);
    assert_eq!(touched(&task, &[(30, 40, B, 1.0, 1.0), (60, 120, B, 1.0, 1.0)]).wrong, 1.0);
    // Who is slower errs again.
    assert_eq!(touched(&task, &[(30, 40, B, 1.0, 1.0), (110, 120, B, 1.0, 1.0)]).wrong, 2.0);
    // Users without such a pause go on.
    assert_eq!(touched(&press(0.0, 0.0), &[(30, 40, B, 1.0, 1.0), early]).done_at, 3.0);
}

#[test]
fn touching_costs_by_all_forces_at_once_squared() {
    let contacts = [(30, 40, A, 3.0, 1.0), (35, 40, DESK, 4.0, 0.0)];
    assert_eq!(touched(&press(0.0, 0.1), &contacts).squared_force, 5.0 * 9.0 + 5.0 * 49.0);
    assert_eq!(touched(&press(0.0, 0.0), &contacts).squared_force, 0.0, "nobody pays for it");
}
