//! Vehicles that the arm drives with a stick: what is seen of them.

use crate::common::{arm, driven, entry, rollout};
use myo_env::{EnvConfig, ReferenceEnv, Skeleton, VectorEnv};

const ENVS: usize = 32;

#[test]
fn an_arm_that_moves_by_chance_drives_vehicles_along_their_lines() {
    let task = driven();
    let (model, config) = (arm(&task), EnvConfig { num_envs: ENVS, seed: 4, exploring: ENVS, ..Default::default() });
    let mut env = ReferenceEnv::new(&model, &task, &config).unwrap();
    let skeleton = Skeleton::new(&model, &task).unwrap();
    let [y, z, speed] = ["drive.y", "drive.z", "drive.speed"].map(|name| entry(&env, name));
    let nobs = env.spec().observation_size();
    let (mut driven, mut done, mut steps) = (0, 0, vec![Some(0); ENVS]);
    for _ in 0..100 {
        let out = rollout(&mut env, 1).remove(0);
        let poses: Vec<_> = env.peek(0..ENVS).unwrap().iter().map(|now| skeleton.pose(now).unwrap()).collect();
        for (number, pose) in poses.iter().enumerate() {
            let seen = &out.observation[number * nobs..(number + 1) * nobs];
            let [car, place] = [1, 2].map(|object| pose.objects[object].frame.position);
            let is_new = out.terminated[number] || out.truncated[number];
            if pose.step != Some(1) {
                driven += usize::from(car.y.abs() > 0.05);
                // It stays on its line: 0.2 m up for 0.6 m to the right.
                assert!(car.y.abs() <= 0.6 + 1e-9 && (car.z + car.y / 3.0).abs() <= 0.1 + 1e-9, "{car:?}");
                let way = [place.y - car.y, place.z - car.z];
                assert!((f64::from(seen[y]) - way[0]).abs() < 1e-5 && (f64::from(seen[z]) - way[1]).abs() < 1e-5);
            }
            assert!(f64::from(seen[speed]).abs() <= 15.0);
            done += usize::from(!is_new && pose.step != steps[number]);
            steps[number] = pose.step;
        }
    }
    assert!(driven > 100 && done > 20, "driven {driven}, done {done} times");
}
