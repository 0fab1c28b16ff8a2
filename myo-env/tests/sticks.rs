//! Sticks that the arm swings: what is seen of them, and that their knobs stay on their circles.

use crate::common::{arm, entry, rollout, swung};
use myo_env::{EnvConfig, ReferenceEnv, Skeleton, VectorEnv};

const ENVS: usize = 32;

#[test]
fn an_arm_that_moves_by_chance_swings_knobs_about_their_hinges() {
    let task = swung();
    let (model, config) = (arm(&task), EnvConfig { num_envs: ENVS, seed: 4, exploring: ENVS, ..Default::default() });
    let mut env = ReferenceEnv::new(&model, &task, &config).unwrap();
    let skeleton = Skeleton::new(&model, &task).unwrap();
    let names = ["drag.held", "drag.x", "target_position.x"].map(|name| entry(&env, name));
    let nobs = env.spec().observation_size();
    let (mut turned, mut held, mut done, mut last) = (0, 0, 0, vec![]);
    let mut steps: Vec<Option<usize>> = vec![];
    for _ in 0..40 {
        let mut angles = vec![];
        let out = rollout(&mut env, 1).remove(0);
        let poses: Vec<_> = env.peek(0..ENVS).unwrap().iter().map(|now| skeleton.pose(now).unwrap()).collect();
        for (number, pose) in poses.iter().enumerate() {
            let (angle, is_new) = (pose.objects[0].value.unwrap(), out.terminated[number] || out.truncated[number]);
            turned += usize::from(!is_new && last.get(number).is_some_and(|last: &f64| (last - angle).abs() > 0.1));
            for (object, length, range) in [(0, 0.3, -60.0..=50.0), (2, 0.25, -45.0..=45.0)] {
                let stick = &pose.objects[object];
                let (knob, hinge, angle) = (stick.frame.position.array(), stick.hinge.unwrap(), stick.value.unwrap());
                let arm = [0, 1, 2].map(|k| knob[k] - hinge[k]);
                assert!((arm.iter().map(|x| x * x).sum::<f64>().sqrt() - length).abs() < 1e-9);
                assert!(range.start() - 1e-9 <= angle && angle <= range.end() + 1e-9, "{angle}");
            }
            angles.push(angle);
            // Of the first lever, or of the switch.
            let (before, now) = (steps.get(number).copied().unwrap_or(pose.step), pose.step);
            done += usize::from(!is_new && before != now && matches!(before, Some(0 | 3)));
            let [is_held, way, place] = names.map(|k| out.observation[number * nobs + k]);
            held += usize::from(is_held == 1.0);
            if pose.step == Some(0) {
                let stick = &pose.objects[0];
                // It swings to the right on a face tilted by 20 degrees.
                let to = stick.hinge.unwrap()[0] - 0.3 * 20_f64.to_radians().sin() * 10_f64.to_radians().cos();
                assert!((f64::from(place) - stick.frame.position.x).abs() < 1e-6);
                assert!((f64::from(way) - (to - stick.frame.position.x)).abs() < 1e-6, "{way}");
            }
        }
        last = angles;
        steps = poses.iter().map(|pose| pose.step).collect();
    }
    assert!(turned > 50 && held > 50 && done > 5, "turned {turned}, held {held}, done {done} times");
}
