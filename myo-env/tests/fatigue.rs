//! Fatigue: muscles tire by what they do and do no more than is left of them, on all evaluators, and as long as the task says.

use crate::common::{arm, gpu, short, without_gpu};
use myo_env::gpu::GpuOptions;
use myo_env::{Autoreset, CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, Snapshot, StepStorage, VectorEnv};
use myo_muscle::{Fatigue as Tires, FatigueRates};
use myo_tasks::{Fatigue, Task};

const ENVS: usize = 20;
/// A minute of work in half a second.
const QUICK: Fatigue = Fatigue { speed: 120.0, lasts: false, initial_max: 0.7 };

fn task(fatigue: Fatigue) -> Task {
    Task { fatigue, time_limit_s: 1.0, ..short("pointing-uitb") }
}

fn config() -> EnvConfig {
    EnvConfig { num_envs: ENVS, seed: 5, autoreset: Autoreset::SameStep, ..EnvConfig::default() }
}

fn reference(task: &Task) -> ReferenceEnv {
    ReferenceEnv::new(&arm(task), task, &config()).unwrap()
}

/// Actions of all kinds: nothing, all, and what lies between.
fn asked(muscles: usize, number: usize) -> Vec<f32> {
    (0..ENVS * muscles).map(|k| ((k * 7 + number * 5) % 21) as f32 / 10.0 - 1.0).collect()
}

fn control(action: f32) -> f64 {
    0.5 * f64::from(action) + 0.5
}

/// What is fatigued of each muscle a control step later.
fn a_step_later(task: &Task, before: &Snapshot, actions: &[f32]) -> Vec<f64> {
    let muscles = arm(task).muscles;
    let joints = muscles.iter().map(|muscle| muscle.parameters.group);
    let rates = joints.map(|joint| {
        assert!(joint.is_some(), "all muscles of the built-in arms are known");
        FatigueRates::of(joint)
    });
    let of_muscle = rates.zip(&before.fatigue).zip(&before.body.act).zip(actions);
    of_muscle
        .map(|(((rates, &fatigued), &act), &action)| {
            Tires::<f64>::new(rates, task.fatigue.speed, task.control_dt_s).next(fatigued, act, control(action))
        })
        .collect()
}

/// Who tires does what others do that are asked for no more than is left of its muscles.
fn check(make: &dyn Fn(&Task) -> Box<dyn VectorEnv>) {
    let [with, without] = [QUICK, Fatigue::default()].map(task);
    let (mut tired, mut fresh) = (make(&with), make(&without));
    let muscles = tired.spec().action_size();
    let (mut a, mut b) = (StepStorage::new(tired.spec()), StepStorage::new(fresh.spec()));
    tired.reset(Some(1), None, &mut a.observation).unwrap();
    fresh.reset(Some(1), None, &mut b.observation).unwrap();
    let (names, width) = (tired.spec().observation_names.clone(), tired.spec().observation_size());
    let first = names.iter().position(|name| name.starts_with("fatigue.")).unwrap();
    assert_eq!(width, fresh.spec().observation_size() + muscles);
    let mut bound = 0;
    for number in 0..8 {
        let actions = asked(muscles, number);
        let before = tired.peek(0..ENVS).unwrap();
        tired.step(&actions, a.buffers()).unwrap();
        let after = tired.peek(0..ENVS).unwrap();
        let mut left = vec![];
        for (env, (before, after)) in before.iter().zip(&after).enumerate() {
            let actions = &actions[env * muscles..][..muscles];
            let expected = a_step_later(&with, before, actions);
            let seen = &a.observation[env * width + first..][..muscles];
            for (k, (&found, &expected)) in after.fatigue.iter().zip(&expected).enumerate() {
                assert!((found - expected).abs() < 1e-5, "muscle {k}, step {number}: {found}, not {expected}");
                assert!((f64::from(seen[k]) - found).abs() < 1e-6, "it is felt as it is");
                bound += i32::from(control(actions[k]) > 1.0 - found);
                left.push((2.0 * control(actions[k]).min(1.0 - found) - 1.0) as f32);
            }
        }
        fresh.step(&left, b.buffers()).unwrap();
        let others = fresh.peek(0..ENVS).unwrap();
        for (ours, theirs) in after.iter().zip(&others) {
            for (x, y) in
                ours.body.qpos.iter().chain(&ours.body.act).zip(theirs.body.qpos.iter().chain(&theirs.body.act))
            {
                assert!((x - y).abs() < 1e-3, "step {number}: {x} and {y}");
            }
        }
    }
    assert!(bound > ENVS as i32, "{bound}: muscles were asked for more than was left");
}

#[test]
fn who_is_tired_can_do_less() {
    check(&|task| Box::new(reference(task)));
    check(&|task| Box::new(CpuEnv::new(&arm(task), task, &config()).unwrap()));
}

#[test]
fn so_it_is_on_a_card() {
    if without_gpu() {
        return;
    }
    let (gpu, options) = (gpu(), GpuOptions { envs_per_shard: 16, ..GpuOptions::default() });
    check(&|task| Box::new(GpuEnv::with_options(&gpu, &arm(task), task, &config(), &options).unwrap()));
}

fn mean(seen: &[Snapshot]) -> f64 {
    let all = seen.iter().flat_map(|env| &env.fatigue);
    all.clone().sum::<f64>() / all.count() as f64
}

/// Means of what is fatigued, at the start, in the last control step of the first episode, in the first of the second, and after another reset.
fn over_two_episodes(fatigue: Fatigue) -> [f64; 4] {
    let task = task(fatigue);
    let mut env = reference(&task);
    let mut out = StepStorage::new(env.spec());
    env.reset(Some(3), None, &mut out.observation).unwrap();
    let start = mean(&env.peek(0..ENVS).unwrap());
    let actions = vec![0.4; ENVS * env.spec().action_size()];
    let mut last = start;
    loop {
        env.step(&actions, out.buffers()).unwrap();
        let seen = env.peek(0..ENVS).unwrap();
        if seen.iter().all(|env| env.episode > 1) {
            env.reset(Some(3), None, &mut out.observation).unwrap();
            return [start, last, mean(&seen), mean(&env.peek(0..ENVS).unwrap())];
        }
        last = mean(&seen);
    }
}

#[test]
fn it_lasts_if_asked_to_and_ends_with_the_episode_otherwise() {
    let [start, tired, again, reset] = over_two_episodes(Fatigue { initial_max: 0.0, ..QUICK });
    assert!(start == 0.0 && tired > 0.3 && again < 0.05 && reset == 0.0, "{start}, {tired}, {again}, {reset}");
    let [start, tired, again, reset] = over_two_episodes(Fatigue { initial_max: 0.2, lasts: true, ..QUICK });
    assert!(
        (0.05..0.15).contains(&start) && tired > 0.3 && again >= tired && reset == start,
        "{start}, {tired}, {again}, {reset}"
    );
    let [start, tired, again, _] = over_two_episodes(Fatigue { speed: 0.0, lasts: false, initial_max: 0.6 });
    assert!((0.25..0.35).contains(&start) && tired == start, "{start}, {tired}");
    assert!((again - start).abs() < 0.05 && again != start, "{again}: drawn anew");
}

#[test]
fn who_tires_can_be_as_others_but_not_the_other_way_round() {
    let [with, without, lasting] = [QUICK, Fatigue::default(), Fatigue { lasts: true, ..QUICK }].map(task);
    let mut env = CpuEnv::new(&arm(&with), &with, &config()).unwrap();
    env.set_task(&without).unwrap();
    let mut out = StepStorage::new(env.spec());
    env.reset(Some(1), None, &mut out.observation).unwrap();
    env.step(&asked(env.spec().action_size(), 1), out.buffers()).unwrap();
    assert_eq!(mean(&env.peek(0..ENVS).unwrap()), 0.0);
    // Who was tired for good is not any more, even amid an episode.
    let mut worn = CpuEnv::new(&arm(&lasting), &lasting, &config()).unwrap();
    worn.reset(Some(1), None, &mut out.observation).unwrap();
    assert!(mean(&worn.peek(0..ENVS).unwrap()) > 0.2);
    worn.set_task(&without).unwrap();
    worn.step(&asked(worn.spec().action_size(), 1), out.buffers()).unwrap();
    assert_eq!(mean(&worn.peek(0..ENVS).unwrap()), 0.0);
    let error = env.set_task(&lasting).unwrap_err().to_string();
    assert!(error.contains("its fatigue lasts from one episode to the next where it did not"), "{error}");
    let mut env = CpuEnv::new(&arm(&without), &without, &config()).unwrap();
    let error = env.set_task(&with).unwrap_err().to_string();
    assert!(error.contains("its muscles tire where they did not (fatigue.speed)"), "{error}");
}

#[test]
fn a_saved_state_keeps_it() {
    let with = task(QUICK);
    let mut env = reference(&with);
    let mut out = StepStorage::new(env.spec());
    env.reset(Some(2), None, &mut out.observation).unwrap();
    let actions = asked(env.spec().action_size(), 3);
    env.step(&actions, out.buffers()).unwrap();
    let saved = env.save_state().unwrap();
    env.step(&actions, out.buffers()).unwrap();
    let once = env.peek(0..ENVS).unwrap();
    env.load_state(&saved).unwrap();
    env.step(&actions, out.buffers()).unwrap();
    for (a, b) in once.iter().zip(&env.peek(0..ENVS).unwrap()) {
        assert!(a.fatigue == b.fatigue && a.fatigue.iter().all(|&fatigued| fatigued > 0.0), "{:?}", b.fatigue);
    }
}

/// Whose state after an episode can be looked at.
fn once() -> EnvConfig {
    EnvConfig { autoreset: Autoreset::NextStep, ..config() }
}

/// What is active after each control step of an episode fatigues at the rates of rested people, weighted by force.
fn check_column(make: &dyn Fn(&Task) -> Box<dyn VectorEnv>) {
    let task = task(Fatigue::default());
    let muscles = arm(&task).muscles;
    // All muscles of the built-in arms have a force of their own.
    let forces: Vec<f64> = muscles.iter().map(|muscle| muscle.parameters.gain.force.unwrap()).collect();
    let all: f64 = forces.iter().sum();
    let rate = |k: usize| FatigueRates::of(muscles[k].parameters.group).fatigue_per_s * forces[k] / all;
    let mut env = make(&task);
    let mut out = StepStorage::new(env.spec());
    let column = env.spec().episode_names.iter().position(|name| name == "fatigue").unwrap();
    let width = env.spec().episode_size();
    env.reset(Some(1), None, &mut out.observation).unwrap();
    let (mut sums, mut seen) = ([0.0; ENVS], 0);
    for number in 0..20 {
        env.step(&asked(muscles.len(), number), out.buffers()).unwrap();
        for (env, (now, sum)) in env.peek(0..ENVS).unwrap().iter().zip(&mut sums).enumerate() {
            *sum += (0..muscles.len()).map(|k| rate(k) * now.body.act[k] * task.control_dt_s).sum::<f64>();
            if out.terminated[env] || out.truncated[env] {
                let found = f64::from(out.episode[env * width + column]);
                assert!((found - *sum).abs() < 1e-5 * *sum && found > 1e-4, "{found}, not {sum}");
                seen += 1;
            }
        }
    }
    assert_eq!(seen, ENVS, "a second is over");
}

#[test]
fn what_fatigues_is_summed_up() {
    check_column(&|task| Box::new(ReferenceEnv::new(&arm(task), task, &once()).unwrap()));
    check_column(&|task| Box::new(CpuEnv::new(&arm(task), task, &once()).unwrap()));
}

#[test]
fn what_fatigues_on_a_card_is_summed_up() {
    if without_gpu() {
        return;
    }
    let gpu = gpu();
    check_column(&|task| Box::new(GpuEnv::new(&gpu, &arm(task), task, &once()).unwrap()));
}
