//! Looking into saved states, and seeds for single environments.

use crate::common::{fast, shuffled};
use myo_env::{Autoreset, CpuEnv, EnvConfig, ReferenceEnv, Snapshot, StepStorage, VectorEnv, reseed};
use myo_model::{Model, builtin};
use myo_tasks::{Task, preset, preset_names};

fn parts() -> (Model, Task) {
    let task = fast("pointing-uitb");
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

/// Of any body at any task, in the middle of its episodes: the place of a number among all must not hang on what the others are.
#[test]
fn whatever_the_body_and_the_task_a_state_can_be_taken_back() {
    // The order of steps is drawn: none of the presets has that.
    let tasks = preset_names().into_iter().map(|name| preset(name).unwrap()).chain([shuffled()]);
    for task in tasks {
        // What fingers do takes a body that has them.
        let bodies = if task.flat().unwrap().fingers.is_empty() {
            &["mobl-arms", "myo-arm"][..]
        } else {
            &["myo-hand", "myo-arm-hand"]
        };
        for &body in bodies {
            let task = Task { model: body.to_owned(), ..task.clone() };
            let name = &task.name;
            let model = Model::new(&builtin(&task.model).unwrap()).unwrap();
            for autoreset in [Autoreset::SameStep, Autoreset::Disabled] {
                let config = EnvConfig { num_envs: 3, seed: 4, autoreset, ..EnvConfig::default() };
                let mut env = CpuEnv::new(&model, &task, &config).unwrap();
                let mut out = StepStorage::new(env.spec());
                env.reset(Some(4), None, &mut vec![0.0; 3 * env.spec().observation_size()]).unwrap();
                let actions = vec![-0.4; 3 * env.spec().action_size()];
                for _ in 0..3 {
                    env.step(&actions, out.buffers()).unwrap();
                    assert!(!out.terminated.iter().chain(&out.truncated).any(|&over| over), "{name} has just begun");
                    let state = env.save_state().unwrap();
                    env.load_state(&state).unwrap_or_else(|error| panic!("{name} on {body}: {error}"));
                }
            }
        }
    }
}
