//! The experiments of the published system: movements whose figures are known, and the page that is kept.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use myo_env::CpuEnv;
use myo_lab::published::{Aiming, Published, at_widths};
use myo_lab::recordings::Recordings;
use myo_lab::{Trajectories, TrajectoryError, trajectories};
use myo_model::builtin;
use myo_tasks::{Item, Range, Task, preset};
use myo_train::{PpoConfig, Trainer};

/// Intercept (s) and slope (s/bit) of people who obey Fitts' law.
const LAW: [f64; 2] = [0.1, 0.15];

/// Two people who move by minimum jerk to targets of two widths over three distances, each movement a trial, at 200 Hz.
fn people() -> String {
    let mut text = String::from("participant,trial,time_s,x_m,y_m,target_x_m,target_y_m,target_width_m\n");
    for who in ["Ada", "Ben"] {
        let mut trial = 0;
        for [distance, width] in [[0.2, 0.02], [0.3, 0.02], [0.4, 0.02], [0.2, 0.08], [0.3, 0.08], [0.4, 0.08]] {
            for repeat in 0..5 {
                trial += 1;
                let end = distance + 0.05 * width * (f64::from(repeat) - 2.0);
                let duration = LAW[0] + LAW[1] * (distance / width + 1.0_f64).log2();
                for sample in 0..((0.6 + duration) * 200.0) as usize {
                    let time = sample as f64 / 200.0;
                    let s = ((time - 0.3) / duration).clamp(0.0, 1.0);
                    let x = end * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
                    writeln!(text, "{who},{trial},{time},{x},0,{distance},0,{width}").unwrap();
                }
            }
        }
    }
    text
}

#[test]
fn movements_by_minimum_jerk_have_its_shape_and_its_law() {
    let found = Aiming::of("people", &Recordings::read(people().as_bytes()).unwrap()).unwrap();
    assert_eq!((found.users, found.movements, found.missed, found.conditions.len()), (2, 60, 0, 6));
    // Entries come before ends, the more so the larger the target: the slope is a little steeper than that of durations.
    let slope = found.fitts.slope_s_per_bit.median;
    assert!(found.fitts.r2.median > 0.98 && (slope / LAW[1] - 1.0).abs() < 0.2, "{found:?}");
    let [narrow, wide] = &found.widths[..] else { panic!("two widths: {found:?}") };
    // Where minimum jerk has 5 % of its peak speed: 30 s² (1 - s)² = 0.05 · 1.875.
    let (at, begin) = (|s: f64| s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s), 0.0594);
    for width in [narrow, wide] {
        assert!((width.time_of_peak - 0.5).abs() < 0.01, "{width:?}");
        for (place, position) in width.position.iter().enumerate() {
            let known = at(begin + (1.0 - 2.0 * begin) * place as f64 / 50.0) - at(begin);
            assert!((position - known).abs() < 0.01, "{place}: {position} {known}");
        }
    }
    // Peak over duration and distance is 1.875 (Flash and Hogan 1985); the middle one of the narrow is over 30 cm.
    let peak = 1.875 * 0.3 / (LAW[0] + LAW[1] * 16.0_f64.log2());
    assert!((narrow.peak_speed_m_s / peak - 1.0).abs() < 0.02, "{} {peak}", narrow.peak_speed_m_s);
    let most = narrow.velocity_m_s.iter().copied().fold(0.0, f64::max);
    assert!((most / narrow.peak_speed_m_s - 1.0).abs() < 0.02, "{most}");
}

#[test]
fn widths_go_from_the_smallest_to_the_largest_target_and_nothing_else_changes() {
    let task = preset("pointing").unwrap();
    let layouts = at_widths(&task).unwrap();
    let sphere = |task: &Task| match &task.scene.0["ball"] {
        Item::Sphere(sphere) => sphere.clone(),
        other => panic!("{other:?}"),
    };
    let radii: Vec<f64> = layouts.iter().map(|layout| (1e3 * sphere(layout).radius.max).round()).collect();
    assert_eq!(radii, [50.0, 70.0, 90.0, 110.0, 130.0, 150.0]);
    for layout in &layouts {
        let mut ball = sphere(layout);
        assert_eq!(ball.radius, Range::fixed(ball.radius.min));
        ball.radius = sphere(&task).radius;
        assert_eq!(ball, sphere(&task));
    }
    for other in ["ar", "wall-ray", "slider"] {
        let refused = at_widths(&preset(other).unwrap()).unwrap_err().to_string();
        assert!(refused.contains(other) && refused.contains("resting spheres of one range of sizes"), "{refused}");
    }
}

/// What is written to a file and read again is what is handed on in memory.
#[test]
fn simulated_users_are_recorded_as_their_trajectories_are_read() {
    let text = "version: 2\nname: balls\nuser: fastest\nmodel: mobl-arms\ntime_limit_s: 0.6\nreset: {pose: zero}\n\
                scene: {near: {kind: sphere, at: [0.1, 0, -0.6], radius: 0.5}, far: {kind: sphere, at: [0.3, 0, 0.4], radius: 0.05}}\n\
                script: [{dwell: {in: near, for_s: 0.2}}, {dwell: {in: far, for_s: 0.2}}]\n";
    let layouts = ["one", "two"].map(|name| Task { name: name.into(), ..Task::from_yaml(text, "t.yaml").unwrap() });
    let model = layouts[0].embody(&builtin(&layouts[0].model).unwrap()).unwrap();
    let config = PpoConfig { num_envs: 64, policy_hidden: vec![8], value_hidden: vec![8], ..PpoConfig::default() };
    let env = CpuEnv::with_layouts(&model, &layouts, &config.envs(1)).unwrap();
    let mut policy = Trainer::new(Box::new(env), config, 1).unwrap().policy();
    let mut all = Trajectories::default();
    let take = |some| {
        all.append(some);
        Ok::<bool, TrajectoryError>(true)
    };
    trajectories(&mut policy, &model, &layouts, (3, 5), take).unwrap();
    let mut file = vec![];
    all.write_head(&mut file).unwrap();
    all.write_rows(&mut file).unwrap();
    let read = Recordings::read(&file[..]).unwrap();
    let own = Recordings::of_user("participant", &mut policy, &model, &layouts, (3, 5)).unwrap();
    let [read, own] = [&read, &own].map(|all| &all.participants[0].trials);
    assert_eq!((read.len(), own.len()), (6, 6));
    for (read, own) in read.iter().zip(own) {
        assert_eq!((&read.name, read.points.len()), (&own.name, own.points.len()));
        let is_near = |a: &f64, b: &f64| (a - b).abs() < 1e-6;
        assert!(read.points.iter().flatten().zip(own.points.iter().flatten()).all(|(a, b)| is_near(a, b)));
        let told = |selection: &myo_lab::recordings::Selection| (selection.samples, selection.entry, selection.outcome);
        let [read, own] = [&read.selections, &own.selections].map(|all| all.iter().map(told).collect::<Vec<_>>());
        assert_eq!(read, own);
        assert_eq!(own.len(), 2);
    }
}

fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/experiments").join(name)
}

/// `MYO_BLESS=1` makes page and figures of the data anew.
#[test]
fn page_and_figures_are_those_of_the_data() {
    let data = std::fs::read_to_string(kept("published.json")).unwrap();
    let found: Published = serde_json::from_str(&data).unwrap();
    assert!(found.trainings.len() == 25 && found.aiming.iter().all(|aiming| aiming.users >= 3), "half of the data");
    let mut made = vec![("published.md".to_owned(), found.page())];
    made.extend(found.plots().into_iter().map(|(stem, plot)| (format!("{stem}.svg"), plot.svg().unwrap())));
    for (name, text) in made {
        if std::env::var_os("MYO_BLESS").is_some() {
            std::fs::write(kept(&name), &text).unwrap();
        }
        assert!(
            std::fs::read_to_string(kept(&name)).unwrap() == text,
            "{name} is out of date; run this with MYO_BLESS=1"
        );
    }
}
