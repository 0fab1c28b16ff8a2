//! Looking into saved states, and seeds for single environments.

use myo_env::{CpuEnv, EnvConfig, ReferenceEnv, Snapshot, VectorEnv, reseed};
use myo_model::{Model, builtin};
use myo_tasks::{Task, preset};

fn parts() -> (Model, Task) {
    let task = preset("pointing").unwrap();
    (Model::new(&builtin(&task.model).unwrap()).unwrap(), task)
}

fn env(num_envs: usize, seed: u64) -> CpuEnv {
    let (model, task) = parts();
    CpuEnv::new(&model, &task, &EnvConfig { num_envs, seed, ..EnvConfig::default() }).unwrap()
}

fn observations(env: &mut CpuEnv, mask: Option<&[bool]>) -> Vec<Vec<f32>> {
    let width = env.spec().observation_size();
    let mut out = vec![0.0; env.spec().num_envs * width];
    env.reset(None, mask, &mut out).unwrap();
    out.chunks(width).map(<[f32]>::to_vec).collect()
}

#[test]
fn a_seed_of_its_own_draws_what_a_single_environment_draws() {
    let mut many = env(20, 1);
    let mut state = many.save_state().unwrap();
    reseed(&mut state, [(3, 7), (18, 7)]).unwrap();
    many.load_state(&state).unwrap();
    let rows = observations(&mut many, None);

    let mut single = env(1, 0);
    let mut first = vec![0.0; single.spec().observation_size()];
    single.reset(Some(7), None, &mut first).unwrap();
    assert!(rows[3] == first && rows[18] == first && rows[4] != first);
    assert!(reseed(&mut state, [(20, 7)]).is_err());
}

#[test]
fn a_snapshot_tells_where_the_target_is() {
    let (model, task) = parts();
    let mut many = env(20, 1);
    let rows = observations(&mut many, None);
    let at = many.spec().observation_names.iter().position(|name| name == "target_position.x").unwrap();
    let config = EnvConfig { num_envs: 1, ..EnvConfig::default() };
    let reference = ReferenceEnv::new(&model, &task, &config).unwrap();
    let state = many.save_state().unwrap();
    let snapshot = Snapshot::read(reference.tables(), &state, 17).unwrap();
    assert_eq!(snapshot.task.position[0].map(|x| x as f32), rows[17][at..at + 3]);
    assert!(Snapshot::read(reference.tables(), &state, 20).is_err());
}
