//! What tests of environments share.
#![allow(dead_code)]

use myo_env::{StepStorage, VectorEnv};
use myo_gpu::{AdapterChoice, Gpu};
use myo_model::description::{Geom, Shape, Site};
use myo_model::{Model, ModelDescription, builtin};
use myo_scalar::Level;
use myo_tasks::{Instruction, Item, Source, SphereItem, Task, User, preset_text};

pub fn arm(task: &Task) -> Model {
    let mut description = builtin(&task.model).unwrap();
    if ["fingers", "chords"].contains(&&*task.name) {
        give_fingers(&mut description);
    }
    Model::new(&description).unwrap()
}

/// Places of an arm as fingers that point and press: one before the wrist, so that a bent wrist is a pinch, and one behind. Hands of many joints,
/// thrown about, come to their limits so fast that single precision tells nothing after some steps.
fn give_fingers(description: &mut ModelDescription) {
    for (name, tip) in [("thumb", "ECRL-P3"), ("middle", "PL-P3")] {
        let Site { body, pos, .. } = description.sites.iter().find(|site| site.name == tip).unwrap().clone();
        let shape = Shape::Sphere { radius: 0.04 };
        description.geoms.push(Geom { name: name.into(), body, pos, shape, ..description.geoms[0].clone() });
        description.landmarks.fingers.insert(name.into(), tip.into());
    }
}

/// The best graphics card, or a software driver.
pub fn gpu() -> Gpu {
    Gpu::open(&AdapterChoice::Any).expect("a GPU or a software driver; to skip these tests, set MYO_NO_GPU=1")
}

/// Whether this processor runs no machine code; it says so where tests are left out for it.
pub fn without_native() -> bool {
    let without = Level::current().lanes() != 16;
    if without {
        println!("skipped: no AVX-512 here");
    }
    without
}

/// Whether tests on a graphics card are to be left out.
pub fn without_gpu() -> bool {
    let skip = std::env::var("MYO_NO_GPU").as_deref() == Ok("1");
    if skip {
        println!("skipped: MYO_NO_GPU=1 says that there is no graphics card and no software driver");
    }
    skip
}

/// A preset done by the fastest user, on a body of straight muscles: what is tested with it holds whoever does it, and these are quick.
pub fn fast(name: &str) -> Task {
    let task = Source::parse(preset_text(name).unwrap(), name).unwrap().done_by(User::Fastest).task;
    let model = if task.model == "myo-arm" { "mobl-arms".into() } else { task.model };
    Task { model, ..task }
}

/// The same, short enough to end often.
pub fn short(name: &str) -> Task {
    let mut task = fast(name);
    task.time_limit_s = 0.5;
    task
}

/// A sphere on its way, to be followed after a wait, and a cursor on a wall that follows it.
pub fn following() -> Task {
    following_with(&[])
}

/// The same with other numbers: pairs of a text in it and what stands there instead.
pub fn following_with(changes: &[(&str, &str)]) -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: following\nscene:\n  wall: {kind: obstacle, at: [1, 0, 0], tilt_deg: 90, size: [2, 2, 0.02]}\n  \
                ball: {kind: sphere, at: [0.99, [-0.1, 0.1], 0], radius: 0.3, moves: {kind: random, by: [0, 0.2, 0.2], period_s: 1}}\n  \
                slow: {kind: sphere, at: [0.99, 0, 0], radius: [0.1, 0.3], moves: {kind: circle, diameter: 0.2, period_s: 3}}\n\
                technique: {kind: cursor, onto: wall, at: [0.3, 0, -0.2], gain: 4}\nscript:\n  - wait: [0.05, 0.2]\n  \
                - follow: {target: ball, for_s: 0.1}\n  - react: {among: [slow, ball], after_s: [0, 0.1], for_s: 0.05}\n\
                time_limit_s: 0.5\n";
    changed("following", text, changes)
}

/// A task's text with other numbers: pairs of a text in it and what stands there instead.
pub fn changed(name: &str, text: &str, changes: &[(&str, &str)]) -> Task {
    let text = changes.iter().fold(text.to_owned(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replace(old, new)
    });
    Task::from_yaml(&text, name).unwrap()
}

/// Spheres in a drawn order and in any, a way between two of them, and a plate before the body, which presses that take back others.
pub fn shuffled() -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: shuffled\nscene:\n  wide: {kind: sphere, at: [[0.1, 0.4], [-0.3, 0.3], [-0.5, 0.1]], radius: 0.35, copies: 7}\n  \
                plate: {kind: button, at: [0.25, 0, -0.2], size: [1.2, 0.9, 0.02], min_force_n: 0.05}\n  \
                back: {kind: button, at: [0.25, 0, 0.4], size: [1.2, 0.3, 0.02], min_force_n: 0.05}\n\
                stimulus: current\ncorrection: back\nscript:\n  - random_order: [{dwell: {in: [wide.1, wide.2, wide.3], for_s: 0.05}}]\n  \
                - any_order: [{dwell: {in: [wide.4, wide.5, wide.6], for_s: 0.05}}, {press: plate}]\n  \
                - steer: {through: [wide.7, wide.1], width: 0.3}\ntime_limit_s: 0.8\n";
    Task::from_yaml(text, "shuffled").unwrap()
}

/// Plates and a sphere in groups that stand elsewhere in every episode, an obstacle beside them, and all of it observed.
pub fn drifting() -> Task {
    drifting_with(&[])
}

/// The same with other numbers.
pub fn drifting_with(changes: &[(&str, &str)]) -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: drifting\nscene:\n  desk:\n    kind: group\n    at: [[0.15, 0.35], [-0.2, 0.2], [-0.3, 0.1]]\n    \
                turn_deg: 20\n    objects:\n      plate: {kind: button, at: [0, 0.3, 0], size: [0.55, 0.9, 0.02], min_force_n: 0.05}\n      \
                other: {kind: button, at: [0, -0.3, 0], size: [[0.3, 0.55], [0.5, 0.9], [0.02, 0.1]], min_force_n: 0.05}\n      \
                spot: {kind: sphere, at: [0, 0, 0.2], radius: [0.25, 0.35]}\n  \
                shelf: {kind: obstacle, at: [0.3, 0, [0.4, 0.6]], size: [1, 0.5, 0.02]}\n\
                observation: {target_normal: true, target_kind: true, nearest_obstacle: true}\nscript:\n  \
                - press: [other, plate]\n  - dwell: {in: spot, for_s: 0.05}\n  - react: {among: [plate, other], after_s: [0, 0.1]}\n\
                time_limit_s: 0.8\n";
    changed("drifting", text, changes)
}

/// A cursor that moves by itself to spheres on a wall, one of which moves, seen until the movement begins.
pub fn steered() -> Task {
    steered_with(&[])
}

/// The same with other numbers.
pub fn steered_with(changes: &[(&str, &str)]) -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: steered\nscene:\n  wall: {kind: obstacle, at: [1, 0, 0], tilt_deg: 90, size: [2, 2, 0.02]}\n  \
                ball: {kind: sphere, at: [0.99, [-0.1, 0.1], 0], radius: 0.3, moves: {kind: random, by: [0, 0.2, 0.2], period_s: 1}}\n  \
                spot: {kind: sphere, at: [0.99, [-0.2, 0.2], [-0.2, 0.2]], radius: 0.2, min_distance_from_previous: 0}\n\
                technique: {kind: rate_cursor, onto: wall, at: [0.3, 0, -0.2], gain: 3}\nstimulus: before_movement\n\
                script:\n  - wait: [0, 0.1]\n  - dwell: {in: [ball, spot], for_s: 0.1}\n  - follow: {target: ball, for_s: 0.2}\n\
                time_limit_s: 0.8\n";
    changed("steered", text, changes)
}

/// Sticks with knobs so large that chance swings them, one of which is drawn with its group; a sphere and a plate beside them.
pub fn swung() -> Task {
    swung_with(&[])
}

/// The same with other numbers.
pub fn swung_with(changes: &[(&str, &str)]) -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: swung\nscene:\n  desk:\n    kind: group\n    at: [[0.2, 0.4], -0.1, [-0.6, -0.5]]\n    objects:\n      \
                lever: {kind: stick, length: 0.3, knob: 0.2, range_deg: [-60, 50], angle_deg: [-60, 20], tilt_deg: 20}\n      \
                ball: {kind: sphere, at: [0, 0.1, 0.2], radius: 0.3, moves: {kind: line, by: [0, 0.2, 0], period_s: 1}}\n  \
                switch: {kind: stick, at: [0.2, 0, -0.2], length: 0.25, knob: 0.24, swings: up, tilt_deg: 90}\n  \
                plate: {kind: button, at: [0.25, 0, -0.1], size: [1.2, 0.9, 0.02], min_force_n: 0.05}\nscript:\n  \
                - wait: [0, 0.1]\n  - swing: {stick: desk.lever, to_deg: 10, within_deg: 50}\n  - dwell: {in: desk.ball, for_s: 0.05}\n  \
                - random_order: [{press: plate}, {swing: {stick: switch, to_deg: -10, within_deg: 60}}]\ntime_limit_s: 0.8\n";
    changed("swung", text, changes)
}

/// Three spheres, each of which is given up soon, for actions that change what muscles do.
pub fn limited() -> Task {
    limited_with(&[])
}

/// The same with other numbers.
pub fn limited_with(changes: &[(&str, &str)]) -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: limited\nscene:\n  \
                near: {kind: sphere, at: [0.2, -0.1, [-0.6, -0.2]], radius: [0.2, 0.4]}\n  \
                wide: {kind: sphere, at: [0.2, -0.1, -0.4], radius: 0.5, min_distance_from_previous: 0}\nscript:\n  \
                - dwell: {in: near, for_s: 0.1}\n  - wait: [0, 0.1]\n  - dwell: {in: wide, for_s: 0.1}\n  \
                - dwell: {in: near, for_s: 0.1}\nstep_limit_s: 0.25\ncontrol: relative\ntime_limit_s: 0.8\n";
    changed("limited", text, changes)
}

/// Two vehicles that a wide knob drives into where they need not be still, one after the other.
pub fn driven() -> Task {
    driven_with(&[])
}

/// The same with other numbers.
pub fn driven_with(changes: &[(&str, &str)]) -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: driven\nscene:\n  \
                lever: {kind: stick, at: [0.2, 0, -0.3], length: 0.3, knob: 0.28, range_deg: [-30, 40], springs_back_s: 0.2, tilt_deg: 40}\n  \
                car: {kind: sphere, at: [2, 0, [-0.1, 0.1]], radius: 0.1, moves: {kind: driven, by: [0, -0.6, 0.2], acceleration: 30, drag_per_s: 2}}\n  \
                place: {kind: sphere, at: [2, [0.4, 0.5], -0.15], radius: 0.3, min_distance_from_previous: 0}\n  \
                van: {kind: sphere, at: [1, 0, 0], radius: 0.1, moves: {kind: driven, by: [0.5, 0, 0], acceleration: 9}}\n  \
                end: {kind: sphere, at: [[1.3, 1.4], 0, 0], radius: 0.2, min_distance_from_previous: 0}\nscript:\n  \
                - wait: [0, 0.1]\n  - drive: {stick: lever, vehicle: car, into: place, slower_than: 2}\n  \
                - drive: {stick: lever, vehicle: van, into: end, slower_than: 5}\n  - drive: {stick: lever, vehicle: car, into: place, slower_than: 1}\n\
                time_limit_s: 0.8\n";
    changed("driven", text, changes)
}

/// An arm whose fingers are wherever they should be now and then, by themselves, in turn and together.
pub fn fingers() -> Task {
    fingers_with(&[])
}

/// The same with other numbers.
pub fn fingers_with(changes: &[(&str, &str)]) -> Task {
    let text = "version: 2\nuser: fastest\nname: fingers\nscene:\n  \
                wide: {kind: sphere, at: [0.15, -0.05, [-0.65, -0.55]], radius: 0.5}\n  \
                near: {kind: sphere, at: [0.15, -0.05, -0.6], radius: [0.4, 0.5], min_distance_from_previous: 0, moves: {kind: line, by: [0, 0.03, 0], period_s: 0.5}}\nscript:\n  \
                - dwell: {in: wide, for_s: 0.1, with: thumb, also: {middle: near}}\n  - pinch: {in: wide, closer_than: 0.17, apart: 0.1705}\n  \
                - dwell: {in: near, for_s: 0.05, also: {thumb: wide}}\n  - pinch: {in: near, for_s: 0.01, closer_than: 0.17, apart: 0.17}\n\
                time_limit_s: 2\n";
    changed("fingers", text, changes)
}

/// An arm that hangs before a plate which its fingers press, one by one and together, and another plate to press wrongly.
pub fn chords() -> Task {
    chords_with(&[])
}

/// The same with other numbers.
pub fn chords_with(changes: &[(&str, &str)]) -> Task {
    let text = "version: 2\nuser: fastest\nname: chords\nscene:\n  \
                a: {kind: button, at: [[0.11, 0.12], 0.42, -0.6], tilt_deg: 90, size: [0.6, 0.6, 0.02], min_force_n: 0.01}\n  \
                b: {kind: button, at: [0.11, -0.2, -0.6], tilt_deg: 90, size: [0.6, 0.6, 0.02], min_force_n: 0.01}\n  \
                wide: {kind: sphere, at: [0.1, -0.05, -0.6], radius: 0.5}\nscript:\n  \
                - dwell: {in: wide, for_s: 0.05, also: {thumb: wide}}\n  - press_with: {thumb: b}\n  - wait: [0, 0.1]\n  \
                - press_with: {fingertip: b, middle: b}\n  - press: b\n\
                time_limit_s: 2.4\n";
    changed("chords", text, changes)
}

/// A sphere of a task's scene, to be changed.
pub fn sphere<'a>(task: &'a mut Task, name: &str) -> &'a mut SphereItem {
    match task.scene.0.get_mut(name) {
        Some(Item::Sphere(sphere)) => sphere,
        other => panic!("{name} is {other:?}"),
    }
}

/// Makes every dwell of a script so long.
pub fn dwell_for(task: &mut Task, seconds: f64) {
    for instruction in &mut task.script {
        if let Instruction::Dwell(dwell) = instruction {
            dwell.for_s = seconds;
        }
    }
}

/// Reproducible actions in [-1, 1], different in every environment.
pub fn actions(env: &dyn VectorEnv, step: usize) -> Vec<f32> {
    let spec = env.spec();
    let of = |k: usize| ((k * 2_654_435_761 + step * 40_503) % 1_000_003) as f32 / 500_001.5 - 1.0;
    (0..spec.num_envs * spec.action_size()).map(of).collect()
}

/// Everything that a roll-out returns, flattened.
pub fn rollout(env: &mut dyn VectorEnv, steps: usize) -> Vec<StepStorage> {
    let mut out = StepStorage::new(env.spec());
    (0..steps)
        .map(|step| {
            let actions = actions(env, step);
            env.step(&actions, out.buffers()).unwrap();
            out.clone()
        })
        .collect()
}

/// Index of a named entry of the observation.
pub fn entry(env: &dyn VectorEnv, name: &str) -> usize {
    env.spec().observation_names.iter().position(|n| n == name).unwrap_or_else(|| panic!("no entry {name}"))
}

/// Index of a named column of the episode summary.
pub fn column(env: &dyn VectorEnv, name: &str) -> usize {
    env.spec().episode_names.iter().position(|n| n == name).unwrap_or_else(|| panic!("no column {name}"))
}

/// A step equals that of the reference, as far as single precision goes after some hundred physics steps.
pub fn assert_follows(reference: &dyn VectorEnv, got: &StepStorage, want: &StepStorage, context: &str) {
    let spec = reference.spec();
    assert_eq!(got.terminated, want.terminated, "{context}");
    assert_eq!(got.truncated, want.truncated, "{context}");
    let nobs = spec.observation_size();
    for (k, (x, y)) in got.observation.iter().zip(&want.observation).enumerate() {
        let name = &spec.observation_names[k % nobs];
        // Targets are drawn, not integrated, but for knobs, which go where the fingertip pushes them.
        let is_pushed = context.starts_with("swung");
        let tolerance = if name.starts_with("target_position") && !is_pushed { 1e-6 } else { 2e-2 };
        assert!((x - y).abs() <= tolerance * (1.0 + y.abs()), "{context} {name}: {x} for {y}");
    }
    for (env, (x, y)) in got.reward.iter().zip(&want.reward).enumerate() {
        assert!((x - y).abs() <= 1e-3 * (1.0 + y.abs()), "{context} reward of environment {env}: {x} for {y}");
    }
    for (env, _) in want.truncated.iter().zip(&want.terminated).enumerate().filter(|(_, (a, b))| **a || **b) {
        assert_same_summary(reference, got, want, env, context);
    }
}

/// The episode that ended has the same summary: counts and times exactly, sums as far as single precision goes.
pub fn assert_same_summary(
    reference: &dyn VectorEnv,
    got: &StepStorage,
    want: &StepStorage,
    env: usize,
    context: &str,
) {
    let names = &reference.spec().episode_names;
    let row = |out: &StepStorage| out.episode[env * names.len()..(env + 1) * names.len()].to_vec();
    for ((name, x), y) in names.iter().zip(row(got)).zip(row(want)) {
        let counted =
            ["length", "success", "targets_done", "solver_unsolved"].contains(&&**name) || name.starts_with("target_");
        let tolerance = if counted { 1e-6 } else { 2e-3 };
        let same = x.is_nan() && y.is_nan() || (x - y).abs() <= tolerance * (1.0 + y.abs());
        assert!(same, "{context} {name} of environment {env}: {x} for {y}");
    }
}
