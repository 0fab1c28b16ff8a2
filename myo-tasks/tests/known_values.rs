//! Distances, rewards and counts against values worked out by hand.

use crate::common::version_1;
use myo_tasks::logic::{
    CompiledTask, Contact, Efforts, Goal, Hold, Landmarks, PRESSERS, Progress, Ride, Sensed, Stay, Steering, TaskState,
    Tracking, advance, distance_to_goal, inside, remaining_path, reward,
};
use myo_tasks::{Pointing, Pressing, Range, Region, Reward, Target, Task};

/// A sphere around a point.
fn sphere(centre: [f64; 3], radius: f64, dwell_s: f64) -> Target {
    let [x, y, z] = centre.map(Range::fixed);
    let position = Region { x, y, z };
    let radius = Range::fixed(radius);
    Target::Pointing(Pointing { position, radius, dwell_s, min_distance_from_previous: None, repeat: 1 })
}

/// A button 6 cm wide, 4 cm high and 2 cm thick.
fn button(position: [f64; 3], tilt_deg: f64) -> Target {
    Target::Pressing(Pressing { position, size: [0.06, 0.04, 0.02], tilt_deg, min_force_n: 2.0 })
}

fn task(targets: Vec<Target>, reward: Reward) -> Task {
    Task { targets, reward, time_limit_s: 0.5, ..version_1("ar") }
}

/// The task in numbers, and its state with every sphere at the centre of where it may be.
fn start(task: &Task) -> (CompiledTask<f64>, TaskState<f64>) {
    let compiled = CompiledTask::new(task).unwrap();
    let flat = task.flat().unwrap();
    let spheres: Vec<_> = flat.objects.iter().filter_map(|object| object.sphere()).collect();
    let mut state = TaskState::new(&compiled);
    state.restart(true);
    for (index, sphere) in spheres.into_iter().enumerate() {
        state.position[index] = sphere.region.at([0.5; 3]);
        state.size[index] = sphere.radius.centre();
    }
    (compiled, state)
}

/// The fingertip at a point, touching nothing.
fn at(fingertip: [f64; 3]) -> Sensed<f64> {
    let (held, touch, pressed, let_go) = (0.0, 0.0, 0.0, 0.0);
    let stay = Stay {
        held,
        tracking: Tracking::new(),
        touch,
        squared_force: 0.0,
        pressed,
        let_go,
        down: 0.0,
        pressing: [myo_tasks::logic::Pressing::in_the_air(); PRESSERS],
        holds: [0.0; PRESSERS],
        wrong_presses: 0.0,
        value: 0.0,
        steering: Steering::new(),
        hold: Hold { angle: 0.0, held: 0.0 },
        ride: Ride { along: 0.0, speed: 0.0 },
        open: 0.0,
        passed: 0.0,
        cursor: [0.0; 2],
    };
    Sensed { body: Landmarks::unknown(), pointer: fingertip, stay, now: 25.0 }
}

/// The fingertip pressing a button for some physics steps, as it was followed.
fn pressing(task: &CompiledTask<f64>, state: &TaskState<f64>, button: usize, force: f64) -> Sensed<f64> {
    let mut sensed = at([0.0; 3]);
    let contact = Contact { exists: true, finger: 0, number: button as f64, force, facing: 1.0 };
    for _ in 0..5 {
        sensed.stay.follow(
            task,
            &Goal::of(task, state),
            &Landmarks::unknown(),
            [0.0; 3],
            SHARE,
            std::iter::once(contact),
        );
    }
    sensed
}

/// The fingertip at a point for a whole control step, as it was followed.
fn staying(task: &CompiledTask<f64>, state: &TaskState<f64>, fingertip: [f64; 3]) -> Sensed<f64> {
    let (mut sensed, goal) = (at(fingertip), Goal::of(task, state));
    sensed.stay = Stay::new(state, &goal);
    for _ in 0..25 {
        sensed.stay.follow(task, &goal, &Landmarks::unknown(), fingertip, SHARE, std::iter::empty());
    }
    sensed
}

/// Share of a control step that a physics step is.
const SHARE: f64 = 0.04;

/// A control step that ends so.
fn step(task: &CompiledTask<f64>, sensed: &Sensed<f64>, state: &mut TaskState<f64>) -> Progress<f64> {
    advance(task, &Goal::of(task, state), sensed, state, SHARE)
}

fn distance_to(task: &CompiledTask<f64>, sensed: &Sensed<f64>, state: &TaskState<f64>) -> f64 {
    distance_to_goal(task, sensed, &Goal::of(task, state))
}

#[track_caller]
fn assert_close(got: f64, want: f64) {
    assert!((got - want).abs() < 1e-12, "{got} for {want}");
}

#[test]
fn distance_to_a_sphere() {
    for (inside_is_zero, outside, within) in [(false, 0.5, 0.05), (true, 0.4, 0.0)] {
        let reward = Reward { inside_is_zero, ..Reward::default() };
        let (task, state) = start(&task(vec![sphere([0.4, 0.1, -0.2], 0.1, 0.1)], reward));
        // 30 cm aside and 40 cm up from the centre: 50 cm from it, 40 cm from the surface.
        assert_close(distance_to(&task, &at([0.4, 0.4, 0.2]), &state), outside);
        assert_close(distance_to(&task, &at([0.45, 0.1, -0.2]), &state), within);
    }
}

#[test]
fn distance_to_a_button() {
    let distance = |inside_is_zero, tilt_deg, point| {
        let reward = Reward { inside_is_zero, ..Reward::default() };
        let (task, state) = start(&task(vec![button([0.4, 0.0, 0.0], tilt_deg)], reward));
        distance_to(&task, &at(point), &state)
    };
    // From the centre, whatever the tilt.
    assert_close(distance(false, 90.0, [0.1, 0.4, 0.0]), 0.5);
    // Upright: the face is the plane x = 0.39, from y = -0.03 to 0.03 and z = -0.02 to 0.02.
    assert_close(distance(true, 90.0, [0.34, 0.02, -0.01]), 0.05);
    assert_close(distance(true, 90.0, [0.39, 0.03, 0.02]), 0.0);
    // 3 cm past the edge in y, 4 cm past it in z, 12 cm before the face: 3, 4 and 12 make 13.
    assert_close(distance(true, 90.0, [0.27, 0.06, -0.06]), 0.13);
    // 1 cm behind the face, within the box and 4 cm past its edge: three times as far, for whoever is there must come round.
    assert_close(distance(true, 90.0, [0.4, 0.0, 0.0]), 0.03);
    assert_close(distance(true, 90.0, [0.4, 0.07, 0.0]), 0.05);
    // Lying: the face looks up at z = 0.01; its height runs along x.
    assert_close(distance(true, 0.0, [0.42, 0.03, 0.06]), 0.05);
    assert_close(distance(true, 0.0, [0.45, 0.07, 0.01]), 0.05);
}

#[test]
fn the_remaining_path_goes_over_the_centres_still_to_come() {
    let targets = vec![
        sphere([0.3, 0.0, 0.0], 0.05, 0.0),
        sphere([0.3, 0.3, 0.4], 0.05, 0.0),
        sphere([0.3, 0.3, 0.0], 0.05, 0.0),
    ];
    let (task, mut state) = start(&task(targets, Reward::default()));
    for (phase, path) in [(0.0, 0.9), (1.0, 0.4), (2.0, 0.0), (3.0, 0.0)] {
        state.phase = phase;
        assert_close(remaining_path(&task, &state), path);
    }
}

#[test]
fn every_term_of_the_reward() {
    let weights = Reward {
        distance_cost: 40.0,
        time_cost: 0.4,
        subtask_bonus: 5.0,
        completion_bonus: 16.0,
        effort_cost: 5.0,
        acceleration_cost: 0.02,
        control_change_cost: 0.1,
        wrong_press: 0.5,
        exit: 0.75,
        ..Reward::default()
    };
    let (mut task, _) = start(&task(vec![sphere([0.3, 0.0, 0.0], 0.05, 0.0)], weights));
    // 40 a second and metre, 0.4 a second, at 20 steps a second: 2 and 0.02 a step.
    for (target_done, task_done, bonuses) in
        [(false, false, [0.0, 0.0]), (true, false, [5.0, 0.0]), (true, true, [5.0, 16.0])]
    {
        let progress: Progress<f64> = Progress {
            target_done,
            target_over: target_done,
            task_done,
            task_over: task_done,
            timed_out: false,
            wrong_presses: 3.0,
            exits: 2.0,
            bonuses: f64::from(u8::from(target_done)),
        };
        // A change by 0.3 within 0.05 s is a rate of 6 a second: 3.6 a second are 0.18 a step.
        let efforts =
            Efforts { squared_control: 8.0, squared_acceleration: 1000.0, squared_change: 0.09, squared_force: 100.0 };
        let terms = reward(&task, &progress, 0.3, efforts);
        assert_close(terms.distance, -0.62);
        assert_close(terms.subtask, bonuses[0]);
        assert_close(terms.completion, bonuses[1]);
        assert_close(terms.neural_effort, -2.0);
        assert_close(terms.acceleration_effort, -1.0);
        assert_close(terms.control_change, -0.18);
        assert_close(terms.wrong_press, -1.5);
        assert_close(terms.exit, -1.5);
        assert_close(terms.sum(), -6.8 + bonuses[0] + bonuses[1]);
        assert_eq!(terms.array().iter().sum::<f64>(), terms.sum());
    }
    // Of a learner: a half of what movements and errors cost, and all of the rest.
    task.weights.cost_share = 0.5;
    let progress: Progress<f64> = Progress {
        target_done: true,
        target_over: true,
        task_done: false,
        task_over: false,
        timed_out: false,
        wrong_presses: 3.0,
        exits: 2.0,
        bonuses: 1.0,
    };
    let efforts =
        Efforts { squared_control: 8.0, squared_acceleration: 1000.0, squared_change: 0.09, squared_force: 100.0 };
    let terms = reward(&task, &progress, 0.3, efforts);
    let expected = [-0.62, 5.0, 0.0, -1.0, -0.5, -0.09, 0.0, -0.75, -0.75];
    terms.array().iter().zip(expected).for_each(|(&term, expected)| assert_close(term, expected));
}

#[test]
fn what_movements_cost_beyond_what_is_earned_at_once_in_a_quarter_of_a_second_counts_for_less_and_less() {
    let costs_of = |subtask_bonus: f64, completion_bonus: f64, squared_change: f64| {
        let weights = Reward {
            subtask_bonus,
            completion_bonus,
            effort_cost: 20.0,
            acceleration_cost: 0.2,
            control_change_cost: 0.1,
            ..Reward::default()
        };
        let (task, _) = start(&task(vec![sphere([0.3, 0.0, 0.0], 0.05, 0.0)], weights));
        let nothing: Progress<f64> = Progress {
            target_done: false,
            target_over: false,
            task_done: false,
            task_over: false,
            timed_out: false,
            wrong_presses: 0.0,
            exits: 0.0,
            bonuses: 0.0,
        };
        let efforts = Efforts { squared_control: 0.2, squared_acceleration: 30.0, squared_change, squared_force: 0.0 };
        let terms = reward(&task, &nothing, 0.0, efforts);
        [terms.neural_effort, terms.acceleration_effort, terms.control_change]
    };
    // In a step of 0.05 s effort costs 0.2, acceleration 0.3, and changes twice the sum of squares; a fifth of the greatest bonus counts in full.
    for (bonuses, squared_change, all) in [
        ([5.0, 0.0], 0.2, 0.9),
        ([5.0, 0.0], 0.25, 1.0),
        ([5.0, 0.0], 0.75, 1.0 + 2.0_f64.ln()),
        ([5.0, 11.0], 0.75, 2.0),
        ([5.0, 11.0], 1.95, 2.2 * (1.0 + 2.0_f64.ln())),
        ([5.0, 0.0], 49.75, 1.0 + 100.0_f64.ln()),
        ([0.0, 0.0], 40.0, 80.5),
    ] {
        // All of them shrink alike.
        let shrunk = all / (0.5 + 2.0 * squared_change);
        let costs = [0.2, 0.3, 2.0 * squared_change].map(|cost| cost * shrunk);
        for (found, cost) in costs_of(bonuses[0], bonuses[1], squared_change).into_iter().zip(costs) {
            assert_close(found, -cost);
        }
    }
}

#[test]
fn a_dwell_is_counted_in_a_row_and_starts_again_outside() {
    let (task, mut state) = start(&task(vec![sphere([0.3, 0.0, 0.0], 0.05, 0.15)], Reward::default()));
    let (near, far) = (at([0.3, 0.04, 0.0]), at([0.3, 0.06, 0.0]));
    let goal = Goal::of(&task, &state);
    assert!(inside(&near, &goal) && !inside(&far, &goal) && !inside(&at([0.3, 0.05, 0.0]), &goal));
    // 0.15 s are three steps at 20 a second.
    for (count, (place, dwell)) in
        [(&near, 1.0), (&near, 2.0), (&far, 0.0), (&near, 1.0), (&near, 2.0)].iter().enumerate()
    {
        let sensed = staying(&task, &state, place.pointer);
        let progress = step(&task, &sensed, &mut state);
        assert_eq!((state.dwell, progress.target_done, state.step), (*dwell, false, count as f64 + 1.0));
        assert_eq!(state.done_at, [-1.0]);
    }
    let sensed = staying(&task, &state, near.pointer);
    let progress = step(&task, &sensed, &mut state);
    assert!(progress.target_done && progress.task_done && !progress.timed_out);
    assert_eq!((state.phase, state.dwell, &state.done_at[..]), (1.0, 0.0, &[6.0][..]));
}

#[test]
fn a_button_is_done_by_enough_force_on_itself() {
    let targets = vec![button([0.4, 0.1, 0.0], 90.0), button([0.4, -0.1, 0.0], 90.0)];
    let (task, mut state) = start(&task(targets, Reward::default()));
    let task = &task;
    let mut done = |sensed: &dyn Fn(&TaskState<f64>) -> Sensed<f64>| {
        let sensed = sensed(&state);
        step(task, &sensed, &mut state).target_done
    };
    let press = |button, force| move |state: &TaskState<f64>| pressing(task, state, button, force);
    assert!(!done(&press(0, 1.99)), "2 N are needed");
    assert!(!done(&press(1, 50.0)), "the second button is not yet asked for");
    assert!(!done(&|_| at([0.4, 0.1, 0.0])), "being there is not pressing");
    assert!(done(&press(0, 2.0)));
    assert!(!done(&press(0, 2.0)), "the first one is done");
    assert!(done(&press(1, 2.0)));
    assert_eq!((state.phase, &state.done_at[..]), (2.0, &[4.0, 6.0][..]));
}

#[test]
fn the_time_limit_ends_what_is_not_done() {
    let (task, mut state) = start(&task(vec![sphere([0.3, 0.0, 0.0], 0.05, 0.0)], Reward::default()));
    // 0.5 s are ten steps.
    let ends: Vec<bool> = (0..10).map(|_| step(&task, &at([0.0; 3]), &mut state).timed_out).collect();
    assert_eq!(ends, [false, false, false, false, false, false, false, false, false, true]);
    state.step = 9.0;
    let sensed = staying(&task, &state, [0.3, 0.0, 0.0]);
    let progress = step(&task, &sensed, &mut state);
    assert!(progress.task_done && !progress.timed_out, "done in the last step is done");
}

#[test]
fn costs_of_old_files_are_those_per_control_step() {
    let text = |reward: &str, dt: f64| {
        format!(
            "version: 2\nname: t\nscene: {{ball: {{kind: sphere, at: [0.4, 0, 0], radius: 0.1}}}}\nscript: [{{dwell: {{in: ball, for_s: 0.2}}}}]\ncontrol_dt_s: {dt}\nreward: {reward}\n"
        )
    };
    let read = |reward: &str, dt| Task::from_yaml(&text(reward, dt), "t.yaml");
    let old = read("{distance: 0.3, neural_effort: 0.001, acceleration_effort: 1.0e-6}", 0.05).unwrap();
    let new = read("{distance_cost: 6, effort_cost: 0.02, acceleration_cost: 2.0e-5}", 0.05).unwrap();
    assert_eq!(old, new);
    assert_eq!(read("{distance: 0.3}", 0.01).unwrap().reward.distance_cost, 30.0);
    // A step of a tenth of a second costs ten times as much as one of a hundredth.
    let cost = |dt| CompiledTask::<f64>::new(&read("{distance_cost: 6}", dt).unwrap()).unwrap().weights.distance_cost;
    assert_close(cost(0.1), 0.6);
    assert_close(cost(0.01), 0.06);
    let error = read("{distance: 0.3, distance_cost: 6}", 0.05).unwrap_err().to_string();
    assert!(error.contains("`distance_cost` the same per second; leave one of them out"), "{error}");
}

#[test]
fn far_distances_count_for_less_where_the_reward_says_so() {
    let weights =
        |distance_scale_m| Reward { distance_cost: 20.0, time_cost: 0.0, distance_scale_m, ..Reward::default() };
    let progress: Progress<f64> = Progress {
        target_done: false,
        target_over: false,
        task_done: false,
        task_over: false,
        timed_out: false,
        wrong_presses: 0.0,
        exits: 0.0,
        bonuses: 0.0,
    };
    let cost = |scale: f64, distance: f64| {
        let (task, _) = start(&task(vec![sphere([0.3, 0.0, 0.0], 0.05, 0.0)], weights(scale)));
        -reward(&task, &progress, distance, Efforts::none()).distance
    };
    // 20 a second and metre are 1 a step and metre; one minus e^-1 is 0.632.
    assert_close(cost(0.0, 0.3), 0.3);
    assert_close(cost(0.1, 0.1), 0.063_212_055_882_855_77);
    assert_close(cost(0.1, 100.0), 0.1);
    assert!((cost(0.1, 1e-4) / 1e-4 - 1.0).abs() < 1e-3, "{}", cost(0.1, 1e-4));
}
