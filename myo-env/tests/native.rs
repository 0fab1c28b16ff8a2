//! Machine code of control steps: when there is some, and that it does what lanes do where tasks differ and change. All else is in
//! `conformance.rs`.

use crate::common::{arm, assert_follows, rollout, short, without_native};
use myo_env::{BuildError, CpuEnv, EnvConfig, NotCompiled, ReferenceEnv, StepStorage, VectorEnv};
use myo_scalar::Level;
use myo_tasks::Task;

fn both(layouts: &[Task], num_envs: usize) -> [CpuEnv; 2] {
    [false, true].map(|native| {
        let config = EnvConfig { num_envs, exploring: 5, native: Some(native), ..Default::default() };
        CpuEnv::with_layouts(&arm(&layouts[0]), layouts, &config).unwrap()
    })
}

fn assert_both_do_the_same([lanes, native]: &mut [CpuEnv; 2], steps: usize, context: &str) {
    let wanted = rollout(lanes, steps);
    for (step, (got, want)) in rollout(native, steps).iter().zip(&wanted).enumerate() {
        assert_follows(lanes, got, want, &format!("{context}, step {step}"));
    }
}

#[test]
fn it_is_made_for_many_environments_where_nobody_says() {
    if without_native() {
        return;
    }
    let task = short("pointing-uitb");
    let made = |num_envs, native| {
        let config = EnvConfig { num_envs, native, ..Default::default() };
        CpuEnv::new(&arm(&task), &task, &config).unwrap()
    };
    assert!(made(256, None).is_native() && !made(255, None).is_native());
    assert!(made(1, Some(true)).is_native() && !made(300, Some(false)).is_native());
    let few = made(256, None).sibling(&EnvConfig { num_envs: 3, ..Default::default() }).unwrap();
    assert!(few.is_native(), "what is compiled is compiled");
}

#[test]
fn what_cannot_be_made_is_said() {
    let task = short("pointing-uitb");
    let config = EnvConfig { native: Some(true), ..Default::default() };
    let double = ReferenceEnv::new(&arm(&task), &task, &config).err().unwrap();
    assert!(matches!(double, BuildError::NotCompiled(NotCompiled::Double)), "{double}");
    assert!(
        !ReferenceEnv::new(&arm(&task), &task, &EnvConfig { native: None, num_envs: 300, ..config })
            .unwrap()
            .is_native()
    );
    let portable = Level::named("portable").unwrap();
    let quiet = EnvConfig { level: Some(portable), native: None, num_envs: 300, ..config };
    assert!(!CpuEnv::new(&arm(&task), &task, &quiet).unwrap().is_native());
    if without_native() {
        return;
    }
    let other = CpuEnv::new(&arm(&task), &task, &EnvConfig { level: Some(portable), ..config }).err().unwrap();
    assert!(other.to_string().contains("lanes of the level `portable` are asked for"), "{other}");
}

#[test]
fn layouts_are_each_environments_own_and_change_while_they_live() {
    if without_native() {
        return;
    }
    let near = short("pointing-uitb");
    let far = |seconds| Task { time_limit_s: seconds, ..near.clone() };
    let mut envs = both(&[near.clone(), far(0.7), far(0.9)], 37);
    assert_both_do_the_same(&mut envs, 12, "three layouts");
    for env in &mut envs {
        env.set_tasks(&[far(0.5), near.clone()]).unwrap();
        env.set_cost_share(0.25).unwrap();
    }
    assert_both_do_the_same(&mut envs, 12, "two others");
    let mut envs = both(std::slice::from_ref(&near), 20);
    envs.iter_mut().for_each(|env| env.set_tasks(&[far(0.4)]).unwrap());
    assert_both_do_the_same(&mut envs, 12, "another one");
}

#[test]
fn physics_steps_are_written_down_all_the_same() {
    if without_native() {
        return;
    }
    let task = short("pointing-uitb");
    let mut envs = both(std::slice::from_ref(&task), 20);
    let traces = envs.each_mut().map(|env| {
        let mut trace = vec![f32::NAN; 20 * env.trace_shape().len_per_env()];
        let mut out = StepStorage::new(env.spec());
        let relaxed = vec![-1.0; 20 * env.spec().action_size()];
        env.step_traced(&relaxed, out.buffers(), &mut trace).unwrap();
        trace
    });
    assert!(traces[0].iter().all(|x| x.is_finite()));
    let difference = traces[0].iter().zip(&traces[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(difference < 1e-3, "{difference}");
    assert_eq!(envs[1].solver_counts()[4].steps, envs[0].solver_counts()[4].steps);
}
