//! Targets that seem to be elsewhere: how far off, and that nothing else changes.

use crate::common::{arm, gpu, short, without_gpu};
use myo_env::gpu::GpuOptions;
use myo_env::{Autoreset, CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, StepStorage, VectorEnv};
use myo_tasks::Task;

const ENVS: usize = 200;
const SHARE: f64 = 0.2;
/// How long targets seem off alike (s).
const HELD_S: f64 = 0.25;
/// As if targets were so much farther away (m).
const NEAR: f64 = 0.01;

fn task(vision_noise: f64) -> Task {
    let mut task = short("pointing-uitb");
    task.perception.vision_noise = vision_noise;
    task.perception.vision_held_s = HELD_S;
    task
}

fn config() -> EnvConfig {
    EnvConfig { num_envs: ENVS, seed: 5, autoreset: Autoreset::SameStep, ..EnvConfig::default() }
}

/// Where each environment's target is away from the pointer, and how far off it seems.
type Seen = Vec<[[f64; 3]; 2]>;

/// So many control steps of relaxed muscles, with targets seen as they are and not.
fn seen(make: &dyn Fn(&Task) -> Box<dyn VectorEnv>, steps: usize) -> Vec<Seen> {
    let [mut noisy, mut clear] = [SHARE, 0.0].map(|share| make(&task(share)));
    let spec = clear.spec().clone();
    let relaxed = vec![-1.0; ENVS * spec.action_size()];
    let (mut a, mut b) = (StepStorage::new(&spec), StepStorage::new(&spec));
    noisy.reset(Some(1), None, &mut a.observation).unwrap();
    clear.reset(Some(1), None, &mut b.observation).unwrap();
    let is_judged = |name: &str| {
        ["target_position.", "target_vector.", "target_direction.", "next_target_vector."]
            .iter()
            .any(|part| name.starts_with(part))
    };
    let at = |name: &str| spec.observation_names.iter().position(|entry| entry == name).unwrap();
    let (vector, place) = (at("target_vector.x"), at("target_position.x"));
    (0..=steps)
        .map(|step| {
            if step > 0 {
                noisy.step(&relaxed, a.buffers()).unwrap();
                clear.step(&relaxed, b.buffers()).unwrap();
                assert!(a.reward == b.reward, "what is so stays so, step {step}");
            }
            let rows = a
                .observation
                .chunks_exact(spec.observation_size())
                .zip(b.observation.chunks_exact(spec.observation_size()));
            rows.map(|(noisy, clear)| {
                for (entry, name) in spec.observation_names.iter().enumerate() {
                    assert!(is_judged(name) || noisy[entry] == clear[entry], "{name}, step {step}");
                }
                let off = |from: usize| std::array::from_fn(|k| f64::from(noisy[from + k] - clear[from + k]));
                let (of_vector, of_place): ([f64; 3], [f64; 3]) = (off(vector), off(place));
                assert!((0..3).all(|k| (of_vector[k] - of_place[k]).abs() < 1e-6), "one error, step {step}");
                [std::array::from_fn(|k| f64::from(clear[vector + k])), of_vector]
            })
            .collect()
        })
        .collect()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn check(make: &dyn Fn(&Task) -> Box<dyn VectorEnv>) {
    let steps = seen(make, 4);
    // Of the distance: along the way, and across it, of both directions.
    let shares: Vec<Vec<[f64; 2]>> = steps.iter().map(|seen| seen.iter().map(share).collect()).collect();
    let [first, last] = [&shares[0], &shares[4]];
    let mean_square = |which: usize| first.iter().map(|share| share[which].powi(2)).sum::<f64>() / ENVS as f64;
    let deviation = |which| mean_square(which).sqrt();
    let [along, across] = [0, 1].map(deviation);
    assert!((along / SHARE - 1.0).abs() < 0.15, "{along}");
    assert!((across / (0.5 * SHARE) - 1.0).abs() < 0.15, "{across}");
    // Who takes a target for much nearer than it is never gets there.
    let most = shares.iter().flatten().map(|share| share[0].abs() / SHARE).fold(0.0, f64::max);
    assert!((1.9..2.0 + 1e-4).contains(&most), "{most} standard deviations");
    // Of what was misjudged first, so much is left after four steps of 50 ms.
    let left = first.iter().zip(last).map(|(then, now)| then[0] * now[0]).sum::<f64>() / ENVS as f64 / mean_square(0);
    assert!((left - (-0.2 / HELD_S).exp()).abs() < 0.12, "{left}");
}

/// How far off a target seems of its distance, along the way and across it.
fn share(&[away, off]: &[[f64; 3]; 2]) -> [f64; 2] {
    let distance = dot(away, away).sqrt();
    let along = dot(off, away) / distance;
    let across = (0.5 * (dot(off, off) - along * along).max(0.0)).sqrt();
    [along / (distance + NEAR), across / (distance + NEAR)]
}

#[test]
fn targets_seem_off_by_a_share_of_their_distance() {
    check(&|task| Box::new(ReferenceEnv::new(&arm(task), task, &config()).unwrap()));
    check(&|task| Box::new(CpuEnv::new(&arm(task), task, &config()).unwrap()));
}

#[test]
fn on_a_card_as_well() {
    if without_gpu() {
        return;
    }
    let (gpu, options) = (gpu(), GpuOptions { envs_per_shard: 100, ..GpuOptions::default() });
    check(&|task| Box::new(GpuEnv::with_options(&gpu, &arm(task), task, &config(), &options).unwrap()));
}

#[test]
fn each_target_is_misjudged_anew() {
    // The same place again and again, a metre around the arm, so that each is done as soon as it is asked for.
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: anew\nscene: {ball: {kind: sphere, at: [0.3, 0, 0], radius: 1}}\n\
                script: [{dwell: {in: [ball, ball, ball, ball], for_s: 0.1}}]\nperception: {vision_noise: 0.2, vision_held_s: 10}\n";
    let task = Task::from_yaml(text, "anew").unwrap();
    let mut env = CpuEnv::new(&arm(&task), &task, &config()).unwrap();
    let spec = env.spec().clone();
    let at = |name: &str| spec.observation_names.iter().position(|entry| entry == name).unwrap();
    let (place, phase, relaxed) = (at("target_position.x"), at("phase"), vec![-1.0; ENVS * spec.action_size()]);
    let mut out = StepStorage::new(&spec);
    env.reset(Some(1), None, &mut out.observation).unwrap();
    // Squared changes of where the target seems to be, of the same target and of the next, and how many of them.
    let (mut last, mut changes) = (out.observation.clone(), [[0.0, 0.0]; 2]);
    for _ in 0..6 {
        env.step(&relaxed, out.buffers()).unwrap();
        let rows = out.observation.chunks(spec.observation_size()).zip(last.chunks(spec.observation_size()));
        for (env, (now, last)) in rows.enumerate().filter(|&(env, _)| !out.terminated[env]) {
            let is_next = now[phase] > last[phase];
            assert!(!is_next || now[place] != last[place], "environment {env}");
            let [sum, count] = &mut changes[usize::from(is_next)];
            (*sum, *count) = (*sum + f64::from(now[place] - last[place]).powi(2), *count + 1.0);
        }
        last.clone_from(&out.observation);
    }
    let [same, next] = changes.map(|[sum, count]| sum / count);
    assert!(changes[1][1] >= 2.0 * ENVS as f64, "{changes:?}");
    // Of the same target a control step changes a hundredth of the variance, and what comes of the arm's movement.
    assert!(same < 0.05 * next, "{same} {next}");
}

#[test]
fn a_sharper_eye_takes_the_place_of_a_dim_one_but_not_the_other_way_round() {
    let [dim, clear] = [SHARE, 0.0].map(task);
    let mut env = CpuEnv::new(&arm(&dim), &dim, &config()).unwrap();
    env.set_task(&clear).unwrap();
    let mut env = CpuEnv::new(&arm(&clear), &clear, &config()).unwrap();
    let error = env.set_task(&dim).unwrap_err().to_string();
    assert!(error.contains("seen with noise where they were seen without (perception.vision_noise)"), "{error}");
}
