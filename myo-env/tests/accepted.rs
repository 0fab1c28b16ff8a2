//! Check what is checked: every task that `check` accepts runs a thousand random control steps with finite numbers, and can be told to a
//! graphics card.
//!
//! Tasks are generated within the bounds, at the bounds, and by changing single values of the presets. `MYO_TEST_ALL=1` runs
//! ten times as many.

use crate::common::arm;
use myo_env::gpu::record;
use myo_env::{Autoreset, CpuEnv, EnvConfig, ReferenceEnv, StepStorage, VectorEnv};
use myo_scalar::symbolic::Form;
use myo_tasks::{Reach, Source, Task, preset, preset_names};
use rayon::prelude::*;
use serde_json::{Value, json};

const STEPS: usize = 1000;

/// Numbers drawn one after the other (SplitMix64).
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }
    fn below(&mut self, n: usize) -> usize {
        (self.word() % n as u64) as usize
    }
    fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn coin(&mut self) -> bool {
        self.below(2) == 0
    }
    /// A bound, or something in between.
    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        match self.below(4) {
            0 => lo,
            1 => hi,
            _ => lo + (hi - lo) * self.unit(),
        }
    }
    fn interval(&mut self, lo: f64, hi: f64) -> Value {
        let (a, b) = (self.between(lo, hi), self.between(lo, hi));
        json!([a.min(b), a.max(b)])
    }
}

/// The model's physics step, which the check asks for; its reach is no matter of finite numbers.
struct Body(f64);

impl Reach for Body {
    fn nearest_in_reach(&self, point: [f64; 3]) -> [f64; 3] {
        point
    }
    fn physics_dt_s(&self) -> Option<f64> {
        Some(self.0)
    }
}

fn target(random: &mut Random) -> Value {
    if random.coin() {
        let mut axis = || random.interval(-2.0, 2.0);
        let position = json!({"x": axis(), "y": axis(), "z": axis()});
        let dwell = if random.coin() { 0.0 } else { random.between(0.0, 0.5) };
        let (radius, distance) = (random.interval(0.001, 2.0), random.between(0.0, 0.2));
        json!({"kind": "pointing", "position": position, "radius": radius, "dwell_s": dwell,
               "min_distance_from_previous": distance})
    } else {
        // Where the fingertip gets to, so that there is contact.
        let position = [0.3 + 0.2 * random.unit(), -0.4 + 0.8 * random.unit(), -0.6 + 0.8 * random.unit()];
        let size = [(); 3].map(|()| random.between(0.001, 0.3));
        let (tilt, force) = (random.between(0.0, 180.0), random.between(0.01, 1000.0));
        json!({"kind": "pressing", "position": position, "size": size, "tilt_deg": tilt, "min_force_n": force})
    }
}

/// A task within the bounds.
fn generated(random: &mut Random) -> Value {
    let targets: Vec<Value> = (0..=random.below(4)).map(|_| target(random)).collect();
    let steps = [0.002, 0.004, 0.01, 0.05, 0.05, 0.1];
    let mut observation: serde_json::Map<String, Value> = myo_tasks::Observation::default()
        .parts()
        .iter()
        .map(|(name, _)| ((*name).into(), random.coin().into()))
        .collect();
    observation.insert("phase".into(), true.into());
    let model = ["mobl-arms", "mobl-arms-uitb", "myo-arm"][random.below(3)];
    let control_dt_s = steps[random.below(steps.len())];
    let pose = ["range_uniform", "near_zero", "zero"][random.below(3)];
    let mut weight = || if random.coin() { random.unit() } else { random.between(0.0, 1e6) };
    let reward = json!({"distance_cost": weight(), "time_cost": weight(), "subtask_bonus": weight(), "completion_bonus": weight(),
        "effort_cost": weight(), "acceleration_cost": weight(),
        "control_change_cost": weight(), "contact_cost": weight(), "wrong_press": weight()});
    json!({
        "version": 1,
        "name": "generated",
        "model": model,
        "targets": targets,
        "time_limit_s": random.between(0.001, 600.0),
        "control_dt_s": control_dt_s,
        "reset": {"pose": pose, "pose_spread_rad": random.between(0.0, 1.0),
            "velocity_spread_rad_s": random.between(0.0, 10.0), "activation_max": random.between(0.0, 1.0)},
        "reward": reward,
        "observation": observation,
        "noise": {"signal_dependent": random.between(0.0, 1.0), "constant": random.between(0.0, 1.0)},
        "perception": {"error_pause_s": random.between(0.0, 1.0)},
        "reflex": {"gain": random.between(0.0, 50.0), "most": random.between(0.0, 1.0)},
        "fatigue": {"speed": random.between(0.0, 1000.0), "lasts": random.coin(), "initial_max": random.unit()},
    })
}

/// A preset of which some values were changed.
fn mutated(random: &mut Random) -> Value {
    let names = preset_names();
    let mut task = serde_json::to_value(preset(names[random.below(names.len())]).unwrap()).unwrap();
    for _ in 0..=random.below(3) {
        let count = leaves(&mut task).len();
        let at = random.below(count);
        let leaf = leaves(&mut task).swap_remove(at);
        *leaf = changed(leaf, random);
    }
    task
}

/// All values that are no lists or groups.
fn leaves(value: &mut Value) -> Vec<&mut Value> {
    match value {
        Value::Object(entries) => entries.values_mut().flat_map(leaves).collect(),
        Value::Array(items) => items.iter_mut().flat_map(leaves).collect(),
        leaf => vec![leaf],
    }
}

fn changed(value: &Value, random: &mut Random) -> Value {
    const NUMBERS: [f64; 20] = [
        0.0, -0.0, 1e-300, 1e-40, 1e-6, 0.001, 0.002, 0.01, 0.033, 0.1, 0.5, 1.0, 2.0, 10.0, 180.0, 600.0, 1000.0, 1e6,
        1e38, 1e308,
    ];
    match value {
        Value::Bool(x) => (!x).into(),
        Value::Number(x) => match (random.below(4), x.as_f64().unwrap_or(0.0)) {
            (0, x) => (10.0 * x).into(),
            (1, x) => (0.1 * x).into(),
            (2, x) => (-x).into(),
            _ => NUMBERS[random.below(NUMBERS.len())].into(),
        },
        _ => ["", "mobl-arms", "pressing", "near_zero", "\u{1b}[2J"][random.below(5)].into(),
    }
}

/// Runs a task; says where a number is not finite.
fn run(task: &Task, seed: u64) -> Result<(), String> {
    let model = arm(task);
    let config = EnvConfig { num_envs: 16, seed, threads: Some(1), ..EnvConfig::default() };
    let mut env = CpuEnv::new(&model, task, &config).map_err(|error| format!("not built: {error}"))?;
    let (mut random, mut out) = (Random(seed), StepStorage::new(env.spec()));
    let mut actions = vec![0.0; 16 * env.spec().action_size()];
    for step in 0..STEPS {
        actions.iter_mut().for_each(|a| *a = (2.0 * random.unit() - 1.0) as f32);
        env.step(&actions, out.buffers()).map_err(|error| format!("step {step}: {error}"))?;
        let names = env.spec().observation_names.iter().cycle();
        let wrong = names.zip(&out.observation).find(|(_, x)| !x.is_finite());
        if let Some((name, x)) = wrong.or(names_of_rewards(&out)) {
            return Err(format!("step {step}: {name} is {x}"));
        }
        let summaries = env.spec().episode_names.iter().cycle().zip(&out.episode);
        // The time of a target that was not done is not a number, and neither is how well nothing was tracked.
        let may_be_none = |name: &str| name.ends_with("_time") || ["on_target", "tracking_error"].contains(&name);
        if let Some((name, x)) = summaries.into_iter().find(|(name, x)| !x.is_finite() && !may_be_none(name)) {
            return Err(format!("step {step}: {name} of the summary is {x}"));
        }
    }
    Ok(())
}

fn names_of_rewards(out: &StepStorage) -> Option<(&'static String, &f32)> {
    static NAME: std::sync::LazyLock<String> = std::sync::LazyLock::new(|| "the reward".into());
    out.reward.iter().find(|x| !x.is_finite()).map(|x| (&*NAME, x))
}

/// Records what a graphics card would run: that does not depend on there being one.
fn tell_card(task: &Task) -> Result<(), String> {
    let env =
        ReferenceEnv::new(&arm(task), task, &EnvConfig::default()).map_err(|error| format!("not built: {error}"))?;
    let recorded = || {
        (
            record::step(env.tables(), Autoreset::SameStep, Form::Straight),
            record::reset_program(env.tables(), Form::Straight),
        )
    };
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(recorded)).map(drop).map_err(|_| "not recorded".into())
}

/// Whether a task is accepted, and whether it then runs.
fn outcome(text: &str, seed: u64) -> Option<Result<(), String>> {
    let source = Source::parse(text, "generated").ok()?;
    let model = myo_model::builtin(&source.task.model).ok()?;
    let report = source.check(&Body(model.options.timestep));
    let runs = || tell_card(&source.task).and_then(|()| run(&source.task, seed));
    report.is_ok().then(|| runs().map_err(|fault| format!("{fault}\n{text}")))
}

#[test]
fn every_preset_can_be_told_to_a_graphics_card() {
    for name in preset_names() {
        tell_card(&preset(name).unwrap()).unwrap_or_else(|fault| panic!("{name}: {fault}"));
    }
}

#[test]
fn what_the_check_accepts_runs_with_finite_numbers() {
    let cases = if std::env::var("MYO_TEST_ALL").as_deref() == Ok("1") { 480 } else { 48 };
    let results: Vec<_> = (0..cases)
        .into_par_iter()
        .map(|case: u64| {
            let mut random = Random(case);
            let task = if case.is_multiple_of(2) { generated(&mut random) } else { mutated(&mut random) };
            outcome(&task.to_string(), case)
        })
        .collect();
    let faults: Vec<&String> = results.iter().flatten().filter_map(|result| result.as_ref().err()).collect();
    let accepted = results.iter().flatten().count();
    println!("{accepted} of {cases} tasks were accepted");
    assert!(faults.is_empty(), "{} of {accepted} accepted tasks failed:\n{}", faults.len(), faults[0]);
    assert!(accepted > cases as usize / 3, "only {accepted} of {cases} were accepted: too few to tell");
    assert!(accepted < cases as usize, "nothing was refused");
}
