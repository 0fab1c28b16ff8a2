//! Steps that may take only so long, and actions that change what muscles do.

use crate::common::*;
use myo_env::{CpuEnv, EnvConfig, StepStorage, VectorEnv};
use myo_tasks::{Control, Task};

const ENVS: usize = 64;

fn config() -> EnvConfig {
    EnvConfig { num_envs: ENVS, seed: 3, ..EnvConfig::default() }
}

#[test]
fn episodes_go_on_after_what_was_given_up_and_are_no_success() {
    let task = limited();
    let mut env = CpuEnv::new(&arm(&task), &task, &config()).unwrap();
    let size = env.spec().episode_size();
    let [success, done, length] = ["success", "targets_done", "length"].map(|name| column(&env, name));
    let of_targets =
        [1, 2, 3].map(|k| [column(&env, &format!("target_{k}_success")), column(&env, &format!("target_{k}_time"))]);
    let (mut went_on, mut cut, mut all) = (0, 0, 0);
    for out in rollout(&mut env, 200) {
        for number in (0..ENVS).filter(|&number| out.terminated[number] || out.truncated[number]) {
            let row = &out.episode[number * size..][..size];
            let were_done = of_targets.map(|[success, _]| row[success] > 0.5);
            assert_eq!(row[done] as usize, were_done.iter().filter(|&&done| done).count());
            assert_eq!([row[success] > 0.5, out.terminated[number]], [were_done == [true; 3]; 2], "{were_done:?}");
            for ([_, time], was_done) in of_targets.into_iter().zip(were_done) {
                // From when it counts: no longer than the limit, and no time where it was given up.
                assert!(
                    if was_done { (0.0..0.25 + 1e-6).contains(&row[time]) } else { row[time].is_nan() },
                    "{}",
                    row[time]
                );
            }
            went_on += usize::from(!were_done[0] && were_done[1]);
            cut += usize::from(!out.terminated[number] && (row[length] as usize) < 16);
            all += usize::from(out.terminated[number]);
        }
    }
    assert!(went_on > 50 && cut > 50 && all > 5, "{went_on} went on, {cut} ended before the time, {all} were done");
}

#[test]
fn relative_actions_keep_raise_and_lower_what_muscles_do() {
    let absolute = Task { control: Control::Absolute, ..fast("pointing-uitb") };
    let relative = Task { control: Control::Relative, ..absolute.clone() };
    let model = arm(&absolute);
    let make = |task: &Task| CpuEnv::new(&model, task, &config()).unwrap();
    let (mut one, mut other) = (make(&absolute), make(&relative));
    let activations =
        |env: &CpuEnv| env.peek(0..ENVS).unwrap().into_iter().flat_map(|now| now.body.act).collect::<Vec<_>>();
    let step = |env: &mut CpuEnv, actions: &[f32]| {
        let mut out = StepStorage::new(env.spec());
        env.step(actions, out.buffers()).unwrap();
    };
    for env in [&mut one, &mut other] {
        let mut observation = StepStorage::new(env.spec()).observation;
        env.reset(Some(5), None, &mut observation).unwrap();
    }
    let before = activations(&other);
    assert!(before.iter().any(|&act| act > 0.9) && before.iter().any(|&act| act < 0.1), "they start anywhere");
    let count = before.len();
    // Nothing is asked for: muscles do what they did.
    step(&mut other, &vec![0.0; count]);
    for (was, is) in before.iter().zip(activations(&other)) {
        assert!((was - is).abs() < 1e-5, "{was} became {is}");
    }
    // What excitations ask for, as changes of what there is.
    step(&mut one, &vec![0.0; count]);
    let now = activations(&one);
    let wanted: Vec<f32> = (0..count).map(|k| (k % 5) as f32 / 4.0).collect();
    let asked: Vec<f32> = wanted.iter().map(|u| 2.0 * u - 1.0).collect();
    step(&mut one, &asked);
    let mut state = make(&relative);
    let mut observation = StepStorage::new(state.spec()).observation;
    state.reset(Some(5), None, &mut observation).unwrap();
    // From the activations of the start to a half, which is what an absolute action of zero asks for.
    let halves: Vec<f32> = activations(&state).iter().map(|&act| 0.5 - act as f32).collect();
    step(&mut state, &halves);
    for (one, other) in now.iter().zip(activations(&state)) {
        assert!((one - other).abs() < 1e-5, "{one}, {other}");
    }
    let changes: Vec<f32> = wanted.iter().zip(activations(&state)).map(|(u, act)| u - act as f32).collect();
    step(&mut state, &changes);
    for (one, other) in activations(&one).iter().zip(activations(&state)) {
        assert!((one - other).abs() < 1e-5, "{one}, {other}");
    }
}
