//! Trajectories are what the physics did.

use myo_env::CpuEnv;
use myo_lab::recordings::{Outcome, Recordings};
use myo_lab::{Column, Trajectories, TrajectoryError, Values, trajectories};
use myo_model::builtin;
use myo_tasks::Task;
use myo_train::{Policy, PpoConfig, Trainer};

/// A ball so large that whoever lets the arm hang is in it, and one that is out of reach of beginners.
const TWO_BALLS: &str = "version: 2\nname: balls\nuser: fastest\nmodel: mobl-arms\ntime_limit_s: 0.6\nreset: {pose: zero}\n\
    scene: {near: {kind: sphere, at: [0.1, 0, -0.6], radius: 0.5}, far: {kind: sphere, at: [0.3, 0, 0.4], radius: 0.05}}\n\
    script: [{dwell: {in: near, for_s: 0.2}}, {dwell: {in: far, for_s: 0.2}}]\n";

fn task(text: &str) -> Task {
    Task::from_yaml(text, "t.yaml").unwrap()
}

/// What a user does who has learnt nothing.
fn taken(layouts: &[Task], episodes: usize) -> Trajectories {
    let model = layouts[0].embody(&builtin(&layouts[0].model).unwrap()).unwrap();
    let config = PpoConfig { num_envs: 64, policy_hidden: vec![8], value_hidden: vec![8], ..PpoConfig::default() };
    let env = CpuEnv::with_layouts(&model, layouts, &config.envs(1)).unwrap();
    let mut policy: Policy = Trainer::new(Box::new(env), config, 1).unwrap().policy();
    let mut all = Trajectories::default();
    let take = |some| {
        all.append(some);
        Ok::<bool, TrajectoryError>(true)
    };
    trajectories(&mut policy, &model, layouts, (episodes, 5), take).unwrap();
    all
}

fn column<'a>(table: &'a Trajectories, name: &str) -> &'a Column {
    table.columns.iter().find(|column| column.name == name).unwrap_or_else(|| panic!("no column {name}"))
}

fn numbers<'a>(table: &'a Trajectories, name: &str) -> &'a [f64] {
    let Values::Number(all) = &column(table, name).values else { panic!("{name} has no numbers") };
    all
}

fn whole<'a>(table: &'a Trajectories, name: &str) -> &'a [u32] {
    let Values::Whole(all) = &column(table, name).values else { panic!("{name} has no whole numbers") };
    all
}

fn texts<'a>(table: &'a Trajectories, name: &str) -> &'a [String] {
    let Values::Text(all) = &column(table, name).values else { panic!("{name} has no texts") };
    all
}

#[test]
fn every_physics_step_of_every_episode_is_there_with_its_events() {
    let table = taken(&[task(TWO_BALLS)], 3);
    assert_eq!(table.rows(), 3 * 300);
    let (times, episodes) = (numbers(&table, "time_s"), whole(&table, "episode"));
    assert!((0..900).all(|row| (times[row] - 0.002 * (row % 300 + 1) as f64).abs() < 1e-12));
    assert!((0..900).all(|row| episodes[row] as usize == row / 300 + 1));
    let events = texts(&table, "event");
    let of_first: Vec<(usize, &str)> = events[..300]
        .iter()
        .enumerate()
        .filter(|(_, event)| !event.is_empty())
        .map(|(k, event)| (k, &**event))
        .collect();
    // It is in the near ball from the start, and stays for 0.2 s: a hundred samples, whole control steps of 25.
    assert_eq!(of_first, [(0, "entered"), (99, "done"), (299, "time_out")]);
    let (steps, objects) = (whole(&table, "step"), texts(&table, "object"));
    assert_eq!((steps[99], &*objects[99], steps[100], &*objects[100]), (1, "near", 2, "far"));
    let (z, width) = (numbers(&table, "object_z_m")[99], numbers(&table, "object_width_m")[100]);
    assert!((z + 0.6).abs() < 1e-6 && (width - 0.1).abs() < 1e-6, "{z} {width}");
}

#[test]
fn velocities_are_rates_and_muscles_pull() {
    let table = taken(&[task(TWO_BALLS)], 1);
    let (q, v) = (numbers(&table, "elbow_flexion_rad"), numbers(&table, "elbow_flexion_rad_s"));
    // Semi-implicit: a step ends where its last velocity takes it.
    assert!((1..300).all(|row| ((q[row] - q[row - 1]) / 0.002 - v[row]).abs() < 1e-3 * v[row].abs().max(1.0)));
    assert!(v.iter().any(|v| v.abs() > 0.1), "it moves: {v:?}");
    let (act, force) = (numbers(&table, "DELT1_activation"), numbers(&table, "DELT1_force_n"));
    assert!(act.iter().all(|act| (0.0..=1.0).contains(act)) && force.iter().all(|&force| force >= 0.0));
    assert!(force.iter().any(|&force| force > 10.0), "{force:?}");
    let x = numbers(&table, "fingertip_x_m");
    assert!(x.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 0.02), "nothing jumps");
    assert!(table.columns.iter().all(|column| !column.name.starts_with("pointer")), "the fingertip points");
}

#[test]
fn episodes_do_not_depend_on_how_many_there_are() {
    let (few, many) = (taken(&[task(TWO_BALLS)], 2), taken(&[task(TWO_BALLS)], 34));
    for (few, many) in few.columns.iter().zip(&many.columns) {
        let Values::Number(many) = &many.values else { continue };
        let Values::Number(few) = &few.values else { panic!("columns differ") };
        let bits = |all: &[f64]| all.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(few), bits(&many[..600]));
    }
    assert_eq!((many.rows(), whole(&many, "episode")[33 * 300]), (34 * 300, 34));
}

#[test]
fn layouts_are_named_and_rays_have_a_pointer() {
    let other = TWO_BALLS.replace("name: balls", "name: others").replace("at: [0.3, 0, 0.4]", "at: [0.3, 0.1, 0.4]");
    let table = taken(&[task(TWO_BALLS), task(&other)], 2);
    let names = texts(&table, "layout");
    assert_eq!([&*names[0], &*names[300], &*names[600]], ["balls", "others", "balls"]);
    assert_eq!(whole(&table, "episode")[600], 2);

    let ray = "version: 2\nname: wall\nuser: fastest\nmodel: mobl-arms\ntime_limit_s: 0.2\ntechnique: {kind: ray, from: forearm}\n\
               scene: {ball: {kind: sphere, at: [1.5, 0, 0], radius: 0.2}}\nscript: [{dwell: {in: ball, for_s: 0.2}}]\n";
    let table = taken(&[task(ray)], 1);
    let [tip, pointer] = ["fingertip_x_m", "pointer_x_m"].map(|name| numbers(&table, name));
    assert!(tip.iter().zip(pointer).any(|(tip, pointer)| (tip - pointer).abs() > 0.1));
}

/// Balls in which the hanging arm is already: what is asked for, when it lights up, and in which order, is all that happens.
const WAITS: &str = "version: 2\nname: waits\nuser: fastest\nmodel: mobl-arms\ntime_limit_s: 3\nreset: {pose: zero}\n\
    scene: {a: {kind: sphere, at: [0.1, 0, -0.6], radius: 0.6}, b: {kind: sphere, at: [0.1, 0.05, -0.6], radius: 0.6}}\n\
    script: [{wait: 0.3}, {dwell: {in: a, for_s: 0.2}}, {random_order: [{dwell: {in: [a, b], for_s: 0.2}}]}, {react: {among: [a, b], after_s: 0.4, for_s: 0.2}}]\n";

#[test]
fn steps_end_where_they_are_done_whatever_their_order_and_however_long_is_waited() {
    let table = taken(&[task(WAITS)], 3);
    let (steps, events) = (whole(&table, "step"), texts(&table, "event"));
    let ends = ["done", "success"];
    for row in 1..table.rows() {
        let is_new = whole(&table, "episode")[row] != whole(&table, "episode")[row - 1];
        let ended = ends.contains(&&*events[row - 1]);
        assert_eq!(is_new || steps[row] != steps[row - 1], ended, "row {row}, step {}", steps[row]);
    }
    let success = events.iter().filter(|event| *event == "success").count();
    assert_eq!(success, 3, "{events:?}");
    // Of each step that has a target the entry is told, in the time of that step.
    let entered = events.iter().filter(|event| *event == "entered").count();
    assert!(entered >= 3 * 4, "{entered}");
}

/// What is exported can be measured: somebody who is in each target at once misses none.
#[test]
fn exported_tables_are_recordings() {
    let ray =
        WAITS.replace("reset:", "technique: {kind: ray, from: forearm}\nreset:").replace("radius: 0.6", "radius: 2");
    let following = "version: 2\nname: follow\nuser: fastest\nmodel: mobl-arms\ntime_limit_s: 2\nreset: {pose: zero}\n\
        scene: {ball: {kind: sphere, at: [0.1, 0, -0.6], radius: 0.6, moves: {kind: circle, diameter: 0.1, period_s: 1}}}\n\
        script: [{follow: {target: ball, for_s: 0.5}}]\n";
    for (text, selections) in [(WAITS, 4), (&*ray, 4), (following, 1)] {
        let table = taken(&[task(text)], 2);
        let mut out = vec![];
        table.write_head(&mut out).unwrap();
        table.write_rows(&mut out).unwrap();
        let recordings = Recordings::read(&*out).unwrap();
        let [participant] = &recordings.participants[..] else { panic!("one participant") };
        for trial in &participant.trials {
            let with_target = trial.selections.iter().filter(|selection| selection.outcome == Outcome::Hit).count();
            assert!(with_target >= selections, "{}: {:?}", trial.name, trial.selections);
        }
    }
}

#[test]
fn cells_are_as_spreadsheets_read_them() {
    let column = |name: &str, values| Column { name: name.into(), values };
    let table = Trajectories {
        columns: vec![
            column("step", Values::Whole(vec![2, 0])),
            column("a \"b\", c", Values::Text(vec!["plain".into(), "with, comma".into()])),
            column("x_m", Values::Number(vec![0.123_456_789, f64::NAN])),
        ],
    };
    let mut out = vec![];
    table.write_head(&mut out).unwrap();
    table.write_rows(&mut out).unwrap();
    let expected = "step,\"a \"\"b\"\", c\",x_m\n2,plain,0.1234568\n,\"with, comma\",\n";
    assert_eq!(String::from_utf8(out).unwrap(), expected);
}

#[test]
fn what_is_given_up_is_told_and_what_is_done_after_it_is_done() {
    let script = "script: [{dwell: {in: far, for_s: 0.2}}, {dwell: {in: near, for_s: 0.2}}]\nstep_limit_s: 0.3\n";
    let text =
        TWO_BALLS.lines().filter(|line| !line.trim_start().starts_with("script:")).collect::<Vec<_>>().join("\n");
    let table = taken(&[task(&format!("{text}\n{script}"))], 1);
    let events = texts(&table, "event").iter().enumerate().filter(|(_, event)| !event.is_empty());
    // The far ball is given up after 0.3 s, and the near one, in which the arm is all the time, is done 0.2 s later.
    let told: Vec<(usize, &str)> = events.map(|(k, event)| (k, &**event)).collect();
    assert_eq!((told[0], *told.last().unwrap()), ((149, "given_up"), (249, "done")), "{told:?}");
    assert_eq!((told.len(), table.rows()), (3, 250), "{told:?}");
}
