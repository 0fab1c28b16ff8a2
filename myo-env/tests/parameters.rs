//! Numbers of a task are data: they change without anything being compiled, and what runs afterwards is the other task.

use crate::common::{
    arm, changed, chords, chords_with, drifting, drifting_with, driven, driven_with, dwell_for, entry, fingers,
    fingers_with, following, following_with, gpu, limited, limited_with, rollout, short, shuffled, sphere, steered,
    steered_with, swung, swung_with, without_gpu,
};
use myo_env::gpu::{GpuOptions, record};
use myo_env::{Autoreset, CpuEnv, EnvConfig, EnvError, EnvSpec, GpuEnv, ReferenceEnv, Tables, VectorEnv};
use myo_model::Model;
use myo_scalar::symbolic::Form;
use myo_tasks::{Body, Control, Instruction, Item, Range, Repeat, Stimulus, Task};

/// A short task with motor noise.
fn noisy(name: &str) -> Task {
    let mut task = short(name);
    task.noise.constant = 0.05;
    task
}

/// A task with everything that may differ within a structure.
fn other(task: &Task) -> Task {
    let mut other = task.clone();
    for item in other.scene.0.values_mut() {
        match item {
            Item::Sphere(sphere) => {
                let y = &mut sphere.at.0.y;
                *y = Range::new(y.min + 0.03, y.max + 0.05);
                sphere.radius = Range::new(0.5 * sphere.radius.min, 0.7 * sphere.radius.max);
            }
            Item::Button(button) => {
                button.at.0 = button.at.0.moved([0.0, 0.0, 0.03]);
                button.tilt_deg += 10.0;
                button.size[0] = Range::fixed(0.7 * button.size[0].centre());
                button.min_force_n *= 1.5;
            }
            Item::Obstacle(wall) => wall.at.0 = wall.at.0.moved([0.0, 0.03, 0.0]),
            other => panic!("{other:?} stays as it is"),
        }
    }
    dwell_for(&mut other, 0.1);
    other.time_limit_s = 0.4;
    other.noise.constant = 0.1;
    other.reset.activation_max = 0.3;
    other.reward.distance_cost *= 2.0;
    other.reward.subtask_bonus += 1.0;
    other.reward.time_cost = 0.4;
    other
}

fn config(num_envs: usize) -> EnvConfig {
    EnvConfig { num_envs, seed: 5, exploring: num_envs / 2, autoreset: Autoreset::SameStep, ..EnvConfig::default() }
}

/// Environments that did another task before do this one as those that were made for it, bit for bit.
fn check_that_nothing_is_left(exchanged: &mut dyn VectorEnv, made: &mut dyn VectorEnv, task: &Task) {
    rollout(exchanged, 3);
    exchanged.set_task(task).unwrap();
    assert_eq!(exchanged.spec(), made.spec());
    let mut first = [(); 2].map(|()| vec![0.0; made.spec().num_envs * made.spec().observation_size()]);
    exchanged.reset(Some(8), None, &mut first[0]).unwrap();
    made.reset(Some(8), None, &mut first[1]).unwrap();
    assert!(first[0] == first[1], "first observations");
    for (step, (a, b)) in rollout(exchanged, 14).iter().zip(&rollout(made, 14)).enumerate() {
        assert!(a.observation == b.observation && a.reward == b.reward, "step {step}");
        assert!(a.terminated == b.terminated && a.truncated == b.truncated, "step {step}");
    }
    assert!(exchanged.save_state().unwrap() == made.save_state().unwrap(), "states");
}

#[test]
fn a_task_in_the_place_of_another_is_as_if_it_had_been_there_from_the_start() {
    for name in ["pointing-uitb", "ar", "public-display"] {
        let (before, task) = (noisy(name), other(&noisy(name)));
        let model = arm(&task);
        let reference = |task| ReferenceEnv::new(&model, task, &config(6)).unwrap();
        check_that_nothing_is_left(&mut reference(&before), &mut reference(&task), &task);
        let lanes = |task| CpuEnv::new(&model, task, &config(21)).unwrap();
        check_that_nothing_is_left(&mut lanes(&before), &mut lanes(&task), &task);
    }
}

#[test]
fn on_a_card_a_task_takes_the_place_of_another() {
    if without_gpu() {
        return;
    }
    let (gpu, before, task) = (gpu(), noisy("ar"), other(&noisy("ar")));
    let model = arm(&task);
    let env = |task| GpuEnv::new(&gpu, &model, task, &config(21)).unwrap();
    check_that_nothing_is_left(&mut env(&before), &mut env(&task), &task);
}

#[test]
fn kernels_know_the_structure_of_a_task_and_none_of_its_numbers() {
    for name in ["pointing-uitb", "ar", "public-display", "mobile-typing"] {
        let (before, task) = (noisy(name), other(&noisy(name)));
        let texts = [&before, &task].map(|task| {
            let tables = Tables::<f64>::new(&arm(task), task).unwrap();
            let step = record::step(&tables, Autoreset::SameStep, Form::Straight);
            let reset = record::reset_program(&tables, Form::Straight);
            [step.to_kernel(&record::STEP_BUFFERS, 64), reset.to_kernel(&record::RESET_BUFFERS, 64)]
                .map(|kernel| kernel.to_wgsl().unwrap())
        });
        assert!(texts[0] == texts[1], "{name}");
    }
}

/// A preset with other numbers.
fn preset_with(name: &str, changes: &[(&str, &str)]) -> Task {
    let who = ("version: 2\n", "version: 2\nuser: fastest\nmodel: mobl-arms\n");
    let changes = [&[who], changes].concat();
    Task { time_limit_s: 0.5, ..changed(name, myo_tasks::preset_text(name).unwrap(), &changes) }
}

#[test]
fn ways_handles_waits_and_pointers_are_numbers_too() {
    let moved = [
        ("gain: 4", "gain: 3"),
        ("period_s: 3", "period_s: 2"),
        ("0.2, 0.2]", "0.1, 0.2]"),
        ("after_s: [0, 0.1]", "after_s: 0.2"),
    ];
    let slid = [
        ("length: 0.1 ", "length: 0.12 "),
        ("value: [0, 40]", "value: 10"),
        ("to: 70, within: 5", "to: 50, within: 8"),
    ];
    let waited = [("after_s: [0.5, 1.5]", "after_s: [0.1, 0.2]"), ("pitch: 0.06", "pitch: 0.07")];
    let pointed =
        [("at: [2, 0, 0]", "at: [1.5, 0, 0]"), ("at: [1.99, 0, 0]", "at: [1.49, 0, 0]"), ("for_s: 0.25", "for_s: 0.1")];
    let drifted = [
        ("[-0.2, 0.2], [-0.3, 0.1]]", "0.1, [-0.3, 0.2]]"),
        ("[0.4, 0.6]", "[0.5, 0.9]"),
        ("[0.02, 0.1]]", "[0.05, 0.06]]"),
    ];
    let aimed = [("gain: 3", "gain: 2, still: 0.03"), ("at: [0.3, 0, -0.2]", "at: [0.35, 0.1, -0.2]")];
    let bent = [
        ("angle_deg: [-60, 20]", "angle_deg: 30"),
        ("length: 0.25, knob: 0.24, swings: up", "length: 0.2, knob: 0.15, range_deg: [-90, 30]"),
        ("to_deg: -10, within_deg: 60", "to_deg: 20, within_deg: 5"),
    ];
    let pointed_otherwise = [
        ("with: thumb, also: {middle: near}", "with: middle, also: {thumb: near}"),
        ("closer_than: 0.17, apart: 0.1705", "with: middle, closer_than: 0.15, apart: 0.18"),
        ("radius: [0.4, 0.5]", "radius: 0.45"),
    ];
    let chorded = [
        ("press_with: {fingertip: b, middle: b}", "press_with: {fingertip: a, thumb: b}"),
        ("press_with: {thumb: b}", "press_with: {middle: b}"),
        ("min_force_n: 0.01", "min_force_n: 0.02"),
    ];
    let tuned = [
        ("springs_back_s: 0.2", "springs_back_s: 0.05"),
        ("acceleration: 30, drag_per_s: 2", "acceleration: 12, drag_per_s: 0"),
        ("vehicle: van, into: end, slower_than: 5", "vehicle: van, into: end, slower_than: 2"),
    ];
    let mut wider = shuffled();
    sphere(&mut wider, "wide").radius = Range::fixed(0.4);
    for (before, task) in [
        (following(), following_with(&moved)),
        (short("slider"), preset_with("slider", &slid)),
        (short("choice"), preset_with("choice", &waited)),
        (short("wall-ray"), preset_with("wall-ray", &pointed)),
        (shuffled(), wider),
        (drifting(), drifting_with(&drifted)),
        (steered(), steered_with(&aimed)),
        (swung(), swung_with(&bent)),
        (driven(), driven_with(&tuned)),
        (fingers(), fingers_with(&pointed_otherwise)),
        (chords(), chords_with(&chorded)),
        (limited(), limited_with(&[("step_limit_s: 0.25", "step_limit_s: 0.15")])),
    ] {
        let model = arm(&task);
        let lanes = |task| CpuEnv::new(&model, task, &config(21)).unwrap();
        check_that_nothing_is_left(&mut lanes(&before), &mut lanes(&task), &task);
        let texts = [&before, &task].map(|task| {
            let tables = Tables::<f64>::new(&model, task).unwrap();
            record::step(&tables, Autoreset::SameStep, Form::Straight)
                .to_kernel(&record::STEP_BUFFERS, 64)
                .to_wgsl()
                .unwrap()
        });
        assert!(texts[0] == texts[1], "{}", task.name);
    }
    let (slider, moving) = (short("slider"), following());
    let refused = |old: &Task, new: &Task| {
        CpuEnv::new(&arm(old), old, &config(3)).unwrap().set_task(new).unwrap_err().to_string()
    };
    assert!(refused(&slider, &moving).ends_with("it has 2 steps instead of 1"), "{}", refused(&slider, &moving));
    let still = following_with(&[(
        "technique: {kind: cursor, onto: wall, at: [0.3, 0, -0.2], gain: 4}",
        "technique: {kind: ray, from: hand, onto: wall}",
    )]);
    assert!(refused(&moving, &still).ends_with("its technique is another"));
    let (plain, mut shown, mut kept) = (shuffled(), shuffled(), shuffled());
    shown.stimulus = Stimulus::All;
    assert!(refused(&plain, &shown).ends_with("it shows what comes next, and the other did not"));
    kept.correction = None;
    assert!(refused(&plain, &kept).ends_with("it has no wrong press corrected, and the other did"));
    let still = drifting_with(&[("at: [0.3, 0, [0.4, 0.6]]", "at: [0.3, 0, 0.5]")]);
    assert!(refused(&drifting(), &still).ends_with("it has 2 places and sizes that are drawn instead of 3"));
    let watched = steered_with(&[("stimulus: before_movement", "stimulus: current")]);
    assert!(
        refused(&steered(), &watched)
            .ends_with("it does not hide its objects once a movement has begun, and the other did")
    );
    let left = swung_with(&[
        (
            "- random_order: [{press: plate}, {swing: {stick: switch, to_deg: -10, within_deg: 60}}]",
            "- press: [plate, plate]",
        ),
        ("- swing: {stick: desk.lever, to_deg: 10, within_deg: 50}", "- dwell: {in: desk.ball, for_s: 0.1}"),
    ]);
    assert!(refused(&left, &swung()).ends_with("it asks to swing a stick, and the other did not"));
    let dwelt = [(
        "- drive: {stick: lever, vehicle: van, into: end, slower_than: 5}",
        "- swing: {stick: lever, to_deg: 0, within_deg: 9}",
    )];
    let both = [
        dwelt[0],
        ("- drive: {stick: lever, vehicle: car, into: place, slower_than: 2}", "- dwell: {in: end, for_s: 0.1}"),
        ("- drive: {stick: lever, vehicle: car, into: place, slower_than: 1}", "- dwell: {in: end, for_s: 0.1}"),
    ];
    assert!(refused(&driven_with(&both), &driven()).ends_with("it asks to drive something, and the other did not"));
    let pointed = fingers_with(&[("for_s: 0.1, with: thumb, also", "for_s: 0.1, also")]);
    assert!(refused(&pointed, &fingers()).ends_with("it asks other fingers to lead, and the other did not"));
    let fewer = fingers_with(&[("also: {middle: near}", "also: {}")]);
    assert!(refused(&fewer, &fingers()).ends_with("it asks for other fingers"));
    let patient = Task { step_limit_s: None, ..limited() };
    let whole = "its steps may take only so long where they could take any time, or the other way round (step_limit_s)";
    assert!(refused(&patient, &limited()).ends_with(whole) && refused(&limited(), &patient).ends_with(whole));
    let absolute = Task { control: Control::Absolute, ..limited() };
    assert!(refused(&absolute, &limited()).ends_with("asked for changes, or the other way round (control)"));
    let mut fixed = shuffled();
    let Instruction::RandomOrder(steps) = fixed.script.remove(0) else { panic!("an order") };
    fixed.script.splice(0..0, steps);
    assert!(refused(&plain, &fixed).ends_with("other steps of it change places with each other"));
}

#[test]
fn a_body_is_that_of_the_tasks_user_or_refused() {
    let task = short("pointing-uitb");
    let strong = Task { body: Body { strength: 1.5, ..task.body.clone() }, ..task.clone() };
    let (plain, other) = (arm(&task), strong.embody(&myo_model::builtin(&strong.model).unwrap()).unwrap());
    let mismatch = |model: &Model, task: &Task| CpuEnv::new(model, task, &config(4)).err().unwrap().to_string();
    assert_eq!(
        mismatch(&plain, &strong),
        "the task's user changes the model by: 1.5 times as strong; the body that is given was changed by: nothing. Make it with \
         `task.embody(&description)`"
    );
    assert!(
        mismatch(&other, &task)
            .contains("changes the model by: nothing; the body that is given was changed by: 1.5 times as strong.")
    );
    let mut env = CpuEnv::new(&other, &strong, &config(4)).unwrap();
    let error = env.set_task(&task).unwrap_err().to_string();
    assert!(error.contains("its user has another body (`body`)"), "{error}");
    assert!(CpuEnv::with_layouts(&other, &[strong, task], &config(4)).is_err());
}

#[test]
fn the_layout_with_the_least_time_says_how_soon_an_environment_is_cut_again() {
    let layouts = [0.5, 0.25, 0.4].map(|time_limit_s| Task { time_limit_s, ..short("pointing-uitb") });
    let mut env = CpuEnv::with_layouts(&arm(&layouts[0]), &layouts, &EnvConfig { exploring: 0, ..config(6) }).unwrap();
    assert_eq!(env.spec().steps_between_cuts(), 5);
    let cut =
        rollout(&mut env, 10).iter().map(|out| out.truncated.iter().filter(|cut| **cut).count()).collect::<Vec<_>>();
    assert_eq!(cut, [0, 0, 0, 0, 2, 0, 0, 2, 0, 4], "two environments of each");
}

/// Three layouts of a task whose objects are drawn, moved, pointed at and waited for.
fn layouts() -> [Task; 3] {
    let wider = following_with(&[("gain: 4", "gain: 3"), ("by: [0, 0.2, 0.2]", "by: [0, 0.1, 0.3]")]);
    let later = following_with(&[
        ("wait: [0.05, 0.2]", "wait: 0.1"),
        ("[-0.1, 0.1]", "0.2"),
        ("diameter: 0.2", "diameter: 0.3"),
    ]);
    [following(), wider, Task { time_limit_s: 0.4, ..later }]
}

/// Each environment of a batch of several layouts does what it does among environments of its own layout alone.
fn check_layouts(batch: &mut dyn VectorEnv, mut alone: impl FnMut(&Task) -> Box<dyn VectorEnv>) {
    let tasks = layouts();
    let (n, nobs) = (batch.spec().num_envs, batch.spec().observation_size());
    let together = rollout(batch, 14);
    for (k, task) in tasks.iter().enumerate() {
        for (step, (a, b)) in together.iter().zip(&rollout(&mut *alone(task), 14)).enumerate() {
            for env in (k..n).step_by(tasks.len()) {
                let row = env * nobs..(env + 1) * nobs;
                assert!(
                    a.observation[row.clone()] == b.observation[row],
                    "{}, environment {env}, step {step}",
                    task.name
                );
                assert_eq!((a.reward[env], a.truncated[env]), (b.reward[env], b.truncated[env]), "environment {env}");
            }
        }
    }
}

#[test]
fn a_batch_holds_many_layouts_and_each_is_as_if_it_were_alone() {
    let model = arm(&following());
    let mut batch = ReferenceEnv::with_layouts(&model, &layouts(), &config(7)).unwrap();
    check_layouts(&mut batch, |task| Box::new(ReferenceEnv::new(&model, task, &config(7)).unwrap()));
    let mut batch = CpuEnv::with_layouts(&model, &layouts(), &config(37)).unwrap();
    let spec = EnvSpec { exploring: 0, ..batch.spec().clone() };
    assert_eq!((spec.max_episode_steps, &spec.layout_limits[..], spec.steps_between_cuts()), (10, &[10, 10, 8][..], 8));
    check_layouts(&mut batch, |task| Box::new(CpuEnv::new(&model, task, &config(37)).unwrap()));
    // States of them are not those of one layout, and one layout may take the place of all.
    let state = batch.save_state().unwrap();
    let mut one = CpuEnv::new(&model, &layouts()[0], &config(37)).unwrap();
    assert!(one.load_state(&state).unwrap_err().to_string().contains("another version of the task `following`"));
    assert!(one.set_tasks(&layouts()).unwrap_err().to_string().ends_with("made for one at a time"));
    assert!(CpuEnv::with_layouts(&model, &[], &config(3)).err().unwrap().to_string().contains("no layout"));
    let few = CpuEnv::with_layouts(&model, &layouts(), &config(2)).err().unwrap().to_string();
    assert_eq!(few, "3 layouts need an environment each; there are 2");
    let mut many = layouts()[0].clone();
    many.script[0] = Instruction::Repeat(Repeat { times: u32::MAX, steps: vec![many.script[0].clone()] });
    assert!(one.set_task(&many).unwrap_err().to_string().contains("4294967295"));
    batch.set_task(&layouts()[1]).unwrap();
    assert_eq!(batch.spec().layout_limits, [10]);
    let mut made = CpuEnv::new(&model, &layouts()[1], &config(37)).unwrap();
    for env in [&mut batch as &mut dyn VectorEnv, &mut made] {
        env.reset(Some(2), None, &mut vec![0.0; 37 * one.spec().observation_size()]).unwrap();
    }
    assert!(rollout(&mut batch, 5).iter().zip(&rollout(&mut made, 5)).all(|(a, b)| a.observation == b.observation));
}

#[test]
fn a_card_holds_many_layouts_as_well() {
    if without_gpu() {
        return;
    }
    let (gpu, model) = (gpu(), arm(&following()));
    let options = GpuOptions { envs_per_shard: 16, ..GpuOptions::default() };
    let mut batch = GpuEnv::with_layouts(&gpu, &model, &layouts(), &config(37), &options).unwrap();
    check_layouts(&mut batch, |task| Box::new(GpuEnv::new(&gpu, &model, task, &config(37)).unwrap()));
    let turned = {
        let [a, b, c] = layouts();
        [c, a, b]
    };
    batch.set_tasks(&turned).unwrap();
    let mut made = GpuEnv::with_layouts(&gpu, &model, &turned, &config(37), &options).unwrap();
    for env in [&mut batch, &mut made] {
        env.reset(Some(2), None, &mut vec![0.0; 37 * made_size(&turned)]).unwrap();
    }
    assert!(rollout(&mut batch, 5).iter().zip(&rollout(&mut made, 5)).all(|(a, b)| a.observation == b.observation));
}

/// Two users who differ in all that can be observed of them.
fn two_natures() -> [Task; 2] {
    let one = |signal_dependent, vision_noise, effort_cost, control_change_cost| {
        let mut task = short("pointing");
        task.observation.traits = true;
        task.noise.signal_dependent = signal_dependent;
        task.perception.vision_noise = vision_noise;
        (task.reward.effort_cost, task.reward.control_change_cost) = (effort_cost, control_change_cost);
        task
    };
    [one(0.1, 0.3, 8.0, 5.0), one(0.02, 0.1, 2.0, 20.0)]
}

/// Everybody observes what it is like, and nobody else.
fn check_natures(env: &mut dyn VectorEnv) {
    let expected = [[1.0, 1.5, 2.0, 0.5], [0.2, 0.5, 0.5, 2.0]];
    let size = env.spec().observation_size();
    let names = ["signal_dependent", "vision_noise", "effort_cost", "control_change_cost"];
    let places = names.map(|name| {
        let name = format!("traits.{name}");
        env.spec().observation_names.iter().position(|other| *other == name).unwrap()
    });
    let mut seen = vec![0.0; 37 * size];
    env.reset(Some(2), None, &mut seen).unwrap();
    for step in rollout(env, 3).iter().map(|step| &step.observation).chain([&seen]) {
        for (number, row) in step.chunks_exact(size).enumerate() {
            let found = places.map(|place| row[place]);
            let off =
                found.iter().zip(expected[number % 2]).map(|(a, b): (&f32, f32)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 1e-5, "environment {number}: {found:?}");
        }
    }
}

#[test]
fn users_of_layouts_observe_what_they_are_like() {
    let tasks = two_natures();
    let model = arm(&tasks[0]);
    check_natures(&mut CpuEnv::with_layouts(&model, &tasks, &config(37)).unwrap());
    if without_gpu() {
        return;
    }
    let options = GpuOptions { envs_per_shard: 16, ..GpuOptions::default() };
    check_natures(&mut GpuEnv::with_layouts(&gpu(), &model, &tasks, &config(37), &options).unwrap());
}

/// Entries of the observation of a task.
fn made_size(tasks: &[Task]) -> usize {
    CpuEnv::new(&arm(&tasks[0]), &tasks[0], &config(1)).unwrap().spec().observation_size()
}

#[test]
fn where_buttons_are_counts_at_once() {
    let (before, task) = (noisy("public-display"), other(&noisy("public-display")));
    let model = arm(&task);
    let mut env = CpuEnv::new(&model, &before, &config(5)).unwrap();
    rollout(&mut env, 2);
    let height = entry(&env, "target_position.z");
    let width = env.spec().observation_size();
    let mut seen = vec![0.0; 5 * width];
    env.set_task(&task).unwrap();
    env.reset(None, Some(&[false; 5]), &mut seen).unwrap();
    let objects = task.flat().unwrap().objects;
    let centres: Vec<f32> = objects.iter().map(|object| object.block().unwrap().centre[2] as f32).collect();
    for row in seen.chunks(width) {
        assert!(centres.contains(&row[height]), "{} of {centres:?}", row[height]);
    }
}

#[test]
fn a_task_of_another_structure_is_refused_and_changes_nothing() {
    let task = noisy("ar");
    let model = arm(&task);
    let mut env = CpuEnv::new(&model, &task, &config(3)).unwrap();
    let before = env.save_state().unwrap();
    let mut refuse = |task: &Task, expected: &str| {
        let error = env.set_task(task).unwrap_err();
        assert!(matches!(error, EnvError::OtherTask { .. }), "{error}");
        let sentence = error.to_string();
        assert!(sentence.ends_with(expected), "{sentence}");
        assert!(env.save_state().unwrap() == before);
    };
    let with = |change: fn(&mut Task)| {
        let mut other = task.clone();
        change(&mut other);
        other
    };
    refuse(&noisy("pointing-uitb"), "it has 10 steps instead of 8");
    refuse(&with(|task| task.scene.0.swap_indices(0, 1)), "its spheres and boxes stand in another order");
    refuse(&with(|task| task.observation.touch = false), "it is observed in another way");
    refuse(&with(|task| task.control_dt_s = 0.1), "its control step is 0.1 s instead of 0.05 s");
    let inside = "it measures the distance in another way (reward.inside_is_zero, reward.remaining_path, reward.distance_scale_m)";
    refuse(&with(|task| task.reward.inside_is_zero = !task.reward.inside_is_zero), inside);
    let error = env.set_task(&with(|task| task.time_limit_s = -1.0)).unwrap_err().to_string();
    assert!(error.contains("time_limit_s"), "{error}");
}

#[test]
fn noise_of_no_size_takes_the_place_of_noise_but_not_the_other_way_round() {
    let loud = noisy("pointing-single");
    let mut quiet = loud.clone();
    (quiet.noise.signal_dependent, quiet.noise.constant) = (0.0, 0.0);
    let model = arm(&loud);
    let mut env = CpuEnv::new(&model, &loud, &config(4)).unwrap();
    env.set_task(&quiet).unwrap();
    let mut made = CpuEnv::new(&model, &quiet, &config(4)).unwrap();
    let error = made.set_task(&loud).unwrap_err().to_string();
    assert!(error.ends_with("it has motor noise where there was none"), "{error}");
    let mut first = vec![0.0; 4 * env.spec().observation_size()];
    env.reset(Some(1), None, &mut first).unwrap();
    made.reset(Some(1), None, &mut first).unwrap();
    for (a, b) in rollout(&mut env, 5).iter().zip(&rollout(&mut made, 5)) {
        assert!(a.observation == b.observation && a.reward == b.reward);
    }
}
