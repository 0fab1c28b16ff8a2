//! One list of properties for every backend. A backend is done when it passes.

use crate::common::{
    actions, arm, assert_follows, chords, column, drifting, driven, entry, fast, fingers, following, gpu, limited,
    rollout, short, sphere, steered, swung, without_native,
};
use myo_env::{
    Autoreset, CpuEnv, Env, EnvConfig, EnvError, GpuEnv, ReferenceEnv, Snapshot, StepStorage, Tables, VectorEnv,
};
use myo_scalar::Level;
use myo_tasks::Task;

/// A backend under test.
trait Subject {
    /// Its environments.
    type Env: VectorEnv;
    /// Whether a driver compiles each task, which takes minutes for large bodies where that is software.
    const IS_COMPILED: bool = false;
    fn make(task: &Task, config: EnvConfig) -> Self::Env;
}

/// Lanes of the processor.
struct Lanes;
/// Machine code of the processor.
struct Native;
/// Double precision.
struct Reference;
/// A graphics card.
struct Card;

impl Subject for Lanes {
    type Env = CpuEnv;
    fn make(task: &Task, config: EnvConfig) -> CpuEnv {
        CpuEnv::new(&arm(task), task, &EnvConfig { native: Some(false), ..config }).unwrap()
    }
}

impl Subject for Native {
    type Env = CpuEnv;
    fn make(task: &Task, config: EnvConfig) -> CpuEnv {
        CpuEnv::new(&arm(task), task, &EnvConfig { native: Some(true), ..config }).unwrap()
    }
}

impl Subject for Reference {
    type Env = ReferenceEnv;
    fn make(task: &Task, config: EnvConfig) -> ReferenceEnv {
        ReferenceEnv::new(&arm(task), task, &config).unwrap()
    }
}

impl Subject for Card {
    type Env = GpuEnv;
    const IS_COMPILED: bool = true;
    fn make(task: &Task, config: EnvConfig) -> GpuEnv {
        GpuEnv::new(&gpu(), &arm(task), task, &config).unwrap()
    }
}

fn bits(rows: &[f32]) -> Vec<u32> {
    rows.iter().map(|x| x.to_bits()).collect()
}

fn assert_same_bits(a: &[StepStorage], b: &[StepStorage]) {
    for (step, (a, b)) in a.iter().zip(b).enumerate() {
        assert_eq!(bits(&a.observation), bits(&b.observation), "observation of step {step}");
        assert_eq!(bits(&a.reward), bits(&b.reward), "reward of step {step}");
        assert_eq!(a.terminated, b.terminated, "terminated in step {step}");
        assert_eq!(a.truncated, b.truncated, "truncated in step {step}");
    }
}

fn same_seed_gives_the_same_bits_and_another_seed_does_not<E: Subject>() {
    let task = short("pointing-uitb");
    let run =
        |seed| rollout(&mut E::make(&task, EnvConfig { num_envs: 5, seed, exploring: 2, ..Default::default() }), 25);
    assert_same_bits(&run(3), &run(3));
    assert_ne!(bits(&run(3)[0].observation), bits(&run(4)[0].observation));
}

fn neighbours_and_threads_do_not_matter<E: Subject>() {
    let task = short("pointing-uitb");
    let run = |num_envs, threads| {
        let mut env = E::make(&task, EnvConfig { num_envs, threads: Some(threads), ..Default::default() });
        let (nobs, nact) = (env.spec().observation_size(), env.spec().action_size());
        let mut out = StepStorage::new(env.spec());
        let mut seen = vec![];
        for step in 0..25 {
            let mut all = vec![0.3; num_envs * nact];
            for (k, a) in all[..nact].iter_mut().enumerate() {
                *a = ((k + step) % 7) as f32 / 3.5 - 1.0;
            }
            env.step(&all, out.buffers()).unwrap();
            seen.extend(bits(&out.observation[..nobs]));
        }
        seen
    };
    let alone = run(1, 1);
    assert_eq!(alone, run(37, 1));
    assert_eq!(alone, run(130, 3));
}

fn same_step_keeps_the_terminal_observation_and_resets_everything<E: Subject>() {
    let task = short("pointing-uitb");
    let mut env = E::make(&task, EnvConfig { num_envs: 3, ..Default::default() });
    let limit = env.spec().max_episode_steps;
    assert_eq!(limit, 10);
    let run = rollout(&mut env, 2 * limit);
    let (time, phase) = (entry(&env, "time_left"), entry(&env, "phase"));
    let (nobs, length) = (env.spec().observation_size(), column(&env, "length"));
    for (step, out) in run.iter().enumerate() {
        let last = (step + 1) % limit == 0;
        for i in 0..3 {
            assert_eq!(out.truncated[i], last, "step {step}");
            assert!(!out.terminated[i]);
            let now = &out.observation[i * nobs..(i + 1) * nobs];
            if last {
                let end = &out.final_observation[i * nobs..(i + 1) * nobs];
                assert!(end[time].abs() < 1e-6, "no time left in the terminal observation");
                assert!((now[time] - 1.0).abs() < 1e-6, "all time left after the reset");
                assert_eq!(now[phase], 0.0);
                assert_ne!(bits(end), bits(now));
                assert_eq!(out.episode[i * env.spec().episode_size() + length], limit as f32);
            }
        }
    }
    // Two resets of one environment draw different episodes.
    assert_ne!(bits(&run[limit - 1].observation), bits(&run[2 * limit - 1].observation));
}

fn next_step_ignores_one_action_and_gives_no_reward<E: Subject>() {
    let task = short("pointing-uitb");
    let make_one = |autoreset| E::make(&task, EnvConfig { num_envs: 2, autoreset, ..Default::default() });
    let (mut next, mut same) = (make_one(Autoreset::NextStep), make_one(Autoreset::SameStep));
    let limit = next.spec().max_episode_steps;
    let (a, b) = (rollout(&mut next, limit + 1), rollout(&mut same, limit));
    assert_same_bits(&a[..limit - 1], &b[..limit - 1]);
    assert!(a[limit - 1].truncated.iter().all(|&t| t));
    assert_eq!(bits(&a[limit - 1].observation), bits(&b[limit - 1].final_observation), "the last observation as it is");
    assert_eq!(bits(&a[limit].observation), bits(&b[limit - 1].observation), "then the reset one");
    assert!(a[limit].reward.iter().all(|&r| r == 0.0));
    assert!(a[limit].truncated.iter().chain(&a[limit].terminated).all(|&flag| !flag));
}

fn disabled_asks_for_a_reset_by_mask<E: Subject>() {
    let task = short("pointing-uitb");
    let config = EnvConfig { num_envs: 3, autoreset: Autoreset::Disabled, ..Default::default() };
    let mut env = E::make(&task, config);
    let limit = env.spec().max_episode_steps;
    let run = rollout(&mut env, limit);
    let (zeros, mut out) = (vec![0.0; 3 * env.spec().action_size()], StepStorage::new(env.spec()));
    assert_eq!(env.step(&zeros, out.buffers()), Err(EnvError::NeedsReset { env: 0 }));
    let nobs = env.spec().observation_size();
    let mut observation = vec![f32::INFINITY; 3 * nobs];
    env.reset(None, Some(&[true, false, true]), &mut observation).unwrap();
    assert_eq!(bits(&observation[nobs..2 * nobs]), bits(&run[limit - 1].observation[nobs..2 * nobs]));
    assert_ne!(bits(&observation[..nobs]), bits(&run[limit - 1].observation[..nobs]));
    assert_eq!(env.step(&zeros, out.buffers()), Err(EnvError::NeedsReset { env: 1 }));
    env.reset(None, Some(&[false, true, false]), &mut observation).unwrap();
    env.step(&zeros, out.buffers()).unwrap();
}

fn a_saved_state_continues_bit_for_bit<E: Subject>() {
    let task = short("pointing-uitb");
    let config = EnvConfig { num_envs: 21, exploring: 6, ..Default::default() };
    let mut env = E::make(&task, config);
    rollout(&mut env, 7);
    let saved = env.save_state().unwrap();
    let mut copy = E::make(&task, EnvConfig { seed: 99, ..config });
    copy.load_state(&saved).unwrap();
    assert_same_bits(&rollout(&mut env, 15), &rollout(&mut copy, 15));
    let refused = copy.load_state(&saved[..saved.len() - 1]).unwrap_err().to_string();
    assert!(refused.contains("does not fit"), "{refused}");
    let mut smaller = E::make(&task, EnvConfig { num_envs: 20, ..config });
    let refused = smaller.load_state(&saved).unwrap_err().to_string();
    assert!(refused.contains("it has 21 environments, this environment 20"), "{refused}");
}

/// Which episodes have ended is part of the state, whatever the mode makes of it.
fn a_saved_state_knows_which_episodes_are_finished<E: Subject>() {
    let mut task = short("pointing-uitb");
    task.time_limit_s = 0.1;
    let make_one = |autoreset| E::make(&task, EnvConfig { num_envs: 3, autoreset, ..Default::default() });
    let mut env = make_one(Autoreset::Disabled);
    let fresh = env.save_state().unwrap();
    rollout(&mut env, 2);
    let mut observation = vec![0.0; 3 * env.spec().observation_size()];
    env.reset(None, Some(&[true, false, true]), &mut observation).unwrap();
    let ended = env.save_state().unwrap();
    let (zeros, mut out) = (vec![0.0; 3 * env.spec().action_size()], StepStorage::new(env.spec()));

    let mut copy = make_one(Autoreset::Disabled);
    copy.load_state(&ended).unwrap();
    assert_eq!(copy.step(&zeros, out.buffers()), Err(EnvError::NeedsReset { env: 1 }));
    copy.load_state(&fresh).unwrap();
    copy.step(&zeros, out.buffers()).unwrap();

    let mut next = make_one(Autoreset::NextStep);
    next.load_state(&ended).unwrap();
    next.step(&zeros, out.buffers()).unwrap();
    assert!(out.reward[1] == 0.0 && out.reward[0] != 0.0 && out.reward[2] != 0.0, "{:?}", out.reward);

    let refused = make_one(Autoreset::SameStep).load_state(&ended).unwrap_err().to_string();
    assert!(refused.contains("environment 1 has finished its episode"), "{refused}");
}

fn a_peek_sees_what_a_saved_state_holds<E: Subject>() {
    let task = short("pointing-uitb");
    let tables = Tables::<f64>::new(&arm(&task), &task).unwrap();
    let mut env = E::make(&task, EnvConfig { num_envs: 21, exploring: 6, ..Default::default() });
    let limit = env.spec().max_episode_steps;
    rollout(&mut env, limit + 2);
    let saved = env.save_state().unwrap();
    for envs in [0..21, 3..4, 15..19, 7..7, 21..21] {
        let read = envs.clone().map(|env| Snapshot::read(&tables, &saved, env).unwrap());
        let (seen, read) = (env.peek(envs).unwrap(), read.collect::<Vec<_>>());
        assert_eq!(format!("{seen:?}"), format!("{read:?}"));
    }
    assert_eq!(env.peek(2..3).unwrap()[0].episode, 2);
    for (start, end) in [(0, 22), (22, 22), (5, 3), (0, usize::MAX)] {
        let refused = env.peek(start..end).err();
        assert_eq!(refused, Some(EnvError::NoSuchEnvironment { start, end, num_envs: 21 }));
    }
    assert_eq!(env.save_state().unwrap(), saved);
}

fn damaged_states_are_refused_and_change_nothing<E: Subject>() {
    let task = short("pointing-uitb");
    let mut env = E::make(&task, EnvConfig { num_envs: 2, ..Default::default() });
    rollout(&mut env, 2);
    let saved = env.save_state().unwrap();
    rollout(&mut env, 2);
    let before = env.save_state().unwrap();
    // Every part of a state: its head, numbers, integers, the end.
    for at in (0..saved.len()).step_by(37).chain([4, 8, saved.len() - 5, saved.len() - 1]) {
        let mut damaged = saved.clone();
        damaged[at] ^= 0x10;
        let refused = env.load_state(&damaged).expect_err("a byte was changed").to_string();
        assert!(refused.starts_with("the saved environment state does not fit: "), "byte {at}: {refused}");
    }
    for length in [0, 3, 20, saved.len() / 2, saved.len() - 1] {
        assert!(env.load_state(&saved[..length]).is_err(), "cut to {length} bytes");
    }
    assert!(env.load_state(&[&saved[..], &[0]].concat()).is_err(), "a byte too many");
    assert_eq!(env.save_state().unwrap(), before);
}

fn states_of_another_task_or_body_are_refused_by_name<E: Subject>() {
    let task = short("pointing-uitb");
    let mut env = E::make(&task, EnvConfig { num_envs: 2, ..Default::default() });
    let refusal = |env: &mut E::Env, other: &Task| {
        let state = E::make(other, EnvConfig { num_envs: 2, ..Default::default() }).save_state().unwrap();
        env.load_state(&state).expect_err("another task").to_string()
    };
    let other = refusal(&mut env, &Task { name: "ten-spheres".into(), ..task.clone() });
    assert!(other.ends_with("it is of the task `ten-spheres`, this environment does `pointing-uitb`"), "{other}");
    let other = refusal(&mut env, &Task { time_limit_s: 0.6, ..task.clone() });
    assert!(
        other.ends_with("it is of another version of the task `pointing-uitb`: what the task says has changed"),
        "{other}"
    );
    let other = refusal(&mut env, &Task { model: "mobl-arms".into(), ..task });
    assert!(other.ends_with("it is of the model `mobl-arms`, this environment has `mobl-arms-uitb`"), "{other}");
}

fn bad_calls_are_refused_and_change_nothing<E: Subject>() {
    let task = short("pointing-uitb");
    let mut env = E::make(&task, EnvConfig { num_envs: 2, ..Default::default() });
    let before = env.save_state().unwrap();
    let nact = env.spec().action_size();
    let mut out = StepStorage::new(env.spec());
    let wrong = env.step(&[0.0; 3], out.buffers()).unwrap_err();
    assert_eq!(wrong, EnvError::WrongLength { what: "actions", got: 3, expected: 2 * nact });
    let mut actions = vec![0.0; 2 * nact];
    actions[nact + 4] = f32::INFINITY;
    let wrong = env.step(&actions, out.buffers()).unwrap_err();
    assert_eq!(wrong, EnvError::NonFiniteAction { env: 1, index: 4, value: f32::INFINITY });
    assert_eq!(env.save_state().unwrap(), before);
}

/// Hanging relaxed, with the fingertip inside a sphere around it: the dwell runs out after exactly so many steps.
fn a_dwell_ends_after_its_seconds<E: Subject>() {
    let mut task = fast("pointing-single");
    let text = task.to_yaml();
    assert!(text.contains("for_s: 0.25"), "{text}");
    task = Task::from_yaml(&text.replace("for_s: 0.25", "for_s: 0.3"), "test").unwrap();
    let ball = sphere(&mut task, "ball");
    // The fingertip of the hanging arm, from the shoulder.
    let [x, y, z] = [0.052, -0.029, -0.708].map(myo_tasks::Range::fixed);
    ball.at.0 = myo_tasks::Region { x, y, z };
    ball.radius = myo_tasks::Range::fixed(0.3);
    task.reset = myo_tasks::Reset { pose: myo_tasks::Pose::Zero, activation_max: 0.0, ..Default::default() };
    let mut env = E::make(&task, EnvConfig { num_envs: 2, ..Default::default() });
    let mut out = StepStorage::new(env.spec());
    let relaxed = vec![-1.0; 2 * env.spec().action_size()];
    for step in 1..=6 {
        env.step(&relaxed, out.buffers()).unwrap();
        assert_eq!(out.terminated, [step == 6; 2], "0.3 s at 20 Hz are six steps; this is step {step}");
    }
    let row = &out.episode[..env.spec().episode_size()];
    assert_eq!(row[column(&env, "success")], 1.0);
    assert!((row[column(&env, "target_1_time")] - 0.3).abs() < 1e-6);
    let terms: f32 =
        ["distance", "subtask", "completion", "neural_effort", "acceleration_effort", "contact", "wrong_press"]
            .iter()
            .map(|name| row[column(&env, &format!("reward_{name}"))])
            .sum();
    assert!((row[column(&env, "return")] - terms).abs() < 1e-4, "the return is the sum of its terms");
}

fn motor_noise_differs_between_muscles<E: Subject>() {
    let mut task = fast("pointing-single");
    task.noise.constant = 0.185;
    task.reset.activation_max = 0.0;
    let mut env = E::make(&task, EnvConfig { num_envs: 1, ..Default::default() });
    let mut out = StepStorage::new(env.spec());
    env.step(&vec![0.0; env.spec().action_size()], out.buffers()).unwrap();
    let first = entry(&env, "activation.DELT1");
    let mut activations = bits(&out.observation[first..first + env.spec().action_size()]);
    activations.sort_unstable();
    activations.dedup();
    assert_eq!(activations.len(), env.spec().action_size(), "every muscle draws its own noise");
}

fn every_preset_runs_with_finite_numbers<E: Subject>() {
    // Of two presets of the largest body one is compiled.
    let is_tried = |name: &&str| !(E::IS_COMPILED && *name == "ar-menu");
    for name in myo_tasks::preset_names().into_iter().filter(is_tried) {
        let task = short(name);
        let mut env = E::make(&task, EnvConfig { num_envs: 4, ..Default::default() });
        let run = rollout(&mut env, 30);
        for out in &run {
            assert!(out.observation.iter().chain(&out.reward).all(|x| x.is_finite()), "{name}");
        }
        let nobs = env.spec().observation_size();
        let varies = |k: usize| run.iter().any(|out| out.observation[k] != run[0].observation[k]);
        let joint = if task.model == "myo-hand" { "mcp2_flexion_r" } else { "elbow_flexion" };
        for name in [format!("joint_position.{joint}"), format!("joint_velocity.{joint}"), "time_left".into()] {
            assert!(varies(entry(&env, &name)), "{}: {name} never changes", task.name);
        }
        assert_eq!(run[0].observation.len(), 4 * nobs);
    }
}

macro_rules! conformance {
    ($backend:ident, $type:ty, $skip:expr; $($property:ident),* $(,)?) => {
        mod $backend {
            $(#[test]
            fn $property() {
                if !$skip {
                    super::$property::<$type>();
                }
            })*
        }
    };
    ($($backend:ident: $type:ty, skip if $skip:expr);* $(;)?) => {
        $(conformance!($backend, $type, $skip;
            same_seed_gives_the_same_bits_and_another_seed_does_not,
            neighbours_and_threads_do_not_matter,
            same_step_keeps_the_terminal_observation_and_resets_everything,
            next_step_ignores_one_action_and_gives_no_reward,
            disabled_asks_for_a_reset_by_mask,
            a_saved_state_continues_bit_for_bit,
            a_saved_state_knows_which_episodes_are_finished,
            a_peek_sees_what_a_saved_state_holds,
            damaged_states_are_refused_and_change_nothing,
            states_of_another_task_or_body_are_refused_by_name,
            bad_calls_are_refused_and_change_nothing,
            a_dwell_ends_after_its_seconds,
            motor_noise_differs_between_muscles,
            every_preset_runs_with_finite_numbers,
        );)*
    };
}
conformance!(
    cpu: super::Lanes, skip if false;
    native: super::Native, skip if crate::common::without_native();
    reference: super::Reference, skip if false;
    gpu: super::Card, skip if crate::common::without_gpu();
);

/// The backends draw the same integers and agree in floats as far as single precision goes, at every level, in all that a
/// step returns.
#[test]
fn lanes_follow_the_reference() {
    let made = [following(), drifting(), steered(), swung(), driven(), limited(), fingers(), chords()];
    let tasks = ["pointing-uitb", "public-display", "slider", "choice", "wall-ray"].map(short).into_iter().chain(made);
    for task in tasks {
        let name = &task.name;
        let config = EnvConfig { num_envs: 20, exploring: 9, ..Default::default() };
        let mut reference = ReferenceEnv::new(&arm(&task), &task, &config).unwrap();
        let wanted = rollout(&mut reference, 20);
        let levels = Level::available().into_iter().map(|level| EnvConfig { level: Some(level), ..config });
        let native = (!without_native()).then_some(EnvConfig { native: Some(true), ..config });
        for config in levels.chain(native) {
            let mut lanes = CpuEnv::new(&arm(&task), &task, &config).unwrap();
            let code = if config.native.is_some() { "machine code".into() } else { format!("{:?}", config.level) };
            for (step, (a, b)) in rollout(&mut lanes, 20).iter().zip(&wanted).enumerate() {
                assert_follows(&reference, a, b, &format!("{name}, {code}, step {step}"));
            }
        }
    }
}

/// The reference runs a plan of its own, so that faults of the specialised one show.
#[test]
fn the_reference_runs_the_exact_plan() {
    let task = short("pointing-uitb");
    let config = EnvConfig::default();
    let reference = ReferenceEnv::new(&arm(&task), &task, &config).unwrap();
    let lanes = CpuEnv::new(&arm(&task), &task, &config).unwrap();
    let (exact, specialised) = (&reference.tables().plan, &lanes.tables().plan);
    assert!(exact.energy_profiles.is_empty() && exact.elements.bodies.len() == arm(&task).bodies.len());
    assert!(!specialised.energy_profiles.is_empty() && specialised.links.len() < exact.links.len());
}

#[test]
fn a_control_step_that_does_not_fit_the_physics_is_refused() {
    let mut task = fast("pointing-uitb");
    task.control_dt_s = 0.0333;
    let refused = CpuEnv::new(&arm(&task), &task, &EnvConfig::default()).err().expect("0.0333 / 0.002 is not whole");
    assert!(
        refused.to_string().contains(
            "0.0333 s, which is not a whole multiple of the model's physics step of 0.002 s; take 0.032 or 0.034 s"
        ),
        "{refused}"
    );
    let none = CpuEnv::new(&arm(&task), &task, &EnvConfig { num_envs: 0, ..Default::default() }).err();
    assert!(none.expect("zero environments").to_string().contains("at least one"));
    for threads in [0, 1_000_000] {
        let config = EnvConfig { threads: Some(threads), ..Default::default() };
        let error = CpuEnv::new(&arm(&fast("pointing-uitb")), &fast("pointing-uitb"), &config).err();
        assert_eq!(error.unwrap().to_string(), format!("threads is {threads}; it must be from 1 to 1024"));
    }
}

#[test]
fn one_environment_equals_the_first_of_many() {
    let task = short("pointing-uitb");
    let mut one = Env::new(&arm(&task), &task, 7).unwrap();
    let mut many = Lanes::make(&task, EnvConfig { num_envs: 9, seed: 7, ..Default::default() });
    let (nobs, nact) = (one.spec().observation_size(), one.spec().action_size());
    let mut out = StepStorage::new(many.spec());
    for step in 0..one.spec().max_episode_steps {
        let all = actions(&many, step);
        many.step(&all, out.buffers()).unwrap();
        let last = one.step(&all[..nact]).unwrap();
        assert_eq!(last.truncated, out.truncated[0]);
        let wanted = if last.truncated { &out.final_observation } else { &out.observation };
        assert_eq!(bits(last.observation), bits(&wanted[..nobs]));
    }
    assert_eq!(one.step(&vec![0.0; nact]), Err(EnvError::NeedsReset { env: 0 }));
    assert_eq!(bits(one.reset(None)), bits(&out.observation[..nobs]), "the second episode of either");
}
