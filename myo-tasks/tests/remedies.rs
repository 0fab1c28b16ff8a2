//! What the check of a task advises where a target is out of reach: the task with the advice taken has nothing to say.

use myo_tasks::{Reach, Region, Remedy, Report, Target, Task, TaskError, TaskWarning, check};

/// In reach: everything between two distances from the shoulder.
struct Shell {
    least: f64,
    most: f64,
}

impl Reach for Shell {
    fn nearest_in_reach(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let length = f64::hypot(f64::hypot(x, y), z);
        let share = length.clamp(self.least, self.most) / length;
        // One rounding must not put the nearest point out of reach.
        if share == 1.0 || (share - 1.0).abs() < 1e-12 { [x, y, z] } else { [x * share, y * share, z * share] }
    }
}

const BALL: Shell = Shell { least: 0.0, most: 0.5 };

fn task(position: &str) -> Task {
    let text = format!(
        "version: 1\nname: t\ntargets:\n  - kind: pointing\n    position: {{ {position} }}\n    radius: 0.02\n    dwell_s: 0.2\ntime_limit_s: 4\n"
    );
    Task::from_yaml(&text, "t").unwrap()
}

fn remedy(report: &Report) -> &Remedy {
    match (&report.errors[..], &report.warnings[..]) {
        ([TaskError::OutOfReach { remedy, .. }], []) | ([], [TaskWarning::PartlyOutOfReach { remedy, .. }]) => remedy,
        other => panic!("{other:?}"),
    }
}

fn at(task: &Task, region: Region) -> Task {
    let mut task = task.clone();
    match &mut task.targets[0] {
        Target::Pointing(sphere) => sphere.position = region,
        Target::Pressing(button) => button.position = region.at([0.0; 3]),
    }
    task
}

/// Length of the move that is advised; the task with any of the advice taken is clean.
fn advised(task: &Task, reach: &Shell) -> f64 {
    let report = check(task, reach);
    let Remedy { moved, narrowed } = remedy(&report);
    let moved = moved.as_ref().expect("a move");
    for region in [Some(moved.to), *narrowed].into_iter().flatten() {
        assert_eq!(check(&at(task, region), reach), Report::default(), "{region:?}");
    }
    moved.length()
}

#[test]
fn a_single_sphere_is_moved_the_shortest_way() {
    for (position, expected) in [("x: 0.7, y: 0, z: 0", 0.2), ("x: 0.3, y: 0.4, z: 0.3", 0.34_f64.sqrt() - 0.5)] {
        let length = advised(&task(position), &BALL);
        assert!((length - expected).abs() < 0.004, "{position}: {length}");
    }
}

#[test]
fn where_nearer_to_the_shoulder_is_worse_the_advice_leads_away_from_it() {
    let hole = Shell { least: 0.3, most: 0.7 };
    let task = task("x: 0.1, y: 0.1, z: 0");
    let report = check(&task, &hole);
    assert!((advised(&task, &hole) - (0.3 - 0.02_f64.sqrt())).abs() < 0.004);
    let text = report.errors[0].to_string();
    assert!(text.contains("forward") && text.contains("to the left") && !text.contains("nearer"), "{text}");
}

#[test]
fn a_range_is_moved_the_shortest_way_that_brings_all_of_it_into_reach() {
    // A wall 60 cm wide at half a metre: at 40 cm its edges are 50 cm away.
    let length = advised(&task("x: 0.5, y: [-0.3, 0.3], z: 0"), &BALL);
    assert!((length - 0.1).abs() < 0.004, "{length}");
    let length = advised(&task("x: [0.3, 0.6], y: 0, z: 0"), &BALL);
    assert!((length - 0.1).abs() < 0.004, "{length}");
}

#[test]
fn what_cannot_be_moved_into_reach_as_a_whole_is_narrowed() {
    let task = task("x: 0.3, y: [-0.9, 0.9], z: 0");
    let report = check(&task, &BALL);
    let Remedy { moved: None, narrowed: Some(part) } = remedy(&report) else { panic!("{report:?}") };
    assert_eq!(check(&at(&task, *part), &BALL), Report::default());
    // Within y of 0.42, where the surface is just in reach.
    assert!(part.y.width() > 0.6 && part.y.width() < 0.84, "{part:?}");
    let text = report.warnings[0].to_string();
    assert!(text.contains("narrow the range to x 0.3, y -0."), "{text}");
}

#[test]
fn a_range_that_is_too_large_is_shrunk_and_moved() {
    let task = task("x: [1.5, 2], y: [-1, 1], z: [-1, 1]");
    let report = check(&task, &BALL);
    let Remedy { moved: Some(moved), narrowed: None } = remedy(&report) else { panic!("{report:?}") };
    assert_eq!((moved.scale, moved.to.y.width()), (0.25, 0.5));
    assert_eq!(check(&at(&task, moved.to), &BALL), Report::default());
    assert!(
        report.errors[0].to_string().contains("; shrink the range to 25.0 % and move it 1"),
        "{}",
        report.errors[0]
    );
}

#[test]
fn a_warning_says_which_part_is_out_of_reach() {
    let report = check(&task("x: 0.3, y: [0, 0.6], z: 0"), &BALL);
    let text = report.warnings[0].to_string();
    // The surface is in reach up to y = 0.424.
    let TaskWarning::PartlyOutOfReach { missed, fraction, .. } = &report.warnings[0] else { panic!("{text}") };
    assert!((missed.y.min - 0.424).abs() < 0.005 && missed.y.max == 0.6, "{missed:?}");
    assert!((fraction - 0.293).abs() < 0.02, "{fraction}");
    assert!(text.contains("within x 0.3, y 0.42") && text.contains("or narrow it to x 0.3, y 0 to 0."), "{text}");
    advised(&task("x: 0.3, y: [0, 0.6], z: 0"), &BALL);
}

#[test]
fn random_ranges_and_buttons_are_clean_once_the_advice_is_taken() {
    let mut number: u32 = 1;
    let mut draw = |lo: f64, hi: f64| {
        number = number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let x = lo + (hi - lo) * f64::from(number >> 8) / f64::from(1_u32 << 24);
        (1e4 * x).round() / 1e4
    };
    let (mut tried, mut found) = (0, 0);
    for k in 0..60 {
        let mut task = task("x: 0.5, y: 0, z: 0");
        let position = [draw(0.2, 0.7), draw(-0.5, 0.5), draw(-0.5, 0.5)];
        if k % 2 == 0 {
            let axis = |at: f64, width: f64| myo_tasks::Range::new(at, at + width);
            let [x, y, z] = position.map(|at| axis(at, draw(0.0, 0.3)));
            let Target::Pointing(sphere) = &mut task.targets[0] else { panic!("a sphere") };
            sphere.position = Region { x, y, z };
        } else {
            let text = format!(
                "kind: pressing\nposition: {position:?}\nsize: [0.05, 0.04, 0.02]\ntilt_deg: 70\nmin_force_n: 1"
            );
            task = Task::from_yaml(&task.to_yaml(), "t").unwrap();
            task.targets[0] = serde_saphyr::from_str(&text).unwrap();
        }
        let report = check(&task, &BALL);
        if report == Report::default() {
            continue;
        }
        tried += 1;
        let Remedy { moved, narrowed } = remedy(&report);
        found += u32::from(moved.is_some());
        for region in [moved.as_ref().map(|moved| moved.to), *narrowed].into_iter().flatten() {
            assert_eq!(check(&at(&task, region), &BALL), Report::default(), "{}\n{region:?}", task.to_yaml());
        }
    }
    assert!(tried > 30 && found == tried, "{found} of {tried}");
}
